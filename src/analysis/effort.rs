//! How a measurement is made: by which truth, with which skips, and what they saved. No result
//! depends on it.

crate::catalogue! {
    /// Who answers what receivers see.
    pub enum TruthBy {
        /// The irregular z-buffer: all receivers of the light in one pass.
        Raster = "raster",
        /// One ray after the other: the arbiter.
        Rays = "rays",
    }
}

/// How a measurement is made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Effort {
    /// Who answers what receivers see.
    pub truth: TruthBy,
    /// Whether what the scene does not need is left out.
    pub skip: bool,
}

impl Default for Effort {
    fn default() -> Self {
        Self { truth: TruthBy::Raster, skip: true }
    }
}

impl Effort {
    /// Every answer by its own ray, nothing left out: what skips are proved against.
    pub const ARBITER: Self = Self { truth: TruthBy::Rays, skip: false };
}

/// How many answers of one kind were given, and how many of them had to be worked out one by one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Count {
    /// What was asked.
    pub what: &'static str,
    /// Answers given.
    pub answered: u64,
    /// Answers worked out.
    pub evaluated: u64,
    /// Why the others need no work.
    pub because: &'static str,
}
