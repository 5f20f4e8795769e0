//! Values to files: a [`report::Report`] of tables, curves and pictures becomes a page, images and
//! data, and [`output`] makes them appear together or not at all. Files come in by [`input`] alone,
//! regular and bounded, within a budget of [`memory`]. Nothing here knows of shadows.

pub mod input;
pub mod memory;
pub mod output;
pub mod report;
