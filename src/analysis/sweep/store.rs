//! A map that is encoded texel by texel as it is read, and remembers what it has read.

use super::chart::Chart;
use crate::device::Device;
use crate::raster::Fragments;
use crate::scene::{MapSpec, TexelFormat};
use crate::shadow::{self, Texels};
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, OnceLock, PoisonError};

/// What the texels of one map return, place by place: bits + 1 of the depth and of the four bytes, 0
/// where they were not read yet.
#[derive(Debug)]
pub(super) struct Decoded {
    depths: Places,
    bytes: Places,
}

impl Decoded {
    fn new(places: usize, texel: TexelFormat) -> Self {
        let packed = matches!(texel, TexelFormat::Packed(_));
        Self { depths: Places::new(places), bytes: Places::new(if packed { places } else { 0 }) }
    }
}

/// Words that are 0 until written, in pages that are made when first touched: most texels of a large map
/// are never looked up.
#[derive(Debug)]
struct Places(Vec<OnceLock<Box<Page>>>);

const PAGE: usize = 1024;
type Page = [AtomicU32; PAGE];

impl Places {
    fn new(places: usize) -> Self {
        Self((0..places.div_ceil(PAGE)).map(|_| OnceLock::new()).collect())
    }

    fn get(&self, place: usize) -> Option<&AtomicU32> {
        let page = || Box::new([const { AtomicU32::new(0) }; PAGE]);
        Some(&self.0.get(place / PAGE)?.get_or_init(page)[place % PAGE])
    }
}

/// The value of a place, read once.
fn remember(place: &AtomicU32, read: impl FnOnce() -> u32) -> u32 {
    match place.load(Ordering::Relaxed) {
        0 => {
            let bits = read();
            place.store(bits.wrapping_add(1), Ordering::Relaxed);
            bits
        }
        known => known - 1,
    }
}

/// A map of a chart under one format.
pub(super) struct Store<'s> {
    spec: MapSpec,
    /// What each texel was drawn with.
    pub(super) drawn: Box<dyn Fn(u32) -> Option<f32> + 's>,
    /// Whose slots the values are remembered by; by texel where there are none.
    slots: Option<&'s Fragments>,
    device: Device,
    decoded: Arc<Decoded>,
}

impl Chart<'_, '_> {
    /// The map without a bias.
    pub(super) fn own_store(&self, texel: TexelFormat) -> Store<'_> {
        let mut list = self.decoded.lock().unwrap_or_else(PoisonError::into_inner);
        let known = list.iter().find(|(format, _)| *format == texel).map(|(_, d)| d.clone());
        let texels = self.size as usize * self.size as usize;
        let decoded = known.unwrap_or_else(|| {
            let new = Arc::new(Decoded::new(texels, texel));
            list.push((texel, new.clone()));
            new
        });
        self.store(texel, |t| self.drawn(t), None, decoded)
    }

    /// A map drawn otherwise, whose values have `places` places: the slots, or all its texels.
    pub(super) fn other_store<'s>(
        &self,
        texel: TexelFormat,
        drawn: impl Fn(u32) -> Option<f32> + 's,
        slots: Option<&'s Fragments>,
        places: usize,
    ) -> Store<'s> {
        self.store(texel, drawn, slots, Arc::new(Decoded::new(places, texel)))
    }

    fn store<'s>(
        &self,
        texel: TexelFormat,
        drawn: impl Fn(u32) -> Option<f32> + 's,
        slots: Option<&'s Fragments>,
        decoded: Arc<Decoded>,
    ) -> Store<'s> {
        let spec = self.spec(texel);
        Store { spec, drawn: Box::new(drawn), slots, device: *self.device(), decoded }
    }
}

impl Store<'_> {
    fn place(&self, texel: u32) -> usize {
        self.slots.map_or(texel as usize, |fragments| fragments.slot(texel))
    }
}

impl Texels for Store<'_> {
    fn size(&self) -> u32 {
        self.spec.size
    }

    fn format(&self) -> TexelFormat {
        self.spec.texel
    }

    fn depth(&self, device: &Device, texel: usize) -> f32 {
        let texel = texel as u32;
        let read = || shadow::texel_depth(device, &self.spec, (self.drawn)(texel)).to_bits();
        let place = self.decoded.depths.get(self.place(texel)).expect("as many places as texels");
        f32::from_bits(remember(place, read))
    }

    fn bytes(&self, texel: usize) -> Option<[u8; 4]> {
        let texel = texel as u32;
        let read = || shadow::texel_bytes(&self.device, &self.spec, (self.drawn)(texel));
        let place = self.decoded.bytes.get(self.place(texel))?;
        Some(remember(place, || u32::from_le_bytes(read().unwrap_or_default())).to_le_bytes())
    }
}
