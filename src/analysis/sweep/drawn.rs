//! What a pass drew on a chart's texels, and where the values of a texel lie.

use crate::raster::{NO_TRIANGLE, Slots};
use crate::scene::TexelFormat;
use crate::shadow::Stored;
use std::borrow::Cow;
use std::sync::Arc;

/// What a pass has drawn, place by place.
#[derive(Debug)]
pub(super) struct Drawn<'d> {
    /// Compared depths; the cleared one where nothing is.
    pub(super) depth: Cow<'d, [f32]>,
    /// Triangles, or [`NO_TRIANGLE`].
    pub(super) triangle: Cow<'d, [u32]>,
}

impl Drawn<'_> {
    pub(super) fn at(&self, place: usize) -> Option<f32> {
        (self.triangle[place] != NO_TRIANGLE).then(|| self.depth[place])
    }
}

/// Where the values of a texel lie.
#[derive(Debug)]
pub(super) enum Places<'p> {
    /// At its own index.
    Texels,
    /// At its slot.
    Slots(&'p Slots),
    /// At the place of its slot, which has one where somebody reads it.
    Read { slots: &'p Slots, place: Vec<u32> },
}

impl Places<'_> {
    pub(super) fn of(&self, texel: u32) -> usize {
        match self {
            Self::Texels => texel as usize,
            Self::Slots(slots) => slots.slot(texel),
            Self::Read { slots, place } => place[slots.slot(texel)] as usize,
        }
    }

    /// The place of the texel at a slot.
    #[inline]
    pub(super) fn of_slot(&self, slot: u32) -> usize {
        match self {
            Self::Read { place, .. } => place[slot as usize] as usize,
            Self::Texels | Self::Slots(_) => slot as usize,
        }
    }
}

/// A map without a bias that has been stored: its format, whether place by texel.
pub(super) type Known = ((TexelFormat, bool), Arc<Stored>);
