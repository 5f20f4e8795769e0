//! The depth test's key of eight fragments at a time.
#![allow(clippy::needless_range_loop, reason = "loops over indices become vectors")]

use crate::depth::{DepthFormat, UnormStore};
use crate::device::Device;
use crate::simd::lanes::BATCH;

/// How fragments' depths become the codes that the depth test compares.
pub(super) trait Test: Copy {
    /// Whether depths are clamped to [0, 1] before they are kept.
    fn clamps(&self) -> bool;

    /// The codes of depths that are kept: what `DepthFormat::encode_with` makes of each.
    fn codes(&self, kept: [f32; BATCH]) -> [u32; BATCH];

    /// The depth of pixels that nothing is drawn into.
    #[inline(always)]
    fn cleared(&self) -> f32 {
        1.0
    }

    /// The depths that are kept.
    #[inline(always)]
    fn kept(&self, mut z: [f32; BATCH]) -> [f32; BATCH] {
        if self.clamps() {
            for k in 0..BATCH {
                z[k] = clamp(z[k]);
            }
        }
        z
    }
}

/// Any format on any device.
#[derive(Clone, Copy, Debug)]
pub(super) struct DepthTest {
    format: DepthFormat,
    store: UnormStore,
    /// Subnormal depths become 0.
    flush: bool,
    /// Depths are clamped to [0, 1] before they are kept.
    clamp: bool,
}

/// A float format of 32 bits: the code is the bit pattern.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlainTest {
    clamp: bool,
}

impl DepthTest {
    pub(super) fn new(device: &Device, format: DepthFormat) -> Self {
        let (format, flush) = (device.depth_format(format), device.flush_denormals);
        Self { format, store: device.store, flush, clamp: device.clamp_frag_z }
    }

    /// This test without a rounding, if it has none.
    pub(super) fn plain(self) -> Option<PlainTest> {
        let plain = self.format == DepthFormat::F32 && !self.flush;
        plain.then_some(PlainTest { clamp: self.clamp })
    }

    /// The codes of depths in [0, 1].
    #[inline(never)]
    fn rounded(&self, mut z: [f32; BATCH]) -> [u32; BATCH] {
        let least = if self.flush { f32::MIN_POSITIVE } else { 0.0 };
        z.iter_mut().for_each(|z| *z = if *z >= least { *z } else { 0.0 });
        match self.format.unorm_max() {
            Some(max) => unorm(self.store, z, max),
            None => each(z, |z| self.format.encode(z)),
        }
    }
}

impl Test for DepthTest {
    #[inline(always)]
    fn clamps(&self) -> bool {
        self.clamp
    }

    #[inline(always)]
    fn codes(&self, z: [f32; BATCH]) -> [u32; BATCH] {
        self.rounded(saturated(z))
    }
}

impl Test for PlainTest {
    #[inline(always)]
    fn clamps(&self) -> bool {
        self.clamp
    }

    #[inline(always)]
    fn codes(&self, z: [f32; BATCH]) -> [u32; BATCH] {
        // Clamped depths are at most 1 already.
        let z = if self.clamp { positive(z) } else { saturated(z) };
        let mut codes = [0; BATCH];
        for k in 0..BATCH {
            codes[k] = z[k].to_bits();
        }
        codes
    }
}

/// A test that keeps the greater depth.
#[derive(Clone, Copy, Debug)]
pub(super) struct Turned<T>(pub(super) T);

impl<T: Test> Test for Turned<T> {
    #[inline(always)]
    fn clamps(&self) -> bool {
        self.0.clamps()
    }

    #[inline(always)]
    fn cleared(&self) -> f32 {
        0.0
    }

    #[inline(always)]
    fn codes(&self, z: [f32; BATCH]) -> [u32; BATCH] {
        let mut codes = self.0.codes(z);
        for k in 0..BATCH {
            codes[k] = !codes[k];
        }
        codes
    }
}

/// Depths within [0, 1] and without a sign: NaN and what lies below 0 become 0.
#[inline(always)]
fn saturated(z: [f32; BATCH]) -> [f32; BATCH] {
    let mut z = positive(z);
    for k in 0..BATCH {
        z[k] = if z[k] < 1.0 { z[k] } else { 1.0 };
    }
    z
}

/// NaN, −0 and what lies below 0 become 0.
#[inline(always)]
fn positive(mut z: [f32; BATCH]) -> [f32; BATCH] {
    for k in 0..BATCH {
        z[k] = if z[k] > 0.0 { z[k] } else { 0.0 };
    }
    z
}

#[inline(always)]
fn each(z: [f32; BATCH], code: impl Fn(f32) -> u32) -> [u32; BATCH] {
    let mut codes = [0; BATCH];
    for k in 0..BATCH {
        codes[k] = code(z[k]);
    }
    codes
}

/// [`f32::clamp`] to [0, 1], which keeps NaN and −0.
#[inline(always)]
fn clamp(z: f32) -> f32 {
    let z = if z < 0.0 { 0.0 } else { z };
    if z > 1.0 { 1.0 } else { z }
}

/// [`UnormStore::code`] of depths in [0, 1] without a branch.
#[inline(always)]
fn unorm(store: UnormStore, z: [f32; BATCH], max: u32) -> [u32; BATCH] {
    let (wide, narrow) = (f64::from(max), max as f32);
    match store {
        UnormStore::Exact => each(z, |z| nearest(f64::from(z) * wide).min(max)),
        UnormStore::HalfEven => each(z, |z| nearest(f64::from(z * narrow)).min(max)),
        UnormStore::HalfUp => each(z, |z| ((z * narrow + 0.5) as u32).min(max)),
        UnormStore::Truncate => each(z, |z| ((z * narrow) as u32).min(max)),
    }
}

/// The nearest integer, ties to even, of 0 ≤ x < 2³²; 2³² − 1 of 2³². The sum with 2⁵² has a last
/// place of 1.
#[inline(always)]
fn nearest(x: f64) -> u32 {
    let x = if x < 4_294_967_295.0 { x } else { 4_294_967_295.0 };
    (x + (1u64 << 52) as f64).to_bits() as u32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::device::DeviceProfile;
    use crate::num::from_ordinal;
    use std::array::from_fn;

    #[test]
    fn eight_codes_are_those_of_one() {
        let odd = [f32::NAN, -0.0, -1.0, 2.0, f32::INFINITY, f32::MIN_POSITIVE, 1e-40, 1.0];
        let near = (0..=255).flat_map(|k| {
            let middle = ((f64::from(k) + 0.5) / 255.0) as f32;
            [-1i32, 0, 1].map(|step| from_ordinal(crate::num::ordinal(middle) + step))
        });
        let depths: Vec<f32> = odd.into_iter().chain(near).chain([0.5; BATCH]).collect();
        for (&profile, &format) in
            DeviceProfile::ALL.iter().flat_map(|p| DepthFormat::ALL.iter().map(move |f| (p, f)))
        {
            for &store in UnormStore::ALL {
                let device = Device { store, ..profile.device() };
                let test = DepthTest::new(&device, format);
                for depths in depths.windows(BATCH) {
                    let depths: [f32; BATCH] = from_fn(|k| depths[k]);
                    let one =
                        |z: f32| device.depth_format(format).encode_with(store, device.flush(z));
                    assert_eq!(
                        test.codes(depths),
                        depths.map(one),
                        "{profile} {format} {depths:?}"
                    );
                    if let Some(plain) = test.plain() {
                        let codes = plain.codes(plain.kept(depths));
                        assert_eq!(codes, depths.map(one), "{profile} {depths:?}");
                    }
                    let kept = depths.map(|z| if test.clamp { z.clamp(0.0, 1.0) } else { z });
                    assert_eq!(test.kept(depths).map(f32::to_bits), kept.map(f32::to_bits));
                }
            }
        }
    }
}
