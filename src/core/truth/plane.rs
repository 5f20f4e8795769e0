//! Where a line meets the plane of a triangle: one formula for one line or for eight.

use std::ops::{Add, Div, Mul, Sub};

use glam::DVec3;

use crate::simd::lanes::{BATCH, Lanes};

/// Half an ulp of 1: the relative error of one f64 operation.
pub(super) const U: f64 = f64::EPSILON / 2.0;

/// A determinant of three differences evaluated in f64 is off by at most `((1 + U)^8 - 1)` of its
/// permanent: three roundings of differences, two products, one subtraction and two sums. 9 leaves
/// room for the roundings of the permanent and of this product.
pub(super) const FILTER: f64 = 9.0 * U;

/// An f64 or eight of them, with the same roundings lane by lane.
pub(super) trait Real:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    fn splat(x: f64) -> Self;
    fn magnitude(self) -> Self;
    fn larger(self, other: Self) -> Self;
}

impl Real for f64 {
    #[inline(always)]
    fn splat(x: f64) -> Self {
        x
    }

    #[inline(always)]
    fn magnitude(self) -> Self {
        self.abs()
    }

    #[inline(always)]
    fn larger(self, other: Self) -> Self {
        if self > other { self } else { other }
    }
}

impl Real for Lanes {
    #[inline(always)]
    fn splat(x: f64) -> Self {
        Self::splat(x)
    }

    #[inline(always)]
    fn magnitude(self) -> Self {
        self.abs()
    }

    #[inline(always)]
    fn larger(self, other: Self) -> Self {
        self.max(other)
    }
}

/// A point or a vector.
pub(super) type Vector<T> = [T; 3];

/// A line from a receiver towards its light.
#[derive(Clone, Copy, Debug)]
pub(super) struct Line<T> {
    pub(super) from: Vector<T>,
    /// From the receiver to the light end.
    pub(super) along: Vector<T>,
    /// How far each coordinate of `from` may be off.
    pub(super) blur: T,
}

/// Where a line meets a plane.
#[derive(Clone, Copy, Debug)]
pub(super) struct Crossing<T> {
    /// `t = n (a - from) / n along`.
    pub(super) t: T,
    /// How far the true one may be off, if `certain` is above 0.
    pub(super) error: T,
    /// `n along`: its sign says which side of the plane the receiver sees.
    pub(super) slope: T,
    /// By how much `|slope|` exceeds its own error. Not above 0: the plane may be parallel to the line.
    pub(super) certain: T,
}

impl<T: Real> Line<T> {
    /// The line of a receiver of a scene whose largest |coordinate| is `extent`: each coordinate of
    /// the receiver may be off by `16 * 2^-53` times the largest of all.
    #[inline(always)]
    pub(super) fn of_scene(from: Vector<T>, to: &Vector<T>, extent: f64) -> Self {
        let [x, y, z] = size(&from);
        let largest = T::splat(extent).larger(x.larger(y).larger(z));
        Self { from, along: minus(to, &from), blur: T::splat(8.0 * f64::EPSILON) * largest }
    }

    /// Where the line meets the plane of the triangle with these corners.
    #[inline(always)]
    pub(super) fn crossing(&self, [a, b, c]: &[Vector<T>; 3]) -> Crossing<T> {
        let number = T::splat;
        let (e1, e2) = (minus(b, a), minus(c, a));
        let (normal, rough) = (cross(&e1, &e2), permanents(&size(&e1), &size(&e2)));
        let offset = minus(a, &self.from);
        let (height, slope) = (dot(&normal, &offset), dot(&normal, &self.along));
        let [x, y, z] = rough;
        let [nx, ny, nz] = size(&normal);
        let few = number(4.0 * U);
        let blurred = (nx + x * few) + (ny + y * few) + (nz + z * few);
        let blur = self.blur * blurred * number(1.0 + 8.0 * U);
        let height_error = number(FILTER) * dot(&rough, &size(&offset)) + blur;
        let slope_error = number(FILTER) * dot(&rough, &size(&self.along));
        let t = height / slope;
        let certain = slope.magnitude() - slope_error;
        let error = (height_error + t.magnitude() * slope_error) / certain * number(1.0 + 16.0 * U)
            + number(2.0 * U) * t.magnitude();
        Crossing { t, error, slope, certain }
    }
}

impl Crossing<f64> {
    /// Whether the triangle is met between the ends of the segment for certain, and well measured.
    #[inline(always)]
    pub(super) fn is_between_ends(&self) -> bool {
        let Self { t, error, certain, .. } = *self;
        (certain > 0.0) & (t - error > 0.0) & (t + error < 1.0) & (error < 1e-9)
    }

    /// The position and its bound, infinite where the plane may be parallel to the line.
    pub(super) fn bounded(&self) -> (f64, f64) {
        let known = self.certain > 0.0 && self.t.is_finite();
        (self.t, if known { self.error } else { f64::INFINITY })
    }
}

impl Crossing<Lanes> {
    #[inline(always)]
    pub(super) fn lane(&self, k: usize) -> Crossing<f64> {
        Crossing {
            t: self.t.0[k],
            error: self.error.0[k],
            slope: self.slope.0[k],
            certain: self.certain.0[k],
        }
    }
}

/// Eight points side by side.
#[inline(always)]
pub(super) fn side_by_side(points: &[DVec3; BATCH]) -> Vector<Lanes> {
    let mut lanes = [Lanes::splat(0.0); 3];
    for (k, p) in points.iter().enumerate() {
        (lanes[0].0[k], lanes[1].0[k], lanes[2].0[k]) = (p.x, p.y, p.z);
    }
    lanes
}

#[inline(always)]
fn minus<T: Real>(a: &Vector<T>, b: &Vector<T>) -> Vector<T> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
fn size<T: Real>(a: &Vector<T>) -> Vector<T> {
    [a[0].magnitude(), a[1].magnitude(), a[2].magnitude()]
}

#[inline(always)]
fn dot<T: Real>(a: &Vector<T>, b: &Vector<T>) -> T {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
fn cross<T: Real>(a: &Vector<T>, b: &Vector<T>) -> Vector<T> {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The permanents of the components of a cross product of such magnitudes.
#[inline(always)]
fn permanents<T: Real>(a: &Vector<T>, b: &Vector<T>) -> Vector<T> {
    [a[1] * b[2] + a[2] * b[1], a[2] * b[0] + a[0] * b[2], a[0] * b[1] + a[1] * b[0]]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Random coordinates in [-1, 1).
    fn points() -> impl FnMut() -> DVec3 {
        let mut random = fastrand::Rng::with_seed(1);
        let mut number = move || 2.0 * random.f64() - 1.0;
        move || DVec3::new(number(), number(), number())
    }

    #[test]
    fn eight_lines_are_measured_like_one() {
        let mut point = points();
        for _ in 0..2000 {
            let mut eight = || std::array::from_fn::<DVec3, BATCH, _>(|_| point());
            let (from, to) = (eight(), eight());
            let corners = [eight(), eight(), eight()];
            let lines = Line::of_scene(side_by_side(&from), &side_by_side(&to), 2.0);
            let crossings = lines.crossing(&corners.map(|corner| side_by_side(&corner)));
            for k in 0..BATCH {
                let line = Line::of_scene(from[k].to_array(), &to[k].to_array(), 2.0);
                let crossing = line.crossing(&corners.map(|corner| corner[k].to_array()));
                let bits = |p: Crossing<f64>| [p.t, p.error, p.slope, p.certain].map(f64::to_bits);
                assert_eq!(bits(crossings.lane(k)), bits(crossing));
            }
        }
    }

    #[test]
    fn a_crossing_lies_on_the_plane_within_its_error() {
        let mut point = points();
        for _ in 0..2000 {
            // Steps of 2⁻¹⁰ keep the plane equation exact in f64.
            let mut grid = || (point() * 1024.0).round() / 1024.0;
            let (from, to, corners) = (grid(), grid(), [grid(), grid(), grid()]);
            let crossing = Line::of_scene(from.to_array(), &to.to_array(), 1.0)
                .crossing(&corners.map(|corner| corner.to_array()));
            let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
            let (height, slope) = (normal.dot(corners[0] - from), normal.dot(to - from));
            assert_eq!(crossing.slope, slope, "exact sums");
            if crossing.certain > 0.0 {
                // |t - height/slope| <= error, multiplied by the exact slope; 2⁻⁵⁰ for this line's own.
                let off = (crossing.t * slope - height).abs();
                assert!(off <= crossing.error * slope.abs() + height.abs() / (1_u64 << 50) as f64);
            }
        }
    }
}
