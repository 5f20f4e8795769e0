//! gnomon
pub mod camera;
pub mod catalogue;
pub mod depth;
pub mod device;
pub mod error;
pub mod light;
pub mod num;
pub mod raster;
pub mod scene;
pub mod simd;
pub mod truth;
pub mod view;
pub use error::{Error, Result};
