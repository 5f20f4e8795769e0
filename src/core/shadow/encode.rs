//! Storing whole maps: many depths at a time, bit for bit what the device stores of each.
#![allow(clippy::needless_range_loop, reason = "loops over indices become vectors")]

use super::Drawn;
use crate::depth::packing::{Pair, PairVisitor};
use crate::depth::{DepthFormat, Packing, UnormLoad, UnormStore};
use crate::device::Device;
use crate::scene::NO_TRIANGLE;
use crate::simd::{Kernel, Level};
use rayon::prelude::*;

/// Texels that a thread stores at a time: they stay in its cache.
pub(super) const RUN: usize = 1 << 12;

/// Where depths are stored, and how.
pub(super) enum Store<'a> {
    /// As they come back from texels of `format`: [`Device::stored_depth`] of each.
    Depths { format: DepthFormat, out: &'a mut Vec<f32> },
    /// As the bytes of packed texels, `clear` where nothing was drawn.
    Bytes { packing: Packing, clear: [u8; 4], out: &'a mut Vec<[u8; 4]> },
}

/// A run of texels of a [`Store`].
enum Part<'a> {
    Depths(DepthFormat, &'a mut [f32]),
    Bytes(Packing, [u8; 4], &'a mut [[u8; 4]]),
}

/// Stores what was drawn in several ways, run by run.
pub(super) fn store(device: &Device, stores: Vec<Store>, drawn: Drawn) {
    let len = drawn.depth.len();
    assert_eq!(len, drawn.triangle.len(), "a triangle for each depth");
    let mut runs: Vec<Vec<Part>> = Vec::new();
    runs.resize_with(len.div_ceil(RUN), || Vec::with_capacity(stores.len()));
    for store in stores {
        match store {
            Store::Depths { format, out } => {
                let parts = resized(out, len, 0.0).chunks_mut(RUN);
                runs.iter_mut().zip(parts).for_each(|(run, x)| run.push(Part::Depths(format, x)));
            }
            Store::Bytes { packing, clear, out } => {
                let parts = resized(out, len, [0; 4]).chunks_mut(RUN);
                let part = |x| Part::Bytes(packing, clear, x);
                runs.iter_mut().zip(parts).for_each(|(run, x)| run.push(part(x)));
            }
        }
    }
    let drawn = drawn.depth.par_chunks(RUN).zip(drawn.triangle.par_chunks(RUN));
    runs.into_par_iter().zip(drawn).for_each(|(parts, (depth, triangle))| {
        parts.into_iter().for_each(|part| part.store(device, Drawn { depth, triangle }));
    });
}

impl Part<'_> {
    fn store(self, device: &Device, drawn: Drawn) {
        match self {
            Self::Bytes(packing, clear, out) => {
                packing.with_pair(Packed { device, drawn, clear, out });
            }
            Self::Depths(format, out) => match Stored::new(device, format) {
                Some(how) => Level::best().run(Depths { how, depth: drawn.depth, out }),
                None => {
                    let stored = drawn.depth.iter().map(|&z| device.stored_depth(format, z));
                    out.iter_mut().zip(stored).for_each(|(out, z)| *out = z);
                }
            },
        }
    }
}

/// A list of so many items; its memory is used again.
pub(super) fn resized<T: Copy>(list: &mut Vec<T>, len: usize, zero: T) -> &mut [T] {
    if list.len() != len {
        *list = vec![zero; len];
    }
    list
}

/// How a depth is stored and read back, without a branch on the way.
#[derive(Clone, Copy)]
enum Stored {
    /// Codes of a normalised integer, divided by the largest of them or times its f32 reciprocal.
    Unorm { store: UnormStore, max: u32, flush: bool, divides: bool },
    /// A float with so few bits less than f32.
    Float { dropped: u32, flush: bool },
}

impl Stored {
    /// None where the device's sampler has no plain form.
    fn new(device: &Device, format: DepthFormat) -> Option<Self> {
        let (format, flush) = (device.depth_format(format), device.flush_denormals);
        match (format, format.unorm_max()) {
            (_, Some(max)) => (device.load != UnormLoad::Half).then_some(Self::Unorm {
                store: device.store,
                max,
                flush,
                divides: device.load == UnormLoad::Divide,
            }),
            (DepthFormat::F16, None) => Some(Self::Float { dropped: 13, flush }),
            (DepthFormat::Bf16, None) => Some(Self::Float { dropped: 16, flush }),
            (_, None) => Some(Self::Float { dropped: 0, flush }),
        }
    }
}

struct Depths<'a> {
    how: Stored,
    depth: &'a [f32],
    out: &'a mut [f32],
}

impl Kernel for Depths<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self, _: bool) {
        let Self { how, depth, out } = self;
        match how {
            Stored::Unorm { store, max, flush, divides } => match store {
                UnormStore::Exact => unorm::<0>(depth, out, least(flush), max, divides),
                UnormStore::HalfEven => unorm::<1>(depth, out, least(flush), max, divides),
                UnormStore::HalfUp => unorm::<2>(depth, out, least(flush), max, divides),
                UnormStore::Truncate => unorm::<3>(depth, out, least(flush), max, divides),
            },
            Stored::Float { dropped: 0, flush } => float::<0>(depth, out, least(flush)),
            Stored::Float { dropped: 13, flush } => float::<13>(depth, out, least(flush)),
            Stored::Float { flush, .. } => float::<16>(depth, out, least(flush)),
        }
    }
}

/// Depths below this are stored as 0.
#[inline(always)]
fn least(flush: bool) -> f32 {
    if flush { f32::MIN_POSITIVE } else { 0.0 }
}

/// A depth in [0, 1]: NaN and what lies below `least` is 0.
#[inline(always)]
fn clamped(z: f32, least: f32) -> f32 {
    let z = if z >= least { z } else { 0.0 };
    (if z > 1.0 { 1.0 } else { z }) + 0.0
}

/// The nearest integer, ties to even, of 0 ≤ x < 2³²: the sum with 2⁵² has a last place of 1.
#[inline(always)]
fn nearest(x: f64) -> f64 {
    (x + (1u64 << 52) as f64) - (1u64 << 52) as f64
}

/// The largest integer not above x, for 0 ≤ x < 2³².
#[inline(always)]
fn floor(x: f64) -> f64 {
    let near = nearest(x);
    if near > x { near - 1.0 } else { near }
}

/// The code of a depth in [0, 1], as [`UnormStore::code`] gives it (`STORE` counts its members).
#[inline(always)]
fn code<const STORE: u8>(z: f32, max: u32, largest: f64) -> f64 {
    let product = f64::from(z * max as f32);
    let code = match STORE {
        0 => nearest(f64::from(z) * largest),
        1 => nearest(product),
        2 => floor(f64::from(z * max as f32 + 0.5)),
        _ => floor(product),
    };
    if code < largest { code } else { largest }
}

/// Up to 24 bits a code times 1/max, in f64, rounds to the same f32 as the quotient: compared for
/// all of them by a test.
#[inline(always)]
fn unorm<const STORE: u8>(depth: &[f32], out: &mut [f32], least: f32, max: u32, divides: bool) {
    let (largest, inverse) = (f64::from(max), 1.0 / f64::from(max));
    if !divides {
        for (out, &z) in out.iter_mut().zip(depth) {
            *out = code::<STORE>(clamped(z, least), max, largest) as f32 * inverse as f32;
        }
    } else if max < 1 << 24 {
        for (out, &z) in out.iter_mut().zip(depth) {
            *out = (code::<STORE>(clamped(z, least), max, largest) * inverse) as f32;
        }
    } else {
        for (out, &z) in out.iter_mut().zip(depth) {
            *out = (code::<STORE>(clamped(z, least), max, largest) / largest) as f32;
        }
    }
}

/// The byte of a channel in [0, 1] in f32 alone: the sum with 2²³ has a last place of 1, and a fused
/// product is not rounded before.
#[inline(always)]
fn byte<const STORE: u8>(x: f32, has_fma: bool) -> u32 {
    const SHIFT: f32 = (1 << 23) as f32;
    match STORE {
        0 if has_fma => x.mul_add(255.0, SHIFT).to_bits() & 0xff,
        1 => (x * 255.0 + SHIFT).to_bits() & 0xff,
        _ => code::<STORE>(x, 255, 255.0) as i32 as u32,
    }
}

/// Floats with `DROPPED` bits less, nearest, ties to even. Below 2⁻¹⁴ f16 counts in steps of 2⁻²⁴,
/// which is the last place of 0.5 in f32.
#[inline(always)]
fn float<const DROPPED: u32>(depth: &[f32], out: &mut [f32], least: f32) {
    for (out, &z) in out.iter_mut().zip(depth) {
        let z = clamped(z, least);
        let bits = z.to_bits();
        let odd = (bits >> DROPPED) & 1;
        let half = if DROPPED == 0 { 0 } else { (1 << DROPPED >> 1) - 1 + odd };
        let kept = f32::from_bits(bits.wrapping_add(half) & !((1 << DROPPED) - 1));
        let tiny = (DROPPED == 13) & (z < 1.0 / 16_384.0);
        *out = if tiny { (z + 0.5) - 0.5 } else { kept };
    }
}

/// Packs depths through a pair that is known when it is compiled.
struct Packed<'a> {
    device: &'a Device,
    drawn: Drawn<'a>,
    clear: [u8; 4],
    out: &'a mut [[u8; 4]],
}

impl PairVisitor for Packed<'_> {
    type Output = ();

    fn visit<P: Pair + 'static>(self, pair: P) {
        match self.device.store {
            UnormStore::Exact => Level::best().run(Bytes::<P, 0> { pair, job: self }),
            UnormStore::HalfEven => Level::best().run(Bytes::<P, 1> { pair, job: self }),
            UnormStore::HalfUp => Level::best().run(Bytes::<P, 2> { pair, job: self }),
            UnormStore::Truncate => Level::best().run(Bytes::<P, 3> { pair, job: self }),
        }
    }
}

struct Bytes<'a, P, const STORE: u8> {
    pair: P,
    job: Packed<'a>,
}

/// Texels packed at a time.
pub(super) const LANES: usize = 16;

impl<P: Pair, const STORE: u8> Kernel for Bytes<'_, P, STORE> {
    type Output = ();

    #[inline(always)]
    fn run(self, has_fma: bool) {
        let Self { pair, job: Packed { device, drawn, clear, out } } = self;
        let least = least(device.flush_denormals);
        let (depths, last_depths) = drawn.depth.as_chunks::<LANES>();
        let (ids, last_ids) = drawn.triangle.as_chunks::<LANES>();
        let (texels, last_texels) = out.as_chunks_mut::<LANES>();
        for ((depths, ids), texels) in depths.iter().zip(ids).zip(texels) {
            *texels = packed::<P, STORE>(&pair, depths, ids, least, clear, has_fma);
        }
        let (mut depths, mut ids, last) = ([0.0; LANES], [0; LANES], last_texels.len());
        depths[..last].copy_from_slice(last_depths);
        ids[..last].copy_from_slice(last_ids);
        let texels = packed::<P, STORE>(&pair, &depths, &ids, least, clear, has_fma);
        last_texels.copy_from_slice(&texels[..last]);
    }
}

/// Some texels of a pass, packed; `clear` where nothing was drawn.
#[inline(always)]
fn packed<P: Pair, const STORE: u8>(
    pair: &P,
    depths: &[f32; LANES],
    ids: &[u32; LANES],
    least: f32,
    clear: [u8; 4],
    has_fma: bool,
) -> [[u8; 4]; LANES] {
    let (mut texels, clear) = ([[0; 4]; LANES], u32::from_le_bytes(clear));
    for k in 0..LANES {
        let [r, g, b, a] = pair.pack(depths[k]);
        let (r, g) = (clamped(r, least), clamped(g, least));
        let (b, a) = (clamped(b, least), clamped(a, least));
        let low = byte::<STORE>(r, has_fma) | byte::<STORE>(g, has_fma) << 8;
        let high = byte::<STORE>(b, has_fma) << 16 | byte::<STORE>(a, has_fma) << 24;
        texels[k] = if ids[k] == NO_TRIANGLE { clear } else { low | high }.to_le_bytes();
    }
    texels
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::device::DeviceProfile;
    use crate::num::{from_ordinal, ordinal};
    use crate::shadow::stored_bytes;

    /// Odd depths, and all around the steps of every format.
    fn samples() -> Vec<f32> {
        let odd = [f32::NAN, -0.0, -1.0, 2.0, f32::INFINITY, f32::MIN_POSITIVE, 1e-40, 1.0, 0.5];
        let steps = (0..4000).map(|k| f64::from(k) * 2.5e-4 + 1e-9);
        let tiny = (0..600).map(|k| f64::from(k) / 16_777_216.0 / 2.0);
        let middles = (0..=255).map(|k| (f64::from(k) + 0.5) / 255.0);
        let near = steps
            .chain(tiny)
            .chain(middles)
            .flat_map(|x| [-1, 0, 1].map(|step| from_ordinal(ordinal(x as f32) + step)));
        odd.into_iter().chain(near).collect()
    }

    fn devices() -> impl Iterator<Item = Device> {
        DeviceProfile::ALL.iter().flat_map(|profile| {
            let with = |&store: &UnormStore| Device { store, ..profile.device() };
            UnormStore::ALL.iter().map(with).collect::<Vec<_>>()
        })
    }

    /// Every fifth of the samples was not drawn.
    fn ids(samples: &[f32]) -> Vec<u32> {
        (0..samples.len()).map(|i| if i % 5 == 3 { NO_TRIANGLE } else { i as u32 }).collect()
    }

    #[test]
    fn many_depths_are_stored_like_one() {
        let samples = samples();
        let drawn = Drawn { depth: &samples, triangle: &ids(&samples) };
        for device in devices() {
            for &format in DepthFormat::ALL {
                let mut out = Vec::new();
                store(&device, vec![Store::Depths { format, out: &mut out }], drawn);
                for (&z, found) in samples.iter().zip(out) {
                    let one = device.stored_depth(format, z);
                    assert_eq!(found.to_bits(), one.to_bits(), "{format} of {z:e}, {device:?}");
                }
            }
        }
    }

    #[test]
    fn a_reciprocal_decodes_like_a_quotient() {
        for max in [0xff, 0xffff, 0xff_ffff] {
            let (largest, inverse) = (f64::from(max), 1.0 / f64::from(max));
            for code in (0..=max).map(f64::from) {
                assert_eq!((code * inverse) as f32, (code / largest) as f32, "{code} of {max}");
            }
        }
    }

    #[test]
    fn many_texels_are_packed_like_one() {
        let samples = samples();
        let drawn = Drawn { depth: &samples, triangle: &ids(&samples) };
        for device in devices() {
            for &packing in Packing::ALL {
                let mut out = Vec::new();
                let bytes = Store::Bytes { packing, clear: [9; 4], out: &mut out };
                store(&device, vec![bytes], drawn);
                for (i, (&z, found)) in samples.iter().zip(out).enumerate() {
                    let one = stored_bytes(&device, packing.pack(z));
                    let expected = if i % 5 == 3 { [9; 4] } else { one };
                    assert_eq!(found, expected, "{packing} of {z:e}, {device:?}");
                }
            }
        }
    }
}
