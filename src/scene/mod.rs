//! Scenes: meshes with their models, and the world-space triangles that the truth sees.

use glam::DVec3;

/// World-space triangles in f64: what truth and analysis call *the scene*. A triangle's index is
/// its id everywhere (maps, EXR channels, verdicts).
#[derive(Clone, Debug, Default)]
pub struct Geometry {
    /// World positions; exact where the model matrix only translates, else rounded to f64.
    pub positions: Vec<DVec3>,
    /// Vertex indices, counter-clockwise seen from the front.
    pub triangles: Vec<[u32; 3]>,
    /// Index of the object that each triangle belongs to.
    pub object: Vec<u16>,
}

impl Geometry {
    /// The three corners of triangle `id`.
    #[must_use]
    pub fn corners(&self, id: u32) -> [DVec3; 3] {
        self.triangles[id as usize].map(|v| self.positions[v as usize])
    }
}
