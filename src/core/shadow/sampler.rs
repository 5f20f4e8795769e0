//! Texture coordinates → texels and weights, in the sampler's own precision.

use crate::scene::Wrap;

/// The texel index along one axis that NEAREST picks at coordinate `c` of a texture of `size`.
///
/// `fixed16` truncates the coordinate to 16-bit fixed point first, as the measured device does for
/// colour textures; otherwise the f32 product c·size is truncated.
#[must_use]
#[inline]
pub fn nearest_texel(c: f32, size: u32, wrap: Wrap, fixed16: bool) -> u32 {
    let last = i64::from(size) - 1;
    if fixed16 {
        let fixed = match wrap {
            Wrap::Clamp => ((c * 65_536.0) as i64).clamp(0, 65_535),
            Wrap::Repeat => (c * 65_536.0) as i64 & 0xffff,
        };
        return ((fixed * i64::from(size)) >> 16) as u32;
    }
    let index = match wrap {
        Wrap::Clamp => (c * size as f32) as i64,
        Wrap::Repeat => ((c - c.floor()) * size as f32) as i64,
    };
    index.clamp(0, last) as u32
}

/// Between which two texel centres along one axis coordinate `c` lies: the index of the first, before
/// `wrap` brings it into the texture, and the share of the way to the second.
#[must_use]
#[inline]
pub fn between_centres(c: f32, size: u32, wrap: Wrap) -> (i64, f32) {
    let wrapped = match wrap {
        Wrap::Clamp => c,
        Wrap::Repeat => c - c.floor(),
    };
    let position = wrapped * size as f32 - 0.5;
    let base = position.floor();
    // Far outside the map the cast saturates.
    (base as i64, position - base)
}

/// The texel along one axis that an index beyond the texture stands for.
#[must_use]
#[inline]
pub fn wrapped_texel(index: i64, size: u32, wrap: Wrap) -> u32 {
    match wrap {
        Wrap::Clamp => index.clamp(0, i64::from(size) - 1) as u32,
        Wrap::Repeat => index.rem_euclid(i64::from(size)) as u32,
    }
}

/// The two texels along one axis that LINEAR mixes, and the weight of the second.
#[must_use]
#[inline]
pub fn linear_axis(c: f32, size: u32, wrap: Wrap) -> ([u32; 2], f32) {
    let (first, fraction) = between_centres(c, size, wrap);
    let texel = |i: i64| wrapped_texel(i, size, wrap);
    ([texel(first), texel(first.saturating_add(1))], fraction)
}

/// LINEAR of one channel: x before y, a + (b − a)·t with each operation rounded to f32.
#[must_use]
pub fn linear(fetch: impl Fn(u32, u32) -> f32, size: [u32; 2], wrap: Wrap, uv: [f32; 2]) -> f32 {
    let ([x0, x1], fx) = linear_axis(uv[0], size[0], wrap);
    let ([y0, y1], fy) = linear_axis(uv[1], size[1], wrap);
    let mix = |a: f32, b: f32, t: f32| a + (b - a) * t;
    let low = mix(fetch(x0, y0), fetch(x1, y0), fx);
    let high = mix(fetch(x0, y1), fetch(x1, y1), fx);
    mix(low, high, fy)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn borders_stay_inside() {
        for fixed in [false, true] {
            for c in [-1.0, -1e-9, 0.0, 0.999_999_94, 1.0, 7.5] {
                assert!(nearest_texel(c, 5, Wrap::Clamp, fixed) < 5, "{c}");
                assert!(nearest_texel(c, 5, Wrap::Repeat, fixed) < 5, "{c}");
            }
        }
        assert_eq!(nearest_texel(1.0, 4, Wrap::Clamp, true), 3, "clamped");
        assert_eq!(nearest_texel(1.0, 4, Wrap::Repeat, true), 0, "repeated");
    }

    #[test]
    fn linear_at_a_texel_centre_is_that_texel() {
        let texture = |x: u32, y: u32| (10 * y + x) as f32;
        let uv = [2.5 / 8.0, 5.5 / 8.0];
        assert_eq!(linear(texture, [8, 8], Wrap::Clamp, uv), 52.0);
    }
}
