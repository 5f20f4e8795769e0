//! Where vertices fall on the grid, and which cells a triangle may shadow.

use super::bins::{BLOCK, Bins};
use super::frame::Frame;
use super::work::{Skipped, Skips};
use crate::scene::Geometry;
use crate::simd::lanes::{BATCH, Lanes};
use crate::simd::{Kernel, Level};
use glam::DVec3;
use rayon::prelude::*;

/// A triangle and the cells that it may shadow, both ends included.
#[derive(Clone, Copy, Debug)]
pub(super) struct Item {
    pub(super) columns: [u16; 2],
    pub(super) rows: [u16; 2],
}

/// Grid positions and depths of all vertices in f32 (NaN where a vertex is behind the light or nearly
/// so).
#[derive(Debug)]
pub(super) struct Vertices<'a> {
    frame: &'a Frame,
    positions: &'a [DVec3],
    screen: Vec<[f32; 3]>,
}

/// Some of them.
struct Project<'a> {
    frame: &'a Frame,
    positions: &'a [DVec3],
    screen: &'a mut [[f32; 3]],
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
                *screen = if seen { [sx[k], sy[k], sd[k]] } else { [f32::NAN; 3] };
            }
        }
    }
}

impl<'a> Vertices<'a> {
    pub(super) fn new(frame: &'a Frame, geometry: &'a Geometry, level: Level) -> Self {
        const RUN: usize = 1 << 13;
        let positions = &geometry.positions;
        let mut screen = vec![[0.0; 3]; positions.len()];
        let runs = screen.par_chunks_mut(RUN).zip(positions.par_chunks(RUN));
        runs.for_each(|(screen, positions)| level.run(Project { frame, positions, screen }));
        Self { frame, positions, screen }
    }

    /// The corners of a triangle in the world.
    #[inline(always)]
    pub(super) fn corners(&self, [a, b, c]: [u32; 3]) -> [DVec3; 3] {
        [self.positions[a as usize], self.positions[b as usize], self.positions[c as usize]]
    }

    /// The cells that a triangle may shadow, or why there are none.
    ///
    /// Left out is a triangle whose cells hold no receiver, and one that is farther from the light
    /// than the farthest receiver of its blocks: depth over a triangle is largest at a corner.
    #[inline(always)]
    pub(super) fn item(
        &self,
        corners: [u32; 3],
        bins: &Bins,
        skips: Skips,
    ) -> Result<Item, Skipped> {
        let [a, b, c] = corners;
        let (a, b, c) = (self.screen[a as usize], self.screen[b as usize], self.screen[c as usize]);
        let low = [lesser(a[0], lesser(b[0], c[0])), lesser(a[1], lesser(b[1], c[1]))];
        let high = [greater(a[0], greater(b[0], c[0])), greater(a[1], greater(b[1], c[1]))];
        let nearest = greater(a[2], greater(b[2], c[2]));
        let (low, high, nearest) = if (a[2] + b[2] + c[2]).is_nan() {
            match self.clipped(corners, bins.cells as f64) {
                Some((low, high)) => (low, high, f32::INFINITY),
                None => return Err(Skipped::Outside),
            }
        } else {
            (low, high, nearest)
        };
        match cells(low, high, bins.cells) {
            Some(cells) => shadowing(cells, nearest, bins, skips),
            None => Err(Skipped::Outside),
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

/// The cells that bounds touch, widened by the rounding of f32 positions.
#[inline(always)]
fn cells(low: [f32; 2], high: [f32; 2], cells: usize) -> Option<[[u16; 2]; 2]> {
    let end = cells as f32;
    let (first_x, last_x) = (low[0] - pad(low[0]), high[0] + pad(high[0]));
    let (first_y, last_y) = (low[1] - pad(low[1]), high[1] + pad(high[1]));
    let inside = (last_x >= 0.0) & (first_x < end) & (last_y >= 0.0) & (first_y < end);
    let last = cells as i32 - 1;
    inside.then_some([
        [(first_x as i32).clamp(0, last) as u16, (last_x as i32).clamp(0, last) as u16],
        [(first_y as i32).clamp(0, last) as u16, (last_y as i32).clamp(0, last) as u16],
    ])
}

/// What an f32 position may be off.
#[inline(always)]
fn pad(x: f32) -> f32 {
    1.0 / 1024.0 + x.abs() * (1.0 / 2_097_152.0)
}

/// The item, unless every receiver of its cells is nearer to the light, or there is none.
#[inline(always)]
fn shadowing(
    [columns, rows]: [[u16; 2]; 2],
    nearest: f32,
    bins: &Bins,
    skips: Skips,
) -> Result<Item, Skipped> {
    let mut farthest = f32::INFINITY;
    for row in usize::from(rows[0]) / BLOCK..=usize::from(rows[1]) / BLOCK {
        let base = row * bins.blocks();
        let (left, right) = (usize::from(columns[0]) / BLOCK, usize::from(columns[1]) / BLOCK);
        for &depth in &bins.farthest[base + left..=base + right] {
            farthest = lesser(farthest, depth);
        }
    }
    if skips.empty && (farthest == f32::INFINITY || is_empty(columns, rows, bins)) {
        return Err(Skipped::Empty);
    }
    let margin = 1e-5 * (nearest.abs() + farthest.abs()) + 1e-9;
    if skips.behind && nearest + margin < farthest {
        return Err(Skipped::Behind);
    }
    Ok(Item { columns, rows })
}

/// Whether no receiver lies in the cells.
#[inline(always)]
fn is_empty(columns: [u16; 2], rows: [u16; 2], bins: &Bins) -> bool {
    let (left, right) = (usize::from(columns[0]), usize::from(columns[1]) + 1);
    for row in rows[0]..=rows[1] {
        let run = bins.run(usize::from(row), left, right);
        if run.start < run.end {
            return false;
        }
    }
    true
}
