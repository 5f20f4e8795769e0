//! The texels under a look-up, before any of them is read: positions, weights, offsets.

use super::place::{Near, Place};
use super::sampler;
use super::sampling::{Offset, Sampling};
use crate::light::Rect;
use crate::scene::filter::{FilterKernel, WIDEST};
use rayon::prelude::*;
use std::ops::Range;

/// What LINEAR mixes before it decodes: four texels, x before y, and the two weights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mix {
    /// (x0,y0), (x1,y0), (x0,y1), (x1,y1).
    pub texels: [u32; 4],
    /// Weight of x1 and of y1.
    pub weights: [f32; 2],
}

/// Every tap of one look-up. For LINEAR the four taps are the texels of one comparison, the one that
/// NEAREST reads first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Footprint<'f> {
    /// The texel that each tap reads, row by row or along the disk.
    pub texels: &'f [u32],
    /// Their shares of the visibility, which add up to 1, where they differ; else empty.
    pub weights: &'f [f64],
    /// The offset of each tap, where they were asked for.
    pub offsets: &'f [Offset],
    /// For LINEAR, what is mixed.
    pub mixed: Option<Mix>,
}

impl Footprint<'_> {
    /// The tap in the middle, or the heaviest where shares differ.
    #[must_use]
    #[inline]
    pub fn centre(&self) -> usize {
        centre(self.texels.len(), !self.weights.is_empty(), |i| self.weights[i])
    }

    /// The share of a tap: all of it where taps are mixed into one comparison.
    #[must_use]
    #[inline]
    pub fn share(&self, tap: usize) -> f64 {
        match (self.mixed, self.weights.get(tap)) {
            (Some(_), _) => 1.0,
            (None, Some(&weight)) => weight,
            (None, None) => 1.0 / self.texels.len() as f64,
        }
    }
}

/// The footprints of many look-ups, one list after the other.
#[derive(Clone, Debug)]
pub struct Footprints {
    sampling: Sampling,
    with_offsets: bool,
    /// Taps of each footprint where all have as many.
    each: Option<usize>,
    /// Else where the taps of each footprint begin; one more at the end.
    starts: Vec<u32>,
    texels: Vec<u32>,
    weights: Vec<f64>,
    offsets: Vec<Offset>,
    mixed: Vec<Mix>,
}

/// The tap in the middle of `count`, or the heaviest (the first of equals) where shares differ.
pub(super) fn centre(count: usize, weighted: bool, weight: impl Fn(usize) -> f64) -> usize {
    let heaviest = |best: usize, i: usize| if weight(i) > weight(best) { i } else { best };
    if weighted { (0..count).fold(0, heaviest) } else { count / 2 }
}

/// Look-ups that a thread places at a time.
const RUN: usize = 1 << 12;

impl Footprints {
    /// None yet.
    #[must_use]
    pub fn new(sampling: Sampling, with_offsets: bool) -> Self {
        let each = match sampling.filter.kernel() {
            FilterKernel::Points { points, .. } => Some(points().len()),
            FilterKernel::Square(n) => Some(n * n),
            FilterKernel::Mix => Some(4),
            FilterKernel::Bilinear { .. }
            | FilterKernel::Separable { .. }
            | FilterKernel::Turned(_) => None,
        };
        let (texels, weights, offsets, mixed) = Default::default();
        Self { sampling, with_offsets, each, starts: vec![0], texels, weights, offsets, mixed }
    }

    /// The footprints of many look-ups, without the offsets of their taps; `at` gives the map's rectangle,
    /// the coordinates in it and the pixel that looks.
    #[must_use]
    pub fn of<'r>(
        sampling: Sampling,
        at: &(impl Fn(usize) -> (&'r Rect, [f32; 2], [u32; 2]) + Sync),
        count: usize,
    ) -> Self {
        let starts = (0..count).into_par_iter().step_by(RUN);
        let run = |start: usize| {
            let mut run = Self::new(sampling, false);
            for (rect, uv, pixel) in (start..count.min(start + RUN)).map(at) {
                run.push(rect, uv, pixel);
            }
            run
        };
        let runs: Vec<Self> = starts.map(run).collect();
        runs.into_iter().fold(Self::new(sampling, false), Self::joined)
    }

    fn joined(mut self, other: Self) -> Self {
        let before = self.texels.len() as u32;
        self.starts.extend(other.starts[1..].iter().map(|start| before + start));
        self.texels.extend(other.texels);
        self.weights.extend(other.weights);
        self.offsets.extend(other.offsets);
        self.mixed.extend(other.mixed);
        self
    }

    /// Adds the footprint of a look-up at (u, v) by a pixel of the canvas.
    ///
    /// # Panics
    /// From 2³² taps on.
    #[inline]
    pub fn push(&mut self, rect: &Rect, uv: [f32; 2], pixel: [u32; 2]) {
        let sampling = self.sampling;
        let at = Place::new(&sampling, rect, uv, pixel);
        self.place(&at);
        if self.with_offsets {
            self.place_offsets(&at);
        }
        let taps = u32::try_from(self.texels.len()).expect("fewer than 2^32 taps");
        if self.each.is_none() {
            self.starts.push(taps);
        }
    }

    /// The footprint of a look-up at (u, v), in place of all others.
    #[inline]
    pub fn only(&mut self, rect: &Rect, uv: [f32; 2], pixel: [u32; 2]) -> Footprint<'_> {
        self.clear();
        self.push(rect, uv, pixel);
        self.get(0)
    }

    /// Forgets all.
    #[inline]
    pub fn clear(&mut self) {
        self.texels.clear();
        self.weights.clear();
        self.offsets.clear();
        self.mixed.clear();
        self.starts.truncate(1);
    }

    /// Taps of each footprint, where all have as many.
    #[must_use]
    pub const fn each(&self) -> Option<usize> {
        self.each
    }

    /// Where the taps of footprint `i` lie in the list of all.
    #[must_use]
    #[inline]
    pub fn range(&self, i: usize) -> Range<usize> {
        match self.each {
            Some(taps) => i * taps..(i + 1) * taps,
            None => self.starts[i] as usize..self.starts[i + 1] as usize,
        }
    }

    /// Footprint `i`.
    #[must_use]
    #[inline]
    pub fn get(&self, i: usize) -> Footprint<'_> {
        let range = self.range(i);
        Footprint {
            offsets: self.offsets.get(range.clone()).unwrap_or_default(),
            weights: self.weights.get(range.clone()).unwrap_or_default(),
            texels: &self.texels[range],
            mixed: self.mixed.get(i).copied(),
        }
    }

    /// The texels of all footprints.
    #[must_use]
    pub fn texels(&self) -> &[u32] {
        &self.texels
    }

    /// What each footprint mixes; empty unless the filter is LINEAR.
    #[must_use]
    pub fn mixed(&self) -> &[Mix] {
        &self.mixed
    }

    fn place(&mut self, at: &Place<'_>) {
        match self.sampling.filter.kernel() {
            FilterKernel::Points { points, .. } => {
                self.texels.extend(points().iter().map(|&p| at.nearest(p)));
            }
            FilterKernel::Square(n) => self.square(at, n),
            FilterKernel::Bilinear { points, .. } => self.bilinear(at, points().iter().copied()),
            FilterKernel::Turned(disk) => {
                self.bilinear(at, (0..disk.count).map(|i| disk.point(i, at.pixel)));
            }
            FilterKernel::Separable { n, weights } => self.weighted(at.covered(n, weights), 1.0),
            FilterKernel::Mix => self.mix(at),
        }
    }

    fn place_offsets(&mut self, at: &Place<'_>) {
        match self.sampling.filter.kernel() {
            FilterKernel::Points { points, .. } => {
                self.offsets.extend(points().iter().map(|&p| at.offset(p)));
            }
            FilterKernel::Square(n) => {
                let half = n as i32 / 2;
                let row = |y: i32| (-half..=half).map(move |x| [x as f32, y as f32]);
                self.offsets.extend((-half..=half).flat_map(row).map(|p| at.offset(p)));
            }
            FilterKernel::Bilinear { points, .. } => {
                self.offsets_of(points().iter().flat_map(|&p| at.around(p)));
            }
            FilterKernel::Turned(disk) => {
                let points = (0..disk.count).map(|i| disk.point(i, at.pixel));
                self.offsets_of(points.flat_map(|p| at.around(p)));
            }
            FilterKernel::Separable { n, weights } => self.offsets_of(at.covered(n, weights)),
            FilterKernel::Mix => self.offsets.extend([at.offset([0.0; 2]); 4]),
        }
    }

    /// The texels under n×n points one texel apart, row by row.
    fn square(&mut self, at: &Place<'_>, n: usize) {
        let axis = |axis: usize| -> [u32; WIDEST] {
            let mut texels = [0; WIDEST];
            for (k, texel) in texels[..n].iter_mut().enumerate() {
                *texel = at.nearest_along(axis, (k as i32 - n as i32 / 2) as f32);
            }
            texels
        };
        let [xs, ys] = [0, 1].map(axis);
        for y in &ys[..n] {
            self.texels.extend(xs[..n].iter().map(|&x| at.texel([x, *y])));
        }
    }

    /// The offsets of comparisons, those of weight 0 left out.
    fn offsets_of(&mut self, around: impl Iterator<Item = Near>) {
        self.offsets.extend(around.filter(|near| near.weight > 0.0).map(|near| near.offset));
    }

    /// Bilinear comparisons around each point.
    fn bilinear(&mut self, at: &Place<'_>, points: impl ExactSizeIterator<Item = [f32; 2]>) {
        let share = 1.0 / points.len() as f64;
        self.weighted(points.flat_map(|point| at.around(point)), share);
    }

    /// Comparisons by their weights times `share`; those of weight 0 are left out.
    fn weighted(&mut self, around: impl Iterator<Item = Near>, share: f64) {
        for near in around {
            if near.weight > 0.0 {
                self.texels.push(near.texel);
                self.weights.push(near.weight * share);
            }
        }
    }

    fn mix(&mut self, at: &Place<'_>) {
        let (wrap, texture) = (at.sampling.wrap, at.rect.texture);
        let nearest = at.nearest([0.0; 2]);
        let ([x0, x1], fx) = sampler::linear_axis(at.uv[0], texture[0], wrap);
        let ([y0, y1], fy) = sampler::linear_axis(at.uv[1], texture[1], wrap);
        let texels = [[x0, y0], [x1, y0], [x0, y1], [x1, y1]].map(|place| at.texel(place));
        self.mixed.push(Mix { texels, weights: [fx, fy] });
        let mut taps = [nearest; 4];
        let others = texels.into_iter().filter(|&t| t != nearest);
        taps[1..].iter_mut().zip(others).for_each(|(tap, t)| *tap = t);
        self.texels.extend(taps);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Filter, Wrap};

    fn sampling(filter: Filter) -> Sampling {
        Sampling { filter, wrap: Wrap::Clamp, fixed: false }
    }

    #[test]
    fn shares_add_up_and_taps_stay_within_the_stated_half_width() {
        for &filter in Filter::ALL.iter().filter(|&&f| f != Filter::Linear) {
            let uv = |i: u32| [0.3 + i as f32 * 1.7e-3, 0.6 - i as f32 * 1.1e-3];
            let mut footprints = Footprints::new(sampling(filter), true);
            for i in 0..200u32 {
                let footprint = footprints.only(&Rect::whole([64; 2]), uv(i), [i, 3 * i]);
                let Footprint { texels, offsets, .. } = footprint;
                let sum: f64 = (0..texels.len()).map(|tap| footprint.share(tap)).sum();
                assert!((sum - 1.0).abs() < 1e-12, "{filter}: shares add up to {sum}");
                assert!(texels.len() as u32 <= filter.fetches(), "{filter}: fetches");
                assert_eq!(texels.len(), offsets.len(), "{filter}");
                let reach = offsets.iter().flat_map(|o| o.centre).map(|c| c.abs() * 64.0);
                let farthest = f64::from(reach.fold(0.0, f32::max));
                assert!(farthest <= filter.half_width() + 1e-4, "{filter}: reaches {farthest}");
            }
        }
    }

    #[test]
    fn a_bilinear_comparison_at_a_texel_centre_reads_that_texel_alone() {
        let mut footprints = Footprints::new(sampling(Filter::Bilinear), false);
        let footprint = footprints.only(&Rect::whole([8; 2]), [2.5 / 8.0, 5.5 / 8.0], [0; 2]);
        assert_eq!((footprint.texels, footprint.weights), (&[42][..], &[1.0][..]));
    }

    #[test]
    fn many_footprints_are_those_of_each() {
        for &filter in Filter::ALL {
            let (sampling, count) = (sampling(filter), RUN + 100);
            let rect = Rect::whole([32, 16]);
            let pixel = |i: usize| [i as u32 % 64, i as u32 / 64];
            let uv = |i: usize| [i as f32 * 1.9e-4, 0.99 - i as f32 * 2.1e-4];
            let footprints = Footprints::of(sampling, &|i| (&rect, uv(i), pixel(i)), count);
            let mut one = Footprints::new(sampling, false);
            for i in 0..count {
                assert_eq!(footprints.get(i), one.only(&rect, uv(i), pixel(i)), "{filter} at {i}");
            }
        }
    }
}
