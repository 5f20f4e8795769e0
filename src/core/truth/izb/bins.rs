//! Receivers by rows of a light-space grid, and by columns within each row.
//!
//! Rows are one grid unit high. Each is as long as its own receivers reach and has as many columns
//! as they need, none wider than a unit: where a camera sees much of a small place, cells are small.

use std::ops::Range;

/// Vectors test this many receivers at once.
pub(super) const LANES: usize = 16;

/// Receivers in a column, on average, where they lie densely.
const PER_COLUMN: u32 = 2;

/// Rows that are sorted and kept together.
pub(super) const ROWS: usize = 16;

/// No row has many more columns than these.
const MOST_COLUMNS: u32 = 1 << 20;

/// Sixteen receivers side by side, one cache line an array. Lanes without a receiver hold no number,
/// and so pass no test.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(super) struct Block {
    /// Grid position, rounded to f32.
    pub(super) x: [f32; LANES],
    pub(super) y: [f32; LANES],
    /// Depth towards the light, rounded to f32.
    pub(super) depth: [f32; LANES],
    /// The receiver's own triangle.
    pub(super) own: [u32; LANES],
}

impl Block {
    pub(super) const EMPTY: Self = Self {
        x: [f32::NAN; LANES],
        y: [f32::NAN; LANES],
        depth: [f32::INFINITY; LANES],
        own: [u32::MAX; LANES],
    };

    /// The smallest depth, found by halves.
    #[inline(always)]
    pub(super) fn least_depth(&self) -> f32 {
        let (mut least, mut half) = (self.depth, LANES / 2);
        while half > 0 {
            for k in 0..half {
                let other = least[k + half];
                least[k] = if other < least[k] { other } else { least[k] };
            }
            half /= 2;
        }
        least[0]
    }
}

/// The row of a grid position: it grows with the position.
#[inline(always)]
pub(super) fn row_of(y: f32, rows: usize) -> usize {
    nearest(y - 0.5, (rows - 1) as f32) as usize
}

/// The integer nearest to a number clamped to 0 … `last` (0 of no number), both below 2²²: the sum with
/// 2²³ has a last place of 1.
#[inline(always)]
fn nearest(x: f32, last: f32) -> u32 {
    const ONES: f32 = (1 << 23) as f32;
    let x = if x > 0.0 { x } else { 0.0 };
    let x = if x < last { x } else { last };
    (x + ONES).to_bits().wrapping_sub(ONES.to_bits())
}

/// A row of the grid.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row {
    /// Where its first and last receiver lie.
    low: f32,
    high: f32,
    /// Columns per unit.
    scale: f32,
    /// Its last column.
    last: f32,
    /// The first of its entries in [`Bins::starts`].
    first: u32,
}

impl Row {
    /// A row of so many receivers between `low` and `high`, whose starts begin at `first`.
    pub(super) fn new([low, high]: [f32; 2], receivers: u32, first: u32) -> Self {
        if receivers == 0 {
            return Self { low: 0.0, high: -1.0, scale: 0.0, last: 0.0, first };
        }
        let width = high - low;
        let last = (receivers / PER_COLUMN).min(MOST_COLUMNS).max(width as u32 + 1);
        Self { low, high, scale: last as f32 / width, last: last as f32, first }
    }

    /// How many entries of [`Bins::starts`] it has: its columns, and one for its end.
    pub(super) fn entries(&self) -> usize {
        self.last as usize + 2
    }

    /// The column of a position: it grows with the position.
    #[inline(always)]
    pub(super) fn column(&self, x: f32) -> u32 {
        nearest((x - self.low) * self.scale, self.last)
    }
}

/// Blocks of some rows that lie together.
#[derive(Debug)]
pub(super) struct Group {
    /// The place of its first lane.
    first: usize,
    blocks: Vec<Block>,
}

impl Group {
    pub(super) fn new(first: u32, blocks: Vec<Block>) -> Self {
        Self { first: first as usize, blocks }
    }

    /// The block of a place.
    #[inline(always)]
    pub(super) fn block(&self, place: usize) -> &Block {
        &self.blocks[place.wrapping_sub(self.first) / LANES]
    }
}

/// The receivers of one frame. A *place* is a lane of a block: sixteen times the block plus the lane.
#[derive(Debug, Default)]
pub(super) struct Bins {
    pub(super) rows: Vec<Row>,
    /// The place of the first receiver of each column, row by row; behind each row its end.
    pub(super) starts: Vec<u32>,
    /// The blocks, [`ROWS`] rows together.
    pub(super) groups: Vec<Group>,
    /// The smallest depth in each block, its farthest receiver, less its margin.
    pub(super) farthest: Vec<f32>,
    /// For each place, the index of the receiver in the caller's slice.
    pub(super) index: Vec<u32>,
}

impl Bins {
    /// The places of the receivers of a row between two positions, and few others: those of the
    /// columns in which the positions lie.
    #[inline(always)]
    pub(super) fn run(&self, row: usize, [low, high]: [f32; 2]) -> Range<usize> {
        let row = &self.rows[row];
        if (high < row.low) | (low > row.high) {
            return 0..0;
        }
        let first = row.first.wrapping_add(row.column(low)) as usize;
        let last = row.first.wrapping_add(row.column(high)) as usize;
        self.starts[first] as usize..self.starts[last.wrapping_add(1)] as usize
    }

    /// Whether all receivers of a run, of which there are some, are nearer to the light than `nearest`
    /// with its margin.
    #[inline(always)]
    pub(super) fn is_before(&self, run: &Range<usize>, nearest: f32) -> bool {
        let last = run.end.wrapping_sub(1) / LANES;
        let mut block = run.start / LANES;
        while block <= last && nearest < self.farthest[block] {
            block = block.wrapping_add(1);
        }
        block > last
    }
}

/// A depth nearer to the light by the margin of its roundings.
#[inline(always)]
pub(super) fn nearer(depth: f32) -> f32 {
    depth + (1e-5 * depth.abs() + 1e-9)
}

/// A depth farther from the light by the margin of its roundings.
#[inline(always)]
pub(super) fn farther(depth: f32) -> f32 {
    depth - (1e-5 * depth.abs() + 1e-9)
}
