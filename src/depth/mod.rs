//! Depth mappings, formats, packings and stores: everything between a distance and a texel.

pub mod format;
pub mod packing;
pub mod store;

pub use format::DepthFormat;
pub use packing::Packing;
pub use store::{UnormLoad, UnormStore};
