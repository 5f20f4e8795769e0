//! Which texels a look-up reads, and with what arithmetic.

use super::footprint::{Footprint, Footprints, centre};
use super::sampling::Sampling;
use super::{Few, ShadowMap, sampler};
use crate::depth::Packing;
use crate::device::{Device, NearestCoord};
use crate::scene::{Filter, TexelFormat, Wrap};

/// Texels of a map, read one by one: a stored map, or one that is encoded as it is read.
pub trait Texels {
    /// Texels per side.
    fn size(&self) -> u32;
    /// What a texel holds.
    fn format(&self) -> TexelFormat;
    /// The depth that a NEAREST look-up of a texel returns to the comparison.
    fn depth(&self, device: &Device, texel: usize) -> f32;
    /// The bytes of a texel of a packed map.
    fn bytes(&self, texel: usize) -> Option<[u8; 4]>;
}

/// The depths that one look-up compares, and the texels that each was made of: one of one for
/// NEAREST, one of four for LINEAR, nine of one for 3×3 PCF.
#[derive(Clone, Debug, PartialEq)]
pub struct Taps {
    depths: Few<f32>,
    texels: Few<u32>,
    texels_per_tap: usize,
    /// Weights that add up to 1; empty where all taps weigh the same.
    weights: Vec<f64>,
}

impl Taps {
    /// Stored depths, as compared.
    #[must_use]
    pub fn depths(&self) -> &[f32] {
        &self.depths
    }

    /// The texels that tap `i` was made of; the first is the one that NEAREST reads.
    #[must_use]
    pub fn texels(&self, i: usize) -> &[u32] {
        &self.texels[i * self.texels_per_tap..(i + 1) * self.texels_per_tap]
    }

    /// The tap in the middle, or the heaviest where weights differ.
    #[must_use]
    pub fn centre(&self) -> usize {
        centre(self.depths.len(), !self.weights.is_empty(), |i| self.weights[i])
    }

    /// Weight of each tap where they differ; they add up to 1.
    #[must_use]
    pub fn weights(&self) -> Option<&[f64]> {
        (!self.weights.is_empty()).then_some(&self.weights)
    }

    /// Fractional visibility in [0, 1] of a look-up whose tap `i` is lit where `is_lit(i)`.
    #[must_use]
    pub fn visibility(&self, is_lit: impl Fn(usize) -> bool) -> f64 {
        let lit = (0..self.depths.len()).filter(|&i| is_lit(i));
        match self.weights() {
            None => lit.count() as f64 / self.depths.len() as f64,
            Some(weights) => lit.map(|i| weights[i]).sum(),
        }
    }
}

impl ShadowMap {
    /// Reads the map at (u, v).
    #[must_use]
    pub fn taps(&self, device: &Device, filter: Filter, wrap: Wrap, u: f32, v: f32) -> Taps {
        if filter == Filter::Nearest {
            let texel = self.nearest(device, wrap, u, v);
            return Taps {
                depths: Few::One(self.depth(device, texel as usize)),
                texels: Few::One(texel),
                texels_per_tap: 1,
                weights: Vec::new(),
            };
        }
        let fixed = fixed_coordinates(device, self.format());
        let sampling = Sampling { filter, wrap, size: self.size(), fixed };
        read(self, device, &Footprints::new(sampling, false).only([u, v]))
    }

    /// Index of the texel that NEAREST picks.
    #[must_use]
    pub fn nearest(&self, device: &Device, wrap: Wrap, u: f32, v: f32) -> u32 {
        let fixed = fixed_coordinates(device, self.format());
        let axis = |c: f32| sampler::nearest_texel(c, self.size(), wrap, fixed);
        axis(v) * self.size() + axis(u)
    }
}

/// Whether NEAREST coordinates are fixed point in textures of this format.
#[must_use]
pub fn fixed_coordinates(device: &Device, format: TexelFormat) -> bool {
    device.nearest == NearestCoord::Fixed16 && matches!(format, TexelFormat::Packed(_))
}

/// Reads the texels of a footprint.
#[must_use]
pub fn read(map: &impl Texels, device: &Device, footprint: &Footprint<'_>) -> Taps {
    let texels = footprint.texels.iter().copied().collect();
    if footprint.mixed.is_some() {
        let depths = Few::One(mixed_depth(map, device, footprint));
        return Taps { depths, texels, texels_per_tap: 4, weights: Vec::new() };
    }
    Taps {
        depths: footprint.texels.iter().map(|&texel| map.depth(device, texel as usize)).collect(),
        texels,
        texels_per_tap: 1,
        weights: footprint.weights.to_vec(),
    }
}

/// LINEAR: the bytes of four texels, mixed and decoded ([`mix`]); depth textures without a compare mode
/// read 0, as measured.
#[must_use]
pub fn mixed_depth(map: &impl Texels, device: &Device, footprint: &Footprint<'_>) -> f32 {
    let (Some(mixed), TexelFormat::Packed(packing)) = (footprint.mixed, map.format()) else {
        return 0.0;
    };
    let bytes = mixed.texels.map(|texel| map.bytes(texel as usize).unwrap_or_default());
    mix(device, packing, &bytes, mixed.weights)
}

/// The depth that LINEAR makes of four texels: bytes are mixed in f32 on 0…255 (x before y), times
/// f32(1/255), then decoded.
#[must_use]
pub fn mix(device: &Device, packing: Packing, bytes: &[[u8; 4]; 4], weights: [f32; 2]) -> f32 {
    let scale = device.load.value(1, 255);
    let [p, q, r, s] = bytes.map(|texel| texel.map(f32::from));
    let lerp = |a: f32, b: f32, t: f32| a + (b - a) * t;
    let mut channels = [0.0; 4];
    for c in 0..4 {
        let (low, high) = (lerp(p[c], q[c], weights[0]), lerp(r[c], s[c], weights[0]));
        channels[c] = lerp(low, high, weights[1]) * scale;
    }
    packing.unpack(channels)
}
