//! Vertex normals as files and programs give them, in the world.

use super::Case;
use glam::{DMat3, DVec3, Mat4};

/// Normals go by the inverse transpose of the model matrix, f64; up to a factor > 0, so that a matrix that
/// flattens a mesh has one too.
fn world_from_normal(model: &Mat4) -> DMat3 {
    let m = DMat3::from_mat4(model.as_dmat4());
    let [x, y, z] = [m.x_axis, m.y_axis, m.z_axis];
    let cofactors = DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y));
    cofactors * if m.determinant() < 0.0 { -1.0 } else { 1.0 }
}

impl Case {
    /// Unit normals of all vertices in the world, in the order of [`super::Geometry::positions`]: each mesh's
    /// own by the inverse transpose of its model matrix, f64 within a few ulp, not turned to any side; zero
    /// where a mesh has none or one has no length. `None` where no mesh has any.
    #[must_use]
    pub fn vertex_normals(&self) -> Option<Vec<DVec3>> {
        if self.objects.iter().all(|object| object.mesh.normals.is_empty()) {
            return None;
        }
        let mut normals = Vec::new();
        for object in &self.objects {
            let world = world_from_normal(&object.model);
            let unit = |v: usize| {
                let given = object.mesh.normals.get(v).map_or(DVec3::ZERO, |n| n.as_dvec3());
                let normal = world * given;
                let unit = normal / crate::view::length(normal);
                if unit.is_finite() { unit } else { DVec3::ZERO }
            };
            normals.extend((0..object.mesh.positions.len()).map(unit));
        }
        Some(normals)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn normals_stay_upright_under_any_scale() {
        let at = |model: Mat4, normal: DVec3| {
            let world = world_from_normal(&model) * normal;
            world / crate::view::length(world)
        };
        let slope = DVec3::new(1.0, 1.0, 0.0);
        let squeezed = at(Mat4::from_scale(Vec3::new(2.0, 1.0, 1.0)), slope);
        assert!((squeezed - DVec3::new(0.5, 1.0, 0.0).normalize()).length() < 1e-15);
        let mirrored = at(Mat4::from_scale(Vec3::new(-1.0, 1.0, 1.0)), slope);
        assert!((mirrored - DVec3::new(-1.0, 1.0, 0.0).normalize()).length() < 1e-15);
        let flat = at(Mat4::from_scale(Vec3::new(1.0, 0.0, 1.0)), slope);
        assert_eq!(flat, DVec3::Y);
    }
}
