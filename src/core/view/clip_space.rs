//! The conventions of a clip space: range and direction of depth, direction of y.

use super::Projection;
use glam::DVec3;

crate::catalogue! {
    /// Which z/w a projection gives to near and far plane.
    pub enum ClipRange {
        /// OpenGL: −w ≤ z ≤ w; window depth is z/w/2 + 1/2.
        MinusOneToOne = "-1..1",
        /// Direct3D, Vulkan, Metal, WebGPU: 0 ≤ z ≤ w; window depth is z/w.
        ZeroToOne = "0..1",
    }
}

impl ClipRange {
    /// Factor of z/w in window depth; 1 − it is added.
    #[must_use]
    #[inline(always)]
    pub const fn scale(self) -> f32 {
        match self {
            Self::MinusOneToOne => 0.5,
            Self::ZeroToOne => 1.0,
        }
    }
}

impl Default for ClipRange {
    /// OpenGL's.
    fn default() -> Self {
        Self::MinusOneToOne
    }
}

/// How a projection writes depth and y.
///
/// Window depth is always in [0, 1]: 0 at near and 1 at far, or the other way round where it is reversed.
/// *Compared* depth grows away from the light in either case: it is window depth, or its negative where
/// depth is reversed, so that every rule, margin and breakpoint reads the same. Negation is exact.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ClipSpace {
    /// Range of z/w.
    pub range: ClipRange,
    /// Whether near has the largest depth; the depth test keeps the greater one and maps clear to 0.
    pub reversed: bool,
    /// Whether y looks down, so that the lowest row of a map is the highest of its view. Faces turn with
    /// it; culling still goes by the side that is seen.
    pub y_down: bool,
}

/// How far beyond the near plane a ray reaches that no far plane ends, in near distances.
const ENDLESS: f64 = (1u64 << 20) as f64;

impl ClipSpace {
    /// OpenGL's and WebGL's.
    pub const OPENGL: Self =
        Self { range: ClipRange::MinusOneToOne, reversed: false, y_down: false };

    /// a and b of clip z = a·z + b for a view-space z.
    pub(super) fn depth_row(self, projection: &Projection) -> [f64; 2] {
        let (near, far) = projection.near_far();
        let perspective = matches!(projection, Projection::Perspective { .. });
        match (self.range, self.reversed, perspective) {
            (ClipRange::MinusOneToOne, false, true) if far.is_infinite() => [-1.0, -2.0 * near],
            (ClipRange::MinusOneToOne, true, true) if far.is_infinite() => [1.0, 2.0 * near],
            (ClipRange::ZeroToOne, false, true) if far.is_infinite() => [-1.0, -near],
            (ClipRange::ZeroToOne, true, true) if far.is_infinite() => [0.0, near],
            (ClipRange::MinusOneToOne, false, true) => {
                [(far + near) / (near - far), 2.0 * far * near / (near - far)]
            }
            (ClipRange::MinusOneToOne, true, true) => {
                [(far + near) / (far - near), 2.0 * far * near / (far - near)]
            }
            (ClipRange::ZeroToOne, false, true) => [far / (near - far), far * near / (near - far)],
            (ClipRange::ZeroToOne, true, true) => [near / (far - near), far * near / (far - near)],
            (ClipRange::MinusOneToOne, false, false) => {
                [2.0 / (near - far), (far + near) / (near - far)]
            }
            (ClipRange::MinusOneToOne, true, false) => {
                [2.0 / (far - near), (far + near) / (far - near)]
            }
            (ClipRange::ZeroToOne, false, false) => [1.0 / (near - far), near / (near - far)],
            (ClipRange::ZeroToOne, true, false) => [1.0 / (far - near), far / (far - near)],
        }
    }

    /// z/w of the near plane, and of the far plane or of a point far beyond where there is none.
    #[must_use]
    pub fn ends(self, projection: &Projection) -> [f64; 2] {
        let (near, far) = projection.near_far();
        let [first, last] = match self.range {
            ClipRange::MinusOneToOne => [-1.0, 1.0],
            ClipRange::ZeroToOne => [0.0, 1.0],
        };
        let [near_end, far_end] = if self.reversed { [last, first] } else { [first, last] };
        if far.is_finite() {
            return [near_end, far_end];
        }
        let [slope, constant] = self.depth_row(projection);
        let distance = near * ENDLESS;
        [near_end, (constant - slope * distance) / distance]
    }

    /// Map coordinates and compared depth of a point in normalised device coordinates, f64.
    #[must_use]
    pub fn look(self, ndc: DVec3) -> DVec3 {
        let halved = ndc * 0.5 + 0.5;
        let depth = match self.range {
            ClipRange::MinusOneToOne => halved.z,
            ClipRange::ZeroToOne => ndc.z,
        };
        DVec3::new(halved.x, halved.y, if self.reversed { -depth } else { depth })
    }

    /// The compared depths of near and far plane.
    #[must_use]
    pub const fn depths(self) -> [f64; 2] {
        if self.reversed { [-1.0, 0.0] } else { [0.0, 1.0] }
    }

    /// Change of compared depth per change of z/w, in units of a map coordinate's change per change of
    /// x/w.
    #[must_use]
    pub const fn steepness(self) -> f64 {
        let sign = if self.reversed { -1.0 } else { 1.0 };
        match self.range {
            ClipRange::MinusOneToOne => sign,
            ClipRange::ZeroToOne => 2.0 * sign,
        }
    }

    /// Compared depth of a window depth, and the other way round: exact.
    #[must_use]
    #[inline(always)]
    pub const fn compared(self, depth: f32) -> f32 {
        if self.reversed { -depth } else { depth }
    }

    /// The window depth of a texel that nothing is drawn into.
    #[must_use]
    pub const fn cleared(self) -> f32 {
        if self.reversed { 0.0 } else { 1.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec4;

    fn spaces() -> impl Iterator<Item = ClipSpace> {
        (0..8).map(|k| ClipSpace {
            range: if k & 1 == 0 { ClipRange::MinusOneToOne } else { ClipRange::ZeroToOne },
            reversed: k & 2 != 0,
            y_down: k & 4 != 0,
        })
    }

    /// Window depth at a distance by the closed form: near 0, far 1; 1 − that where reversed.
    fn expected(projection: &Projection, clip: ClipSpace, z: f64) -> f64 {
        let depth = match *projection {
            Projection::Perspective { near, far, .. } if far.is_infinite() => 1.0 - near / z,
            Projection::Perspective { near, far, .. } => far * (z - near) / (z * (far - near)),
            Projection::Orthographic { near, far, .. } => (z - near) / (far - near),
        };
        if clip.reversed { depth - 1.0 } else { depth }
    }

    #[test]
    fn every_space_gives_the_closed_forms_depth_and_height() {
        let perspective =
            |far| Projection::Perspective { fovy_degrees: 90.0, aspect: 1.0, near: 0.5, far };
        let box_ = Projection::Orthographic { width: 2.0, height: 2.0, near: 0.5, far: 8.0 };
        for projection in [perspective(8.0), perspective(f64::INFINITY), box_] {
            for clip in spaces() {
                let matrix = projection.clip_from_view_in(clip);
                for z in [0.5, 0.75, 2.0, 8.0] {
                    let p = matrix * DVec4::new(0.0, 0.25, -z, 1.0);
                    let look = clip.look(p.truncate() / p.w);
                    let depth = expected(&projection, clip, z);
                    assert!((look.z - depth).abs() < 1e-14, "{projection:?} {clip:?} {z}: {look}");
                    assert_eq!(look.y < 0.5, clip.y_down, "{clip:?}");
                }
                let [near, far] = clip.ends(&projection);
                let [low, high] = clip.depths();
                assert!((clip.look(DVec3::new(0.0, 0.0, near)).z - low).abs() < 1e-15);
                let end = clip.look(DVec3::new(0.0, 0.0, far)).z;
                assert!((end - high).abs() < 1e-5, "{clip:?} {end}");
            }
        }
    }
}
