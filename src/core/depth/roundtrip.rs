//! Pack → store → load → unpack as one function of the depth: for one depth, for a run of
//! consecutive floats in wide vectors, and as an enclosure over an interval.

mod closures;
mod texture;

pub use closures::Closures;
use texture::Texture;

use super::arith::{Arithmetic, Fused, Interval, Mediump, Raw, Shader};
use super::packing::{Packing, Pair, PairVisitor};
use super::store::{ByteRounding, UnormLoad};
use crate::simd::{Kernel, Level};
use std::marker::PhantomData;

/// A round trip of depths, decoded to `F` (f32, or f64 beside real values). Object-safe: the analysis
/// calls it once for thousands of depths.
pub trait RoundTrip<F: Raw>: Send + Sync {
    /// Decoded values of the floats with the bit patterns `first`, `first` + 1, ….
    fn run(&self, level: Level, first: u32, out: &mut [F]);

    /// As [`Self::run`], but a channel whose byte is proved the same for all of the floats is stored
    /// and sampled once. The values are the same.
    fn run_proved(&self, level: Level, first: u32, out: &mut [F]) {
        self.run(level, first, out);
    }

    /// The one decoded value of *all* floats between two bit patterns (0 ≤ first ≤ last ≤ 1.0), where
    /// that can be proved; `None` where it cannot.
    fn constant(&self, first: u32, last: u32) -> Option<F>;

    /// The bytes of a texel, R G B A (empty for formats without bytes).
    fn texel(&self, depth: F) -> Vec<u8>;

    /// The decoded value of any depth, NaN and infinities included.
    fn decoded(&self, depth: F) -> F;

    /// False where an operation on the way overflows or is undefined.
    fn is_sound(&self, depth: F) -> bool;

    /// The depth of channel values as a filter blends them.
    fn unpack(&self, channels: [F; 4]) -> F;
}

/// A pair in arithmetic `A`, with its store and sampler.
#[derive(Clone, Debug)]
struct Through<P, A: Shader> {
    pair: P,
    texture: Texture<A::Raw>,
    arithmetic: PhantomData<fn() -> A>,
}

/// The vectorised loop: a linear sampler; `EVEN`, and which channels are `KNOWN` (bit i), are constants.
struct Run<'a, P, A: Shader, const EVEN: bool, const KNOWN: u8> {
    pair: P,
    half: A::Raw,
    scale: A::Raw,
    rest: A::Raw,
    known: [A::Raw; 4],
    first: u32,
    out: &'a mut [A::Raw],
}

impl<P: Pair, A: Shader, const EVEN: bool, const KNOWN: u8> Kernel for Run<'_, P, A, EVEN, KNOWN> {
    type Output = ();
    #[inline(always)]
    fn run(self, has_fma: bool) {
        for (i, slot) in self.out.iter_mut().enumerate() {
            let z = f32::from_bits(self.first.wrapping_add(i as u32));
            let mut channels = self.pair.pack(A::enter(A::Raw::from_depth(z)));
            for (k, channel) in channels.iter_mut().enumerate() {
                let x = channel.leave();
                let byte = if EVEN { x.byte_even() } else { x.byte_floor(self.half) };
                let sampled = byte.product_sum(self.scale, self.rest, has_fma);
                // What leads to a known channel alone is not computed.
                *channel = A::enter(if KNOWN >> k & 1 == 1 { self.known[k] } else { sampled });
            }
            *slot = self.pair.unpack(channels).leave();
        }
    }
}

/// The bytes of the first of the depths, and which of them (bit i) are proved to be those of all.
struct Enclose<'a, P, A: Shader> {
    through: &'a Through<P, A>,
    depths: Interval<A>,
}

impl<P: Pair, A: Shader> Kernel for Enclose<'_, P, A> {
    type Output = ([A::Raw; 4], u8);
    #[inline(always)]
    fn run(self, _has_fma: bool) -> Self::Output {
        let texture = &self.through.texture;
        let channels = self.through.pair.pack(self.depths);
        let (mut bytes, mut agreeing) = ([A::Raw::default(); 4], 0);
        for i in 0..4 {
            bytes[i] = texture.stored(channels[i].lo.leave());
            let agrees = bytes[i] == texture.stored(channels[i].hi.leave());
            agreeing |= u8::from(agrees) << i;
        }
        (bytes, agreeing)
    }
}

/// Every byte agrees.
const ALL_AGREE: u8 = 0b1111;
/// A run of so many depths is worth an enclosure.
const PROVED_RUN: usize = 512;

/// Whether all floats of a run lie where [`Lean`](super::arith::Lean) is plain f32.
fn are_lean(first: u32, count: usize) -> bool {
    const LEAST: u32 = (127 - 64) << 23;
    const ONE: u32 = 127 << 23;
    LEAST <= first && u64::from(first) + count as u64 <= u64::from(ONE) + 1
}

/// The two halves are compiled once for all that looks at single depths.
impl<P: Pair, A: Shader> Through<P, A> {
    #[inline(never)]
    fn packed(&self, z: A) -> [A; 4] {
        self.pair.pack(z)
    }

    #[inline(never)]
    fn unpacked(&self, channels: [A; 4]) -> A {
        self.pair.unpack(channels)
    }

    fn through(&self, z: A) -> A {
        let packed = self.packed(z);
        self.unpacked(packed.map(|c| self.sampled(self.texture.stored(c.leave()))))
    }

    fn sampled(&self, byte: A::Raw) -> A {
        A::enter(self.texture.sampled(byte))
    }

    fn enclosed(&self, first: u32, last: u32) -> ([A::Raw; 4], u8) {
        let depths = Interval { lo: Self::enters(first), hi: Self::enters(last) };
        Level::run_scalar(Enclose { through: self, depths })
    }

    /// In wide vectors. Whether there was a vector width to run in.
    fn wide<W: Shader<Raw = A::Raw>, const EVEN: bool, const KNOWN: u8>(
        &self,
        (level, first): (Level, u32),
        bytes: [A::Raw; 4],
        out: &mut [A::Raw],
    ) -> bool {
        let Texture { half, scale, rest, .. } = self.texture;
        let known = bytes.map(|byte| byte.product_sum(scale, rest, true));
        let pair = self.pair;
        let run = Run::<P, W, EVEN, KNOWN> { pair, half, scale, rest, known, first, out };
        level.run_wide(run).is_some()
    }

    fn vector_run<const EVEN: bool>(&self, level: Level, first: u32, out: &mut [A::Raw]) -> bool {
        let nothing = [A::Raw::default(); 4];
        if P::LEAN && are_lean(first, out.len()) {
            return self.wide::<A::Wide, EVEN, 0>((level, first), nothing, out);
        }
        self.wide::<A, EVEN, 0>((level, first), nothing, out)
    }

    /// [`Self::vector_run`] without the leading channels whose bytes agree, wherever they live.
    fn proved_run(&self, level: Level, first: u32, out: &mut [A::Raw]) -> bool {
        let (bytes, agreeing) = self.enclosed(first, first + (out.len() as u32 - 1));
        let (all, at) = (|mask: u8| agreeing & mask == mask, (level, first));
        match () {
            () if all(0b0011) => self.wide::<A::Wide, true, 0b0011>(at, bytes, out),
            () if all(0b0001) => self.wide::<A::Wide, true, 0b0001>(at, bytes, out),
            () if P::CHANNELS < 4 => self.wide::<A::Wide, true, 0>(at, bytes, out),
            () if all(0b1100) => self.wide::<A::Wide, true, 0b1100>(at, bytes, out),
            () if all(0b1000) => self.wide::<A::Wide, true, 0b1000>(at, bytes, out),
            () => self.wide::<A::Wide, true, 0>(at, bytes, out),
        }
    }

    /// One depth at a time; a value that enters like the one before it is not computed again.
    fn scalar_run(&self, first: u32, out: &mut [A::Raw]) {
        let mut last: Option<(A, A::Raw)> = None;
        for (bits, slot) in (first..).zip(out) {
            let z = Self::enters(bits);
            let decoded = match last {
                Some((at, decoded)) if at == z => decoded,
                _ => self.through(z).leave(),
            };
            last = Some((z, decoded));
            *slot = decoded;
        }
    }

    fn enters(bits: u32) -> A {
        A::enter(A::Raw::from_depth(f32::from_bits(bits)))
    }
}

impl<P: Pair, A: Shader + Send + Sync> RoundTrip<A::Raw> for Through<P, A> {
    fn run(&self, level: Level, first: u32, out: &mut [A::Raw]) {
        let done = match (A::COARSE || !self.texture.linear, self.texture.even) {
            (true, _) => false,
            (false, true) => self.vector_run::<true>(level, first, out),
            (false, false) => self.vector_run::<false>(level, first, out),
        };
        if !done {
            self.scalar_run(first, out);
        }
    }

    /// Compiled for the store that rounds to even.
    fn run_proved(&self, level: Level, first: u32, out: &mut [A::Raw]) {
        let vector = !A::COARSE && self.texture.linear && self.texture.even;
        let worth = vector && P::LEAN && out.len() >= PROVED_RUN && are_lean(first, out.len());
        if !(worth && self.proved_run(level, first, out)) {
            self.run(level, first, out);
        }
    }

    fn constant(&self, first: u32, last: u32) -> Option<A::Raw> {
        if A::COARSE {
            let (lo, hi) = (Self::enters(first), Self::enters(last));
            return (lo == hi).then(|| self.through(lo).leave());
        }
        let (bytes, agreeing) = self.enclosed(first, last);
        let decoded = || self.unpacked(bytes.map(|k| self.sampled(k))).leave();
        (agreeing == ALL_AGREE).then(decoded)
    }

    fn texel(&self, depth: A::Raw) -> Vec<u8> {
        let packed = self.packed(A::enter(depth));
        packed[..P::CHANNELS].iter().map(|c| self.texture.stored(c.leave()).byte()).collect()
    }

    fn decoded(&self, depth: A::Raw) -> A::Raw {
        self.through(A::enter(depth)).leave()
    }

    fn is_sound(&self, depth: A::Raw) -> bool {
        let packed = self.packed(A::enter(depth));
        packed.iter().all(|c| c.is_sound()) && self.through(A::enter(depth)).is_sound()
    }

    fn unpack(&self, channels: [A::Raw; 4]) -> A::Raw {
        self.unpacked(channels.map(A::enter)).leave()
    }
}

/// A round trip decoded to f32, or to f64 beside real values.
#[allow(missing_debug_implementations, reason = "holds trait objects")]
pub enum AnyRoundTrip {
    /// The shader runs in f32, contracted f32 or half precision.
    F32(Box<dyn RoundTrip<f32>>),
    /// Real values.
    F64(Box<dyn RoundTrip<f64>>),
}

/// What lies between a pack and its unpack.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Path {
    /// How a channel becomes a byte.
    pub rounding: ByteRounding,
    /// How a byte becomes a float (beside real values `Divide` is k/255 to f64 accuracy).
    pub load: UnormLoad,
    /// What the shader computes in.
    pub arithmetic: Arithmetic,
}

impl Path {
    /// The round trip of a pair along this path.
    #[must_use]
    pub fn of<P: Pair + 'static>(self, pair: P) -> AnyRoundTrip {
        match self.arithmetic {
            Arithmetic::F32 => AnyRoundTrip::F32(self.boxed::<P, f32>(pair)),
            Arithmetic::Fma => AnyRoundTrip::F32(self.boxed::<P, Fused>(pair)),
            Arithmetic::Fp16 => AnyRoundTrip::F32(self.boxed::<P, Mediump>(pair)),
            Arithmetic::Real => AnyRoundTrip::F64(self.boxed::<P, f64>(pair)),
        }
    }

    /// The round trip of a catalogued packing along this path.
    #[must_use]
    pub fn of_packing(self, packing: Packing) -> AnyRoundTrip {
        packing.with_pair(self)
    }

    fn boxed<P: Pair + 'static, A: Shader + Send + Sync + 'static>(
        self,
        pair: P,
    ) -> Box<dyn RoundTrip<A::Raw>> {
        let real = self.arithmetic == Arithmetic::Real;
        let texture = Texture::new(self.rounding, self.load, real);
        Box::new(Through::<P, A> { pair, texture, arithmetic: PhantomData })
    }
}

impl PairVisitor for Path {
    type Output = AnyRoundTrip;
    fn visit<P: Pair + 'static>(self, pair: P) -> AnyRoundTrip {
        self.of(pair)
    }
}
