//! Planes of triangles in light space, with error bounds.
#![allow(clippy::needless_range_loop, reason = "loops over indices become vectors")]

use glam::DVec3;

use super::frame::Frame;
use super::vertices::Item;
use crate::simd::lanes::{BATCH, Lanes};

/// Half an ulp of 1 in f32.
const U32: f64 = f32::EPSILON as f64 / 2.0;
/// Triangles on their way to planes, structure of arrays.
#[derive(Debug)]
pub(super) struct Batch {
    pub(super) len: usize,
    pub(super) ids: [u32; BATCH],
    /// World positions.
    corners: [[Lanes; 3]; 3],
    middle: [[f64; BATCH]; 2],
    reach: [f64; BATCH],
}

/// Affine functions of the position relative to `origin`, in f32 and in units of their own error
/// bound: below -1 the exact value is negative, above 1 it is positive, for every receiver of the
/// item's runs. All are 0 where the area is lost in the rounding of the vertices: then every
/// receiver of the runs is a candidate.
#[derive(Clone, Copy, Debug)]
pub(super) struct Planes {
    /// Middle of the item.
    origin: [[f32; BATCH]; 2],
    /// `a dx + b dy + c`, positive inside.
    edges: [[[f32; BATCH]; 3]; 3],
    /// Depth of the plane, and the factor of the receiver's depth to subtract.
    depth: [[f32; BATCH]; 3],
    per_depth: [f32; BATCH],
    /// The error bound of the depth.
    depth_error: [f32; BATCH],
}

/// One triangle of [`Planes`].
#[derive(Clone, Copy, Debug)]
pub(super) struct Plane {
    pub(super) origin: [f32; 2],
    pub(super) edges: [[f32; 3]; 3],
    pub(super) depth: [f32; 3],
    pub(super) per_depth: f32,
    pub(super) depth_error: f32,
}

impl Planes {
    #[inline(always)]
    pub(super) fn get(&self, k: usize) -> Plane {
        Plane {
            origin: [self.origin[0][k], self.origin[1][k]],
            edges: [at(&self.edges[0], k), at(&self.edges[1], k), at(&self.edges[2], k)],
            depth: at(&self.depth, k),
            per_depth: self.per_depth[k],
            depth_error: self.depth_error[k],
        }
    }
}

impl Batch {
    pub(super) const EMPTY: Self = Self {
        len: 0,
        ids: [0; BATCH],
        corners: [[Lanes([0.0; BATCH]); 3]; 3],
        middle: [[0.0; BATCH]; 2],
        reach: [0.0; BATCH],
    };

    /// Adds a triangle with these corners.
    #[inline(always)]
    pub(super) fn push(&mut self, id: u32, corners: [DVec3; 3], item: &Item) {
        let k = self.len;
        let ([left, right], [bottom, top]) = (item.columns, item.rows);
        let high = f64::from(top - bottom) + 1.0;
        self.ids[k] = id;
        self.middle[0][k] = f64::from((left + right) / 2.0);
        self.middle[1][k] = f64::from(bottom) + high / 2.0;
        // A run begins and ends less than a unit beside the triangle.
        self.reach[k] = high.max(f64::from(right - left)) / 2.0 + 1.25;
        for corner in 0..3 {
            let [x, y, z] = &mut self.corners[corner];
            (x.0[k], y.0[k], z.0[k]) = corners[corner].into();
        }
        self.len += 1;
    }

    /// The planes of all triangles.
    #[inline(always)]
    pub(super) fn planes(&self, frame: &Frame) -> Planes {
        let middle = [Lanes(self.middle[0]), Lanes(self.middle[1])];
        // Relative to the middle of the item, so that small triangles keep their digits.
        let [a, b, c] = &self.corners;
        let [a, b, c] = [frame.eight(a), frame.eight(b), frame.eight(c)];
        let v = [beside(&a.v, middle), beside(&b.v, middle), beside(&c.v, middle)];
        let far = a.far.max(b.far).max(c.far);
        let e = [cross(v[1], v[2]), cross(v[2], v[0]), cross(v[0], v[1])];
        let det = v[0][0] * e[0][0] + v[0][1] * e[0][1] + v[0][2] * e[0][2];
        let bounds = Bounds::new(&v, far, Lanes(self.reach), frame);
        let decided = det.abs().exceeds(bounds.area * 4.0);
        let side = decided * det.signum();
        let edges = [bounds.edge(e[0], side), bounds.edge(e[1], side), bounds.edge(e[2], side)];
        let inverse = (det + (Lanes::splat(1.0) - decided)).recip();
        let q = [a.q, b.q, c.q];
        let depth = [
            (e[0][0] * q[0] + e[1][0] * q[1] + e[2][0] * q[2]) * inverse,
            (e[0][1] * q[0] + e[1][1] * q[1] + e[2][1] * q[2]) * inverse,
            (e[0][2] * q[0] + e[1][2] * q[1] + e[2][2] * q[2]) * inverse,
        ];
        let weight = q[0].abs().max(q[1].abs()).max(q[2].abs());
        let error = bounds.depth(depth, weight, inverse.abs(), frame.depth_scale);
        let unit = decided * (error + Lanes::splat(1e-300)).recip();
        Planes {
            origin: [middle[0].narrow(), middle[1].narrow()],
            edges,
            depth: scaled(depth, unit),
            per_depth: unit.narrow(),
            depth_error: (error * 1.001).narrow(),
        }
    }
}

/// What bounds the errors of planes.
struct Bounds {
    /// The receiver's f32 position, the subtraction of the origin and the f32 sums.
    place: Lanes,
    reach: Lanes,
    /// An edge is off by the rounding of its vertices times their size.
    rough: Lanes,
    /// The error of the determinant.
    area: Lanes,
}

impl Bounds {
    #[inline(always)]
    fn new(v: &[[Lanes; 3]; 3], far: Lanes, reach: Lanes, frame: &Frame) -> Self {
        let height = largest(v, 2);
        let size = largest(v, 0).max(largest(v, 1)).max(height);
        let vertex_error = far * frame.rounding + Lanes::splat(frame.shift_rounding);
        let rough = vertex_error * size * (reach + Lanes::splat(1.0)) * 4.0;
        let cells = Lanes::splat(1.5 * frame.cells as f64);
        Self { place: (cells + reach * 8.0) * U32, reach, rough, area: rough * height * 4.0 }
    }

    /// An edge in units of its error, times `side`.
    #[inline(always)]
    fn edge(&self, e: [Lanes; 3], side: Lanes) -> [[f32; BATCH]; 3] {
        let slope = e[0].abs() + e[1].abs();
        let error = slope * self.place + e[2].abs() * (4.0 * U32) + self.rough;
        let unit = side * (error + Lanes::splat(1e-300)).recip();
        scaled(e, unit)
    }

    /// The error of the depth of a plane.
    #[inline(always)]
    fn depth(&self, depth: [Lanes; 3], weight: Lanes, inverse: Lanes, scale: f64) -> Lanes {
        let slope = depth[0].abs() + depth[1].abs();
        let size = depth[2].abs();
        slope * self.place
            + (size + Lanes::splat(scale)) * (8.0 * U32)
            + weight * self.rough * inverse * 4.0
            + self.area * inverse * (size + slope * self.reach)
    }
}

/// One triangle's share of three numbers.
#[inline(always)]
fn at(values: &[[f32; BATCH]; 3], k: usize) -> [f32; 3] {
    [values[0][k], values[1][k], values[2][k]]
}

#[inline(always)]
fn scaled(plane: [Lanes; 3], unit: Lanes) -> [[f32; BATCH]; 3] {
    [(plane[0] * unit).narrow(), (plane[1] * unit).narrow(), (plane[2] * unit).narrow()]
}

/// A vertex relative to the middle of the item.
#[inline(always)]
fn beside([x, y, z]: &[Lanes; 3], middle: [Lanes; 2]) -> [Lanes; 3] {
    [*x - middle[0] * *z, *y - middle[1] * *z, *z]
}

/// The largest magnitude of a coordinate.
#[inline(always)]
fn largest(v: &[[Lanes; 3]; 3], axis: usize) -> Lanes {
    v[0][axis].abs().max(v[1][axis].abs()).max(v[2][axis].abs())
}
#[inline(always)]
fn cross(a: [Lanes; 3], b: [Lanes; 3]) -> [Lanes; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
