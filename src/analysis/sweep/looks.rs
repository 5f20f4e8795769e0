//! The comparisons of all receivers under one map: what each tap compares, and how errors are named.

use super::tally::{Curve, Kind, SHARE, Tally};
use crate::analysis::classify::{self, Artifact, StoredCaster};
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
    /// Whose surface is stored.
    pub caster: StoredCaster,
    /// Whether the depth read is the one drawn, up to two codes of 8 bits.
    pub sound: bool,
    /// Window depth that the caster was moved away from the light.
    pub gained: f64,
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
    /// Window depth to its first occluder.
    pub gap: f64,
    /// Way inside its true shadow, world units.
    pub inside: f64,
    /// Whether the receiver's move alone has made it lit.
    pub moved_into_light: bool,
}

/// The kind of a false shadow by a tap that holds `caster`.
pub(super) fn shadow_kind(caster: StoredCaster, sound: bool) -> Kind {
    match classify::false_shadow(caster, sound) {
        Artifact::Acne => Kind::Acne,
        Artifact::EncodingFault => Kind::EncodingFault,
        _ => Kind::EdgeShadow,
    }
}

/// The kind of a false light; `hidden` where the bias alone loses the occluder.
pub(super) fn light_kind(caster: StoredCaster, hidden: bool) -> Kind {
    match classify::false_light(caster, hidden) {
        Artifact::PeterPanning => Kind::PeterPanning,
        Artifact::EdgeAliasing => Kind::EdgeLight,
        _ => Kind::LightLeak,
    }
}

impl Looks {
    /// The literal verdict at one bias, by the case's own f32 rule: what went wrong, if anything.
    #[must_use]
    pub fn verdict(&self, rule: CompareRule, bias: f32) -> (Option<Kind>, i64) {
        let is_lit = |look: &Look| rule.is_lit(look.z, look.stored, bias);
        let wrong = |look: &Look| is_lit(look) != self.lit;
        let weight: i64 = self.taps.iter().filter(|l| wrong(l)).map(|l| l.share).sum();
        let centre = self.taps.get(self.centre).filter(|l| wrong(l));
        let Some(look) = centre.or_else(|| self.taps.iter().find(|l| wrong(l))) else {
            let lost = self.taps.is_empty() && !self.lit;
            return (lost.then_some(Kind::LightLeak), if lost { SHARE as i64 } else { 0 });
        };
        let hidden = self.moved_into_light || f64::from(bias) + look.gained >= self.gap;
        let kind = if self.lit {
            shadow_kind(look.caster, look.sound)
        } else {
            light_kind(look.caster, hidden)
        };
        (Some(kind), weight)
    }

    /// Adds the literal verdict to a tally.
    pub fn tally(&self, rule: CompareRule, bias: f32, tally: &mut Tally) {
        let (kind, weight) = self.verdict(rule, bias);
        if let Some(kind) = kind {
            tally.kinds[kind as usize] += 1;
        }
        *(if self.lit { &mut tally.shadow } else { &mut tally.light }) += weight;
    }

    /// Adds the breakpoints of this receiver to a curve, `bias` being the tap bias at an amount
    /// (monotone in it) and `scale` its rough slope, which only speeds the search up.
    fn break_down(
        &self,
        rule: CompareRule,
        bias: &impl Fn(f32) -> f32,
        scale: f32,
        curve: &mut Curve,
    ) {
        if self.taps.is_empty() {
            if !self.lit {
                curve.count(Kind::LightLeak, f32::NEG_INFINITY, f32::INFINITY);
            }
            return;
        }
        if self.lit && self.taps.iter().all(|look| rule.is_lit(look.z, look.stored, bias(0.0))) {
            return;
        }
        let first_lit = |look: &Look| {
            let guess = rule.turning_point(look.z, look.stored) / scale;
            breakpoint_where(guess, |a| rule.is_lit(look.z, look.stored, bias(a)))
        };
        let breakpoints: Few<f32> = self.taps.iter().map(first_lit).collect();
        for (look, &b) in self.taps.iter().zip(&breakpoints) {
            curve.lights(self.lit, b, look.share);
        }
        if self.lit {
            self.darkness(&breakpoints, curve);
        } else {
            self.brightness(&breakpoints, bias, scale, curve);
        }
        self.bounds(&breakpoints, curve);
    }

    /// Where a truly lit receiver is dark: the centre tap decides up to its breakpoint, then the first
    /// tap in order that is still dark.
    fn darkness(&self, breakpoints: &[f32], curve: &mut Curve) {
        let mut until = breakpoints[self.centre];
        let dark = |look: &Look| shadow_kind(look.caster, look.sound);
        curve.count(dark(&self.taps[self.centre]), f32::NEG_INFINITY, until);
        for (look, &b) in self.taps.iter().zip(breakpoints) {
            curve.count(dark(look), until, b);
            until = until.max(b);
        }
    }

    /// Where a truly shadowed receiver is lit: the centre tap decides from its breakpoint on, below it
    /// the first tap in order that is already lit.
    fn brightness(
        &self,
        breakpoints: &[f32],
        bias: &impl Fn(f32) -> f32,
        scale: f32,
        curve: &mut Curve,
    ) {
        let mut known = None;
        let mut lit = |look: &Look, from: f32, until: f32| {
            if look.caster != StoredCaster::Occluder {
                return curve.count(light_kind(look.caster, false), from, until);
            }
            let hides = match known {
                Some((gained, hides)) if gained == look.gained => hides,
                _ => self.hides(look.gained, bias, scale),
            };
            known = Some((look.gained, hides));
            curve.count(Kind::LightLeak, from, until.min(hides));
            curve.count(Kind::PeterPanning, from.max(hides), until);
            if from.max(hides) < until {
                curve.panned(from.max(hides), self.inside);
            }
        };
        let mut until = breakpoints[self.centre];
        lit(&self.taps[self.centre], until, f32::INFINITY);
        for (look, &b) in self.taps.iter().zip(breakpoints) {
            lit(look, b, until);
            until = until.min(b);
        }
    }

    /// The amount from which the bias alone loses the occluder, under a caster moved by `gained`.
    fn hides(&self, gained: f64, bias: &impl Fn(f32) -> f32, scale: f32) -> f32 {
        if self.moved_into_light {
            return f32::NEG_INFINITY;
        }
        let guess = (self.gap - gained) as f32 / scale;
        breakpoint_where(guess, |a| f64::from(bias(a)) + gained >= self.gap)
    }

    fn bounds(&self, breakpoints: &[f32], curve: &mut Curve) {
        let own = self.taps.iter().all(|l| l.caster == StoredCaster::Own);
        if self.lit && own {
            let last = breakpoints.iter().copied().fold(f32::NEG_INFINITY, f32::max);
            curve.critical = Some(curve.critical.map_or(last, |b| b.max(last)));
        } else if !self.lit && self.taps[self.centre].caster == StoredCaster::Occluder {
            let first = breakpoints.iter().copied().fold(f32::INFINITY, f32::min);
            curve.detachment = Some(curve.detachment.map_or(first, |b| b.min(first)));
        }
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

/// The counts at every amount over receivers given with their index, `bias(i, a)` being the tap bias of
/// receiver i at amount a (monotone in a) and `scale(i)` its rough slope.
#[must_use]
pub fn curve<'l>(
    looks: impl Iterator<Item = (usize, &'l Looks)>,
    rule: CompareRule,
    bias: impl Fn(usize, f32) -> f32,
    scale: impl Fn(usize) -> f32,
) -> Curve {
    let mut curve = Curve::default();
    for (i, look) in looks {
        look.break_down(rule, &|a| bias(i, a), scale(i), &mut curve);
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
