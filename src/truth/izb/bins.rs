//! Receivers sorted into the cells of a light-space grid: a stable counting sort.
#![allow(clippy::needless_range_loop, reason = "loops over indices become vectors")]

use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

use rayon::prelude::*;

use super::super::Receiver;
use super::frame::Frame;
use crate::simd::lanes::{BATCH, Lanes};
use crate::simd::{Kernel, Level};

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

impl Bins {
    /// Sorts the receivers that `members` names.
    pub(super) fn new(
        frame: &Frame,
        receivers: &[Receiver],
        members: Members,
        level: Level,
    ) -> Self {
        let chunk = members.len().div_ceil(rayon::current_num_threads()).max(1);
        let mut cell_of = vec![0_u32; members.len()];
        let count = |(k, cell_of): (usize, &mut [u32])| {
            level.run(Count { frame, receivers, members, first: k * chunk, cell_of })
        };
        let counts = cell_of.par_chunks_mut(chunk).enumerate().map(count).collect();
        let (start, cursors) = offsets(counts, frame.cells);
        let index = sorted(&cell_of, chunk, cursors);
        let mut bins = Self { start, index, cells: frame.cells, ..Self::default() };
        bins.fill(frame, receivers, members, level);
        bins.farthest = bins.farthest_by_block();
        bins
    }

    /// Blocks along one axis.
    pub(super) fn blocks(&self) -> usize {
        self.cells.div_ceil(BLOCK)
    }

    /// Places the receivers in their order.
    fn fill(&mut self, frame: &Frame, receivers: &[Receiver], members: Members, level: Level) {
        const RUN: usize = 1 << 14;
        let n = self.index.len();
        (self.x, self.y) = (vec![0.0; n + LANES], vec![0.0; n + LANES]);
        (self.depth, self.own) = (vec![0.0; n + LANES], vec![0; n + LANES]);
        let places = self.x.par_chunks_mut(RUN).zip(self.y.par_chunks_mut(RUN));
        let others = self.depth.par_chunks_mut(RUN).zip(self.own.par_chunks_mut(RUN));
        let runs = self.index.par_chunks_mut(RUN).zip(places.zip(others));
        runs.for_each(|(index, ((x, y), (depth, own)))| {
            index.iter_mut().for_each(|k| *k = members.index(*k as usize) as u32);
            level.run(Fill { frame, receivers, index, x, y, depth, own });
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
    /// The positions of the next `count` members from `at` on, the last one again in the lanes that
    /// are left.
    #[inline(always)]
    pub(super) fn positions(self, receivers: &[Receiver], at: usize, count: usize) -> [Lanes; 3] {
        let mut p = [Lanes::splat(0.0); 3];
        for k in 0..BATCH {
            let position = receivers[self.index(at + k.min(count - 1))].position;
            (p[0].0[k], p[1].0[k], p[2].0[k]) = (position.x, position.y, position.z);
        }
        p
    }

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

/// Counts the receivers in each cell, and notes the cell of each.
struct Count<'a> {
    frame: &'a Frame,
    receivers: &'a [Receiver],
    members: Members<'a>,
    first: usize,
    cell_of: &'a mut [u32],
}

impl Kernel for Count<'_> {
    type Output = Vec<u32>;

    #[inline(always)]
    fn run(self, _: bool) -> Vec<u32> {
        let cells = self.frame.cells as i32;
        let mut counts = vec![0_u32; self.frame.cells * self.frame.cells];
        for (run, cell_of) in self.cell_of.chunks_mut(BATCH).enumerate() {
            let at = self.first + run * BATCH;
            let p = self.members.positions(self.receivers, at, cell_of.len());
            let [x, y, _] = self.frame.eight(&p).places();
            let (x, y) = (x.narrow(), y.narrow());
            let mut cell = [0; BATCH];
            for k in 0..BATCH {
                let (x, y) = (x[k] as i32, y[k] as i32);
                let (x, y) = (x.clamp(0, cells - 1), y.clamp(0, cells - 1));
                cell[k] = y.wrapping_mul(cells).wrapping_add(x) as u32;
            }
            for (k, cell_of) in cell_of.iter_mut().enumerate() {
                *cell_of = cell[k];
                let count = &mut counts[cell[k] as usize];
                *count = count.wrapping_add(1);
            }
        }
        counts
    }
}

/// Places the receivers that `index` names.
struct Fill<'a> {
    frame: &'a Frame,
    receivers: &'a [Receiver],
    index: &'a [u32],
    x: &'a mut [f32],
    y: &'a mut [f32],
    depth: &'a mut [f32],
    own: &'a mut [u32],
}

impl Kernel for Fill<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self, _: bool) {
        let named = Members::Some(self.index);
        for at in (0..self.index.len()).step_by(BATCH) {
            let count = (self.index.len() - at).min(BATCH);
            let p = named.positions(self.receivers, at, count);
            let [x, y, depth] = self.frame.eight(&p).places();
            let (x, y, depth) = (x.narrow(), y.narrow(), depth.narrow());
            let end = at + count;
            self.x[at..end].copy_from_slice(&x[..count]);
            self.y[at..end].copy_from_slice(&y[..count]);
            self.depth[at..end].copy_from_slice(&depth[..count]);
            for (own, &k) in self.own[at..end].iter_mut().zip(&self.index[at..end]) {
                *own = self.receivers[k as usize].triangle;
            }
        }
    }
}

/// Where each cell starts, and where each chunk's first receiver of each cell goes.
fn offsets(mut cursors: Vec<Vec<u32>>, cells: usize) -> (Vec<u32>, Vec<Vec<u32>>) {
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

/// For each place in the sorted order the member. Places are disjoint between chunks; atomics only
/// say so in safe code.
fn sorted(cell_of: &[u32], chunk: usize, mut cursors: Vec<Vec<u32>>) -> Vec<u32> {
    let mut order = Vec::new();
    let zeros = (0..cell_of.len()).into_par_iter().with_min_len(1 << 16);
    zeros.map(|_| AtomicU32::new(0)).collect_into_vec(&mut order);
    let chunks = cell_of.par_chunks(chunk).zip(&mut cursors).enumerate();
    chunks.for_each(|(c, (cell_of, cursor))| {
        for (k, &cell) in cell_of.iter().enumerate() {
            let place = &mut cursor[cell as usize];
            order[*place as usize].store((c * chunk + k) as u32, Relaxed);
            *place += 1;
        }
    });
    order.into_iter().map(AtomicU32::into_inner).collect()
}
