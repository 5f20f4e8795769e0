//! Map points and triangles sorted into blocks of the map, so that each triangle meets only the points
//! near it and what is known of these stays in the cache.

use super::SIDEWAYS;
use super::flat::Flat;
use super::points::{Points, counted};
use glam::DVec2;
use rayon::prelude::*;

/// Points of a block, on average over the box of all.
const POINTS: usize = 2048;

/// Points and triangles by block.
#[derive(Debug)]
pub(super) struct Blocks {
    /// Width and height of the map in texels.
    size: DVec2,
    /// First point of each block; one more at the end.
    start: Vec<u32>,
    order: Vec<u32>,
    /// Triangles that come near each block.
    flats: Vec<Vec<u32>>,
}

/// A grid over the box of all points.
#[derive(Clone, Copy, Debug)]
struct Grid {
    side: usize,
    low: DVec2,
    scale: DVec2,
}

impl Grid {
    fn new(texels: &[DVec2]) -> Self {
        let low = texels.iter().copied().fold(DVec2::INFINITY, DVec2::min);
        let high = texels.iter().copied().fold(DVec2::NEG_INFINITY, DVec2::max);
        let side = ((texels.len() / POINTS) as f64).sqrt().ceil().clamp(1.0, 256.0);
        Self { side: side as usize, low, scale: side / (high - low).max(DVec2::splat(1e-6)) }
    }

    /// The block of a place; those outside belong to the border's blocks.
    fn block(&self, p: DVec2) -> [usize; 2] {
        let at = (p - self.low) * self.scale;
        [at.x, at.y].map(|x| (x as i32).clamp(0, self.side as i32 - 1) as usize)
    }

    /// Whether the box of a triangle, widened by `pad`, meets the grid; and the blocks that it meets.
    fn blocks(&self, flat: &Flat, pad: f64) -> Option<[[usize; 2]; 2]> {
        let (low, high) = (flat.low - pad, flat.high + pad);
        let end = self.low + self.side as f64 / self.scale + pad;
        let outside = high.cmplt(self.low).any() || low.cmpgt(end).any();
        (!outside).then(|| [self.block(low), self.block(high)])
    }
}

impl Blocks {
    /// Sorts `points` (map coordinates) and the triangles within `reach` texels of them.
    pub(super) fn new(points: &[DVec2], size: DVec2, flats: &[Flat], reach: f64) -> Self {
        let texels: Vec<DVec2> = points.par_iter().map(|p| *p * size).collect();
        let grid = Grid::new(&texels);
        let block = |p: &DVec2| {
            let [x, y] = grid.block(*p);
            (y * grid.side + x) as u32
        };
        let places: Vec<u32> = texels.par_iter().map(block).collect();
        let ((start, order), flats) = rayon::join(
            || counted(&places, grid.side * grid.side),
            || near(&grid, flats, reach + SIDEWAYS),
        );
        Self { size, start, order, flats }
    }

    pub(super) fn count(&self) -> usize {
        self.flats.len()
    }

    /// The points of a block, in texels.
    pub(super) fn points(&self, k: usize, points: &[DVec2]) -> Points {
        let members = &self.order[self.start[k] as usize..self.start[k + 1] as usize];
        let texels: Vec<DVec2> = members.iter().map(|&i| points[i as usize] * self.size).collect();
        let flats = if members.is_empty() { Vec::new() } else { self.flats[k].clone() };
        Points::new(&texels, members, flats)
    }
}

/// The triangles that come within `pad` texels of each block, in their order.
fn near(grid: &Grid, flats: &[Flat], pad: f64) -> Vec<Vec<u32>> {
    let mut near = vec![Vec::new(); grid.side * grid.side];
    for (id, flat) in flats.iter().enumerate() {
        let Some([[x0, y0], [x1, y1]]) = grid.blocks(flat, pad) else { continue };
        for y in y0..=y1 {
            let row = &mut near[y * grid.side..];
            row[x0..=x1].iter_mut().for_each(|list| list.push(id as u32));
        }
    }
    near
}
