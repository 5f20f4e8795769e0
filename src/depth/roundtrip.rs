//! Pack → store → load → unpack as one function of the depth: for one depth, for a run of
//! consecutive floats in wide vectors, and as an enclosure over an interval.

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

/// The texture unit as numbers. Bytes round to even or are ⌊255x + half⌋; the sampler returns
/// fl(k·scale) + fl(k·rest) where it is `linear`, else a table.
///
/// f32(k/255) has the linear form too: with scale = 1/255 to 16 bits, k·scale is exact (8 + 16 = 24
/// bits), and the sum is wrong by less than 2⁻⁴⁰ before its one rounding, fused or not; a test
/// compares all 256.
#[derive(Clone, Debug)]
struct Texture<F> {
    even: bool,
    half: F,
    linear: bool,
    scale: F,
    rest: F,
    table: [F; 256],
}

/// (scale, rest) of the sampler rules that have that form.
fn scale_and_rest<F: Raw>(load: UnormLoad) -> (F, F) {
    let exact = 1.0 / 255.0;
    let high = match load {
        UnormLoad::Reciprocal => f64::from(exact as f32),
        _ => f64::from(f32::from_bits((exact as f32).to_bits() & !0xff)),
    };
    let rest = if load == UnormLoad::Reciprocal { 0.0 } else { (1.0 - 255.0 * high) / 255.0 };
    (F::from_real(high), F::from_real(rest))
}

impl<F: Raw> Texture<F> {
    fn new(rounding: ByteRounding, load: UnormLoad, real: bool) -> Self {
        let (scale, rest) = scale_and_rest(load);
        let value = |k: usize| match load {
            UnormLoad::Divide => F::from_real(k as f64 / 255.0),
            _ => F::from_depth(load.value(k as u32, 255)),
        };
        let half = if let ByteRounding::Floor { half } = rounding { half } else { 0.0 };
        Self {
            even: rounding == ByteRounding::Even,
            half: F::from_real(half),
            linear: load == UnormLoad::Divide || (load == UnormLoad::Reciprocal && !real),
            scale,
            rest,
            table: std::array::from_fn(value),
        }
    }

    #[inline(always)]
    fn stored(&self, x: F) -> F {
        if self.even { x.byte_even() } else { x.byte_floor(self.half) }
    }

    fn sampled(&self, byte: F) -> F {
        self.table[usize::from(byte.byte())]
    }
}

/// The vectorised loop: a linear sampler, `EVEN` known when it is compiled.
struct Run<'a, P, A: Shader, const EVEN: bool> {
    pair: P,
    half: A::Raw,
    scale: A::Raw,
    rest: A::Raw,
    first: u32,
    out: &'a mut [A::Raw],
}

impl<P: Pair, A: Shader, const EVEN: bool> Kernel for Run<'_, P, A, EVEN> {
    type Output = ();
    #[inline(always)]
    fn run(self, has_fma: bool) {
        for (i, slot) in self.out.iter_mut().enumerate() {
            let z = f32::from_bits(self.first.wrapping_add(i as u32));
            let mut channels = self.pair.pack(A::enter(A::Raw::from_depth(z)));
            for channel in &mut channels {
                let x = channel.leave();
                let byte = if EVEN { x.byte_even() } else { x.byte_floor(self.half) };
                *channel = A::enter(byte.product_sum(self.scale, self.rest, has_fma));
            }
            *slot = self.pair.unpack(channels).leave();
        }
    }
}

/// The bytes of every depth between two, where they are the same.
struct Enclose<'a, P, A: Shader> {
    through: &'a Through<P, A>,
    depths: Interval<A>,
}

impl<P: Pair, A: Shader> Kernel for Enclose<'_, P, A> {
    type Output = Option<[A::Raw; 4]>;
    #[inline(always)]
    fn run(self, _has_fma: bool) -> Self::Output {
        let texture = &self.through.texture;
        let channels = self.through.pair.pack(self.depths);
        let mut bytes = [A::Raw::default(); 4];
        for i in 0..4 {
            bytes[i] = texture.stored(channels[i].lo.leave());
            if bytes[i] != texture.stored(channels[i].hi.leave()) {
                return None;
            }
        }
        Some(bytes)
    }
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

    /// Whether there was a vector width to run in.
    fn vector_run<const EVEN: bool>(&self, level: Level, first: u32, out: &mut [A::Raw]) -> bool {
        let Texture { half, scale, rest, .. } = self.texture;
        let run = Run::<P, A, EVEN> { pair: self.pair, half, scale, rest, first, out };
        level.run_wide(run).is_some()
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

    fn constant(&self, first: u32, last: u32) -> Option<A::Raw> {
        let (lo, hi) = (Self::enters(first), Self::enters(last));
        if A::COARSE {
            return (lo == hi).then(|| self.through(lo).leave());
        }
        let bytes = Level::run_scalar(Enclose { through: self, depths: Interval { lo, hi } })?;
        Some(self.unpacked(bytes.map(|k| self.sampled(k))).leave())
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

/// A user's own pair as Rust closures, in f32. Nothing can be proved about a closure, so
/// [`RoundTrip::constant`] never answers and exhaustive runs evaluate every float.
#[allow(missing_debug_implementations, reason = "holds closures")]
pub struct Closures<P, U> {
    pack: P,
    unpack: U,
    channels: usize,
    texture: Texture<f32>,
}

impl<P, U> Closures<P, U>
where
    P: Fn(f32) -> [f32; 4] + Send + Sync,
    U: Fn([f32; 4]) -> f32 + Send + Sync,
{
    /// `channels` of the four that `pack` returns are stored by `rounding`, read by `load` and given
    /// to `unpack`.
    pub fn new(
        channels: usize,
        rounding: ByteRounding,
        load: UnormLoad,
        pack: P,
        unpack: U,
    ) -> Self {
        Self { pack, unpack, channels, texture: Texture::new(rounding, load, false) }
    }
}

impl<P, U> RoundTrip<f32> for Closures<P, U>
where
    P: Fn(f32) -> [f32; 4] + Send + Sync,
    U: Fn([f32; 4]) -> f32 + Send + Sync,
{
    fn run(&self, _: Level, first: u32, out: &mut [f32]) {
        for (bits, slot) in (first..).zip(out) {
            *slot = self.decoded(f32::from_bits(bits));
        }
    }
    fn constant(&self, _: u32, _: u32) -> Option<f32> {
        None
    }
    fn texel(&self, depth: f32) -> Vec<u8> {
        let packed = (self.pack)(depth);
        packed.iter().take(self.channels).map(|&c| self.texture.stored(c).byte()).collect()
    }
    fn decoded(&self, depth: f32) -> f32 {
        let sample = |c: f32| self.texture.sampled(self.texture.stored(c));
        (self.unpack)((self.pack)(depth).map(sample))
    }
    fn is_sound(&self, depth: f32) -> bool {
        (self.pack)(depth).iter().all(|c| c.is_finite())
    }
    fn unpack(&self, channels: [f32; 4]) -> f32 {
        (self.unpack)(channels)
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_products_give_every_sampled_byte() {
        for load in [UnormLoad::Divide, UnormLoad::Reciprocal] {
            let (scale, rest) = scale_and_rest::<f32>(load);
            for (k, fused) in (0..=255u32).flat_map(|k| [(k, false), (k, true)]) {
                let value = (k as f32).product_sum(scale, rest, fused);
                assert_eq!(value, load.value(k, 255), "byte {k}, {load}, fused {fused}");
            }
        }
    }
}
