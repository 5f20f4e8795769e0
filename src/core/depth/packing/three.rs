//! three.js' packings, r68 to today, in their own order of operations.

use super::Pair;
use crate::depth::arith::{Number, dot, ratios};

/// r68…r85 and PlayCanvas' WebGL1 `packFloat` (until #6998): mod(z·256ⁱ·255, 256)/255, lo-first.
#[derive(Clone, Copy, Debug)]
pub(super) struct R68;

impl Pair for R68 {
    #[inline(always)]
    fn pack<A: Number>(&self, z: A) -> [A; 4] {
        let (q, base, top) = (A::ratio(1.0, 256.0), A::whole(256.0), A::whole(255.0));
        let mut c = [z; 4];
        for (c, scale) in c.iter_mut().zip([16_777_216.0, 65_536.0, 256.0, 1.0]) {
            let x = z * A::whole(scale) * top;
            *c = (x - base * (x / base).floor()) / top;
        }
        [
            c[0],
            c[1].minus_product(c[0], q),
            c[2].minus_product(c[1], q),
            c[3].minus_product(c[2], q),
        ]
    }
    #[inline(always)]
    fn unpack<A: Number>(&self, c: [A; 4]) -> A {
        dot(c, ratios(1.0, [16_777_216.0, 65_536.0, 256.0, 1.0]))
    }
}

/// r86…r166 and luma.gl: digits stretched by 256/255 so that k/256 becomes k/255; lo-first. The most
/// significant channel is the depth itself, not its fraction, and saturates at 255/256.
#[derive(Clone, Copy, Debug)]
pub(super) struct R86;

impl Pair for R86 {
    #[inline(always)]
    fn pack<A: Number>(&self, z: A) -> [A; 4] {
        let (q, up) = (A::ratio(1.0, 256.0), A::ratio(256.0, 255.0));
        let x = (z * A::whole(16_777_216.0)).fract();
        let y = (z * A::whole(65_536.0)).fract();
        let w = (z * A::whole(256.0)).fract();
        let (g, b, a) = (y.minus_product(x, q), w.minus_product(y, q), z.minus_product(w, q));
        [x * up, g * up, b * up, a * up]
    }
    #[inline(always)]
    fn unpack<A: Number>(&self, c: [A; 4]) -> A {
        let down = A::ratio(255.0, 256.0);
        let (r, g) = (down / A::whole(16_777_216.0), down / A::whole(65_536.0));
        dot(c, [r, g, down / A::whole(256.0), down / A::whole(1.0)])
    }
}

/// r167 and later (#28789), `CHANNELS` = 4, 3 or 2: integer digits by floor, the last channel keeps
/// the remainder; z ≤ 0 packs to zeros, z ≥ 1 to ones. Hi-first.
///
/// The leading digit enters as k·(1/255), as measured; the source divides. Both store k.
#[derive(Clone, Copy, Debug)]
pub(super) struct R167<const CHANNELS: usize>;

impl<const CHANNELS: usize> R167<CHANNELS> {
    /// 256^(channels − 1): the scale of the last channel.
    const LAST: f64 = [1.0, 256.0, 65_536.0, 16_777_216.0][CHANNELS - 1];
}

impl<const CHANNELS: usize> Pair for R167<CHANNELS> {
    const CHANNELS: usize = CHANNELS;
    #[inline(always)]
    fn pack<A: Number>(&self, z: A) -> [A; 4] {
        let (zero, one) = (A::whole(0.0), A::whole(1.0));
        let (q, up) = (A::ratio(1.0, 256.0), A::ratio(256.0, 255.0));
        let z = z.at_least(zero, z, zero);
        let mut packed = [zero; 4];
        let scaled = z * A::whole(Self::LAST);
        let mut whole = scaled.floor();
        packed[CHANNELS - 1] = scaled - whole;
        for i in (1..CHANNELS - 1).rev() {
            let shifted = whole * q;
            whole = shifted.floor();
            packed[i] = (shifted - whole) * up;
        }
        packed[0] = whole * A::ratio(1.0, 255.0);
        for channel in packed.iter_mut().take(CHANNELS) {
            *channel = z.at_least(one, one, *channel);
        }
        packed
    }
    #[inline(always)]
    fn unpack<A: Number>(&self, c: [A; 4]) -> A {
        let down = A::ratio(255.0, 256.0);
        let weight = |i: usize| {
            let scale = A::whole([1.0, 256.0, 65_536.0, 16_777_216.0][i]);
            if i == CHANNELS - 1 { A::whole(1.0) / scale } else { down / scale }
        };
        let mut sum = c[0] * weight(0);
        for (i, &channel) in c.iter().enumerate().take(CHANNELS).skip(1) {
            sum = sum.plus_product(channel, weight(i));
        }
        sum
    }
}

/// pack2HalfToRGBA: (x − fract(255x)/255, fract(255x)), one of its two halves.
#[derive(Clone, Copy, Debug)]
pub(super) struct Half;

impl Pair for Half {
    const CHANNELS: usize = 2;
    #[inline(always)]
    fn pack<A: Number>(&self, z: A) -> [A; 4] {
        let top = A::whole(255.0);
        let g = (z * top).fract();
        [z - g / top, g, A::whole(0.0), A::whole(0.0)]
    }
    #[inline(always)]
    fn unpack<A: Number>(&self, [r, g, ..]: [A; 4]) -> A {
        r + g / A::whole(255.0)
    }
}
