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

    /// Where on a grid of `cells * cells` a triangle may shadow receivers; none where it lies beside.
    #[inline(always)]
    pub(super) fn item(&self, corners: [u32; 3], cells: usize) -> Option<Item> {
        let [a, b, c] = corners;
        let (a, b, c) =
            (&self.screen[a as usize], &self.screen[b as usize], &self.screen[c as usize]);
        let (mut low, mut high) = ([0.0; 4], [0.0; 4]);
        for k in 0..4 {
            low[k] = lesser(a[k], lesser(b[k], c[k]));
        }
        for k in 0..4 {
            high[k] = greater(a[k], greater(b[k], c[k]));
        }
        if (a[2] + b[2] + c[2]).is_nan() {
            let (low, high) = self.clipped(corners, cells as f64)?;
            let [low, high] = [low, high].map(|[x, y]| [x, y, 0.0, 0.0]);
            return on_grid(low, high, f32::INFINITY, cells);
        }
        on_grid(low, high, nearer(high[2]), cells)
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

/// The part of bounds that lies on the grid, widened by the rounding of f32 positions.
#[inline(always)]
fn on_grid(mut low: [f32; 4], mut high: [f32; 4], nearest: f32, cells: usize) -> Option<Item> {
    let end = cells as f32;
    for k in 0..4 {
        low[k] -= pad(low[k]);
    }
    for k in 0..4 {
        high[k] += pad(high[k]);
    }
    let inside = (high[0] >= 0.0) & (low[0] < end) & (high[1] >= 0.0) & (low[1] < end);
    inside.then_some(Item {
        columns: [greater(low[0], -1.0), lesser(high[0], end + 1.0)],
        rows: [row_of(low[1], cells) as u16, row_of(high[1], cells) as u16],
        nearest,
    })
}

/// What an f32 position may be off.
#[inline(always)]
fn pad(x: f32) -> f32 {
    1.0 / 1024.0 + x.abs() * (1.0 / 2_097_152.0)
}
