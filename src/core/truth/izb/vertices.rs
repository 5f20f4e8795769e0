//! Where vertices fall on the grid, and where on it a triangle may shadow receivers.
#![allow(clippy::needless_range_loop, reason = "loops over indices become vectors")]

use super::bins::{nearer, row_of};
use super::frame::Frame;
use crate::scene::Geometry;
use crate::simd::lanes::{BATCH, Lanes};
use crate::simd::{Kernel, Level};
use glam::DVec3;
use rayon::prelude::*;

/// Where on the grid a triangle may shadow receivers.
#[derive(Clone, Copy, Debug)]
pub(super) struct Item {
    /// From where to where along the rows.
    pub(super) columns: [f32; 2],
    /// First and last row.
    pub(super) rows: [u16; 2],
    /// Its largest depth and its margin: depth over a triangle is largest at a corner.
    pub(super) nearest: f32,
}

/// The box around a triangle in light space: grid position, depth and a 0.
#[derive(Clone, Copy, Debug)]
struct BoundingBox {
    low: [f32; 4],
    high: [f32; 4],
}

impl BoundingBox {
    const NOWHERE: Self = Self { low: [f32::INFINITY; 4], high: [f32::NEG_INFINITY; 4] };
}

/// The items of eight triangles side by side.
#[derive(Clone, Copy, Debug)]
pub(super) struct Items {
    left: [f32; BATCH],
    right: [f32; BATCH],
    bottom: [u16; BATCH],
    top: [u16; BATCH],
    nearest: [f32; BATCH],
    on_grid: [bool; BATCH],
}

impl Items {
    /// The parts of boxes that lie on the grid, widened by the rounding of f32 positions.
    #[inline(always)]
    fn on_grid(boxes: &[BoundingBox; BATCH], cells: usize) -> Self {
        let end = cells as f32;
        let mut items = Self {
            left: [0.0; BATCH],
            right: [0.0; BATCH],
            bottom: [0; BATCH],
            top: [0; BATCH],
            nearest: [0.0; BATCH],
            on_grid: [false; BATCH],
        };
        for k in 0..BATCH {
            let ([left, bottom, ..], [right, top, depth, _]) = (boxes[k].low, boxes[k].high);
            let (left, bottom) = (left - pad(left), bottom - pad(bottom));
            let (right, top) = (right + pad(right), top + pad(top));
            items.on_grid[k] = (right >= 0.0) & (left < end) & (top >= 0.0) & (bottom < end);
            items.left[k] = greater(left, -1.0);
            items.right[k] = lesser(right, end + 1.0);
            items.bottom[k] = row_of(bottom, cells) as u16;
            items.top[k] = row_of(top, cells) as u16;
            items.nearest[k] = nearer(depth);
        }
        items
    }

    /// The item of triangle `k` of the eight; none where it lies beside the grid.
    #[inline(always)]
    pub(super) fn get(&self, k: usize) -> Option<Item> {
        self.on_grid[k].then_some(Item {
            columns: [self.left[k], self.right[k]],
            rows: [self.bottom[k], self.top[k]],
            nearest: self.nearest[k],
        })
    }
}

/// Grid positions and depths of all vertices in f32 and a 0, so that all are compared at once (NaN where
/// a vertex is behind the light or nearly so).
#[derive(Debug)]
pub(super) struct Vertices<'a> {
    frame: &'a Frame,
    positions: &'a [DVec3],
    screen: Vec<[f32; 4]>,
}

/// Some of them.
struct Project<'a> {
    frame: &'a Frame,
    positions: &'a [DVec3],
    screen: &'a mut [[f32; 4]],
}

impl Kernel for Project<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self, _: bool) {
        let runs = self.positions.chunks(BATCH).zip(self.screen.chunks_mut(BATCH));
        for (positions, screen) in runs {
            let mut p = [Lanes::splat(1.0); 3];
            for (k, at) in positions.iter().enumerate() {
                (p[0].0[k], p[1].0[k], p[2].0[k]) = (at.x, at.y, at.z);
            }
            let eight = self.frame.eight(&p);
            let [x, y, depth] = eight.places();
            let (sx, sy, sd) = (x.narrow(), y.narrow(), depth.narrow());
            for (k, screen) in screen.iter_mut().enumerate() {
                let near_axis = (x.0[k].abs() < 1e6) & (y.0[k].abs() < 1e6);
                let seen = (eight.v[2].0[k] > 0.0) & near_axis;
                *screen = if seen { [sx[k], sy[k], sd[k], 0.0] } else { [f32::NAN; 4] };
            }
        }
    }
}

impl<'a> Vertices<'a> {
    pub(super) fn new(frame: &'a Frame, geometry: &'a Geometry, level: Level) -> Self {
        const RUN: usize = 1 << 13;
        let positions = &geometry.positions;
        let mut screen = vec![[0.0; 4]; positions.len()];
        let runs = screen.par_chunks_mut(RUN).zip(positions.par_chunks(RUN));
        runs.for_each(|(screen, positions)| level.run(Project { frame, positions, screen }));
        Self { frame, positions, screen }
    }

    /// The corners of a triangle in the world.
    #[inline(always)]
    pub(super) fn corners(&self, [a, b, c]: [u32; 3]) -> [DVec3; 3] {
        [self.positions[a as usize], self.positions[b as usize], self.positions[c as usize]]
    }

    /// Where on a grid of `cells * cells` up to eight triangles may shadow receivers.
    #[inline(always)]
    pub(super) fn items(&self, triangles: &[[u32; 3]], cells: usize) -> Items {
        let mut boxes = [BoundingBox::NOWHERE; BATCH];
        let mut seen = 0.0;
        for (&[a, b, c], bounds) in triangles.iter().zip(&mut boxes) {
            let (a, b, c) =
                (&self.screen[a as usize], &self.screen[b as usize], &self.screen[c as usize]);
            for k in 0..4 {
                bounds.low[k] = lesser(a[k], lesser(b[k], c[k]));
            }
            for k in 0..4 {
                bounds.high[k] = greater(a[k], greater(b[k], c[k]));
            }
            seen += a[3] + b[3] + c[3];
        }
        if seen.is_nan() {
            self.clip_those_behind(triangles, &mut boxes, cells);
        }
        Items::on_grid(&boxes, cells)
    }

    /// Bounds of those triangles of which a corner is behind the light.
    #[cold]
    #[inline(never)]
    fn clip_those_behind(&self, triangles: &[[u32; 3]], boxes: &mut [BoundingBox], cells: usize) {
        for (&corners, bounds) in triangles.iter().zip(boxes) {
            if corners.iter().any(|&v| self.screen[v as usize][3].is_nan()) {
                let clipped = self.clipped(corners, cells as f64);
                *bounds = clipped.map_or(BoundingBox::NOWHERE, |(low, high)| BoundingBox {
                    low: [low[0], low[1], 0.0, 0.0],
                    high: [high[0], high[1], f32::INFINITY, 0.0],
                });
            }
        }
    }

    /// Bounds on the grid of a triangle that reaches behind the light: it is clipped to the
    /// pyramid over the grid (one cell wider), whose sides leave nothing behind the light.
    #[cold]
    #[inline(never)]
    fn clipped(&self, corners: [u32; 3], cells: f64) -> Option<([f32; 2], [f32; 2])> {
        let corners = corners.map(|v| self.frame.vertex(self.positions[v as usize]).v);
        let everywhere = Some(([0.0; 2], [cells as f32; 2]));
        if may_hold_light(corners) {
            return everywhere;
        }
        let mut polygon = corners.to_vec();
        let sides = [
            DVec3::new(1.0, 0.0, 1.0),
            DVec3::new(-1.0, 0.0, cells + 1.0),
            DVec3::new(0.0, 1.0, 1.0),
            DVec3::new(0.0, -1.0, cells + 1.0),
        ];
        for side in sides {
            polygon = clip(&polygon, side);
        }
        let size = polygon.iter().fold(0.0, |m: f64, v| m.max(v.abs().max_element()));
        if polygon.iter().any(|v| v.z <= size * 1e-9) {
            return everywhere;
        }
        let (mut low, mut high) = ([f32::INFINITY; 2], [f32::NEG_INFINITY; 2]);
        for v in &polygon {
            let at = [(v.x / v.z) as f32, (v.y / v.z) as f32];
            (low, high) = ([0, 1].map(|k| low[k].min(at[k])), [0, 1].map(|k| high[k].max(at[k])));
        }
        (!polygon.is_empty()).then_some((low, high))
    }
}

/// The lesser of two numbers, in one instruction: `f32::min` also looks for NaN.
#[inline(always)]
fn lesser(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

#[inline(always)]
fn greater(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}
/// Whether the box of a triangle reaches to the light: then every segment may end on it.
fn may_hold_light([a, b, c]: [DVec3; 3]) -> bool {
    let (low, high) = (a.min(b).min(c), a.max(b).max(c));
    let pad = low.abs().max(high.abs()) * 1e-9;
    (low - pad).max_element() <= 0.0 && (high + pad).min_element() >= 0.0
}

/// The part of a polygon on the positive side of a plane through the light.
fn clip(polygon: &[DVec3], side: DVec3) -> Vec<DVec3> {
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (k, &v) in polygon.iter().enumerate() {
        let next = polygon[(k + 1) % polygon.len()];
        let (here, there) = (side.dot(v), side.dot(next));
        if here >= 0.0 {
            kept.push(v);
        }
        if (here > 0.0 && there < 0.0) || (here < 0.0 && there > 0.0) {
            kept.push(v + (next - v) * (here / (here - there)));
        }
    }
    kept
}

/// What an f32 position may be off.
#[inline(always)]
fn pad(x: f32) -> f32 {
    1.0 / 1024.0 + x.abs() * (1.0 / 2_097_152.0)
}
