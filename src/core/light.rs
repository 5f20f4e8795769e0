//! Lights: where they stand, how their map projects, and where a receiver's ray goes.

use crate::view::{self, Projection, View};
use glam::{DMat4, DVec3, DVec4};

/// A light with one shadow map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    /// Position and direction of the map's eye.
    pub view: View,
    /// The map's projection: perspective for a spot, orthographic for a directional light.
    pub projection: Projection,
    /// Cosine of the angle from the axis beyond which a spot gives no light, if it has a cone.
    pub cone_cos: Option<f64>,
}

impl Light {
    /// Whether all rays share a direction.
    #[must_use]
    pub const fn is_directional(&self) -> bool {
        matches!(self.projection, Projection::Orthographic { .. })
    }

    /// Exact-input clip matrix: f64 products of f64 matrices.
    #[must_use]
    pub fn clip_from_world(&self) -> DMat4 {
        view::product(&self.projection.clip_from_view(), &self.view.view_from_world())
    }

    /// Unit vector from a world point towards the light.
    #[must_use]
    pub fn direction_from(&self, p_world: DVec3) -> DVec3 {
        if self.is_directional() {
            return self.view.backward();
        }
        let to_light = self.view.position - p_world;
        to_light / view::length(to_light)
    }

    /// The other end of a receiver's shadow ray: the light's position, or for a directional light
    /// the point where the ray leaves the map's near plane towards the light, a far plane's
    /// distance further on, so that every caster of the scene within that reach counts.
    #[must_use]
    pub fn ray_end(&self, p_world: DVec3) -> DVec3 {
        if !self.is_directional() {
            return self.view.position;
        }
        let (_, far) = self.projection.near_far();
        let along = self.view.backward();
        let depth = (self.view.position - p_world).dot(along);
        p_world + along * (depth.abs() + far.abs())
    }

    /// Depth along the light's axis (distance from the eye's plane), world units.
    #[must_use]
    pub fn axial_distance(&self, p_world: DVec3) -> f64 {
        (self.view.position - p_world).dot(self.view.backward())
    }

    /// Map coordinates and depth of a world point, all in [0, 1] inside the map, and clip w.
    /// f64; `None` behind the eye (w ≤ 0).
    #[must_use]
    pub fn window_from_world(&self, clip_from_world: &DMat4, p_world: DVec3) -> Option<DVec3> {
        let clip: DVec4 = *clip_from_world * p_world.extend(1.0);
        (clip.w > 0.0).then(|| clip.truncate() / clip.w * 0.5 + 0.5)
    }

    /// Whether a world point lies in the spot's cone (always true without one).
    #[must_use]
    pub fn in_cone(&self, p_world: DVec3) -> bool {
        self.cone_cos
            .is_none_or(|limit| self.direction_from(p_world).dot(self.view.backward()) >= limit)
    }

    /// Edge length of one texel in world units at axial distance `distance`, for a square map of
    /// `size` texels.
    #[must_use]
    pub fn texel_world(&self, size: u32, distance: f64) -> f64 {
        let scale = if self.is_directional() { 1.0 } else { distance };
        2.0 * self.projection.half_width() * scale / f64::from(size)
    }

    /// World distance along the axis between two window depths.
    #[must_use]
    pub fn world_from_window(&self, depth: f64) -> f64 {
        let (near, far) = self.projection.near_far();
        if self.is_directional() {
            near + depth * (far - near)
        } else {
            near * far / (far - depth * (far - near))
        }
    }
}
