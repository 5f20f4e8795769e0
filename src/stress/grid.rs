//! A device's grid of sub-pixels: triangles on it exactly, and which pixels they own by an oracle of its own.

use crate::device::{Device, DeviceProfile};
use crate::raster::Setup;
use crate::scene::Cull;
use glam::Vec4;

/// Pixels per side.
pub(super) const SIZE: u32 = 64;
/// Sub-pixels per pixel of the ideal device.
pub(super) const FINE: i64 = 256;

/// A point in sub-pixels: pixel (i, j) has its centre at `fine`·(i, j).
pub(super) type Point = [i64; 2];

/// A device with so many sub-pixels per pixel, a power of two.
#[derive(Clone, Copy)]
pub(super) struct Grid {
    pub(super) fine: i64,
}

/// The grid of the ideal device.
pub(super) const IDEAL: Grid = Grid { fine: FINE };

impl Grid {
    pub(super) fn device(self) -> Device {
        let subpixel_bits = self.fine.ilog2();
        Device { subpixel_bits, ..DeviceProfile::Ideal.device() }
    }

    /// Clip coordinates of a place in sub-pixels, which need not be whole; f32.
    pub(super) fn clip_at(self, place: [f64; 2], depth: f64) -> Vec4 {
        let half = f64::from(SIZE) * self.fine as f64 / 2.0;
        let ndc = |s: f64| ((s + self.fine as f64 / 2.0) / half - 1.0) as f32;
        Vec4::new(ndc(place[0]), ndc(place[1]), (2.0 * depth - 1.0) as f32, 1.0)
    }

    /// Clip coordinates of a grid point: exact.
    pub(super) fn clip(self, p: Point) -> Vec4 {
        self.clip_at(p.map(|c| c as f64), 0.5)
    }

    /// How often the rasteriser covers each pixel with these triangles.
    pub(super) fn covered(self, triangles: &[[Point; 3]]) -> Vec<u8> {
        let device = self.device();
        let mut hits = vec![0u8; (SIZE * SIZE) as usize];
        for corners in triangles {
            let setup = Setup::new(&device, [SIZE; 2], corners.map(|p| self.clip(p)));
            setup.cover(&device, [SIZE; 2], Cull::None, |y, first, end| {
                (first..end).for_each(|x| hits[(y * SIZE + x) as usize] += 1);
            });
        }
        hits
    }

    /// The oracle: each pixel centre against three integer edge functions, one pixel at a time.
    pub(super) fn oracle(self, triangles: &[[Point; 3]]) -> Vec<u8> {
        let triangles: Vec<_> = triangles.iter().copied().filter_map(counter_clockwise).collect();
        let size = i64::from(SIZE);
        let pixel = |i: i64| [i % size * self.fine, i / size * self.fine];
        let count = |i: i64| triangles.iter().filter(|&&t| inside(t, pixel(i))).count() as u8;
        (0..size * size).map(count).collect()
    }

    /// Pixels on which rasteriser and oracle differ.
    pub(super) fn differing(self, triangles: &[[Point; 3]]) -> usize {
        self.covered(triangles)
            .iter()
            .zip(self.oracle(triangles))
            .filter(|(a, b)| **a != *b)
            .count()
    }
}

pub(super) fn double_area([a, b, c]: [Point; 3]) -> i64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])
}

pub(super) fn counter_clockwise([a, b, c]: [Point; 3]) -> Option<[Point; 3]> {
    match double_area([a, b, c]).signum() {
        0 => None,
        1 => Some([a, b, c]),
        _ => Some([a, c, b]),
    }
}

/// Whether a counter-clockwise triangle owns a point: points on an edge are its own if the edge is a left
/// one (it goes down) or a lower one.
pub(super) fn inside([a, b, c]: [Point; 3], p: Point) -> bool {
    let owns = |a: Point, b: Point| {
        let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
        let area = double_area([a, b, p]);
        area > 0 || (area == 0 && (dy < 0 || (dy == 0 && dx > 0)))
    };
    owns(a, b) && owns(b, c) && owns(c, a)
}
