//! Interval pruning: whole runs of floats answered for by one proof.
//!
//! If the enclosure of every channel over [a, b] stores one byte, all depths between decode to one
//! value, and [`ErrorTally::constant`] gives the exact statistics of the run from its ends. Where the
//! proof fails the run is halved; where it is bound to fail the brute loop takes over. Both give the
//! same tally, maximum and position, so it does not matter where the border lies.

use super::brute;
use super::tally::ErrorTally;
use crate::depth::RoundTrip;
use crate::depth::arith::Raw;
use crate::simd::Level;

/// Runs no longer than this are cheaper to evaluate than to prove (one enclosure costs about this
/// many vectorised evaluations).
const LEAF: u32 = 64;
/// Proofs tried in a piece before its strategy is chosen.
const PROBES: u32 = 8;

/// The tally of all floats with bit patterns `start`…`end`, which lie in one binade.
pub(super) fn tally<F: Raw>(
    trip: &dyn RoundTrip<F>,
    level: Level,
    start: u32,
    end: u32,
) -> ErrorTally<F> {
    if let Some(value) = trip.constant(start, end) {
        return ErrorTally::constant(start, end, value);
    }
    let pieces = Pieces { trip, level };
    if pieces.is_hopeless(start, end) {
        return brute::tally_by(&proved(trip, level), level, start, end);
    }
    pieces.halve(start, end)
}

fn proved<F: Raw>(trip: &dyn RoundTrip<F>, level: Level) -> impl Fn(u32, &mut [F]) {
    move |first, out| trip.run_proved(level, first, out)
}

struct Pieces<'a, F> {
    trip: &'a dyn RoundTrip<F>,
    level: Level,
}

impl<F: Raw> Pieces<'_, F> {
    /// Whether most of a few leaves, spread over the run, cannot be proved constant.
    fn is_hopeless(&self, start: u32, end: u32) -> bool {
        let length = end - start;
        if length < LEAF * PROBES * 4 {
            return false;
        }
        let fails = |i: &u32| {
            let at = start + length / PROBES * i;
            self.trip.constant(at, at + LEAF).is_none()
        };
        (0..PROBES).filter(fails).count() as u32 > PROBES / 2
    }

    fn answer(&self, start: u32, end: u32) -> ErrorTally<F> {
        if let Some(value) = self.trip.constant(start, end) {
            return ErrorTally::constant(start, end, value);
        }
        if end - start < LEAF {
            return brute::tally_by(&proved(self.trip, self.level), self.level, start, end);
        }
        self.halve(start, end)
    }

    fn halve(&self, start: u32, end: u32) -> ErrorTally<F> {
        let middle = start + (end - start) / 2;
        self.answer(start, middle).then(self.answer(middle + 1, end))
    }
}
