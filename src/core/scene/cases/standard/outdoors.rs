//! Thin casters, many edges and many corners: a fence, foliage cards, a staircase, in the sun.

use super::{GROUND, LEAF, Scene, WOOD, boxes, case, ground, random, sun};
use crate::scene::Case;
use crate::scene::shapes::{Mesh, quad};
use glam::{DVec3, Vec3};

/// Slats of 1/32 between two rails: at 1024² texels a slat is less than three texels wide.
pub(super) fn fence() -> Case {
    let slat = |k: i32| {
        let x = k as f32 / 8.0;
        [Vec3::new(x, 0.0, -0.015_625), Vec3::new(x + 0.031_25, 1.5, 0.015_625)]
    };
    let rail = |y: f32| [Vec3::new(-4.0, y, 0.015_625), Vec3::new(4.0, y + 0.0625, 0.0625)];
    case(Scene {
        name: "fence",
        about: "a fence of thin slats",
        parts: vec![
            ("ground", ground(5.0, 0.0)),
            ("slats", boxes((-32..32).map(slat), WOOD)),
            ("rails", boxes([rail(0.375), rail(1.125)], WOOD)),
        ],
        light: sun(DVec3::new(4.0, 10.0, -8.0), 12.0),
        eye: [DVec3::new(3.0, 4.0, 6.0), DVec3::new(0.0, 0.25, 0.5)],
        bias: 0.002,
    })
}

/// A crown of 400 cards without thickness, turned every way, on a trunk.
pub(super) fn foliage() -> Case {
    let mut crown = Mesh::new(Vec::new(), Vec::new(), LEAF);
    for k in 0..400 {
        let unit = |axis: u32| 2.0 * random(k, axis) - 1.0;
        let centre = Vec3::new(unit(0), unit(1), unit(2)) * 1.5 + Vec3::Y * 3.0;
        let along = direction([unit(3), unit(4), unit(5)]) * 0.25;
        let across =
            direction(along.cross(direction([unit(6), unit(7), unit(8)])).to_array()) * 0.1875;
        let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
        let card = quad(corners.map(|[s, t]| centre + along * s + across * t), LEAF);
        super::append(&mut crown, &card);
    }
    let trunk = [Vec3::new(-0.125, 0.0, -0.125), Vec3::new(0.125, 2.5, 0.125)];
    case(Scene {
        name: "foliage",
        about: "foliage cards",
        parts: vec![
            ("ground", ground(5.0, 0.0)),
            ("trunk", boxes([trunk], WOOD)),
            ("crown", crown),
        ],
        light: sun(DVec3::new(5.0, 10.0, 4.0), 14.0),
        eye: [DVec3::new(-4.0, 5.0, 8.0), DVec3::new(-0.5, 1.0, 0.0)],
        bias: 0.002,
    })
}

/// A direction of about unit length; up where the vector has none.
fn direction(v: [f32; 3]) -> Vec3 {
    let squared = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    if squared > 1e-6 { Vec3::from_array(v) / squared.sqrt() } else { Vec3::Y }
}

/// Twelve steps with a post on each: contacts in every corner.
pub(super) fn staircase() -> Case {
    let step = |k: i32| {
        let (z, y) = (2.0 - k as f32 / 4.0, (k + 1) as f32 / 8.0);
        [Vec3::new(-1.5, 0.0, z - 0.25), Vec3::new(1.5, y, z)]
    };
    let post = |k: i32| {
        let (z, y) = (1.875 - k as f32 / 4.0, (k + 1) as f32 / 8.0);
        [Vec3::new(1.25, y, z - 0.015_625), Vec3::new(1.281_25, y + 0.75, z + 0.015_625)]
    };
    case(Scene {
        name: "staircase",
        about: "a staircase with posts",
        parts: vec![
            ("ground", ground(4.0, 0.0)),
            ("steps", boxes((0..12).map(step), GROUND)),
            ("posts", boxes((0..12).map(post), WOOD)),
        ],
        light: sun(DVec3::new(6.0, 9.0, 2.0), 10.0),
        eye: [DVec3::new(-2.0, 4.0, 6.0), DVec3::new(0.0, 0.5, 0.25)],
        bias: 0.002,
    })
}
