//! The comparisons of all receivers under one map: what each tap compares, and how errors are named.

use super::curve::SweptCurve;
use super::tally::{Kind, SHARE, Tally};
use super::turns::{Along, Turns};
use crate::analysis::classify::StoredCaster;
use crate::analysis::verdict::Held;
use crate::scene::CompareRule;
use crate::shadow::{Few, breakpoint_where};
use rayon::prelude::*;

/// One comparison: receiver depth against stored depth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Look {
    /// Receiver depth as compared (negated under reversed depth).
    pub z: f32,
    /// Stored depth as read (negated under reversed depth).
    pub stored: f32,
    /// Share of the visibility in 2⁻⁴⁰.
    pub share: i64,
    /// The owner of the stored surface.
    pub caster: StoredCaster,
    /// Whether the depth read is the one drawn: [`crate::analysis::verdict::is_sound`].
    pub sound: bool,
    /// Window depth that the caster was moved away from the light.
    pub gained: f64,
    /// The map that it reads.
    pub map: usize,
    /// Depth in that map from the receiver's first occluder to itself.
    pub gap: f64,
}

/// All comparisons of one receiver.
#[derive(Clone, Debug, Default)]
pub struct Looks {
    /// In the filter's order; empty where the range test lights the receiver without a look-up.
    pub taps: Few<Look>,
    /// The tap in the middle.
    pub centre: usize,
    /// Whether the receiver is truly lit.
    pub lit: bool,
    /// Way inside its true shadow, world units.
    pub inside: f64,
    /// Whether the receiver's move alone has made it lit.
    pub moved_into_light: bool,
}

impl Looks {
    /// The literal verdict at one bias, by the case's own f32 rule: what went wrong, if anything. It is
    /// the arbiter of [`crate::analysis::verdict`] and says by itself which tap decides.
    #[must_use]
    pub fn verdict(&self, rule: CompareRule, bias: f32) -> (Option<Kind>, i64) {
        self.verdict_by(rule, |_| bias)
    }

    /// This answer where each tap has a bias of its own.
    #[must_use]
    pub fn verdict_by(
        &self,
        rule: CompareRule,
        bias: impl Fn(&Look) -> f32,
    ) -> (Option<Kind>, i64) {
        let is_lit = |look: &Look| rule.is_lit(look.z, look.stored, bias(look));
        let wrong = |look: &Look| is_lit(look) != self.lit;
        let weight: i64 = self.taps.iter().filter(|l| wrong(l)).map(|l| l.share).sum();
        let centre = self.taps.get(self.centre).filter(|l| wrong(l));
        let Some(look) = centre.or_else(|| self.taps.iter().find(|l| wrong(l))) else {
            let lost = self.taps.is_empty() && !self.lit;
            return (lost.then_some(Kind::LIGHT_LEAK), if lost { SHARE as i64 } else { 0 });
        };
        let hidden = self.moved_into_light || f64::from(bias(look)) + look.gained >= look.gap;
        let kind = if self.lit {
            Kind::false_shadow(look.caster, look.sound)
        } else {
            Kind::false_light(look.caster, hidden)
        };
        (Some(kind), weight)
    }

    /// Adds the literal verdict to a tally.
    pub fn tally(&self, rule: CompareRule, bias: f32, tally: &mut Tally) {
        self.tally_by(rule, |_| bias, tally);
    }

    /// This answer where each tap has a bias of its own.
    pub fn tally_by(&self, rule: CompareRule, bias: impl Fn(&Look) -> f32, tally: &mut Tally) {
        let (kind, weight) = self.verdict_by(rule, bias);
        if let Some(kind) = kind {
            tally.kinds[kind.index()] += 1;
        }
        *(if self.lit { &mut tally.shadow } else { &mut tally.light }) += weight;
    }

    /// Adds the breakpoints of this receiver to a curve, `bias` being the tap bias in a map at an amount
    /// (monotone in it) and `scale` its rough slope, which only speeds the search up.
    fn break_down(
        &self,
        rule: CompareRule,
        bias: &impl Fn(usize, f32) -> f32,
        scale: f32,
        curve: &mut SweptCurve,
    ) {
        let first_lit = |look: &Look| {
            let guess = rule.turning_point(look.z, look.stored) / scale;
            breakpoint_where(guess, |a| rule.is_lit(look.z, look.stored, bias(look.map, a)))
        };
        let breakpoints: Few<f32> = self.taps.iter().map(first_lit).collect();
        let Self { lit, inside, centre, .. } = *self;
        let held = Kept { looks: self, bias, scale };
        Turns { lit, inside, centre, breakpoints: &breakpoints, held }.count(curve);
    }
}

/// Comparisons that are kept, under a bias.
struct Kept<'l, B> {
    looks: &'l Looks,
    bias: &'l B,
    scale: f32,
}

impl<B: Fn(usize, f32) -> f32> Held for Kept<'_, B> {
    fn caster(&self, tap: usize) -> StoredCaster {
        self.looks.taps[tap].caster
    }

    fn is_sound(&self, tap: usize) -> bool {
        self.looks.taps[tap].sound
    }

    fn share(&self, tap: usize) -> i64 {
        self.looks.taps[tap].share
    }
}

impl<B: Fn(usize, f32) -> f32> Along for Kept<'_, B> {
    fn hides(&self, tap: usize) -> f32 {
        if self.looks.moved_into_light {
            return f32::NEG_INFINITY;
        }
        let Look { gap, gained, map, .. } = self.looks.taps[tap];
        let guess = (gap - gained) as f32 / self.scale;
        breakpoint_where(guess, |a| f64::from((self.bias)(map, a)) + gained >= gap)
    }
}

/// The literal counts at one recipe: every receiver's own bias.
#[must_use]
pub fn literal(looks: &[Looks], rule: CompareRule, bias: impl Fn(usize) -> f32) -> Tally {
    let mut tally = Tally::default();
    for (i, look) in looks.iter().enumerate() {
        look.tally(rule, bias(i), &mut tally);
    }
    tally
}

/// The counts at every amount over receivers given with their index, `bias(i, map, a)` being the tap bias
/// of receiver i in a map at amount a (monotone in a) and `scale(i)` its rough slope.
#[must_use]
pub fn curve<'l>(
    looks: impl Iterator<Item = (usize, &'l Looks)>,
    rule: CompareRule,
    bias: impl Fn(usize, usize, f32) -> f32,
    scale: impl Fn(usize) -> f32,
) -> SweptCurve {
    let mut curve = SweptCurve::new(false);
    for (i, look) in looks {
        look.break_down(rule, &|map, a| bias(i, map, a), scale(i), &mut curve);
    }
    curve.sorted()
}

/// The literal counts at many recipes, in parallel: the arbiter, and what a sweep would cost without
/// breakpoints.
#[must_use]
pub fn literal_all(
    looks: &[Looks],
    rule: CompareRule,
    amounts: &[f32],
    bias: impl Fn(usize, f32) -> f32 + Sync,
) -> Vec<Tally> {
    amounts.par_iter().map(|&a| literal(looks, rule, |i| bias(i, a))).collect()
}
