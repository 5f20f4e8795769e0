//! Which slots of a chart's fragments each receiver reads, one list after the other.

use crate::raster::Fragments;
use crate::shadow::Footprint;
use std::ops::Range;

/// The slots of every receiver's taps.
#[derive(Debug)]
pub(super) struct Reads {
    /// Where each receiver's slots begin; one more at the end.
    starts: Vec<u32>,
    slots: Vec<u32>,
    /// The four that each receiver mixes, where they are mixed.
    mixed: Vec<[u32; 4]>,
}

impl Reads {
    pub(super) fn new(footprints: &[Footprint], fragments: &Fragments) -> Self {
        let mut reads = Self { starts: vec![0], slots: Vec::new(), mixed: Vec::new() };
        for footprint in footprints {
            let slots = footprint.taps().iter().map(|tap| fragments.slot(tap.texel) as u32);
            reads.slots.extend(slots);
            reads.starts.push(reads.slots.len() as u32);
            reads.mixed.extend(footprint.mixed.map(|m| m.texels.map(|t| fragments.slot(t) as u32)));
        }
        reads
    }

    /// Where the taps of a receiver lie in a list over all taps.
    pub(super) fn range(&self, receiver: usize) -> Range<usize> {
        self.starts[receiver] as usize..self.starts[receiver + 1] as usize
    }

    /// The slots of a receiver's taps.
    pub(super) fn of(&self, receiver: usize) -> &[u32] {
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
            self.of(receiver).iter().chain(self.mixed(receiver).into_iter().flatten())
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
