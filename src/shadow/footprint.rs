//! The texels under a look-up, before any of them is read: positions, weights, offsets.

use super::sampler;
use crate::scene::{Filter, Wrap};
use std::sync::OnceLock;

/// One comparison of a look-up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tap {
    /// The texel that it reads.
    pub texel: u32,
    /// Its share of the visibility; all shares add up to 1.
    pub weight: f64,
    /// From the coordinate to the point that the filter samples, in units of u and v.
    pub sample: [f32; 2],
    /// From the coordinate to the centre of the texel, in units of u and v.
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

impl Footprint {
    /// The taps, row by row or along the disk.
    #[must_use]
    pub fn taps(&self) -> &[Tap] {
        &self.taps
    }

    /// The tap in the middle, or the heaviest where shares differ.
    #[must_use]
    pub fn centre(&self) -> usize {
        centre(self.taps.len(), self.weighted, |i| self.taps[i].weight)
    }

    /// Places the taps of `filter` at (u, v) of a map of `size`² texels; `fixed` as in
    /// [`sampler::nearest_texel`].
    pub fn place(&mut self, filter: Filter, wrap: Wrap, size: u32, fixed: bool, uv: [f32; 2]) {
        self.taps.clear();
        (self.weighted, self.mixed) = (false, None);
        let at = Place { wrap, size, fixed, uv };
        match filter {
            Filter::Nearest => self.taps.push(at.nearest([0.0; 2], 1.0)),
            Filter::Linear => self.mix(&at),
            Filter::Pcf3 => self.square(&at, 3),
            Filter::Pcf5 => self.square(&at, 5),
            Filter::Pcf7 => self.square(&at, 7),
            Filter::Pcf9 => self.square(&at, 9),
            Filter::Bilinear => self.bilinear(&at, &[[0.0; 2]]),
            Filter::Pcf3Bilinear => self.bilinear(&at, &grid(3)),
            Filter::Poisson16 => self.points(&at, poisson16()),
            Filter::Vogel16 => self.points(&at, vogel16()),
            Filter::Vogel5Bilinear => self.bilinear(&at, vogel5()),
        }
    }

    fn square(&mut self, at: &Place, n: i32) {
        self.points(at, &grid(n));
    }

    fn points(&mut self, at: &Place, offsets: &[[f32; 2]]) {
        let weight = 1.0 / offsets.len() as f64;
        self.taps.extend(offsets.iter().map(|&o| at.nearest(o, weight)));
    }

    /// Bilinear comparisons around each point; comparisons of weight 0 are left out.
    fn bilinear(&mut self, at: &Place, offsets: &[[f32; 2]]) {
        self.weighted = true;
        let share = 1.0 / offsets.len() as f64;
        for &offset in offsets {
            let axes = [0, 1].map(|axis| at.between(axis, offset[axis]));
            for corner in 0..4 {
                let side = [corner & 1, corner >> 1];
                let weight = axes[0].weight(side[0]) * axes[1].weight(side[1]) * share;
                if weight > 0.0 {
                    let texel = axes[1].texels[side[1]] * at.size + axes[0].texels[side[0]];
                    let centre = [axes[0].centres[side[0]], axes[1].centres[side[1]]];
                    self.taps.push(Tap { texel, weight, sample: at.step(offset), centre });
                }
            }
        }
    }

    fn mix(&mut self, at: &Place) {
        let nearest = at.nearest([0.0; 2], 1.0);
        let ([x0, x1], fx) = sampler::linear_axis(at.uv[0], at.size, at.wrap);
        let ([y0, y1], fy) = sampler::linear_axis(at.uv[1], at.size, at.wrap);
        let texels = [(x0, y0), (x1, y0), (x0, y1), (x1, y1)].map(|(x, y)| y * at.size + x);
        self.mixed = Some(Mix { texels, weights: [fx, fy] });
        self.taps.resize(4, nearest);
        let others = texels.into_iter().filter(|&t| t != nearest.texel);
        self.taps[1..].iter_mut().zip(others).for_each(|(tap, t)| tap.texel = t);
    }
}

/// Where a look-up happens.
struct Place {
    wrap: Wrap,
    size: u32,
    fixed: bool,
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

impl Place {
    /// An offset in texels as one in u and v: f32 product with f32(1/size).
    fn step(&self, texels: [f32; 2]) -> [f32; 2] {
        let step = 1.0 / self.size as f32;
        texels.map(|t| t * step)
    }

    fn nearest(&self, texels: [f32; 2], weight: f64) -> Tap {
        let sample = self.step(texels);
        let axis = |i: usize| {
            let c = self.uv[i] + sample[i];
            (sampler::nearest_texel(c, self.size, self.wrap, self.fixed), self.centre(i, c))
        };
        let ((x, centre_x), (y, centre_y)) = (axis(0), axis(1));
        Tap { texel: y * self.size + x, weight, sample, centre: [centre_x, centre_y] }
    }

    /// From the coordinate to the centre of the texel that c falls into, along one axis.
    fn centre(&self, axis: usize, c: f32) -> f32 {
        let size = f64::from(self.size);
        (((f64::from(c) * size).floor() + 0.5) / size - f64::from(self.uv[axis])) as f32
    }

    fn between(&self, axis: usize, texels: f32) -> Between {
        let c = self.uv[axis] + self.step([texels, 0.0])[0];
        let (pair, fraction) = sampler::linear_axis(c, self.size, self.wrap);
        let size = f64::from(self.size);
        let low = (f64::from(c) * size - 0.5).floor() + 0.5;
        let from = |position: f64| (position / size - f64::from(self.uv[axis])) as f32;
        Between { texels: pair, fraction, centres: [from(low), from(low + 1.0)] }
    }
}

/// n×n offsets in texels around 0, row by row.
fn grid(n: i32) -> Vec<[f32; 2]> {
    let half = n / 2;
    let row = |y: i32| (-half..=half).map(move |x| [x as f32, y as f32]);
    (-half..=half).flat_map(row).collect()
}

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
                footprint.place(filter, Wrap::Clamp, 64, false, uv);
                let sum: f64 = footprint.taps().iter().map(|t| t.weight).sum();
                assert!((sum - 1.0).abs() < 1e-12, "{filter}: shares add up to {sum}");
                assert!(footprint.taps().len() as u32 <= filter.fetches(), "{filter}: fetches");
                let reach = footprint.taps().iter().flat_map(|t| t.centre).map(|c| c.abs() * 64.0);
                let farthest = f64::from(reach.fold(0.0, f32::max));
                assert!(farthest <= filter.half_width() + 1e-4, "{filter}: reaches {farthest}");
            }
        }
    }

    #[test]
    fn a_bilinear_comparison_at_a_texel_centre_reads_that_texel_alone() {
        let mut footprint = Footprint::default();
        footprint.place(Filter::Bilinear, Wrap::Clamp, 8, false, [2.5 / 8.0, 5.5 / 8.0]);
        let taps: Vec<_> = footprint.taps().iter().map(|t| (t.texel, t.weight)).collect();
        assert_eq!(taps, [(42, 1.0)]);
    }
}
