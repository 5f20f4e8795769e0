//! Certificates of depth round trips: does a pack/unpack pair or a format lose bits, where and why.
//!
//! ```
//! use gnomon::analysis::roundtrip::{Conditions, Effort, Method};
//! use gnomon::depth::{ByteStore, Packing};
//! use gnomon::simd::Level;
//!
//! let effort = Effort { method: Method::Sampled, level: Level::best() };
//! let book = effort.certify_packing(Packing::Book, Conditions::plain(ByteStore::HalfEven));
//! assert!(book.equivalent_bits < 9.0 && book.at_one == 0.0); // 32 bits stored, 9 kept; far wraps
//! ```

pub mod bound;
mod breakpoints;
mod brute;
mod certificate;
mod combination;
pub mod curve;
pub mod filter;
pub mod moments;
mod prune;
pub mod report;
mod sample;
pub mod shaders;
pub mod survey;
pub mod tally;
pub mod verdict;
pub mod world;

pub use certificate::{Certificate, Order, Peak, Promise, RangeError, Special, Subject, certify};
pub use combination::{Conditions, Effort};
pub use sample::{boundaries, sample};
pub use survey::{Method, survey, survey_format};
