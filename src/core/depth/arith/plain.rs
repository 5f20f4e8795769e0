//! f32 without contraction, and f64 as the stand-in for real values.

use super::{Lean, Number, Raw, Shader};

macro_rules! plain {
    ($F:ty, $Wide:ty, $Key:ty, $below_one:expr, $($exact:item)*) => {
        impl Number for $F {
            #[inline(always)]
            fn ratio(n: f64, d: f64) -> Self {
                n as $F / d as $F
            }
            #[inline(always)]
            fn floor(self) -> Self {
                <$F>::floor(self)
            }
            #[inline(always)]
            fn nearest(self) -> Self {
                self.round_ties_even()
            }
            $($exact)*
            #[inline(always)]
            fn fract(self) -> Self {
                let x = self - <$F>::floor(self);
                if x < $below_one { x } else { $below_one }
            }
            #[inline(always)]
            fn pattern_byte(self, index: u32) -> Self {
                ((self as f32).to_bits() >> (8 * index) & 255) as i32 as $F
            }
            #[inline(always)]
            fn from_pattern(bytes: [Self; 4]) -> Self {
                let [a, b, c, d] = bytes;
                let (a, b) = (low_byte(clamped_to(255, a) as f32), low_byte(clamped_to(255, b) as f32));
                let (c, d) = (low_byte(clamped_to(255, c) as f32), low_byte(clamped_to(255, d) as f32));
                f32::from_bits(a << 24 | b << 16 | c << 8 | d) as $F
            }
        }

        impl Shader for $F {
            type Raw = $F;
            type Wide = $Wide;
            #[inline(always)]
            fn enter(raw: $F) -> Self {
                raw
            }
            #[inline(always)]
            fn leave(self) -> $F {
                self
            }
        }

        impl Raw for $F {
            type Key = $Key;
            #[inline(always)]
            fn from_depth(z: f32) -> Self {
                z.into()
            }
            #[inline(always)]
            fn from_real(x: f64) -> Self {
                x as $F
            }
            #[inline(always)]
            fn byte_even(self) -> Self {
                clamped_to(255, self * 255.0).round_ties_even()
            }
            #[inline(always)]
            fn byte_floor(self, half: Self) -> Self {
                (clamped_to(255, self * 255.0) + half).floor()
            }
            #[inline(always)]
            fn byte(self) -> u8 {
                (self as i32 & 255) as u8
            }
            #[inline(always)]
            fn product_sum(self, a: Self, b: Self, fused: bool) -> Self {
                if fused { self.mul_add(a, self * b) } else { self * a + self * b }
            }
            #[inline(always)]
            fn key(self) -> $Key {
                self.to_bits() as $Key
            }
            #[inline(always)]
            fn from_key(key: $Key) -> Self {
                Self::from_bits(key as _)
            }
        }
    };
}

plain!(f32, Lean, i32, 1.0 - f32::EPSILON / 2.0,);
plain! {
    f64, Self, i64, 1.0 - f64::EPSILON / 2.0,
    /// A f32 times 2³² − 1 needs 56 bits. What the product loses is exact by `fma`, and decides
    /// where the rounded product is halfway between two integers.
    #[inline(always)]
    fn nearest_product(self, scale: Self) -> Self {
        let product = self * scale;
        let lost = self.mul_add(scale, -product);
        let nearest = product.round_ties_even();
        let half = product - nearest;
        let up = if half == 0.5 && lost > 0.0 { 1.0 } else { 0.0 };
        let down = if half == -0.5 && lost < 0.0 { 1.0 } else { 0.0 };
        nearest + up - down
    }
}

/// `x` within [0, top]; NaN gives 0. Written with comparisons so that it vectorises.
#[inline(always)]
fn clamped_to<F: Raw + From<u8>>(top: u8, x: F) -> F {
    let (zero, top) = (F::from(0), F::from(top));
    let x = if x > zero { x } else { zero };
    if x < top { x } else { top }
}

/// ⌊x⌋ of 0 ≤ x < 256: added to 2²³ it is the low byte of the pattern (a saturating cast does not
/// vectorise).
#[inline(always)]
fn low_byte(x: f32) -> u32 {
    (x.floor() + 8_388_608.0).to_bits() & 255
}
