//! The normals of a receiver beside its face's: those of the vertices, and the one that shades.
//!
//! Whether a receiver faces the light and counts is said by its face ([`super::observe::Standing`]); how much
//! a wrong verdict of it is seen by the normal that shades, and what no shading lights weighs 0.

use super::observe::Observer;
use crate::scene::Sides;
use crate::shadow::bias::SurfaceNormals;
use crate::truth::Receiver;
use crate::view::length;
use glam::DVec3;

impl Observer<'_> {
    /// Normals of the vertices at a receiver; `None` where its mesh has none and its face's stands for them,
    /// as three.js' flat shading has it.
    ///
    /// They are turned as materials turn them: those of one that draws the back alone are reversed; one that
    /// draws both reverses the normal that shades where the camera sees the back, and never those of the
    /// vertices; one that draws the front alone turns nothing.
    #[must_use]
    #[inline]
    pub fn vertex_normals_at(&self, receiver: &Receiver) -> Option<SurfaceNormals> {
        self.interpolated(receiver, self.vertex_normals.as_ref()?)
    }

    fn interpolated(&self, receiver: &Receiver, normals: &[DVec3]) -> Option<SurfaceNormals> {
        let corners = self.geometry.triangles[receiver.triangle as usize];
        let corner = corners.map(|v| normals[v as usize]);
        if corner.contains(&DVec3::ZERO) {
            return None;
        }
        let [a, b, c] = self.barycentrics(receiver);
        let sum = corner[0] * a + corner[1] * b + corner[2] * c;
        let unit = sum / length(sum);
        if !unit.is_finite() {
            return None;
        }
        let object = usize::from(self.geometry.object[receiver.triangle as usize]);
        let object = &self.case().objects[object];
        let (all, shading) = match object.surface.sides {
            Sides::Front => (1.0, 1.0),
            Sides::Back => (-1.0, 1.0),
            Sides::Both => {
                let face = self.geometry.area_normal(receiver.triangle);
                let winding = face.dot(self.seen_normal(receiver)) < 0.0;
                // A mirrored model's front is wound clockwise in the world.
                (1.0, if winding != (object.model.determinant() < 0.0) { -1.0 } else { 1.0 })
            }
        };
        Some(SurfaceNormals {
            vertices: sum * all,
            interpolated: unit * all,
            shading: unit * (all * shading),
        })
    }

    /// Barycentrics of a receiver in its triangle's plane, f64; not finite where that has no area.
    fn barycentrics(&self, receiver: &Receiver) -> [f64; 3] {
        let [a, b, c] = self.geometry.corners(receiver.triangle).map(|p| p - receiver.position);
        let normal = self.geometry.area_normal(receiver.triangle);
        let share = |p: DVec3, q: DVec3| p.cross(q).dot(normal) / normal.dot(normal);
        [share(b, c), share(c, a), share(a, b)]
    }
}
