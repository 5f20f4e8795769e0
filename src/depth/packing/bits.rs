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
        let byte = |i| z.pattern_byte(i) / A::whole(255.0);
        [byte(3), byte(2), byte(1), byte(0)]
    }
    #[inline(always)]
    fn unpack<A: Number>(&self, c: [A; 4]) -> A {
        A::from_pattern(c.map(|channel| channel * A::whole(255.0)))
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
