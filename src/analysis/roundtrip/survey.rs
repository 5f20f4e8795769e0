//! Every float of [0, 1], cut into segments of one binade, answered for in order.

use super::tally::ErrorTally;
use super::{breakpoints, brute, prune};
use crate::depth::arith::Raw;
use crate::depth::{FormatTrip, RoundTrip};
use crate::simd::Level;
use rayon::prelude::*;

/// Bit pattern of 1.0: the floats of [0, 1] are 0…ONE.
pub const ONE: u32 = 0x3f80_0000;
/// How many floats [0, 1] holds.
pub const FLOATS: u64 = ONE as u64 + 1;
/// Floats per piece of work: a fixed size, so that sums never depend on the number of threads.
const PIECE: u32 = 1 << 18;

crate::catalogue! {
    /// How the floats are answered for.
    pub enum Method {
        /// A stratified sample and every code boundary ± a few ulps.
        Sampled = "sampled",
        /// Every float, evaluated.
        Brute = "brute",
        /// Every float, by interval pruning.
        Pruned = "pruned",
        /// Every float, by the break points of a monotone code.
        BreakPoints = "break-points",
    }
}

/// Consecutive floats of one binade between two cuts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Segment {
    /// Bit pattern of the first depth.
    pub start: u32,
    /// Bit pattern of the last depth.
    pub end: u32,
}

/// Depths at which error tables are cut, beside the binades.
pub const CUTS: [f32; 5] = [0.75, 0.9, 0.95, 0.98, 0.99];

/// The segments of [0, 1]: the binades, cut at [`CUTS`], and 1.0 alone.
#[must_use]
pub fn segments() -> Vec<Segment> {
    let binades = (0..=ONE >> 23).map(|exponent| exponent << 23);
    let mut starts: Vec<u32> = binades.chain(CUTS.map(f32::to_bits)).collect();
    starts.sort_unstable();
    let ends = starts.iter().skip(1).map(|&next| next - 1).chain([ONE]);
    starts.iter().zip(ends).map(|(&start, end)| Segment { start, end }).collect()
}

/// The tallies of all segments, every float evaluated ([`Method::Brute`]) or proved
/// ([`Method::Pruned`]).
///
/// # Panics
/// With another method.
#[must_use]
pub fn survey<F: Raw>(trip: &dyn RoundTrip<F>, level: Level, method: Method) -> Vec<ErrorTally<F>> {
    answered_by(|start, end| tally(trip, level, method, start, end))
}

/// The tally of the floats from bit pattern `start` to `end`, which lie in one binade, by one method.
///
/// # Panics
/// With another method than `Brute` or `Pruned`.
#[must_use]
pub fn tally<F: Raw>(
    trip: &dyn RoundTrip<F>,
    level: Level,
    method: Method,
    start: u32,
    end: u32,
) -> ErrorTally<F> {
    match method {
        Method::Brute => brute::tally(trip, level, start, end),
        Method::Pruned => prune::tally(trip, level, start, end),
        Method::Sampled | Method::BreakPoints => panic!("{method} does not go by enclosures"),
    }
}

/// The tallies of all segments of a depth format, by the break points of its codes.
#[must_use]
pub fn survey_format<F: Raw>(trip: FormatTrip) -> Vec<ErrorTally<F>> {
    answered_by(|start, end| breakpoints::tally(trip, start, end))
}

fn answered_by<F: Raw>(answer: impl Fn(u32, u32) -> ErrorTally<F> + Sync) -> Vec<ErrorTally<F>> {
    let segments = segments();
    let pieces: Vec<_> = segments.iter().enumerate().flat_map(pieces).collect();
    let tallies: Vec<(usize, ErrorTally<F>)> =
        pieces.into_par_iter().map(|(segment, start, end)| (segment, answer(start, end))).collect();
    let mut joined: Vec<ErrorTally<F>> = Vec::with_capacity(segments.len());
    for (segment, tally) in tallies {
        match joined.get_mut(segment) {
            Some(before) => *before = before.then(tally),
            None => joined.push(tally),
        }
    }
    joined
}

fn pieces((index, segment): (usize, &Segment)) -> Vec<(usize, u32, u32)> {
    let last = |start: u32| segment.end.min(start.saturating_add(PIECE - 1));
    let starts = (segment.start..=segment.end).step_by(PIECE as usize);
    starts.map(|start| (index, start, last(start))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn segments_cover_every_float_once_within_one_binade() {
        let segments = segments();
        let covered: u64 = segments.iter().map(|s| u64::from(s.end - s.start) + 1).sum();
        assert_eq!(covered, FLOATS);
        assert!(segments.windows(2).all(|w| w[0].end + 1 == w[1].start));
        assert!(segments.iter().all(|s| s.start >> 23 == s.end >> 23));
        assert_eq!(FLOATS, 1_065_353_217);
    }
}
