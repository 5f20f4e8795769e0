//! Chosen texels of a map, numbered row by row.

use super::TexelSet;
use crate::light::Layout;
use rayon::prelude::*;

/// Some texels of a light's maps; each has a slot.
#[derive(Debug)]
pub struct Slots {
    layout: Layout,
    set: TexelSet,
    /// The texel of each slot.
    texels: Vec<u32>,
}

impl Slots {
    /// The texels that are wanted, in no order, each any number of times.
    #[must_use]
    pub fn of(layout: Layout, wanted: impl ParallelIterator<Item = u32>) -> Self {
        let mut set = TexelSet::new(layout.texels());
        wanted.for_each(|texel| set.insert(texel));
        set.count();
        Self { layout, texels: set.list(), set }
    }

    /// Where the maps' texels lie.
    #[must_use]
    pub const fn layout(&self) -> &Layout {
        &self.layout
    }

    /// The slot of a texel.
    ///
    /// # Panics
    /// Where the texel was not wanted.
    #[must_use]
    #[inline]
    pub fn slot(&self, texel: u32) -> usize {
        self.found(texel).expect("only texels that were wanted have a slot")
    }

    /// The slot of a texel, if it has one.
    #[must_use]
    #[inline]
    pub fn found(&self, texel: u32) -> Option<usize> {
        self.set.rank(texel)
    }

    /// The texel of a slot.
    #[must_use]
    #[inline]
    pub fn texel(&self, slot: usize) -> u32 {
        self.texels[slot]
    }

    /// Something of every texel, by slot.
    #[must_use]
    pub fn over_texels<T: Send>(&self, of: impl Fn(u32) -> T + Sync) -> Vec<T> {
        self.texels.par_iter().with_min_len(1 << 12).map(|&texel| of(texel)).collect()
    }

    /// How many there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.texels.len()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.texels.is_empty()
    }
}
