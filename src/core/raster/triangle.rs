//! One triangle: projected, snapped to the sub-pixel grid, culled, and covered row by row.

use super::clip;
use crate::device::{Device, PlaneSetup};
use crate::scene::Cull;
use crate::view::ClipRange;
use glam::{DMat3, DVec3, Vec4};

/// A triangle whose vertices are snapped to the sub-pixel grid.
#[derive(Clone, Copy, Debug)]
pub struct Projected {
    /// Clip-space corners.
    pub clip: [Vec4; 3],
    /// Positions in sub-pixels; pixel (px,py) has its centre at 2^bits·(px,py).
    pub snapped: [[i64; 2]; 3],
    subpixel: i64,
    viewport: [u32; 2],
    /// The range of z in clip space.
    pub range: ClipRange,
}

/// Vertices beside a clipped one may project anywhere; beyond this their place no longer matters.
const FARTHEST: f64 = (1u64 << 40) as f64;

/// Sub-pixel position of a clip-space point, within ±2⁴⁰.
#[inline(always)]
pub(super) fn snap(device: &Device, viewport: [u32; 2], v: Vec4) -> [i64; 2] {
    let half = (1u32 << (device.subpixel_bits - 1)) as f32;
    let axis = |x: f32, size: u32| match device.setup {
        PlaneSetup::Measured => {
            let scale = half * size as f32;
            let place = (scale - half) + (x * (1.0 / v.w)) * scale;
            f64::from(place.round_ties_even()).clamp(-FARTHEST, FARTHEST) as i64
        }
        PlaneSetup::Exact => {
            let scale = f64::from(half) * f64::from(size);
            let ndc = f64::from(x) / f64::from(v.w);
            let place = scale - f64::from(half) + ndc * scale;
            place.round_ties_even().clamp(-FARTHEST, FARTHEST) as i64
        }
    };
    [axis(v.x, viewport[0]), axis(v.y, viewport[1])]
}

impl Projected {
    pub(super) fn new(
        device: &Device,
        viewport: [u32; 2],
        range: ClipRange,
        corners: [Vec4; 3],
    ) -> Self {
        Self {
            clip: corners,
            snapped: corners.map(|v| snap(device, viewport, v)),
            subpixel: 1 << device.subpixel_bits,
            viewport,
            range,
        }
    }

    /// Twice the signed area in sub-pixels², positive counter-clockwise, negated where an odd number
    /// of vertices lies behind the eye. i128: vertices beside a clipped one may lie far outside.
    pub(super) fn area(&self) -> i128 {
        let [a, b, c] = self.snapped.map(|v| v.map(i128::from));
        let area = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
        let behind = self.clip.iter().filter(|v| v.w < 0.0).count();
        if behind % 2 == 1 { -area } else { area }
    }

    /// Which vertex the measured set-up refers to, and the other two.
    pub(super) fn reference_order(&self) -> [usize; 3] {
        fn rotate(order: [usize; 3], second: bool, third: bool) -> [usize; 3] {
            let [a, b, c] = order;
            match (second, third) {
                (true, false) => [b, c, a],
                (false, true) => [c, a, b],
                _ => order,
            }
        }
        let pick = |order: [usize; 3], key: &dyn Fn(usize) -> f32| {
            let best = order.map(key).into_iter().fold(f32::INFINITY, f32::min);
            rotate(order, key(order[1]) == best, key(order[2]) == best)
        };
        let by_y = pick([2, 0, 1], &|i| self.clip[i].y);
        pick(by_y, &|i| -self.clip[i].w)
    }

    /// Columns such that `homogeneous() * v` = coefficients of the plane of v/w over (px, py, 1), for a
    /// quantity v given at the vertices in clip space. f64; snapped positions where all w > 0.
    pub(super) fn homogeneous(&self) -> DMat3 {
        let in_front = self.clip.iter().all(|v| v.w > 0.0);
        let row = |i: usize| {
            let w = f64::from(self.clip[i].w);
            if in_front {
                let [x, y] = self.snapped[i].map(|s| s as f64 / self.subpixel as f64);
                return DVec3::new(x * w, y * w, w);
            }
            let axis = |c: f32, size: u32| {
                let half = f64::from(size) / 2.0;
                f64::from(c) * half + w * (half - 0.5)
            };
            DVec3::new(
                axis(self.clip[i].x, self.viewport[0]),
                axis(self.clip[i].y, self.viewport[1]),
                w,
            )
        };
        let [r0, r1, r2] = [row(0), row(1), row(2)];
        // Inverse of the matrix with rows r0, r1, r2, by cofactors.
        let determinant = r0.dot(r1.cross(r2));
        DMat3::from_cols(r1.cross(r2), r2.cross(r0), r0.cross(r1)) * (1.0 / determinant)
    }

    /// Barycentric coordinates of a pixel centre on the triangle in space, f64, in [0, 1].
    pub(super) fn barycentrics(&self, px: f64, py: f64) -> DVec3 {
        barycentrics(&self.homogeneous(), px, py)
    }

    /// The snapped outline to be filled, counter-clockwise; `None` if culled or without area.
    pub(super) fn outline(&self, device: &Device, cull: Cull) -> Option<Outline> {
        let area = self.area();
        let dropped = match cull {
            Cull::None => area == 0,
            Cull::Back => area <= 0,
            Cull::Front => area >= 0,
        };
        if dropped || self.clip.iter().any(|v| !v.is_finite()) {
            return None;
        }
        let mut outline = Outline { points: [[0; 2]; 9], len: 0, subpixel: self.subpixel };
        if clip::needs_clipping(&self.clip, self.range) {
            for &v in clip::clip(&self.clip, self.range).corners() {
                outline.push(snap(device, self.viewport, v));
            }
        } else {
            self.snapped.into_iter().for_each(|p| outline.push(p));
        }
        outline.make_counter_clockwise().then_some(outline)
    }
}

/// Barycentric coordinates on a triangle with this [`Projected::homogeneous`].
pub(super) fn barycentrics(homogeneous: &DMat3, px: f64, py: f64) -> DVec3 {
    let pixel = DVec3::new(px, py, 1.0);
    let along = |axis: DVec3| axis.dot(pixel);
    let weights =
        DVec3::new(along(homogeneous.x_axis), along(homogeneous.y_axis), along(homogeneous.z_axis));
    let clamped = weights.max(DVec3::ZERO);
    clamped / (clamped.x + clamped.y + clamped.z)
}

/// A convex polygon on the sub-pixel grid.
#[derive(Clone, Copy, Debug)]
pub(super) struct Outline {
    points: [[i64; 2]; 9],
    len: usize,
    subpixel: i64,
}

impl Outline {
    fn push(&mut self, point: [i64; 2]) {
        self.points[self.len] = point;
        self.len += 1;
    }

    fn points(&self) -> &[[i64; 2]] {
        &self.points[..self.len]
    }

    /// Orients the outline; false if it has no area.
    fn make_counter_clockwise(&mut self) -> bool {
        let p = self.points();
        let twice_area: i128 = (0..p.len())
            .map(|i| (p[i], p[(i + 1) % p.len()]))
            .map(|(a, b)| i128::from(a[0]) * i128::from(b[1]) - i128::from(b[0]) * i128::from(a[1]))
            .sum();
        if twice_area < 0 {
            self.points[..self.len].reverse();
        }
        twice_area != 0
    }

    /// The pixels whose centres the box of the outline holds: first and end on each axis, at least 0.
    pub(super) fn samples(&self) -> [[i64; 2]; 2] {
        [0, 1].map(|axis| {
            let along = self.points().iter().map(|v| v[axis]);
            let (low, high) = (along.clone().min().unwrap_or(0), along.max().unwrap_or(0));
            [ceil_div(low, self.subpixel).max(0), ceil_div(high, self.subpixel).max(0)]
        })
    }

    /// Calls `span(y, first, end)` for each row of covered pixel centres within `window`, in exact
    /// integer arithmetic: left and lower edges belong to the polygon, right and upper ones do not,
    /// so that an edge shared by two triangles is covered once.
    ///
    /// Range: |coordinate| ≤ 2²⁵ sub-pixels (clipping sees to it), products ≤ 2⁵³.
    pub(super) fn spans(&self, window: &Window, mut span: impl FnMut(u32, u32, u32)) {
        for y in self.rows(window) {
            let [first, end] = self.span(window, y);
            if first < end {
                span(y, first, end);
            }
        }
    }

    /// The rows of pixel centres within `window` that the box of the outline holds.
    pub(super) fn rows(&self, [_, rows]: &Window) -> std::ops::Range<u32> {
        let [_, [low, high]] = self.samples();
        let within = |y: i64| y.clamp(i64::from(rows[0]), i64::from(rows[1])) as u32;
        within(low)..within(high)
    }

    /// First and end of the covered pixel centres of a row.
    pub(super) fn span(&self, [columns, _]: &Window, row: u32) -> [u32; 2] {
        let (s, p) = (self.subpixel, self.points());
        let y = i64::from(row) * s;
        let [mut first, mut end] = columns.map(i64::from);
        for i in 0..p.len() {
            let (a, b) = (p[i], p[(i + 1) % p.len()]);
            let dy = b[1] - a[1];
            if dy == 0 || y < a[1].min(b[1]) || y >= a[1].max(b[1]) {
                continue;
            }
            let (numerator, sign) = ((b[0] - a[0]) * (y - a[1]) + a[0] * dy, dy.signum());
            let crossing = ceil_div(numerator * sign, dy * sign * s);
            if dy < 0 {
                first = first.max(crossing);
            } else {
                end = end.min(crossing);
            }
        }
        // An empty span may lie anywhere, also below 0.
        if first < end { [first as u32, end as u32] } else { [0, 0] }
    }
}

/// First and end pixel along x and along y.
pub(super) type Window = [[u32; 2]; 2];

/// ⌈a/b⌉ for b > 0.
fn ceil_div(a: i64, b: i64) -> i64 {
    a.div_euclid(b) + i64::from(a.rem_euclid(b) != 0)
}
