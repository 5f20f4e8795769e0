//! gnomon
pub mod camera;
pub mod catalogue;
pub mod conformance;
pub mod depth;
pub mod device;
pub mod error;
pub mod harness;
pub mod light;
pub mod num;
pub mod output;
pub mod raster;
pub mod report;
pub mod scene;
pub mod shadow;
pub mod simd;
pub mod truth;
pub mod view;
pub use error::{Error, Result};
