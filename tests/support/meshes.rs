//! Meshes and random numbers for tests of the truth.
#![allow(dead_code, unreachable_pub, reason = "every test binary uses a part of it")]

use std::collections::HashMap;

use glam::DVec3;
use gnomon::scene::Geometry;

/// Seeded random numbers, the same on every machine.
pub struct Random(fastrand::Rng);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(fastrand::Rng::with_seed(seed))
    }

    pub fn bits(&mut self) -> u64 {
        self.0.u64(..)
    }

    /// Uniform in [0, 1), a multiple of 2^-32.
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 32) as f64 / (1_u64 << 32) as f64
    }

    /// Uniform in [-1, 1)^3.
    pub fn cube(&mut self) -> DVec3 {
        DVec3::new(self.unit(), self.unit(), self.unit()) * 2.0 - 1.0
    }

    /// An integer in `low..=high`.
    pub fn integer(&mut self, low: i64, high: i64) -> i64 {
        self.0.i64(low..=high)
    }

    pub fn index(&mut self, len: usize) -> usize {
        self.0.usize(..len)
    }
}

/// Appends triangles to a scene as one more object.
pub fn append(scene: &mut Geometry, positions: &[DVec3], triangles: &[[u32; 3]]) {
    let base = scene.positions.len() as u32;
    let object = scene.object.last().map_or(0, |o| o + 1);
    scene.positions.extend_from_slice(positions);
    scene.triangles.extend(triangles.iter().map(|t| t.map(|v| v + base)));
    scene.object.extend(triangles.iter().map(|_| object));
}

pub fn scene(positions: &[DVec3], triangles: &[[u32; 3]]) -> Geometry {
    let mut scene = Geometry::default();
    append(&mut scene, positions, triangles);
    scene
}

/// Rounds to a multiple of 2^-24, so that sums and doubles of coordinates stay exact.
pub fn dyadic(p: DVec3) -> DVec3 {
    let grid = f64::from(1 << 24);
    (p * grid).round() / grid
}

/// A closed sphere of 20 * 4^levels triangles with dyadic vertices within 2^-24 of the sphere,
/// counter-clockwise seen from outside.
pub fn icosphere(levels: u32, centre: DVec3, radius: f64) -> Geometry {
    let golden = (1.0 + 5.0_f64.sqrt()) / 2.0;
    let mut points: Vec<DVec3> = Vec::new();
    for (a, b) in [(-1.0, golden), (1.0, golden), (-1.0, -golden), (1.0, -golden)] {
        points.push(DVec3::new(a, b, 0.0));
    }
    for (a, b) in [(-1.0, golden), (1.0, golden), (-1.0, -golden), (1.0, -golden)] {
        points.push(DVec3::new(0.0, a, b));
    }
    for (a, b) in [(-1.0, golden), (1.0, golden), (-1.0, -golden), (1.0, -golden)] {
        points.push(DVec3::new(b, 0.0, a));
    }
    let mut triangles: Vec<[u32; 3]> = vec![
        [0, 11, 5],
        [0, 5, 1],
        [0, 1, 7],
        [0, 7, 10],
        [0, 10, 11],
        [1, 5, 9],
        [5, 11, 4],
        [11, 10, 2],
        [10, 7, 6],
        [7, 1, 8],
        [3, 9, 4],
        [3, 4, 2],
        [3, 2, 6],
        [3, 6, 8],
        [3, 8, 9],
        [4, 9, 5],
        [2, 4, 11],
        [6, 2, 10],
        [8, 6, 7],
        [9, 8, 1],
    ];
    for _ in 0..levels {
        triangles = refined(&mut points, &triangles);
    }
    let points: Vec<_> = points.iter().map(|p| dyadic(centre + p.normalize() * radius)).collect();
    scene(&points, &triangles)
}

/// Splits every triangle into four, with shared midpoints.
fn refined(points: &mut Vec<DVec3>, triangles: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let mut middles: HashMap<(u32, u32), u32> = HashMap::new();
    let mut middle = |a: u32, b: u32, points: &mut Vec<DVec3>| {
        *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
            points.push((points[a as usize].normalize() + points[b as usize].normalize()) / 2.0);
            points.len() as u32 - 1
        })
    };
    let mut out = Vec::with_capacity(triangles.len() * 4);
    for &[a, b, c] in triangles {
        let (ab, bc, ca) = (middle(a, b, points), middle(b, c, points), middle(c, a, points));
        out.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
    }
    out
}

/// A closed cube `centre +- half` with `n * n` squares of two triangles a side; vertices of
/// neighbouring sides are separate but equal.
pub fn cube(n: u32, centre: DVec3, half: f64) -> Geometry {
    let mut scene = Geometry::default();
    for axis in 0..3 {
        for side in [-1.0, 1.0] {
            let normal = DVec3::AXES[axis] * side;
            let (u, v) = (DVec3::AXES[(axis + 1) % 3], DVec3::AXES[(axis + 2) % 3] * side);
            append_grid(&mut scene, n, |a, b| centre + (normal + u * a + v * b) * half);
        }
    }
    scene
}

/// A grid of `n * n` squares, parameters from -1 to 1.
pub fn append_grid(scene: &mut Geometry, n: u32, at: impl Fn(f64, f64) -> DVec3) {
    let parameter = |k: u32| 2.0 * f64::from(k) / f64::from(n) - 1.0;
    let points: Vec<_> = (0..=n)
        .flat_map(|j| (0..=n).map(move |i| (i, j)))
        .map(|(i, j)| at(parameter(i), parameter(j)))
        .collect();
    let corner = |i: u32, j: u32| j * (n + 1) + i;
    let triangles: Vec<_> = (0..n * n)
        .map(|k| (k % n, k / n))
        .flat_map(|(i, j)| {
            let [a, b, c, d] =
                [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
            [[a, b, c], [a, c, d]]
        })
        .collect();
    append(scene, &points, &triangles);
}

/// A floor, a sphere and a cube on it: 2 + 1280 + 12 triangles at level 3, 5120 + 14 at 4.
pub fn still_life(levels: u32) -> Geometry {
    let mut scene = Geometry::default();
    append_grid(&mut scene, 1, |x, z| DVec3::new(8.0 * x, 0.0, -8.0 * z));
    for part in [
        icosphere(levels, DVec3::new(-1.5, 1.5, 0.0), 1.25),
        cube(1, DVec3::new(2.0, 0.75, 0.5), 0.75),
    ] {
        append(&mut scene, &part.positions, &part.triangles);
    }
    scene
}

/// A point of a triangle by barycentrics, rounded to f64 as receivers are.
pub fn on_triangle(scene: &Geometry, id: u32, random: &mut Random) -> DVec3 {
    let [a, b, c] = scene.corners(id);
    let (mut u, mut v) = (random.unit(), random.unit());
    if u + v > 1.0 {
        (u, v) = (1.0 - u, 1.0 - v);
    }
    a * (1.0 - u - v) + b * u + c * v
}
