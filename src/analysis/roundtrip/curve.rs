//! The largest error in each slice of depth: what a plot of error against depth shows.

use super::bound::bound_at;
use super::boundaries;
use super::conditions::Conditions;
use crate::depth::Packing;
use crate::depth::arith::Raw;
use crate::depth::roundtrip::AnyRoundTrip;
use crate::depth::{ByteRounding, RoundTrip, roundtrip::Path};
use crate::simd::Level;

/// Runs of consecutive floats looked at in each slice, and their length.
const RUNS: usize = 256;
const RUN: usize = 16;

/// One slice of depth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slice {
    /// Middle of the slice.
    pub depth: f64,
    /// Largest |decoded − z| seen.
    pub measured: f64,
    /// The proved bound there.
    pub theory: Option<f64>,
}

/// The error of a packing over `n` slices of [0, 1), under the first rounding of its store.
#[must_use]
pub fn error_curve(packing: Packing, conditions: Conditions, n: usize) -> Vec<Slice> {
    let rounding: ByteRounding = conditions.store.roundings()[0];
    let Conditions { load, arithmetic, .. } = conditions;
    let trip = Path { rounding, load, arithmetic }.of_packing(packing);
    let edges = boundaries();
    let slice = |i: usize| {
        let (from, to) = (i as f64 / n as f64, (i + 1) as f64 / n as f64);
        let measured = match &trip {
            AnyRoundTrip::F32(trip) => largest(&**trip, &edges, from, to),
            AnyRoundTrip::F64(trip) => largest(&**trip, &edges, from, to),
        };
        let theory = bound_at(packing, conditions, from, to);
        Slice { depth: (from + to) / 2.0, measured, theory }
    };
    (0..n).map(slice).collect()
}

/// The largest error of evenly spread runs, and of those around code boundaries: some errors peak within
/// a few ulps of one.
fn largest<F: Raw>(trip: &dyn RoundTrip<F>, edges: &[f32], from: f64, to: f64) -> f64 {
    let even = (0..RUNS).map(|run| (from + (to - from) * run as f64 / RUNS as f64) as f32);
    let within = |&z: &f32| (from..to).contains(&f64::from(z));
    let around =
        edges.iter().copied().filter(within).map(|z| z.to_bits().saturating_sub(RUN as u32 / 2));
    let mut decoded = [F::default(); RUN];
    let mut largest = 0.0f64;
    for first in even.map(f32::to_bits).chain(around) {
        trip.run(Level::best(), first, &mut decoded);
        for (bits, &d) in (first..).zip(&decoded) {
            let z = f64::from(f32::from_bits(bits));
            if (from..to).contains(&z) {
                largest = largest.max((d.into() - z).abs());
            }
        }
    }
    largest
}
