//! One tile of the target while it is drawn: keys, depths and triangles, eight pixels at a time.
#![allow(clippy::needless_range_loop, reason = "loops over indices become vectors")]

use super::NO_TRIANGLE;
use super::plane::{Plane, Row};
use super::test::DepthTest;
use super::tiny::Pixels;
use crate::simd::lanes::BATCH;

/// Pixels along each side of a tile.
pub(super) const TILE: u32 = 64;

/// Rows are longer than the tile, so that eight pixels may begin at its last one.
const STRIDE: usize = TILE as usize + BATCH;

/// The pixels of a tile, 12 bytes each.
#[derive(Clone, Debug)]
pub(super) struct Tile {
    keys: Vec<u32>,
    /// Bit patterns.
    depth: Vec<u32>,
    triangle: Vec<u32>,
    test: DepthTest,
}

impl Tile {
    pub(super) fn new(test: DepthTest) -> Self {
        let n = STRIDE * TILE as usize;
        Self { keys: vec![0; n], depth: vec![0; n], triangle: vec![0; n], test }
    }

    /// Depth 1 and no triangle everywhere.
    #[inline(always)]
    pub(super) fn clear(&mut self) {
        self.keys.fill(self.test.codes([1.0; BATCH])[0]);
        self.depth.fill(1.0f32.to_bits());
        self.triangle.fill(NO_TRIANGLE);
    }

    /// Tests eight fragments of a triangle at (x, y) of the tile, and keeps those that are not
    /// outside (negative) and nearer than what is there.
    #[inline(always)]
    pub(super) fn draw(
        &mut self,
        [x, y]: [u32; 2],
        outside: [i32; BATCH],
        z: [f32; BATCH],
        id: u32,
    ) {
        let at = Self::place([x, y]);
        let (keys, depth, triangle) =
            (lanes(&mut self.keys, at), lanes(&mut self.depth, at), lanes(&mut self.triangle, at));
        let z = self.test.kept(z);
        let codes = self.test.codes(z);
        // All bits where the fragment wins.
        let mut wins = [0; BATCH];
        for k in 0..BATCH {
            let nearer = 0u32.wrapping_sub(u32::from(codes[k] < keys[k]));
            wins[k] = !((outside[k] >> 31) as u32) & nearer;
        }
        let mut bits = [0; BATCH];
        for k in 0..BATCH {
            bits[k] = z[k].to_bits();
        }
        *keys = pick(&wins, &codes, keys);
        *depth = pick(&wins, &bits, depth);
        *triangle = pick(&wins, &[id; BATCH], triangle);
    }

    /// Where a pixel of the tile lies.
    #[inline(always)]
    pub(super) fn place([x, y]: [u32; 2]) -> usize {
        y as usize * STRIDE + x as usize
    }

    /// Tests the `covered` ones of eight pixels beside the one at `corner`, and keeps those fragments
    /// that are nearer than what is there.
    #[inline(always)]
    pub(super) fn draw_each(
        &mut self,
        corner: usize,
        pixels: &Pixels,
        mut covered: u32,
        z: [f32; BATCH],
        id: u32,
    ) {
        let z = self.test.kept(z);
        let codes = self.test.codes(z);
        while covered != 0 {
            let k = (covered.trailing_zeros() as usize) % BATCH;
            covered &= covered - 1;
            let at = corner + pixels.y[k] as usize * STRIDE + pixels.x[k] as usize;
            if codes[k] < self.keys[at] {
                (self.keys[at], self.depth[at]) = (codes[k], z[k].to_bits());
                self.triangle[at] = id;
            }
        }
    }

    /// Copies a row.
    #[inline(always)]
    pub(super) fn copy_row(&self, y: usize, depth: &mut [f32], triangle: &mut [u32]) {
        let first = y * STRIDE;
        triangle.copy_from_slice(&self.triangle[first..first + triangle.len()]);
        for (depth, &bits) in depth.iter_mut().zip(&self.depth[first..]) {
            *depth = f32::from_bits(bits);
        }
    }
}

#[inline(always)]
fn pick(wins: &[u32; BATCH], new: &[u32; BATCH], old: &[u32; BATCH]) -> [u32; BATCH] {
    let mut picked = [0; BATCH];
    for k in 0..BATCH {
        picked[k] = (new[k] & wins[k]) | (old[k] & !wins[k]);
    }
    picked
}

#[inline(always)]
fn lanes<T>(values: &mut [T], at: usize) -> &mut [T; BATCH] {
    values[at..at + BATCH].first_chunk_mut().expect("as long as that")
}

/// A depth plane of which eight pixels are evaluated at a time, as [`super::Row::at`] does one.
pub(super) trait Surface: Copy {
    /// What a row of pixels shares.
    type Row: Copy;
    fn row(&self, py: f32) -> Self::Row;
    fn along(row: Self::Row, px: u32) -> [f32; BATCH];
}

/// [`Plane::Exact`]: gradient · (px, py, 1).
#[derive(Clone, Copy, Debug)]
pub(super) struct Exact(pub(super) [f64; 3]);

impl Exact {
    /// The depths of eight pixels beside one: what [`Surface::along`] gives each.
    #[inline(always)]
    pub(super) fn scattered(&self, [px, py]: [i32; 2], pixels: &Pixels) -> [f32; BATCH] {
        let [a, b, c] = self.0;
        let mut depths = [0.0; BATCH];
        for k in 0..BATCH {
            let base = b * f64::from(py.wrapping_add(pixels.y[k])) + c;
            depths[k] = (a * f64::from(px.wrapping_add(pixels.x[k])) + base) as f32;
        }
        depths
    }
}

impl Surface for Exact {
    type Row = [f64; 2];

    #[inline(always)]
    fn row(&self, py: f32) -> [f64; 2] {
        [self.0[0], self.0[1] * f64::from(py) + self.0[2]]
    }

    #[inline(always)]
    fn along([slope, base]: [f64; 2], px: u32) -> [f32; BATCH] {
        let first = f64::from(px as i32);
        let mut depths = [0.0; BATCH];
        for k in 0..BATCH {
            depths[k] = (slope * (first + k as f64) + base) as f32;
        }
        depths
    }
}

impl Surface for Plane {
    type Row = Row;

    #[inline(always)]
    fn row(&self, py: f32) -> Row {
        Self::row(self, py)
    }

    #[inline(always)]
    fn along(row: Row, px: u32) -> [f32; BATCH] {
        let first = px as i32 as f32;
        match row {
            Row::Exact { slope, base } => Exact::along([slope, base], px),
            Row::Measured { x, slope, base, offset } => {
                let mut depths = [0.0; BATCH];
                for k in 0..BATCH {
                    depths[k] = (((first + k as f32) - x) * slope + base) + offset;
                }
                depths
            }
        }
    }
}
