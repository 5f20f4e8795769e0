//! Receivers sorted into the cells of a light-space grid: a stable counting sort.

use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

use rayon::prelude::*;

use super::super::Receiver;
use super::frame::Frame;

/// Vectors read this many receivers at once, so arrays are padded by as many.
pub(super) const LANES: usize = 16;

/// Cells per side of a block, over which the farthest receiver is known.
pub(super) const BLOCK: usize = 8;

/// Structure of arrays over the receivers of one frame, in the order of their cells.
#[derive(Debug, Default)]
pub(super) struct Bins {
    /// Grid position, rounded to f32.
    pub(super) x: Vec<f32>,
    pub(super) y: Vec<f32>,
    /// Depth towards the light, rounded to f32.
    pub(super) depth: Vec<f32>,
    /// The receiver's own triangle.
    pub(super) own: Vec<u32>,
    /// Index of the receiver in the caller's slice.
    pub(super) index: Vec<u32>,
    /// First receiver of each cell, row by row; one more at the end.
    pub(super) start: Vec<u32>,
    /// The smallest depth in each block of cells: its farthest receiver. Infinite where empty.
    pub(super) farthest: Vec<f32>,
    pub(super) cells: usize,
}

/// A receiver before sorting.
#[derive(Clone, Copy, Default)]
struct Placed {
    x: f32,
    y: f32,
    depth: f32,
    own: u32,
}

impl Placed {
    #[inline(always)]
    fn cell(self, cells: usize) -> usize {
        let clamp = |x: f32| (x.max(0.0) as usize).min(cells - 1);
        clamp(self.y) * cells + clamp(self.x)
    }
}

impl Bins {
    /// Sorts the receivers that `members` names.
    pub(super) fn new(frame: &Frame, receivers: &[Receiver], members: Members) -> Self {
        let cells = frame.cells;
        let chunk = members.len().div_ceil(rayon::current_num_threads()).max(1);
        let placed = placed(frame, receivers, members, chunk);
        let (start, mut cursors) = offsets(&placed, chunk, cells);
        let order = sorted(&placed, chunk, cells, &mut cursors);
        let mut bins = Self { start, cells, ..Self::default() };
        bins.fill(order, &placed, members);
        bins.farthest = bins.farthest_by_block();
        bins
    }

    /// Blocks along one axis.
    pub(super) fn blocks(&self) -> usize {
        self.cells.div_ceil(BLOCK)
    }

    /// Puts the receivers into their order, all arrays in one pass.
    fn fill(&mut self, order: Vec<AtomicU32>, placed: &[Placed], members: Members) {
        const RUN: usize = 1 << 16;
        let n = order.len();
        self.index = order.into_iter().map(AtomicU32::into_inner).collect();
        (self.x, self.y) = (vec![0.0; n + LANES], vec![0.0; n + LANES]);
        (self.depth, self.own) = (vec![0.0; n + LANES], vec![0; n + LANES]);
        let places = self.x.par_chunks_mut(RUN).zip(self.y.par_chunks_mut(RUN));
        let others = self.depth.par_chunks_mut(RUN).zip(self.own.par_chunks_mut(RUN));
        let runs = self.index.par_chunks_mut(RUN).zip(places.zip(others));
        runs.for_each(|(index, ((x, y), (depth, own)))| {
            for (k, index) in index.iter_mut().enumerate() {
                let at = placed[*index as usize];
                (x[k], y[k], depth[k], own[k]) = (at.x, at.y, at.depth, at.own);
                *index = members.index(*index as usize) as u32;
            }
        });
    }

    fn farthest_by_block(&self) -> Vec<f32> {
        let blocks = self.blocks();
        let mut farthest = vec![f32::INFINITY; blocks * blocks];
        farthest.par_chunks_mut(blocks).enumerate().for_each(|(block_row, farthest)| {
            let rows = block_row * BLOCK..((block_row + 1) * BLOCK).min(self.cells);
            for row in rows {
                for (column, least) in farthest.iter_mut().enumerate() {
                    let end = ((column + 1) * BLOCK).min(self.cells);
                    let run = &self.depth[self.run(row, column * BLOCK, end)];
                    *least = run.iter().fold(*least, |m, &x| if x < m { x } else { m });
                }
            }
        });
        farthest
    }

    /// Receivers of the cells `first..end` of a row.
    #[inline(always)]
    pub(super) fn run(&self, row: usize, first: usize, end: usize) -> std::ops::Range<usize> {
        let base = row * self.cells;
        self.start[base + first] as usize..self.start[base + end] as usize
    }
}

/// The receivers of a frame.
#[derive(Clone, Copy, Debug)]
pub(super) enum Members<'a> {
    /// All of so many.
    All(usize),
    /// Those with these indices.
    Some(&'a [u32]),
}

impl Members<'_> {
    pub(super) fn len(self) -> usize {
        match self {
            Self::All(len) => len,
            Self::Some(members) => members.len(),
        }
    }

    #[inline(always)]
    pub(super) fn index(self, k: usize) -> usize {
        match self {
            Self::All(_) => k,
            Self::Some(members) => members[k] as usize,
        }
    }
}

/// Light-space places in the order of `members`.
fn placed(frame: &Frame, receivers: &[Receiver], members: Members, chunk: usize) -> Vec<Placed> {
    let place = |k: usize| {
        let receiver = &receivers[members.index(k)];
        let [x, y, depth] = frame.place(receiver.position).map(|x| x as f32);
        Placed { x, y, depth, own: receiver.triangle }
    };
    let mut placed = Vec::new();
    (0..members.len()).into_par_iter().with_min_len(chunk).map(place).collect_into_vec(&mut placed);
    placed
}

/// Where each cell starts, and where each chunk's first receiver of each cell goes.
fn offsets(placed: &[Placed], chunk: usize, cells: usize) -> (Vec<u32>, Vec<Vec<u32>>) {
    let count = |placed: &[Placed]| {
        let mut counts = vec![0_u32; cells * cells];
        placed.iter().for_each(|p| counts[p.cell(cells)] += 1);
        counts
    };
    let mut cursors: Vec<Vec<u32>> = placed.par_chunks(chunk).map(count).collect();
    let mut start = Vec::with_capacity(cells * cells + 1);
    let mut sum = 0;
    for cell in 0..cells * cells {
        start.push(sum);
        for cursor in &mut cursors {
            let counted = std::mem::replace(&mut cursor[cell], sum);
            sum += counted;
        }
    }
    start.push(sum);
    (start, cursors)
}

/// For each place in the sorted order the position in `placed`. Places are disjoint between
/// chunks; atomics only say so in safe code.
fn sorted(
    placed: &[Placed],
    chunk: usize,
    cells: usize,
    cursors: &mut [Vec<u32>],
) -> Vec<AtomicU32> {
    let mut order = Vec::new();
    let zeros = (0..placed.len()).into_par_iter().with_min_len(1 << 16);
    zeros.map(|_| AtomicU32::new(0)).collect_into_vec(&mut order);
    placed.par_chunks(chunk).zip(cursors).enumerate().for_each(|(c, (placed, cursor))| {
        for (k, p) in placed.iter().enumerate() {
            let place = &mut cursor[p.cell(cells)];
            order[*place as usize].store((c * chunk + k) as u32, Relaxed);
            *place += 1;
        }
    });
    order
}
