//! Moves along a surface's normal: receivers outwards, casters inwards, in each engine's form.

use super::Site;
use glam::DVec3;

crate::catalogue! {
    /// How the length of a move depends on θ, the angle between normal and light.
    pub enum NormalWeight {
        /// 1 (three.js normalBias, Bevy shadow_normal_bias, HDRP).
        One = "one",
        /// sin θ (Filament, Unity built-in, Babylon).
        Sin = "sin",
        /// 1 − cos θ (Godot, URP, Cesium).
        OneMinusCos = "1-cos",
        /// sin θ / cos 0.534 + 0.195 (Blender EEVEE Next).
        Blender = "blender",
    }
}

impl NormalWeight {
    /// The weight; θ ∈ [0°, 90°] given by its cosine.
    #[must_use]
    pub fn at(self, cosine: f64) -> f64 {
        let cosine = cosine.clamp(0.0, 1.0);
        let sine = f64::sqrt(1.0 - cosine * cosine);
        match self {
            Self::One => 1.0,
            Self::Sin => sine,
            Self::OneMinusCos => 1.0 - cosine,
            Self::Blender => sine / libm::cos(0.534) + 0.195,
        }
    }
}

crate::catalogue! {
    /// The normal that a move goes along, as the engine's shader has it.
    pub enum MoveNormal {
        /// The face's own, on the side that the light reaches (Blender EEVEE Next, from derivatives).
        Face = "face",
        /// The normals of the vertices: each is moved by its own and the moved ones are interpolated; never
        /// turned to the side seen (three.js; casters of Unity, URP and Babylon).
        Vertices = "vertices",
        /// The interpolated one, normalised, never turned (Godot's normal_interp).
        Interpolated = "interpolated",
        /// The one that shades: interpolated, normalised, turned by a material that draws both sides where the
        /// back is seen (Bevy, Filament, HDRP, Cesium).
        Shading = "shading",
    }
}

/// Normals of the vertices at a place on a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceNormals {
    /// The vertices' unit normals, interpolated and not normalised again.
    pub vertices: DVec3,
    /// The interpolated normal, unit.
    pub interpolated: DVec3,
    /// The normal that shades, unit.
    pub shading: DVec3,
}

/// A move along the normal by amount · weight(θ) · (texel edge or 1 world unit).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalMove {
    /// Length; 0 does not move.
    pub amount: f64,
    /// Dependence on θ.
    pub weight: NormalWeight,
    /// Whether `amount` counts texel edges at the place itself, else world units.
    pub in_texels: bool,
    /// Whether the component along the light is removed, so that only the look-up moves (Godot).
    pub sideways: bool,
    /// The normal that it goes along.
    pub along: MoveNormal,
}

impl Default for NormalMove {
    fn default() -> Self {
        Self::NONE
    }
}

impl NormalMove {
    /// None.
    pub const NONE: Self = Self {
        amount: 0.0,
        weight: NormalWeight::One,
        in_texels: false,
        sideways: false,
        along: MoveNormal::Face,
    };

    /// The move at a place, world units, f64.
    #[must_use]
    pub fn offset(&self, site: &Site) -> DVec3 {
        if self.amount == 0.0 {
            return DVec3::ZERO;
        }
        let (normal, cosine_of) = match (self.along, &site.normals) {
            (MoveNormal::Face, _) | (_, None) => (site.normal, site.normal),
            (MoveNormal::Vertices, Some(normals)) => (normals.vertices, normals.interpolated),
            (MoveNormal::Interpolated, Some(normals)) => {
                (normals.interpolated, normals.interpolated)
            }
            (MoveNormal::Shading, Some(normals)) => (normals.shading, normals.shading),
        };
        let cosine = cosine_of.dot(site.to_light);
        let unit = if self.in_texels { site.texel_world } else { 1.0 };
        let offset = normal * (self.amount * self.weight.at(cosine) * unit);
        if self.sideways { offset - site.to_light * offset.dot(site.to_light) } else { offset }
    }
}
