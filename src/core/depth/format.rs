//! Depth formats: window depth → code → window depth, and the smallest resolvable difference r.

use super::arith::Raw;
use super::roundtrip::RoundTrip;
use super::store::{UnormLoad, UnormStore};
use crate::simd::Level;

/// How codes and depths turn into each other.
#[derive(Clone, Copy)]
enum Code {
    /// Normalised integers up to a largest code.
    Unorm(u32),
    /// The bit pattern of a half.
    Half,
    /// That of a bfloat16.
    Brain,
    /// That of a single.
    Single,
}

/// What is known of a format beside its name.
struct Row {
    code: Code,
    /// Bits that API documents call significant: of an integer all, of a float with the implicit one.
    significant: u32,
    /// Bytes of a texel as graphics memory and raw files keep it.
    bytes: u32,
}

const fn unorm(bits: u32, bytes: u32) -> Row {
    Row { code: Code::Unorm(u32::MAX >> (32 - bits)), significant: bits, bytes }
}

const fn float(code: Code, significant: u32, bytes: u32) -> Row {
    Row { code, significant, bytes }
}

crate::catalogue! {
    /// How a window depth is stored in one texel of a depth texture.
    pub enum DepthFormat: Row {
        /// 8-bit normalised integer (one colour channel).
        Unorm8 = "unorm8" => unorm(8, 1),
        /// 16-bit normalised integer.
        Unorm16 = "unorm16" => unorm(16, 2),
        /// 24-bit normalised integer; a texel takes 32 bits.
        Unorm24 = "unorm24" => unorm(24, 4),
        /// 32-bit normalised integer.
        Unorm32 = "unorm32" => unorm(32, 4),
        /// IEEE half precision.
        F16 = "f16" => float(Code::Half, 11, 2),
        /// bfloat16: the upper half of a single-precision float.
        Bf16 = "bf16" => float(Code::Brain, 8, 2),
        /// IEEE single precision.
        F32 = "f32" => float(Code::Single, 24, 4),
    }
}

impl DepthFormat {
    /// The largest code of a normalised integer format, `None` for floats.
    #[must_use]
    #[inline(always)]
    pub const fn unorm_max(self) -> Option<u32> {
        match self.row().code {
            Code::Unorm(max) => Some(max),
            Code::Half | Code::Brain | Code::Single => None,
        }
    }

    /// Significant bits as APIs count them: of an integer all, of a float with the implicit one.
    #[must_use]
    pub const fn significant_bits(self) -> u32 {
        self.row().significant
    }

    /// Bytes of a texel as graphics memory and raw files keep it.
    #[must_use]
    pub const fn bytes(self) -> u32 {
        self.row().bytes
    }

    /// Nearest code of a window depth, clamped to [0, 1] (NaN stores 0). Codes are monotone in the
    /// depth: integers for UNORM, the bit pattern for floats.
    #[must_use]
    pub fn encode(self, depth: f32) -> u32 {
        self.encode_with(UnormStore::Exact, depth)
    }

    /// [`Self::encode`] under a device's own rounding.
    #[must_use]
    #[inline(always)]
    pub fn encode_with(self, store: UnormStore, depth: f32) -> u32 {
        let clamped = if depth.is_nan() { 0.0 } else { depth.clamp(0.0, 1.0) + 0.0 };
        match self.row().code {
            Code::Unorm(max) => store.code(depth, max),
            Code::Half => u32::from(half::f16::from_f32(clamped).to_bits()),
            Code::Brain => u32::from(half::bf16::from_f32(clamped).to_bits()),
            Code::Single => clamped.to_bits(),
        }
    }

    /// The window depth of a code, correctly rounded to f32.
    #[must_use]
    pub fn decode(self, code: u32) -> f32 {
        self.decode_with(UnormLoad::Divide, code)
    }

    /// [`Self::decode`] under a device's own sampler.
    #[must_use]
    #[inline(always)]
    pub fn decode_with(self, load: UnormLoad, code: u32) -> f32 {
        match self.row().code {
            Code::Unorm(max) => load.value(code, max),
            Code::Half => half::f16::from_bits(code as u16).to_f32(),
            Code::Brain => half::bf16::from_bits(code as u16).to_f32(),
            Code::Single => f32::from_bits(code),
        }
    }

    /// The largest |decoded − z| of a depth z ∈ [0, 1), stored to nearest and read back exactly: half the
    /// widest spacing; 0 for f32, which depths are given in.
    #[must_use]
    pub fn worst_error(self) -> f64 {
        if self == Self::F32 { 0.0 } else { self.quantum(0.5) / 2.0 }
    }

    /// Spacing of the format's values at `depth` ∈ [0, 1], in window depth.
    #[must_use]
    pub fn quantum(self, depth: f32) -> f64 {
        match self.unorm_max() {
            Some(max) => 1.0 / f64::from(max),
            None => {
                let code = self.encode(depth);
                (f64::from(self.decode(code + 1)) - f64::from(self.decode(code))).abs()
            }
        }
    }
}

/// A format with its store and sampler as a round trip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FormatTrip {
    /// The format.
    pub format: DepthFormat,
    /// How a UNORM code is made.
    pub store: UnormStore,
    /// How a UNORM code is read.
    pub load: UnormLoad,
}

impl FormatTrip {
    /// The code of a depth; monotone.
    #[must_use]
    #[inline(always)]
    pub fn code(self, depth: f32) -> u32 {
        self.format.encode_with(self.store, depth)
    }

    /// The decoded value of a code, in f64 as well where the sampler is exact.
    #[must_use]
    #[inline(always)]
    pub fn value<F: Raw>(self, code: u32) -> F {
        match self.format.unorm_max() {
            Some(max) if self.load == UnormLoad::Divide => {
                F::from_real(f64::from(code) / f64::from(max))
            }
            Some(_) | None => F::from_depth(self.format.decode_with(self.load, code)),
        }
    }

    /// About the last depth that has the code (a starting point, not a promise).
    #[must_use]
    #[inline(always)]
    pub fn end_of(self, code: u32) -> f32 {
        let reach = if self.store == UnormStore::Truncate { 1.0 } else { 0.5 };
        match self.format.unorm_max() {
            Some(max) => ((f64::from(code) + reach) / f64::from(max)) as f32,
            None => {
                let (low, high) = (self.format.decode(code), self.format.decode(code + 1));
                low + (high - low) / 2.0
            }
        }
    }
}

impl<F: Raw> RoundTrip<F> for FormatTrip {
    fn run(&self, _: Level, first: u32, out: &mut [F]) {
        for (bits, slot) in (first..).zip(out) {
            *slot = self.value(self.code(f32::from_bits(bits)));
        }
    }
    fn constant(&self, first: u32, last: u32) -> Option<F> {
        let code = self.code(f32::from_bits(first));
        (code == self.code(f32::from_bits(last))).then(|| self.value(code))
    }
    fn texel(&self, _: F) -> Vec<u8> {
        Vec::new()
    }
    fn decoded(&self, depth: F) -> F {
        let depth: f64 = depth.into();
        self.value(self.code(depth as f32))
    }
    fn is_sound(&self, _: F) -> bool {
        true
    }
    fn unpack(&self, channels: [F; 4]) -> F {
        channels[0]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_sixteen_bit_code_survives() {
        for code in 0..=0xffff {
            let depth = DepthFormat::Unorm16.decode(code);
            assert_eq!(DepthFormat::Unorm16.encode(depth), code);
        }
    }

    #[test]
    fn ends_of_the_range_are_exact() {
        for &format in DepthFormat::ALL {
            assert_eq!(format.decode(format.encode(0.0)), 0.0, "{format}");
            assert_eq!(format.decode(format.encode(1.0)), 1.0, "{format}");
            assert_eq!(format.decode(format.encode(-0.0)).to_bits(), 0, "{format}");
            assert_eq!(format.decode(format.encode(f32::NAN)), 0.0, "{format}");
            assert_eq!(format.decode(format.encode(f32::INFINITY)), 1.0, "{format}");
        }
    }
}
