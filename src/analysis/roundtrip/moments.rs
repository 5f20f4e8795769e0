//! VSM and EVSM, a first look: what the storage of moments costs.
//!
//! Variance is E(z²) − E(z)²: two stored numbers of size z² cancel, so each relative rounding of
//! 2⁻ⁿ leaves about 2⁻ⁿz² of false variance on a flat surface, where the true one is 0. A floor at
//! least as large is needed, or the surface shadows itself with full strength.

use crate::depth::{DepthFormat, Packing, UnormLoad, UnormStore};
use serde::Serialize;

crate::catalogue! {
    /// What a moment is stored in.
    pub enum MomentStore {
        /// IEEE half precision.
        F16 = "f16",
        /// IEEE single precision.
        F32 = "f32",
        /// Two UNORM8 channels by three.js' pack2HalfToRGBA.
        ThreeHalf = "rg8-three-half",
        /// Two UNORM8 channels by PlayCanvas' VSM8 pack.
        PlaycanvasVsm8 = "rg8-playcanvas-vsm8",
        /// Two UNORM8 channels of integer digits.
        Digits16 = "rg8-digits-16",
    }
}

impl MomentStore {
    /// A moment in [0, 1] as it is read back.
    #[must_use]
    pub fn stored(self, moment: f32) -> f32 {
        let packed = |packing: Packing| {
            let bytes = packing.pack(moment).map(|c| UnormStore::HalfEven.code(c, 255));
            packing.unpack(bytes.map(|k| UnormLoad::Divide.value(k, 255)))
        };
        match self {
            Self::F16 => DepthFormat::F16.decode(DepthFormat::F16.encode(moment)),
            Self::F32 => moment,
            Self::ThreeHalf => packed(Packing::ThreeHalf),
            Self::PlaycanvasVsm8 => packed(Packing::PlaycanvasVsm8),
            Self::Digits16 => packed(Packing::Digits16),
        }
    }

    /// The largest finite value, for exponentially warped moments; `None` for stores of [0, 1].
    #[must_use]
    pub fn largest(self) -> Option<f64> {
        match self {
            Self::F16 => Some(65_504.0),
            Self::F32 => Some(f64::from(f32::MAX)),
            Self::ThreeHalf | Self::PlaycanvasVsm8 | Self::Digits16 => None,
        }
    }

    /// The greatest EVSM exponent c: the second moment e²ᶜ must be finite (f16: 5.54, f32: 44.36;
    /// engines stay at 5.54 and 42, below the limit, for the sake of filtering).
    #[must_use]
    pub fn exponent_limit(self) -> Option<f64> {
        self.largest().map(|largest| libm::log(largest) / 2.0)
    }
}

/// False variance of flat surfaces.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct MomentPrecision {
    /// What the moments are stored in.
    pub store: MomentStore,
    /// The largest |variance| that a flat surface is given: the floor that is needed.
    pub variance_floor: f64,
    /// The depth that has it.
    pub at: f32,
    /// Standard deviation of that variance, window depth: how far a blocker must lie in front before
    /// its shadow is half dark.
    pub deviation: f64,
    /// EVSM's exponent limit.
    pub exponent_limit: Option<f64>,
}

/// A 3 × 3 box blur of nine equal texels in f32: its weights do not add up to 1 exactly.
fn blurred(moment: f32) -> f32 {
    (0..9).fold(0.0, |sum, _| sum + moment * (1.0 / 9.0))
}

/// The false variance over `n` evenly spaced depths of a flat surface, blurred 3 × 3; z², the blur
/// and the variance are computed in f32.
#[must_use]
pub fn moment_precision(store: MomentStore, n: u32) -> MomentPrecision {
    let variance = |z: f32| {
        let (first, second) = (blurred(store.stored(z)), blurred(store.stored(z * z)));
        (second - first * first).abs()
    };
    let depths = (0..n).map(|i| (i as f32 + 0.5) / n as f32);
    let mut worst = (0.0f32, 0.0f32);
    for z in depths {
        if variance(z) > worst.0 {
            worst = (variance(z), z);
        }
    }
    MomentPrecision {
        store,
        variance_floor: worst.0.into(),
        at: worst.1,
        deviation: f64::from(worst.0).sqrt(),
        exponent_limit: store.exponent_limit(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_limits_and_the_size_of_the_cancellation() {
        let limit = MomentStore::F16.exponent_limit().expect("a float");
        assert!((limit - 5.54).abs() < 0.01, "{limit}");
        let half = moment_precision(MomentStore::F16, 4096);
        assert!(half.variance_floor > 1e-4 && half.variance_floor < 2e-3, "{half:?}");
        let single = moment_precision(MomentStore::F32, 4096);
        let floor = single.variance_floor;
        assert!(floor > 1e-8 && floor < 1e-6, "about three.js' floor of 1e-7: {single:?}");
    }
}
