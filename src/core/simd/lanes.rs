//! Eight f64 at a time, as arrays that the compiler keeps in vectors.
//!
//! Loops over indices, not `array::from_fn` or `map`: their closures are compiled on their own, for
//! the target's baseline, and called lane by lane.
#![allow(clippy::needless_range_loop, reason = "loops over indices become vectors")]

use std::ops::{Add, Div, Mul, Sub};

/// How many there are.
pub const BATCH: usize = 8;

/// Eight numbers; every operation is IEEE's, lane by lane.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub struct Lanes(pub [f64; BATCH]);

impl Lanes {
    /// One number eight times.
    #[inline(always)]
    #[must_use]
    pub fn splat(x: f64) -> Self {
        Self([x; BATCH])
    }

    #[inline(always)]
    fn zip(self, other: Self, op: impl Fn(f64, f64) -> f64) -> Self {
        let mut out = [0.0; BATCH];
        for k in 0..BATCH {
            out[k] = op(self.0[k], other.0[k]);
        }
        Self(out)
    }

    /// Magnitudes.
    #[inline(always)]
    #[must_use]
    pub fn abs(self) -> Self {
        self.zip(self, |x, _| x.abs())
    }

    /// The larger one; the other one where one is not a number.
    #[inline(always)]
    #[must_use]
    pub fn max(self, other: Self) -> Self {
        self.zip(other, |a, b| if a > b { a } else { b })
    }

    /// The smaller one; the other one where one is not a number.
    #[inline(always)]
    #[must_use]
    pub fn min(self, other: Self) -> Self {
        self.zip(other, |a, b| if a < b { a } else { b })
    }

    /// 1/x, rounded once.
    #[inline(always)]
    #[must_use]
    pub fn recip(self) -> Self {
        self.zip(self, |x, _| 1.0 / x)
    }

    /// 1 where `self > other`, else 0.
    #[inline(always)]
    #[must_use]
    pub fn exceeds(self, other: Self) -> Self {
        self.zip(other, |a, b| if a > b { 1.0 } else { 0.0 })
    }

    /// 1 with the sign of the number.
    #[inline(always)]
    #[must_use]
    pub fn signum(self) -> Self {
        self.zip(self, |x, _| if x < 0.0 { -1.0 } else { 1.0 })
    }

    /// Rounded to f32.
    #[inline(always)]
    #[must_use]
    pub fn narrow(self) -> [f32; BATCH] {
        let mut out = [0.0; BATCH];
        for k in 0..BATCH {
            out[k] = self.0[k] as f32;
        }
        out
    }
}

impl Add for Lanes {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }
}

impl Sub for Lanes {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }
}

impl Mul for Lanes {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.zip(other, |a, b| a * b)
    }
}

impl Div for Lanes {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        self.zip(other, |a, b| a / b)
    }
}

impl Mul<f64> for Lanes {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: f64) -> Self {
        self * Self::splat(other)
    }
}
