//! Values to files: a [`report::Report`] of tables, curves and pictures becomes a page, images and
//! data, and [`output`] makes them appear together or not at all. Nothing here knows of shadows.

pub mod output;
pub mod report;
