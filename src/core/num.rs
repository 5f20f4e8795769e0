//! Ulp steps and ordinals of `f32`, and rounding to half precision.

/// The ordinal of a float: consecutive finite floats have consecutive ordinals, `-0.0` and `+0.0`
/// share 0, infinities follow the largest finite values. NaN is a bug of the caller.
#[must_use]
#[inline(always)]
pub fn ordinal(x: f32) -> i32 {
    debug_assert!(!x.is_nan(), "NaN has no ordinal");
    let magnitude = (x.to_bits() & 0x7fff_ffff) as i32;
    if x.is_sign_negative() { -magnitude } else { magnitude }
}

/// The float of an ordinal; the inverse of [`ordinal`] but for the sign of zero.
#[must_use]
#[inline(always)]
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

/// Checks that this thread computes in IEEE 754's default mode: rounds to nearest, ties to even, and
/// keeps subnormals as operands and as results. Libraries loaded by others may have changed it.
///
/// # Errors
/// [`crate::Error::CheckFailed`] naming what is not as it should be.
pub fn check_float_mode() -> crate::Result<()> {
    let opaque = std::hint::black_box::<f32>;
    fault_of_mode(|a, b| opaque(a) + opaque(b), |a, b| opaque(a) * opaque(b)).map_or(
        Ok(()),
        |fault| {
            let advice = "run in a process whose libraries leave the floating-point mode alone";
            Err(crate::Error::CheckFailed(format!("floating-point mode: {fault}; {advice}")))
        },
    )
}

/// What is wrong with a sum and a product of f32, if anything.
fn fault_of_mode(
    add: impl Fn(f32, f32) -> f32,
    multiply: impl Fn(f32, f32) -> f32,
) -> Option<&'static str> {
    let half_ulp = exp2(-24) as f32;
    let odd = 1.0 + f32::EPSILON;
    let even_above = 1.0 + 2.0 * f32::EPSILON;
    let to_even = [(1.0, 1.0), (odd, even_above)]
        .iter()
        .all(|&(x, rounded)| add(x, half_ulp) == rounded && add(-x, -half_ulp) == -rounded);
    let subnormal = f32::MIN_POSITIVE / 4.0;
    if !to_even {
        Some("sums are not rounded to nearest, ties to even")
    } else if multiply(f32::MIN_POSITIVE, 0.25).to_bits() != subnormal.to_bits() {
        Some("subnormal results are flushed to zero")
    } else if multiply(subnormal, 4.0) != f32::MIN_POSITIVE {
        Some("subnormal operands are taken as zero")
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn other_float_modes_are_recognised() {
        let (add, multiply) = (|a: f32, b: f32| a + b, |a: f32, b: f32| a * b);
        assert_eq!(fault_of_mode(add, multiply), None, "the default mode");
        // Directed roundings, from the exact f64 sum of two f32 that differ by less than 2²⁹.
        let upwards = |a: f32, b: f32| {
            let (exact, near) = (f64::from(a) + f64::from(b), a + b);
            if f64::from(near) < exact { near.next_up() } else { near }
        };
        let downwards = |a: f32, b: f32| -upwards(-a, -b);
        let to_zero = |a: f32, b: f32| if a + b > 0.0 { downwards(a, b) } else { upwards(a, b) };
        let modes: [&dyn Fn(f32, f32) -> f32; 3] = [&upwards, &downwards, &to_zero];
        for mode in modes {
            assert!(fault_of_mode(mode, multiply).is_some_and(|f| f.contains("rounded")));
        }
        let flushed = |x: f32| if x.is_subnormal() { 0.0 } else { x };
        let results = fault_of_mode(add, |a, b| flushed(a * b));
        assert!(results.is_some_and(|f| f.contains("results")), "FTZ");
        let operands = fault_of_mode(add, |a, b| flushed(a) * flushed(b));
        assert!(operands.is_some_and(|f| f.contains("operands")), "DAZ");
    }

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
