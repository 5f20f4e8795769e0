//! Eight triangles set up at once: edge functions in exact integers, depth planes in f64.
#![allow(clippy::needless_range_loop, reason = "loops over indices become vectors")]

use super::bins::{Place, ceil};
use crate::simd::lanes::{BATCH, Lanes};
use crate::view::ClipRange;
use glam::Vec4;

/// A triangle wider or higher than this many sub-pixels is drawn by rows.
///
/// Edge functions over its box stay below 2·2¹⁴·2¹⁴ = 2²⁹, eight pixels of 2⁸ sub-pixels beyond it
/// below 2²⁹ + 2³·2¹⁴·2⁸ < 2³⁰: i32 holds them.
const WIDEST: i32 = 1 << 14;

/// The finest sub-pixel grid for which that holds.
pub(super) const FINEST: u32 = 8;

type Ints = [i32; BATCH];

/// Whether a triangle is small enough for a batch.
#[inline(always)]
pub(super) fn fits([a, b, c]: [Place; 3]) -> bool {
    let reach = |axis: usize| {
        let (low, high) = (a[axis].min(b[axis]).min(c[axis]), a[axis].max(b[axis]).max(c[axis]));
        high.wrapping_sub(low)
    };
    reach(0).max(reach(1)) <= WIDEST
}

/// Triangles on their way to edges and planes, structure of arrays.
#[derive(Debug)]
pub(super) struct Batch {
    pub(super) len: usize,
    pub(super) ids: [u32; BATCH],
    x: [Ints; 3],
    y: [Ints; 3],
    w: [[f64; BATCH]; 3],
    /// Window depth times w.
    depth: [[f64; BATCH]; 3],
    /// Factor of z in window depth times w; that of w is 1 less it.
    scale: f64,
}

/// Edge functions of a batch: inside where none is negative.
#[derive(Debug)]
pub(super) struct Edges {
    /// First pixel and end of the box along x and y.
    samples: [[Ints; 2]; 2],
    /// At the first pixel.
    at: [Ints; 3],
    /// Per pixel along x and y.
    step: [[Ints; 2]; 3],
}

/// The edge functions of one triangle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Edge3 {
    pub(super) samples: [[i32; 2]; 2],
    pub(super) at: [i32; 3],
    pub(super) step: [[i32; 2]; 3],
}

impl Batch {
    const EMPTY: Self = Self {
        len: 0,
        ids: [0; BATCH],
        x: [[0; BATCH]; 3],
        y: [[0; BATCH]; 3],
        w: [[1.0; BATCH]; 3],
        depth: [[0.0; BATCH]; 3],
        scale: 0.5,
    };

    /// None yet, of a clip space.
    pub(super) fn new(range: ClipRange) -> Self {
        Self { scale: f64::from(range.scale()), ..Self::EMPTY }
    }

    #[inline(always)]
    pub(super) fn push(&mut self, id: u32, places: [Place; 3], clip: [Vec4; 3]) {
        let k = self.len;
        self.ids[k] = id;
        for corner in 0..3 {
            [self.x[corner][k], self.y[corner][k]] = places[corner];
            let (z, w) = (f64::from(clip[corner].z), f64::from(clip[corner].w));
            self.w[corner][k] = w;
            self.depth[corner][k] = z * self.scale + w * (1.0 - self.scale);
        }
        self.len += 1;
    }

    /// The edges, turned counter-clockwise. Left and lower edges belong to the triangle, right and
    /// upper ones do not: those are lowered by one, the least step of an integer.
    #[inline(always)]
    pub(super) fn edges(&self, subpixel_bits: u32) -> Edges {
        let samples = [ends(&self.x, subpixel_bits), ends(&self.y, subpixel_bits)];
        let [x, y] = self.counter_clockwise();
        let unit = 1i32.wrapping_shl(subpixel_bits);
        let first = [scaled(&samples[0][0], unit), scaled(&samples[1][0], unit)];
        let (e0, s0) = edge([&x[0], &y[0]], [&x[1], &y[1]], &first, unit);
        let (e1, s1) = edge([&x[1], &y[1]], [&x[2], &y[2]], &first, unit);
        let (e2, s2) = edge([&x[2], &y[2]], [&x[0], &y[0]], &first, unit);
        Edges { samples, at: [e0, e1, e2], step: [s0, s1, s2] }
    }

    /// The corners, second and third exchanged where the area is negative.
    #[inline(always)]
    fn counter_clockwise(&self) -> [[Ints; 3]; 2] {
        let (x, y) = (&self.x, &self.y);
        let (bx, by) = (minus(&x[1], &x[0]), minus(&y[1], &y[0]));
        let (cx, cy) = (minus(&x[2], &x[0]), minus(&y[2], &y[0]));
        let mut turned = [0; BATCH];
        for k in 0..BATCH {
            // Twice the area, below 2²⁹; then all bits where it is negative.
            turned[k] = bx[k].wrapping_mul(cy[k]).wrapping_sub(cx[k].wrapping_mul(by[k])) >> 31;
        }
        let pick = |kept: &Ints, other: &Ints| {
            let mut picked = [0; BATCH];
            for k in 0..BATCH {
                picked[k] = (kept[k] & !turned[k]) | (other[k] & turned[k]);
            }
            picked
        };
        [
            [x[0], pick(&x[1], &x[2]), pick(&x[2], &x[1])],
            [y[0], pick(&y[1], &y[2]), pick(&y[2], &y[1])],
        ]
    }

    /// The exact depth planes, in the operations and the order of `Projected::homogeneous`.
    #[inline(always)]
    pub(super) fn planes(&self, subpixel_bits: u32) -> [Lanes; 3] {
        // The reciprocal of a power of two is exact.
        let unit = 1.0 / f64::from(1u32 << subpixel_bits);
        let row = |i: usize| {
            let w = Lanes(self.w[i]);
            [wide(&self.x[i]) * unit * w, wide(&self.y[i]) * unit * w, w]
        };
        let [a, b, c] = [row(0), row(1), row(2)];
        let (x, y, z) = (cross(b, c), cross(c, a), cross(a, b));
        let inverse = dot(a, x).recip();
        let [d, e, f] = [Lanes(self.depth[0]), Lanes(self.depth[1]), Lanes(self.depth[2])];
        [
            x[0] * inverse * d + y[0] * inverse * e + z[0] * inverse * f,
            x[1] * inverse * d + y[1] * inverse * e + z[1] * inverse * f,
            x[2] * inverse * d + y[2] * inverse * e + z[2] * inverse * f,
        ]
    }
}

/// An edge function at the place `first`, and its steps per pixel along x and y.
#[inline(always)]
fn edge(from: [&Ints; 2], to: [&Ints; 2], first: &[Ints; 2], unit: i32) -> (Ints, [Ints; 2]) {
    let (dx, dy) = (minus(to[0], from[0]), minus(to[1], from[1]));
    let (px, py) = (minus(&first[0], from[0]), minus(&first[1], from[1]));
    let mut at = [0; BATCH];
    for k in 0..BATCH {
        let owns = (dy[k] < 0) | ((dy[k] == 0) & (dx[k] > 0));
        let value = dx[k].wrapping_mul(py[k]).wrapping_sub(dy[k].wrapping_mul(px[k]));
        at[k] = value.wrapping_sub(i32::from(!owns));
    }
    (at, [scaled(&dy, unit.wrapping_neg()), scaled(&dx, unit)])
}

#[inline(always)]
fn scaled(values: &Ints, by: i32) -> Ints {
    let mut out = [0; BATCH];
    for k in 0..BATCH {
        out[k] = values[k].wrapping_mul(by);
    }
    out
}

#[inline(always)]
fn minus(a: &Ints, b: &Ints) -> Ints {
    let mut out = [0; BATCH];
    for k in 0..BATCH {
        out[k] = a[k].wrapping_sub(b[k]);
    }
    out
}

/// First pixel centre and end of the boxes of a batch along an axis.
#[inline(always)]
fn ends([a, b, c]: &[Ints; 3], subpixel_bits: u32) -> [Ints; 2] {
    let (mut first, mut end) = ([0; BATCH], [0; BATCH]);
    for k in 0..BATCH {
        first[k] = ceil(a[k].min(b[k]).min(c[k]), subpixel_bits);
    }
    for k in 0..BATCH {
        end[k] = ceil(a[k].max(b[k]).max(c[k]), subpixel_bits);
    }
    [first, end]
}

impl Edge3 {
    /// Each edge at eight pixels from the first one on.
    #[inline(always)]
    pub(super) fn ramps(&self) -> [Ints; 3] {
        [self.ramp(0), self.ramp(1), self.ramp(2)]
    }

    #[inline(always)]
    fn ramp(&self, i: usize) -> Ints {
        let mut ramp = [0; BATCH];
        for k in 0..BATCH {
            ramp[k] = self.at[i].wrapping_add((k as i32).wrapping_mul(self.step[i][0]));
        }
        ramp
    }

    /// What the edges rise from the first pixel to (x, y).
    #[inline(always)]
    pub(super) fn rise(&self, x: i32, y: i32) -> [i32; 3] {
        let (dx, dy) = (x.wrapping_sub(self.samples[0][0]), y.wrapping_sub(self.samples[1][0]));
        let rise = |[step_x, step_y]: [i32; 2]| {
            dx.wrapping_mul(step_x).wrapping_add(dy.wrapping_mul(step_y))
        };
        [rise(self.step[0]), rise(self.step[1]), rise(self.step[2])]
    }
}

/// Moves edges at eight pixels up by a row.
#[inline(always)]
pub(super) fn climb(edges: &mut [Ints; 3], step: &[[i32; 2]; 3]) {
    for i in 0..3 {
        for k in 0..BATCH {
            edges[i][k] = edges[i][k].wrapping_add(step[i][1]);
        }
    }
}

/// Negative where a pixel of the eight lies outside of some edge.
#[inline(always)]
pub(super) fn outside([a, b, c]: &[Ints; 3], rise: [i32; 3]) -> Ints {
    let mut outside = [0; BATCH];
    for k in 0..BATCH {
        outside[k] =
            a[k].wrapping_add(rise[0]) | b[k].wrapping_add(rise[1]) | c[k].wrapping_add(rise[2]);
    }
    outside
}

impl Edges {
    #[inline(always)]
    pub(super) fn get(&self, k: usize) -> Edge3 {
        Edge3 {
            samples: [
                [self.samples[0][0][k], self.samples[0][1][k]],
                [self.samples[1][0][k], self.samples[1][1][k]],
            ],
            at: [self.at[0][k], self.at[1][k], self.at[2][k]],
            step: [
                [self.step[0][0][k], self.step[0][1][k]],
                [self.step[1][0][k], self.step[1][1][k]],
                [self.step[2][0][k], self.step[2][1][k]],
            ],
        }
    }
}

#[inline(always)]
fn wide(values: &Ints) -> Lanes {
    let mut lanes = [0.0; BATCH];
    for k in 0..BATCH {
        lanes[k] = f64::from(values[k]);
    }
    Lanes(lanes)
}

#[inline(always)]
fn cross(a: [Lanes; 3], b: [Lanes; 3]) -> [Lanes; 3] {
    [a[1] * b[2] - b[1] * a[2], a[2] * b[0] - b[2] * a[0], a[0] * b[1] - b[0] * a[1]]
}

#[inline(always)]
fn dot(a: [Lanes; 3], b: [Lanes; 3]) -> Lanes {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
