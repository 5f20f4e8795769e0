//! Where something begins along a parameter, and sequences of parameters and phases.

/// The smallest value in [`low`, `high`] from which on `bad` is seen: the first of a geometric ladder of
/// `steps` values at which it is, then bisected to 10⁻⁹ of itself. `None` if no value is bad.
pub(super) fn onset(low: f64, high: f64, steps: u32, bad: impl Fn(f64) -> bool) -> Option<f64> {
    let values = ladder(low, high, steps);
    let first = values.iter().position(|&x| bad(x))?;
    let (mut good, mut found) = (values[first.max(1) - 1], values[first]);
    while found - good > 1e-9 * found {
        let middle = good + (found - good) / 2.0;
        if bad(middle) { found = middle } else { good = middle }
    }
    Some(found)
}

/// `count` values from `low` to `high`, each the same multiple of the one before.
pub(super) fn ladder(low: f64, high: f64, count: u32) -> Vec<f64> {
    let ratio = libm::log(high / low) / f64::from(count - 1);
    let inside = (1..count - 1).map(|i| low * libm::exp(ratio * f64::from(i)));
    std::iter::once(low).chain(inside).chain([high]).collect()
}

/// `count` phases in (0,1), spread by the golden ratio: (½ + i/φ) mod 1.
pub(super) fn phases(count: u32) -> impl Iterator<Item = f64> {
    const INVERSE_GOLDEN: f64 = 0.618_033_988_749_894_9;
    (0..count).map(|i| (0.5 + f64::from(i) * INVERSE_GOLDEN).fract())
}

/// `count` points of the unit square by the plastic number ρ (ρ³ = ρ + 1): (½ + i/ρ, ½ + i/ρ²) mod 1,
/// the two-dimensional sibling of the golden ratio (M. Roberts 2018).
pub(super) fn plastic(count: u32) -> impl Iterator<Item = [f64; 2]> {
    const INVERSE: [f64; 2] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_3];
    (0..count).map(|i| INVERSE.map(|step| (0.5 + f64::from(i) * step).fract()))
}

/// A small generator of uniform numbers (Steele and others 2014, splitmix64).
///
/// The one generator written here: reports are compared byte for byte, and no library promises its
/// sequence for good. Tests take theirs from `fastrand`.
#[derive(Clone, Debug)]
pub(super) struct Random(pub u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Uniform in [0,1), a multiple of 2⁻⁵³.
    pub(super) fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 * crate::num::exp2(-53)
    }

    /// Uniform among `low`, …, `high` − 1.
    pub(super) fn integer(&mut self, low: i64, high: i64) -> i64 {
        low + (self.unit() * (high - low) as f64) as i64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_onset_of_a_step_is_the_step() {
        let found = onset(1.0, 1e6, 40, |x| x >= 1234.5).expect("a step");
        assert!((found / 1234.5 - 1.0).abs() < 1e-8, "{found}");
        assert_eq!(onset(1.0, 10.0, 5, |_| false), None);
        assert_eq!(onset(2.0, 10.0, 5, |_| true), Some(2.0));
    }

    #[test]
    fn plastic_points_fill_the_square_evenly() {
        let points: Vec<_> = plastic(4096).collect();
        for cell in 0..64 {
            let [x, y] = [cell % 8, cell / 8].map(f64::from).map(|c| c / 8.0);
            let inside = points
                .iter()
                .filter(|p| (x..x + 0.125).contains(&p[0]) && (y..y + 0.125).contains(&p[1]));
            let count = inside.count();
            assert!((56..=72).contains(&count), "cell {cell} holds {count} of 64");
        }
    }
}
