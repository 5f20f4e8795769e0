//! The alpha test of a fragment, f32 as a shader makes it: coordinates from perspective-correct varyings,
//! level 0, the material's own filter.

use super::{Setup, Varyings};
use crate::device::Device;
use crate::scene::Surfaces;
use crate::scene::alpha::{AlphaImage, Mask, Tiling};
use glam::Vec2;

/// The holes of one triangle as a pass sees them.
pub(super) struct Cut<'m> {
    mask: &'m Mask,
    varyings: Varyings,
    /// Texture coordinates of the three vertices, transformed there.
    uvs: [Vec2; 3],
}

impl<'m> Cut<'m> {
    /// The holes of a triangle; `None` where it has none.
    pub(super) fn of(
        device: &Device,
        setup: &Setup,
        surfaces: &'m Surfaces,
        (id, corners): (u32, [u32; 3]),
    ) -> Option<Self> {
        let mask = surfaces.mask(id)?;
        let [x, y] = mask.scale_rotate;
        let moved = |uv: Vec2| x * uv.x + y * uv.y + mask.offset;
        let uvs = surfaces.uvs(corners).map(moved);
        Some(Self { mask, varyings: setup.varyings(device), uvs })
    }

    /// Whether the surface is there at a pixel's centre: factor · texture ≥ cutoff, f32.
    pub(super) fn is_there(&self, px: f32, py: f32) -> bool {
        let texture = self.mask.image.as_ref().map_or(1.0, |image| {
            let along = |axis: usize| self.varyings.scalar(self.uvs.map(|uv| uv[axis]), px, py);
            sampled(image, [along(0), along(1)])
        });
        self.mask.factor * texture >= self.mask.cutoff
    }
}

/// The alpha of a texture at coordinates, each operation rounded to f32; 0 where they are no numbers.
fn sampled(image: &AlphaImage, uv: [f32; 2]) -> f32 {
    if !(uv[0].is_finite() && uv[1].is_finite()) {
        return 0.0;
    }
    let at = [0, 1].map(|axis| uv[axis] * image.size[axis] as f32);
    let fetch = |x: i64, y: i64| {
        let x = wrapped(x, image.size[0], image.tiling[0]);
        let y = wrapped(y, image.size[1], image.tiling[1]);
        f32::from(image.alpha[y * image.size[0] as usize + x]) / 255.0
    };
    if !image.linear {
        return fetch(at[0].floor() as i64, at[1].floor() as i64);
    }
    let [x, y] = at.map(|c| c - 0.5);
    let [fx, fy] = [x - x.floor(), y - y.floor()];
    let [x, y] = [x.floor() as i64, y.floor() as i64];
    let mix = |a: f32, b: f32, t: f32| a + (b - a) * t;
    let row = |y: i64| mix(fetch(x, y), fetch(x.saturating_add(1), y), fx);
    mix(row(y), row(y.saturating_add(1)), fy)
}

/// The texel that an index along an axis stands for.
fn wrapped(index: i64, size: u32, tiling: Tiling) -> usize {
    let size = i64::from(size);
    let inside = match tiling {
        Tiling::Clamp => index.clamp(0, size - 1),
        Tiling::Repeat => index.rem_euclid(size),
        Tiling::Mirror => {
            let there = index.rem_euclid(2 * size);
            there.min(2 * size - 1 - there)
        }
    };
    inside as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image(linear: bool, tiling: Tiling) -> AlphaImage {
        AlphaImage { size: [2, 1], alpha: vec![0, 255], tiling: [tiling; 2], linear }
    }

    #[test]
    fn texels_repeat_mirror_and_end() {
        let near = |tiling, u: f32| sampled(&image(false, tiling), [u, 0.5]);
        assert_eq!([0.1, 0.6, 1.1, 1.6].map(|u| near(Tiling::Repeat, u)), [0.0, 1.0, 0.0, 1.0]);
        assert_eq!([0.1, 0.6, 1.1, 1.6].map(|u| near(Tiling::Mirror, u)), [0.0, 1.0, 1.0, 0.0]);
        assert_eq!([-3.0, 0.6, 9.0].map(|u| near(Tiling::Clamp, u)), [0.0, 1.0, 1.0]);
        assert_eq!(near(Tiling::Repeat, f32::NAN), 0.0);
    }

    #[test]
    fn texels_are_mixed_between_their_centres() {
        let mixed = |u: f32| sampled(&image(true, Tiling::Clamp), [u, 0.5]);
        assert_eq!([0.25, 0.5, 0.75, 1.0].map(mixed), [0.0, 0.5, 1.0, 1.0]);
    }
}
