//! Which texels a look-up reads, and with what arithmetic.

use super::{ShadowMap, Texels, sampler};
use crate::device::{Device, NearestCoord};
use crate::scene::{Filter, TexelFormat, Wrap};

/// The depths that one look-up compares, and the texels that each was made of: one of one for
/// NEAREST, one of four for LINEAR, nine of one for 3×3 PCF.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Taps {
    depths: [f32; 9],
    texels: [u32; 9],
    taps: u8,
    texels_per_tap: u8,
}

impl Taps {
    /// Stored depths, as compared.
    #[must_use]
    pub fn depths(&self) -> &[f32] {
        &self.depths[..usize::from(self.taps)]
    }

    /// The texels that tap `i` was made of; the first is the one that NEAREST reads.
    #[must_use]
    pub fn texels(&self, i: usize) -> &[u32] {
        let per_tap = usize::from(self.texels_per_tap);
        &self.texels[i * per_tap..(i + 1) * per_tap]
    }

    /// The tap in the middle.
    #[must_use]
    pub const fn centre(&self) -> usize {
        self.taps as usize / 2
    }
}

impl ShadowMap {
    /// Reads the map at (u, v).
    #[must_use]
    pub fn taps(&self, device: &Device, filter: Filter, wrap: Wrap, u: f32, v: f32) -> Taps {
        match filter {
            Filter::Nearest => {
                let texel = self.nearest(device, wrap, u, v);
                let depth = self.depth(device, texel as usize);
                Taps { depths: [depth; 9], texels: [texel; 9], taps: 1, texels_per_tap: 1 }
            }
            Filter::Linear => self.linear(device, wrap, u, v),
            Filter::Pcf3 => self.pcf3(device, wrap, u, v),
        }
    }

    fn pcf3(&self, device: &Device, wrap: Wrap, u: f32, v: f32) -> Taps {
        let step = 1.0 / self.size as f32;
        let mut taps = Taps { depths: [0.0; 9], texels: [0; 9], taps: 9, texels_per_tap: 1 };
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
    fn linear(&self, device: &Device, wrap: Wrap, u: f32, v: f32) -> Taps {
        let nearest = self.nearest(device, wrap, u, v);
        let ([x0, x1], _) = sampler::linear_axis(u, self.size, wrap);
        let ([y0, y1], _) = sampler::linear_axis(v, self.size, wrap);
        let mixed = [(x0, y0), (x1, y0), (x0, y1), (x1, y1)].map(|(x, y)| y * self.size + x);
        let mut texels = [nearest; 9];
        let others = mixed.into_iter().filter(|&t| t != nearest);
        texels[1..].iter_mut().zip(others).take(3).for_each(|(slot, t)| *slot = t);
        let depth = match (&self.texels, self.format) {
            (Texels::Bytes(bytes), TexelFormat::Packed(packing)) => {
                let scale = device.load.value(1, 255);
                packing.unpack(std::array::from_fn(|c| {
                    let fetch = |x: u32, y: u32| f32::from(bytes[(y * self.size + x) as usize][c]);
                    sampler::linear(fetch, [self.size; 2], wrap, [u, v]) * scale
                }))
            }
            _ => 0.0,
        };
        Taps { depths: [depth; 9], texels, taps: 1, texels_per_tap: 4 }
    }
}
