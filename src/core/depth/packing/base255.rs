//! Base-255 packings in `fract` form: k/255 is what UNORM8 holds, so the digits survive a store that
//! rounds; a store that truncates loses a step wherever f32 falls short of k/255.

use super::Pair;
use crate::depth::arith::{Number, dot, ratios};

const SCALES: [f64; 4] = [1.0, 255.0, 65_025.0, 16_581_375.0];
/// The last scale as it was copied for years, one zero too many.
const TYPO_SCALES: [f64; 4] = [1.0, 255.0, 65_025.0, 160_581_375.0];

#[inline(always)]
fn digits<A: Number>(z: A, [r, g, b, a]: [f64; 4]) -> [A; 4] {
    [digit(z, r), digit(z, g), digit(z, b), digit(z, a)]
}

#[inline(always)]
fn digit<A: Number>(z: A, scale: f64) -> A {
    (z * A::whole(scale)).fract()
}

#[inline(always)]
fn weights<A: Number>(scales: [f64; 4]) -> [A; 4] {
    ratios(1.0, scales)
}

/// Each channel less a 255th of the next; the last one keeps everything below it.
#[inline(always)]
fn masked<A: Number>(c: [A; 4]) -> [A; 4] {
    let q = A::ratio(1.0, 255.0);
    [c[0].minus_product(c[1], q), c[1].minus_product(c[2], q), c[2].minus_product(c[3], q), c[3]]
}

/// Aras Pranckevičius, June 2007: unmasked digits plus half a step, made for stores that truncate.
#[derive(Clone, Copy, Debug)]
pub(super) struct HalfStep;

impl Pair for HalfStep {
    #[inline(always)]
    fn pack<A: Number>(&self, z: A) -> [A; 4] {
        let (half, [r, g, b, a]) = (A::ratio(0.5, 255.0), digits(z, SCALES));
        [r + half, g + half, b + half, a + half]
    }
    #[inline(always)]
    fn unpack<A: Number>(&self, c: [A; 4]) -> A {
        dot(c, weights(SCALES))
    }
}

/// Aras Pranckevičius, July 2009, and Cesium: R most significant, masks (1/255, 1/255, 1/255, 0).
/// With `TYPO` the scale 160581375 (PlayCanvas particles, Cocos Creator, Cesium before #4615).
#[derive(Clone, Copy, Debug)]
pub(super) struct HighFirst<const TYPO: bool>;

impl<const TYPO: bool> HighFirst<TYPO> {
    const SCALES: [f64; 4] = if TYPO { TYPO_SCALES } else { SCALES };
}

impl<const TYPO: bool> Pair for HighFirst<TYPO> {
    #[inline(always)]
    fn pack<A: Number>(&self, z: A) -> [A; 4] {
        masked(digits(z, Self::SCALES))
    }
    #[inline(always)]
    fn unpack<A: Number>(&self, c: [A; 4]) -> A {
        dot(c, weights(Self::SCALES))
    }
}

/// Unity's EncodeFloatRGBA: as Aras 2009, but the last channel is masked with itself too.
#[derive(Clone, Copy, Debug)]
pub(super) struct UnityRgba;

impl Pair for UnityRgba {
    #[inline(always)]
    fn pack<A: Number>(&self, z: A) -> [A; 4] {
        let [r, g, b, a] = masked(digits(z, SCALES));
        [r, g, b, a.minus_product(a, A::ratio(1.0, 255.0))]
    }
    #[inline(always)]
    fn unpack<A: Number>(&self, c: [A; 4]) -> A {
        dot(c, weights(SCALES))
    }
}

/// Babylon, Godot 3, mapbox-gl since #12005: lo-first, A most significant, sum from the smallest.
#[derive(Clone, Copy, Debug)]
pub(super) struct LowFirst;

impl Pair for LowFirst {
    #[inline(always)]
    fn pack<A: Number>(&self, z: A) -> [A; 4] {
        let [r, g, b, a] = masked(digits(z, SCALES));
        [a, b, g, r]
    }
    #[inline(always)]
    fn unpack<A: Number>(&self, c: [A; 4]) -> A {
        let [r, g, b, a] = weights(SCALES);
        dot(c, [a, b, g, r])
    }
}

/// ForgE: a hi-first base-255 pack with the typo, unpacked lo-first in base 256.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mismatched;

impl Pair for Mismatched {
    #[inline(always)]
    fn pack<A: Number>(&self, z: A) -> [A; 4] {
        let [_, g, b, a] = digits(z, TYPO_SCALES);
        masked([z, g, b, a])
    }
    #[inline(always)]
    fn unpack<A: Number>(&self, c: [A; 4]) -> A {
        dot(c, ratios(1.0, [16_777_216.0, 65_536.0, 256.0, 1.0]))
    }
}

/// Two channels: Unity's EncodeFloatRG masks the first alone, PlayCanvas' VSM8 (`BOTH`) masks the
/// second with itself too and decodes g·(1/255) + r.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rg<const BOTH: bool>;

impl<const BOTH: bool> Pair for Rg<BOTH> {
    const CHANNELS: usize = 2;
    #[inline(always)]
    fn pack<A: Number>(&self, z: A) -> [A; 4] {
        let q = A::ratio(1.0, 255.0);
        let (r, g) = (z.fract(), (z * A::whole(255.0)).fract());
        let second = if BOTH { g.minus_product(g, q) } else { g };
        [r.minus_product(g, q), second, A::whole(0.0), A::whole(0.0)]
    }
    #[inline(always)]
    fn unpack<A: Number>(&self, [r, g, ..]: [A; 4]) -> A {
        let q = A::ratio(1.0, 255.0);
        if BOTH { (g * q) + r } else { dot([r, g], [A::whole(1.0), q]) }
    }
}

/// PlayCanvas' packFloat32ToRGBA8 (written for JavaScript's doubles: its own row is `real`):
/// base-255 digits, each byte floor(256·digit), ends z ≤ 0 → 0 and z ≥ 1 → (255, 0, 0, 0).
#[derive(Clone, Copy, Debug)]
pub(super) struct PlayCanvasCpu;

impl Pair for PlayCanvasCpu {
    #[inline(always)]
    fn pack<A: Number>(&self, z: A) -> [A; 4] {
        let (zero, top) = (A::whole(0.0), A::whole(255.0));
        let z = z.at_least(zero, z, zero);
        let c = digits(z, SCALES);
        let c = [c[0] - c[1] / top, c[1] - c[2] / top, c[2] - c[3] / top, c[3]];
        let ends = [A::whole(1.0), zero, zero, zero];
        let mut packed = c;
        for i in 0..4 {
            let byte = (c[i] * A::whole(256.0)).floor();
            packed[i] = byte.at_least(top, top, byte) / top;
            packed[i] = z.at_least(A::whole(1.0), ends[i], packed[i]);
        }
        packed
    }
    #[inline(always)]
    fn unpack<A: Number>(&self, c: [A; 4]) -> A {
        dot(c, weights(SCALES))
    }
}
