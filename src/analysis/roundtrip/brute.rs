//! The brute loop: every float of a run is packed, stored, sampled and unpacked.

use super::tally::{Drop, ErrorTally, Extreme};
use crate::depth::RoundTrip;
use crate::depth::arith::Raw;
use crate::simd::{Kernel, Level};

/// Depths decoded at a time: the buffer stays in the first-level cache.
const BLOCK: usize = 2048;
/// A run of no more depths has a buffer of its own size.
const SHORT: usize = 128;
/// Independent sums, so that they vectorise and their order never depends on the vector width.
const LANES: usize = 16;

/// What one block yields; extremes as keys, whose positions are looked up once at the end.
struct Block<F: Raw> {
    above: F::Key,
    below: F::Key,
    inversions: u32,
    /// The largest step down, rounded to `F`.
    drop: F::Key,
    sum: f64,
    squares: f64,
}

struct Reduce<'a, F> {
    first: u32,
    decoded: &'a [F],
}

impl<F: Raw> Kernel for Reduce<'_, F> {
    type Output = Block<F>;
    #[inline(always)]
    fn run(self, _has_fma: bool) -> Block<F> {
        let mut lanes = Lanes::<F>::default();
        let (rows, rest) = self.decoded.as_chunks::<LANES>();
        for (row, decoded) in rows.iter().enumerate() {
            for (l, &decoded) in decoded.iter().enumerate() {
                lanes.take(l, decoded, self.depth((row * LANES).wrapping_add(l)));
            }
        }
        // The rest has accumulators of its own: a run-time index would force the others to memory.
        let mut tail = Lanes::<F>::default();
        for (l, &decoded) in rest.iter().enumerate() {
            tail.take(0, decoded, self.depth(rows.len() * LANES + l));
        }
        lanes.joined(&tail, self.falls())
    }
}

impl<F: Raw> Reduce<'_, F> {
    #[inline(always)]
    fn depth(&self, i: usize) -> f32 {
        f32::from_bits(self.first.wrapping_add(i as u32))
    }

    /// How many neighbours go down, and the largest such step.
    #[inline(always)]
    fn falls(&self) -> (u32, F::Key) {
        let (before, after) = (&self.decoded[..self.decoded.len() - 1], &self.decoded[1..]);
        before.iter().zip(after).fold((0, F::Key::default()), |(count, drop), (&before, &after)| {
            (u32::from(after < before).wrapping_add(count), drop.max((before - after).key()))
        })
    }
}

/// Independent accumulators.
#[derive(Default)]
struct Lanes<F: Raw> {
    above: [F::Key; LANES],
    below: [F::Key; LANES],
    sum: [f64; LANES],
    squares: [f64; LANES],
}

impl<F: Raw> Lanes<F> {
    /// The error is rounded to `F` before it is summed: a relative 2⁻²⁴ where decoded and depth are
    /// more than a factor 2 apart, exact elsewhere (Sterbenz).
    #[inline(always)]
    fn take(&mut self, lane: usize, decoded: F, depth: f32) {
        let error = decoded - F::from_depth(depth);
        self.above[lane] = self.above[lane].max(error.key());
        self.below[lane] = self.below[lane].max((F::default() - error).key());
        let error: f64 = error.into();
        self.sum[lane] += error;
        self.squares[lane] += error * error;
    }

    /// One loop a field: a loop over all of them is too long to be unrolled, and the accumulators
    /// would live in memory.
    #[inline(always)]
    fn joined(&self, tail: &Self, (inversions, drop): (u32, F::Key)) -> Block<F> {
        let (mut above, mut below) = (tail.above[0], tail.below[0]);
        let (mut sum, mut squares) = (tail.sum[0], tail.squares[0]);
        for l in 0..LANES {
            above = above.max(self.above[l]);
        }
        for l in 0..LANES {
            below = below.max(self.below[l]);
        }
        for l in 0..LANES {
            sum += self.sum[l];
        }
        for l in 0..LANES {
            squares += self.squares[l];
        }
        Block { above, below, inversions, drop, sum, squares }
    }
}

/// The tally of all floats with bit patterns `start`…`end`, which lie in one binade.
pub(super) fn tally<F: Raw>(
    trip: &dyn RoundTrip<F>,
    level: Level,
    start: u32,
    end: u32,
) -> ErrorTally<F> {
    tally_by(&|first, out: &mut [F]| trip.run(level, first, out), level, start, end)
}

/// [`tally`] with `run` to decode the floats from a bit pattern on.
pub(super) fn tally_by<F: Raw>(
    run: &impl Fn(u32, &mut [F]),
    level: Level,
    start: u32,
    end: u32,
) -> ErrorTally<F> {
    if end - start < SHORT as u32 {
        return short(run, level, start, end);
    }
    let mut buffer = [F::default(); BLOCK];
    let mut total: Option<ErrorTally<F>> = None;
    let (mut above, mut below) = ((F::Key::default(), start), (F::Key::default(), start));
    let mut at = start;
    loop {
        let len = BLOCK.min((end - at) as usize + 1);
        let decoded = &mut buffer[..len];
        run(at, decoded);
        let block = level.run(Reduce { first: at, decoded });
        if block.above > above.0 {
            above = (block.above, at);
        }
        if block.below > below.0 {
            below = (block.below, at);
        }
        let known = total.map_or(0.0, |t: ErrorTally<F>| t.drop.size);
        let next = block_tally(at, decoded, &block, known);
        total = Some(total.map_or(next, |t| t.then(next)));
        if (end - at) as usize + 1 == len {
            break;
        }
        at += len as u32;
    }
    let mut total = total.expect("a run has at least one float");
    let mut locate = |(key, at): (F::Key, u32), error: fn(F, F) -> F| {
        let decoded = &mut buffer[..BLOCK.min((end - at) as usize + 1)];
        run(at, decoded);
        found(key, at, decoded, error)
    };
    total.above = locate(above, |d, z| d - z);
    total.below = locate(below, |d, z| z - d);
    total
}

/// A run of one small block: its extremes are found where it stands, and little is cleared for it.
fn short<F: Raw>(
    run: &impl Fn(u32, &mut [F]),
    level: Level,
    start: u32,
    end: u32,
) -> ErrorTally<F> {
    let mut buffer = [F::default(); SHORT];
    let decoded = &mut buffer[..(end - start) as usize + 1];
    run(start, decoded);
    let block = level.run(Reduce { first: start, decoded });
    ErrorTally {
        above: found(block.above, start, decoded, |d, z| d - z),
        below: found(block.below, start, decoded, |d, z| z - d),
        ..block_tally(start, decoded, &block, 0.0)
    }
}

/// The block's tally, without its extremes; its largest drop only where that may exceed `known`.
fn block_tally<F: Raw>(start: u32, decoded: &[F], block: &Block<F>, known: f64) -> ErrorTally<F> {
    let nothing = Extreme { error: F::default(), at: start };
    // What is no number compares with nothing: looked at.
    let exceeds = block.inversions > 0 && !(block.drop_bound(start) <= known);
    ErrorTally {
        start,
        count: decoded.len() as u64,
        evaluated: decoded.len() as u64,
        above: nothing,
        below: nothing,
        sum: block.sum,
        squares: block.squares,
        inversions: block.inversions.into(),
        drop: if exceeds { largest_drop(start, decoded) } else { Drop::default() },
        first: decoded[0],
        last: decoded[decoded.len() - 1],
    }
}

impl<F: Raw> Block<F> {
    /// No drop of the block from depth `start` on is larger. Every decoded value is at least
    /// `start` − `below`; a difference of at most half of that is exact (Sterbenz).
    fn drop_bound(&self, start: u32) -> f64 {
        let drop: f64 = F::from_key(self.drop).into();
        let least = f64::from(f32::from_bits(start)) - F::from_key(self.below).into();
        if 4.0 * drop <= least { drop } else { drop * (1.0 + 2.0 * f64::from(f32::EPSILON)) }
    }
}

fn largest_drop<F: Raw>(start: u32, decoded: &[F]) -> Drop {
    let mut largest = Drop::default();
    for (at, pair) in (start + 1..).zip(decoded.windows(2)) {
        let size = pair[0].into() - pair[1].into();
        if size > largest.size {
            largest = Drop { size, at };
        }
    }
    largest
}

/// The first depth of the block at `start` whose error has the key.
fn found<F: Raw>(key: F::Key, start: u32, decoded: &[F], error: fn(F, F) -> F) -> Extreme<F> {
    if key == F::Key::default() {
        return Extreme { error: F::default(), at: start };
    }
    let depths = (start..).map(|bits| F::from_depth(f32::from_bits(bits)));
    let offset = depths.zip(decoded).position(|(z, &d)| error(d, z).key() == key);
    let offset = offset.expect("the key came from this block") as u32;
    Extreme { error: F::from_key(key), at: start + offset }
}
