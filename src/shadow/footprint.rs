//! The texels under a look-up, before any of them is read: positions, weights, offsets.

use super::sampler;
use crate::scene::{Filter, Wrap};
use std::sync::OnceLock;

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
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Footprint {
    taps: Vec<Tap>,
    /// Of each tap, where they were asked for.
    offsets: Vec<Offset>,
    /// Whether shares differ.
    pub weighted: bool,
    /// For LINEAR, what is mixed.
    pub mixed: Option<Mix>,
}

/// Of `count` taps the one in the middle, or the heaviest (the first of equals) where shares differ.
pub(super) fn centre(count: usize, weighted: bool, weight: impl Fn(usize) -> f64) -> usize {
    let heaviest = |best: usize, i: usize| if weight(i) > weight(best) { i } else { best };
    if weighted { (0..count).fold(0, heaviest) } else { count / 2 }
}

/// Radius of the disks of sixteen, in texels.
const DISK: f64 = 2.0;

/// What a filter compares, points in texels around the coordinate.
enum Shape {
    /// The texels under each point.
    Points(&'static [[f32; 2]]),
    /// The texels under n×n points one texel apart.
    Square(usize),
    /// The four texels around each point, by their distance.
    Bilinear(&'static [[f32; 2]]),
    /// One depth made of four texels.
    Mix,
}

/// The widest square.
const WIDEST: usize = 9;

fn shape(filter: Filter) -> Shape {
    match filter {
        Filter::Nearest => Shape::Points(&[[0.0; 2]]),
        Filter::Linear => Shape::Mix,
        Filter::Pcf3 => Shape::Square(3),
        Filter::Pcf5 => Shape::Square(5),
        Filter::Pcf7 => Shape::Square(7),
        Filter::Pcf9 => Shape::Square(WIDEST),
        Filter::Bilinear => Shape::Bilinear(&[[0.0; 2]]),
        Filter::Pcf3Bilinear => Shape::Bilinear(&GRID3),
        Filter::Poisson16 => Shape::Points(poisson16()),
        Filter::Vogel16 => Shape::Points(vogel16()),
        Filter::Vogel5Bilinear => Shape::Bilinear(vogel5()),
    }
}

impl Footprint {
    /// The taps, row by row or along the disk.
    #[must_use]
    pub fn taps(&self) -> &[Tap] {
        &self.taps
    }

    /// Where tap `i` samples.
    ///
    /// # Panics
    /// Unless the taps were placed with their offsets.
    #[must_use]
    pub fn offset(&self, i: usize) -> Offset {
        self.offsets[i]
    }

    /// The tap in the middle, or the heaviest where shares differ.
    #[must_use]
    pub fn centre(&self) -> usize {
        centre(self.taps.len(), self.weighted, |i| self.taps[i].weight)
    }

    /// Places the taps of a look-up at (u, v), without their offsets.
    pub fn place(&mut self, sampling: &Sampling, uv: [f32; 2]) {
        self.taps.clear();
        self.offsets.clear();
        (self.weighted, self.mixed) = (false, None);
        let at = Place { sampling, uv };
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

    /// The same with the offset of every tap.
    pub fn place_with_offsets(&mut self, sampling: &Sampling, uv: [f32; 2]) {
        self.place(sampling, uv);
        let at = Place { sampling, uv };
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
            Shape::Mix => self.offsets.resize(4, at.offset([0.0; 2])),
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
        self.weighted = true;
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
        self.mixed = Some(Mix { texels, weights: [fx, fy] });
        self.taps.resize(4, nearest);
        let others = texels.into_iter().filter(|&t| t != nearest.texel);
        self.taps[1..].iter_mut().zip(others).for_each(|(tap, t)| tap.texel = t);
    }
}

/// Where a look-up happens.
struct Place<'s> {
    sampling: &'s Sampling,
    uv: [f32; 2],
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

impl Place<'_> {
    /// An offset in texels as one in u or v: f32 product with f32(1/size).
    fn step(&self, texels: f32) -> f32 {
        texels * (1.0 / self.sampling.size as f32)
    }

    /// Index along an axis of the texel so many texels away.
    fn nearest_along(&self, axis: usize, texels: f32) -> u32 {
        let Sampling { size, wrap, fixed, .. } = *self.sampling;
        sampler::nearest_texel(self.uv[axis] + self.step(texels), size, wrap, fixed)
    }

    fn nearest(&self, texels: [f32; 2]) -> u32 {
        let [x, y] = [0, 1].map(|axis| self.nearest_along(axis, texels[axis]));
        y * self.sampling.size + x
    }

    fn offset(&self, texels: [f32; 2]) -> Offset {
        let centre = |axis: usize| self.centre(axis, self.uv[axis] + self.step(texels[axis]));
        Offset { sample: texels.map(|t| self.step(t)), centre: [0, 1].map(centre) }
    }

    /// From the coordinate to the centre of the texel that c falls into, along one axis.
    fn centre(&self, axis: usize, c: f32) -> f32 {
        let size = f64::from(self.sampling.size);
        (((f64::from(c) * size).floor() + 0.5) / size - f64::from(self.uv[axis])) as f32
    }

    /// The four texels around a point: their shares of its comparison, their offsets.
    fn around(&self, point: [f32; 2]) -> [(Tap, Offset); 4] {
        let axes = [0, 1].map(|axis| self.between(axis, point[axis]));
        [[0, 0], [1, 0], [0, 1], [1, 1]].map(|[x, y]: [usize; 2]| {
            let texel = axes[1].texels[y] * self.sampling.size + axes[0].texels[x];
            let centre = [axes[0].centres[x], axes[1].centres[y]];
            let tap = Tap { texel, weight: axes[0].weight(x) * axes[1].weight(y) };
            (tap, Offset { sample: point.map(|t| self.step(t)), centre })
        })
    }

    fn between(&self, axis: usize, texels: f32) -> Between {
        let c = self.uv[axis] + self.step(texels);
        let (pair, fraction) =
            sampler::linear_axis(c, self.sampling.size, self.sampling.wrap);
        let size = f64::from(self.sampling.size);
        let low = (f64::from(c) * size - 0.5).floor() + 0.5;
        let from = |position: f64| (position / size - f64::from(self.uv[axis])) as f32;
        Between { texels: pair, fraction, centres: [from(low), from(low + 1.0)] }
    }
}

/// 3×3 offsets in texels around 0, row by row.
const GRID3: [[f32; 2]; 9] = [
    [-1.0, -1.0],
    [0.0, -1.0],
    [1.0, -1.0],
    [-1.0, 0.0],
    [0.0, 0.0],
    [1.0, 0.0],
    [-1.0, 1.0],
    [0.0, 1.0],
    [1.0, 1.0],
];

/// Vogel's disk: point i of n at radius √((i + ½)/n) and i golden angles.
fn vogel(n: u32, radius: f64) -> Vec<[f32; 2]> {
    let golden = std::f64::consts::PI * (3.0 - f64::sqrt(5.0));
    let point = |i: u32| {
        let r = f64::sqrt((f64::from(i) + 0.5) / f64::from(n)) * radius;
        let angle = f64::from(i) * golden;
        [(r * libm::cos(angle)) as f32, (r * libm::sin(angle)) as f32]
    };
    (0..n).map(point).collect()
}

fn vogel5() -> &'static [[f32; 2]] {
    static POINTS: OnceLock<Vec<[f32; 2]>> = OnceLock::new();
    POINTS.get_or_init(|| vogel(5, 1.0))
}

fn vogel16() -> &'static [[f32; 2]] {
    static POINTS: OnceLock<Vec<[f32; 2]>> = OnceLock::new();
    POINTS.get_or_init(|| vogel(16, DISK))
}

/// Sixteen points no closer than 0.38 radii, thrown with a fixed seed.
fn poisson16() -> &'static [[f32; 2]] {
    static POINTS: OnceLock<Vec<[f32; 2]>> = OnceLock::new();
    POINTS.get_or_init(|| {
        let mut seed: u64 = 1;
        let mut random = || {
            seed = seed
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (seed >> 40) as f64 / f64::from(1u32 << 23) - 1.0
        };
        let mut points: Vec<[f64; 2]> = Vec::new();
        let mut distance = 0.38;
        while points.len() < 16 {
            for _ in 0..10_000 {
                let p = [random(), random()];
                let apart = |q: &[f64; 2]| {
                    let d = [p[0] - q[0], p[1] - q[1]];
                    d[0] * d[0] + d[1] * d[1] >= distance * distance
                };
                let inside = p[0] * p[0] + p[1] * p[1] <= 1.0;
                if inside && points.len() < 16 && points.iter().all(apart) {
                    points.push(p);
                }
            }
            distance *= 0.9;
        }
        points.iter().map(|p| p.map(|c| (c * DISK) as f32)).collect()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_add_up_and_taps_stay_within_the_stated_half_width() {
        let mut footprint = Footprint::default();
        for &filter in Filter::ALL.iter().filter(|&&f| f != Filter::Linear) {
            for i in 0..200u32 {
                let uv = [0.3 + i as f32 * 1.7e-3, 0.6 - i as f32 * 1.1e-3];
                let sampling = Sampling { filter, wrap: Wrap::Clamp, size: 64, fixed: false };
                footprint.place_with_offsets(&sampling, uv);
                let sum: f64 = footprint.taps().iter().map(|t| t.weight).sum();
                assert!((sum - 1.0).abs() < 1e-12, "{filter}: shares add up to {sum}");
                assert!(footprint.taps().len() as u32 <= filter.fetches(), "{filter}: fetches");
                let offsets = (0..footprint.taps().len()).flat_map(|i| footprint.offset(i).centre);
                let reach = offsets.map(|c| c.abs() * 64.0);
                let farthest = f64::from(reach.fold(0.0, f32::max));
                assert!(farthest <= filter.half_width() + 1e-4, "{filter}: reaches {farthest}");
            }
        }
    }

    #[test]
    fn a_bilinear_comparison_at_a_texel_centre_reads_that_texel_alone() {
        let mut footprint = Footprint::default();
        let sampling =
            Sampling { filter: Filter::Bilinear, wrap: Wrap::Clamp, size: 8, fixed: false };
        footprint.place(&sampling, [2.5 / 8.0, 5.5 / 8.0]);
        let taps: Vec<_> = footprint.taps().iter().map(|t| (t.texel, t.weight)).collect();
        assert_eq!(taps, [(42, 1.0)]);
    }
}
