//! Depth formats: window depth → code → window depth, and the smallest resolvable difference r.

use super::store::{UnormLoad, UnormStore};

crate::catalogue! {
    /// How a window depth is stored in one texel of a depth texture.
    pub enum DepthFormat {
        /// 8-bit normalised integer (one colour channel).
        Unorm8 = "unorm8",
        /// 16-bit normalised integer.
        Unorm16 = "unorm16",
        /// 24-bit normalised integer.
        Unorm24 = "unorm24",
        /// 32-bit normalised integer.
        Unorm32 = "unorm32",
        /// IEEE half precision.
        F16 = "f16",
        /// IEEE single precision.
        F32 = "f32",
    }
}

impl DepthFormat {
    /// The largest code of a normalised integer format, `None` for floats.
    #[must_use]
    pub const fn unorm_max(self) -> Option<u32> {
        match self {
            Self::Unorm8 => Some(0xff),
            Self::Unorm16 => Some(0xffff),
            Self::Unorm24 => Some(0xff_ffff),
            Self::Unorm32 => Some(u32::MAX),
            Self::F16 | Self::F32 => None,
        }
    }

    /// Nearest code of a window depth, clamped to [0,1] (NaN stores 0). Codes are monotone in the
    /// depth: integers for UNORM, the bit pattern for floats.
    #[must_use]
    pub fn encode(self, depth: f32) -> u32 {
        self.encode_with(UnormStore::Exact, depth)
    }

    /// [`Self::encode`] under a device's own rounding.
    #[must_use]
    pub fn encode_with(self, store: UnormStore, depth: f32) -> u32 {
        let clamped = if depth.is_nan() { 0.0 } else { depth.clamp(0.0, 1.0) + 0.0 };
        match (self, self.unorm_max()) {
            (_, Some(max)) => store.code(depth, max),
            (Self::F16, None) => u32::from(half::f16::from_f32(clamped).to_bits()),
            (_, None) => clamped.to_bits(),
        }
    }

    /// The window depth of a code, correctly rounded to f32.
    #[must_use]
    pub fn decode(self, code: u32) -> f32 {
        self.decode_with(UnormLoad::Divide, code)
    }

    /// [`Self::decode`] under a device's own sampler.
    #[must_use]
    pub fn decode_with(self, load: UnormLoad, code: u32) -> f32 {
        match (self, self.unorm_max()) {
            (_, Some(max)) => load.value(code, max),
            (Self::F16, None) => half::f16::from_bits(code as u16).to_f32(),
            (_, None) => f32::from_bits(code),
        }
    }

    /// Spacing of the format's values at `depth` ∈ [0,1], in window depth.
    #[must_use]
    pub fn quantum(self, depth: f32) -> f64 {
        match (self, self.unorm_max()) {
            (_, Some(max)) => 1.0 / f64::from(max),
            (_, None) => {
                let code = self.encode(depth);
                (f64::from(self.decode(code + 1)) - f64::from(self.decode(code))).abs()
            }
        }
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
