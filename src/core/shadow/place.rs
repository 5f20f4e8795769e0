//! Which texels lie where a filter compares.

use super::sampler;
use super::sampling::{Offset, Sampling};

/// Where a look-up happens.
pub(super) struct Place<'s> {
    pub(super) sampling: &'s Sampling,
    pub(super) uv: [f32; 2],
}

/// The two texels along an axis that a comparison lies between.
struct Between {
    texels: [u32; 2],
    fraction: f32,
    centres: [f32; 2],
}

impl Between {
    fn weight(&self, side: usize) -> f64 {
        let f = f64::from(self.fraction);
        if side == 0 { 1.0 - f } else { f }
    }
}

/// One of the texels around a point.
#[derive(Clone, Copy)]
pub(super) struct Near {
    pub(super) texel: u32,
    /// Its share of the comparison.
    pub(super) weight: f64,
    pub(super) offset: Offset,
}

impl Place<'_> {
    /// An offset in texels as one in u or v: f32 product with f32(1/size).
    fn step(&self, texels: f32) -> f32 {
        texels * (1.0 / self.sampling.size as f32)
    }

    /// Index along an axis of the texel so many texels away.
    pub(super) fn nearest_along(&self, axis: usize, texels: f32) -> u32 {
        let Sampling { size, wrap, fixed, .. } = *self.sampling;
        sampler::nearest_texel(self.uv[axis] + self.step(texels), size, wrap, fixed)
    }

    pub(super) fn nearest(&self, texels: [f32; 2]) -> u32 {
        let [x, y] = [0, 1].map(|axis| self.nearest_along(axis, texels[axis]));
        y * self.sampling.size + x
    }

    pub(super) fn offset(&self, texels: [f32; 2]) -> Offset {
        let centre = |axis: usize| self.centre(axis, self.uv[axis] + self.step(texels[axis]));
        Offset { sample: texels.map(|t| self.step(t)), centre: [0, 1].map(centre) }
    }

    /// From the coordinate to the centre of the texel that c falls into, along one axis.
    fn centre(&self, axis: usize, c: f32) -> f32 {
        let size = f64::from(self.sampling.size);
        (((f64::from(c) * size).floor() + 0.5) / size - f64::from(self.uv[axis])) as f32
    }

    /// The four texels around a point.
    pub(super) fn around(&self, point: [f32; 2]) -> [Near; 4] {
        let axes = [0, 1].map(|axis| self.between(axis, point[axis]));
        [[0, 0], [1, 0], [0, 1], [1, 1]].map(|[x, y]: [usize; 2]| {
            let texel = axes[1].texels[y] * self.sampling.size + axes[0].texels[x];
            let centre = [axes[0].centres[x], axes[1].centres[y]];
            let weight = axes[0].weight(x) * axes[1].weight(y);
            Near { texel, weight, offset: Offset { sample: point.map(|t| self.step(t)), centre } }
        })
    }

    fn between(&self, axis: usize, texels: f32) -> Between {
        let c = self.uv[axis] + self.step(texels);
        let (pair, fraction) = sampler::linear_axis(c, self.sampling.size, self.sampling.wrap);
        let size = f64::from(self.sampling.size);
        let low = (f64::from(c) * size - 0.5).floor() + 0.5;
        let from = |position: f64| (position / size - f64::from(self.uv[axis])) as f32;
        Between { texels: pair, fraction, centres: [from(low), from(low + 1.0)] }
    }
}
