//! The float's own bit pattern as four bytes (PlayCanvas' float-as-uint).

use super::Pair;
use crate::depth::arith::Number;

/// Bytes of floatBitsToUint(z), most significant in R, as k/255; decoded with uint(255·c), which
/// *truncates*: a sampler that returns k/255 one ulp low loses one from the byte.
#[derive(Clone, Copy, Debug)]
pub(super) struct FloatBits;

impl Pair for FloatBits {
    #[inline(always)]
    fn pack<A: Number>(&self, z: A) -> [A; 4] {
        let top = A::whole(255.0);
        let (r, g) = (z.pattern_byte(3), z.pattern_byte(2));
        [r / top, g / top, z.pattern_byte(1) / top, z.pattern_byte(0) / top]
    }
    #[inline(always)]
    fn unpack<A: Number>(&self, c: [A; 4]) -> A {
        let ([r, g, b, a], top) = (c, A::whole(255.0));
        A::from_pattern([r * top, g * top, b * top, a * top])
    }
}

/// The depth in the red channel alone (document 000, Shadow.js).
#[derive(Clone, Copy, Debug)]
pub(super) struct R8;

impl Pair for R8 {
    const CHANNELS: usize = 1;
    #[inline(always)]
    fn pack<A: Number>(&self, z: A) -> [A; 4] {
        [z, A::whole(0.0), A::whole(0.0), A::whole(0.0)]
    }
    #[inline(always)]
    fn unpack<A: Number>(&self, c: [A; 4]) -> A {
        c[0]
    }
}
