//! The closed form beside the measurement: which share of the lit has acne on planes under NEAREST.

use super::field::{Field, Sample};

/// Largest number of receivers that the mean is taken over, evenly spread.
const MOST: usize = 4096;

/// The share of a plane's area with acne at a bias b, F(b) for the half-texel depths a ≥ c along the two
/// axes: ½ − b/(2a) up to a − c, (a + c − b)²/(8ac) up to a + c, then 0 (closed-form acne fraction of an
/// affine depth under uniform phases). b ≥ 0; a may be infinite.
fn acne_share(a: f64, c: f64, b: f64) -> f64 {
    let (a, c) = (a.max(c), a.min(c));
    if b >= a + c {
        0.0
    } else if b <= a - c || !a.is_finite() {
        0.5 - b / (2.0 * a)
    } else {
        (a + c - b) * (a + c - b) / (8.0 * a * c)
    }
}

fn half_texel(sample: &Sample, size: u32) -> [f64; 2] {
    sample.gradient.abs().to_array().map(|g| g / (2.0 * f64::from(size)))
}

/// The mean of F over the truly lit receivers at each bias (window depth): what slopes and texels alone
/// predict, each receiver on its own plane, without quantization. The depth of a plane is affine in map
/// coordinates under perspective lights too.
#[must_use]
pub(super) fn acne(field: &Field<'_>, size: u32, biases: &[f32]) -> Vec<f64> {
    let lit: Vec<&Sample> = field.samples.iter().filter(|s| s.lit).collect();
    let stride = lit.len().div_ceil(MOST).max(1);
    let halves: Vec<[f64; 2]> = lit.iter().step_by(stride).map(|s| half_texel(s, size)).collect();
    let count = halves.len().max(1) as f64;
    let at = |&b: &f32| halves.iter().map(|&[a, c]| acne_share(a, c, b.into())).sum::<f64>();
    biases.iter().map(|b| at(b) / count).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_share_is_half_without_a_bias_and_none_beyond_a_corner() {
        assert_eq!(acne_share(0.25, 0.125, 0.0), 0.5);
        assert_eq!(acne_share(0.25, 0.125, 0.125), 0.25, "the two forms meet");
        assert_eq!(acne_share(0.125, 0.25, 0.25), 0.062_5, "the axes are alike");
        assert_eq!(acne_share(0.25, 0.125, 0.375), 0.0);
        assert_eq!(acne_share(f64::INFINITY, 0.125, 1.0), 0.5, "a plane seen edge-on");
    }
}
