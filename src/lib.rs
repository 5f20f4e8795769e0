//! gnomon
pub mod catalogue;
pub mod depth;
pub mod error;
pub mod harness;
pub mod num;
pub mod output;
pub mod report;
pub use error::{Error, Result};
pub mod scene;
