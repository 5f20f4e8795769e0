//! Enclosures: the same packing code over an interval of depths.
//!
//! Every operation of [`Number`] rounds a monotone real function to nearest, and rounding is itself
//! monotone, so the computed result over [lo, hi] lies between the computed results at the ends:
//! the ends are evaluated in the *same* arithmetic and no outward rounding is needed. `fract` is
//! monotone where `floor` agrees at both ends, else it is enclosed by [0, 1). A comparison that the
//! interval straddles yields the hull of both answers. By induction over the operations the channels
//! computed at any depth of the interval lie in the channels' intervals.

use super::Number;
use std::ops::{Add, Div, Mul, Sub};

/// All values between two numbers, ends included.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct Interval<A> {
    /// The lower end.
    pub lo: A,
    /// The upper end.
    pub hi: A,
}

impl<A: Number> Interval<A> {
    #[inline(always)]
    fn point(x: A) -> Self {
        Self { lo: x, hi: x }
    }

    #[inline(always)]
    fn hull(self, other: Self) -> Self {
        let lo = if other.lo < self.lo { other.lo } else { self.lo };
        let hi = if other.hi > self.hi { other.hi } else { self.hi };
        Self { lo, hi }
    }

    /// Products are enclosed by the products of like ends: right where both factors are
    /// nonnegative, or where one is a nonnegative constant. Packings do nothing else.
    #[inline(always)]
    fn assert_factors(self, other: Self) {
        let zero = A::whole(0.0);
        let constant = |x: Self| x.lo == x.hi && x.lo >= zero;
        let fine = constant(self) || constant(other) || (self.lo >= zero && other.lo >= zero);
        debug_assert!(fine, "one factor is a nonnegative constant");
    }
}

impl<A: Number> Add for Interval<A> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self { lo: self.lo + other.lo, hi: self.hi + other.hi }
    }
}

impl<A: Number> Sub for Interval<A> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self { lo: self.lo - other.hi, hi: self.hi - other.lo }
    }
}

impl<A: Number> Mul for Interval<A> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.assert_factors(other);
        Self { lo: self.lo * other.lo, hi: self.hi * other.hi }
    }
}

/// Packings divide by positive constants alone.
impl<A: Number> Div for Interval<A> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        self.assert_factors(other);
        Self { lo: self.lo / other.hi, hi: self.hi / other.lo }
    }
}

impl<A: Number> Number for Interval<A> {
    #[inline(always)]
    fn ratio(n: f64, d: f64) -> Self {
        Self::point(A::ratio(n, d))
    }
    #[inline(always)]
    fn floor(self) -> Self {
        Self { lo: self.lo.floor(), hi: self.hi.floor() }
    }
    #[inline(always)]
    fn nearest(self) -> Self {
        Self { lo: self.lo.nearest(), hi: self.hi.nearest() }
    }
    #[inline(always)]
    fn nearest_product(self, scale: Self) -> Self {
        self.assert_factors(scale);
        Self { lo: self.lo.nearest_product(scale.lo), hi: self.hi.nearest_product(scale.hi) }
    }
    #[inline(always)]
    fn fract(self) -> Self {
        if self.lo.floor() == self.hi.floor() {
            return Self { lo: self.lo.fract(), hi: self.hi.fract() };
        }
        Self { lo: A::whole(0.0), hi: A::whole(1.0) }
    }
    #[inline(always)]
    fn plus_product(self, a: Self, b: Self) -> Self {
        a.assert_factors(b);
        Self { lo: self.lo.plus_product(a.lo, b.lo), hi: self.hi.plus_product(a.hi, b.hi) }
    }
    #[inline(always)]
    fn minus_product(self, a: Self, b: Self) -> Self {
        a.assert_factors(b);
        Self { lo: self.lo.minus_product(a.hi, b.hi), hi: self.hi.minus_product(a.lo, b.lo) }
    }
    #[inline(always)]
    fn at_least(self, limit: Self, then: Self, otherwise: Self) -> Self {
        if self.lo >= limit.hi {
            then
        } else if self.hi < limit.lo {
            otherwise
        } else {
            then.hull(otherwise)
        }
    }
    /// Bytes above `index` equal at both ends: the pattern counts up through this byte alone.
    #[inline(always)]
    fn pattern_byte(self, index: u32) -> Self {
        let agree = (index + 1..4).all(|i| self.lo.pattern_byte(i) == self.hi.pattern_byte(i));
        if agree {
            return Self { lo: self.lo.pattern_byte(index), hi: self.hi.pattern_byte(index) };
        }
        Self { lo: A::whole(0.0), hi: A::whole(255.0) }
    }
    #[inline(always)]
    fn from_pattern(bytes: [Self; 4]) -> Self {
        Self { lo: A::from_pattern(bytes.map(|b| b.lo)), hi: A::from_pattern(bytes.map(|b| b.hi)) }
    }
}
