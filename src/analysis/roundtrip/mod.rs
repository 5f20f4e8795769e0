//! Certificates of depth round trips: does a pack/unpack pair or a format lose bits, where and why.
//!
//! ```
//! use gnomon::analysis::roundtrip::{Certifier, Conditions, Method};
//! use gnomon::depth::{ByteStore, Packing};
//! use gnomon::simd::Level;
//!
//! let certifier = Certifier { method: Method::Sampled, level: Level::best() };
//! let book = certifier.certify_packing(Packing::Book, Conditions::plain(ByteStore::HalfEven));
//! assert!(book.equivalent_bits < 9.0 && book.at_one == 0.0); // 32 bits stored, 9 kept; far wraps
//! ```
//!
//! Your own pair, as two closures:
//!
//! ```
//! # use gnomon::analysis::roundtrip::{Certifier, Conditions, Method};
//! # use gnomon::depth::ByteStore;
//! # use gnomon::simd::Level;
//! let pack = |z: f32| [(z * 255.0).floor() / 255.0, (z * 255.0).fract(), 0.0, 0.0];
//! let unpack = |c: [f32; 4]| c[0] + c[1] / 255.0;
//! let certifier = Certifier { method: Method::Sampled, level: Level::best() };
//! let conditions = Conditions::plain(ByteStore::Truncate);
//! let mine = certifier.certify_closures("mine", 2, conditions, pack, unpack);
//! // Truncated, the leading byte loses a step where f32 falls short of k/255.
//! assert!(mine.max.error < 1.0 / 255.0 + 1.0 / 65_025.0 && mine.forced_bias > 0.0);
//! println!("{} at {}", mine.max.error, mine.max.at);
//! ```

pub mod bound;
mod breakpoints;
mod brute;
mod certificate;
mod combination;
mod conditions;
pub mod curve;
pub mod filter;
mod layout;
pub mod moments;
mod proof;
mod prune;
pub mod report;
mod sample;
pub mod shaders;
pub mod survey;
pub mod tally;
mod unmasked;
pub mod verdict;
pub mod world;

pub use certificate::{Certificate, Order, Peak, Promise, RangeError, Special, Subject, certify};
pub use combination::Certifier;
pub use conditions::Conditions;
pub use sample::{boundaries, sample};
pub use survey::{Method, survey, survey_format};
