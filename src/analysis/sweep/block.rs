//! The comparisons of some receivers, side by side for the vectors.

use super::chart::Chart;
use super::reading::compared;
use super::store::Store;
use crate::shadow::bias::Follow;
use crate::shadow::margins::Margins;
use crate::shadow::{self, Footprints};
use std::ops::Range;
use std::slice;

/// Receivers that are looked at together: their comparisons stay in a core's cache.
pub(super) const RECEIVERS: usize = 1 << 12;

/// Where comparisons come from.
pub(super) struct Source<'s> {
    pub(super) chart: &'s Chart<'s, 's>,
    pub(super) store: &'s Store<'s>,
    pub(super) follow: Follow,
}

/// Comparisons of receivers that look from where they are: 12 bytes each.
#[derive(Default)]
pub(super) struct Block {
    /// Whether each receiver has exactly one.
    single: bool,
    /// Else where those of each begin; one more at the end.
    starts: Vec<u32>,
    z: Vec<f32>,
    stored: Vec<f32>,
    weight: Vec<f32>,
}

impl Block {
    /// Reads what the receivers of `which` compare; `weight` gives the bias of each per amount.
    pub(super) fn read(
        &mut self,
        source: &Source<'_>,
        which: &[u32],
        weight: impl Fn(usize) -> f32,
    ) {
        self.starts.clear();
        self.z.clear();
        self.stored.clear();
        self.weight.clear();
        let Source { chart, store, follow } = source;
        let (z, tested) = (&chart.field.receivers.z, chart.field.case().lookup.range_test);
        self.single = chart.taps_each() == Some(1) && *follow == Follow::Receiver && !tested;
        if !self.single {
            return self.read_taps(source, which, weight);
        }
        self.z.extend(which.iter().map(|&i| z[i as usize]));
        self.weight.extend(which.iter().map(|&i| weight(i as usize)));
        chart.only_depths(store, which, &mut self.stored);
    }

    fn read_taps(&mut self, source: &Source<'_>, which: &[u32], weight: impl Fn(usize) -> f32) {
        let Source { chart, store, follow } = source;
        let mut footprints = Footprints::new(chart.sampling, true);
        let tested = chart.field.case().lookup.range_test;
        for &i in which {
            let (i, start) = (i as usize, self.stored.len());
            let [u, v, z] = chart.field.receivers.coord(i);
            self.starts.push(start as u32);
            if tested && !shadow::in_square([u, v, z]) {
                continue;
            }
            match chart.reads.mixed(i) {
                Some(_) => self.stored.push(chart.mixed_depth(store, i)),
                None => self.stored.extend(chart.reads.slots(i).iter().map(|&s| store.at_slot(s))),
            }
            let end = self.stored.len();
            self.weight.resize(end, weight(i));
            if *follow == Follow::Receiver {
                self.z.resize(end, z);
            } else {
                let sample = &chart.field.samples[i];
                let rect = chart.layout.rect(sample.map);
                let footprint = footprints.only(rect, [u, v], sample.pixel);
                let tap = |tap: usize| compared(*follow, sample, z, &footprint, tap);
                self.z.extend((0..end - start).map(tap));
            }
        }
        self.starts.push(self.stored.len() as u32);
    }

    /// The comparisons of all of them, under biases of at most `bound`.
    pub(super) fn margins(&self, bound: f32) -> Margins<'_> {
        Margins { z: &self.z, stored: &self.stored, weight: &self.weight, bound }
    }

    /// How many comparisons there are.
    pub(super) fn len(&self) -> usize {
        self.stored.len()
    }

    /// The entries of a list over the comparisons that belong to the receiver at a place; none where the range test
    /// lights it without a look-up.
    #[inline(always)]
    pub(super) fn of<'l, T>(&self, place: usize, all: &'l [T]) -> &'l [T] {
        match self.single {
            true => slice::from_ref(&all[place]),
            false => &all[self.range(place)],
        }
    }

    /// Where the comparisons of the receiver at a place of the list lie.
    fn range(&self, place: usize) -> Range<usize> {
        self.starts[place] as usize..self.starts[place + 1] as usize
    }
}

impl Chart<'_, '_> {
    /// Comparisons of each receiver, where all have as many.
    pub(super) fn taps_each(&self) -> Option<usize> {
        if self.reads.are_mixed() { Some(1) } else { self.reads.each() }
    }

    /// What receivers with a single comparison find in the map.
    fn only_depths(&self, store: &Store<'_>, which: &[u32], out: &mut Vec<f32>) {
        if self.reads.are_mixed() {
            return out.extend(which.iter().map(|&i| self.mixed_depth(store, i as usize)));
        }
        let slots = self.reads.all_slots();
        out.extend(which.iter().map(|&i| store.at_slot(slots[i as usize])));
    }

    /// What a receiver finds whose texels are mixed.
    pub(super) fn mixed_depth(&self, store: &Store<'_>, i: usize) -> f32 {
        match (self.reads.mixed(i), self.reads.footprint(i).mixed) {
            (Some(slots), Some(mixed)) => store.mixed(slots, mixed.weights),
            _ => unreachable!("its texels are mixed"),
        }
    }
}
