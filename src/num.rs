//! Ulp steps and ordinals of `f32`, and rounding to half precision.

/// The ordinal of a float: consecutive finite floats have consecutive ordinals, `-0.0` and `+0.0`
/// share 0, infinities follow the largest finite values. NaN is a bug of the caller.
#[must_use]
pub fn ordinal(x: f32) -> i32 {
    debug_assert!(!x.is_nan(), "NaN has no ordinal");
    let magnitude = (x.to_bits() & 0x7fff_ffff) as i32;
    if x.is_sign_negative() { -magnitude } else { magnitude }
}

/// The float of an ordinal; the inverse of [`ordinal`] but for the sign of zero.
#[must_use]
pub fn from_ordinal(ordinal: i32) -> f32 {
    let magnitude = f32::from_bits(ordinal.unsigned_abs());
    if ordinal < 0 { -magnitude } else { magnitude }
}

/// Distance in representable steps between two floats.
#[must_use]
pub fn ulps_between(a: f32, b: f32) -> u64 {
    (i64::from(ordinal(a)) - i64::from(ordinal(b))).unsigned_abs()
}

/// Spacing of `f32` at `x`: the distance from |x| to the next float away from zero.
#[must_use]
pub fn ulp(x: f32) -> f64 {
    let x = x.abs();
    f64::from(x.next_up()) - f64::from(x)
}

/// The nearest half-precision value, ties to even; overflow gives infinity.
#[must_use]
pub fn to_half(x: f32) -> f32 {
    half::f16::from_f32(x).to_f32()
}

/// 2ⁿ as f64 for −1022 ≤ n ≤ 1023, exactly (`powi` has unspecified precision).
#[must_use]
pub const fn exp2(n: i32) -> f64 {
    assert!(-1022 <= n && n <= 1023, "2ⁿ is a normal f64");
    f64::from_bits(((n + 1023) as u64) << 52)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ordinals_are_consecutive_and_invertible() {
        for x in [0.0f32, 1e-45, 1.0, -1.0, 0.1, -3.5e-39, f32::MAX] {
            assert_eq!(from_ordinal(ordinal(x)), x, "{x:e}");
            assert_eq!(ordinal(x.next_up()), ordinal(x) + 1, "{x:e}");
        }
        assert_eq!(ordinal(-0.0), 0, "both zeros share an ordinal");
    }

    #[test]
    fn ulp_is_the_spacing_above() {
        assert_eq!(ulp(1.0), exp2(-23), "spacing at one");
        assert_eq!(ulp(-0.75), exp2(-24), "spacing below one");
    }
}
