//! gnomon
pub mod analysis;
pub mod catalogue;
pub mod depth;
pub mod error;
pub mod num;
pub mod simd;
pub use error::{Error, Result};
pub mod scene;
