//! Analysis: every receiver judged against the truth, with the cause and the kind of each artifact.

pub mod adjacency;
pub mod budget;
pub mod classify;
pub mod curve;
pub mod formats;
pub mod interior;
pub mod ladder;
pub mod measure;
pub mod observe;
pub mod sweep;
pub mod tune;
pub mod walk;
