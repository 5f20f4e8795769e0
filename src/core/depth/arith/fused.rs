//! f32 as a contracting shader compiler runs it: products that feed a sum become one `fma`.

use super::{Number, Shader};
use std::ops::{Add, Div, Mul, Sub};

/// An f32 whose [`Number::plus_product`] and [`Number::minus_product`] round once.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct Fused(f32);

macro_rules! operator {
    ($Trait:ident, $method:ident, $op:tt) => {
        impl $Trait for Fused {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(self.0 $op other.0)
            }
        }
    };
}

operator!(Add, add, +);
operator!(Sub, sub, -);
operator!(Mul, mul, *);
operator!(Div, div, /);

impl Number for Fused {
    #[inline(always)]
    fn ratio(n: f64, d: f64) -> Self {
        Self(f32::ratio(n, d))
    }
    #[inline(always)]
    fn floor(self) -> Self {
        Self(self.0.floor())
    }
    #[inline(always)]
    fn nearest(self) -> Self {
        Self(self.0.nearest())
    }
    #[inline(always)]
    fn fract(self) -> Self {
        Self(Number::fract(self.0))
    }
    #[inline(always)]
    fn plus_product(self, a: Self, b: Self) -> Self {
        Self(a.0.mul_add(b.0, self.0))
    }
    #[inline(always)]
    fn minus_product(self, a: Self, b: Self) -> Self {
        Self((-a.0).mul_add(b.0, self.0))
    }
    #[inline(always)]
    fn pattern_byte(self, index: u32) -> Self {
        Self(self.0.pattern_byte(index))
    }
    #[inline(always)]
    fn from_pattern(bytes: [Self; 4]) -> Self {
        Self(f32::from_pattern([bytes[0].0, bytes[1].0, bytes[2].0, bytes[3].0]))
    }
}

impl Shader for Fused {
    type Raw = f32;
    type Wide = Self;
    #[inline(always)]
    fn enter(raw: f32) -> Self {
        Self(raw)
    }
    #[inline(always)]
    fn leave(self) -> f32 {
        self.0
    }
}
