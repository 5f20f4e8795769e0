//! One tile of the target while it is drawn: keys, depths and triangles, eight pixels at a time.
#![allow(clippy::needless_range_loop, reason = "loops over indices become vectors")]

use super::NO_TRIANGLE;
use super::plane::{Plane, Row};
use super::test::Test;
use crate::simd::lanes::BATCH;

/// Pixels of a tile along x and y. Wide tiles are copied to fewer pages, and low ones stay near.
pub(super) const TILE: [u32; 2] = [128, 32];

/// Rows are longer than the tile, so that eight pixels may begin at its last one.
const STRIDE: usize = TILE[0] as usize + BATCH;

/// The pixels of a tile, 12 bytes each. (Making keys anew of the depths would save a store, but the
/// next fragment waits longer: measured a third slower.)
#[derive(Clone, Debug)]
pub(super) struct Tile<T> {
    rows: Vec<Pixels>,
    test: T,
}

/// A row of them.
#[derive(Clone, Copy, Debug)]
struct Pixels {
    keys: [u32; STRIDE],
    /// Bit patterns.
    depth: [u32; STRIDE],
    triangle: [u32; STRIDE],
}

impl<T: Test> Tile<T> {
    pub(super) fn new(test: T) -> Self {
        let zero = [0; STRIDE];
        let row = Pixels { keys: zero, depth: zero, triangle: zero };
        Self { rows: vec![row; TILE[1] as usize], test }
    }

    /// The cleared depth and no triangle everywhere.
    #[inline(always)]
    pub(super) fn clear(&mut self) {
        let cleared = self.test.cleared();
        let key = self.test.codes([cleared; BATCH])[0];
        for row in &mut self.rows {
            row.keys.fill(key);
            row.depth.fill(cleared.to_bits());
            row.triangle.fill(NO_TRIANGLE);
        }
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
        let row = &mut self.rows[y as usize];
        let (keys, depth, triangle) =
            (lanes(&mut row.keys, x), lanes(&mut row.depth, x), lanes(&mut row.triangle, x));
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

    /// Copies a row.
    #[inline(always)]
    pub(super) fn copy_row(&self, y: usize, depth: &mut [f32], triangle: &mut [u32]) {
        let row = &self.rows[y];
        triangle.copy_from_slice(&row.triangle[..triangle.len()]);
        for (depth, &bits) in depth.iter_mut().zip(&row.depth) {
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
fn lanes(values: &mut [u32; STRIDE], at: u32) -> &mut [u32; BATCH] {
    values[at as usize..at as usize + BATCH].first_chunk_mut().expect("as long as that")
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
    /// What eight pixels from `px` on add to the depth of their row.
    #[inline(always)]
    pub(super) fn across(&self, px: i32) -> [f64; BATCH] {
        let first = f64::from(px);
        let mut across = [0.0; BATCH];
        for k in 0..BATCH {
            across[k] = self.0[0] * (first + k as f64);
        }
        across
    }

    /// The depths of those pixels in a row: what [`Surface::along`] gives each.
    #[inline(always)]
    pub(super) fn depths(&self, across: &[f64; BATCH], py: i32) -> [f32; BATCH] {
        let base = self.0[1] * f64::from(py) + self.0[2];
        let mut depths = [0.0; BATCH];
        for k in 0..BATCH {
            depths[k] = (across[k] + base) as f32;
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
