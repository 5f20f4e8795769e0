//! What each receiver of a chart reads: the texels of its taps, and their slots.

use crate::raster::Slots;
use crate::shadow::{Footprint, Footprints};
use rayon::prelude::*;
use std::ops::Range;

/// The taps of every receiver and their slots.
#[derive(Debug)]
pub(super) struct Reads {
    footprints: Footprints,
    /// The slot of each tap.
    slots: Vec<u32>,
    /// The four slots that each receiver mixes, where they are mixed.
    mixed: Vec<[u32; 4]>,
}

/// The texels that footprints read.
pub(super) fn wanted_texels(footprints: &Footprints) -> impl ParallelIterator<Item = u32> {
    let taps = footprints.texels().par_iter().with_min_len(1 << 12).copied();
    taps.chain(footprints.mixed().par_iter().flat_map_iter(|mix| mix.texels))
}

impl Reads {
    pub(super) fn new(footprints: Footprints, slots: &Slots) -> Self {
        let slot = |&texel: &u32| slots.slot(texel) as u32;
        let taps = footprints.texels().par_iter().with_min_len(1 << 12).map(slot).collect();
        let mixed = footprints.mixed().iter().map(|mix| mix.texels.map(|t| slot(&t))).collect();
        Self { footprints, slots: taps, mixed }
    }

    /// The footprint of a receiver, without offsets.
    pub(super) fn footprint(&self, receiver: usize) -> Footprint<'_> {
        self.footprints.get(receiver)
    }

    /// Where the taps of a receiver lie in a list over all taps.
    #[inline]
    pub(super) fn range(&self, receiver: usize) -> Range<usize> {
        self.footprints.range(receiver)
    }

    /// Taps of each receiver where all have as many.
    pub(super) fn each(&self) -> Option<usize> {
        self.footprints.each()
    }

    /// Whether taps are mixed before they are compared.
    pub(super) fn are_mixed(&self) -> bool {
        !self.mixed.is_empty()
    }

    /// How many taps there are.
    pub(super) fn taps(&self) -> usize {
        self.slots.len()
    }

    /// The slot of each tap of all receivers.
    pub(super) fn all_slots(&self) -> &[u32] {
        &self.slots
    }

    /// The slots of a receiver's taps.
    #[inline]
    pub(super) fn slots(&self, receiver: usize) -> &[u32] {
        &self.slots[self.range(receiver)]
    }

    /// The slots that a receiver mixes.
    pub(super) fn mixed(&self, receiver: usize) -> Option<&[u32; 4]> {
        self.mixed.get(receiver)
    }

    /// The slots that some receivers read, each once, and the place of each of `count` slots in that list.
    pub(super) fn by(&self, which: &[u32], count: usize) -> (Vec<u32>, Vec<u32>) {
        let (mut read, mut place) = (Vec::new(), vec![0; count]);
        let all = |&receiver: &u32| {
            let receiver = receiver as usize;
            self.slots(receiver).iter().chain(self.mixed(receiver).into_iter().flatten())
        };
        for &slot in which.iter().flat_map(all) {
            let known = read.get(place[slot as usize] as usize) == Some(&slot);
            if !known {
                place[slot as usize] = read.len() as u32;
                read.push(slot);
            }
        }
        (read, place)
    }
}
