//! Scene files: glTF 2.0 (`.gltf`, `.glb`), Wavefront OBJ, PLY and three.js' scene JSON, read under limits
//! and refused in one sentence.
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
mod three;

use files::Budget;
pub use files::{Beside, Limits};
use glam::{DMat4, DVec3};
use gnomon_core::scene::{Mesh, Surface};
use gnomon_core::{Error, Result};
use std::path::Path;
use std::sync::Arc;

/// What a scene file holds.
#[derive(Clone, Debug, Default)]
pub struct LoadedScene {
    /// What is drawn.
    pub parts: Vec<Part>,
    /// Every light of the file, in its order.
    pub lights: Vec<LoadedLight>,
    /// Every camera of the file, in its order.
    pub cameras: Vec<LoadedCamera>,
    /// The faces that the file's engine leaves out of maps, as `map.cull` names them; none where the file
    /// says nothing of it.
    pub cull: Option<&'static str>,
    /// What was left out, or taken otherwise than an engine would, and can change a shadow, each as a
    /// sentence that is said once.
    pub skipped: Vec<String>,
    /// What else is worth knowing of the file, each as a sentence.
    pub notes: Vec<String>,
}

/// A mesh where it stands.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// What reports call it.
    pub name: String,
    /// Its shape; instances share one.
    pub mesh: Arc<Mesh>,
    /// World from model, multiplied along the file's nodes in f64.
    pub model: DMat4,
    /// How it is drawn.
    pub surface: Surface,
}

impl Part {
    /// A mesh where its vertices are, drawn on both sides.
    fn drawn(name: String, mesh: Mesh) -> Self {
        let (model, surface) = (DMat4::IDENTITY, Surface::default());
        Self { name, mesh: mesh.into(), model, surface }
    }
}

/// A kind of light, with what only it has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightKind {
    /// Parallel light; its position is where its shadow camera stands, if the file says so.
    Directional,
    /// A cone of this full angle in degrees.
    Spot {
        /// Full cone angle, degrees.
        cone_degrees: f64,
    },
    /// Light into all directions, whose shadow is a cube of maps.
    Point,
}

/// A light as the file gives it.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadedLight {
    /// Its name, or that of its node.
    pub name: String,
    /// Directional, spot or point.
    pub kind: LightKind,
    /// Where it stands.
    pub position: DVec3,
    /// Where it shines, unit length.
    pub direction: DVec3,
    /// How far a spot or point light reaches in world units, if the file says so.
    pub range: Option<f64>,
    /// What the file says of its map.
    pub shadow: Option<LoadedShadow>,
}

/// A light's map as the file gives it.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadedShadow {
    /// Left, right, bottom and top of a directional light's box from its line of sight, world units.
    pub sides: Option<[f64; 4]>,
    /// Vertical field of view of a spot's map in degrees, where it is not the cone's angle.
    pub fovy_degrees: Option<f64>,
    /// Near plane, from the light.
    pub near: f64,
    /// Far plane, from the light.
    pub far: f64,
    /// Width and height in texels.
    pub size: Option<[u32; 2]>,
    /// Constant bias in window depth; positive repairs acne.
    pub bias: Option<f32>,
    /// Normal offset in the engine's own unit.
    pub normal_bias: f64,
    /// Filter radius in the engine's own unit.
    pub radius: f64,
}

/// A camera's lens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LoadedLens {
    /// A pinhole.
    Perspective {
        /// Vertical field of view in degrees.
        fovy_degrees: f64,
    },
    /// A box.
    Orthographic {
        /// Its height in world units.
        height: f64,
    },
}

/// A camera as the file gives it.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadedCamera {
    /// Its name, or that of its node.
    pub name: String,
    /// The eye.
    pub position: DVec3,
    /// Where it looks, unit length.
    pub direction: DVec3,
    /// Up.
    pub up: DVec3,
    /// Its lens.
    pub lens: LoadedLens,
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
        "json" => three::read(&place, bytes, budget)?,
        _ => {
            return Err(Error::bad_input(
                path.display().to_string(),
                format!("'.{extension}' is no scene format known here"),
                "give a .gltf, .glb, .obj or .ply file, or three.js' scene.toJSON() as .json",
            ));
        }
    };
    let triangles: usize = scene.parts.iter().map(|part| part.mesh.triangles.len()).sum();
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
    for Part { name, mesh, model, .. } in &scene.parts {
        for i in 0..mesh.positions.len() {
            let p = model.transform_point3(mesh.at(i));
            range::point(|| format!("{place}: part '{name}': vertex {i} in the world"), p)?;
            (low, high) = (low.min(p), high.max(p));
        }
    }
    range::extent(&format!("{place}: the scene"), low, high)
}
