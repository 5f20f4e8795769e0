//! gnomon
pub mod catalogue;
pub mod depth;
pub mod error;
pub mod num;
pub use error::{Error, Result};
pub mod scene;
pub mod truth;
