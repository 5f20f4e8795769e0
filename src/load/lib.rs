//! Scene files: glTF 2.0 (`.gltf`, `.glb`), Wavefront OBJ, PLY, STL and three.js' scene JSON, read under
//! limits and refused in one sentence; other formats are named, with how to convert them.
//!
//! What changes a shadow is read: geometry with its normals in the pose that the file or a time gives,
//! sides and alpha masks of materials, every light and camera; nothing else of materials. Files named
//! by a scene stay inside its folder.

// A reader may not panic on what a file says.
#![cfg_attr(not(test), deny(clippy::unwrap_used, clippy::expect_used, clippy::indexing_slicing))]

pub mod config;
mod files;
pub mod fit;
mod format;
mod gltf;
mod mtl;
mod obj_file;
mod picture;
mod ply_file;
mod polygons;
pub mod range;
mod repair;
mod stl_file;
mod strips;
pub mod summary;
mod three;
mod told;

use files::Budget;
pub use files::{Beside, Blend, Limits, Wanted};
use format::Format;
use glam::{DMat4, DVec3};
use gnomon_core::scene::{Mesh, Surface};
use gnomon_core::{Error, Result};
use std::path::Path;
use std::sync::Arc;
pub use summary::{FileFacts, Summary};

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
    /// The filter that the file's engine uses unless it is told otherwise, as `lookup.filter` names it;
    /// none where the file names no engine.
    pub filter: Option<&'static str>,
    /// What was left out, or taken otherwise than an engine would, and can change a shadow, each as a
    /// sentence that is said once.
    pub skipped: Vec<String>,
    /// What else is worth knowing of the file, each as a sentence.
    pub notes: Vec<String>,
    /// What the file says of itself.
    pub file: FileFacts,
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

impl LoadedShadow {
    /// What of it is not applied, each as a sentence.
    fn unapplied(&self) -> Vec<String> {
        let normal = (self.normal_bias != 0.0).then(|| {
            format!("shadow.normalBias of {}: one knob is measured at a time", self.normal_bias)
        });
        let radius = (self.radius != 1.0).then(|| {
            format!("shadow.radius of {}: the filter is taken as of radius 1", self.radius)
        });
        normal.into_iter().chain(radius).collect()
    }
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

impl LoadedLens {
    /// What it is called.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Perspective { .. } => "perspective",
            Self::Orthographic { .. } => "orthographic",
        }
    }
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

/// Reads the bytes of a scene file, known by its content, then by the extension of its path; the files
/// that it names come from `beside`.
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
    let format = format::of(path, bytes)?;
    let mut scene = match format {
        Format::Gltf => self::gltf::read(&place, bytes, budget)?,
        Format::Obj => obj_file::read(&place, bytes, budget)?,
        Format::Ply => ply_file::read(&place, bytes, budget)?,
        Format::Stl => stl_file::read(&place, bytes, budget)?,
        Format::Three => three::read(&place, bytes, budget)?,
    };
    scene.file.format = format.name();
    let triangles: usize = scene.parts.iter().map(|part| part.mesh.triangles.len()).sum();
    if triangles == 0 {
        return Err(Error::bad_input(
            path.display().to_string(),
            "holds no triangle",
            "give a scene with triangle meshes",
        ));
    }
    check_parts(&place, scene.parts.len())?;
    in_range(&path.display().to_string(), &scene)?;
    Ok(scene)
}

/// Refuses more parts than a triangle can say that it belongs to.
fn check_parts(place: &str, count: usize) -> Result<()> {
    if count <= usize::from(u16::MAX) {
        return Ok(());
    }
    let reason = format!("holds {count} parts, at most {} can be told apart", u16::MAX);
    Err(Error::bad_input(place, reason, "merge meshes (`gltf-transform join`), or draw fewer"))
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
