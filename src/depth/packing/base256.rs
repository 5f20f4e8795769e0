//! Base-256 packings in `fract` form: the documents' two.

use super::fract;

/// Documents 000 and 004: fract(z·(1, 256, 256², 256³)) less a 256th of the next digit; the most
/// significant digit in R. Scalings by powers of two are exact, so each digit is exact but for the
/// final subtraction, which rounds once.
pub(super) fn pack_book(z: f32) -> [f32; 4] {
    let c = [1.0, 256.0, 65_536.0, 16_777_216.0].map(|scale| fract(z * scale));
    [c[0] - c[1] / 256.0, c[1] - c[2] / 256.0, c[2] - c[3] / 256.0, c[3]]
}

/// dot(c, (1, 1/256, 1/256², 1/256³)), summed left to right.
pub(super) fn unpack_book(c: [f32; 4]) -> f32 {
    ((c[0] + c[1] / 256.0) + c[2] / 65_536.0) + c[3] / 16_777_216.0
}

/// Document 001 (its vec3·vec4 corrected to `xxyz`): the same digits with A most significant.
pub(super) fn pack_upc(z: f32) -> [f32; 4] {
    let [r, g, b, a] = pack_book(z);
    [a, b, g, r]
}

/// dot(c, (1/256³, 1/256², 1/256, 1)), summed left to right.
pub(super) fn unpack_upc(c: [f32; 4]) -> f32 {
    ((c[0] / 16_777_216.0 + c[1] / 65_536.0) + c[2] / 256.0) + c[3]
}
