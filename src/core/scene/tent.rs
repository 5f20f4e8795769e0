//! Weights of separable kernels along one axis: Castaño's and tents, in closed form.
//!
//! A kernel of odd width n at a coordinate covers n + 1 texels: (n − 1)/2 before the two between whose
//! centres the coordinate lies, these two, and as many after. With s in [0, 1) the share of the way from
//! the first of the two centres to the second, the weights are polynomials in s.

/// Weights of the n + 1 texels along an axis, in their order, adding up to 1; the rest are 0.
pub type AxisWeights = [f64; 8];

fn scaled<const N: usize>(weights: [f64; N], all: f64) -> AxisWeights {
    let mut out = [0.0; 8];
    out.iter_mut().zip(weights).for_each(|(out, weight)| *out = weight / all);
    out
}

/// (1 − s, 2 − s, 1 + s, s)/4: a box of 3 texels mixed with its own neighbour.
pub(super) fn castano3(s: f32) -> AxisWeights {
    let s = f64::from(s);
    scaled([1.0 - s, 2.0 - s, 1.0 + s, s], 4.0)
}

/// (1 − s, 3 − 2s, 4 − s, 3 + s, 1 + 2s, s)/12.
pub(super) fn castano5(s: f32) -> AxisWeights {
    let s = f64::from(s);
    scaled([1.0 - s, 3.0 - 2.0 * s, 4.0 - s, 3.0 + s, 1.0 + 2.0 * s, s], 12.0)
}

/// A tent of half-width h = n/2 and height h stands on the coordinate; each texel weighs as the area above
/// it, F(b) − F(a) over h², F the integral of h − |x| from the coordinate on.
fn tent<const TEXELS: usize>(s: f32) -> AxisWeights {
    let half = (TEXELS - 1) as f64 / 2.0;
    let integral = |x: f64| {
        let x = x.clamp(-half, half);
        half * x - x * x.abs() / 2.0
    };
    // The border between the two middle texels lies ½ − s after the coordinate.
    let border = |k: usize| k as f64 - (TEXELS / 2) as f64 + 0.5 - f64::from(s);
    let area = |k: usize| integral(border(k + 1)) - integral(border(k));
    scaled::<TEXELS>(std::array::from_fn(area), half * half)
}

/// A tent 3 texels wide over 4.
pub(super) fn tent3(s: f32) -> AxisWeights {
    tent::<4>(s)
}

/// A tent 5 texels wide over 6.
pub(super) fn tent5(s: f32) -> AxisWeights {
    tent::<6>(s)
}

/// A tent 7 texels wide over 8.
pub(super) fn tent7(s: f32) -> AxisWeights {
    tent::<8>(s)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Filter, FilterKernel};

    /// Weights along an axis as an engine's hardware comparisons make them: position from the first of the
    /// two middle texels' centres and weight of each; one mixes the two texels that it lies between.
    fn of_comparisons(taps: &[(f64, f64)], before: f64, texels: usize) -> Vec<f64> {
        let mut weights = vec![0.0; texels];
        let all: f64 = taps.iter().map(|tap| tap.1).sum();
        for &(position, weight) in taps {
            let from_first = position + before;
            let (low, t) = (from_first.floor(), from_first - from_first.floor());
            weights[low as usize] += weight * (1.0 - t) / all;
            if t > 0.0 {
                weights[low as usize + 1] += weight * t / all;
            }
        }
        weights
    }

    fn near(ours: AxisWeights, theirs: &[f64], what: &str) {
        for (k, &weight) in theirs.iter().enumerate() {
            assert!((ours[k] - weight).abs() < 1e-6, "{what} texel {k}: {} {weight}", ours[k]);
        }
    }

    #[test]
    fn weights_are_those_of_the_engines_own_taps() {
        for i in 0..64 {
            let s32 = i as f32 / 64.0;
            let s = f64::from(s32);
            // PlayCanvas 2.22, shadowPCF3 and shadowPCF5; u = 0 is the first middle centre, the pair before
            // it is 1 texel nearer.
            let (a, b) = (3.0 - 2.0 * s, 1.0 + 2.0 * s);
            let three = [((2.0 - s) / a - 1.0, a), (s / b + 1.0, b)];
            near(castano3(s32), &of_comparisons(&three, 1.0, 4), "castano3");
            let (a, b, c) = (4.0 - 3.0 * s, 7.0, 1.0 + 3.0 * s);
            let five = [((3.0 - 2.0 * s) / a - 2.0, a), ((3.0 + s) / b, b), (s / c + 2.0, c)];
            near(castano5(s32), &of_comparisons(&five, 2.0, 6), "castano5");
            // Unity's SampleShadow_GetTexelAreas_Tent_3x3 at the offset s − ½, over 1.5².
            let offset = s - 0.5;
            let outer = (offset + 0.5) * (offset + 0.5) / 2.0;
            let (left, right) = (offset.min(0.0), offset.max(0.0));
            let areas = [
                outer - offset,
                1.5 - offset - 0.5 - left * left,
                1.5 + offset - 0.5 - right * right,
                outer,
            ];
            near(tent3(s32), &areas.map(|area| area / 2.25), "tent3");
            // GetTexelWeights_Tent_5x5: the same areas one texel wider, 0.16 = 1/2.5².
            let uncut = [1.5 - offset - 0.5, 1.5 + offset - 0.5];
            let wide = [areas[0], uncut[0], areas[1] + 1.0, areas[2] + 1.0, uncut[1], areas[3]];
            near(tent5(s32), &wide.map(|area| area * 0.16), "tent5");
        }
    }

    #[test]
    fn weights_add_up_and_mirror() {
        for filter in
            [Filter::Castano3, Filter::Castano5, Filter::Tent3, Filter::Tent5, Filter::Tent7]
        {
            let FilterKernel::Separable { n, weights } = filter.kernel() else {
                panic!("{filter}")
            };
            let texels = n + 1;
            for i in 0..=32 {
                let s = i as f32 / 32.0;
                let (there, mirrored) = (weights(s), weights(1.0 - s));
                assert!((there.iter().sum::<f64>() - 1.0).abs() < 1e-12);
                assert!(there.iter().all(|&w| w >= -1e-16));
                for k in 0..texels {
                    assert!((there[k] - mirrored[texels - 1 - k]).abs() < 1e-12);
                }
            }
        }
    }
}
