//! The default look: a stratified sample of [0, 1] and every code boundary ± a few ulps.

use super::brute;
use super::survey::{ONE, Segment, segments};
use super::tally::{Drop, ErrorTally, Extreme};
use crate::depth::RoundTrip;
use crate::depth::arith::Raw;
use crate::simd::Level;
use rayon::prelude::*;
use std::sync::OnceLock;

/// Runs of consecutive floats, one in each stratum of a segment.
const STRATA: u32 = 512;
/// Floats in a run: neighbours are needed to see the order.
const RUN: u32 = 16;
/// Floats on each side of a code boundary.
const AROUND: u32 = 16;
/// Finer boundaries (multiples of 1/65025, 2⁻¹⁶, 2⁻²⁴, 255⁻³ and halves between), spread by a
/// multiplicative sequence.
const FINE: u64 = 512;

/// Depths at which a code of some packing changes, or nearly.
#[must_use]
pub fn boundaries() -> Vec<f32> {
    let coarse = (0..=512u32).flat_map(|k| {
        [f64::from(k) / 255.0 / 2.0, f64::from(k) / 256.0 / 2.0, f64::from(k) / 257.0]
    });
    let fine = [65_025.0, 65_535.0, 65_536.0, 16_581_375.0, 16_777_215.0, 16_777_216.0];
    let fine = fine.into_iter().flat_map(|base| {
        let step = |i: u64| i.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 11; // golden ratio, 53 bits
        (1..=FINE).map(move |i| {
            let unit = step(i) as f64 / (1u64 << 53) as f64;
            (unit * base * 2.0).floor() / 2.0 / base
        })
    });
    let depths = coarse.chain(fine).map(|z| z as f32);
    depths.filter(|z| (0.0..=1.0).contains(z)).collect()
}

fn strata(segment: Segment) -> Vec<(u32, u32)> {
    let length = segment.end - segment.start;
    if length < STRATA * RUN {
        return vec![(segment.start, segment.end)];
    }
    // Anywhere in its stratum, by the golden ratio: even spacing would beat with the codes.
    let place = |i: u32| f64::from(i.wrapping_mul(0x9e37_79b9)) / 4_294_967_296.0;
    let stratum = f64::from(length - RUN) / f64::from(STRATA);
    let at = |i: u32| segment.start + ((f64::from(i) + place(i)) * stratum) as u32;
    (0..STRATA).map(|i| (at(i), at(i) + RUN - 1)).collect()
}

fn around_boundaries(segment: Segment, edges: &[f32]) -> Vec<(u32, u32)> {
    let mut centres: Vec<u32> = edges.iter().map(|z| z.to_bits()).collect();
    centres.extend([segment.start, segment.end]);
    centres.retain(|bits| (segment.start..=segment.end).contains(bits));
    centres.sort_unstable();
    let mut runs: Vec<(u32, u32)> = Vec::new();
    for bits in centres {
        let start = bits.saturating_sub(AROUND).max(segment.start);
        let end = (bits + AROUND).min(segment.end);
        match runs.last_mut() {
            Some(run) if start <= run.1 => run.1 = end.max(run.1),
            _ => runs.push((start, end)),
        }
    }
    runs
}

/// A segment with the runs looked at in it.
struct Look {
    segment: Segment,
    strata: Vec<(u32, u32)>,
    around: Vec<(u32, u32)>,
}

fn plan() -> &'static [Look] {
    static PLAN: OnceLock<Vec<Look>> = OnceLock::new();
    PLAN.get_or_init(|| {
        let edges = boundaries();
        let look = |segment| {
            let around = around_boundaries(segment, &edges);
            Look { segment, strata: strata(segment), around }
        };
        segments().into_iter().map(look).collect()
    })
}

/// The sampled tallies of all segments. Extremes and inversions are those seen; the sums are of the
/// strata alone, scaled to the whole segment, so that boundaries do not weigh more than they are.
#[must_use]
pub fn sample<F: Raw>(trip: &dyn RoundTrip<F>, level: Level) -> Vec<ErrorTally<F>> {
    let look = |look: &Look| {
        let tally = |&(start, end): &(u32, u32)| brute::tally(trip, level, start, end);
        let even = look.strata.iter().map(tally).reduce(beside);
        let even = even.expect("a segment has a float");
        let length = f64::from(look.segment.end - look.segment.start) + 1.0;
        let scale = length / even.count as f64;
        let fine = look.around.iter().map(tally);
        let seen = fine.fold(even, beside);
        ErrorTally { sum: even.sum * scale, squares: even.squares * scale, ..seen }
    };
    plan().par_iter().map(look).collect()
}

/// Joins two runs that are not neighbours.
fn beside<F: Raw>(a: ErrorTally<F>, b: ErrorTally<F>) -> ErrorTally<F> {
    let larger = |a: Drop, b: Drop| if b.size > a.size { b } else { a };
    let earlier = |a: Extreme<F>, b: Extreme<F>| {
        if a.error.key() == b.error.key() && b.at < a.at { b } else { a.or(b) }
    };
    ErrorTally {
        count: a.count + b.count,
        evaluated: a.evaluated + b.evaluated,
        above: earlier(a.above, b.above),
        below: earlier(a.below, b.below),
        sum: a.sum + b.sum,
        squares: a.squares + b.squares,
        inversions: a.inversions + b.inversions,
        drop: larger(a.drop, b.drop),
        last: b.last,
        ..a
    }
}

/// Depths at which promises are checked one by one: a few of every stratum, every boundary and its
/// neighbours.
pub(super) fn sampled_depths() -> &'static [f32] {
    static DEPTHS: OnceLock<Vec<f32>> = OnceLock::new();
    DEPTHS.get_or_init(single_depths)
}

fn single_depths() -> Vec<f32> {
    let strata = plan().iter().flat_map(|look| &look.strata).map(|&(start, _)| start).step_by(16);
    let edges = boundaries().into_iter().map(f32::to_bits);
    let around = edges.flat_map(|bits| [bits.saturating_sub(1), bits, (bits + 1).min(ONE)]);
    let mut depths: Vec<u32> = strata.chain(around).collect();
    depths.sort_unstable();
    depths.dedup();
    depths.into_iter().map(f32::from_bits).collect()
}
