//! A user's own pair as two Rust closures.

use super::super::arith::Raw;
use super::super::store::{ByteRounding, UnormLoad};
use super::{RoundTrip, Texture};
use crate::simd::Level;

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
