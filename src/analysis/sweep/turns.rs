//! One receiver along all amounts of a bias: which tap decides where, and what its error is called.

use super::curve::Curve;
use super::looks::{light_kind, shadow_kind};
use super::tally::{Kind, SHARE};
use crate::analysis::classify::StoredCaster;

/// What the taps of a receiver hold, asked only where a verdict turns on it.
pub(super) trait Held {
    /// Whose surface a tap holds.
    fn caster(&self, tap: usize) -> StoredCaster;
    /// Whether the depth read there is the one drawn.
    fn is_sound(&self, tap: usize) -> bool;
    /// Its share of the visibility in 2⁻⁴⁰.
    fn share(&self, tap: usize) -> i64;
    /// The amount from which the bias alone loses the occluder that it holds.
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

impl<H: Held> Turns<'_, H> {
    /// Adds this receiver to a curve.
    #[inline(always)]
    pub(super) fn count(&self, curve: &mut Curve) {
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

    fn count_unlooked(&self, curve: &mut Curve) {
        if !self.lit {
            curve.lights(false, f32::NEG_INFINITY, || SHARE as i64);
            curve.count(Kind::LightLeak, f32::NEG_INFINITY, f32::INFINITY);
        }
    }

    /// Where a truly lit receiver is dark: the centre tap decides up to its breakpoint, then the first
    /// tap in order that is still dark.
    #[inline(always)]
    fn count_darkness(&self, curve: &mut Curve) {
        let kind = |tap: usize| shadow_kind(self.held.caster(tap), self.held.is_sound(tap));
        let mut until = self.breakpoints[self.centre];
        curve.count(kind(self.centre), f32::NEG_INFINITY, until);
        for (tap, &b) in self.breakpoints.iter().enumerate() {
            if b > until {
                curve.count(kind(tap), until, b);
                until = b;
            }
        }
        if (0..self.breakpoints.len()).all(|tap| self.held.caster(tap) == StoredCaster::Own) {
            curve.needs(until);
        }
    }

    /// Where a truly shadowed receiver is lit: the centre tap decides from its breakpoint on, below it
    /// the first tap in order that is already lit.
    #[inline(always)]
    fn count_brightness(&self, curve: &mut Curve) {
        let mut until = self.breakpoints[self.centre];
        self.count_lit(self.centre, until, f32::INFINITY, curve);
        for (tap, &b) in self.breakpoints.iter().enumerate() {
            if b < until {
                self.count_lit(tap, b, until, curve);
                until = b;
            }
        }
    }

    /// A truly shadowed receiver that one tap lights on [from, until).
    #[inline(always)]
    fn count_lit(&self, tap: usize, from: f32, until: f32, curve: &mut Curve) {
        let caster = self.held.caster(tap);
        if caster != StoredCaster::Occluder {
            return curve.count(light_kind(caster, false), from, until);
        }
        let hides = self.held.hides(tap);
        let pans = from.max(hides);
        curve.count(Kind::LightLeak, from, until.min(hides));
        curve.count(Kind::PeterPanning, pans, until);
        if pans < until {
            curve.panned(pans, self.inside);
        }
    }
}
