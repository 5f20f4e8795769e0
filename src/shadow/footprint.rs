//! The texels under a look-up, before any of them is read: positions, weights, offsets.

use super::place::{Place, Shape, WIDEST, shape};
use super::sampler;
use crate::scene::{Filter, Wrap};
use rayon::prelude::*;
use std::ops::Range;

/// How look-ups of a map find their texels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sampling {
    /// Texels read.
    pub filter: Filter,
    /// What lies beyond the edges.
    pub wrap: Wrap,
    /// Texels per side.
    pub size: u32,
    /// Whether NEAREST coordinates are fixed point ([`sampler::nearest_texel`]).
    pub fixed: bool,
}

/// One comparison of a look-up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tap {
    /// The texel that it reads.
    pub texel: u32,
    /// Its share of the visibility; all shares add up to 1.
    pub weight: f64,
}

/// From the coordinate of a look-up to what one of its taps stands for, in units of u and v.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Offset {
    /// To the point that the filter samples.
    pub sample: [f32; 2],
    /// To the centre of the texel.
    pub centre: [f32; 2],
}

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
    /// The taps, row by row or along the disk.
    pub taps: &'f [Tap],
    /// The offset of each tap, where they were asked for.
    pub offsets: &'f [Offset],
    /// Whether shares differ.
    pub weighted: bool,
    /// For LINEAR, what is mixed.
    pub mixed: Option<Mix>,
}

impl Footprint<'_> {
    /// The tap in the middle, or the heaviest where shares differ.
    #[must_use]
    pub fn centre(&self) -> usize {
        centre(self.taps.len(), self.weighted, |i| self.taps[i].weight)
    }
}

/// The footprints of many look-ups of one map, one list after the other.
#[derive(Clone, Debug)]
pub struct Footprints {
    sampling: Sampling,
    with_offsets: bool,
    /// Where the taps of each footprint begin; one more at the end.
    starts: Vec<u32>,
    taps: Vec<Tap>,
    offsets: Vec<Offset>,
    mixed: Vec<Mix>,
}

/// Of `count` taps the one in the middle, or the heaviest (the first of equals) where shares differ.
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
        let (taps, offsets, mixed) = Default::default();
        Self { sampling, with_offsets, starts: vec![0], taps, offsets, mixed }
    }

    /// The footprints of many look-ups, with the offsets of their taps.
    #[must_use]
    pub fn of(sampling: Sampling, uv: &(impl Fn(usize) -> [f32; 2] + Sync), count: usize) -> Self {
        let starts = (0..count).into_par_iter().step_by(RUN);
        let run = |start: usize| {
            let mut run = Self::new(sampling, true);
            (start..count.min(start + RUN)).for_each(|i| run.push(uv(i)));
            run
        };
        let runs: Vec<Self> = starts.map(run).collect();
        runs.into_iter().fold(Self::new(sampling, true), Self::joined)
    }

    fn joined(mut self, other: Self) -> Self {
        let before = self.taps.len() as u32;
        self.starts.extend(other.starts[1..].iter().map(|start| before + start));
        self.taps.extend(other.taps);
        self.offsets.extend(other.offsets);
        self.mixed.extend(other.mixed);
        self
    }

    /// Adds the footprint of a look-up at (u, v).
    ///
    /// # Panics
    /// From 2³² taps on.
    #[inline]
    pub fn push(&mut self, uv: [f32; 2]) {
        self.place(uv);
        if self.with_offsets {
            self.place_offsets(uv);
        }
        self.starts.push(u32::try_from(self.taps.len()).expect("fewer than 2^32 taps"));
    }

    /// The footprint of a look-up at (u, v), in place of all others.
    #[inline]
    pub fn only(&mut self, uv: [f32; 2]) -> Footprint<'_> {
        self.taps.clear();
        self.offsets.clear();
        self.mixed.clear();
        self.starts.truncate(1);
        self.push(uv);
        self.get(0)
    }

    /// Where the taps of footprint `i` lie in the list of all.
    #[must_use]
    #[inline]
    pub fn range(&self, i: usize) -> Range<usize> {
        self.starts[i] as usize..self.starts[i + 1] as usize
    }

    /// Footprint `i`.
    #[must_use]
    #[inline]
    pub fn get(&self, i: usize) -> Footprint<'_> {
        let range = self.range(i);
        Footprint {
            offsets: self.offsets.get(range.clone()).unwrap_or_default(),
            taps: &self.taps[range],
            weighted: matches!(shape(self.sampling.filter), Shape::Bilinear(_)),
            mixed: self.mixed.get(i).copied(),
        }
    }

    /// The taps of all footprints.
    #[must_use]
    pub fn taps(&self) -> &[Tap] {
        &self.taps
    }

    /// What each footprint mixes; empty unless the filter is LINEAR.
    #[must_use]
    pub fn mixed(&self) -> &[Mix] {
        &self.mixed
    }

    fn place(&mut self, uv: [f32; 2]) {
        let sampling = self.sampling;
        let at = Place { sampling: &sampling, uv };
        match shape(sampling.filter) {
            Shape::Points(points) => {
                let weight = 1.0 / points.len() as f64;
                self.taps.extend(points.iter().map(|&p| Tap { texel: at.nearest(p), weight }));
            }
            Shape::Square(n) => self.square(&at, n),
            Shape::Bilinear(points) => self.bilinear(&at, points),
            Shape::Mix => self.mix(&at),
        }
    }

    fn place_offsets(&mut self, uv: [f32; 2]) {
        let sampling = self.sampling;
        let at = Place { sampling: &sampling, uv };
        match shape(sampling.filter) {
            Shape::Points(points) => self.offsets.extend(points.iter().map(|&p| at.offset(p))),
            Shape::Square(n) => {
                let half = n as i32 / 2;
                let row = |y: i32| (-half..=half).map(move |x| [x as f32, y as f32]);
                self.offsets.extend((-half..=half).flat_map(row).map(|p| at.offset(p)));
            }
            Shape::Bilinear(points) => {
                let around = points.iter().flat_map(|&p| at.around(p));
                self.offsets.extend(around.filter(|(tap, _)| tap.weight > 0.0).map(|(_, o)| o));
            }
            Shape::Mix => self.offsets.extend([at.offset([0.0; 2]); 4]),
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
        let ([xs, ys], weight) = ([0, 1].map(axis), 1.0 / (n * n) as f64);
        for y in &ys[..n] {
            let tap = |x: &u32| Tap { texel: y * at.sampling.size + x, weight };
            self.taps.extend(xs[..n].iter().map(tap));
        }
    }

    /// Bilinear comparisons around each point; comparisons of weight 0 are left out.
    fn bilinear(&mut self, at: &Place<'_>, points: &[[f32; 2]]) {
        let share = 1.0 / points.len() as f64;
        for &point in points {
            let around = at.around(point).map(|(tap, _)| tap).into_iter();
            let heavy = around.filter(|tap| tap.weight > 0.0);
            self.taps.extend(heavy.map(|tap| Tap { weight: tap.weight * share, ..tap }));
        }
    }

    fn mix(&mut self, at: &Place<'_>) {
        let Sampling { size, wrap, .. } = *at.sampling;
        let nearest = Tap { texel: at.nearest([0.0; 2]), weight: 1.0 };
        let ([x0, x1], fx) = sampler::linear_axis(at.uv[0], size, wrap);
        let ([y0, y1], fy) = sampler::linear_axis(at.uv[1], size, wrap);
        let texels = [(x0, y0), (x1, y0), (x0, y1), (x1, y1)].map(|(x, y)| y * size + x);
        self.mixed.push(Mix { texels, weights: [fx, fy] });
        let mut taps = [nearest; 4];
        let others = texels.into_iter().filter(|&t| t != nearest.texel);
        taps[1..].iter_mut().zip(others).for_each(|(tap, t)| tap.texel = t);
        self.taps.extend(taps);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sampling(filter: Filter, size: u32) -> Sampling {
        Sampling { filter, wrap: Wrap::Clamp, size, fixed: false }
    }

    #[test]
    fn shares_add_up_and_taps_stay_within_the_stated_half_width() {
        for &filter in Filter::ALL.iter().filter(|&&f| f != Filter::Linear) {
            let uv = |i: usize| [0.3 + i as f32 * 1.7e-3, 0.6 - i as f32 * 1.1e-3];
            let footprints = Footprints::of(sampling(filter, 64), &uv, 200);
            for i in 0..200 {
                let Footprint { taps, offsets, .. } = footprints.get(i);
                let sum: f64 = taps.iter().map(|t| t.weight).sum();
                assert!((sum - 1.0).abs() < 1e-12, "{filter}: shares add up to {sum}");
                assert!(taps.len() as u32 <= filter.fetches(), "{filter}: fetches");
                assert_eq!(taps.len(), offsets.len(), "{filter}");
                let reach = offsets.iter().flat_map(|o| o.centre).map(|c| c.abs() * 64.0);
                let farthest = f64::from(reach.fold(0.0, f32::max));
                assert!(farthest <= filter.half_width() + 1e-4, "{filter}: reaches {farthest}");
            }
        }
    }

    #[test]
    fn a_bilinear_comparison_at_a_texel_centre_reads_that_texel_alone() {
        let mut footprints = Footprints::new(sampling(Filter::Bilinear, 8), false);
        let footprint = footprints.only([2.5 / 8.0, 5.5 / 8.0]);
        let taps: Vec<_> = footprint.taps.iter().map(|t| (t.texel, t.weight)).collect();
        assert_eq!(taps, [(42, 1.0)]);
    }

    #[test]
    fn many_footprints_are_those_of_each() {
        for &filter in Filter::ALL {
            let (sampling, count) = (sampling(filter, 32), RUN + 100);
            let uv = |i: usize| [i as f32 * 1.9e-4, 0.99 - i as f32 * 2.1e-4];
            let footprints = Footprints::of(sampling, &uv, count);
            let mut one = Footprints::new(sampling, true);
            for i in 0..count {
                assert_eq!(footprints.get(i), one.only(uv(i)), "{filter} at {i}");
            }
        }
    }
}
