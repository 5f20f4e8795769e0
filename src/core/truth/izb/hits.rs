//! Hits that are certain but for their order, and what they say about the ends of their segments.

use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

use rayon::prelude::*;

/// A triangle between a receiver and the light, for certain.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hit {
    /// The place of the receiver.
    pub(super) place: u32,
    pub(super) triangle: u32,
    /// Its depth lies between these; between the infinities where its order is not judged by depth.
    pub(super) depths: [f32; 2],
}

/// Depth bounds of the hits so far, by place: that of the one nearest to the receiver is at most the
/// first, that of the one nearest to the light at least the second. Threads may overwrite a better
/// bound by a weaker one; both hold, and no answer depends on them.
#[derive(Debug)]
pub(super) struct Known {
    bounds: Vec<[AtomicU32; 2]>,
}

impl Known {
    /// No hit at any of so many places.
    pub(super) fn new(len: usize) -> Self {
        let lit = |_| [f32::INFINITY, f32::NEG_INFINITY].map(|x| AtomicU32::new(x.to_bits()));
        let mut bounds = Vec::new();
        let places = (0..len).into_par_iter().with_min_len(1 << 16);
        places.map(lit).collect_into_vec(&mut bounds);
        Self { bounds }
    }

    #[inline(always)]
    fn get(&self, place: u32) -> [f32; 2] {
        let [near, far] = &self.bounds[place as usize];
        [f32::from_bits(near.load(Relaxed)), f32::from_bits(far.load(Relaxed))]
    }

    /// Whether others are certain to be nearer to both ends.
    #[inline(always)]
    pub(super) fn surround(&self, hit: &Hit) -> bool {
        let [near, far] = self.get(hit.place);
        (hit.depths[0] > near) & (hit.depths[1] < far)
    }

    /// Adds a hit.
    pub(super) fn tighten(&self, hit: &Hit) {
        let [near, far] = self.get(hit.place);
        let bounds = &self.bounds[hit.place as usize];
        bounds[0].store(near.min(hit.depths[1]).to_bits(), Relaxed);
        bounds[1].store(far.max(hit.depths[0]).to_bits(), Relaxed);
    }
}

/// The hits of a chunk that may be at an end of their segment.
#[derive(Debug)]
pub(super) struct Hits {
    list: Vec<Hit>,
    /// Looked through again when there are so many.
    limit: usize,
}

impl Default for Hits {
    fn default() -> Self {
        Self { list: Vec::new(), limit: 1 << 14 }
    }
}

impl Hits {
    /// Adds a hit. Where many have come together, those that others surround by now are dropped, if
    /// anything is known.
    pub(super) fn push(&mut self, hit: Hit, known: Option<&Known>) {
        if let (true, Some(known)) = (self.list.len() >= self.limit, known) {
            self.list.retain(|hit| !known.surround(hit));
            self.limit = (2 * self.list.len()).max(1 << 14);
        }
        self.list.push(hit);
    }

    pub(super) fn len(&self) -> usize {
        self.list.len()
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = &Hit> {
        self.list.iter()
    }
}
