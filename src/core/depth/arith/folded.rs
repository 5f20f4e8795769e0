//! f32 under a compiler that multiplies with a reciprocal where a shader divides by a constant.

use super::{Number, Shader};
use std::ops::{Add, Div, Mul, Sub};

/// As plain f32, but x / c is f32(x · f32(1/c)). Every division of a packing is by a constant, and
/// SPIR-V's optimiser folds those (its rule `ReciprocalFDiv`), so that ANGLE and drivers that use it
/// round twice; measured on the WebGL of the dumps with three.js' k/255.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct Folded(f32);

macro_rules! operator {
    ($Trait:ident, $method:ident, $op:tt) => {
        impl $Trait for Folded {
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

impl Div for Folded {
    type Output = Self;
    #[inline(always)]
    fn div(self, constant: Self) -> Self {
        Self(self.0 * (1.0 / constant.0))
    }
}

impl Number for Folded {
    fn ratio(n: f64, d: f64) -> Self {
        Self(f32::ratio(n, d))
    }
    fn floor(self) -> Self {
        Self(Number::floor(self.0))
    }
    fn nearest(self) -> Self {
        Self(self.0.nearest())
    }
    fn fract(self) -> Self {
        Self(Number::fract(self.0))
    }
    fn pattern_byte(self, index: u32) -> Self {
        Self(self.0.pattern_byte(index))
    }
    fn from_pattern(bytes: [Self; 4]) -> Self {
        Self(f32::from_pattern(bytes.map(|byte| byte.0)))
    }
}

impl Shader for Folded {
    type Raw = f32;
    type Wide = Self;
    fn enter(raw: f32) -> Self {
        Self(raw)
    }
    fn leave(self) -> f32 {
        self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_constant_divisor_rounds_twice() {
        let differing = (0..256).filter(|k| {
            let (k, top) = (f64::from(*k), 255.0);
            (Folded::whole(k) / Folded::whole(top)).leave() != Folded::ratio(k, top).leave()
        });
        assert_eq!(differing.count(), 126, "as the sampler's reciprocal, measured");
        assert_eq!((Folded::whole(3.0) / Folded::whole(256.0)).leave(), 3.0 / 256.0);
    }
}
