//! LINEAR filtering of packed bytes: what a blend of two texels decodes to.
//!
//! A dot-product unpack is linear, so blending bytes blends depths (with full-precision weights to a
//! few ulps; the wrap at 1 and 8-bit results break it). An unpack that rounds digits is not linear:
//! a blend of digits is no digit.

use crate::depth::roundtrip::{AnyRoundTrip, Path};
use crate::depth::{Arithmetic, ByteStore, Packing, UnormLoad};
use crate::num::to_half;
use serde::Serialize;

crate::catalogue! {
    /// Precision of the filter's result.
    pub enum FilterResult {
        /// f32 weights on bytes 0…255, a + (b − a)t, times f32(1/255): the measured WebGL.
        Full = "full",
        /// The filtered channel rounded to half precision: 16-bit samplers of phones.
        Half = "half",
        /// The blend rounded to a byte again: mip maps, a blurred 8-bit target.
        Byte = "byte",
    }
}

impl FilterResult {
    /// The float of a blend of bytes 0…255.
    fn sample(self, blend: f32) -> f32 {
        let scale = 1.0f32 / 255.0;
        match self {
            Self::Full => blend * scale,
            Self::Half => to_half(blend * scale),
            Self::Byte => blend.round_ties_even() * scale,
        }
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
        *channel = result.sample(a + (b - a) * t);
    }
    let expected = f64::from(z) + (f64::from(next) - f64::from(z)) * f64::from(t);
    f64::from(trip.unpack(channels)) - expected
}

/// Largest |error| over depths (i + ½)/n at one fraction `t` ∈ [0, 1] of the filter.
#[must_use]
pub fn max_at(packing: Packing, result: FilterResult, slope: Slope, n: usize, t: f32) -> f64 {
    let depths = (0..n).map(|i| (i as f32 + 0.5) / n as f32);
    let error = |z| filtered_error(packing, result, z, slope, t).abs();
    depths.map(error).fold(0.0, f64::max)
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

    /// The least fraction that has the largest |error|.
    #[must_use]
    pub fn worst_fraction(&self) -> f64 {
        let max = self.max();
        let has_it = |e: &f32| f64::from(e.abs()) == max;
        let row = self.errors.iter().rposition(has_it).map_or(0, |i| i / self.width);
        (self.height - 1 - row) as f64 / (self.height - 1) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sum of weighed bytes is linear in them, rounded digits are not; phones' 16-bit samplers and
    /// 8-bit targets spoil both.
    #[test]
    fn a_precise_filter_spares_dot_products_alone() {
        let max = |packing, result| {
            FilterSweep::new(packing, result, Slope { step: 1e-3 }, 240, 33).max()
        };
        use FilterResult::{Byte, Full, Half};
        assert!(max(Packing::Aras2009, Full) < 4e-7);
        assert!(max(Packing::ThreeRgba, Full) < 4e-7);
        for digits in [Packing::Digits16, Packing::Digits24, Packing::Digits32] {
            assert!(max(digits, Full) > 1e-3, "{digits}: a blend of digits is no digit");
        }
        assert!(max(Packing::Aras2009, Half) > 1e-4);
        assert!(max(Packing::Aras2009, Byte) > 1.5e-3);
    }
}
