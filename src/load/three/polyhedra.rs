//! Tetra-, octa-, icosa- and dodecahedra and other polyhedra, vertex for vertex as three.js r187 makes
//! them: faces divided, pushed to the sphere, no index.

use super::shape::{PI, Parameters, Shape, normalized};
use glam::{DVec2, DVec3};
use gnomon_core::{Error, Result};
use libm::atan2;
use serde_json::Value;

/// Corners and faces of a solid.
type Solid = (Vec<DVec3>, Vec<[u32; 3]>);

const TETRAHEDRON: [[u32; 3]; 4] = [[2, 1, 0], [0, 3, 2], [1, 3, 0], [2, 3, 1]];

const OCTAHEDRON: [[u32; 3]; 8] =
    [[0, 2, 4], [0, 4, 3], [0, 3, 5], [0, 5, 2], [1, 2, 5], [1, 5, 3], [1, 3, 4], [1, 4, 2]];

#[rustfmt::skip]
const ICOSAHEDRON: [[u32; 3]; 20] = [
    [0, 11, 5], [0, 5, 1], [0, 1, 7], [0, 7, 10], [0, 10, 11],
    [1, 5, 9], [5, 11, 4], [11, 10, 2], [10, 7, 6], [7, 1, 8],
    [3, 9, 4], [3, 4, 2], [3, 2, 6], [3, 6, 8], [3, 8, 9],
    [4, 9, 5], [2, 4, 11], [6, 2, 10], [8, 6, 7], [9, 8, 1],
];

#[rustfmt::skip]
const DODECAHEDRON: [[u32; 3]; 36] = [
    [3, 11, 7], [3, 7, 15], [3, 15, 13], [7, 19, 17], [7, 17, 6], [7, 6, 15],
    [17, 4, 8], [17, 8, 10], [17, 10, 6], [8, 0, 16], [8, 16, 2], [8, 2, 10],
    [0, 12, 1], [0, 1, 18], [0, 18, 16], [6, 10, 2], [6, 2, 13], [6, 13, 15],
    [2, 16, 18], [2, 18, 3], [2, 3, 13], [18, 1, 9], [18, 9, 11], [18, 11, 3],
    [4, 14, 12], [4, 12, 0], [4, 0, 8], [11, 9, 5], [11, 5, 19], [11, 19, 7],
    [19, 5, 14], [19, 14, 4], [19, 4, 17], [1, 12, 14], [1, 14, 5], [1, 5, 9],
];

fn points<const N: usize>(list: [[f64; 3]; N]) -> Vec<DVec3> {
    list.map(DVec3::from_array).to_vec()
}

/// The solid of a geometry's type; `None` where it is no polyhedron.
fn solid(kind: &str, p: &Parameters<'_, '_, '_>) -> Result<Option<Solid>> {
    let t = (1.0 + f64::sqrt(5.0)) / 2.0;
    let r = 1.0 / t;
    Ok(Some(match kind {
        "TetrahedronGeometry" => {
            let corners =
                [[1.0, 1.0, 1.0], [-1.0, -1.0, 1.0], [-1.0, 1.0, -1.0], [1.0, -1.0, -1.0]];
            (points(corners), TETRAHEDRON.to_vec())
        }
        "OctahedronGeometry" => {
            let axes = [DVec3::X, -DVec3::X, DVec3::Y, -DVec3::Y, DVec3::Z, -DVec3::Z];
            (axes.to_vec(), OCTAHEDRON.to_vec())
        }
        "IcosahedronGeometry" => {
            let [a, b] = [[-1.0, 1.0, -1.0, 1.0], [t, t, -t, -t]];
            let pairs = || a.into_iter().zip(b);
            let corners = pairs().map(|(a, b)| DVec3::new(a, b, 0.0));
            let corners = corners.chain(pairs().map(|(a, b)| DVec3::new(0.0, a, b)));
            let corners = corners.chain(pairs().map(|(a, b)| DVec3::new(b, 0.0, a)));
            (corners.collect(), ICOSAHEDRON.to_vec())
        }
        "DodecahedronGeometry" => {
            let cube = (0..8).map(|i| {
                let sign = |bit: i32| if i & bit == 0 { -1.0 } else { 1.0 };
                DVec3::new(sign(4), sign(2), sign(1))
            });
            let signs = [[-1.0, -1.0], [-1.0, 1.0], [1.0, -1.0], [1.0, 1.0]];
            let rest = [
                signs.map(|[a, b]| DVec3::new(0.0, a * r, b * t)),
                signs.map(|[a, b]| DVec3::new(a * r, b * t, 0.0)),
                [[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]]
                    .map(|[a, b]| DVec3::new(a * t, 0.0, b * r)),
            ];
            (cube.chain(rest.into_iter().flatten()).collect(), DODECAHEDRON.to_vec())
        }
        "PolyhedronGeometry" => given(p)?,
        _ => return Ok(None),
    }))
}

/// A solid by its own lists.
fn given(p: &Parameters<'_, '_, '_>) -> Result<Solid> {
    let numbers = |key: &str| -> Option<Vec<f64>> {
        p.given.get(key)?.as_array()?.iter().map(Value::as_f64).collect()
    };
    let lists = numbers("vertices").zip(numbers("indices")).and_then(|(vertices, indices)| {
        let corners: Vec<DVec3> =
            vertices.as_chunks().0.iter().copied().map(DVec3::from_array).collect();
        let faces = indices.as_chunks().0.iter().map(|face: &[f64; 3]| face.map(|i| i as u32));
        let faces: Vec<[u32; 3]> = faces.collect();
        let inside = faces.iter().flatten().all(|&i| (i as usize) < corners.len());
        (inside && corners.iter().all(|c| c.is_finite())).then_some((corners, faces))
    });
    lists.ok_or_else(|| {
        Error::bad_input(p.place, "has no sound vertices and indices", "export it again")
    })
}

/// A polyhedron of this type; `None` where the type is none.
pub(super) fn polyhedron(kind: &str, p: &mut Parameters<'_, '_, '_>) -> Result<Option<Shape>> {
    let Some((corners, faces)) = solid(kind, p)? else { return Ok(None) };
    let (radius, detail) = (p.number("radius", 1.0)?, p.count("detail", 0, 0)?);
    let columns = u64::from(detail) + 1;
    let triangles = columns.saturating_mul(columns).saturating_mul(faces.len() as u64);
    p.budget.vertices(p.place, triangles.saturating_mul(3))?;
    p.budget.indices(p.place, triangles.saturating_mul(3))?;
    let corner = |i: u32| corners.get(i as usize).copied().unwrap_or_default();
    let mut positions = Vec::new();
    for face in faces {
        divide(face.map(corner), detail + 1, &mut positions);
    }
    positions.iter_mut().for_each(|p| *p = normalized(*p) * radius);
    let uvs = uvs(&positions);
    let rounded = |p: &DVec3| p.as_vec3().as_dvec3();
    let normals = match detail {
        0 => positions
            .as_chunks()
            .0
            .iter()
            .flat_map(|face: &[DVec3; 3]| {
                let [a, b, c] = face.each_ref().map(rounded);
                [rounded(&(c - b).cross(a - b)); 3]
            })
            .map(normalized)
            .collect(),
        _ => positions.iter().map(|p| normalized(rounded(p))).collect(),
    };
    let triangles =
        (0..positions.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    Ok(Some(Shape { positions, normals, uvs, triangles, groups: Vec::new() }))
}

/// `Vector3.lerp`.
fn lerp(a: DVec3, b: DVec3, t: f64) -> DVec3 {
    a + (b - a) * t
}

/// The corners of all triangles of a face that is divided into so many columns.
fn divide([a, b, c]: [DVec3; 3], columns: u32, positions: &mut Vec<DVec3>) {
    let at = |i: u32, j: u32| {
        let t = f64::from(i) / f64::from(columns);
        let [aj, bj] = [lerp(a, c, t), lerp(b, c, t)];
        if i == columns { aj } else { lerp(aj, bj, f64::from(j) / f64::from(columns - i)) }
    };
    for i in 0..columns {
        for j in 0..2 * (columns - i) - 1 {
            let k = j / 2;
            positions.extend(match j % 2 {
                0 => [at(i, k + 1), at(i + 1, k), at(i, k)],
                _ => [at(i, k + 1), at(i + 1, k + 1), at(i + 1, k)],
            });
        }
    }
}

fn azimuth(p: DVec3) -> f64 {
    atan2(p.z, -p.x)
}

/// Spherical coordinates, corrected at the poles and across the seam.
fn uvs(positions: &[DVec3]) -> Vec<DVec2> {
    let uv = |p: DVec3| {
        let inclination = atan2(-p.y, f64::sqrt(p.x * p.x + p.z * p.z));
        DVec2::new(azimuth(p) / 2.0 / PI + 0.5, 1.0 - (inclination / PI + 0.5))
    };
    let face = |face: &[DVec3; 3]| {
        let [a, b, c] = *face;
        let middle = azimuth((a + b + c) / 3.0);
        let mut uvs = face.map(|p| {
            let uv = uv(p);
            let u = match (middle < 0.0 && uv.x == 1.0, p.x == 0.0 && p.z == 0.0) {
                (_, true) => middle / 2.0 / PI + 0.5,
                (true, false) => uv.x - 1.0,
                (false, false) => uv.x,
            };
            DVec2::new(u, uv.y)
        });
        let us = uvs.map(|uv| uv.x);
        let most = us.into_iter().fold(f64::NEG_INFINITY, f64::max);
        let least = us.into_iter().fold(f64::INFINITY, f64::min);
        if most > 0.9 && least < 0.1 {
            uvs.iter_mut().filter(|uv| uv.x < 0.2).for_each(|uv| uv.x += 1.0);
        }
        uvs
    };
    positions.as_chunks().0.iter().flat_map(face).collect()
}
