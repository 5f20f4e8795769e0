//! Break points: a monotone code is constant on cells, so a cell is answered for by its two ends.
//!
//! The code is monotone in the depth, hence the depths of one code are consecutive, and the last of
//! them is found from a guess by stepping while the code says so: the literal encoder decides, the
//! guess only saves time. On a cell the decoded value is constant, and [`Tally::constant`] is exact.

use super::tally::Tally;
use crate::depth::FormatTrip;
use crate::depth::arith::Raw;

/// The tally of all floats with bit patterns `start`…`end`, which lie in one binade.
pub(super) fn tally<F: Raw>(trip: FormatTrip, start: u32, end: u32) -> Tally<F> {
    let mut total: Option<Tally<F>> = None;
    let mut at = start;
    loop {
        let code = trip.code(f32::from_bits(at));
        let last = cell_end(trip, code, at, end);
        let cell = Tally::constant(at, last, trip.value(code));
        total = Some(total.map_or(cell, |t| t.then(cell)));
        if last == end {
            return total.expect("at least one cell");
        }
        at = last + 1;
    }
}

/// Bit pattern of the last depth in `at`…`end` that has `code`, which `at` has.
fn cell_end(trip: FormatTrip, code: u32, at: u32, end: u32) -> u32 {
    let code_at = |bits: u32| trip.code(f32::from_bits(bits));
    let mut last = trip.end_of(code).to_bits().clamp(at, end);
    while code_at(last) > code {
        last -= 1;
    }
    while last < end && code_at(last + 1) == code {
        last += 1;
    }
    last
}
