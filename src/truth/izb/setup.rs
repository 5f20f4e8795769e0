//! Triangles in light space: which cells they may shadow, and their planes with error bounds.

use glam::DVec3;
use rayon::prelude::*;

use super::bins::{BLOCK, Bins};
use super::frame::{Frame, Vertex};
use super::work::{Skipped, Skips};
use crate::scene::Geometry;
use crate::simd::lanes::{BATCH, Lanes};

/// Half an ulp of 1 in f32.
const U32: f64 = f32::EPSILON as f64 / 2.0;

/// A triangle and the cells that it may shadow, both ends included.
#[derive(Clone, Copy, Debug)]
pub(super) struct Item {
    pub(super) columns: [u16; 2],
    pub(super) rows: [u16; 2],
}

/// Light-space vertices, and their grid positions and depths in f32 (NaN where a vertex is behind
/// the light or nearly so).
#[derive(Debug)]
pub(super) struct Vertices {
    exact: Vec<Vertex>,
    screen: Vec<[f32; 3]>,
}

impl Vertices {
    pub(super) fn new(frame: &Frame, geometry: &Geometry) -> Self {
        let (mut exact, mut screen) = (Vec::new(), Vec::new());
        let place = |&p: &DVec3| {
            let vertex = frame.vertex(p);
            (vertex, on_screen(&vertex))
        };
        let vertices = geometry.positions.par_iter().with_min_len(4096).map(place);
        vertices.unzip_into_vecs(&mut exact, &mut screen);
        Self { exact, screen }
    }

    /// The cells that a triangle may shadow, or why there are none.
    ///
    /// Left out is a triangle whose cells hold no receiver, and one that is farther from the light
    /// than the farthest receiver of its blocks: depth over a triangle is largest at a corner.
    #[inline(always)]
    pub(super) fn item(
        &self,
        corners: [u32; 3],
        bins: &Bins,
        skips: Skips,
    ) -> Result<Item, Skipped> {
        let [a, b, c] = corners;
        let (a, b, c) = (self.screen[a as usize], self.screen[b as usize], self.screen[c as usize]);
        let low = [lesser(a[0], lesser(b[0], c[0])), lesser(a[1], lesser(b[1], c[1]))];
        let high = [greater(a[0], greater(b[0], c[0])), greater(a[1], greater(b[1], c[1]))];
        let nearest = greater(a[2], greater(b[2], c[2]));
        let (bounds, nearest) = if (a[2] + b[2] + c[2]).is_nan() {
            (self.clipped(corners, bins.cells as f64), f32::INFINITY)
        } else {
            (Some((low, high)), nearest)
        };
        let cells = bounds.and_then(|(low, high)| cells(low, high, bins.cells));
        shadowing(cells.ok_or(Skipped::Outside)?, nearest, bins, skips)
    }

    /// Bounds on the grid of a triangle that reaches behind the light: it is clipped to the
    /// pyramid over the grid (one cell wider), whose sides leave nothing behind the light.
    #[cold]
    #[inline(never)]
    fn clipped(&self, corners: [u32; 3], cells: f64) -> Option<([f32; 2], [f32; 2])> {
        let corners = corners.map(|v| self.exact[v as usize].v);
        let everywhere = Some(([0.0; 2], [cells as f32; 2]));
        if may_hold_light(corners) {
            return everywhere;
        }
        let mut polygon = corners.to_vec();
        let sides = [
            DVec3::new(1.0, 0.0, 1.0),
            DVec3::new(-1.0, 0.0, cells + 1.0),
            DVec3::new(0.0, 1.0, 1.0),
            DVec3::new(0.0, -1.0, cells + 1.0),
        ];
        for side in sides {
            polygon = clip(&polygon, side);
        }
        let size = polygon.iter().fold(0.0, |m: f64, v| m.max(v.abs().max_element()));
        if polygon.iter().any(|v| v.z <= size * 1e-9) {
            return everywhere;
        }
        let (mut low, mut high) = ([f32::INFINITY; 2], [f32::NEG_INFINITY; 2]);
        for v in &polygon {
            let at = [(v.x / v.z) as f32, (v.y / v.z) as f32];
            (low, high) = ([0, 1].map(|k| low[k].min(at[k])), [0, 1].map(|k| high[k].max(at[k])));
        }
        (!polygon.is_empty()).then_some((low, high))
    }

    /// Adds a triangle to a batch.
    #[inline(always)]
    pub(super) fn load(&self, batch: &mut Batch, id: u32, corners: [u32; 3], item: Item) {
        let k = batch.len;
        let middle = |[a, b]: [u16; 2]| (f64::from(a) + f64::from(b) + 1.0) / 2.0;
        let wide = (item.columns[1] - item.columns[0]).max(item.rows[1] - item.rows[0]);
        (batch.ids[k], batch.items[k]) = (id, item);
        (batch.middle[0][k], batch.middle[1][k]) = (middle(item.columns), middle(item.rows));
        batch.reach[k] = f64::from(wide) / 2.0 + 1.0;
        let [a, b, c] = corners;
        let vertices = [&self.exact[a as usize], &self.exact[b as usize], &self.exact[c as usize]];
        batch.far[k] = vertices[0].far.max(vertices[1].far).max(vertices[2].far);
        for (corner, vertex) in vertices.iter().enumerate() {
            for axis in 0..3 {
                batch.corners[corner][axis][k] = vertex.v[axis];
            }
            batch.weights[corner][k] = vertex.q;
        }
        batch.len += 1;
    }
}

/// Triangles on their way to planes, structure of arrays.
#[derive(Debug)]
pub(super) struct Batch {
    pub(super) len: usize,
    pub(super) ids: [u32; BATCH],
    pub(super) items: [Item; BATCH],
    corners: [[[f64; BATCH]; 3]; 3],
    weights: [[f64; BATCH]; 3],
    far: [f64; BATCH],
    middle: [[f64; BATCH]; 2],
    reach: [f64; BATCH],
}

/// Affine functions of the position relative to `origin`, in f32 and in units of their own error
/// bound: below -1 the exact value is negative, above 1 it is positive, for every receiver of the
/// item's cells. All are 0 where the area is lost in the rounding of the vertices: then every
/// receiver of the cells is a candidate.
#[derive(Clone, Copy, Debug)]
pub(super) struct Planes {
    /// Middle of the cells.
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
        items: [Item { columns: [0; 2], rows: [0; 2] }; BATCH],
        corners: [[[0.0; BATCH]; 3]; 3],
        weights: [[0.0; BATCH]; 3],
        far: [0.0; BATCH],
        middle: [[0.0; BATCH]; 2],
        reach: [0.0; BATCH],
    };

    /// The planes of all triangles.
    #[inline(always)]
    pub(super) fn planes(&self, frame: &Frame) -> Planes {
        let middle = [Lanes(self.middle[0]), Lanes(self.middle[1])];
        // Relative to the middle of the cells, so that small triangles keep their digits.
        let v = [
            beside(&self.corners[0], middle),
            beside(&self.corners[1], middle),
            beside(&self.corners[2], middle),
        ];
        let e = [cross(v[1], v[2]), cross(v[2], v[0]), cross(v[0], v[1])];
        let det = v[0][0] * e[0][0] + v[0][1] * e[0][1] + v[0][2] * e[0][2];
        let bounds = Bounds::new(&v, Lanes(self.far), Lanes(self.reach), frame);
        let decided = det.abs().exceeds(bounds.area * 4.0);
        let side = decided * det.signum();
        let edges = [bounds.edge(e[0], side), bounds.edge(e[1], side), bounds.edge(e[2], side)];
        let inverse = (det + (Lanes::splat(1.0) - decided)).recip();
        let q = [Lanes(self.weights[0]), Lanes(self.weights[1]), Lanes(self.weights[2])];
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

/// A vertex relative to the middle of the cells.
#[inline(always)]
fn beside(corner: &[[f64; BATCH]; 3], middle: [Lanes; 2]) -> [Lanes; 3] {
    let z = Lanes(corner[2]);
    [Lanes(corner[0]) - middle[0] * z, Lanes(corner[1]) - middle[1] * z, z]
}

/// The largest magnitude of a coordinate.
#[inline(always)]
fn largest(v: &[[Lanes; 3]; 3], axis: usize) -> Lanes {
    v[0][axis].abs().max(v[1][axis].abs()).max(v[2][axis].abs())
}

/// The lesser of two numbers, in one instruction: `f32::min` also looks for NaN.
#[inline(always)]
fn lesser(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

#[inline(always)]
fn greater(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

#[inline(always)]
fn cross(a: [Lanes; 3], b: [Lanes; 3]) -> [Lanes; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Grid position and depth; NaN behind the light, or nearly beside it.
#[inline(always)]
fn on_screen(vertex: &Vertex) -> [f32; 3] {
    let at = vertex.place();
    let near_axis = at[0].abs() < 1e6 && at[1].abs() < 1e6;
    if vertex.v.z > 0.0 && near_axis { at.map(|x| x as f32) } else { [f32::NAN; 3] }
}

/// Whether the box of a triangle reaches to the light: then every segment may end on it.
fn may_hold_light([a, b, c]: [DVec3; 3]) -> bool {
    let (low, high) = (a.min(b).min(c), a.max(b).max(c));
    let pad = low.abs().max(high.abs()) * 1e-9;
    (low - pad).max_element() <= 0.0 && (high + pad).min_element() >= 0.0
}

/// The part of a polygon on the positive side of a plane through the light.
fn clip(polygon: &[DVec3], side: DVec3) -> Vec<DVec3> {
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (k, &v) in polygon.iter().enumerate() {
        let next = polygon[(k + 1) % polygon.len()];
        let (here, there) = (side.dot(v), side.dot(next));
        if here >= 0.0 {
            kept.push(v);
        }
        if (here > 0.0 && there < 0.0) || (here < 0.0 && there > 0.0) {
            kept.push(v + (next - v) * (here / (here - there)));
        }
    }
    kept
}

/// The cells that bounds touch, widened by the rounding of f32 positions.
#[inline(always)]
fn cells(low: [f32; 2], high: [f32; 2], cells: usize) -> Option<[[u16; 2]; 2]> {
    let pad = |x: f32| 1.0 / 1024.0 + x.abs() * (1.0 / 2_097_152.0);
    let last = cells as f32 - 1.0;
    let range = |k: usize| {
        let (first, end) = (low[k] - pad(low[k]), high[k] + pad(high[k]));
        let inside = end >= 0.0 && first < cells as f32;
        inside.then(|| [first.clamp(0.0, last) as u16, end.clamp(0.0, last) as u16])
    };
    Some([range(0)?, range(1)?])
}

/// The item, unless every receiver of its cells is nearer to the light, or there is none.
#[inline(always)]
fn shadowing(
    [columns, rows]: [[u16; 2]; 2],
    nearest: f32,
    bins: &Bins,
    skips: Skips,
) -> Result<Item, Skipped> {
    let block = |x: u16| usize::from(x) / BLOCK;
    let mut farthest = f32::INFINITY;
    for row in block(rows[0])..=block(rows[1]) {
        let base = row * bins.blocks();
        let run = &bins.farthest[base + block(columns[0])..=base + block(columns[1])];
        farthest = run.iter().fold(farthest, |m, &x| lesser(m, x));
    }
    let (left, right) = (usize::from(columns[0]), usize::from(columns[1]) + 1);
    let full = |row: u16| !bins.run(usize::from(row), left, right).is_empty();
    if skips.empty && (farthest == f32::INFINITY || !(rows[0]..=rows[1]).any(full)) {
        return Err(Skipped::Empty);
    }
    let margin = 1e-5 * (nearest.abs() + farthest.abs()) + 1e-9;
    if skips.behind && nearest + margin < farthest {
        return Err(Skipped::Behind);
    }
    Ok(Item { columns, rows })
}
