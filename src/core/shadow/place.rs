//! Which texels lie where a filter compares.

use super::sampler;
use super::sampling::{Offset, Sampling};
use crate::light::Rect;
use crate::scene::AxisWeights;

/// Where a look-up happens.
pub(super) struct Place<'s> {
    pub(super) sampling: &'s Sampling,
    /// The map's texels in its texture.
    pub(super) rect: &'s Rect,
    /// In the texture.
    pub(super) uv: [f32; 2],
    /// The pixel that looks.
    pub(super) pixel: [u32; 2],
}

/// The texels that a separable kernel covers along an axis.
struct Covered {
    texels: [u32; 8],
    weights: AxisWeights,
    centres: [f32; 8],
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

impl<'s> Place<'s> {
    /// A look-up at the map's own coordinates.
    pub(super) fn new(
        sampling: &'s Sampling,
        rect: &'s Rect,
        uv: [f32; 2],
        pixel: [u32; 2],
    ) -> Self {
        Self { sampling, rect, uv: rect.in_texture(uv), pixel }
    }

    /// An offset in texels as one in u or v of the texture: f32 product with f32(1/size).
    fn step(&self, axis: usize, texels: f32) -> f32 {
        texels * (1.0 / self.rect.texture[axis] as f32)
    }

    /// Index along an axis of the texel so many texels away.
    pub(super) fn nearest_along(&self, axis: usize, texels: f32) -> u32 {
        let Sampling { wrap, fixed, .. } = *self.sampling;
        let c = self.uv[axis] + self.step(axis, texels);
        sampler::nearest_texel(c, self.rect.texture[axis], wrap, fixed)
    }

    /// The number of the texel in a column and a row of the texture.
    #[inline]
    pub(super) fn texel(&self, [x, y]: [u32; 2]) -> u32 {
        self.rect.first + y * self.rect.texture[0] + x
    }

    pub(super) fn nearest(&self, texels: [f32; 2]) -> u32 {
        self.texel([0, 1].map(|axis| self.nearest_along(axis, texels[axis])))
    }

    pub(super) fn offset(&self, texels: [f32; 2]) -> Offset {
        let centre = |axis: usize| self.centre(axis, self.uv[axis] + self.step(axis, texels[axis]));
        let sample = [0, 1].map(|axis| self.step(axis, texels[axis]));
        self.in_map(Offset { sample, centre: [0, 1].map(centre) })
    }

    /// An offset in the texture as one in the map's own u and v.
    fn in_map(&self, offset: Offset) -> Offset {
        let Rect { size, texture, .. } = *self.rect;
        if size == texture {
            return offset;
        }
        let grown =
            |o: [f32; 2]| [0, 1].map(|axis| o[axis] * (texture[axis] as f32 / size[axis] as f32));
        Offset { sample: grown(offset.sample), centre: grown(offset.centre) }
    }

    /// From the coordinate to the centre of the texel that c falls into, along one axis.
    fn centre(&self, axis: usize, c: f32) -> f32 {
        let size = f64::from(self.rect.texture[axis]);
        (((f64::from(c) * size).floor() + 0.5) / size - f64::from(self.uv[axis])) as f32
    }

    /// The four texels around a point.
    pub(super) fn around(&self, point: [f32; 2]) -> [Near; 4] {
        let axes = [0, 1].map(|axis| self.between(axis, point[axis]));
        [[0, 0], [1, 0], [0, 1], [1, 1]].map(|[x, y]: [usize; 2]| {
            let texel = self.texel([axes[0].texels[x], axes[1].texels[y]]);
            let centre = [axes[0].centres[x], axes[1].centres[y]];
            let weight = axes[0].weight(x) * axes[1].weight(y);
            let sample = [0, 1].map(|axis| self.step(axis, point[axis]));
            Near { texel, weight, offset: self.in_map(Offset { sample, centre }) }
        })
    }

    fn between(&self, axis: usize, texels: f32) -> Between {
        let c = self.uv[axis] + self.step(axis, texels);
        let size = self.rect.texture[axis];
        let (pair, fraction) = sampler::linear_axis(c, size, self.sampling.wrap);
        let size = f64::from(size);
        let low = (f64::from(c) * size - 0.5).floor() + 0.5;
        let from = |position: f64| (position / size - f64::from(self.uv[axis])) as f32;
        Between { texels: pair, fraction, centres: [from(low), from(low + 1.0)] }
    }

    /// The (n + 1)² texels of a separable kernel, row by row; each stands for its own centre.
    pub(super) fn covered(
        &self,
        n: usize,
        weights: fn(f32) -> AxisWeights,
    ) -> impl Iterator<Item = Near> + use<> {
        let [xs, ys] = [0, 1].map(|axis| self.covered_along(axis, n, weights));
        let (first, row) = (self.rect.first, self.rect.texture[0]);
        let Rect { size, texture, .. } = *self.rect;
        let grown = [0, 1].map(|axis| texture[axis] as f32 / size[axis] as f32);
        (0..=n).flat_map(move |y| (0..=n).map(move |x| (x, y))).map(move |(x, y)| {
            let centre = [xs.centres[x] * grown[0], ys.centres[y] * grown[1]];
            Near {
                texel: first + ys.texels[y] * row + xs.texels[x],
                weight: xs.weights[x] * ys.weights[y],
                offset: Offset { sample: centre, centre },
            }
        })
    }

    fn covered_along(&self, axis: usize, n: usize, weights: fn(f32) -> AxisWeights) -> Covered {
        let (size, wrap) = (self.rect.texture[axis], self.sampling.wrap);
        let (first, fraction) = sampler::between_centres(self.uv[axis], size, wrap);
        let before = (n as i64 - 1) / 2;
        let index = |k: usize| first.saturating_add(k as i64 - before);
        let low = (f64::from(self.uv[axis]) * f64::from(size) - 0.5).floor() + 0.5;
        let centre = |k: usize| {
            let texels = low + (k as i64 - before) as f64;
            (texels / f64::from(size) - f64::from(self.uv[axis])) as f32
        };
        Covered {
            texels: std::array::from_fn(|k| sampler::wrapped_texel(index(k), size, wrap)),
            weights: weights(fraction),
            centres: std::array::from_fn(centre),
        }
    }
}
