//! A terrain of any number of triangles: hills in five octaves, boulders on them, under a low sun.

use super::{GROUND, Scene, WOOD, append, case, random, sun};
use crate::scene::Case;
use crate::scene::shapes::{Mesh, sphere};
use glam::{DVec3, Vec3};

/// Half the side of the terrain.
const HALF: f32 = 16.0;

/// A terrain of at least `triangles` triangles.
pub(super) fn terrain(name: &str, triangles: u32) -> Case {
    let side = ((f64::from(triangles) / 2.0).sqrt().ceil() as u32).max(1);
    let boulders = if triangles < 10_000 { 0 } else { 12 };
    case(Scene {
        name,
        about: "terrain",
        parts: vec![("hills", hills(side)), ("boulders", stones(boulders))]
            .into_iter()
            .filter(|(_, mesh)| !mesh.triangles.is_empty())
            .collect(),
        light: sun(DVec3::new(24.0, 28.0, 16.0), 48.0),
        eye: [DVec3::new(-4.0, 18.0, 30.0), DVec3::new(0.0, 0.0, 2.0)],
        bias: 0.001,
    })
}

/// A grid of side² cells, two triangles each.
fn hills(side: u32) -> Mesh {
    let at = |i: u32, j: u32| {
        let place = |k: u32| (2.0 * (k as f32 / side as f32) - 1.0) * HALF;
        let (x, z) = (place(i), place(j));
        Vec3::new(x, height(x, z), z)
    };
    let positions = (0..=side).flat_map(|j| (0..=side).map(move |i| at(i, j))).collect();
    let cell = |i: u32, j: u32| {
        let here = j * (side + 1) + i;
        let below = here + side + 1;
        [[here, below, here + 1], [here + 1, below, below + 1]]
    };
    let triangles = (0..side).flat_map(|j| (0..side).flat_map(move |i| cell(i, j))).collect();
    Mesh::new(positions, triangles, GROUND)
}

/// Value noise in five octaves: each half as wide and less than half as high as the one before.
fn height(x: f32, z: f32) -> f32 {
    let octave = |k: u32| {
        let scale = (1 << k) as f32 / 8.0;
        noise(x * scale + 64.0, z * scale + 64.0, k) * [3.2, 1.4, 0.6, 0.25, 0.1][k as usize]
    };
    (0..5).map(octave).sum::<f32>() - 2.5
}

/// Smooth interpolation between random values on the integer lattice, for x, z > 0.
fn noise(x: f32, z: f32, seed: u32) -> f32 {
    let (i, j) = (x as u32, z as u32);
    let smooth = |t: f32| t * t * (3.0 - 2.0 * t);
    let (u, v) = (smooth(x - i as f32), smooth(z - j as f32));
    let value = |i: u32, j: u32| random(i + 1000 * seed, j);
    let row = |j: u32| value(i, j) + (value(i + 1, j) - value(i, j)) * u;
    row(j) + (row(j + 1) - row(j)) * v
}

/// Balls of 288 triangles that lie half in the ground.
fn stones(count: u32) -> Mesh {
    let mut mesh = Mesh::new(Vec::new(), Vec::new(), WOOD);
    for k in 0..count {
        let along = |axis: u32| (2.0 * random(7000 + k, axis) - 1.0) * 12.0;
        let (x, z) = (along(0), along(1));
        let radius = 0.5 + random(7000 + k, 2);
        let mut ball = sphere(f64::from(radius), 16, 9, WOOD);
        let centre = Vec3::new(x, height(x, z) + 0.5 * radius, z);
        ball.positions.iter_mut().for_each(|p| *p += centre);
        append(&mut mesh, &ball);
    }
    mesh
}
