//! Proved bounds of the round-trip error, to stand beside the measured ones.
//!
//! **Digits.** Write the pack as channels vᵢ with real weights wᵢ, Σ wᵢvᵢ = z: the masks telescope,
//! since wᵢ₊₁ = wᵢ/B and each vᵢ loses vᵢ₊₁/B. A masked channel holds one of a few digits, so what
//! store and sampler make of it is found by trying them all, in the arithmetic at hand: the greatest
//! and the least of decoded − digit, weighed and summed. The last channel holds anything and errs by
//! at most what the store and the sampler can do to any value.
//!
//! **f32.** Base 256 packs exactly. In base 255, fl(255ⁱz) errs by 2⁻²⁵·255ⁱ·(1 + 2⁻⁶) at most; the
//! masks pass each such error on to the next channel with the opposite sign, and a store that rounds
//! puts every masked channel back on its grid, so that the last one's alone remains (that rounding
//! never carries one digit without the next is what the exhaustive runs check). A store that
//! truncates may lose a whole step of each. Sums below 1 round by 2⁻²⁵, the one sum that may reach 1
//! by 2⁻²⁴; sums of small terms by 2⁻³² at most.
//!
//! **Where the partial sums are exact** (stretched digits that come back as multiples of 1/256) the
//! only rounding is the last. It goes to the float nearest to the sum s, and z is a float, so
//! |fl(s) − s| ≤ |z − s| and |fl(s) − z| ≤ 2|s − z|.

use super::conditions::{Conditions, Texels, paths};
use super::layout::{Layout, Sums, layout};
pub use super::proof::Bound;
use super::unmasked;
use crate::depth::{Arithmetic, DepthFormat, FormatTrip, Packing, UnormLoad, UnormStore};
use crate::num::exp2;
use std::ops::RangeInclusive;

/// The bound for a packing where one is known. None for half-precision arithmetic, nor where a byte
/// of an integer does not come back.
#[must_use]
pub fn bound(packing: Packing, conditions: Conditions) -> Option<Bound> {
    if conditions.arithmetic == Arithmetic::Fp16 {
        return None;
    }
    let worst = |bound: &dyn Fn(Texels) -> Option<Bound>| -> Option<Bound> {
        let bounds: Option<Vec<Bound>> = paths(conditions).map(bound).collect();
        bounds?.into_iter().reduce(|a, b| if b.value > a.value { b } else { a })
    };
    if let Some(bits) = digit_bits(packing) {
        return worst(&|texels| texels.keep_bytes().then(|| integer_digits(bits, texels.real)));
    }
    if packing == Packing::PlaycanvasBits {
        let because = "every byte comes back".to_string();
        return worst(&|texels| {
            texels.truncate_back().then(|| Bound { value: 0.0, because: because.clone() })
        });
    }
    match layout(packing) {
        Some(layout) => worst(&|texels| Some(layout.terms(&texels, layout.all_digits()).bound())),
        None => worst(&|texels| unmasked::bound(packing, &texels)),
    }
}

/// The bound over the depths from `from` to `to` alone: the leading digit is one of a few.
#[must_use]
pub fn bound_at(packing: Packing, conditions: Conditions, from: f64, to: f64) -> Option<f64> {
    let Some(layout) = layout(packing).filter(|_| conditions.arithmetic != Arithmetic::Fp16) else {
        return bound(packing, conditions).map(|b| b.value);
    };
    // f32 may put a depth next to a digit's edge on either side of it.
    let last = layout.digits - 1;
    let digit = |z: f64| (z * layout.leading).floor().clamp(0.0, f64::from(last)) as u32;
    let leading = digit(from - 1e-6)..=digit(to + 1e-6);
    let value = |texels: Texels| layout.terms(&texels, leading.clone()).bound().value;
    paths(conditions).map(value).reduce(f64::max)
}

/// The bound of a depth format that stores to nearest and is read back exactly: half a step (and
/// 2⁻²¹ of one, which the product with 2³² − 1 rounds in f64). `None` for f32, which loses nothing.
#[must_use]
pub fn format_bound(trip: FormatTrip) -> Option<Bound> {
    if trip.store != UnormStore::Exact || trip.load != UnormLoad::Divide {
        return None;
    }
    let (step, of) = match (trip.format, trip.format.unorm_max()) {
        (_, Some(max)) => (1.0 / f64::from(max), ""),
        (DepthFormat::F32, None) => return None,
        (format, None) => (format.quantum(0.5), " in [1/2, 1)"),
    };
    Some(Bound { value: (0.5 + exp2(-21)) * step, because: format!("half a step{of}") })
}

/// The parts of a bound.
struct Terms {
    digits: f64,
    last: f64,
    rounding: f64,
}

impl Terms {
    fn bound(&self) -> Bound {
        let Self { digits, last, rounding } = self;
        let because = format!(
            "stored digits {digits:.3e}, last channel {last:.3e}, arithmetic {rounding:.3e}"
        );
        Bound { value: digits + last + rounding, because }
    }
}

impl Layout {
    fn all_digits(&self) -> RangeInclusive<u32> {
        0..=self.digits - 1
    }

    fn terms(&self, texels: &Texels, leading: RangeInclusive<u32>) -> Terms {
        let (mut above, mut below, mut weight) = (0.0, 0.0, 1.0);
        for i in 0..self.masked {
            let digits = if i == 0 { leading.clone() } else { self.all_digits() };
            let (up, down) = self.digit.extremes(texels, i == 0, digits);
            above += weight * up;
            below += weight * down;
            weight /= self.base;
        }
        let digits = f64::max(above, below);
        let last = self.last_weight * (self.last)(texels.loose_error());
        let rounding = match (texels.real, self.sums) {
            (true, _) => exp2(-48),
            (false, Sums::Rounded(sums)) => self.pack + sums,
            (false, Sums::Exact { partial }) if digits == 0.0 => {
                partial + f64::min(last + partial, exp2(-25))
            }
            (false, Sums::Exact { .. }) => exp2(-23),
        };
        Terms { digits, last, rounding }
    }
}

fn digit_bits(packing: Packing) -> Option<u32> {
    let digits = [(Packing::Digits16, 16), (Packing::Digits24, 24), (Packing::Digits32, 32)];
    digits.into_iter().find(|(of, _)| *of == packing).map(|(_, bits)| bits)
}

/// K = round(z·M) errs by half a code in real numbers. In f32 the product with M = 2ⁿ − 1 rounds by
/// at most 2⁻⁹ of a code more for 16 bits and a quarter for 24 (from 2²³ on it is an integer already);
/// 2³² scales exactly. The decoded quotient rounds once more by 2⁻²⁵. Every byte is exact.
fn integer_digits(bits: u32, real: bool) -> Bound {
    let max = exp2(bits as i32) - 1.0;
    let (codes, quotient) = match (real, bits) {
        (true, _) => (0.5, exp2(-54)),
        (false, 32) => (0.5 + exp2(-24), 0.0),
        (false, 16) => (0.5 + exp2(-9), exp2(-25)),
        (false, _) => (0.75, exp2(-25)),
    };
    let because = format!("{codes} codes of 1/(2^{bits} − 1), quotient {quotient:.3e}");
    Bound { value: codes / max * (1.0 + exp2(-32)) + quotient, because }
}
