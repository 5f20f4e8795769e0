//! f32 without contraction, and f64 as the stand-in for real values.

use super::{Number, Raw, Shader};

macro_rules! plain {
    ($F:ty, $Key:ty, $below_one:expr) => {
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
                let byte = |x: Self| (if x < 255.0 { x } else { 255.0 }) as i32 as u32 & 255;
                let [a, b, c, d] = bytes.map(byte);
                f32::from_bits(a << 24 | b << 16 | c << 8 | d) as $F
            }
        }

        impl Shader for $F {
            type Raw = $F;
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
                clamped(self * 255.0).round_ties_even()
            }
            #[inline(always)]
            fn byte_floor(self, half: Self) -> Self {
                (clamped(self * 255.0) + half).floor()
            }
            #[inline(always)]
            fn byte(self) -> u8 {
                (self as i32 & 255) as u8
            }
            #[inline(always)]
            fn times(self, factor: Self) -> Self {
                self * factor
            }
            #[inline(always)]
            fn plus(self, other: Self) -> Self {
                self + other
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

plain!(f32, i32, 1.0 - f32::EPSILON / 2.0);
plain!(f64, i64, 1.0 - f64::EPSILON / 2.0);

/// `x` within [0,255]; NaN gives 0. Written with comparisons so that it vectorises.
#[inline(always)]
fn clamped<F: Raw + From<u8>>(x: F) -> F {
    let (zero, top) = (F::from(0), F::from(255));
    let x = if x > zero { x } else { zero };
    if x < top { x } else { top }
}
