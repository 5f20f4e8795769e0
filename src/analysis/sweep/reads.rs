//! What each receiver of a chart reads: its taps, and the slots of the chart's fragments under them.

use crate::raster::Fragments;
use crate::shadow::{Footprint, Footprints};

/// The taps of every receiver and their slots.
#[derive(Debug)]
pub(super) struct Reads {
    footprints: Footprints,
    /// The slot of each tap.
    slots: Vec<u32>,
    /// The four slots that each receiver mixes, where they are mixed.
    mixed: Vec<[u32; 4]>,
}

/// The texels that footprints read, in their order.
pub(super) fn wanted_texels(footprints: &Footprints) -> impl Iterator<Item = u32> {
    let taps = footprints.taps().iter().map(|tap| tap.texel);
    taps.chain(footprints.mixed().iter().flat_map(|mix| mix.texels))
}

impl Reads {
    pub(super) fn new(footprints: Footprints, fragments: &Fragments) -> Self {
        let slot = |texel: u32| fragments.slot(texel) as u32;
        let slots = footprints.taps().iter().map(|tap| slot(tap.texel)).collect();
        let mixed = footprints.mixed().iter().map(|mix| mix.texels.map(slot)).collect();
        Self { footprints, slots, mixed }
    }

    /// The texels that are read.
    pub(super) fn texels(&self) -> impl Iterator<Item = u32> {
        wanted_texels(&self.footprints)
    }

    /// The footprint of a receiver.
    pub(super) fn footprint(&self, receiver: usize) -> Footprint<'_> {
        self.footprints.get(receiver)
    }

    /// Of a list over all taps, those of a receiver.
    pub(super) fn of<'l, T>(&self, receiver: usize, all: &'l [T]) -> &'l [T] {
        &all[self.footprints.range(receiver)]
    }

    /// The slots of a receiver's taps.
    pub(super) fn slots(&self, receiver: usize) -> &[u32] {
        self.of(receiver, &self.slots)
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
