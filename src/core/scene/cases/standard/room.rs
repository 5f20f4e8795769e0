//! A closed room with a lamp under its ceiling: a table, stools and a ball.

use super::{GROUND, Scene, WOOD, boxes, case};
use crate::light::Light;
use crate::scene::Case;
use crate::scene::shapes::{Mesh, sphere};
use crate::view::{Projection, View};
use glam::{DVec3, Vec3};

/// Half the floor's sides and the height of the ceiling.
const SIZE: Vec3 = Vec3::new(4.0, 3.0, 3.0);

/// The room; the lamp's frustum of 120° leaves the upper walls outside the map.
pub(super) fn room() -> Case {
    let mut ball = sphere(0.5, 32, 16, WOOD);
    ball.positions.iter_mut().for_each(|p| *p += Vec3::new(-2.5, 0.5, 1.5));
    let eye = View {
        position: DVec3::new(0.5, 2.875, 0.25),
        target: DVec3::new(0.5, 0.0, 0.25),
        up: DVec3::NEG_Z,
    };
    let projection =
        Projection::Perspective { fovy_degrees: 120.0, aspect: 1.0, near: 0.125, far: 4.0 };
    case(Scene {
        name: "room",
        about: "a room with a lamp",
        parts: vec![("walls", walls()), ("table", table()), ("stools", stools()), ("ball", ball)],
        light: Light::new(eye, projection, Some(0.5)),
        eye: [DVec3::new(-3.75, 2.5, 2.75), DVec3::new(0.5, 0.5, 0.0)],
        bias: 0.001,
    })
}

/// Six sides that face inwards.
fn walls() -> Mesh {
    let low = Vec3::new(-SIZE.x, 0.0, -SIZE.z);
    let mut mesh = boxes([[low, SIZE]], GROUND);
    mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    mesh
}

/// A top and four legs.
fn table() -> Mesh {
    let leg = |x: f32, z: f32| [Vec3::new(x, 0.0, z), Vec3::new(x + 0.125, 1.0, z + 0.125)];
    let top = [Vec3::new(-1.0, 1.0, -0.75), Vec3::new(1.5, 1.0625, 0.75)];
    let legs = [leg(-1.0, -0.75), leg(1.375, -0.75), leg(-1.0, 0.625), leg(1.375, 0.625)];
    boxes([top].into_iter().chain(legs), WOOD)
}

/// Cubes around the table.
fn stools() -> Mesh {
    let stool = |x: f32, z: f32| [Vec3::new(x, 0.0, z), Vec3::new(x + 0.5, 0.5625, z + 0.5)];
    boxes([stool(-2.0, -0.25), stool(2.0, -0.25), stool(0.0, 1.25), stool(0.0, -1.75)], WOOD)
}
