//! The Utah teapot from its Bézier patches, on a table in the sun.
//!
//! The control points are Martin Newell's of 1975 in the form in which GLUT 3.7 published them
//! (`glut_teapot.c`: 127 points, 10 patches, the others by reflection).

use super::{GROUND, Scene, case, ground, sun};
use crate::scene::Case;
use crate::scene::shapes::Mesh;
use glam::{DVec3, Vec3};

/// x, y (depth) and z (height) of the control points.
const POINTS: &str = include_str!("teapot.txt");

/// Control points of each patch, row by row: rim, body (2), lid (2), bottom, which are reflected in x
/// and y; handle (2), spout (2), which are reflected in y.
const PATCHES: [[u8; 16]; 10] = [
    [102, 103, 104, 105, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15],
    [12, 13, 14, 15, 16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27],
    [24, 25, 26, 27, 29, 30, 31, 32, 33, 34, 35, 36, 37, 38, 39, 40],
    [96, 96, 96, 96, 97, 98, 99, 100, 101, 101, 101, 101, 0, 1, 2, 3],
    [0, 1, 2, 3, 106, 107, 108, 109, 110, 111, 112, 113, 114, 115, 116, 117],
    [118, 118, 118, 118, 124, 122, 119, 121, 123, 126, 125, 120, 40, 39, 38, 37],
    [41, 42, 43, 44, 45, 46, 47, 48, 49, 50, 51, 52, 53, 54, 55, 56],
    [53, 54, 55, 56, 57, 58, 59, 60, 61, 62, 63, 64, 28, 65, 66, 67],
    [68, 69, 70, 71, 72, 73, 74, 75, 76, 77, 78, 79, 80, 81, 82, 83],
    [80, 81, 82, 83, 84, 85, 86, 87, 88, 89, 90, 91, 92, 93, 94, 95],
];
const REFLECTED_IN_X: usize = 6;

/// The teapot of 32 patches, each of `cells`² cells of two triangles.
pub(super) fn teapot(cells: u32) -> Case {
    case(Scene {
        name: "teapot",
        about: "the Utah teapot",
        parts: vec![("table", ground(5.0, 0.0)), ("teapot", mesh(cells))],
        light: sun(DVec3::new(-6.0, 9.0, 4.0), 14.0),
        eye: [DVec3::new(2.0, 6.0, 9.0), DVec3::new(0.5, 1.0, 0.0)],
        bias: 0.002,
    })
}

fn points() -> Vec<DVec3> {
    let numbers: Vec<f64> = POINTS.split_whitespace().filter_map(|n| n.parse().ok()).collect();
    numbers.chunks_exact(3).map(DVec3::from_slice).collect()
}

fn mesh(cells: u32) -> Mesh {
    let points = points();
    let mut mesh = Mesh { smooth: true, ..Mesh::new(Vec::new(), Vec::new(), GROUND) };
    for (k, patch) in PATCHES.iter().enumerate() {
        let control = patch.map(|i| points[usize::from(i)]);
        let turns: &[f64] = if k < REFLECTED_IN_X { &[1.0, -1.0] } else { &[1.0] };
        for &x in turns {
            for y in [1.0, -1.0] {
                let reflect = DVec3::new(x, y, 1.0);
                add(&mut mesh, &control.map(|p| p * reflect), cells, x * y > 0.0);
            }
        }
    }
    mesh
}

/// Adds one patch, z up turned to y up; `keeps` tells whether its reflections keep the orientation.
fn add(mesh: &mut Mesh, control: &[DVec3; 16], cells: u32, keeps: bool) {
    let first = mesh.positions.len() as u32;
    let at = |k: u32| f64::from(k) / f64::from(cells);
    for i in 0..=cells {
        for j in 0..=cells {
            let p = surface(control, at(i), at(j));
            mesh.positions.push(Vec3::new(p.x as f32, p.z as f32, -p.y as f32));
        }
    }
    for i in 0..cells {
        for j in 0..cells {
            let here = first + i * (cells + 1) + j;
            let below = here + cells + 1;
            let mut pair = [[here, here + 1, below], [here + 1, below + 1, below]];
            if !keeps {
                pair.iter_mut().for_each(|t| t.swap(1, 2));
            }
            mesh.triangles.extend(pair);
        }
    }
}

/// Bernstein's cubic polynomials.
fn bernstein(t: f64) -> [f64; 4] {
    let s = 1.0 - t;
    [s * s * s, 3.0 * t * s * s, 3.0 * t * t * s, t * t * t]
}

/// A point of a bicubic patch.
fn surface(control: &[DVec3; 16], u: f64, v: f64) -> DVec3 {
    let (rows, columns) = (bernstein(u), bernstein(v));
    (0..16).map(|k| control[k] * (rows[k / 4] * columns[k % 4])).sum()
}
