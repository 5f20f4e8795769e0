//! The shadow map: stored texels with the triangle that drew each, and how they are read back.

pub mod bias;
mod decode;
mod encode;
mod few;
mod filter;
mod footprint;
mod lookup;
pub mod margins;
mod place;
pub mod sampler;
mod sampling;

use crate::depth::{DepthFormat, Packing};
use crate::device::Device;
use crate::light::Layout;
use crate::scene::{MapSpec, NO_TRIANGLE, TexelFormat};
pub use few::Few;
pub use filter::{Taps, Texels, fixed_coordinates, mix, mixed_depth};
pub use footprint::{Footprint, Footprints, Mix};
pub use lookup::{breakpoint, breakpoint_where, in_square, visibility};
use rayon::prelude::*;
pub use sampling::{Offset, Sampling};
use std::slice;

/// Stored texels, row by row from the bottom.
#[derive(Clone, Debug, PartialEq)]
enum Memory {
    /// Four UNORM8 channels.
    Bytes(Vec<[u8; 4]>),
    /// Depths as the sampler returns them.
    Depths(Vec<f32>),
}

impl Memory {
    /// Where and how depths are to be stored.
    fn storing(&mut self, device: &Device, spec: &MapSpec) -> encode::Store<'_> {
        match (self, spec.texel) {
            (Self::Bytes(out), TexelFormat::Packed(packing)) => {
                encode::Store::Bytes { packing, clear: stored_bytes(device, spec.clear), out }
            }
            (Self::Depths(out), TexelFormat::Depth(format)) => {
                encode::Store::Depths { format, out }
            }
            _ => unreachable!("the memory of a map fits its format"),
        }
    }
}

/// What a pass drew, texel by texel: as many triangles as depths, or storing panics.
#[derive(Clone, Copy, Debug)]
pub struct Drawn<'a> {
    /// Window depths; where nothing was drawn 1, or 0 under reversed depth.
    pub depth: &'a [f32],
    /// Triangles, or [`NO_TRIANGLE`].
    pub triangle: &'a [u32],
}

/// The maps of a light as they lie in memory.
#[derive(Clone, Debug, PartialEq)]
pub struct ShadowMap {
    layout: Layout,
    format: TexelFormat,
    texels: Memory,
}

impl ShadowMap {
    /// Stores the depths of drawn passes whose texels lie as `layout` says.
    #[must_use]
    pub fn store(device: &Device, spec: &MapSpec, layout: &Layout, drawn: Drawn) -> Self {
        let mut map = Self::empty(spec.texel);
        Self::store_each(slice::from_mut(&mut map), device, slice::from_ref(spec), layout, drawn);
        map
    }

    /// [`Self::store`] under several formats at once, over older maps, whose memory is used again. What
    /// was drawn is read once for all.
    ///
    /// # Panics
    /// Unless there are as many maps as specifications, and as many triangles as depths.
    pub fn store_each(
        maps: &mut [Self],
        device: &Device,
        specs: &[MapSpec],
        layout: &Layout,
        drawn: Drawn,
    ) {
        assert_eq!(maps.len(), specs.len(), "a map for each specification");
        let stores = maps.iter_mut().zip(specs).map(|(map, spec)| {
            if map.format != spec.texel {
                *map = Self::empty(spec.texel);
            }
            map.layout = layout.clone();
            map.texels.storing(device, spec)
        });
        encode::store(device, stores.collect(), drawn);
    }

    /// A map without texels.
    #[must_use]
    pub const fn empty(format: TexelFormat) -> Self {
        let texels = match format {
            TexelFormat::Packed(_) => Memory::Bytes(Vec::new()),
            TexelFormat::Depth(_) => Memory::Depths(Vec::new()),
        };
        Self { layout: Layout::empty(), format, texels }
    }

    /// A map of ideal precision: the raster's own f32 depths, infinitely far where nothing was drawn.
    #[must_use]
    pub fn unquantized(layout: &Layout, drawn: Drawn) -> Self {
        let clear = layout.compared(f32::INFINITY);
        let texel = |(&z, &id): (&f32, &u32)| if id == NO_TRIANGLE { clear } else { z };
        let depths = drawn.depth.par_iter().zip(drawn.triangle).map(texel).collect();
        let format = TexelFormat::Depth(DepthFormat::F32);
        Self { layout: layout.clone(), format, texels: Memory::Depths(depths) }
    }

    /// A map of packed texels, row by row from the bottom.
    ///
    /// # Panics
    /// Unless there are as many texels as the layout has.
    #[must_use]
    pub fn from_bytes(layout: Layout, packing: Packing, bytes: Vec<[u8; 4]>) -> Self {
        assert_eq!(bytes.len(), layout.texels(), "as many texels");
        Self { layout, format: TexelFormat::Packed(packing), texels: Memory::Bytes(bytes) }
    }

    /// A map of depths as the sampler returns them, row by row from the bottom.
    ///
    /// # Panics
    /// Unless there are as many texels as the layout has.
    #[must_use]
    pub fn from_depths(layout: Layout, format: DepthFormat, depths: Vec<f32>) -> Self {
        assert_eq!(depths.len(), layout.texels(), "as many texels");
        Self { layout, format: TexelFormat::Depth(format), texels: Memory::Depths(depths) }
    }

    /// These texels as the maps of another layout.
    ///
    /// # Panics
    /// Unless it has as many texels.
    #[must_use]
    pub fn lying(self, layout: Layout) -> Self {
        assert_eq!(self.layout.texels(), layout.texels(), "as many texels");
        Self { layout, ..self }
    }

    /// Where the texels of each map lie.
    #[must_use]
    pub const fn layout(&self) -> &Layout {
        &self.layout
    }

    /// What a texel holds.
    #[must_use]
    pub const fn format(&self) -> TexelFormat {
        self.format
    }

    /// The bytes of a texel of a packed map.
    #[must_use]
    pub fn bytes(&self, texel: usize) -> Option<[u8; 4]> {
        match &self.texels {
            Memory::Bytes(bytes) => Some(bytes[texel]),
            Memory::Depths(_) => None,
        }
    }

    /// The compared depth that a NEAREST look-up of a texel returns
    /// ([`ClipSpace::compared`](crate::view::ClipSpace::compared)).
    #[must_use]
    pub fn depth(&self, device: &Device, texel: usize) -> f32 {
        self.layout.compared(self.window_depth(device, texel))
    }

    /// The window depth that a texel holds.
    #[must_use]
    pub fn window_depth(&self, device: &Device, texel: usize) -> f32 {
        match (&self.texels, self.format) {
            (Memory::Depths(depths), _) => depths[texel],
            (Memory::Bytes(bytes), TexelFormat::Packed(packing)) => {
                loaded_depth(device, packing, bytes[texel])
            }
            (Memory::Bytes(_), TexelFormat::Depth(_)) => unreachable!("bytes belong to packings"),
        }
    }
}

impl Texels for ShadowMap {
    fn reversed(&self) -> bool {
        self.layout.reversed()
    }

    fn format(&self) -> TexelFormat {
        self.format
    }

    fn depth(&self, device: &Device, texel: usize) -> f32 {
        Self::depth(self, device, texel)
    }

    fn bytes(&self, texel: usize) -> Option<[u8; 4]> {
        Self::bytes(self, texel)
    }
}

/// Many texels of a map, stored at once: of each [`texel_depth`], compared, and [`texel_bytes`].
#[derive(Clone, Debug)]
pub struct Stored {
    /// The compared depths that NEAREST look-ups return.
    pub depths: Vec<f32>,
    /// The bytes of packed texels; none of depth textures.
    pub bytes: Vec<[u8; 4]>,
    /// The largest |stored − drawn|, rounded up; +∞ where one of them is not a number.
    pub error: f32,
}

impl Stored {
    /// Stores what a pass drew, given as compared depths: negative ones where `reversed`.
    #[must_use]
    pub fn new(device: &Device, spec: &MapSpec, reversed: bool, drawn: Drawn) -> Self {
        if reversed {
            let negative = |depths: &[f32]| depths.iter().map(|&z| -z).collect::<Vec<f32>>();
            let depth = negative(drawn.depth);
            let stored = Self::new(device, spec, false, Drawn { depth: &depth, ..drawn });
            return Self { depths: negative(&stored.depths), ..stored };
        }
        let mut texels = ShadowMap::empty(spec.texel).texels;
        encode::store(device, vec![texels.storing(device, spec)], drawn);
        let (depths, bytes) = match (texels, spec.texel) {
            (Memory::Bytes(bytes), TexelFormat::Packed(packing)) => {
                let mut depths = Vec::new();
                decode::loaded(device, packing, &bytes, &mut depths);
                (depths, bytes)
            }
            (Memory::Depths(depths), _) => (depths, Vec::new()),
            (Memory::Bytes(_), TexelFormat::Depth(_)) => unreachable!("bytes belong to packings"),
        };
        let error = decode::error(drawn.depth, &depths);
        Self { depths, bytes, error }
    }
}

/// Four channels as the colour store of the device keeps them.
fn stored_bytes(device: &Device, channels: [f32; 4]) -> [u8; 4] {
    channels.map(|x| device.store.code(device.flush(x), 255) as u8)
}

/// The depth of four bytes as the device's sampler returns them.
fn loaded_depth(device: &Device, packing: Packing, bytes: [u8; 4]) -> f32 {
    packing.unpack(bytes.map(|b| device.load.value(u32::from(b), 255)))
}

/// The bytes that one texel of a packed map keeps: of a drawn depth, or of the clear colour. `None`
/// for depth textures.
#[must_use]
pub fn texel_bytes(device: &Device, spec: &MapSpec, drawn: Option<f32>) -> Option<[u8; 4]> {
    let TexelFormat::Packed(packing) = spec.texel else { return None };
    Some(stored_bytes(device, drawn.map_or(spec.clear, |z| packing.pack(z))))
}

/// The window depth that one texel returns after it was stored: what [`ShadowMap::window_depth`] says of
/// a map that holds it; `None` is a texel cleared to 1.
#[must_use]
pub fn texel_depth(device: &Device, spec: &MapSpec, drawn: Option<f32>) -> f32 {
    match (spec.texel, texel_bytes(device, spec, drawn)) {
        (TexelFormat::Packed(packing), Some(bytes)) => loaded_depth(device, packing, bytes),
        (TexelFormat::Depth(format), _) => device.stored_depth(format, drawn.unwrap_or(1.0)),
        (TexelFormat::Packed(_), None) => unreachable!("packed texels have bytes"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::device::DeviceProfile;
    use crate::scene::{CullRule, DepthBuffer};

    #[test]
    fn maps_stored_together_equal_maps_stored_alone() {
        let device = DeviceProfile::Ideal.device();
        let depths = DepthFormat::ALL.iter().map(|&format| TexelFormat::Depth(format));
        let packed = Packing::ALL.iter().map(|&packing| TexelFormat::Packed(packing));
        let all: Vec<TexelFormat> = depths.chain(packed).collect();
        // The maps are of another size and format before.
        let mut maps: Vec<ShadowMap> = all.iter().rev().map(|&f| ShadowMap::empty(f)).collect();
        for size in [3, 70, 64] {
            let texels = size * size;
            let depth: Vec<f32> = (0..texels).map(|i| i as f32 / texels as f32).collect();
            let id = |i: u32| if i.is_multiple_of(7) { NO_TRIANGLE } else { i };
            let triangle: Vec<u32> = (0..texels).map(id).collect();
            let drawn = Drawn { depth: &depth, triangle: &triangle };
            let spec = |&texel: &TexelFormat| {
                let (clear, depth_buffer) = ([0.25, 0.5, 0.75, 1.0], DepthBuffer::Texture);
                MapSpec { size, texel, clear, depth_buffer, cull: CullRule::None }
            };
            let specs: Vec<MapSpec> = all.iter().map(spec).collect();
            let layout = Layout::whole([size; 2]);
            ShadowMap::store_each(&mut maps, &device, &specs, &layout, drawn);
            for (map, spec) in maps.iter().zip(&specs) {
                let alone = ShadowMap::store(&device, spec, &layout, drawn);
                assert_eq!(map, &alone, "{:?}", spec.texel);
            }
        }
    }
}
