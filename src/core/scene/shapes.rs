//! Meshes that scenes are made of, in f32, vertex for vertex as the documents' programs make them.

use glam::{DVec3, Vec2, Vec3};

/// An indexed triangle mesh in its own space.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Vertex positions, f32 as uploaded.
    pub positions: Vec<Vec3>,
    /// The positions that these are rounded from, which truth goes by; empty where they are exact.
    pub exact: Vec<DVec3>,
    /// A normal for each vertex, as the file or the program gives it; empty where there are none.
    pub normals: Vec<Vec3>,
    /// Texture coordinates for each vertex, of the set that an alpha mask uses; empty where there are none.
    pub uvs: Vec<Vec2>,
    /// Counter-clockwise triangles.
    pub triangles: Vec<[u32; 3]>,
    /// A colour for each vertex, or one for all; linear RGB in [0, 1].
    pub colours: Vec<Vec3>,
    /// Whether shading interpolates normals across shared vertices.
    pub smooth: bool,
}

impl Mesh {
    /// A mesh of one colour.
    #[must_use]
    pub fn new(positions: Vec<Vec3>, triangles: Vec<[u32; 3]>, colour: Vec3) -> Self {
        Self { positions, triangles, colours: vec![colour], ..Self::default() }
    }

    /// Vertex `v` as the file gives it, in f64; the origin beyond the last.
    #[must_use]
    pub fn at(&self, v: usize) -> DVec3 {
        let rounded = || self.positions.get(v).map(|p| p.as_dvec3());
        self.exact.get(v).copied().or_else(rounded).unwrap_or_default()
    }

    /// The colour of vertex `v`.
    #[must_use]
    pub fn colour(&self, v: u32) -> Vec3 {
        *self.colours.get(v as usize).or(self.colours.first()).unwrap_or(&Vec3::ONE)
    }
}

/// Two triangles (0,1,2) and (0,2,3) over four corners given in order.
#[must_use]
pub fn quad(corners: [Vec3; 4], colour: Vec3) -> Mesh {
    Mesh::new(corners.to_vec(), vec![[0, 1, 2], [0, 2, 3]], colour)
}

/// A square of side `size` at y = 0, as one cell of a grid: corners row by row from −z.
#[must_use]
pub fn floor(size: f32, colour: Vec3) -> Mesh {
    let h = size / 2.0;
    let at = |x: f32, z: f32| Vec3::new(x, 0.0, z);
    Mesh::new(vec![at(-h, -h), at(h, -h), at(-h, h), at(h, h)], vec![[0, 2, 1], [2, 3, 1]], colour)
}

/// A sphere of `around` × `down` cells: rings from the north pole, the first column repeated at the
/// seam, polar cells left as two triangles (one of them without area).
#[must_use]
pub fn sphere(radius: f64, around: u32, down: u32, colour: Vec3) -> Mesh {
    let turn = 2.0 * std::f64::consts::PI;
    let mut positions = Vec::new();
    for y in 0..=down {
        for x in 0..=around {
            let theta = turn * (f64::from(x) / f64::from(around));
            let phi = std::f64::consts::PI * (f64::from(y) / f64::from(down));
            let ring = libm::sin(phi);
            let unit = [libm::cos(theta) * ring, libm::cos(phi), libm::sin(theta) * ring];
            positions.push(Vec3::from_array(unit.map(|c| (radius * c) as f32)));
        }
    }
    let mut triangles = Vec::new();
    for y in 0..down {
        for x in 0..around {
            let here = y * (around + 1) + x;
            let below = here + around + 1;
            triangles.push([here, here + 1, below]);
            triangles.push([below, here + 1, below + 1]);
        }
    }
    Mesh { smooth: true, ..Mesh::new(positions, triangles, colour) }
}

/// A cube of side `size` with four vertices of its own on each face.
#[must_use]
pub fn cube(size: f32, colour: Vec3) -> Mesh {
    const FACES: [[usize; 4]; 6] =
        [[1, 3, 7, 5], [0, 4, 6, 2], [2, 6, 7, 3], [0, 1, 5, 4], [4, 5, 7, 6], [0, 2, 3, 1]];
    let h = size / 2.0;
    let corner = |i: usize| {
        let sign = |bit: usize| if i & bit == 0 { -h } else { h };
        Vec3::new(sign(1), sign(2), sign(4))
    };
    cuboid_faces(corner, FACES, colour)
}

/// An axis-aligned box between two corners.
#[must_use]
pub fn cuboid(low: Vec3, high: Vec3, colour: Vec3) -> Mesh {
    let mut mesh = cube(2.0, colour);
    for p in &mut mesh.positions {
        *p = Vec3::select(p.cmpgt(Vec3::ZERO), high, low);
    }
    mesh
}

fn cuboid_faces(corner: impl Fn(usize) -> Vec3, faces: [[usize; 4]; 6], colour: Vec3) -> Mesh {
    let mut mesh = Mesh::new(Vec::new(), Vec::new(), colour);
    for face in faces {
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(face.map(&corner));
        mesh.triangles.push([first, first + 1, first + 2]);
        mesh.triangles.push([first, first + 2, first + 3]);
    }
    mesh
}
