//! Analyses: from subjects and truths to numbers, certificates and reports.

pub mod roundtrip;
