//! Half precision after every operation: `mediump` as a phone executes it.

use super::{Number, Shader};
use crate::num::to_half;
use std::ops::{Add, Div, Mul, Sub};

/// A half-precision number kept in an f32, and whether every step on the way to it was finite.
///
/// One operation is the f32 operation rounded to half precision: correctly rounded for + − × ÷,
/// because 24 ≥ 2·11 + 2 makes the double rounding harmless (Figueroa 1995).
#[derive(Clone, Copy, Debug)]
pub struct Mediump {
    value: f32,
    sound: bool,
}

impl PartialEq for Mediump {
    fn eq(&self, other: &Self) -> bool {
        self.value == other.value
    }
}

impl PartialOrd for Mediump {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        self.value.partial_cmp(&other.value)
    }
}

impl Mediump {
    fn rounded(x: f32, sound: bool) -> Self {
        let value = to_half(x);
        Self { value, sound: sound && value.is_finite() }
    }
}

macro_rules! operator {
    ($Trait:ident, $method:ident, $op:tt) => {
        impl $Trait for Mediump {
            type Output = Self;
            fn $method(self, other: Self) -> Self {
                Self::rounded(self.value $op other.value, self.sound && other.sound)
            }
        }
    };
}

operator!(Add, add, +);
operator!(Sub, sub, -);
operator!(Mul, mul, *);
operator!(Div, div, /);

impl Number for Mediump {
    fn ratio(n: f64, d: f64) -> Self {
        Self::rounded((n / d) as f32, true)
    }
    fn floor(self) -> Self {
        Self { value: self.value.floor(), ..self }
    }
    fn nearest(self) -> Self {
        Self { value: self.value.round_ties_even(), ..self }
    }
    fn fract(self) -> Self {
        const BELOW_ONE: f32 = 1.0 - 1.0 / 2048.0;
        let x = self - Number::floor(self);
        let value = if x.value < BELOW_ONE { x.value } else { BELOW_ONE };
        Self { value, sound: x.sound }
    }
    fn pattern_byte(self, index: u32) -> Self {
        Self { value: self.value.pattern_byte(index), ..self }
    }
    fn from_pattern(bytes: [Self; 4]) -> Self {
        let sound = bytes.iter().all(|b| b.sound);
        Self::rounded(f32::from_pattern(bytes.map(|b| b.value)), sound)
    }
}

impl Shader for Mediump {
    type Raw = f32;
    type Wide = Self;
    const COARSE: bool = true;
    fn enter(raw: f32) -> Self {
        Self::rounded(raw, true)
    }
    fn leave(self) -> f32 {
        self.value
    }
    fn is_sound(self) -> bool {
        self.sound
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_largest_half_is_65504_and_256_cubed_overflows() {
        assert!(Mediump::whole(65_504.0).is_sound());
        let cubed = Mediump::whole(256.0) * Mediump::whole(256.0);
        assert!(cubed.leave().is_infinite() && !cubed.is_sound());
    }

    #[test]
    fn constants_round_to_eleven_bits() {
        assert_eq!(Mediump::ratio(1.0, 255.0).leave(), 0.003_921_509);
        assert_eq!(Mediump::enter(0.999_9).leave(), 1.0);
    }
}
