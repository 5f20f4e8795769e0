//! The curve of a tap bias over all receivers of a chart: their breakpoints, many at a time.

use super::block::{Block, RECEIVERS};
use super::chart::Chart;
use super::curve::Curve;
use super::maps::Surface;
use super::reading::{SOUND, is_sound, mixed_tap};
use super::store::Store;
use super::tally::SHARE;
use super::taps::Taps;
use super::turns::{Held, Turns};
use crate::analysis::classify::StoredCaster;
use crate::scene::TexelFormat;
use crate::shadow::bias::{Recipe, Strategy};
use crate::shadow::margins::reaching;
use crate::shadow::{Footprint, breakpoint_where};
use crate::simd::Level;
use rayon::prelude::*;

impl Chart<'_, '_> {
    /// The exact curve of a strategy with a bias of the taps: that of [`Self::looks`], none of which is kept.
    pub(super) fn curve(&self, texel: TexelFormat, strategy: Strategy, taps: &Taps) -> Curve {
        let (all, recipe) = (self.all(), strategy.with(0.0));
        self.with_maps(&[texel], &recipe, &all, |stores, surface| {
            let run = Run { chart: self, store: &stores[0], surface, recipe: &recipe, taps };
            let of = |which: &[u32]| run.curve(which).thinned();
            let curves: Vec<Curve> = all.par_chunks(RECEIVERS).map(of).collect();
            curves.iter().fold(run.nothing(), Curve::joined).sorted()
        })
    }
}

/// A format and a bias on a chart.
struct Run<'r> {
    chart: &'r Chart<'r, 'r>,
    store: &'r Store<'r>,
    surface: &'r Surface<'r>,
    recipe: &'r Recipe,
    taps: &'r Taps,
}

impl Run<'_> {
    fn nothing(&self) -> Curve {
        Curve::new(self.chart.taps_each() == Some(1))
    }

    /// The curve of some receivers, not sorted.
    fn curve(&self, which: &[u32]) -> Curve {
        let Self { chart, store, recipe, taps, .. } = *self;
        let receivers = &chart.field.receivers;
        let (level, bound, mut block) = (Level::best(), taps.bound(), Block::default());
        let weight = |i: usize| taps.weight(i);
        block.read(chart, store, which, recipe.follow, weight);
        let mut turns = vec![0.0; block.len()];
        let rule = chart.field.case().lookup.compare;
        block.margins(bound).breakpoints(level, rule, &mut turns);
        // Nobody asks for those of the lit: any gap whose neighbours are quick to multiply will do.
        let gap = |i: usize| if receivers.lit[i] { 1.0 } else { receivers.gap[i] };
        let gaps: Vec<f64> = which.iter().map(|&i| gap(i as usize)).collect();
        let weights: Vec<f32> = which.iter().map(|&i| weight(i as usize)).collect();
        let mut hides = vec![0.0; which.len()];
        reaching(level, &gaps, &weights, bound, &mut hides);
        let (each, mut curve) = (chart.taps_each(), self.nothing());
        for (place, (&receiver, &hides)) in which.iter().zip(&hides).enumerate() {
            let held = Here { run: self, receiver: receiver as usize, hides };
            match each {
                _ if chart.is_unlooked(receivers.coord(held.receiver)) => {
                    held.count(0, &[], &mut curve)
                }
                Some(1) => held.count(0, std::slice::from_ref(&turns[place]), &mut curve),
                _ => held.count(held.centre(), &turns[block.range(place)], &mut curve),
            }
        }
        curve
    }
}

/// What a receiver reads where it is.
#[derive(Clone, Copy)]
struct Here<'h> {
    run: &'h Run<'h>,
    receiver: usize,
    hides: f32,
}

impl Here<'_> {
    /// Adds the receiver to a curve.
    #[inline(always)]
    fn count(self, centre: usize, breakpoints: &[f32], curve: &mut Curve) {
        let receivers = &self.run.chart.field.receivers;
        let (lit, inside) = (receivers.lit[self.receiver], receivers.inside[self.receiver]);
        Turns { lit, inside, centre, breakpoints, held: self }.count(curve);
    }

    fn footprint(&self) -> Footprint<'_> {
        self.run.chart.reads.footprint(self.receiver)
    }

    fn centre(&self) -> usize {
        self.footprint().centre()
    }

    /// Whose surface a tap holds in a map that the recipe has changed, and how far it was moved.
    fn surface(&self, tap: usize) -> (StoredCaster, f64) {
        (self.run.surface)(self.receiver, tap, self.footprint().texels[tap])
    }

    /// The tap whose texel a comparison rests on.
    fn deciding(&self, comparison: usize) -> usize {
        let Run { chart, store, .. } = self.run;
        if !chart.reads.are_mixed() {
            return comparison;
        }
        let slots = chart.reads.slots(self.receiver);
        mixed_tap(chart.field.receivers.lit[self.receiver], |tap| store.at_slot(slots[tap]))
    }
}

impl Held for Here<'_> {
    fn caster(&self, comparison: usize) -> StoredCaster {
        let (Run { chart, recipe, .. }, tap) = (self.run, self.deciding(comparison));
        match recipe.changes_map() {
            true => self.surface(tap).0,
            false => chart.own_caster(self.receiver, tap),
        }
    }

    fn is_sound(&self, comparison: usize) -> bool {
        let Run { chart, store, .. } = self.run;
        // Where nothing was drawn, the caster says so.
        if store.error() <= SOUND {
            return true;
        }
        let slot = chart.reads.slots(self.receiver)[self.deciding(comparison)];
        is_sound(store.drawn.at(slot as usize), store.at_slot(slot))
    }

    fn share(&self, comparison: usize) -> i64 {
        (self.footprint().share(comparison) * SHARE) as i64
    }

    fn hides(&self, comparison: usize) -> f32 {
        let Run { chart, recipe, taps, .. } = self.run;
        if !recipe.changes_map() {
            return self.hides;
        }
        let gained = self.surface(self.deciding(comparison)).1;
        let gap = chart.field.receivers.gap[self.receiver];
        let guess = (gap - gained) as f32 / taps.scale(self.receiver);
        breakpoint_where(guess, |a| f64::from(taps.bias(self.receiver, a)) + gained >= gap)
    }
}
