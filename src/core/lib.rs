//! The measuring core of *gnomon*: encodings, bias, raster and exact truth for shadow maps.
//!
//! It opens no file and has no command line; the package `gnomon` around it is the map of the whole.

pub mod camera;
pub mod catalogue;
pub mod depth;
pub mod device;
pub mod engines;
pub mod error;
pub mod light;
pub mod num;
pub mod raster;
pub mod scene;
pub mod shadow;
pub mod simd;
pub mod size;
pub mod truth;
pub mod view;

pub use error::{Error, Result};
