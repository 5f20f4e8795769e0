//! Depth mappings, formats, packings and stores: everything between a distance and a texel.

pub mod arith;
pub mod format;
pub mod mapping;
pub mod packing;
pub mod roundtrip;
pub mod store;

pub use arith::Arithmetic;
pub use format::{DepthFormat, FormatTrip};
pub use mapping::{DepthMapping, MappingKind};
pub use packing::Packing;
pub use roundtrip::RoundTrip;
pub use store::{ByteRounding, ByteStore, UnormLoad, UnormStore};
