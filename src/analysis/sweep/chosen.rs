//! Receivers that choose among several maps: every comparison is made literally, map by map.

use super::chart::Chart;
use super::looks::{Look, Looks};
use super::reading::{Glance, unlooked};
use super::receivers::Sample;
use super::store::Store;
use super::wrong::Wrong;
use crate::analysis::classify::StoredCaster;
use crate::light::Lookup;
use crate::scene::TexelFormat;
use crate::shadow::bias::Recipe;
use crate::shadow::{self, Few, Footprints};
use glam::DVec3;
use rayon::prelude::*;

impl Chart<'_, '_> {
    /// All comparisons of all receivers on maps drawn and stored under a recipe. A move comes before the
    /// choice.
    pub(super) fn looks_chosen(&self, store: &Store<'_>, recipe: &Recipe) -> Vec<Looks> {
        let rule = self.field.case().lookup.compare;
        let one = |(i, sample): (usize, &Sample)| {
            if !recipe.moves_receiver() {
                return self.chosen(store, recipe, sample, &sample.lookups);
            }
            let offset: DVec3 = recipe.receiver_offset(&self.site(i));
            let lookups = self.field.lookups_from(sample, offset);
            let mut looks = self.chosen(store, recipe, sample, &lookups);
            let lit = |l: &Look| rule.is_lit(l.z, l.stored, 0.0);
            looks.moved_into_light =
                !sample.lit && looks.taps.iter().any(lit) && self.field.is_lit_from(sample, offset);
            looks
        };
        self.field.samples.par_iter().enumerate().map(one).collect()
    }

    /// The comparisons of one receiver at its look-ups.
    fn chosen(
        &self,
        store: &Store<'_>,
        recipe: &Recipe,
        sample: &Sample,
        lookups: &[Lookup],
    ) -> Looks {
        let outside =
            |l: &Lookup| self.field.case().lookup.range_test && !shadow::in_square(l.coord);
        match lookups {
            [] => unlooked(sample),
            [only] if outside(only) => unlooked(sample),
            [only] => self.in_one_map(store, recipe, sample, only).0,
            [first, second, ..] => {
                let both = [first, second].map(|lookup| {
                    let (mut looks, shares) = self.in_one_map(store, recipe, sample, lookup);
                    if outside(lookup) {
                        looks.taps.iter_mut().for_each(|tap| tap.z = f32::NEG_INFINITY);
                    }
                    (looks, shares, lookup.weight)
                });
                mixed(both)
            }
        }
    }

    /// The comparisons in one map, and the share of each.
    fn in_one_map(
        &self,
        store: &Store<'_>,
        recipe: &Recipe,
        sample: &Sample,
        lookup: &Lookup,
    ) -> (Looks, Vec<f64>) {
        let Lookup { map, coord, .. } = *lookup;
        let there = match map == sample.map {
            true => sample.clone(),
            false => self.field.in_map(sample, map),
        };
        let mut footprints = Footprints::new(self.sampling, true);
        let footprint = footprints.only(self.layout.rect(map), [coord[0], coord[1]], sample.pixel);
        let surface = |_: usize, texel: u32| -> (StoredCaster, f64) {
            let place = store.places.of(texel);
            let triangle = store.drawn.triangle[place];
            let own = self.layout.compared(self.raster.depth[texel as usize]);
            let gained = store.drawn.depth[place] - own;
            (self.field.caster(&there, triangle, texel, &self.layout), f64::from(gained))
        };
        let at = Glance { sample: &there, coord, footprint };
        let looks = self.comparisons(store, recipe, &at, &surface);
        let shares = (0..looks.taps.len()).map(|i| at.footprint.share(i)).collect();
        (looks, shares)
    }

    /// The receivers of `which` that are wrong under a recipe, in that order.
    pub(super) fn wrong_chosen(
        &self,
        format: TexelFormat,
        recipe: &Recipe,
        which: &[u32],
    ) -> Vec<Wrong> {
        let (looks, rule) = (self.looks(format, recipe), self.field.case().lookup.compare);
        let wrong = |&receiver: &u32| {
            let i = receiver as usize;
            let bias = |look: &Look| self.tap_bias(recipe, format, i, look.map);
            let (kind, share) = looks[i].verdict_by(rule, bias);
            kind.map(|kind| Wrong { receiver, kind, share })
        };
        which.iter().filter_map(wrong).collect()
    }
}

/// The comparisons of two maps, each by its weight; the heaviest names an error first.
fn mixed([a, b]: [(Looks, Vec<f64>, f64); 2]) -> Looks {
    let weigh = |(looks, shares, weight): (Looks, Vec<f64>, f64)| {
        let taps = looks.taps.iter().map(|tap| (tap.share, *tap)).collect::<Vec<_>>();
        let weighed = taps.into_iter().zip(shares).map(move |((share, tap), part)| {
            (Look { share: (share as f64 * weight) as i64, ..tap }, part * weight)
        });
        (Looks { taps: Few::default(), ..looks }, weighed.collect::<Vec<_>>())
    };
    let ((base, mut taps), (_, others)) = (weigh(a), weigh(b));
    taps.extend(others);
    let heavier = |best: usize, i: usize| if taps[i].1 > taps[best].1 { i } else { best };
    let centre = (0..taps.len()).fold(0, heavier);
    Looks { taps: taps.into_iter().map(|(tap, _)| tap).collect(), centre, ..base }
}
