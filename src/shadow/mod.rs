//! The shadow map: stored texels with the triangle that drew each, and how they are read back.

mod filter;
mod lookup;
pub mod sampler;

use crate::depth::DepthFormat;
use crate::device::Device;
use crate::scene::{MapSpec, TexelFormat};
pub use filter::Taps;
pub use lookup::{breakpoint, visibility};

/// Stored texels, row by row from the bottom.
#[derive(Clone, Debug, PartialEq)]
enum Texels {
    /// Four UNORM8 channels.
    Bytes(Vec<[u8; 4]>),
    /// Depths as the sampler returns them.
    Depths(Vec<f32>),
}

/// A square shadow map as it lies in memory.
#[derive(Clone, Debug, PartialEq)]
pub struct ShadowMap {
    size: u32,
    format: TexelFormat,
    texels: Texels,
}

impl ShadowMap {
    /// Stores the depths of a drawn pass; `covered` tells drawn texels from cleared ones.
    #[must_use]
    pub fn store(
        device: &Device,
        spec: &MapSpec,
        depth: &[f32],
        covered: impl Fn(usize) -> bool,
    ) -> Self {
        let texels = match spec.texel {
            TexelFormat::Packed(packing) => {
                let bytes = |c: [f32; 4]| c.map(|x| device.store.code(device.flush(x), 255) as u8);
                let clear = bytes(spec.clear);
                let texel = |(i, &z): (usize, &f32)| match covered(i) {
                    true => bytes(packing.pack(z)),
                    false => clear,
                };
                Texels::Bytes(depth.iter().enumerate().map(texel).collect())
            }
            TexelFormat::Depth(format) => {
                Texels::Depths(depth.iter().map(|&z| device.stored_depth(format, z)).collect())
            }
        };
        Self { size: spec.size, format: spec.texel, texels }
    }

    /// A map of ideal precision: the raster's own f32 depths, cleared to `clear`.
    #[must_use]
    pub fn unquantized(
        size: u32,
        depth: &[f32],
        clear: f32,
        covered: impl Fn(usize) -> bool,
    ) -> Self {
        let texel = |(i, &z): (usize, &f32)| if covered(i) { z } else { clear };
        let depths = depth.iter().enumerate().map(texel).collect();
        Self { size, format: TexelFormat::Depth(DepthFormat::F32), texels: Texels::Depths(depths) }
    }

    /// Texels per side.
    #[must_use]
    pub const fn size(&self) -> u32 {
        self.size
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
            Texels::Bytes(bytes) => Some(bytes[texel]),
            Texels::Depths(_) => None,
        }
    }

    /// The depth that a NEAREST look-up of a texel returns to the comparison.
    #[must_use]
    pub fn depth(&self, device: &Device, texel: usize) -> f32 {
        match (&self.texels, self.format) {
            (Texels::Depths(depths), _) => depths[texel],
            (Texels::Bytes(bytes), TexelFormat::Packed(packing)) => {
                packing.unpack(bytes[texel].map(|b| device.load.value(u32::from(b), 255)))
            }
            (Texels::Bytes(_), TexelFormat::Depth(_)) => unreachable!("bytes belong to packings"),
        }
    }
}
