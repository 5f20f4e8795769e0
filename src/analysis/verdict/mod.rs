//! One verdict: which part of a look-up decides, what the error is called, how much of it is wrong.
//!
//! The observer, the sweeps and the pages ask here; captured maps go by way of the observer. Only
//! [`super::sweep::looks::Looks::verdict`] says the same in other words: it is slow, literal, and the
//! arbiter in tests.

pub mod counted;
mod order;

use super::classify::{Kind, StoredCaster};
pub use order::{deciding, deciding_in_a_mix, order, spans};

/// Two codes of one 8-bit channel, window depth: what even the coarsest sound store keeps of a depth.
pub const SOUND: f64 = 2.0 / 255.0;

/// [`SOUND`], rounded down: a store that errs by no more is sound wherever something is drawn.
pub const SURELY_SOUND: f32 = (SOUND as f32).next_down();

/// Whether a texel decodes to the depth that it was drawn with, up to [`SOUND`]; not where nothing was
/// drawn. Depths beyond 0 and 1 count as these.
#[must_use]
#[inline]
pub fn is_sound(drawn: Option<f32>, read: f32) -> bool {
    drawn.is_some_and(|z| (f64::from(read) - f64::from(z.clamp(0.0, 1.0))).abs() <= SOUND)
}

/// Shares of visibility are summed as integers of 2⁻⁴⁰, so that sums do not depend on their order.
pub const SHARE: f64 = 1_099_511_627_776.0;

/// All of a look-up's visibility.
pub const WHOLE: i64 = SHARE as i64;

/// What a look-up of one receiver read, part by part: taps that are compared, or one part whose visibility
/// has a closed form (moments). Questions are asked only where a verdict turns on the answer.
pub trait Held {
    /// Whose surface a part rests on.
    fn caster(&self, part: usize) -> StoredCaster;
    /// Whether the depth that it read is the one drawn: [`is_sound`].
    fn is_sound(&self, part: usize) -> bool;
    /// The share of a part in the whole, in 2⁻⁴⁰.
    fn share(&self, part: usize) -> i64;
}

/// A look-up at one bias.
pub trait LookUp: Held {
    /// How many parts there are; none where a range test lights the receiver without a look-up.
    fn parts(&self) -> usize;
    /// The part in the middle, which names an error before all others.
    fn centre(&self) -> usize;
    /// How much light a part lets through, from 0 to 1; of a tap 0 or 1.
    fn visibility(&self, part: usize) -> f64;
    /// Whether the bias alone hides the occluder that a part holds; asked of such parts alone.
    fn is_hidden(&self, part: usize) -> bool;
}

/// The visibility v of a look-up, from 0 to 1: the sum over its parts; 1 where there is none.
#[must_use]
pub fn visibility(look: &impl LookUp) -> f64 {
    match look.parts() {
        0 => 1.0,
        parts => (0..parts).map(|i| look.visibility(i) * look.share(i) as f64 / SHARE).sum(),
    }
}

/// A wrong verdict.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Verdict {
    /// Its side and what it is called.
    pub kind: Kind,
    /// The part that named it; `None` without a look-up.
    pub part: Option<usize>,
    /// |v − t|, in 2⁻⁴⁰.
    pub share: i64,
}

/// The wrong share of a part, in 2⁻⁴⁰; `None` where it is right. A part without a share can be wrong.
#[inline(always)]
fn wrong_share(look: &impl LookUp, part: usize, truly_lit: bool) -> Option<i64> {
    let visibility = look.visibility(part);
    let wrong = if truly_lit { 1.0 - visibility } else { visibility };
    match wrong {
        0.0 => None,
        1.0 => Some(look.share(part)),
        wrong => Some((look.share(part) as f64 * wrong) as i64),
    }
}

/// What a part's error is called.
#[must_use]
#[inline(always)]
pub fn named(look: &impl LookUp, part: usize, truly_lit: bool) -> Kind {
    let caster = look.caster(part);
    if truly_lit {
        Kind::false_shadow(caster, look.is_sound(part))
    } else {
        Kind::false_light(caster, caster == StoredCaster::Occluder && look.is_hidden(part))
    }
}

/// What is wrong about a look-up, if anything: the first wrong part in [`order`] names it.
#[must_use]
#[inline(always)]
pub fn verdict(look: &impl LookUp, truly_lit: bool) -> Option<Verdict> {
    let (parts, centre) = (look.parts(), look.centre());
    if parts == 0 {
        let lost = Verdict { kind: Kind::LIGHT_LEAK, part: None, share: WHOLE };
        return (!truly_lit).then_some(lost);
    }
    let (mut first, mut share) = (None, 0);
    for part in 0..parts {
        if let Some(wrong) = wrong_share(look, part, truly_lit) {
            first = if part == centre { Some(part) } else { first.or(Some(part)) };
            share += wrong;
        }
    }
    let part = first?;
    Some(Verdict { kind: named(look, part, truly_lit), part: Some(part), share })
}

/// Calls `book` with the kind and the wrong share of each wrong part: every share is booked to its own
/// part's artifact, so that kinds add up to |v − t|.
pub fn booked(look: &impl LookUp, truly_lit: bool, mut book: impl FnMut(Kind, i64)) {
    if look.parts() == 0 && !truly_lit {
        book(Kind::LIGHT_LEAK, WHOLE);
    }
    for part in 0..look.parts() {
        if let Some(share) = wrong_share(look, part, truly_lit) {
            book(named(look, part, truly_lit), share);
        }
    }
}
