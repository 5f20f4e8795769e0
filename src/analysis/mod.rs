//! Analysis: every receiver judged against the truth, with the cause and the kind of each artifact.

pub mod adjacency;
pub mod budget;
pub mod captured;
pub mod classify;
mod counts;
pub mod curve;
pub mod documents;
pub mod effort;
pub mod explain;
pub mod foremost;
pub mod formats;
pub mod interior;
mod judge;
pub mod ladder;
pub mod measure;
pub mod measurement;
pub mod observation;
pub mod observe;
mod observe_all;
pub mod pareto;
pub mod roundtrip;
pub mod sweep;
pub mod tune;
pub mod verdict;
pub mod walk;
