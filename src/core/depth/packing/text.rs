//! A user's own pair as data: base, order, masks and end cases in TOML.

use super::Pair;
use crate::depth::arith::Number;
use crate::{Error, Result};

/// Where the most significant digit lives.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
enum Order {
    HighFirst,
    LowFirst,
}

/// How the sampled channels become a depth again.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
enum Decode {
    Dot,
    Digits,
}

/// The file's form; see [`TextPair::from_toml`].
#[derive(Clone, Debug, serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    base: f64,
    #[serde(default = "four")]
    channels: usize,
    order: Order,
    #[serde(default)]
    unmasked: Vec<usize>,
    #[serde(default = "one")]
    upscale: f64,
    #[serde(default)]
    offset: f64,
    scales: Option<Vec<f64>>,
    weights: Option<Vec<f64>>,
    #[serde(default = "dot_decode")]
    decode: Decode,
    at_one: Option<Vec<f64>>,
    at_zero: Option<Vec<f64>>,
    limit: Option<f64>,
}

fn four() -> usize {
    4
}
fn one() -> f64 {
    1.0
}
fn dot_decode() -> Decode {
    Decode::Dot
}

/// A fract-digit pair given as data. Digit i is fract(scaleᵢ·z), most significant first; a masked
/// channel loses the next digit over the base; then `·upscale + offset`.
#[derive(Clone, Copy, Debug)]
pub struct TextPair {
    channels: usize,
    low_first: bool,
    base: f64,
    scales: [f64; 4],
    masked: [bool; 4],
    upscale: f64,
    offset: f64,
    weights: [f64; 4],
    digits: bool,
    at_one: Option<[f64; 4]>,
    at_zero: Option<[f64; 4]>,
    limit: Option<f64>,
}

impl TextPair {
    /// Reads the text form. `place` names the file in messages.
    ///
    /// ```
    /// let pair = gnomon_core::depth::packing::TextPair::from_toml("mine.toml", r#"
    /// base = 255.0            # ratio between neighbouring digits
    /// channels = 4            # 1 to 4 (default 4)
    /// order = "high-first"    # or "low-first": where the most significant digit lives
    /// unmasked = [3]          # digits (0 = most significant) that keep what lies below them
    /// upscale = 1.0           # multiplies every channel after masking (three.js r86: 256/255)
    /// offset = 0.0            # added to every channel (Aras 2007: 0.5/255)
    /// # scales = [1, 255, 65025, 16581375]         # instead of powers of the base
    /// # weights = [1, 3.9e-3, 1.5e-5, 6.0e-8]      # instead of 1/(scale·upscale)
    /// decode = "dot"          # or "digits": round(255·c) in base 256 over 256ⁿ − 1
    /// at_one = [1, 1, 1, 1]   # channels for z ≥ 1, in R G B A (default: no end case)
    /// at_zero = [0, 0, 0, 0]  # channels for z ≤ 0
    /// # limit = 0.999         # z is first clamped to this
    /// "#).unwrap();
    /// ```
    ///
    /// # Errors
    /// One sentence that names the key and what to do.
    pub fn from_toml(place: &str, text: &str) -> Result<Self> {
        let file: File = toml::from_str(text).map_err(|e| {
            let reason = e.message().lines().next().unwrap_or("not valid TOML").to_string();
            Error::bad_input(place, reason, "see `gnomon-roundtrip --help` for the keys of a pair")
        })?;
        file.check(place)?;
        Ok(file.pair())
    }
}

impl File {
    fn check(&self, place: &str) -> Result<()> {
        let fail = |key: &str, reason: &str, fix: &str| {
            Err(Error::bad_input(format!("{place}: {key}"), reason, fix))
        };
        if !(1..=4).contains(&self.channels) {
            return fail("channels", "must be 1, 2, 3 or 4", "give the number of bytes a texel");
        }
        if !(self.base.is_finite() && self.base > 1.0) {
            return fail("base", "must be a finite number above 1", "use 255 or 256");
        }
        let lists =
            [("scales", &self.scales), ("weights", &self.weights), ("at_one", &self.at_one)];
        for (key, list) in lists.into_iter().chain([("at_zero", &self.at_zero)]) {
            let wrong = list
                .as_ref()
                .is_some_and(|l| l.len() != self.channels || l.iter().any(|x| !x.is_finite()));
            if wrong {
                return fail(key, "needs one finite number for each channel", "mend the list");
            }
        }
        if self.scales.as_ref().is_some_and(|l| l.iter().any(|&x| x <= 0.0)) {
            return fail("scales", "must be positive", "mend the list");
        }
        if !(self.upscale.is_finite() && self.upscale > 0.0 && self.offset.is_finite()) {
            return fail("upscale", "upscale must be positive, offset finite", "mend the numbers");
        }
        if self.unmasked.iter().any(|&i| i >= self.channels) {
            return fail("unmasked", "names a digit that is not there", "digits count from 0");
        }
        if self.limit.is_some_and(|l| !(l > 0.0 && l <= 1.0)) {
            return fail("limit", "must lie in (0, 1]", "use 0.999 or leave it out");
        }
        Ok(())
    }

    fn pair(self) -> TextPair {
        let four = |list: Vec<f64>| {
            let mut array = [0.0; 4];
            array[..list.len()].copy_from_slice(&list);
            array
        };
        let mut scales = [1.0; 4];
        for i in 1..4 {
            scales[i] = scales[i - 1] * self.base;
        }
        let scales = self.scales.map_or(scales, four);
        let weights = self.weights.map_or(scales.map(|s| 1.0 / (s * self.upscale)), four);
        let masked = |i| i + 1 < self.channels && !self.unmasked.contains(&i);
        TextPair {
            channels: self.channels,
            low_first: self.order == Order::LowFirst,
            base: self.base,
            scales,
            masked: [0, 1, 2, 3].map(masked),
            upscale: self.upscale,
            offset: self.offset,
            weights,
            digits: self.decode == Decode::Digits,
            at_one: self.at_one.map(four),
            at_zero: self.at_zero.map(four),
            limit: self.limit,
        }
    }
}

impl TextPair {
    /// How many of the four channels carry the depth.
    #[must_use]
    pub fn channels(&self) -> usize {
        self.channels
    }

    /// Most significant first ↔ R G B A.
    #[inline(always)]
    fn ordered<T: Copy>(&self, mut c: [T; 4]) -> [T; 4] {
        if self.low_first {
            c[..self.channels].reverse();
        }
        c
    }

    #[inline(always)]
    fn stretched<A: Number>(&self, c: A) -> A {
        let c = if self.upscale == 1.0 { c } else { c * A::whole(self.upscale) };
        if self.offset == 0.0 { c } else { c + A::whole(self.offset) }
    }
}

impl Pair for TextPair {
    /// A user's scale may be infinite.
    const LEAN: bool = false;
    #[inline(always)]
    fn pack<A: Number>(&self, z: A) -> [A; 4] {
        let q = A::ratio(1.0, self.base);
        let limited = self.limit.map_or(z, |l| z.at_least(A::whole(l), A::whole(l), z));
        let digit = self.scales.map(|scale| (limited * A::whole(scale)).fract());
        let mut c = [A::whole(0.0); 4];
        for i in 0..self.channels {
            let kept =
                if self.masked[i] { digit[i].minus_product(digit[i + 1], q) } else { digit[i] };
            c[i] = self.stretched(kept);
        }
        let mut c = self.ordered(c);
        for i in 0..4 {
            if let Some(end) = self.at_one {
                c[i] = z.at_least(A::whole(1.0), A::whole(end[i]), c[i]);
            }
            if let Some(end) = self.at_zero {
                let tiny = A::whole(f64::from(f32::from_bits(1)));
                c[i] = z.at_least(tiny, c[i], A::whole(end[i]));
            }
        }
        c
    }

    #[inline(always)]
    fn unpack<A: Number>(&self, c: [A; 4]) -> A {
        let weights = self.ordered(self.weights).map(A::whole);
        let mut sum = c[0] * weights[0];
        for i in 1..self.channels {
            sum = sum.plus_product(c[i], weights[i]);
        }
        if !self.digits {
            return sum;
        }
        let (top, base) = (A::whole(255.0), A::whole(256.0));
        let c = self.ordered(c);
        let (mut code, mut max) = (A::whole(0.0), 1.0);
        for &channel in &c[..self.channels] {
            code = code * base + (channel * top).nearest();
            max *= 256.0;
        }
        code / A::whole(max - 1.0)
    }
}
