//! A map of a chart under one format: all texels that are read, stored at once.

use super::chart::Chart;
use super::drawn::{Drawn, Places};
use crate::analysis::verdict::is_sound;
use crate::device::Device;
use crate::scene::{MapSpec, TexelFormat};
use crate::shadow::{self, Stored, Texels};
use std::sync::{Arc, PoisonError};

/// A map under one format.
pub(super) struct Store<'s> {
    pub(super) drawn: &'s Drawn<'s>,
    pub(super) places: &'s Places<'s>,
    spec: MapSpec,
    reversed: bool,
    device: Device,
    stored: Arc<Stored>,
}

impl Chart<'_, '_> {
    /// The map without a bias, stored once. The list is not locked meanwhile: storing waits for other
    /// threads, and a thread that waits may come by here again.
    pub(super) fn own_store<'s>(
        &self,
        texel: TexelFormat,
        drawn: &'s Drawn<'s>,
        places: &'s Places<'s>,
    ) -> Store<'s> {
        let key = (texel, matches!(places, Places::Texels));
        let stored = self.known(key, None).unwrap_or_else(|| {
            let new = Arc::new(self.stored(texel, drawn));
            self.known(key, Some(&new)).unwrap_or(new)
        });
        Store {
            drawn,
            places,
            spec: self.spec(texel),
            reversed: self.layout.reversed(),
            device: *self.device(),
            stored,
        }
    }

    /// A map that was stored before; else `new` is kept from now on.
    fn known(&self, key: (TexelFormat, bool), new: Option<&Arc<Stored>>) -> Option<Arc<Stored>> {
        let mut list = self.stored.lock().unwrap_or_else(PoisonError::into_inner);
        let known = list.iter().find(|(known, _)| *known == key).map(|(_, s)| s.clone());
        if let (None, Some(new)) = (&known, new) {
            list.push((key, new.clone()));
        }
        known
    }

    /// A map drawn otherwise.
    pub(super) fn other_store<'s>(
        &self,
        texel: TexelFormat,
        drawn: &'s Drawn<'s>,
        places: &'s Places<'s>,
    ) -> Store<'s> {
        let stored = Arc::new(self.stored(texel, drawn));
        Store {
            drawn,
            places,
            spec: self.spec(texel),
            reversed: self.layout.reversed(),
            device: *self.device(),
            stored,
        }
    }

    fn stored(&self, texel: TexelFormat, drawn: &Drawn<'_>) -> Stored {
        let drawn = shadow::Drawn { depth: &drawn.depth, triangle: &drawn.triangle };
        Stored::new(self.device(), &self.spec(texel), self.layout.reversed(), drawn)
    }
}

impl Store<'_> {
    /// The depth that NEAREST returns of the texel at a slot, where values lie by slot.
    pub(super) fn at_slot(&self, slot: u32) -> f32 {
        self.stored.depths[self.places.of_slot(slot)]
    }

    /// The depth that LINEAR makes of the texels at four slots.
    pub(super) fn mixed(&self, slots: &[u32; 4], weights: [f32; 2]) -> f32 {
        let TexelFormat::Packed(packing) = self.spec.texel else { return 0.0 };
        let bytes = slots.map(|slot| self.stored.bytes[self.places.of_slot(slot)]);
        let depth = shadow::mix(&self.device, packing, &bytes, weights);
        if self.reversed { -depth } else { depth }
    }

    /// Whether a depth read is the one drawn, both as compared: [`is_sound`] of their window depths.
    pub(super) fn is_sound(&self, drawn: Option<f32>, read: f32) -> bool {
        let window = |z: f32| if self.reversed { -z } else { z };
        is_sound(drawn.map(window), window(read))
    }

    /// What a texel was drawn with.
    pub(super) fn drawn(&self, texel: u32) -> Option<f32> {
        self.drawn.at(self.places.of(texel))
    }

    /// No depth differs by more than this from what was drawn, or +∞.
    pub(super) fn error(&self) -> f32 {
        self.stored.error
    }
}

impl Texels for Store<'_> {
    fn reversed(&self) -> bool {
        self.reversed
    }

    fn format(&self) -> TexelFormat {
        self.spec.texel
    }

    fn depth(&self, _: &Device, texel: usize) -> f32 {
        self.stored.depths[self.places.of(texel as u32)]
    }

    fn bytes(&self, texel: usize) -> Option<[u8; 4]> {
        self.stored.bytes.get(self.places.of(texel as u32)).copied()
    }
}
