//! Base-256 packings in `fract` form: the documents' two and their many copies.
//!
//! Scalings by powers of two are exact, so each digit is exact but for the one subtraction that
//! removes the next digit. What fails is the store: a channel holds k/256, UNORM8 keeps n/255.

use super::Pair;
use crate::depth::arith::{Number, dot, ratios};

const SCALES: [f64; 4] = [1.0, 256.0, 65_536.0, 16_777_216.0];

#[inline(always)]
fn digits<A: Number>(z: A) -> [A; 4] {
    let [r, g, b, a] = SCALES;
    [digit(z, r), digit(z, g), digit(z, b), digit(z, a)]
}

#[inline(always)]
fn digit<A: Number>(z: A, scale: f64) -> A {
    (z * A::whole(scale)).fract()
}

#[inline(always)]
fn weights<A: Number>() -> [A; 4] {
    ratios(1.0, SCALES)
}

#[inline(always)]
fn reversed<T: Copy>([r, g, b, a]: [T; 4]) -> [T; 4] {
    [a, b, g, r]
}

/// Documents 000 and 004: fract(z·(1, 256, 256², 256³)) less a 256th of the next digit; the most
/// significant digit in R.
#[derive(Clone, Copy, Debug)]
pub(super) struct HighFirst;

impl Pair for HighFirst {
    #[inline(always)]
    fn pack<A: Number>(&self, z: A) -> [A; 4] {
        let (c, q) = (digits(z), A::ratio(1.0, 256.0));
        [
            c[0].minus_product(c[1], q),
            c[1].minus_product(c[2], q),
            c[2].minus_product(c[3], q),
            c[3],
        ]
    }
    #[inline(always)]
    fn unpack<A: Number>(&self, c: [A; 4]) -> A {
        dot(c, weights())
    }
}

/// Document 001 (its vec3·vec4 mended to `xxyz`), ozone3d 2008, Godot 2, mapbox-gl before #12005:
/// the same digits with A most significant, so that the dot product starts with the smallest term.
#[derive(Clone, Copy, Debug)]
pub(super) struct LowFirst;

impl Pair for LowFirst {
    #[inline(always)]
    fn pack<A: Number>(&self, z: A) -> [A; 4] {
        reversed(HighFirst.pack(z))
    }
    #[inline(always)]
    fn unpack<A: Number>(&self, c: [A; 4]) -> A {
        dot(c, reversed(weights()))
    }
}

/// Aras Pranckevičius, March 2007: the digits unmasked, so that every channel still holds all the
/// digits after it and rounding one channel is not undone by the next.
#[derive(Clone, Copy, Debug)]
pub(super) struct Unmasked;

impl Pair for Unmasked {
    #[inline(always)]
    fn pack<A: Number>(&self, z: A) -> [A; 4] {
        digits(z)
    }
    #[inline(always)]
    fn unpack<A: Number>(&self, c: [A; 4]) -> A {
        dot(c, weights())
    }
}
