//! What the hardware does between pack and unpack: floats to UNORM codes, and codes to floats.

crate::catalogue! {
    /// How a float becomes a UNORM code. NaN and x ≤ 0 give 0, x ≥ 1 gives the largest code.
    pub enum UnormStore {
        /// Exact x·max, rounded to nearest, ties to even.
        Exact = "exact",
        /// f32(x·max), rounded to nearest, ties to even (what the measured WebGL does).
        HalfEven = "half-even",
        /// floor(f32(f32(x·max) + 0.5)).
        HalfUp = "half-up",
        /// floor(f32(x·max)): Vulkan and old GL allow it.
        Truncate = "truncate",
    }
}

impl UnormStore {
    /// The code of `x` in a UNORM format whose largest code is `max` (255, 65535, 2²⁴−1, 2³²−1).
    ///
    /// The f32 products are exact to half an ulp; `Exact` uses f64, where x·max is exact for
    /// max < 2²⁹ and within 2⁻²¹ of a code for 32 bits.
    #[must_use]
    #[inline(always)]
    pub fn code(self, x: f32, max: u32) -> u32 {
        if x.is_nan() || x <= 0.0 {
            return 0;
        }
        if x >= 1.0 {
            return max;
        }
        let product = x * max as f32;
        match self {
            Self::Exact => (f64::from(x) * f64::from(max)).round_ties_even() as u32,
            Self::HalfEven => product.round_ties_even() as u32,
            Self::HalfUp => (product + 0.5).floor() as u32,
            Self::Truncate => product as u32,
        }
        .min(max)
    }
}

crate::catalogue! {
    /// How a UNORM code is read back as a float.
    pub enum UnormLoad {
        /// k/max, correctly rounded to f32.
        Divide = "divide",
        /// f32(k · f32(1/max)) (what the measured WebGL does).
        Reciprocal = "reciprocal",
        /// k/max rounded to half precision: 16-bit samplers of phones.
        Half = "half",
    }
}

impl UnormLoad {
    /// The float of code `k` in a UNORM format whose largest code is `max`.
    #[must_use]
    #[inline(always)]
    pub fn value(self, k: u32, max: u32) -> f32 {
        let exact = f64::from(k) / f64::from(max);
        match self {
            Self::Divide => exact as f32,
            Self::Reciprocal => k as f32 * (1.0 / f64::from(max)) as f32,
            Self::Half => half::f16::from_f64(exact).to_f32(),
        }
    }
}

crate::catalogue! {
    /// How a colour channel becomes a byte: by one rule, or by any rule that an API admits.
    pub enum ByteStore {
        /// Rounded to nearest, ties to even (the measured WebGL).
        HalfEven = "half-even",
        /// Rounded to nearest, ties up.
        HalfUp = "half-up",
        /// Truncated: legal in Vulkan and OpenGL ES.
        Truncate = "truncate",
        /// Every byte within 0.6 of 255·x (D3D's conversion tolerance): the worst of the set.
        Admissible = "d3d-0.6",
    }
}

/// One rounding of f32(255·x), clamped to [0, 255], to a byte.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ByteRounding {
    /// To nearest, ties to even.
    Even,
    /// ⌊255·x + half⌋.
    Floor {
        /// 0.5 rounds, 0 truncates; 0.4 and 0.6 are the ends of D3D's tolerance.
        half: f64,
    },
}

impl ByteStore {
    /// The roundings whose bytes enclose the admissible ones from below and from above: one rounding
    /// for a rule, ⌊255x + 0.4⌋ and ⌊255x + 0.6⌋ for D3D's 0.6 ulp. A byte k is admissible iff
    /// |k − 255x| ≤ 0.6, so the least is ⌈255x − 0.6⌉ = ⌊255x + 0.4⌋ (but for 255x − 0.6 an
    /// integer, which no f32 is) and the greatest ⌊255x + 0.6⌋. Every unpack here is monotone in
    /// each byte, hence the worst error over the set is met by all-least or all-greatest bytes.
    #[must_use]
    pub fn roundings(self) -> &'static [ByteRounding] {
        use ByteRounding::{Even, Floor};
        match self {
            Self::HalfEven => &[Even],
            Self::HalfUp => &[Floor { half: 0.5 }],
            Self::Truncate => &[Floor { half: 0.0 }],
            Self::Admissible => &[Floor { half: 0.4 }, Floor { half: 0.6 }],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_are_exact_for_every_rule() {
        for &store in UnormStore::ALL {
            for max in [255, 65_535, (1 << 24) - 1, u32::MAX] {
                assert_eq!(store.code(0.0, max), 0, "{store} at 0");
                assert_eq!(store.code(1.0, max), max, "{store} at 1");
                assert_eq!(store.code(f32::NAN, max), 0, "{store} of NaN");
                assert_eq!(store.code(f32::NEG_INFINITY, max), 0, "{store} of -inf");
                assert_eq!(store.code(f32::INFINITY, max), max, "{store} of +inf");
            }
        }
    }

    #[test]
    fn ties_tell_the_rounding_rules_apart() {
        let tie = 0.5 / 255.0 * 255.0; // the f32 whose product with 255 is 0.5 lies near 0.5/255
        assert_eq!(tie, 0.5);
        let x = (0.5f64 / 255.0) as f32;
        if x * 255.0 == 0.5 {
            assert_eq!(UnormStore::HalfEven.code(x, 255), 0);
            assert_eq!(UnormStore::HalfUp.code(x, 255), 1);
        }
        assert_eq!(UnormStore::Truncate.code(0.999_999, 255), 254);
        assert_eq!(UnormStore::HalfEven.code(0.999_999, 255), 255);
    }

    #[test]
    fn reciprocal_differs_from_division_for_126_bytes() {
        let differing = (0..256u32)
            .filter(|&k| UnormLoad::Divide.value(k, 255) != UnormLoad::Reciprocal.value(k, 255))
            .count();
        assert_eq!(differing, 126, "measured on a real WebGL");
    }
}
