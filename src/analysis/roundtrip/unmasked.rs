//! Bounds for packings whose channels keep the digits after their own, or decode other digits.
//!
//! **Unmasked.** The channels are cᵢ = fract(Bⁱz) + h, weighed by B⁻ⁱ. Where the leading digit of z is m,
//! z = (m + fract(Bz))/B, and what the second channel carries cancels against the first one's tail:
//! decoded − z = ĉ₀ − m/B + (ĉ₁ − fract(Bz))/B + ĉ₂/B² + ĉ₃/B³. On the piece of a digit the first term
//! lies between its values at the ends, because store and sampler are monotone; the second is h and what
//! the store may do to any value (a channel above 1 is clamped, which takes back h at most); the others
//! lie in [0, 1]. The bound is the worst of the B pieces.
//!
//! **Mismatched.** Channels that are weighed by other powers than those they were cut by say nothing
//! of z: what is decoded lies between 0 and the sum of the weights.

use super::conditions::Texels;
use super::proof::Bound;
use crate::depth::Packing;
use crate::num::exp2;

/// The bound of a packing of either kind.
pub(super) fn bound(packing: Packing, texels: &Texels) -> Option<Bound> {
    // fl(255z) errs by 2⁻²⁵·255, half a step added to a channel by 2⁻²⁵.
    let half_step = || pieces(texels, 255, 0.5 / 255.0, exp2(-25) * (1.0 + 1.0 / 64.0));
    let whole = || pieces(texels, 256, 0.0, 0.0);
    let bounds: [(Packing, &dyn Fn() -> Bound); 3] = [
        (Packing::Aras200703, &whole),
        (Packing::Aras2007, &half_step),
        (Packing::Forge, &mismatched),
    ];
    bounds.into_iter().find(|(of, _)| *of == packing).map(|(_, bound)| bound())
}

/// Roundings of the weighted sum in f32, the greatest term first.
const SUMS: f64 = exp2(-23);

fn pieces(texels: &Texels, base: u32, offset: f64, pack: f64) -> Bound {
    let b = f64::from(base);
    let first = |z: f64| texels.sampled(texels.rounded(texels.rounded(z) + offset));
    let (mut above, mut below) = (0.0f64, 0.0f64);
    for m in 0..base {
        let digit = f64::from(m) / b;
        let (low, high) = (just_below(texels, digit), just_below(texels, f64::from(m + 1) / b));
        above = above.max(first(high) - digit);
        below = below.min(first(low) - digit);
    }
    let rounding = if texels.real { exp2(-48) } else { pack + SUMS };
    let loose = texels.loose_error();
    let rest = 1.0 / (b * b) + 1.0 / (b * b * b);
    let above = above + (offset + loose) / b + rest;
    let below = -below + loose / b;
    let because = format!(
        "leading digits {above:.3e} up, {below:.3e} down, what follows included, arithmetic {rounding:.3e}"
    );
    Bound { value: f64::max(above, below) + rounding, because }
}

/// The last depth below `z` that the arithmetic holds (0 for 0): f32 may put it on the far side of a
/// digit's edge.
fn just_below(texels: &Texels, z: f64) -> f64 {
    if z == 0.0 {
        return 0.0;
    }
    if texels.real {
        return z.next_down();
    }
    let nearest = z as f32;
    f64::from(if f64::from(nearest) < z { nearest } else { nearest.next_down() })
}

fn mismatched() -> Bound {
    let weights = 1.0 + exp2(-8) + exp2(-16) + exp2(-24);
    let because = "the weights' sum: the digits decoded are not those of the depth".to_string();
    Bound { value: weights + SUMS, because }
}
