//! Scene files: glTF 2.0 (`.gltf`, `.glb`), Wavefront OBJ and PLY, read under limits and refused in one
//! sentence.
//!
//! Only geometry, node transforms, the first camera and the first directional or spot light are read;
//! images and materials never are. Files named by a scene stay inside its folder.

// A reader may not panic on what a file says.
#![cfg_attr(not(test), deny(clippy::unwrap_used, clippy::expect_used, clippy::indexing_slicing))]

mod accessor;
pub mod config;
mod files;
pub mod fit;
mod gltf_file;
mod obj_file;
mod ply_file;
mod polygons;
pub mod range;
mod repair;
mod strips;

use files::Budget;
pub use files::{Beside, Limits};
use glam::{DVec3, Mat4};
use gnomon_core::scene::Mesh;
use gnomon_core::{Error, Result};
use std::path::Path;

/// What a scene file holds.
#[derive(Clone, Debug, Default)]
pub struct LoadedScene {
    /// Name, mesh and world-from-model matrix of each part.
    pub parts: Vec<(String, Mesh, Mat4)>,
    /// The first light that can have one shadow map.
    pub light: Option<LoadedLight>,
    /// The first perspective camera.
    pub camera: Option<LoadedCamera>,
    /// Parts of the file that were left out, each as a sentence.
    pub notes: Vec<String>,
}

/// A light as the file gives it: no map, no near and far.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoadedLight {
    /// Where it stands; meaningless for a directional light.
    pub position: DVec3,
    /// Where it shines, unit length.
    pub direction: DVec3,
    /// Full cone angle of a spot in degrees; `None` for a directional light.
    pub cone_degrees: Option<f64>,
}

/// A camera as the file gives it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoadedCamera {
    /// The eye.
    pub position: DVec3,
    /// Where it looks, unit length.
    pub direction: DVec3,
    /// Up.
    pub up: DVec3,
    /// Vertical field of view in degrees.
    pub fovy_degrees: f64,
}

/// Reads the bytes of a scene file by the extension of its path; the files that it names come from
/// `beside`.
///
/// # Errors
/// [`Error::BadInput`] in one sentence: file, place, reason, what to do; whatever `beside` answers.
pub fn read(
    path: &Path,
    bytes: &[u8],
    limits: &Limits,
    beside: &Beside<'_>,
) -> Result<LoadedScene> {
    let place = path.display().to_string();
    let budget = Budget::new(&place, bytes.len() as u64, limits, beside)?;
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or("").to_ascii_lowercase();
    let scene = match extension.as_str() {
        "gltf" | "glb" => gltf_file::read(&place, bytes, budget)?,
        "obj" => obj_file::read(&place, bytes, budget)?,
        "ply" => ply_file::read(&place, bytes, budget)?,
        _ => {
            return Err(Error::bad_input(
                path.display().to_string(),
                format!("'.{extension}' is no scene format known here"),
                "give a .gltf, .glb, .obj or .ply file",
            ));
        }
    };
    let triangles: usize = scene.parts.iter().map(|(_, mesh, _)| mesh.triangles.len()).sum();
    if triangles == 0 {
        return Err(Error::bad_input(
            path.display().to_string(),
            "holds no triangle",
            "give a scene with triangle meshes",
        ));
    }
    if scene.parts.len() > usize::from(u16::MAX) {
        return Err(Error::bad_input(
            path.display().to_string(),
            format!("holds {} parts, at most {} can be told apart", scene.parts.len(), u16::MAX),
            "merge meshes",
        ));
    }
    in_range(&path.display().to_string(), &scene)?;
    Ok(scene)
}

/// Refuses a scene whose world coordinates leave the range of the pipeline.
fn in_range(place: &str, scene: &LoadedScene) -> Result<()> {
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for (name, mesh, model) in &scene.parts {
        let model = model.as_dmat4();
        for (i, position) in mesh.positions.iter().enumerate() {
            let p = model.transform_point3(position.as_dvec3());
            range::point(|| format!("{place}: part '{name}': vertex {i} in the world"), p)?;
            (low, high) = (low.min(p), high.max(p));
        }
    }
    range::extent(&format!("{place}: the scene"), low, high)
}
