//! What the raster leaves out, and how much that is.

use std::ops::AddAssign;

/// Which work is left out that no answer depends on. [`Skips::NONE`] is the arbiter of the rest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Skips {
    /// Triangles with no receiver in their rows and columns: there is nobody to shadow.
    pub empty: bool,
    /// Triangles farther from the light than every receiver near them: depth over a triangle
    /// is largest at a corner, so none of its points lies between a receiver and the light.
    pub behind: bool,
    /// Hits that lie, by more than their error bounds, between the occluders already known to be
    /// nearest to the receiver and to the light: neither end of the answer can become theirs.
    pub between: bool,
}

impl Skips {
    /// Everything that can be left out is.
    pub const ALL: Self = Self { empty: true, behind: true, between: true };
    /// Every triangle is run over the receivers near it, every hit goes to the exact tests.
    pub const NONE: Self = Self { empty: false, behind: false, between: false };

    /// All of them, or none.
    #[must_use]
    pub const fn all(on: bool) -> Self {
        if on { Self::ALL } else { Self::NONE }
    }
}

/// How much was done, over all projections of the light (a point light may need seven). The same
/// with any number of threads and any instruction set.
///
/// `triangles = outside + empty + behind + swept`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Work {
    /// Triangles looked at.
    pub triangles: u64,
    /// Triangles that project beside the grid of the receivers: they share no cell with any.
    pub outside: u64,
    /// Triangles with no receiver in their rows and columns.
    pub empty: u64,
    /// Triangles farther from the light than every receiver near them.
    pub behind: u64,
    /// Triangles run over the receivers near them.
    pub swept: u64,
    /// Pairs of triangle and receiver that were evaluated.
    pub evaluated: u64,
    /// Pairs of triangle and receiver that are answered: all of them.
    pub answered: u64,
    /// Pairs that the error bound of f32 left open, decided by exact signs.
    pub escalated: u64,
}

impl Work {
    #[inline(always)]
    pub(super) fn skip(&mut self, why: Skipped) {
        match why {
            Skipped::Empty => self.empty += 1,
            Skipped::Behind => self.behind += 1,
        }
    }
}

impl AddAssign for Work {
    fn add_assign(&mut self, other: Self) {
        self.triangles += other.triangles;
        self.outside += other.outside;
        self.empty += other.empty;
        self.behind += other.behind;
        self.swept += other.swept;
        self.evaluated += other.evaluated;
        self.answered += other.answered;
        self.escalated += other.escalated;
    }
}

/// Why a triangle is not swept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Skipped {
    Empty,
    Behind,
}
