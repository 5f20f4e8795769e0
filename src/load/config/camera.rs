//! The camera of the settings.

use super::strict;
use serde::Deserialize;

gnomon_core::catalogue! {
    /// How a camera projects.
    pub enum CameraType {
        /// A pinhole.
        Perspective = "perspective",
        /// A box.
        Orthographic = "orthographic",
    }
}

/// A camera.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct CameraSettings {
    /// `perspective` or `orthographic`.
    #[serde(rename = "type")]
    pub kind: Option<String>,
    /// Name or number of a camera of the scene file.
    pub name: Option<String>,
    /// The eye.
    #[serde(deserialize_with = "strict::vector")]
    pub position: Option<[f64; 3]>,
    /// What it looks at.
    #[serde(deserialize_with = "strict::vector")]
    pub target: Option<[f64; 3]>,
    /// Up.
    #[serde(deserialize_with = "strict::vector")]
    pub up: Option<[f64; 3]>,
    /// Vertical field of view in degrees.
    #[serde(deserialize_with = "strict::number")]
    pub fovy: Option<f64>,
    /// Height of an orthographic camera's box in world units.
    #[serde(deserialize_with = "strict::number")]
    pub height: Option<f64>,
    /// Near plane.
    #[serde(deserialize_with = "strict::number")]
    pub near: Option<f64>,
    /// Far plane.
    #[serde(deserialize_with = "strict::number")]
    pub far: Option<f64>,
}
