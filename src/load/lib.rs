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
mod repair;

use files::Budget;
pub use files::Limits;
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

/// Reads a scene file by its extension.
///
/// # Errors
/// [`Error::BadInput`] or [`Error::Read`] in one sentence: file, place, reason, what to do.
pub fn load(path: &Path, limits: &Limits) -> Result<LoadedScene> {
    let mut budget = Budget::new(limits);
    let bytes = budget.read(path)?;
    read(path, &bytes, budget)
}

/// Loads a scene from the bytes of the file at `path`; files that they name are looked for beside it.
///
/// # Errors
/// As [`load`].
pub fn parse(path: &Path, bytes: &[u8], limits: &Limits) -> Result<LoadedScene> {
    read(path, bytes, Budget::new(limits))
}

fn read(path: &Path, bytes: &[u8], budget: Budget) -> Result<LoadedScene> {
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or("").to_ascii_lowercase();
    let scene = match extension.as_str() {
        "gltf" | "glb" => gltf_file::read(path, bytes, budget)?,
        "obj" => obj_file::read(path, bytes, budget)?,
        "ply" => ply_file::read(path, bytes, budget)?,
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
    Ok(scene)
}
