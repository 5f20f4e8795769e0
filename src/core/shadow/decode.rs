//! Reading whole maps back: many texels at a time, and how far they are from what was drawn.
#![allow(clippy::needless_range_loop, reason = "loops over indices become vectors")]

use super::encode::{LANES, RUN, resized};
use crate::depth::Packing;
use crate::depth::packing::{Pair, PairVisitor};
use crate::device::Device;
use crate::simd::{Kernel, Level};
use rayon::prelude::*;

/// The depths of packed texels, as the device's sampler and the packing return them.
pub(super) fn loaded(device: &Device, packing: Packing, bytes: &[[u8; 4]], out: &mut Vec<f32>) {
    resized(out, bytes.len(), 0.0);
    let channel: [f32; 256] = std::array::from_fn(|k| device.load.value(k as u32, 255));
    out.par_chunks_mut(RUN).zip(bytes.par_chunks(RUN)).for_each(|(out, bytes)| {
        packing.with_pair(Loaded { channel: &channel, bytes, out });
    });
}

/// The largest |stored − drawn|, rounded up; +∞ where one of them is not a number.
pub(super) fn error(drawn: &[f32], stored: &[f32]) -> f32 {
    let runs = drawn.par_chunks(RUN).zip(stored.par_chunks(RUN));
    let of = |(drawn, stored)| Level::best().run(Differences { drawn, stored });
    runs.map(of).reduce(|| 0.0, f32::max).next_up()
}

/// Decodes texels through a pair that is known when it is compiled.
struct Loaded<'a> {
    channel: &'a [f32; 256],
    bytes: &'a [[u8; 4]],
    out: &'a mut [f32],
}

impl PairVisitor for Loaded<'_> {
    type Output = ();

    fn visit<P: Pair + 'static>(self, pair: P) {
        let Self { channel, bytes, out } = self;
        Level::best().run(Depth { pair, channel, bytes, out });
    }
}

struct Depth<'a, P> {
    pair: P,
    channel: &'a [f32; 256],
    bytes: &'a [[u8; 4]],
    out: &'a mut [f32],
}

impl<P: Pair> Kernel for Depth<'_, P> {
    type Output = ();

    #[inline(always)]
    fn run(self, _: bool) {
        for (out, texel) in self.out.iter_mut().zip(self.bytes) {
            *out = self.pair.unpack(texel.map(|byte| self.channel[usize::from(byte)]));
        }
    }
}

struct Differences<'a> {
    drawn: &'a [f32],
    stored: &'a [f32],
}

impl Kernel for Differences<'_> {
    type Output = f32;

    /// An f32 difference is rounded to nearest: the next float above the largest is not below any.
    #[inline(always)]
    fn run(self, _: bool) -> f32 {
        let mut most = [0.0f32; LANES];
        let (drawn, stored) = (self.drawn.chunks(LANES), self.stored.chunks(LANES));
        for (drawn, stored) in drawn.zip(stored) {
            for k in 0..drawn.len() {
                let difference = (stored[k] - drawn[k]).abs();
                let difference = if difference >= 0.0 { difference } else { f32::INFINITY };
                most[k] = if difference > most[k] { difference } else { most[k] };
            }
        }
        most.into_iter().fold(0.0, f32::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::device::DeviceProfile;
    use crate::shadow::loaded_depth;

    #[test]
    fn many_texels_are_read_like_one() {
        let texels: Vec<[u8; 4]> =
            (0..70_000u32).map(|k| k.wrapping_mul(0x9E37_79B1).to_le_bytes()).collect();
        for device in DeviceProfile::ALL.iter().map(|profile| profile.device()) {
            for &packing in Packing::ALL {
                let mut out = Vec::new();
                loaded(&device, packing, &texels, &mut out);
                for (&texel, found) in texels.iter().zip(out) {
                    let one = loaded_depth(&device, packing, texel);
                    assert_eq!(
                        found.to_bits(),
                        one.to_bits(),
                        "{packing} of {texel:?}, {device:?}"
                    );
                }
            }
        }
    }

    #[test]
    fn no_stored_depth_is_farther_from_the_drawn_one_than_their_error() {
        let drawn = [0.1, 0.7, 0.3, 0.5];
        let stored = [0.1, 0.7 + 1.0 / 512.0, 0.3 - 1.0 / 1024.0, 0.5];
        let found = error(&drawn, &stored);
        let exact = f64::from(stored[1]) - f64::from(drawn[1]);
        assert!(f64::from(found) >= exact && f64::from(found) < exact * 1.000_001);
        assert_eq!(error(&drawn, &[0.1, f32::NAN, 0.3, 0.5]), f32::INFINITY);
    }
}
