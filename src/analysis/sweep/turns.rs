//! One receiver along all amounts of a bias: which tap decides where, and what its error is called.

use super::curve::SweptCurve;
use super::tally::Kind;
use crate::analysis::classify::StoredCaster;
use crate::analysis::verdict::{Held, WHOLE, spans};

/// What a receiver's taps hold, along all amounts of a bias.
pub(super) trait Along: Held {
    /// The amount from which the bias alone loses the occluder that a tap holds.
    fn hides(&self, tap: usize) -> f32;
}

/// A receiver with the amount from which each of its taps is lit.
pub(super) struct Turns<'t, H> {
    /// Whether it is truly lit.
    pub(super) lit: bool,
    /// Way inside its true shadow, world units.
    pub(super) inside: f64,
    /// The tap in the middle.
    pub(super) centre: usize,
    /// Where each tap turns; empty where the range test lights the receiver without a look-up.
    pub(super) breakpoints: &'t [f32],
    /// What they hold.
    pub(super) held: H,
}

impl<H: Along> Turns<'_, H> {
    /// Adds this receiver to a curve.
    #[inline(always)]
    pub(super) fn count(&self, curve: &mut SweptCurve) {
        if self.breakpoints.is_empty() {
            return self.count_unlooked(curve);
        }
        if self.lit && self.breakpoints.iter().all(|&b| b <= 0.0) {
            return;
        }
        for (tap, &b) in self.breakpoints.iter().enumerate() {
            curve.lights(self.lit, b, || self.held.share(tap));
        }
        if self.lit { self.count_darkness(curve) } else { self.count_brightness(curve) }
    }

    fn count_unlooked(&self, curve: &mut SweptCurve) {
        if !self.lit {
            curve.lights(false, f32::NEG_INFINITY, || WHOLE);
            curve.count(Kind::LIGHT_LEAK, f32::NEG_INFINITY, f32::INFINITY);
        }
    }

    /// Where a truly lit receiver is dark.
    #[inline(always)]
    fn count_darkness(&self, curve: &mut SweptCurve) {
        let kind = |tap: usize| Kind::false_shadow(self.held.caster(tap), self.held.is_sound(tap));
        let until = spans(true, self.centre, self.breakpoints, |tap, from, until| {
            curve.count(kind(tap), from, until);
        });
        if (0..self.breakpoints.len()).all(|tap| self.held.caster(tap) == StoredCaster::Own) {
            curve.needs(until);
        }
    }

    /// Where a truly shadowed receiver is lit.
    #[inline(always)]
    fn count_brightness(&self, curve: &mut SweptCurve) {
        spans(false, self.centre, self.breakpoints, |tap, from, until| {
            self.count_lit(tap, from, until, curve);
        });
    }

    /// A truly shadowed receiver that one tap lights on [from, until).
    #[inline(always)]
    fn count_lit(&self, tap: usize, from: f32, until: f32, curve: &mut SweptCurve) {
        let caster = self.held.caster(tap);
        if caster != StoredCaster::Occluder {
            return curve.count(Kind::false_light(caster, false), from, until);
        }
        let hides = self.held.hides(tap);
        let pans = from.max(hides);
        curve.count(Kind::LIGHT_LEAK, from, until.min(hides));
        curve.count(Kind::PETER_PANNING, pans, until);
        if pans < until {
            curve.panned(pans, self.inside);
        }
    }
}
