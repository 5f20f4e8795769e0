//! Light space: the plane in which all segments of one light are points.
//!
//! Point light at `L`, world point `p`, `(x, y, z) = rows (p - L)`: all points of a segment share
//! `x / z` and `y / z`, and `1 / z` grows towards the light. Directional light: rows are sideways
//! axes, `z` is 1, and the depth is the height towards the light. Both are written as homogeneous
//! vertices `(x, y, z)` with a weight `q`, such that over a triangle with barycentric (cone)
//! coordinates `b`, `(X, Y, 1) = sum b v` and the depth is `sum b q`.

#![allow(clippy::needless_range_loop, reason = "loops over indices become vectors")]

use std::ops::Range;

use glam::DVec3;
use rayon::prelude::*;

use super::super::{LightEnd, Receiver};
use super::members::Members;
use crate::simd::lanes::{BATCH, Lanes};
use crate::simd::{Kernel, Level};

/// A receiver farther from the axis than this many times its height does not belong to the frame.
const WIDEST: f64 = 4.0;

/// Nor does one that is farther away than this many times the size of the scene.
const FARTHEST: f64 = 1e3;

/// By so many cells rounding may place a receiver beside the grid: less than a triangle is padded.
const BESIDE: f64 = 1e-4;

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
        let Vertex { v, q } = *vertex;
        let sideways = v.x.abs().max(v.y.abs());
        if self.is_point {
            is_deep(v.z) && sideways <= WIDEST * v.z
        } else {
            sideways <= FARTHEST && q.abs() < FARTHEST
        }
    }

    /// The box around the places of the receivers; none unless all are held.
    pub(super) fn survey(
        &self,
        receivers: &[Receiver],
        members: Members,
        level: Level,
    ) -> Option<[DVec3; 2]> {
        const RUN: usize = 1 << 16;
        let nothing = || Some([DVec3::INFINITY, DVec3::NEG_INFINITY]);
        let join = |a: Option<[DVec3; 2]>, b: Option<[DVec3; 2]>| {
            let ([al, ah], [bl, bh]) = (a?, b?);
            Some([al.min(bl), ah.max(bh)])
        };
        let one = |run: usize| {
            let range = run * RUN..((run + 1) * RUN).min(members.len());
            level.run(Survey { frame: self, receivers, members, range })
        };
        (0..members.len().div_ceil(RUN)).into_par_iter().map(one).reduce(nothing, join)
    }

    /// This frame with a grid of `cells * cells` over the box of its receivers.
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
        if self.is_point {
            Vertex { v: DVec3::new(x, y, z), q: 1.0 }
        } else {
            Vertex { v: DVec3::new(x + self.shift[0], y + self.shift[1], 1.0), q: -z }
        }
    }

    /// Eight world points as homogeneous vertices: lane by lane what [`Self::vertex`] gives.
    #[inline(always)]
    pub(super) fn eight(&self, p_world: &[Lanes; 3]) -> Eight {
        let r = [
            p_world[0] - Lanes::splat(self.origin.x),
            p_world[1] - Lanes::splat(self.origin.y),
            p_world[2] - Lanes::splat(self.origin.z),
        ];
        let far = r[0].abs().max(r[1].abs()).max(r[2].abs());
        let (x, y, z) = (along(self.rows[0], &r), along(self.rows[1], &r), along(self.rows[2], &r));
        if self.is_point {
            return Eight { v: [x, y, z], q: Lanes::splat(1.0), far };
        }
        let (x, y) = (x + Lanes::splat(self.shift[0]), y + Lanes::splat(self.shift[1]));
        Eight { v: [x, y, Lanes::splat(1.0)], q: z * -1.0, far }
    }

    /// Whether all of eight receivers can be seen in this frame, as [`Self::holds`] tells.
    #[inline(always)]
    fn holds_eight(&self, eight: &Eight) -> bool {
        let Eight { v: [x, y, z], q, .. } = eight;
        let mut holds = true;
        for k in 0..BATCH {
            let (x, y, z) = (x.0[k].abs(), y.0[k].abs(), z.0[k]);
            let (widest, deep) = match self.is_point {
                true => (WIDEST * z, is_deep(z)),
                false => (FARTHEST, q.0[k].abs() < FARTHEST),
            };
            holds &= deep & (x <= widest) & (y <= widest);
        }
        holds
    }

    /// Whether receivers of this reach lie in the box of the grid, but for [`BESIDE`]: then they are
    /// also held.
    pub(super) fn contains(&self, reach: &Reach) -> bool {
        let end = self.cells as f64 + BESIDE;
        let is_deep = match self.is_point {
            true => is_deep(reach.least(2)) && is_deep(reach.most(2)),
            false => reach.most(3).max(-reach.least(3)) <= self.depth_scale,
        };
        let inside = |axis| reach.least(axis) > -BESIDE && reach.most(axis) < end;
        is_deep && inside(0) && inside(1) && reach.is_sane()
    }

    /// Above this depth a candidate's order along the segment is not judged by depth: the error of
    /// a position `t` near the light is not small against `1 - t`.
    #[inline(always)]
    pub(super) fn order_limit(&self, receiver_depth: f32) -> f32 {
        if self.is_point { 64.0 * receiver_depth } else { f32::INFINITY }
    }
}

/// Whether a height above a point light is far enough from it and near enough.
#[inline(always)]
fn is_deep(z: f64) -> bool {
    (z > 1e-12) & (z < FARTHEST)
}

/// Eight vertices in light space.
#[derive(Clone, Copy, Debug)]
pub(super) struct Eight {
    pub(super) v: [Lanes; 3],
    pub(super) q: Lanes,
    /// The largest |coordinate| relative to the origin of the frame, in world units.
    pub(super) far: Lanes,
}

impl Eight {
    /// Grid positions and depths.
    #[inline(always)]
    pub(super) fn places(&self) -> [Lanes; 3] {
        let inverse = self.v[2].recip();
        [self.v[0] * inverse, self.v[1] * inverse, self.q * inverse]
    }
}

/// How far receivers reach: their grid position, their height above the light and their depth.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reach {
    low: [Lanes; 4],
    high: [Lanes; 4],
    /// Not a number if one of them was none.
    odd: Lanes,
}

impl Default for Reach {
    fn default() -> Self {
        let (low, high) = (Lanes::splat(f64::INFINITY), Lanes::splat(f64::NEG_INFINITY));
        Self { low: [low; 4], high: [high; 4], odd: Lanes::splat(0.0) }
    }
}

impl Reach {
    /// Adds eight receivers that fall on these places.
    #[inline(always)]
    pub(super) fn add(&mut self, eight: &Eight, places: &[Lanes; 3]) {
        let values = [places[0], places[1], eight.v[2], eight.q];
        for axis in 0..4 {
            self.low[axis] = self.low[axis].min(values[axis]);
            self.high[axis] = self.high[axis].max(values[axis]);
        }
        self.odd = self.odd + (places[0] + places[1] + places[2]) * 0.0;
    }

    fn least(&self, axis: usize) -> f64 {
        self.low[axis].0.into_iter().fold(f64::INFINITY, f64::min)
    }

    fn most(&self, axis: usize) -> f64 {
        self.high[axis].0.into_iter().fold(f64::NEG_INFINITY, f64::max)
    }

    fn is_sane(&self) -> bool {
        self.odd.0.iter().all(|x| *x == 0.0)
    }
}

#[inline(always)]
fn along(row: DVec3, r: &[Lanes; 3]) -> Lanes {
    r[0] * row.x + r[1] * row.y + r[2] * row.z
}

/// The box around the places of the receivers of a range of members; none unless all are held.
struct Survey<'a> {
    frame: &'a Frame,
    receivers: &'a [Receiver],
    members: Members<'a>,
    range: Range<usize>,
}

impl Kernel for Survey<'_> {
    type Output = Option<[DVec3; 2]>;

    #[inline(always)]
    fn run(self, _: bool) -> Self::Output {
        let (mut low, mut high) = ([f64::INFINITY; BATCH * 3], [f64::NEG_INFINITY; BATCH * 3]);
        let mut holds = true;
        for at in self.range.clone().step_by(BATCH) {
            let count = (self.range.end - at).min(BATCH);
            let eight = self.frame.eight(&self.members.positions(self.receivers, at, count));
            holds &= self.frame.holds_eight(&eight);
            let places = eight.places();
            for axis in 0..3 {
                for k in 0..BATCH {
                    let (x, i) = (places[axis].0[k], axis * BATCH + k);
                    low[i] = if x < low[i] { x } else { low[i] };
                    high[i] = if x > high[i] { x } else { high[i] };
                }
            }
        }
        let end = |values: &[f64], of: fn(f64, f64) -> f64| {
            let along = |axis: usize| values[axis * BATCH..][..BATCH].iter().copied().reduce(of);
            [along(0), along(1), along(2)].map(|x| x.unwrap_or(0.0))
        };
        holds.then(|| [end(&low, f64::min).into(), end(&high, f64::max).into()])
    }
}
