//! Eight f64 at a time, as arrays that the compiler keeps in vectors.

use std::array::from_fn;
use std::ops::{Add, Mul, Sub};

/// Triangles that are set up at once.
pub(super) const BATCH: usize = 8;

/// Eight numbers; every operation is IEEE's, lane by lane.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(super) struct Lanes(pub(super) [f64; BATCH]);

impl Lanes {
    #[inline(always)]
    pub(super) fn splat(x: f64) -> Self {
        Self([x; BATCH])
    }

    #[inline(always)]
    fn zip(self, other: Self, op: impl Fn(f64, f64) -> f64) -> Self {
        Self(from_fn(|k| op(self.0[k], other.0[k])))
    }

    #[inline(always)]
    pub(super) fn abs(self) -> Self {
        Self(from_fn(|k| self.0[k].abs()))
    }

    /// The larger one; the other one where one is not a number.
    #[inline(always)]
    pub(super) fn max(self, other: Self) -> Self {
        self.zip(other, |a, b| if a > b { a } else { b })
    }

    #[inline(always)]
    pub(super) fn recip(self) -> Self {
        Self(from_fn(|k| 1.0 / self.0[k]))
    }

    /// 1 where `self > other`, else 0.
    #[inline(always)]
    pub(super) fn exceeds(self, other: Self) -> Self {
        self.zip(other, |a, b| if a > b { 1.0 } else { 0.0 })
    }

    /// 1 with the sign of the number.
    #[inline(always)]
    pub(super) fn signum(self) -> Self {
        Self(from_fn(|k| if self.0[k] < 0.0 { -1.0 } else { 1.0 }))
    }

    /// Rounded to f32.
    #[inline(always)]
    pub(super) fn narrow(self) -> [f32; BATCH] {
        from_fn(|k| self.0[k] as f32)
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

impl Mul<f64> for Lanes {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: f64) -> Self {
        self * Self::splat(other)
    }
}
