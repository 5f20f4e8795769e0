//! Break points: a monotone code is constant on cells, so a cell is answered for by its two ends.
//!
//! The code is monotone in the depth, hence the depths of one code are consecutive, and the last of
//! them is found from a guess by stepping while the code says so: the literal encoder decides, the
//! guess only saves time. On a cell the decoded value is constant, and [`ErrorTally::constant`] is exact.

use super::tally::ErrorTally;
use crate::depth::FormatTrip;
use crate::depth::arith::Raw;
use crate::simd::{Kernel, Level};
use std::marker::PhantomData;

/// The tally of all floats with bit patterns `start`…`end`, which lie in one binade.
pub(super) fn tally<F: Raw>(trip: FormatTrip, start: u32, end: u32) -> ErrorTally<F> {
    Level::run_scalar(Cells { trip, start, end, decoded: PhantomData })
}

/// A run's cells in order.
struct Cells<F> {
    trip: FormatTrip,
    start: u32,
    end: u32,
    decoded: PhantomData<F>,
}

impl<F: Raw> Kernel for Cells<F> {
    type Output = ErrorTally<F>;
    #[inline(always)]
    fn run(self, _has_fma: bool) -> ErrorTally<F> {
        let cell = |at, code, last| ErrorTally::constant(at, last, self.trip.value(code));
        let mut code = self.trip.code(f32::from_bits(self.start));
        let (mut last, mut next) = self.cell_end(code, self.start);
        let mut total = cell(self.start, code, last);
        while last < self.end {
            let at = last + 1;
            code = next;
            (last, next) = self.cell_end(code, at);
            total = total.then(cell(at, code, last));
        }
        total
    }
}

impl<F> Cells<F> {
    /// Bit pattern of the last depth in `at`…`end` that has `code`, which `at` has, and the code after
    /// it.
    #[inline(always)]
    fn cell_end(&self, code: u32, at: u32) -> (u32, u32) {
        let code_at = |bits: u32| self.trip.code(f32::from_bits(bits));
        let mut last = self.trip.end_of(code).to_bits().clamp(at, self.end);
        while code_at(last) > code {
            last -= 1;
        }
        while last < self.end {
            let next = code_at(last + 1);
            if next > code {
                return (last, next);
            }
            last += 1;
        }
        (last, code)
    }
}
