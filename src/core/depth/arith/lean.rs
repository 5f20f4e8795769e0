//! Plain f32 in fewer instructions: what depths of [2⁻⁶⁴, 1] cannot reach is left out.

use super::{Number, Shader};
use std::ops::{Add, Div, Mul, Sub};

/// Arithmetic with the bits of plain f32 in a packing of depths from 2⁻⁶⁴ to 1, for loops that have `fma`.
///
/// - `fract` needs no clamp: packings take it of a depth times a positive constant, and x − ⌊x⌋ is
///   exact and below one for every x ≥ 0 (Sterbenz). Only a negative x could round to one.
/// - A product with 2ᵏ, |k| ≤ 32, is exact where it does not underflow, so that a sum with it may be
///   one `fma`. The other factor is a sampled byte (0 or at least 2⁻⁸), a fraction of a number from 1
///   on (0 or at least 2⁻²³), or the depth times constants: far above 2⁻⁹⁴.
///
/// That every vector width gives the bits of the scalar path is tested for every packing.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct Lean(f32);

/// Whether |x| is 2ᵏ with |k| ≤ 32. A packing's constants are known when it is compiled, and so is
/// this.
#[inline(always)]
fn is_scale(x: f32) -> bool {
    let exponent = x.to_bits() >> 23 & 255;
    x.to_bits() << 9 == 0 && (127 - 32..=127 + 32).contains(&exponent)
}

macro_rules! operator {
    ($Trait:ident, $method:ident, $op:tt) => {
        impl $Trait for Lean {
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

impl Number for Lean {
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
        Self(self.0 - self.0.floor())
    }
    #[inline(always)]
    fn plus_product(self, a: Self, b: Self) -> Self {
        Self(if is_scale(b.0) { a.0.mul_add(b.0, self.0) } else { self.0 + a.0 * b.0 })
    }
    #[inline(always)]
    fn minus_product(self, a: Self, b: Self) -> Self {
        Self(if is_scale(b.0) { (-a.0).mul_add(b.0, self.0) } else { self.0 - a.0 * b.0 })
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

impl Shader for Lean {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_powers_of_two_within_reach_are_contracted() {
        let scales = [1.0, 256.0, 1.0 / 256.0, 16_777_216.0, 4_294_967_296.0];
        assert!(scales.iter().all(|&x| is_scale(x)));
        let others =
            [0.0, 1.0 / 255.0, 255.0, 3.0, 1e-40, 8_589_934_592.0, f32::NAN, f32::INFINITY];
        assert!(others.iter().all(|&x| !is_scale(x)));
    }
}
