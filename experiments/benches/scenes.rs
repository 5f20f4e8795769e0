//! Scenes that the benches share.
#![allow(dead_code, unreachable_pub, reason = "every bench uses a part of it")]

use super::meshes::{append, append_grid, icosphere};
use glam::{DVec3, Vec4};
use gnomon::scene::Geometry;

/// The direction towards the light.
pub const SUN: DVec3 = DVec3::new(0.35, 0.8, 0.3);

fn wave(x: f64, z: f64) -> f64 {
    0.35 * libm::sin(3.1 * x) * libm::cos(2.7 * z)
        + 0.06 * libm::sin(17.0 * x + 2.0 * z)
        + 0.02 * libm::cos(61.0 * z - 23.0 * x)
}

/// `side` · `side` bumpy squares.
pub fn grid(side: u32) -> Geometry {
    let mut scene = Geometry::default();
    append_grid(&mut scene, side, |x, z| DVec3::new(8.0 * x, wave(8.0 * x, 8.0 * z), -8.0 * z));
    in_f32(scene)
}

/// The same with twelve spheres: 1,064,960 triangles for a side of 640.
pub fn terrain(side: u32) -> Geometry {
    let mut scene = grid(side);
    for k in 0..12_u32 {
        let (x, z) = (f64::from(k % 4) * 3.0 - 4.5, f64::from(k / 4) * 3.0 - 3.0);
        let ball = icosphere(5, DVec3::new(x, wave(x, -z) + 0.8, z), 0.45);
        append(&mut scene, &ball.positions, &ball.triangles);
    }
    in_f32(scene)
}

/// Large triangles over each other.
pub fn sheets() -> Geometry {
    let mut scene = Geometry::default();
    append_grid(&mut scene, 1, |x, z| DVec3::new(9.0 * x, 0.0, -9.0 * z));
    for k in 0..100 {
        let at = DVec3::new(
            0.13 * f64::from(k % 10) - 0.6,
            1.0 + 0.02 * f64::from(k),
            0.1 * f64::from(k / 10) - 0.5,
        );
        append_grid(&mut scene, 2, |x, z| at + DVec3::new(1.5 * x, 0.3 * x * z, -1.5 * z));
    }
    in_f32(scene)
}

/// Ten thousand slats much thinner than a texel, over a floor.
pub fn fence() -> Geometry {
    let mut scene = Geometry::default();
    append_grid(&mut scene, 1, |x, z| DVec3::new(8.0 * x, 0.0, -8.0 * z));
    for k in 0..10_000 {
        let (row, x) = (f64::from(k / 1000), 0.012 * f64::from(k % 1000) - 6.0);
        let z = 1.1 * row - 5.0;
        append_grid(&mut scene, 1, |s, y| DVec3::new(x + 1e-3 * s, 0.8 + 0.8 * y, z + 0.01 * x));
    }
    in_f32(scene)
}

pub fn in_f32(mut scene: Geometry) -> Geometry {
    scene.positions.iter_mut().for_each(|p| *p = p.as_vec3().as_dvec3());
    scene
}

/// The scene as a light sees it, the frustum as tight as its vertices allow: GL clip space, f32.
pub fn clip_space(scene: &Geometry, sun: DVec3, is_point: bool) -> Vec<Vec4> {
    let away = -sun.normalize();
    let (right, up) = away.any_orthonormal_pair();
    // Sideways, upwards and away from the light.
    let seen = |p: &DVec3| {
        let from_light = *p - sun * 30.0;
        DVec3::new(from_light.dot(right), from_light.dot(up), from_light.dot(away))
    };
    let flat = |p: DVec3| if is_point { DVec3::new(p.x / p.z, p.y / p.z, p.z) } else { p };
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for p in scene.positions.iter().map(seen).map(flat) {
        (low, high) = (low.min(p), high.max(p));
    }
    let pad = (high - low) * 1e-3;
    let (low, high) = (low - pad, high + pad);
    let clip = |p: DVec3| {
        let w = if is_point { p.z } else { 1.0 };
        let ndc = (flat(p) * 2.0 - low - high) / (high - low);
        // Depth over distance, or distance itself, from -1 at `low.z` to 1 at `high.z`.
        let (near, far) = (low.z, high.z);
        let hyperbolic = (far + near) / (far - near) - 2.0 * far * near / (far - near) / p.z;
        let z = if is_point { hyperbolic } else { ndc.z };
        Vec4::new((ndc.x * w) as f32, (ndc.y * w) as f32, (z * w) as f32, w as f32)
    };
    scene.positions.iter().map(seen).map(clip).collect()
}
