//! Integer digits, the safe reference: bytes that are integers before they are stored, rounded to
//! integers again when they are read, so neither the store's rounding nor the sampler's matters.

use super::Pair;
use crate::depth::arith::Number;

/// K = round(z·(256ᴺ − 1)), its N base-256 digits as k/255; decoded from round(255·c).
///
/// In f32 arithmetic 2³² − 1 rounds to 2³², and every digit is exact: K has at most 24 significant
/// bits. z ≥ 1 packs to ones. maplibre-native #4559 moved to this form.
#[derive(Clone, Copy, Debug)]
pub(super) struct Digits<const N: usize>;

impl<const N: usize> Digits<N> {
    const MAX: f64 = [0.0, 255.0, 65_535.0, 16_777_215.0, 4_294_967_295.0][N];
}

impl<const N: usize> Pair for Digits<N> {
    const CHANNELS: usize = N;
    #[inline(always)]
    fn pack<A: Number>(&self, z: A) -> [A; 4] {
        let (zero, one, top) = (A::whole(0.0), A::whole(1.0), A::whole(255.0));
        let z = z.at_least(zero, z, zero);
        let mut packed = [zero; 4];
        let mut rest = z.nearest_product(A::whole(Self::MAX));
        for (i, channel) in packed.iter_mut().enumerate().take(N) {
            let place = A::whole([1.0, 256.0, 65_536.0, 16_777_216.0][N - 1 - i]);
            let digit = (rest / place).floor();
            rest = rest - digit * place;
            *channel = z.at_least(one, one, digit / top);
        }
        packed
    }
    #[inline(always)]
    fn unpack<A: Number>(&self, c: [A; 4]) -> A {
        let (top, base) = (A::whole(255.0), A::whole(256.0));
        let mut code = (c[0] * top).nearest();
        for &channel in &c[1..N] {
            code = code * base + (channel * top).nearest();
        }
        code / A::whole(Self::MAX)
    }
}
