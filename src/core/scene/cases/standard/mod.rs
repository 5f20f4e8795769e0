//! Standard scenes in code: fence, foliage cards, terrain, room, teapot, staircase. Their answers are
//! not known in closed form; their difficulties are: thin casters, many edges, many triangles, a lamp
//! in a closed space, curved surfaces, corners.
//!
//! Every coordinate is an f32 made with + − × ÷ √ and integers only, so a scene has the same bits
//! everywhere.

mod outdoors;
mod room;
mod teapot;
mod terrain;

use super::{float_map, plain_lookup};
use crate::camera::Camera;
use crate::device::DeviceProfile;
use crate::light::Light;
use crate::scene::shapes::Mesh;
use crate::scene::{Case, Cull, MatrixChain, Object, Shading};
use crate::view::{Projection, View};
use glam::{DVec3, Mat4, Vec3};

/// Names of the standard scenes; `terrain-N` stands for a terrain of about N triangles.
pub const NAMES: [&str; 6] = ["fence", "foliage", "terrain", "room", "teapot", "staircase"];

/// Triangles of the terrain where no number is given, and the most that can be asked for.
const TERRAIN: u32 = 20_000;
const LARGEST_TERRAIN: u32 = 16_000_000;

/// The standard scene of that name.
#[must_use]
pub fn named(name: &str) -> Option<Case> {
    match name {
        "fence" => Some(outdoors::fence()),
        "foliage" => Some(outdoors::foliage()),
        "staircase" => Some(outdoors::staircase()),
        "room" => Some(room::room()),
        "teapot" => Some(teapot::teapot(8)),
        "terrain" => Some(terrain::terrain(name, TERRAIN)),
        _ => {
            let triangles = name.strip_prefix("terrain-")?.parse().ok()?;
            let possible = (2..=LARGEST_TERRAIN).contains(&triangles);
            possible.then(|| terrain::terrain(name, triangles))
        }
    }
}

const GROUND: Vec3 = Vec3::new(0.75, 0.75, 0.7);
const WOOD: Vec3 = Vec3::new(0.7, 0.5, 0.35);
const LEAF: Vec3 = Vec3::new(0.35, 0.6, 0.3);

/// What a scene fixes; the rest is the same for all.
struct Scene<'n> {
    name: &'n str,
    about: &'static str,
    parts: Vec<(&'static str, Mesh)>,
    light: Light,
    /// Eye and the point it looks at.
    eye: [DVec3; 2],
    bias: f32,
}

/// A directional light over a box of `width` around the origin, near and far by its own distance.
fn sun(position: DVec3, width: f64) -> Light {
    let distance = crate::view::length(position);
    let projection = Projection::Orthographic {
        width,
        height: width,
        near: distance - width / 2.0,
        far: distance + width / 2.0,
    };
    Light::new(View { position, target: DVec3::ZERO, up: DVec3::Y }, projection, None)
}

fn case(scene: Scene<'_>) -> Case {
    let chain = MatrixChain::World;
    let [position, target] = scene.eye;
    let far = 4.0 * crate::view::length(target - position);
    let camera = Camera {
        view: View { position, target, up: DVec3::Y },
        projection: Projection::Perspective {
            fovy_degrees: 45.0,
            aspect: 16.0 / 9.0,
            near: far / 256.0,
            far,
        },
    };
    let object = |(name, mesh): (&str, Mesh)| Object::new(name, mesh, Mat4::IDENTITY);
    Case {
        name: scene.name.to_string(),
        document: format!("standard scene: {}", scene.about),
        objects: scene.parts.into_iter().map(object).collect(),
        light: scene.light,
        camera,
        canvas: [640, 360],
        chain,
        map: float_map(1024),
        lookup: plain_lookup(),
        camera_cull: Cull::None,
        bias: scene.bias,
        shading: Shading::AmbientLambert,
        device: DeviceProfile::Ideal,
        assumptions: Vec::new(),
        skipped: Vec::new(),
        facts: Vec::new(),
    }
}

/// Adds a mesh to another.
fn append(mesh: &mut Mesh, other: &Mesh) {
    let first = mesh.positions.len() as u32;
    mesh.positions.extend(&other.positions);
    mesh.triangles.extend(other.triangles.iter().map(|t| t.map(|v| v + first)));
}

/// Boxes between pairs of corners, as one mesh.
fn boxes(corners: impl IntoIterator<Item = [Vec3; 2]>, colour: Vec3) -> Mesh {
    let mut mesh = Mesh::new(Vec::new(), Vec::new(), colour);
    for [low, high] in corners {
        append(&mut mesh, &crate::scene::shapes::cuboid(low, high, colour));
    }
    mesh
}

/// A level square of half-width `half` at height `y`, facing up.
fn ground(half: f32, y: f32) -> Mesh {
    let at = |x: f32, z: f32| Vec3::new(x, y, z);
    crate::scene::shapes::quad(
        [at(-half, half), at(half, half), at(half, -half), at(-half, -half)],
        GROUND,
    )
}

/// 24 well-mixed bits of two numbers as a fraction of 1: what places leaves and hills.
fn random(x: u32, y: u32) -> f32 {
    let mut bits = x.wrapping_mul(0x9e37_79b9) ^ y.wrapping_mul(0x85eb_ca6b);
    for _ in 0..2 {
        bits = (bits ^ (bits >> 15)).wrapping_mul(0x2c1b_3c6d);
        bits = (bits ^ (bits >> 12)).wrapping_mul(0x297a_2d39);
    }
    (bits >> 8) as f32 / 16_777_216.0
}
