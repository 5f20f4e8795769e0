//! What is counted over a run of consecutive floats of one spacing, and how runs join.

use crate::depth::arith::Raw;
use crate::num::exp2;

/// The greatest error in one direction, and the first depth (by bit pattern) that has it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extreme<F> {
    /// The error, rounded once to `F`; 0 where no depth errs in this direction.
    pub error: F,
    /// Bit pattern of the depth.
    pub at: u32,
}

impl<F: Raw> Extreme<F> {
    /// The greater, the earlier of equals; NaN is greater than all.
    #[must_use]
    #[inline(always)]
    pub fn or(self, later: Self) -> Self {
        if later.error.key() > self.error.key() { later } else { self }
    }
}

/// The largest step down between neighbours.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Drop {
    /// decoded(z) − decoded(next z), positive.
    pub size: f64,
    /// Bit pattern of the second depth.
    pub at: u32,
}

/// Statistics of the round-trip error decoded − z over consecutive floats of one binade.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ErrorTally<F> {
    /// Bit pattern of the first depth.
    pub start: u32,
    /// How many depths are answered for.
    pub count: u64,
    /// How many were evaluated to answer.
    pub evaluated: u64,
    /// Greatest decoded − z.
    pub above: Extreme<F>,
    /// Greatest z − decoded.
    pub below: Extreme<F>,
    /// Σ(decoded − z).
    pub sum: f64,
    /// Σ(decoded − z)².
    pub squares: f64,
    /// Neighbours whose decoded values go down.
    pub inversions: u64,
    /// The largest such step.
    pub drop: Drop,
    /// Decoded value of the first depth.
    pub first: F,
    /// Decoded value of the last depth.
    pub last: F,
}

impl<F: Raw> ErrorTally<F> {
    /// The tally of depths `start`…`end` (one binade) that all decode to `value`.
    ///
    /// |value − z| is convex in z, so the greatest errors lie at the ends; so do their first
    /// positions after rounding, because fl(value − z) is nonincreasing in z, and fl(z − value) is
    /// strictly increasing where z > value: there ulp(z − value) ≤ ulp(z), so neighbouring depths
    /// keep their distance. The sums are arithmetic series in the spacing u:
    /// Σ(c − ku) = nc − uS₁ and Σ(c − ku)² = nc² − 2cuS₁ + u²S₂ with c = value − z₀.
    #[must_use]
    #[inline(always)]
    pub fn constant(start: u32, end: u32, value: F) -> Self {
        let (low, high) = (f32::from_bits(start), f32::from_bits(end));
        let negated = |x: F| F::default() - x;
        let above = value - F::from_depth(low);
        let below = negated(value - F::from_depth(high));
        let n = f64::from(end - start) + 1.0;
        let (s1, s2) = (n * (n - 1.0) / 2.0, n * (n - 1.0) * (2.0 * n - 1.0) / 6.0);
        let (c, u) = (value.into() - f64::from(low), spacing(start));
        Self {
            start,
            count: u64::from(end - start) + 1,
            evaluated: 2,
            above: positive(above, start, start),
            below: positive(below, end, start),
            sum: n * c - u * s1,
            squares: n * c * c - 2.0 * c * u * s1 + u * u * s2,
            inversions: 0,
            drop: Drop::default(),
            first: value,
            last: value,
        }
    }

    /// Joins the tally of the depths that follow at once.
    #[must_use]
    #[inline(always)]
    pub fn then(self, next: Self) -> Self {
        let mut joined = self;
        let step = self.last.into() - next.first.into();
        let falls = next.first < self.last;
        joined.inversions += next.inversions + u64::from(falls);
        for drop in [Drop { size: if falls { step } else { 0.0 }, at: next.start }, next.drop] {
            if drop.size > joined.drop.size {
                joined.drop = drop;
            }
        }
        joined.count += next.count;
        joined.evaluated += next.evaluated;
        joined.above = self.above.or(next.above);
        joined.below = self.below.or(next.below);
        joined.sum += next.sum;
        joined.squares += next.squares;
        joined.last = next.last;
        joined
    }
}

impl<F: Raw> ErrorTally<F> {
    /// These statistics as f64.
    #[must_use]
    pub fn widened(self) -> ErrorTally<f64> {
        let wide = |e: Extreme<F>| Extreme { error: e.error.into(), at: e.at };
        ErrorTally {
            start: self.start,
            count: self.count,
            evaluated: self.evaluated,
            above: wide(self.above),
            below: wide(self.below),
            sum: self.sum,
            squares: self.squares,
            inversions: self.inversions,
            drop: self.drop,
            first: self.first.into(),
            last: self.last.into(),
        }
    }
}

/// An error that is none has no place of its own: it is said to be at the start of the run.
#[inline(always)]
fn positive<F: Raw>(error: F, at: u32, start: u32) -> Extreme<F> {
    let none = F::Key::default();
    if error.key() > none {
        Extreme { error, at }
    } else {
        Extreme { error: F::from_key(none), at: start }
    }
}

/// Distance between neighbouring floats at a bit pattern.
#[must_use]
#[inline(always)]
pub fn spacing(bits: u32) -> f64 {
    exp2((bits >> 23).max(1) as i32 - 150)
}
