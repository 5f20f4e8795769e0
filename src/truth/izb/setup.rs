//! Triangles in light space: which cells they may shadow, and their planes with error bounds.

use glam::DVec3;
use rayon::prelude::*;

use super::bins::{BLOCK, Bins};
use super::frame::{Frame, Vertex};
use crate::scene::Geometry;

/// Half an ulp of 1 in f32.
const U32: f64 = f32::EPSILON as f64 / 2.0;

/// A triangle and the cells that it may shadow, both ends included.
#[derive(Clone, Copy, Debug)]
pub(super) struct Item {
    pub(super) id: u32,
    pub(super) columns: [u16; 2],
    pub(super) rows: [u16; 2],
}

/// Affine functions of the position relative to `origin`, in f32 and in units of their own error
/// bound: below -1 the exact value is negative, above 1 it is positive, for every receiver of the
/// item's cells.
#[derive(Clone, Copy, Debug)]
pub(super) struct Planes {
    pub(super) origin: [f32; 2],
    /// The three edges, positive inside: `a dx + b dy + c`.
    pub(super) edges: [[f32; 3]; 3],
    /// Depth of the plane, and the factor of the receiver's depth to subtract.
    pub(super) depth: [f32; 3],
    pub(super) per_depth: f32,
    /// The error bound of the depth; infinite where nothing is decided.
    pub(super) depth_error: f32,
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
        geometry
            .positions
            .par_iter()
            .with_min_len(4096)
            .map(|&p| {
                let vertex = frame.vertex(p);
                (vertex, on_screen(&vertex))
            })
            .unzip_into_vecs(&mut exact, &mut screen);
        Self { exact, screen }
    }

    /// The triangles that can shadow a receiver, in order of their ids.
    ///
    /// Left out is a triangle whose cells hold no receiver, and one that is farther from the light
    /// than the farthest receiver of its blocks: depth over a triangle is largest at a corner.
    pub(super) fn items(&self, geometry: &Geometry, bins: &Bins) -> Vec<Item> {
        let item = |(id, corners): (usize, &[u32; 3])| self.item(id as u32, *corners, bins);
        geometry.triangles.par_iter().enumerate().with_min_len(4096).filter_map(item).collect()
    }

    #[inline]
    fn item(&self, id: u32, corners: [u32; 3], bins: &Bins) -> Option<Item> {
        let [a, b, c] = corners.map(|v| self.screen[v as usize]);
        let low = [0, 1].map(|k| a[k].min(b[k]).min(c[k]));
        let high = [0, 1].map(|k| a[k].max(b[k]).max(c[k]));
        let nearest = a[2].max(b[2]).max(c[2]);
        if (a[2] + b[2] + c[2]).is_nan() {
            let (low, high) = self.clipped(corners, bins.cells as f64)?;
            return shadowing(id, cells(low, high, bins.cells)?, f32::INFINITY, bins);
        }
        shadowing(id, cells(low, high, bins.cells)?, nearest, bins)
    }

    /// Bounds on the grid of a triangle that reaches behind the light: it is clipped to the
    /// pyramid over the grid (one cell wider), whose sides leave nothing behind the light.
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

    /// The planes of a triangle over the cells of its item.
    #[inline(always)]
    pub(super) fn planes(&self, corners: [u32; 3], item: &Item, frame: &Frame) -> Planes {
        let span = |[a, b]: [u16; 2]| (f64::from(a) + f64::from(b) + 1.0) / 2.0;
        let middle = [span(item.columns), span(item.rows)];
        let wide = (item.columns[1] - item.columns[0]).max(item.rows[1] - item.rows[0]);
        let reach = f64::from(wide) / 2.0 + 1.0;
        let [a, b, c] = corners.map(|v| self.exact[v as usize]);
        // Relative to the middle of the cells, so that small triangles keep their digits.
        let local =
            |p: &Vertex| DVec3::new(p.v.x - middle[0] * p.v.z, p.v.y - middle[1] * p.v.z, p.v.z);
        let v = [local(&a), local(&b), local(&c)];
        let e = [v[1].cross(v[2]), v[2].cross(v[0]), v[0].cross(v[1])];
        let det = v[0].dot(e[0]);
        let far = a.far.max(b.far).max(c.far);
        let size = v[0].abs().max(v[1].abs()).max(v[2].abs());
        let vertex_error = frame.rounding * far + frame.shift_rounding;
        // An edge is off by the rounding of its vertices times their size.
        let rough = 4.0 * vertex_error * size.max_element() * (1.0 + reach);
        let ray = Bounds {
            // The receiver's f32 position, the subtraction of the origin and the f32 sums.
            place: U32 * (1.5 * frame.cells as f64 + 8.0 * reach),
            reach,
            rough,
            area: 4.0 * rough * size.z,
        };
        let origin = middle.map(|x| x as f32);
        if det.abs() <= 4.0 * ray.area {
            return Planes { origin, ..Planes::UNDECIDED };
        }
        let weighted = e[0] * a.q + e[1] * b.q + e[2] * c.q;
        let weight = a.q.abs().max(b.q.abs()).max(c.q.abs());
        let edges = e.map(|e| ray.edge(if det < 0.0 { -e } else { e }));
        ray.planes(origin, edges, weighted / det, 1.0 / det.abs(), weight, frame.depth_scale)
    }
}

/// What bounds the errors of the planes of one triangle.
struct Bounds {
    place: f64,
    reach: f64,
    rough: f64,
    area: f64,
}

impl Bounds {
    /// An edge in units of its error.
    #[inline(always)]
    fn edge(&self, e: DVec3) -> [f32; 3] {
        let error = (e.x.abs() + e.y.abs()) * self.place + 4.0 * U32 * e.z.abs() + self.rough;
        let unit = 1.0 / (error + 1e-300);
        [(e.x * unit) as f32, (e.y * unit) as f32, (e.z * unit) as f32]
    }

    /// The planes with the depth in units of its error.
    #[inline(always)]
    fn planes(
        &self,
        origin: [f32; 2],
        edges: [[f32; 3]; 3],
        depth: DVec3,
        inverse: f64,
        weight: f64,
        scale: f64,
    ) -> Planes {
        let slope = depth.x.abs() + depth.y.abs();
        let error = slope * self.place
            + 8.0 * U32 * (depth.z.abs() + scale)
            + 4.0 * weight * self.rough * inverse
            + self.area * inverse * (depth.z.abs() + slope * self.reach);
        let unit = 1.0 / error;
        Planes {
            origin,
            edges,
            depth: [depth.x * unit, depth.y * unit, depth.z * unit].map(|x| x as f32),
            per_depth: unit as f32,
            depth_error: (error * 1.001) as f32,
        }
    }
}

impl Planes {
    /// Every receiver of the cells is a candidate: the area is lost in the rounding of the
    /// vertices.
    const UNDECIDED: Self = Self {
        origin: [0.0; 2],
        edges: [[0.0; 3]; 3],
        depth: [0.0; 3],
        per_depth: 0.0,
        depth_error: f32::INFINITY,
    };
}

/// Grid position and depth, NaN within a thousandth of the plane of the light or behind it.
#[inline(always)]
fn on_screen(vertex: &Vertex) -> [f32; 3] {
    let Vertex { v, q, .. } = *vertex;
    let at = [v.x / v.z, v.y / v.z, q / v.z];
    let far = at[0].abs().max(at[1].abs()) < 1e6;
    if v.z > 0.0 && far { [at[0] as f32, at[1] as f32, at[2] as f32] } else { [f32::NAN; 3] }
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
fn shadowing(id: u32, [columns, rows]: [[u16; 2]; 2], nearest: f32, bins: &Bins) -> Option<Item> {
    let block = |x: u16| usize::from(x) / BLOCK;
    let mut farthest = f32::INFINITY;
    for row in block(rows[0])..=block(rows[1]) {
        let base = row * bins.blocks();
        let run = &bins.farthest[base + block(columns[0])..=base + block(columns[1])];
        farthest = run.iter().fold(farthest, |m, &x| m.min(x));
    }
    let margin = 1e-5 * (nearest.abs() + farthest.abs()) + 1e-9;
    let shadows = farthest < f32::INFINITY && nearest + margin >= farthest;
    shadows.then_some(Item { id, columns, rows })
}
