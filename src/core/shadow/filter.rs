//! Which texels a look-up reads, and with what arithmetic.

use super::footprint::{Footprint, Footprints, centre};
use super::sampling::Sampling;
use super::{Few, ShadowMap, sampler};
use crate::depth::Packing;
use crate::device::{Device, NearestCoord};
use crate::light::Lookup;
use crate::scene::{CompareRule, Filter, LookupSpec, TexelFormat, Wrap};

/// Texels of maps, read one by one: stored ones, or ones that are encoded as they are read.
pub trait Texels {
    /// What a texel holds.
    fn format(&self) -> TexelFormat;
    /// Whether window depths are the largest near the light.
    fn reversed(&self) -> bool;
    /// The compared depth that a NEAREST look-up of a texel returns.
    fn depth(&self, device: &Device, texel: usize) -> f32;
    /// The bytes of a texel of a packed map.
    fn bytes(&self, texel: usize) -> Option<[u8; 4]>;
}

/// The depths that a receiver compares, and the texels that each was made of: one of one for NEAREST,
/// one of four for LINEAR, nine of one for 3×3 PCF; those of a second map after those of the first.
#[derive(Clone, Debug, PartialEq)]
pub struct Taps {
    depths: Few<f32>,
    texels: Few<u32>,
    texels_per_tap: usize,
    /// Weights that add up to 1; empty where all taps weigh the same.
    weights: Vec<f64>,
    /// Where the taps of each look-up end, its map, and the receiver depth that they are compared with.
    runs: Few<Run>,
}

/// The taps of one look-up.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Run {
    end: usize,
    map: usize,
    z: f32,
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

    fn run(&self, i: usize) -> &Run {
        match &*self.runs {
            [only] => only,
            runs => runs.iter().find(|run| i < run.end).unwrap_or(&runs[runs.len() - 1]),
        }
    }

    /// The receiver depth that tap `i` compares; −∞ where the range test lights it without a look.
    #[must_use]
    pub fn z(&self, i: usize) -> f32 {
        self.run(i).z
    }

    /// The map that tap `i` reads.
    #[must_use]
    pub fn map(&self, i: usize) -> usize {
        self.run(i).map
    }

    /// Whether a rule lights tap `i`.
    #[must_use]
    pub fn is_lit(&self, rule: CompareRule, i: usize, bias: f32) -> bool {
        rule.is_lit(self.z(i), self.depths[i], bias)
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

    /// The taps of a second look-up after these, each by its weight.
    fn mixed_with(mut self, mut other: Self, weights: [f64; 2]) -> Self {
        for (taps, weight) in [(&mut self, weights[0]), (&mut other, weights[1])] {
            let even = 1.0 / taps.depths.len() as f64;
            taps.weights.resize(taps.depths.len(), even);
            taps.weights.iter_mut().for_each(|w| *w *= weight);
        }
        let before = self.depths.len();
        let later = |run: &Run| Run { end: run.end + before, ..*run };
        self.runs = self.runs.iter().copied().chain(other.runs.iter().map(later)).collect();
        self.depths = self.depths.iter().chain(&*other.depths).copied().collect();
        self.texels = self.texels.iter().chain(&*other.texels).copied().collect();
        self.weights.extend(other.weights);
        self
    }
}

impl ShadowMap {
    /// Reads what the look-ups of a receiver under a pixel of the canvas ask for. Of two that are mixed, one outside its map's square is lit
    /// by the range test alone; of one alone the caller sees to it ([`super::visibility`]).
    ///
    /// # Panics
    /// Without a look-up.
    #[must_use]
    pub fn taps(
        &self,
        device: &Device,
        spec: &LookupSpec,
        lookups: &[Lookup],
        pixel: [u32; 2],
    ) -> Taps {
        let outside = |l: &Lookup| spec.range_test && !super::in_square(l.coord);
        match lookups {
            [only] => self.taps_of(device, spec, only, pixel),
            [first, second, ..] => {
                let taps = |l: &Lookup| {
                    let [u, v, z] = l.coord;
                    let z = if outside(l) { f32::NEG_INFINITY } else { z };
                    self.taps_of(device, spec, &Lookup { coord: [u, v, z], ..*l }, pixel)
                };
                taps(first).mixed_with(taps(second), [first.weight, second.weight])
            }
            [] => unreachable!("every choice takes a map"),
        }
    }

    fn taps_of(
        &self,
        device: &Device,
        spec: &LookupSpec,
        lookup: &Lookup,
        pixel: [u32; 2],
    ) -> Taps {
        let Lookup { map, coord: [u, v, z], .. } = *lookup;
        if spec.filter == Filter::Nearest {
            let texel = self.nearest(device, spec.wrap, lookup);
            return Taps {
                depths: Few::One(self.depth(device, texel as usize)),
                texels: Few::One(texel),
                texels_per_tap: 1,
                weights: Vec::new(),
                runs: Few::One(Run { end: 1, map, z }),
            };
        }
        let fixed = fixed_coordinates(device, self.format());
        let sampling = Sampling { filter: spec.filter, wrap: spec.wrap, fixed };
        let mut footprints = Footprints::new(sampling, false);
        let taps = read(self, device, &footprints.only(self.layout().rect(map), [u, v], pixel));
        Taps { runs: Few::One(Run { end: taps.depths.len(), map, z }), ..taps }
    }

    /// Number of the texel that NEAREST picks.
    #[must_use]
    pub fn nearest(&self, device: &Device, wrap: Wrap, lookup: &Lookup) -> u32 {
        let fixed = fixed_coordinates(device, self.format());
        let rect = self.layout().rect(lookup.map);
        let [u, v] = rect.in_texture([lookup.coord[0], lookup.coord[1]]);
        let axis = |c: f32, size: u32| sampler::nearest_texel(c, size, wrap, fixed);
        rect.first + axis(v, rect.texture[1]) * rect.texture[0] + axis(u, rect.texture[0])
    }
}

/// Whether NEAREST coordinates are fixed point in textures of this format.
#[must_use]
pub fn fixed_coordinates(device: &Device, format: TexelFormat) -> bool {
    device.nearest == NearestCoord::Fixed16 && matches!(format, TexelFormat::Packed(_))
}

/// Reads the texels of a footprint.
#[must_use]
fn read(map: &impl Texels, device: &Device, footprint: &Footprint<'_>) -> Taps {
    let texels = footprint.texels.iter().copied().collect();
    if footprint.mixed.is_some() {
        let depths = Few::One(mixed_depth(map, device, footprint));
        let runs = Few::default();
        return Taps { depths, texels, texels_per_tap: 4, weights: Vec::new(), runs };
    }
    Taps {
        depths: footprint.texels.iter().map(|&texel| map.depth(device, texel as usize)).collect(),
        texels,
        texels_per_tap: 1,
        weights: footprint.weights.to_vec(),
        runs: Few::default(),
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
    let depth = mix(device, packing, &bytes, mixed.weights);
    if map.reversed() { -depth } else { depth }
}

/// The window depth that LINEAR makes of four texels: bytes are mixed in f32 on 0…255 (x before y), times
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
