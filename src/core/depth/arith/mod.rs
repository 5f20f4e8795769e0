//! The arithmetics a packing can run in: each packing is written once, over [`Number`].
//!
//! | type | what one operation does |
//! |---|---|
//! | `f32` | rounds to f32, no contraction (the measured WebGL) |
//! | [`Fused`] | rounds to f32, a product that feeds a sum is contracted to one `fma` |
//! | [`Folded`] | as f32, but x / c is x times the rounded 1/c |
//! | [`Mediump`] | rounds to half precision, overflows to infinity (phones) |
//! | [`Lean`] | as `f32`, in fewer instructions, on depths of [2⁻⁶⁴, 1] |
//! | `f64` | the real value to f64 accuracy: what the formula means |
//! | [`Interval`] | encloses the results of one of the above over an interval of depths |

mod folded;
mod fused;
mod interval;
mod lean;
mod mediump;
mod plain;

pub use folded::Folded;
pub use fused::Fused;
pub use interval::Interval;
pub use lean::Lean;
pub use mediump::Mediump;
use std::ops::{Add, Div, Mul, Sub};

crate::catalogue! {
    /// The arithmetic of the shader that packs and unpacks.
    pub enum Arithmetic {
        /// f32, every operation rounded by itself.
        F32 = "f32",
        /// f32 with contraction: pack `fma(−e, q, c)`, dot product as an fma chain.
        Fma = "fma",
        /// Half precision, every operation rounded (`mediump` on phones).
        Fp16 = "fp16",
        /// The exact real value, to f64 accuracy.
        Real = "real",
    }
}

/// What a packing may do with a depth. Every operation rounds once to the implementing arithmetic
/// and is monotone in each operand (nonincreasing in a subtrahend), which makes [`Interval`] an
/// enclosure without any outward rounding.
pub trait Number:
    Copy
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
{
    /// The constant n/d, rounded once.
    fn ratio(n: f64, d: f64) -> Self;
    /// Largest integer not above the value.
    #[must_use]
    fn floor(self) -> Self;
    /// Nearest integer, ties to even (`round` of GLSL ES 3, WGSL and HLSL).
    #[must_use]
    fn nearest(self) -> Self;
    /// nearest(self·scale). For real values the product is not rounded first.
    #[inline(always)]
    #[must_use]
    fn nearest_product(self, scale: Self) -> Self {
        (self * scale).nearest()
    }
    /// x − floor(x), kept below one as measured: min(x − floor(x), 1 − 2⁻²⁴) in f32. NaN gives the
    /// largest value below one, as `min` does.
    #[must_use]
    fn fract(self) -> Self;
    /// self + a·b, contracted where the arithmetic contracts.
    #[inline(always)]
    #[must_use]
    fn plus_product(self, a: Self, b: Self) -> Self {
        self + a * b
    }
    /// self − a·b, contracted where the arithmetic contracts.
    #[inline(always)]
    #[must_use]
    fn minus_product(self, a: Self, b: Self) -> Self {
        self - a * b
    }
    /// `then` where self ≥ limit, else `otherwise` (NaN takes `otherwise`).
    #[inline(always)]
    #[must_use]
    fn at_least(self, limit: Self, then: Self, otherwise: Self) -> Self {
        if self >= limit { then } else { otherwise }
    }
    /// Byte `index` (0 = least significant) of the f32 bit pattern, as a number 0…255.
    #[must_use]
    fn pattern_byte(self, index: u32) -> Self;
    /// The f32 with these bytes, most significant first; each is truncated to an integer 0…255.
    fn from_pattern(bytes: [Self; 4]) -> Self;

    /// The constant `n`, rounded once.
    #[inline(always)]
    fn whole(n: f64) -> Self {
        Self::ratio(n, 1.0)
    }
}

/// A [`Number`] that a shader runs in: it exchanges floats with the texture unit.
pub trait Shader: Number {
    /// The floats of the texture unit: f32, or f64 beside real values.
    type Raw: Raw;
    /// Arithmetic with these results on depths of [2⁻⁶⁴, 1] in fewer instructions, where the machine has `fma`.
    type Wide: Shader<Raw = Self::Raw>;
    /// An input or a sampled channel enters, rounded to the arithmetic.
    fn enter(raw: Self::Raw) -> Self;
    /// A value leaves for the texture unit, exactly.
    fn leave(self) -> Self::Raw;
    /// Whether so many depths enter as one value that a run of them is better taken one value at a
    /// time, and whether only single values can be enclosed.
    const COARSE: bool = false;
    /// False where an operation on the way met infinity or NaN (told by [`Mediump`] alone).
    fn is_sound(self) -> bool {
        true
    }
}

/// The constants n/dᵢ. Packings spell arrays out: `array::map` is not always inlined, and what is not
/// inlined into a kernel is compiled without its instructions.
#[inline(always)]
pub fn ratios<A: Number>(n: f64, [r, g, b, a]: [f64; 4]) -> [A; 4] {
    [A::ratio(n, r), A::ratio(n, g), A::ratio(n, b), A::ratio(n, a)]
}

/// Σ cᵢwᵢ summed left to right; an fma chain where the arithmetic contracts.
#[inline(always)]
pub fn dot<A: Number, const N: usize>(c: [A; N], w: [A; N]) -> A {
    let mut sum = c[0] * w[0];
    for i in 1..N {
        sum = sum.plus_product(c[i], w[i]);
    }
    sum
}

/// The float types of texture units and of the error measurement.
pub trait Raw:
    Copy
    + PartialOrd
    + Default
    + Send
    + Sync
    + std::fmt::Debug
    + Into<f64>
    + Sub<Output = Self>
    + 'static
{
    /// Its bit pattern as a signed integer: nonnegative values order as integers, negative ones lie
    /// below them all.
    type Key: Ord + Copy + Default + Send + Sync + std::fmt::Debug;
    /// From a f32 depth, exactly.
    fn from_depth(z: f32) -> Self;
    /// From f64, rounded once.
    fn from_real(x: f64) -> Self;
    /// x·255 clamped to [0, 255] (NaN gives 0), rounded to nearest, ties to even.
    #[must_use]
    fn byte_even(self) -> Self;
    /// x·255 clamped to [0, 255] (NaN gives 0), plus `half`, rounded down.
    #[must_use]
    fn byte_floor(self, half: Self) -> Self;
    /// fl(self·a) + fl(self·b), rounded; with `fused`, fl(self·a + fl(self·b)).
    #[must_use]
    fn product_sum(self, a: Self, b: Self, fused: bool) -> Self;
    /// The byte that it is (fraction dropped).
    fn byte(self) -> u8;
    /// The ordered bit pattern.
    fn key(self) -> Self::Key;
    /// The inverse of [`Self::key`].
    fn from_key(key: Self::Key) -> Self;
}
