//! What lies between pack and unpack: the conditions of a certificate, by name and as a texture unit.

use crate::depth::roundtrip::{AnyRoundTrip, Path};
use crate::depth::{Arithmetic, ByteRounding, ByteStore, Packing, UnormLoad};
use crate::num::exp2;

/// What lies between pack and unpack, by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Conditions {
    /// How a channel becomes a byte.
    pub store: ByteStore,
    /// How a byte becomes a float.
    pub load: UnormLoad,
    /// What the shader computes in.
    pub arithmetic: Arithmetic,
}

impl Conditions {
    /// f32 arithmetic, correctly rounded samples, the given store.
    #[must_use]
    pub fn plain(store: ByteStore) -> Self {
        Self { store, load: UnormLoad::Divide, arithmetic: Arithmetic::F32 }
    }

    pub(super) fn paths(self) -> impl Iterator<Item = Path> {
        let Self { store, load, arithmetic } = self;
        store.roundings().iter().map(move |&rounding| Path { rounding, load, arithmetic })
    }
}

/// The texture unit: what store and sampler make of a channel. It is the round trip of a single
/// channel, as catalogued.
pub(super) struct Texels {
    trip: AnyRoundTrip,
    path: Path,
    pub(super) real: bool,
}

/// The texture unit along each path of some conditions.
pub(super) fn paths(conditions: Conditions) -> impl Iterator<Item = Texels> {
    conditions.paths().map(|path| Texels {
        trip: path.of_packing(Packing::R8),
        real: path.arithmetic == Arithmetic::Real,
        path,
    })
}

impl Texels {
    /// `x` as the arithmetic holds it.
    pub(super) fn rounded(&self, x: f64) -> f64 {
        if self.real { x } else { f64::from(x as f32) }
    }

    /// What a channel value is read back as.
    pub(super) fn sampled(&self, channel: f64) -> f64 {
        match &self.trip {
            AnyRoundTrip::F32(trip) => trip.decoded(channel as f32).into(),
            AnyRoundTrip::F64(trip) => trip.decoded(channel),
        }
    }

    pub(super) fn truncates(&self) -> bool {
        self.path.rounding == ByteRounding::Floor { half: 0.0 }
    }

    /// Greatest distance of a sampled byte from k/255.
    pub(super) fn sampler_error(&self) -> f64 {
        let error = |k: u32| {
            let exact = f64::from(k) / 255.0;
            let sampled = match self.path.load {
                UnormLoad::Divide if self.real => exact,
                UnormLoad::Divide | UnormLoad::Reciprocal | UnormLoad::Half => {
                    self.path.load.value(k, 255).into()
                }
            };
            (sampled - exact).abs()
        };
        (0..=255).map(error).fold(0.0, f64::max)
    }

    /// Greatest error of storing and sampling any value of [0, 1]; the store's own product and sum
    /// round by 2⁻¹⁷ of a byte each in f32.
    pub(super) fn loose_error(&self) -> f64 {
        let byte = match self.path.rounding {
            ByteRounding::Even => 0.5,
            ByteRounding::Floor { half } => f64::max(half, 1.0 - half),
        };
        let rounding = if self.real { exp2(-44) } else { exp2(-16) };
        (byte + rounding) / 255.0 + self.sampler_error()
    }

    fn bytes(&self) -> impl Iterator<Item = (f64, f64)> {
        let read = |k: u32| self.rounded(255.0 * self.sampled(self.rounded(f64::from(k) / 255.0)));
        (0..=255u32).map(move |k| (f64::from(k), read(k)))
    }

    /// Whether every byte k stored as k/255 comes back as round(255·sample).
    pub(super) fn keep_bytes(&self) -> bool {
        self.bytes().all(|(k, read)| read.round_ties_even() == k)
    }

    /// Whether every byte comes back as ⌊255·sample⌋.
    pub(super) fn truncate_back(&self) -> bool {
        self.bytes().all(|(k, read)| read.floor() == k)
    }
}
