//! Light space: the plane in which all segments of one light are points.
//!
//! Point light at `L`, world point `p`, `(x, y, z) = rows (p - L)`: all points of a segment share
//! `x / z` and `y / z`, and `1 / z` grows towards the light. Directional light: rows are sideways
//! axes, `z` is 1, and the depth is the height towards the light. Both are written as homogeneous
//! vertices `(x, y, z)` with a weight `q`, such that over a triangle with barycentric (cone)
//! coordinates `b`, `(X, Y, 1) = sum b v` and the depth is `sum b q`.

use glam::DVec3;
use rayon::prelude::*;

use super::super::{LightEnd, Receiver};
use super::bins::Members;

/// A receiver farther from the axis than this many times its height does not belong to the frame.
const WIDEST: f64 = 4.0;

/// Nor does one that is farther away than this many times the size of the scene.
const FARTHEST: f64 = 1e3;

/// One projection of a light, with its grid of cells.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    origin: DVec3,
    /// World to grid: two sideways rows and the one away from the light.
    rows: [DVec3; 3],
    /// Added to the grid coordinates of a directional light.
    shift: [f64; 2],
    is_point: bool,
    /// Cells along each axis.
    pub(super) cells: usize,
    /// The largest |depth| of a directional light, 0 of a point light, whose depths are judged
    /// relatively.
    pub(super) depth_scale: f64,
    /// A homogeneous grid position is off by at most this times the world distance of the point
    /// from the origin of the frame, in the largest coordinate difference...
    pub(super) rounding: f64,
    /// ... plus this.
    pub(super) shift_rounding: f64,
}

/// A vertex in light space.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Vertex {
    /// Homogeneous grid position.
    pub(super) v: DVec3,
    /// Weight of the depth.
    pub(super) q: f64,
    /// The largest |coordinate| relative to the origin of the frame, in world units.
    pub(super) far: f64,
}

impl Frame {
    /// Frames of unit size in which receivers are points: one along `axis`, and for a point light
    /// the six along the coordinate axes for what the first does not hold.
    pub(super) fn candidates(light: LightEnd, centre: DVec3, scale: f64, axis: DVec3) -> Vec<Self> {
        let is_point = matches!(light, LightEnd::Point(_));
        let origin = if let LightEnd::Point(light) = light { light } else { centre };
        let along = |w: DVec3| {
            let (u, v) = w.any_orthonormal_pair();
            let rows = [u, v, w].map(|row| row * scale);
            Self {
                origin,
                rows,
                shift: [0.0; 2],
                is_point,
                cells: 1,
                depth_scale: 0.0,
                rounding: 0.0,
                shift_rounding: 0.0,
            }
        };
        let mut frames = vec![along(axis)];
        if is_point {
            frames.extend(DVec3::AXES.iter().flat_map(|&a| [along(a), along(-a)]));
        }
        frames
    }

    /// The direction in which a light looks at its receivers: their mean direction.
    pub(super) fn axis(light: LightEnd, receivers: &[Receiver]) -> DVec3 {
        match light {
            LightEnd::Along(vector) => (-vector).normalize_or(DVec3::NEG_Y),
            LightEnd::Point(light) => {
                let step = (receivers.len() / 4096).max(1);
                let directions = receivers.iter().step_by(step);
                let sum: DVec3 = directions.map(|r| (r.position - light).normalize_or_zero()).sum();
                sum.normalize_or(DVec3::NEG_Y)
            }
        }
    }

    /// Whether a receiver can be seen in this frame.
    #[inline(always)]
    pub(super) fn holds(&self, p_world: DVec3) -> bool {
        self.holds_vertex(&self.vertex(p_world))
    }

    #[inline(always)]
    fn holds_vertex(&self, vertex: &Vertex) -> bool {
        let Vertex { v, q, .. } = *vertex;
        let sideways = v.x.abs().max(v.y.abs());
        if self.is_point {
            v.z > 1e-12 && v.z < FARTHEST && sideways <= WIDEST * v.z
        } else {
            sideways < FARTHEST && q.abs() < FARTHEST
        }
    }

    /// The box around the places of the receivers; none unless all are held.
    pub(super) fn survey(&self, receivers: &[Receiver], members: Members) -> Option<[DVec3; 2]> {
        let nothing = || Some([DVec3::INFINITY, DVec3::NEG_INFINITY]);
        let join = |a: Option<[DVec3; 2]>, b: Option<[DVec3; 2]>| {
            let ([al, ah], [bl, bh]) = (a?, b?);
            Some([al.min(bl), ah.max(bh)])
        };
        (0..members.len())
            .into_par_iter()
            .with_min_len(1 << 16)
            .fold(nothing, |all, k| {
                let vertex = self.vertex(receivers[members.index(k)].position);
                let [low, high] = all?;
                let at = DVec3::from_array(vertex.place());
                self.holds_vertex(&vertex).then(|| [lesser(low, at), greater(high, at)])
            })
            .reduce(nothing, join)
    }

    /// The same frame with a grid of `cells * cells` over the box of its receivers.
    pub(super) fn with_grid(&self, [low, high]: [DVec3; 2], cells: usize) -> Self {
        let size = (high - low).max(DVec3::splat(1e-5));
        // A little less than the whole grid, so that rounding stays inside.
        let (sx, sy) = (cells as f64 * 0.999 / size.x, cells as f64 * 0.999 / size.y);
        let [u, v, w] = self.rows;
        let mut grid = Self { cells, ..*self };
        if self.is_point {
            grid.rows = [(u - w * low.x) * sx, (v - w * low.y) * sy, w];
        } else {
            grid.rows = [u * sx, v * sy, w];
            grid.shift = [-low.x * sx, -low.y * sy];
            grid.depth_scale = 1.0_f64.max(low.z.abs()).max(high.z.abs());
        }
        let norm = |row: DVec3| row.abs().element_sum();
        let norms = norm(grid.rows[0]).max(norm(grid.rows[1])) + cells as f64 * norm(w);
        grid.rounding = 8.0 * f64::EPSILON * norms;
        grid.shift_rounding =
            4.0 * f64::EPSILON * (grid.shift[0].abs().max(grid.shift[1].abs()) + cells as f64);
        grid
    }

    /// A world point as a homogeneous vertex.
    #[inline(always)]
    pub(super) fn vertex(&self, p_world: DVec3) -> Vertex {
        let r = p_world - self.origin;
        let [x, y, z] = self.rows.map(|row| row.dot(r));
        let far = r.abs().max_element();
        if self.is_point {
            Vertex { v: DVec3::new(x, y, z), q: 1.0, far }
        } else {
            Vertex { v: DVec3::new(x + self.shift[0], y + self.shift[1], 1.0), q: -z, far }
        }
    }

    /// Grid position and depth of a world point in front of the light.
    #[inline(always)]
    pub(super) fn place(&self, p_world: DVec3) -> [f64; 3] {
        self.vertex(p_world).place()
    }

    /// Above this depth a candidate's order along the segment is not judged by depth: the error of
    /// a position `t` near the light is not small against `1 - t`.
    #[inline(always)]
    pub(super) fn order_limit(&self, receiver_depth: f32) -> f32 {
        if self.is_point { 64.0 * receiver_depth } else { f32::INFINITY }
    }
}

impl Vertex {
    /// Grid position and depth.
    #[inline(always)]
    pub(super) fn place(&self) -> [f64; 3] {
        let inverse = 1.0 / self.v.z;
        [self.v.x * inverse, self.v.y * inverse, self.q * inverse]
    }
}

/// The lesser coordinates, in one instruction each: `DVec3::min` also looks for NaN.
#[inline(always)]
fn lesser(a: DVec3, b: DVec3) -> DVec3 {
    let pick = |a: f64, b: f64| if a < b { a } else { b };
    DVec3::new(pick(a.x, b.x), pick(a.y, b.y), pick(a.z, b.z))
}

#[inline(always)]
fn greater(a: DVec3, b: DVec3) -> DVec3 {
    -lesser(-a, -b)
}
