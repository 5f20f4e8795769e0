//! The exact sign of a 3x3 or 2x2 determinant of differences, or none outside the safe range.

use glam::{DVec2, DVec3};
use robust::{Coord, Coord3D};

/// -1, 0 or 1; `None` where the exponents of the inputs are too far apart to decide exactly.
pub(super) type Sign = Option<i8>;

/// Non-zero coordinates between these need no scaling: products of three differences and all
/// their rounding tails then neither overflow nor underflow (Shewchuk 1997, `predicates.c`).
const SMALLEST: f64 = f64::from_bits((1023 - 142) << 52);
pub(super) const LARGEST: f64 = f64::from_bits((1023 + 200) << 52);

/// The sign of `det(a - d, b - d, c - d)`: positive if `a`, `b`, `c` turn counter-clockwise seen
/// from the side that `d` is not on. Exact.
pub(super) fn orient3d(a: DVec3, b: DVec3, c: DVec3, d: DVec3) -> Sign {
    let [a, b, c, d] = in_range([a, b, c, d])?;
    let coord = |p: DVec3| Coord3D { x: p.x, y: p.y, z: p.z };
    Some(sign(robust::orient3d(coord(a), coord(b), coord(c), coord(d))))
}

/// The sign of `det(a - c, b - c)`: positive if `a`, `b`, `c` turn counter-clockwise. Exact.
pub(super) fn orient2d(a: DVec2, b: DVec2, c: DVec2) -> Sign {
    let [a, b, c] = in_range([a, b, c].map(|p| p.extend(0.0)))?;
    let coord = |p: DVec3| Coord { x: p.x, y: p.y };
    Some(sign(robust::orient2d(coord(a), coord(b), coord(c))))
}

/// -1, 0 or 1.
pub(super) fn sign(x: f64) -> i8 {
    i8::from(x > 0.0) - i8::from(x < 0.0)
}

/// The points, scaled together by a power of two if that is needed to bring them into the safe
/// range. Scaling is exact, and no sign depends on it.
fn in_range<const N: usize>(points: [DVec3; N]) -> Option<[DVec3; N]> {
    let (mut smallest, mut largest) = (f64::MAX, 0.0_f64);
    for x in points.iter().flat_map(|p| p.to_array()).filter(|&x| x != 0.0) {
        (smallest, largest) = (smallest.min(x.abs()), largest.max(x.abs()));
        if !x.is_finite() {
            return None;
        }
    }
    if largest == 0.0 || (smallest >= SMALLEST && largest <= LARGEST) {
        return Some(points);
    }
    let scale = 200 - exponent(largest);
    let half = (power_of_two(scale / 2), power_of_two(scale - scale / 2));
    (exponent(smallest) + scale >= -142).then(|| points.map(|p| p * half.0 * half.1))
}

/// Floor of log2 of a positive finite number, subnormal ones too.
fn exponent(x: f64) -> i32 {
    let biased = |x: f64| (x.to_bits() >> 52) as i32;
    if x.is_normal() { biased(x) - 1023 } else { biased(x * power_of_two(64)) - 1023 - 64 }
}

/// `2^e` for `-1022 <= e <= 1023`.
fn power_of_two(e: i32) -> f64 {
    f64::from_bits(((e + 1023) as u64) << 52)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A nearly flat quadruple whose determinant is far below the rounding of its products.
    fn sliver(scale: i32) -> [DVec3; 4] {
        let up = DVec3::new(0.1, 0.1, 0.1).map(|x| f64::from_bits(x.to_bits() + 1));
        [DVec3::new(12.0, 12.0, 12.0), DVec3::new(24.0, 24.0, 24.0), DVec3::new(0.3, 0.7, 0.2), up]
            .map(|p| p * power_of_two(scale / 2) * power_of_two(scale - scale / 2))
    }

    #[test]
    fn scaling_by_any_power_of_two_keeps_every_sign() {
        let [a, b, c, d] = sliver(0);
        let expected = orient3d(a, b, c, d);
        for scale in [-1000, -500, -150, 150, 190, 500, 1000] {
            let [a, b, c, d] = sliver(scale);
            assert_eq!(orient3d(a, b, c, d), expected, "scaled by 2^{scale}");
            assert_eq!(orient3d(b, a, c, d), expected.map(|s| -s), "scaled by 2^{scale}");
        }
    }

    #[test]
    fn exponents_too_far_apart_are_undecided() {
        let tiny = DVec3::splat(1e-200);
        assert_eq!(orient3d(tiny, DVec3::X, DVec3::Y, DVec3::Z), None);
        assert_eq!(
            orient3d(tiny, tiny * 2.0, DVec3::new(1e-200, 0.0, 3e-200), DVec3::ZERO),
            Some(0)
        );
        assert_eq!(orient3d(DVec3::splat(f64::NAN), DVec3::X, DVec3::Y, DVec3::Z), None);
        assert_eq!(orient2d(DVec2::X, DVec2::Y, DVec2::splat(f64::INFINITY)), None);
    }

    /// A random integer, signed, below 2^bits.
    fn random(state: &mut fastrand::Rng, bits: u32) -> i128 {
        i128::from(state.i64(..) >> (63 - bits))
    }

    fn determinant([a, b, c]: [[i128; 3]; 3]) -> i128 {
        a[0] * (b[1] * c[2] - b[2] * c[1])
            + a[1] * (b[2] * c[0] - b[0] * c[2])
            + a[2] * (b[0] * c[1] - b[1] * c[0])
    }

    /// The fourth point lies in the plane of three others but for a step of 0 or 1.
    fn nearly_coplanar(state: &mut fastrand::Rng) -> [[i128; 3]; 4] {
        let mut point = |bits| [0; 3].map(|_| random(state, bits));
        let ([a, b, c], step) = ([point(36), point(36), point(36)], point(1));
        let (s, t) = (random(state, 1), random(state, 1));
        let d = std::array::from_fn(|k| a[k] + s * (b[k] - a[k]) + t * (c[k] - a[k]) + step[k]);
        [a, b, c, d]
    }

    #[test]
    fn signs_equal_integers_on_a_million_nearly_degenerate_quadruples() {
        let mut state = fastrand::Rng::with_seed(17);
        let mut zeros = 0;
        for _ in 0..1_000_000 {
            let points = nearly_coplanar(&mut state);
            let rows = [0, 1, 2].map(|k| [0, 1, 2].map(|i| points[k][i] - points[3][i]));
            let expected = determinant(rows).signum() as i8;
            zeros += u32::from(expected == 0);
            let [a, b, c, d] = points.map(|p| DVec3::from_array(p.map(|x| x as f64)));
            assert_eq!(orient3d(a, b, c, d), Some(expected), "{points:?}");
        }
        assert!((1_000..900_000).contains(&zeros), "{zeros} zeros");
    }

    #[test]
    fn turns_equal_integers_on_a_million_nearly_collinear_triples() {
        let mut state = fastrand::Rng::with_seed(18);
        for _ in 0..1_000_000 {
            let [a, b, _, step] = nearly_coplanar(&mut state);
            let s = random(&mut state, 3);
            let c: [i128; 2] = std::array::from_fn(|k| a[k] + s * (b[k] - a[k]) + step[k] % 2);
            let (u, v) = ([a[0] - c[0], a[1] - c[1]], [b[0] - c[0], b[1] - c[1]]);
            let expected = (u[0] * v[1] - u[1] * v[0]).signum() as i8;
            let float = |p: [i128; 2]| DVec2::from_array(p.map(|x| x as f64));
            let sign = orient2d(float([a[0], a[1]]), float([b[0], b[1]]), float(c));
            assert_eq!(sign, Some(expected), "{a:?} {b:?} {c:?}");
        }
    }
}
