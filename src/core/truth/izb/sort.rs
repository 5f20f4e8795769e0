//! Sorting the receivers of a frame: first by row, stably, then each row by column.
#![allow(clippy::needless_range_loop, reason = "loops over indices become vectors")]

use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

use rayon::prelude::*;

use super::super::Receiver;
use super::bins::{Bins, Block, Group, LANES, ROWS, Row, farther, row_of};
use super::frame::{Frame, Reach};
use super::members::Members;
use crate::simd::lanes::BATCH;
use crate::simd::{Kernel, Level};

/// The receivers that `members` names, sorted; none unless all of them lie in the grid of the frame.
pub(super) fn sorted(
    frame: &Frame,
    receivers: &[Receiver],
    members: Members,
    level: Level,
) -> Option<Bins> {
    let chunk = members.len().div_ceil(rayon::current_num_threads()).max(1);
    let mut row_numbers = vec![0_u16; members.len()];
    let look = |(k, rows): (usize, &mut [u16])| {
        level.run(Look { frame, receivers, members, first: k * chunk, rows })
    };
    let looks: Option<Vec<_>> = row_numbers.par_chunks_mut(chunk).enumerate().map(look).collect();
    let looks = looks?;
    let mut bins = Bins::default();
    let mut rows = Vec::with_capacity(frame.cells);
    let (mut blocks, mut entries) = (0, 0);
    for row in 0..frame.cells {
        let all = looks.iter().fold(Extent::EMPTY, |all, look| all.joined(look[row]));
        let row = Row::new([all.low, all.high], all.count, entries);
        bins.rows.push(row);
        rows.push(Extent { first: blocks * LANES as u32, ..all });
        entries += row.entries() as u32;
        blocks += all.count.div_ceil(LANES as u32);
    }
    bins.index = by_row(&row_numbers, chunk, &looks, &rows, blocks as usize * LANES);
    bins.starts = vec![0; entries as usize];
    bins.farthest = vec![0.0; blocks as usize];
    bins.groups =
        bins.by_column(&rows, |jobs| level.run(Columns { frame, receivers, members, jobs }));
    Some(bins)
}

/// What lies in a row.
#[derive(Clone, Copy, Debug)]
struct Extent {
    count: u32,
    low: f32,
    high: f32,
    /// The place of its first receiver.
    first: u32,
}

impl Extent {
    const EMPTY: Self = Self { count: 0, low: f32::INFINITY, high: f32::NEG_INFINITY, first: 0 };

    fn joined(self, other: Self) -> Self {
        let (low, high) = (self.low.min(other.low), self.high.max(other.high));
        Self { count: self.count + other.count, low, high, ..self }
    }
}

/// Notes the row of each receiver of a chunk, and what lies in each row; none where one lies outside
/// of the grid.
struct Look<'a> {
    frame: &'a Frame,
    receivers: &'a [Receiver],
    members: Members<'a>,
    first: usize,
    rows: &'a mut [u16],
}

impl Kernel for Look<'_> {
    type Output = Option<Vec<Extent>>;

    #[inline(always)]
    fn run(self, _: bool) -> Self::Output {
        let cells = self.frame.cells;
        let mut extents = vec![Extent::EMPTY; cells];
        let mut reach = Reach::default();
        for (run, noted) in self.rows.chunks_mut(BATCH).enumerate() {
            let at = self.first + run * BATCH;
            let eight = self.frame.eight(&self.members.positions(self.receivers, at, noted.len()));
            let places = eight.places();
            reach.add(&eight, &places);
            let (x, y) = (places[0].narrow(), places[1].narrow());
            let mut row = [0; BATCH];
            for k in 0..BATCH {
                row[k] = row_of(y[k], cells);
            }
            for (k, noted) in noted.iter_mut().enumerate() {
                *noted = row[k] as u16;
                let here = &mut extents[row[k]];
                here.count = here.count.wrapping_add(1);
                here.low = if x[k] < here.low { x[k] } else { here.low };
                here.high = if x[k] > here.high { x[k] } else { here.high };
            }
        }
        self.frame.contains(&reach).then_some(extents)
    }
}

/// For each place the member, by rows. Places are disjoint between chunks; atomics only say so in
/// safe code.
fn by_row(
    numbers: &[u16],
    chunk: usize,
    looks: &[Vec<Extent>],
    rows: &[Extent],
    places: usize,
) -> Vec<u32> {
    let mut next: Vec<u32> = rows.iter().map(|row| row.first).collect();
    let mut cursors = Vec::with_capacity(looks.len());
    for look in looks {
        cursors.push(next.clone());
        next.iter_mut().zip(look).for_each(|(next, row)| *next += row.count);
    }
    let mut order = Vec::new();
    let nobody = (0..places).into_par_iter().with_min_len(1 << 16);
    nobody.map(|_| AtomicU32::new(u32::MAX)).collect_into_vec(&mut order);
    let chunks = numbers.par_chunks(chunk).zip(&mut cursors).enumerate();
    chunks.for_each(|(c, (numbers, cursor))| {
        for (k, &row) in numbers.iter().enumerate() {
            let place = &mut cursor[usize::from(row)];
            order[*place as usize].store((c * chunk + k) as u32, Relaxed);
            *place += 1;
        }
    });
    order.into_iter().map(AtomicU32::into_inner).collect()
}

/// A row to be sorted by column, and where.
struct Job<'a> {
    row: Row,
    extent: Extent,
    starts: &'a mut [u32],
    farthest: &'a mut [f32],
    index: &'a mut [u32],
}

impl Bins {
    /// Does the `work` on all rows, some at a time.
    fn by_column(
        &mut self,
        rows: &[Extent],
        work: impl Fn(&mut [Job]) -> Group + Sync + Send,
    ) -> Vec<Group> {
        let mut left = (&mut self.starts[..], &mut self.farthest[..], &mut self.index[..]);
        let mut jobs = Vec::with_capacity(rows.len());
        for (&row, &extent) in self.rows.iter().zip(rows) {
            let blocks = (extent.count as usize).div_ceil(LANES);
            jobs.push(Job {
                row,
                extent,
                starts: cut(&mut left.0, row.entries()),
                farthest: cut(&mut left.1, blocks),
                index: cut(&mut left.2, blocks * LANES),
            });
        }
        jobs.par_chunks_mut(ROWS).map(work).collect()
    }
}

/// Takes the first `count` items off a slice.
fn cut<'a, T>(left: &mut &'a mut [T], count: usize) -> &'a mut [T] {
    let (taken, rest) = std::mem::take(left).split_at_mut(count);
    *left = rest;
    taken
}

/// Sorts rows by column, and places their receivers.
struct Columns<'a, 'b> {
    frame: &'a Frame,
    receivers: &'a [Receiver],
    members: Members<'a>,
    jobs: &'a mut [Job<'b>],
}

/// The receivers of a row on their way to their places, side by side; eight more than there are.
#[derive(Debug, Default)]
struct Records {
    x: Vec<f32>,
    y: Vec<f32>,
    depth: Vec<f32>,
    column: Vec<u32>,
    own: Vec<u32>,
    index: Vec<u32>,
}

impl Kernel for Columns<'_, '_> {
    type Output = Group;

    #[inline(always)]
    fn run(self, _: bool) -> Group {
        let mut records = Records::default();
        let mut blocks = Vec::with_capacity(self.jobs.iter().map(|job| job.farthest.len()).sum());
        for job in &mut *self.jobs {
            let named = &mut job.index[..job.extent.count as usize];
            named.iter_mut().for_each(|k| *k = self.members.index(*k as usize) as u32);
            records.fill(self.frame, self.receivers, named, &job.row);
            let before = blocks.len();
            blocks.resize(before + job.farthest.len(), Block::EMPTY);
            job.place(&records, &mut blocks[before..]);
        }
        Group::new(self.jobs[0].extent.first, blocks)
    }
}

impl Records {
    /// The receivers with these indices, in their order.
    #[inline(always)]
    fn fill(&mut self, frame: &Frame, receivers: &[Receiver], index: &[u32], row: &Row) {
        let len = index.len() + BATCH;
        for values in [&mut self.x, &mut self.y, &mut self.depth] {
            values.resize(len, 0.0);
        }
        self.column.resize(len, 0);
        self.own.resize(len, 0);
        self.index.clear();
        self.index.extend_from_slice(index);
        for (run, index) in index.chunks(BATCH).enumerate() {
            let here = run * BATCH..run * BATCH + BATCH;
            let p = Members::Some(index).positions(receivers, 0, index.len());
            let [x, y, depth] = frame.eight(&p).places();
            let (x, y, depth) = (x.narrow(), y.narrow(), depth.narrow());
            let mut column = [0; BATCH];
            for k in 0..BATCH {
                column[k] = row.column(x[k]);
            }
            self.x[here.clone()].copy_from_slice(&x);
            self.y[here.clone()].copy_from_slice(&y);
            self.depth[here.clone()].copy_from_slice(&depth);
            self.column[here.clone()].copy_from_slice(&column);
            for (own, &k) in self.own[here].iter_mut().zip(index) {
                *own = receivers[k as usize].triangle;
            }
        }
    }
}

impl Job<'_> {
    /// Puts the receivers of the row in the order of their columns: a stable counting sort.
    #[inline(always)]
    fn place(&mut self, records: &Records, blocks: &mut [Block]) {
        let count = records.index.len();
        for &column in &records.column[..count] {
            let start = &mut self.starts[column as usize + 1];
            *start = start.wrapping_add(1);
        }
        let mut sum = 0_u32;
        for start in &mut *self.starts {
            sum = sum.wrapping_add(*start);
            *start = sum;
        }
        for k in 0..count {
            // Runs ahead to the end of the column; moved back by one column below.
            let start = &mut self.starts[records.column[k] as usize];
            let place = *start as usize;
            *start = start.wrapping_add(1);
            let (block, lane) = (&mut blocks[place / LANES], place % LANES);
            (block.x[lane], block.y[lane]) = (records.x[k], records.y[k]);
            (block.depth[lane], block.own[lane]) = (records.depth[k], records.own[k]);
            self.index[place] = records.index[k];
        }
        let columns = self.starts.len() - 1;
        self.starts.copy_within(..columns, 1);
        self.starts[0] = 0;
        for start in &mut *self.starts {
            *start = start.wrapping_add(self.extent.first);
        }
        for (farthest, block) in self.farthest.iter_mut().zip(&*blocks) {
            *farthest = farther(block.least_depth());
        }
    }
}
