//! Which texels a look-up reads, and with what arithmetic.

use super::{ShadowMap, Texels, sampler};
use crate::device::{Device, NearestCoord};
use crate::scene::{Filter, TexelFormat, Wrap};

/// The depths that one look-up compares: one for NEAREST and LINEAR, nine for 3×3 PCF.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Taps {
    depths: [f32; 9],
    texels: [u32; 9],
    len: usize,
}

impl Taps {
    fn one(depth: f32, texel: u32) -> Self {
        Self { depths: [depth; 9], texels: [texel; 9], len: 1 }
    }

    /// Stored depths, as compared.
    #[must_use]
    pub fn depths(&self) -> &[f32] {
        &self.depths[..self.len]
    }

    /// The texel of each tap; for LINEAR the one that NEAREST would have read.
    #[must_use]
    pub fn texels(&self) -> &[u32] {
        &self.texels[..self.len]
    }

    /// The tap in the middle.
    #[must_use]
    pub const fn centre(&self) -> usize {
        self.len / 2
    }
}

impl ShadowMap {
    /// Reads the map at (u, v).
    #[must_use]
    pub fn taps(&self, device: &Device, filter: Filter, wrap: Wrap, u: f32, v: f32) -> Taps {
        match filter {
            Filter::Nearest => {
                let texel = self.nearest(device, wrap, u, v);
                Taps::one(self.depth(device, texel as usize), texel)
            }
            Filter::Linear => {
                let texel = self.nearest(device, wrap, u, v);
                Taps::one(self.linear(device, wrap, u, v), texel)
            }
            Filter::Pcf3 => self.pcf3(device, wrap, u, v),
        }
    }

    fn pcf3(&self, device: &Device, wrap: Wrap, u: f32, v: f32) -> Taps {
        let step = 1.0 / self.size as f32;
        let mut taps = Taps { depths: [0.0; 9], texels: [0; 9], len: 9 };
        for i in 0..9u8 {
            let (dx, dy) = (f32::from(i % 3) - 1.0, f32::from(i / 3) - 1.0);
            let texel = self.nearest(device, wrap, u + dx * step, v + dy * step);
            taps.texels[usize::from(i)] = texel;
            taps.depths[usize::from(i)] = self.depth(device, texel as usize);
        }
        taps
    }

    /// Index of the texel that NEAREST picks.
    #[must_use]
    pub fn nearest(&self, device: &Device, wrap: Wrap, u: f32, v: f32) -> u32 {
        let fixed = device.nearest == NearestCoord::Fixed16
            && matches!(self.format, TexelFormat::Packed(_));
        let axis = |c: f32| sampler::nearest_texel(c, self.size, wrap, fixed);
        axis(v) * self.size + axis(u)
    }

    /// LINEAR: bytes are mixed in f32 on 0…255 (x before y), times f32(1/255), then decoded; depth
    /// textures without a compare mode read 0, as measured.
    fn linear(&self, device: &Device, wrap: Wrap, u: f32, v: f32) -> f32 {
        let (Texels::Bytes(bytes), TexelFormat::Packed(packing)) = (&self.texels, self.format)
        else {
            return 0.0;
        };
        let scale = device.load.value(1, 255);
        packing.unpack(std::array::from_fn(|c| {
            let fetch = |x: u32, y: u32| f32::from(bytes[(y * self.size + x) as usize][c]);
            sampler::linear(fetch, [self.size; 2], wrap, [u, v]) * scale
        }))
    }
}
