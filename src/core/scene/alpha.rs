//! Alpha-masked surfaces: the texture, factor and cutoff by which a point of a surface is there or not.

use glam::{DVec2, Vec2};

crate::catalogue! {
    /// What a texture gives outside of [0, 1].
    pub enum Tiling {
        /// The border texel goes on for ever.
        Clamp = "clamp-to-edge",
        /// The texture repeats.
        Repeat = "repeat",
        /// The texture repeats, every second time mirrored.
        Mirror = "mirrored-repeat",
    }
}

/// The alpha channel of a texture, rows from the top as glTF counts v.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AlphaImage {
    /// Width and height in texels, each at least 1.
    pub size: [u32; 2],
    /// One UNORM8 value a texel, row by row from v = 0.
    pub alpha: Vec<u8>,
    /// What u and v give outside.
    pub tiling: [Tiling; 2],
    /// Whether texels are mixed bilinearly; else the nearest one speaks.
    pub linear: bool,
}

/// A cut-out: a point is there where factor · texture ≥ cutoff (glTF 2.0, alphaMode MASK).
///
/// Texture coordinates are the mesh's own ([`Mesh::uvs`](super::Mesh::uvs)), moved by `offset` after a
/// multiplication by `scale_rotate` (KHR_texture_transform; the identity where there is none).
#[derive(Clone, Debug, PartialEq)]
pub struct Mask {
    /// The texture; without one the factor alone decides.
    pub image: Option<AlphaImage>,
    /// Multiplies the texture (the base colour factor's alpha).
    pub factor: f32,
    /// The least alpha that is there.
    pub cutoff: f32,
    /// Columns of the 2×2 matrix that turns and scales texture coordinates.
    pub scale_rotate: [Vec2; 2],
    /// What is added to them afterwards.
    pub offset: Vec2,
}

impl Mask {
    /// Texture coordinates of this mask for the mesh's own.
    #[must_use]
    pub fn moved(&self, uv: DVec2) -> DVec2 {
        let [x, y] = self.scale_rotate.map(|column| column.as_dvec2());
        x * uv.x + y * uv.y + self.offset.as_dvec2()
    }
}
