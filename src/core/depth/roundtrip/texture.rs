//! The texture unit as numbers: a channel becomes a byte, a byte becomes a sample.

use super::super::arith::Raw;
use super::super::store::{ByteRounding, UnormLoad};

/// The texture unit as numbers. Bytes round to even or are ⌊255x + half⌋; the sampler returns
/// fl(k·scale) + fl(k·rest) where it is `linear`, else a table.
///
/// f32(k/255) has the linear form too: with scale = 1/255 to 16 bits, k·scale is exact (8 + 16 = 24
/// bits), and the sum is wrong by less than 2⁻⁴⁰ before its one rounding, fused or not; a test
/// compares all 256.
#[derive(Clone, Debug)]
pub(super) struct Texture<F> {
    pub(super) even: bool,
    pub(super) half: F,
    pub(super) linear: bool,
    pub(super) scale: F,
    pub(super) rest: F,
    table: [F; 256],
}

/// (scale, rest) of the sampler rules that have that form.
fn scale_and_rest<F: Raw>(load: UnormLoad) -> (F, F) {
    let exact = 1.0 / 255.0;
    let high = match load {
        UnormLoad::Reciprocal => f64::from(exact as f32),
        UnormLoad::Divide | UnormLoad::Half => {
            f64::from(f32::from_bits((exact as f32).to_bits() & !0xff))
        }
    };
    let rest = if load == UnormLoad::Reciprocal { 0.0 } else { (1.0 - 255.0 * high) / 255.0 };
    (F::from_real(high), F::from_real(rest))
}

impl<F: Raw> Texture<F> {
    pub(super) fn new(rounding: ByteRounding, load: UnormLoad, real: bool) -> Self {
        let (scale, rest) = scale_and_rest(load);
        let value = |k: usize| match load {
            UnormLoad::Divide => F::from_real(k as f64 / 255.0),
            UnormLoad::Reciprocal | UnormLoad::Half => F::from_depth(load.value(k as u32, 255)),
        };
        let half = if let ByteRounding::Floor { half } = rounding { half } else { 0.0 };
        Self {
            even: rounding == ByteRounding::Even,
            half: F::from_real(half),
            linear: load == UnormLoad::Divide || (load == UnormLoad::Reciprocal && !real),
            scale,
            rest,
            table: std::array::from_fn(value),
        }
    }

    #[inline(always)]
    pub(super) fn stored(&self, x: F) -> F {
        if self.even { x.byte_even() } else { x.byte_floor(self.half) }
    }

    pub(super) fn sampled(&self, byte: F) -> F {
        self.table[usize::from(byte.byte())]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_products_give_every_sampled_byte() {
        for load in [UnormLoad::Divide, UnormLoad::Reciprocal] {
            let (scale, rest) = scale_and_rest::<f32>(load);
            for (k, fused) in (0..=255u32).flat_map(|k| [(k, false), (k, true)]) {
                let value = (k as f32).product_sum(scale, rest, fused);
                assert_eq!(value, load.value(k, 255), "byte {k}, {load}, fused {fused}");
            }
        }
    }
}
