//! Analysis: every receiver judged against the truth, with the cause and the kind of each artifact.

pub mod adjacency;
pub mod classify;
pub mod curve;
pub mod documents;
pub mod explain;
pub mod interior;
pub mod ladder;
pub mod measure;
pub mod measurement;
pub mod observe;
pub mod roundtrip;
pub mod walk;
