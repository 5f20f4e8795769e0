//! LINEAR filtering of packed bytes: what a blend of two texels decodes to.
//!
//! A dot-product unpack is linear, so blending bytes blends depths (with full-precision weights to a
//! few ulps; the wrap at 1 and 8-bit results break it). An unpack that rounds digits is not linear:
//! a blend of digits is no digit.

use crate::depth::roundtrip::{AnyRoundTrip, Path};
use crate::depth::{Arithmetic, ByteStore, Packing, UnormLoad};
use serde::Serialize;

crate::catalogue! {
    /// Precision of the filter's result.
    pub enum FilterResult {
        /// f32 weights on bytes 0…255, a + (b − a)t, times f32(1/255): the measured WebGL.
        Full = "full",
        /// The blend rounded to a byte again: mip maps, a blurred 8-bit target.
        Byte = "byte",
    }
}

/// Two neighbouring texels of a slope and a filter between them.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Slope {
    /// Window depth from one texel to the next.
    pub step: f32,
}

/// Signed error decoded(blend) − blend of the depths, for a texel of depth `z` and its neighbour.
///
/// `t` ∈ [0, 1] is the filter's fraction.
#[must_use]
pub fn filtered_error(packing: Packing, result: FilterResult, z: f32, slope: Slope, t: f32) -> f64 {
    let path = Path {
        rounding: ByteStore::HalfEven.roundings()[0],
        load: UnormLoad::Reciprocal,
        arithmetic: Arithmetic::F32,
    };
    let AnyRoundTrip::F32(trip) = path.of_packing(packing) else {
        unreachable!("f32 arithmetic decodes to f32")
    };
    let next = (z + slope.step).min(1.0);
    let (a, b) = (trip.texel(z), trip.texel(next));
    let mut channels = [0.0; 4];
    for (channel, (&a, &b)) in channels.iter_mut().zip(a.iter().zip(&b)) {
        let (a, b) = (f32::from(a), f32::from(b));
        let blend = a + (b - a) * t;
        let blend = if result == FilterResult::Byte { blend.round_ties_even() } else { blend };
        *channel = blend * (1.0f32 / 255.0);
    }
    let expected = f64::from(z) + (f64::from(next) - f64::from(z)) * f64::from(t);
    f64::from(trip.unpack(channels)) - expected
}

/// Signed errors over depth × fraction, row by row (depth grows to the right, fraction upwards; the
/// top row comes first).
#[derive(Clone, Debug)]
pub struct FilterSweep {
    /// The packing.
    pub packing: Packing,
    /// Depths across.
    pub width: usize,
    /// Fractions up.
    pub height: usize,
    /// Signed errors.
    pub errors: Vec<f32>,
}

impl FilterSweep {
    /// Depths (i + ½)/width and fractions j/(height − 1).
    #[must_use]
    pub fn new(
        packing: Packing,
        result: FilterResult,
        slope: Slope,
        width: usize,
        height: usize,
    ) -> Self {
        let error = |row: usize, column: usize| {
            let z = (column as f32 + 0.5) / width as f32;
            let t = (height - 1 - row) as f32 / (height - 1) as f32;
            filtered_error(packing, result, z, slope, t) as f32
        };
        let rows = 0..height;
        let errors = rows.flat_map(|row| (0..width).map(move |c| error(row, c))).collect();
        Self { packing, width, height, errors }
    }

    /// Largest |error|.
    #[must_use]
    pub fn max(&self) -> f64 {
        self.errors.iter().map(|e| f64::from(e.abs())).fold(0.0, f64::max)
    }
}
