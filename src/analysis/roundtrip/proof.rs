//! A proved bound of a round-trip error.

use serde::Serialize;

/// A bound of |decoded − z| for 0 ≤ z < 1, and why it holds.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Bound {
    /// The bound, window depth.
    pub value: f64,
    /// The argument in a few words.
    pub because: String,
}
