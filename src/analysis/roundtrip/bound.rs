//! Proved bounds of the round-trip error, to stand beside the measured ones.
//!
//! **Digits in a dot product.** Write the pack as channels vᵢ with real weights wᵢ, Σ wᵢvᵢ = z: the
//! masks telescope, since wᵢ₊₁ = wᵢ/B and each vᵢ loses vᵢ₊₁/B. The store changes vᵢ by εᵢ, hence
//! |decoded − z| ≤ Σ wᵢ·sup|εᵢ|. A masked channel holds one of the B values k·s (s = 1/256 or 1/255),
//! so sup|εᵢ| is the greatest of B numbers, enumerated here; the last channel holds anything, so its
//! sup is half a byte (a whole one truncated, 0.6 under D3D's tolerance).
//!
//! **f32.** Base 256 packs exactly. Base 255 rounds each vᵢ's digits: fl(Bⁱz) errs by 2⁻²⁵Bⁱ, which
//! puts vᵢ₋₁ off its grid by at most (2⁻²⁵ + 2⁻²⁵)·Bⁱ⁻¹; weighed, at most 2⁻²⁴ for each of the three
//! masked channels. A truncating store may lose a whole step at each. The dot product adds three
//! roundings of sums below 1 and one of each weighed channel: at most 2⁻²³ together.

use crate::depth::{Arithmetic, ByteRounding, ByteStore, Packing};
use crate::num::exp2;
use serde::Serialize;

/// A bound of |decoded − z| for 0 ≤ z < 1, and why it holds.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Bound {
    /// The bound, window depth.
    pub value: f64,
    /// The argument in a few words.
    pub because: String,
}

/// How a packing lays its digits out.
struct Layout {
    /// Ratio of neighbouring weights.
    base: f64,
    /// The value of digit k in a masked channel is k·step.
    step: f64,
    /// Masked channels before the last.
    masked: i32,
    /// Weight of the last channel.
    last_weight: f64,
    /// Most that the last channel loses by saturating at 1.
    last_excess: f64,
    /// Weight of the first channel.
    first_weight: f64,
    /// Bound of the f32 rounding in pack and unpack.
    rounding: f64,
}

/// The bound for a packing where one is known; reciprocal or exact sampler (an ulp apart, inside the
/// f32 term).
#[must_use]
pub fn bound(packing: Packing, store: ByteStore, arithmetic: Arithmetic) -> Option<Bound> {
    if arithmetic == Arithmetic::Fp16 {
        return None;
    }
    let real = arithmetic == Arithmetic::Real;
    if let Some(bits) = digit_bits(packing) {
        return Some(integer_digits(bits, real));
    }
    let layout = layout(packing)?;
    let terms = layout.terms(store, real, 0..=layout.base as u32 - 1);
    let because = format!(
        "stored digits {:.3e}, last channel {:.3e}, arithmetic {:.3e}",
        terms.digits, terms.last, terms.rounding
    );
    Some(Bound { value: terms.digits + terms.last + terms.rounding, because })
}

/// The bound over the depths from `from` to `to` alone: the leading digit is one of a few.
#[must_use]
pub fn bound_at(
    packing: Packing,
    store: ByteStore,
    arithmetic: Arithmetic,
    from: f64,
    to: f64,
) -> Option<f64> {
    let Some(layout) = layout(packing).filter(|_| arithmetic != Arithmetic::Fp16) else {
        return bound(packing, store, arithmetic).map(|b| b.value);
    };
    // f32 may put a depth next to a digit's edge on either side of it.
    let digit = |z: f64| (z * layout.base).floor().clamp(0.0, layout.base - 1.0) as u32;
    let leading = digit(from - 1e-6)..=digit(to + 1e-6);
    let terms = layout.terms(store, arithmetic == Arithmetic::Real, leading);
    Some(terms.digits + terms.last + terms.rounding)
}

/// The parts of a bound.
struct Terms {
    digits: f64,
    last: f64,
    rounding: f64,
}

impl Layout {
    fn terms(&self, store: ByteStore, real: bool, leading: std::ops::RangeInclusive<u32>) -> Terms {
        let all = 0..=self.base as u32 - 1;
        let channel = |i: i32| {
            let digits = if i == 0 { leading.clone() } else { all.clone() };
            self.first_weight / power(self.base, i) * grid_error(self, store, digits)
        };
        Terms {
            digits: (0..self.masked).map(channel).sum(),
            last: self.last_weight * loose_error(store).max(self.last_excess),
            rounding: if real { exp2(-48) } else { self.rounding },
        }
    }
}

fn power(base: f64, n: i32) -> f64 {
    (0..n).fold(1.0, |product, _| product * base)
}

/// Greatest error, over these digits, of storing k·step and reading k'/255. Where f32 may fall
/// short of a byte's exact value a truncating store loses the whole byte.
fn grid_error(layout: &Layout, store: ByteStore, digits: std::ops::RangeInclusive<u32>) -> f64 {
    let exact_bytes = layout.step * 255.0 == 1.0;
    if exact_bytes && store == ByteStore::Truncate {
        return 1.0 / 255.0;
    }
    let error = |k: u32| {
        let value = f64::from(k) * layout.step;
        let stored = |rounding: &ByteRounding| match *rounding {
            ByteRounding::Even => (value * 255.0).round_ties_even(),
            ByteRounding::Floor { half } => (value * 255.0 + half).floor(),
        };
        let distance = |byte: f64| (byte / 255.0 - value).abs();
        store.roundings().iter().map(|r| distance(stored(r))).fold(0.0, f64::max)
    };
    digits.map(error).fold(0.0, f64::max)
}

/// Greatest error of storing any value of [0, 1].
fn loose_error(store: ByteStore) -> f64 {
    match store {
        ByteStore::HalfEven | ByteStore::HalfUp => 0.5 / 255.0,
        ByteStore::Truncate => 1.0 / 255.0,
        ByteStore::Admissible => 0.6 / 255.0,
    }
}

fn digit_bits(packing: Packing) -> Option<u32> {
    match packing {
        Packing::Digits16 => Some(16),
        Packing::Digits24 => Some(24),
        Packing::Digits32 => Some(32),
        _ => None,
    }
}

/// K = round(z·M) errs by half a code in real numbers. In f32 the product with M = 2ⁿ − 1 rounds by
/// at most a quarter code more (half an ulp below 2²³; above, it is an integer already), 2³² scales
/// exactly, and the decoded quotient rounds once more by 2⁻²⁵. Every byte is exact under every store.
fn integer_digits(bits: u32, real: bool) -> Bound {
    let max = exp2(bits as i32) - 1.0;
    let (codes, quotient) = match (real, bits) {
        (true, _) => (0.5, exp2(-54)),
        (false, 32) => (0.5 + exp2(-24), 0.0),
        (false, _) => (0.75, exp2(-25)),
    };
    let because = format!("{codes} codes of 1/(2^{bits} − 1), quotient {quotient:.3e}");
    Bound { value: codes / max * (1.0 + exp2(-32)) + quotient, because }
}

fn layout(packing: Packing) -> Option<Layout> {
    let dot = exp2(-23);
    let family = |base: f64, step: f64, masked: i32, rounding: f64| Layout {
        base,
        step,
        masked,
        first_weight: 1.0,
        last_weight: 1.0 / power(base, masked),
        last_excess: 0.0,
        rounding,
    };
    let stretched = |channels: i32| Layout {
        first_weight: 255.0 / 256.0,
        ..family(256.0, 1.0 / 255.0, channels - 1, dot)
    };
    Some(match packing {
        // The store's own f32: 255x and the sum with 0.6 round by 2⁻¹⁷ of a byte each.
        Packing::R8 => family(255.0, 1.0 / 255.0, 0, exp2(-23)),
        Packing::Book | Packing::Upc | Packing::Ozone3d | Packing::Godot2 | Packing::Mapbox256 => {
            family(256.0, 1.0 / 256.0, 3, dot)
        }
        Packing::Aras2009
        | Packing::Cesium
        | Packing::Babylon
        | Packing::Godot3
        | Packing::Mapbox255 => family(255.0, 1.0 / 255.0, 3, dot + 3.0 * exp2(-24)),
        Packing::UnityRg | Packing::ThreeHalf => family(255.0, 1.0 / 255.0, 1, dot + exp2(-24)),
        Packing::ThreeR86 => Layout {
            // The last remainder is stretched too, to 256/255 at most, and clamped to 1.
            last_weight: 255.0 / 256.0 / exp2(24),
            last_excess: 1.0 / 255.0,
            ..stretched(4)
        },
        Packing::ThreeRgba => stretched(4),
        Packing::ThreeRgb => stretched(3),
        Packing::ThreeRg => stretched(2),
        _ => return None,
    })
}
