//! The comparison: visibility of a look-up, and the smallest bias at which a tap is lit.

use super::Taps;
use crate::light::Lookup;
use crate::num::{from_ordinal, ordinal};
use crate::scene::{CompareRule, LookupSpec};

/// Number of lit taps of a receiver; all of them where the range test says *outside* of its one look-up.
///
/// The share `lit / taps` is the fractional visibility v ∈ [0, 1].
#[must_use]
pub fn visibility(spec: &LookupSpec, lookups: &[Lookup], taps: &Taps, bias: f32) -> usize {
    let count = taps.depths().len();
    match lookups {
        [only] if spec.range_test && !in_square(only.coord) => count,
        _ => (0..count).filter(|&i| taps.is_lit(spec.compare, i, bias)).count(),
    }
}

/// Whether 0 ≤ u, v ≤ 1.
#[must_use]
pub fn in_square(coord: [f32; 3]) -> bool {
    (0.0..=1.0).contains(&coord[0]) && (0.0..=1.0).contains(&coord[1])
}

/// The smallest finite f32 bias at which the literal rule says lit; +∞ if none does, −∞ if all do.
#[must_use]
pub fn breakpoint(rule: CompareRule, z: f32, stored: f32) -> f32 {
    breakpoint_where(rule.turning_point(z, stored), |bias| rule.is_lit(z, stored, bias))
}

/// The smallest finite f32 at which `is_lit`; +∞ if there is none, −∞ if it is so everywhere.
///
/// Every rule is monotone in its bias (IEEE operations are), so the breakpoint is found by steps
/// around `guess` and, where that is poor, by bisection over the ordinals of f32.
#[must_use]
pub fn breakpoint_where(guess: f32, is_lit: impl Fn(f32) -> bool) -> f32 {
    let lit = |o: i32| is_lit(from_ordinal(o));
    let (lowest, highest) = (ordinal(f32::MIN), ordinal(f32::MAX));
    if guess.abs() < f32::MAX / 2.0 {
        let guess = ordinal(guess);
        let turns = |o: &i32| lit(*o) && !lit(*o - 1);
        if let Some(found) = [guess, guess + 1, guess - 1].into_iter().find(turns) {
            return from_ordinal(found);
        }
    }
    if !lit(highest) {
        return f32::INFINITY;
    }
    if lit(lowest) {
        return f32::NEG_INFINITY;
    }
    let guess = if guess.is_nan() { 0.0 } else { guess };
    let guess = ordinal(guess).clamp(lowest + 1, highest);
    let (mut dark, mut bright) = bracket(&lit, guess, lowest, highest);
    while i64::from(bright) - i64::from(dark) > 1 {
        let middle = ((i64::from(dark) + i64::from(bright)) / 2) as i32;
        if lit(middle) { bright = middle } else { dark = middle }
    }
    from_ordinal(bright)
}

/// A dark ordinal below a lit one, found by doubling steps away from `guess`.
fn bracket(lit: &impl Fn(i32) -> bool, guess: i32, lowest: i32, highest: i32) -> (i32, i32) {
    let mut step: i64 = 1;
    let at = |offset: i64| {
        (i64::from(guess) + offset).clamp(i64::from(lowest), i64::from(highest)) as i32
    };
    if lit(guess) {
        while lit(at(-step)) {
            step *= 2;
        }
        return (at(-step), at(-step / 2));
    }
    while !lit(at(step)) {
        step *= 2;
    }
    (at(step / 2), at(step))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn breakpoints_are_the_first_lit_bias() {
        let pairs =
            [(0.5, 0.499), (0.9, 0.9), (0.3, 0.7), (1.0, 0.0), (0.982_3, 0.982_3), (0.0, 0.0)];
        for &rule in CompareRule::ALL {
            for (z, d) in pairs {
                let b = breakpoint(rule, z, d);
                assert!(rule.is_lit(z, d, b), "{rule} {z} {d}: lit at {b:e}");
                let below = from_ordinal(ordinal(b) - 1);
                assert!(!rule.is_lit(z, d, below), "{rule} {z} {d}: dark at {below:e}");
            }
        }
    }
}
