//! Map points in the order of their cells, and what a pass of triangles over them finds: eight points
//! at a time.
#![allow(clippy::needless_range_loop, reason = "loops over indices become vectors")]

use super::flat::Flat;
use super::{IN_DEPTH, SIDEWAYS, Seen};
use crate::simd::Kernel;
use crate::simd::lanes::BATCH;
use glam::DVec2;

/// Points sorted into cells, about two to a cell. Coordinates are padded, so that eight may be read
/// from the last one on.
#[derive(Debug)]
pub struct Points {
    low: DVec2,
    scale: DVec2,
    cells: usize,
    /// First point of each cell, row by row; one more at the end.
    start: Vec<u32>,
    /// In texels.
    x: Vec<f64>,
    y: Vec<f64>,
    index: Vec<u32>,
    /// The triangles that come near.
    flats: Vec<u32>,
}

/// What is known of each point of [`Points`], structure of arrays, padded as those.
#[derive(Debug, Default)]
pub struct States {
    /// Depth of the nearest certain triangle.
    depth: Vec<f64>,
    /// Depth from which on something else may be met.
    other: Vec<f64>,
    /// The nearest certain triangle.
    id: Vec<u32>,
}

impl Points {
    /// Sorts the points (in texels) of the named `members`.
    pub(super) fn new(points: &[DVec2], members: &[u32], flats: Vec<u32>) -> Self {
        let low = points.iter().copied().fold(DVec2::INFINITY, DVec2::min);
        let high = points.iter().copied().fold(DVec2::NEG_INFINITY, DVec2::max);
        let cells = ((points.len() as f64 / 2.0).sqrt() as usize).clamp(1, 2048);
        let scale = cells as f64 / (high - low).max(DVec2::splat(1e-6));
        let (n, padded) = (points.len(), points.len() + BATCH);
        let mut sorted = Self {
            low,
            scale,
            cells,
            start: vec![0; cells * cells + 1],
            x: vec![0.0; padded],
            y: vec![0.0; padded],
            index: vec![0; n],
            flats,
        };
        let cell = |p: &DVec2| {
            let [x, y] = sorted.cell(*p);
            (y * cells + x) as u32
        };
        let places: Vec<u32> = points.iter().map(cell).collect();
        let (start, order) = counted(&places, cells * cells);
        sorted.start = start;
        for (place, &i) in order.iter().enumerate() {
            (sorted.x[place], sorted.y[place]) = points[i as usize].into();
            sorted.index[place] = members[i as usize];
        }
        sorted
    }

    /// For each point, its place in the caller's list.
    #[must_use]
    pub fn index(&self) -> &[u32] {
        &self.index
    }

    /// The cell of a point; those outside belong to the border's cells. Monotone in each coordinate,
    /// so a box reaches every cell of its points.
    #[inline(always)]
    fn cell(&self, p: DVec2) -> [usize; 2] {
        let at = (p - self.low) * self.scale;
        let last = self.cells as i32 - 1;
        [at.x, at.y].map(|x| (x as i32).clamp(0, last) as usize)
    }
}

/// Where each of `bins` begins, and the items in the order of their bins: a stable counting sort.
pub(super) fn counted(bin_of: &[u32], bins: usize) -> (Vec<u32>, Vec<u32>) {
    let mut start = vec![0; bins + 1];
    bin_of.iter().for_each(|&bin| start[bin as usize + 1] += 1);
    for bin in 0..bins {
        start[bin + 1] += start[bin];
    }
    let (mut next, mut order) = (start.clone(), vec![0; bin_of.len()]);
    for (k, &bin) in bin_of.iter().enumerate() {
        order[next[bin as usize] as usize] = k as u32;
        next[bin as usize] += 1;
    }
    (start, order)
}

impl States {
    /// Forgets everything, for so many points.
    pub(super) fn clear(&mut self, points: usize) {
        let padded = points + BATCH;
        self.depth.clear();
        self.other.clear();
        self.id.clear();
        self.depth.resize(padded, f64::INFINITY);
        self.other.resize(padded, f64::INFINITY);
        self.id.resize(padded, u32::MAX);
    }

    /// What is seen at a point, by its place in the sorted order.
    #[inline]
    #[must_use]
    pub fn seen(&self, place: usize) -> Seen {
        match (self.id[place], self.other[place]) {
            (u32::MAX, f64::INFINITY) => Seen::Nothing,
            (u32::MAX, _) => Seen::Open,
            (id, other) if other > self.depth[place] + IN_DEPTH => Seen::First(id),
            _ => Seen::Open,
        }
    }
}

/// A pass of triangles over points that are moved by `offset` texels.
pub(super) struct Look<'a> {
    pub(super) flats: &'a [Flat],
    pub(super) points: &'a Points,
    pub(super) offset: DVec2,
    pub(super) states: &'a mut States,
}

impl Kernel for Look<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self, _: bool) {
        let Self { flats, points, offset, states } = self;
        for &k in &points.flats {
            let flat = &flats[k as usize];
            let [x0, y0] = points.cell(flat.low - offset);
            let [x1, y1] = points.cell(flat.high - offset);
            for y in y0..=y1 {
                let row = y * points.cells;
                let end = points.start[row + x1 + 1] as usize;
                let mut at = points.start[row + x0] as usize;
                while at < end {
                    let count = (end - at).min(BATCH);
                    if flat.vague {
                        vague(flat, points, offset, at, count, states);
                    } else {
                        meet(flat, points, offset, at, count, states);
                    }
                    at += BATCH;
                }
            }
        }
    }
}

#[inline(always)]
fn lanes<T>(values: &[T], at: usize) -> &[T; BATCH] {
    values[at..at + BATCH].first_chunk().expect("padded")
}

#[inline(always)]
fn lanes_mut<T>(values: &mut [T], at: usize) -> &mut [T; BATCH] {
    values[at..at + BATCH].first_chunk_mut().expect("padded")
}

#[inline(always)]
fn lesser(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// The first `count` points from `at` on meet a triangle whose plane is known.
///
/// Too close to an edge or to the ends of the ray, it *may* be met from `depth - slack` on. Else it
/// certainly is, and what lies behind the nearest of these may be met as well.
#[inline(always)]
fn meet(flat: &Flat, points: &Points, by: DVec2, at: usize, count: usize, states: &mut States) {
    // Copies, so that no store can change what is read: else the loop would not become vectors.
    let (x, y) = (*lanes(&points.x, at), *lanes(&points.y, at));
    let (mut depth, mut other) = (*lanes(&states.depth, at), *lanes(&states.other, at));
    let mut id = *lanes(&states.id, at);
    let [[x0, y0, d0], [x1, y1, d1], [x2, y2, d2]] = flat.edges;
    for k in 0..BATCH {
        let (px, py) = (x[k] + by.x, y[k] + by.y);
        let (e0, e1) = (x0 * px + y0 * py - d0, x1 * px + y1 * py - d1);
        let inside = lesser(lesser(e0, e1), x2 * px + y2 * py - d2);
        let here = flat.plane.x * px + flat.plane.y * py + flat.plane.z;
        let met = (k < count) & (inside >= -SIDEWAYS);
        let unsure = (inside <= SIDEWAYS) | (here <= IN_DEPTH) | (here >= 1.0 - IN_DEPTH);
        let on_the_ray = (here > -flat.slack) & (here < 1.0 + flat.slack);
        let nearer = met & !unsure & (here < depth[k]);
        let behind = if nearer { depth[k] } else { here };
        let from = if unsure { here - flat.slack } else { behind };
        let from = if met & (!unsure | on_the_ray) { from } else { f64::INFINITY };
        other[k] = lesser(from, other[k]);
        depth[k] = if nearer { here } else { depth[k] };
        id[k] = if nearer { flat.id } else { id[k] };
    }
    *lanes_mut(&mut states.depth, at) = depth;
    *lanes_mut(&mut states.other, at) = other;
    *lanes_mut(&mut states.id, at) = id;
}

/// Looks at a triangle whose plane is not known: it may be met anywhere in its box.
#[inline(always)]
fn vague(flat: &Flat, points: &Points, by: DVec2, at: usize, count: usize, states: &mut States) {
    let (x, y) = (lanes(&points.x, at), lanes(&points.y, at));
    let other = lanes_mut(&mut states.other, at);
    for k in 0..count {
        let p = DVec2::new(x[k] + by.x, y[k] + by.y);
        if p.cmpge(flat.low).all() && p.cmple(flat.high).all() {
            other[k] = lesser(flat.nearest, other[k]);
        }
    }
}
