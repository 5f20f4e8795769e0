//! Cameras: the eye whose pixels are the receivers.

use crate::view::{self, Projection, View};
use glam::{DMat4, DVec3};

/// The camera that looks at the lit scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Position and direction.
    pub view: View,
    /// Its projection.
    pub projection: Projection,
}

impl Camera {
    /// Clip matrix in f64.
    #[must_use]
    pub fn clip_from_world(&self) -> DMat4 {
        view::product(&self.projection.clip_from_view(), &self.view.view_from_world())
    }

    /// From a world point towards the eye, not normalised: the same everywhere for an orthographic camera.
    #[must_use]
    pub fn towards(&self, p_world: DVec3) -> DVec3 {
        match self.projection {
            Projection::Perspective { .. } => self.view.position - p_world,
            Projection::Orthographic { .. } => self.view.position - self.view.target,
        }
    }
}
