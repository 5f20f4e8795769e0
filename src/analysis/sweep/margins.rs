//! The curve of a tap bias over all receivers of a chart: their breakpoints, many at a time.

use super::block::{Block, RECEIVERS, Source};
use super::chart::Chart;
use super::curve::SweptCurve;
use super::maps::Surface;
use super::store::Store;
use super::tally::SHARE;
use super::taps::Taps;
use super::turns::{Along, Turns};
use crate::analysis::classify::StoredCaster;
use crate::analysis::verdict::{Held, SURELY_SOUND, deciding_in_a_mix};
use crate::scene::TexelFormat;
use crate::shadow::bias::{Follow, Strategy};
use crate::shadow::margins::reaching;
use crate::shadow::{Footprint, breakpoint_where};
use crate::simd::Level;
use rayon::prelude::*;
use std::slice;

impl Chart<'_, '_> {
    /// The exact curve of a strategy with a bias of the taps: that of [`Self::looks`], none of which is kept.
    pub(super) fn curve(&self, texel: TexelFormat, strategy: Strategy, taps: &Taps) -> SweptCurve {
        let (all, recipe) = (self.all(), strategy.with(0.0));
        self.with_maps(&[texel], &recipe, &all, |stores, surface| {
            let moved = recipe.changes_map().then_some(surface);
            let run = Run { chart: self, store: &stores[0], moved, follow: recipe.follow, taps };
            let of = |which: &[u32]| run.curve(which).thinned();
            let curves: Vec<SweptCurve> = all.par_chunks(RECEIVERS).map(of).collect();
            curves.iter().fold(run.nothing(), SweptCurve::joined).sorted()
        })
    }
}

/// A format and a bias on a chart.
struct Run<'r> {
    chart: &'r Chart<'r, 'r>,
    store: &'r Store<'r>,
    /// The owner of the surface that a tap holds, where the recipe changes the map.
    moved: Option<&'r Surface<'r>>,
    follow: Follow,
    taps: &'r Taps,
}

impl Run<'_> {
    fn nothing(&self) -> SweptCurve {
        SweptCurve::new(self.chart.taps_each() == Some(1))
    }

    /// The curve of some receivers, not sorted.
    fn curve(&self, which: &[u32]) -> SweptCurve {
        let Self { chart, store, follow, taps, .. } = *self;
        let receivers = &chart.field.receivers;
        let (level, bound, mut block) = (Level::best(), taps.bound(), Block::default());
        let weight = |i: usize| taps.weight(i);
        block.read(&Source { chart, store, follow }, which, weight);
        let mut turns = vec![0.0; block.len()];
        let rule = chart.field.case().lookup.compare;
        block.margins(bound).breakpoints(level, rule, &mut turns);
        // Gaps of lit receivers are never asked for: any number whose neighbours are quick to multiply will do.
        let gap = |i: usize| if receivers.lit[i] { 1.0 } else { receivers.gap[i] };
        let gaps: Vec<f64> = which.iter().map(|&i| gap(i as usize)).collect();
        let weights: Vec<f32> = which.iter().map(|&i| weight(i as usize)).collect();
        let mut hides = vec![0.0; which.len()];
        reaching(level, &gaps, &weights, bound, &mut hides);
        let mut curve = self.nothing();
        for (place, (&receiver, &hides)) in which.iter().zip(&hides).enumerate() {
            let held = Here { run: self, receiver: receiver as usize, hides };
            // Compiled for one comparison and for any number.
            match block.of(place, &turns) {
                [only] => held.count(slice::from_ref(only), &mut curve),
                several => held.count(several, &mut curve),
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
    fn count(self, breakpoints: &[f32], curve: &mut SweptCurve) {
        let receivers = &self.run.chart.field.receivers;
        let (lit, inside) = (receivers.lit[self.receiver], receivers.inside[self.receiver]);
        let centre = if breakpoints.len() == 1 { 0 } else { self.footprint().centre() };
        Turns { lit, inside, centre, breakpoints, held: self }.count(curve);
    }

    fn footprint(&self) -> Footprint<'_> {
        self.run.chart.reads.footprint(self.receiver)
    }

    /// The owner of the surface that a tap holds, and how far it was moved.
    #[inline(never)]
    fn ask(&self, surface: &Surface<'_>, tap: usize) -> (StoredCaster, f64) {
        surface(self.receiver, tap, self.footprint().texels[tap])
    }

    /// The tap whose texel a comparison rests on.
    #[inline(always)]
    fn deciding(&self, comparison: usize) -> usize {
        let Run { chart, store, .. } = self.run;
        if !chart.reads.are_mixed() {
            return comparison;
        }
        let slots = chart.reads.slots(self.receiver);
        let lit = chart.field.receivers.lit[self.receiver];
        deciding_in_a_mix(lit, slots.len(), |tap| store.at_slot(slots[tap]))
    }
}

impl Held for Here<'_> {
    #[inline(always)]
    fn caster(&self, comparison: usize) -> StoredCaster {
        let (Run { chart, moved, .. }, tap) = (self.run, self.deciding(comparison));
        match moved {
            Some(surface) => self.ask(*surface, tap).0,
            None => chart.own_caster(self.receiver, tap),
        }
    }

    #[inline(always)]
    fn is_sound(&self, comparison: usize) -> bool {
        let Run { chart, store, .. } = self.run;
        // Where nothing was drawn, the caster says so.
        if store.error() <= SURELY_SOUND {
            return true;
        }
        let slot = chart.reads.slots(self.receiver)[self.deciding(comparison)];
        store.is_sound(store.drawn.at(slot as usize), store.at_slot(slot))
    }

    fn share(&self, comparison: usize) -> i64 {
        (self.footprint().share(comparison) * SHARE) as i64
    }
}

impl Along for Here<'_> {
    #[inline(always)]
    fn hides(&self, comparison: usize) -> f32 {
        let Run { chart, moved, taps, .. } = self.run;
        let Some(surface) = moved else { return self.hides };
        let gained = self.ask(*surface, self.deciding(comparison)).1;
        let gap = chart.field.receivers.gap[self.receiver];
        let guess = (gap - gained) as f32 / taps.scale(self.receiver);
        breakpoint_where(guess, |a| f64::from(taps.bias(self.receiver, a)) + gained >= gap)
    }
}
