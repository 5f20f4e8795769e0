//! How a triangle meets a segment: signs with a certified filter, position with an error bound.

use glam::{DVec2, DVec3};

use super::orient::{LARGEST, orient2d, orient3d, sign};
use super::plane::{Crossing, FILTER, Line, U};

/// Permanents below this may be falsified by underflow, so the filter does not trust them:
/// with |coordinates| up to 2^200 an underflow adds less than 2^-870, far below U * 2^-700.
const TINY: f64 = f64::from_bits((1023 - 700) << 52);

/// A segment from a receiver to a light end, with what every test of it needs.
#[derive(Clone, Copy, Debug)]
pub(super) struct Segment {
    pub(super) from: DVec3,
    pub(super) to: DVec3,
    /// `to - from`, rounded.
    along: DVec3,
    /// How far each coordinate of `from` may be off.
    blur: f64,
}

/// How a triangle meets the open segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Contact {
    pub(super) triangle: u32,
    /// Position on the segment, and how far the true one may be off.
    pub(super) t: f64,
    pub(super) error: f64,
    /// On which side of the segment each edge passes: all equal where the segment passes through
    /// the inside, 0 for an edge that it meets (two of them: a vertex), all 0 where it lies in the
    /// plane of the triangle or ends on it.
    pub(super) signs: [i8; 3],
}

/// The outcome of one test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Meeting {
    Miss,
    /// At distance 0 within the error bounds.
    Touching,
    Contact(Contact),
}

impl Contact {
    /// Whether the segment passes through the inside of the triangle.
    pub(super) fn is_inside(&self) -> bool {
        !self.signs.contains(&0)
    }

    /// The side seen from the start of the segment: -1 front (counter-clockwise), 1 back, 0 where
    /// the triangle is seen edge-on.
    pub(super) fn facing(&self) -> i8 {
        self.signs.iter().sum::<i8>().signum()
    }

    /// Whether the positions of both may be the same.
    pub(super) fn overlaps(&self, other: &Self) -> bool {
        (self.t - other.t).abs() <= self.error + other.error
    }
}

impl Segment {
    /// The segment of a receiver of a scene whose largest |coordinate| is `extent`.
    pub(super) fn of_scene(from: DVec3, to: DVec3, extent: f64) -> Self {
        let line = Line::of_scene(from.to_array(), &to.to_array(), extent);
        Self { from, to, along: line.along.into(), blur: line.blur }
    }

    #[cfg(test)]
    pub(super) const fn vertical() -> Self {
        let to = DVec3::new(0.0, 0.0, 10.0);
        Self { from: DVec3::ZERO, to, along: to, blur: 0.0 }
    }

    /// World length, within 4 ulp.
    pub(super) fn length(&self) -> f64 {
        self.along.length()
    }

    /// Whether both ends coincide, or a coordinate is not a number or absurd (above 2^200):
    /// nothing is said then.
    pub(super) fn is_void(&self) -> bool {
        let sane = |p: DVec3| p.is_finite() && p.abs().max_element() <= LARGEST;
        self.from == self.to || !sane(self.from) || !sane(self.to)
    }

    /// Clamps to the part whose |coordinates| after `map` stay below 2; none where there is no
    /// such part. Used to bring the segment near the boxes of a tree, conservatively.
    pub(super) fn clamped(&self, map: impl Fn(DVec3) -> DVec3) -> Option<(DVec3, DVec3)> {
        let (from, to) = (map(self.from), map(self.to));
        let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
        for axis in 0..3 {
            let (start, step) = (from[axis], to[axis] - from[axis]);
            if step != 0.0 {
                let (a, b) = ((-2.0 - start) / step, (2.0 - start) / step);
                (enter, leave) = (enter.max(a.min(b)), leave.min(a.max(b)));
            } else if start.abs() > 2.0 {
                return None;
            }
        }
        (enter <= leave).then(|| (from + (to - from) * enter, from + (to - from) * leave))
    }

    /// How triangle `id` with these corners meets the segment. Deterministic, and independent of
    /// everything but its arguments.
    pub(super) fn meet(&self, id: u32, corners: &[DVec3; 3]) -> Meeting {
        let Some(signs) = self.sides(corners) else {
            return Meeting::Miss;
        };
        if signs == [Some(0); 3] {
            return self.in_plane(id, corners);
        }
        self.meet_at(id, corners, signs.map(|s| s.unwrap_or(0)))
    }

    /// As [`Self::meet`], where the line is known to pass through the inside.
    pub(super) fn meet_inside(&self, id: u32, corners: &[DVec3; 3]) -> Meeting {
        let crossing = self.on_plane(corners);
        if crossing.certain > 0.0 {
            self.meet_at(id, corners, [sign(crossing.slope); 3])
        } else {
            self.meet(id, corners)
        }
    }

    /// Where on the segment the triangle is met, given the sides on which the edges pass.
    #[inline]
    fn meet_at(&self, id: u32, corners: &[DVec3; 3], signs: [i8; 3]) -> Meeting {
        let (t, error) = self.position(corners);
        if t - error > 1.0 || t + error < 0.0 {
            Meeting::Miss
        } else if t - error <= 0.0 {
            Meeting::Touching
        } else {
            self.before_end(Contact { triangle: id, t, error, signs }, corners)
        }
    }

    /// The side on which each edge passes; none where two sides differ, that is where the line
    /// misses the triangle. An undecidable side is `Some(None)`.
    #[inline]
    fn sides(&self, corners: &[DVec3; 3]) -> Option<[Option<i8>; 3]> {
        let [a, b, c] = corners.map(|v| v - self.from);
        let (ab, bc, ca) = (self.volume(a, b), self.volume(b, c), self.volume(c, a));
        let certain =
            [ab, bc, ca].map(|(det, bound)| if det.abs() > bound { sign(det) } else { 0 });
        if certain.contains(&1) && certain.contains(&-1) {
            return None;
        }
        if !certain.contains(&0) {
            return Some(certain.map(Some));
        }
        let exact = |k: usize| match certain[k] {
            0 => orient3d(self.to, corners[k], corners[(k + 1) % 3], self.from),
            s => Some(s),
        };
        let signs = [exact(0), exact(1), exact(2)];
        (!(signs.contains(&Some(1)) && signs.contains(&Some(-1)))).then_some(signs)
    }

    /// `det(along, a, b)` with the bound below which its sign is not certain.
    #[inline]
    fn volume(&self, a: DVec3, b: DVec3) -> (f64, f64) {
        let d = self.along;
        let (yz, zy) = (a.y * b.z, a.z * b.y);
        let (zx, xz) = (a.z * b.x, a.x * b.z);
        let (xy, yx) = (a.x * b.y, a.y * b.x);
        let det = d.x * (yz - zy) + d.y * (zx - xz) + d.z * (xy - yx);
        let permanent = d.x.abs() * (yz.abs() + zy.abs())
            + d.y.abs() * (zx.abs() + xz.abs())
            + d.z.abs() * (xy.abs() + yx.abs());
        (det, FILTER * permanent.max(TINY))
    }

    /// Where the line meets the plane of the triangle: `t = n (a - from) / n along`, with its error
    /// bound. Near the ends, and where the plane is nearly parallel to the line, the range of the
    /// corners along the segment bounds it as well.
    fn position(&self, corners: &[DVec3; 3]) -> (f64, f64) {
        let crossing = self.on_plane(corners);
        if crossing.is_between_ends() {
            return (crossing.t, crossing.error);
        }
        let (t, error) = crossing.bounded();
        let (near, far) = self.corner_range(corners);
        let (low, high) = ((t - error).max(near), (t + error).min(far));
        if low > high {
            return ((near + far) / 2.0, (far - near) / 2.0);
        }
        let t = if t.is_finite() { t.clamp(low, high) } else { (low + high) / 2.0 };
        (t, (high - t).max(t - low) * (1.0 + 4.0 * U))
    }

    /// Where the line meets the plane of the triangle.
    fn on_plane(&self, corners: &[DVec3; 3]) -> Crossing<f64> {
        let Self { from, along, blur, .. } = *self;
        let line = Line { from: from.to_array(), along: along.to_array(), blur };
        line.crossing(&corners.map(|corner| corner.to_array()))
    }

    /// The range of the corners' positions along the segment, widened by their error: a point of
    /// the triangle cannot lie outside it.
    fn corner_range(&self, corners: &[DVec3; 3]) -> (f64, f64) {
        let squared = self.along.length_squared();
        let (mut near, mut far) = (f64::INFINITY, f64::NEG_INFINITY);
        for corner in corners {
            let offset = *corner - self.from;
            let t = offset.dot(self.along) / squared;
            let size =
                offset.abs().dot(self.along.abs()) + self.blur * self.along.abs().element_sum();
            let error = (16.0 * U * size + self.blur * self.along.abs().element_sum()) / squared;
            (near, far) = (near.min(t - error), far.max(t + error));
        }
        (near, far)
    }

    /// Drops a contact at or behind the light end, exactly: at the end it grazes.
    fn before_end(&self, contact: Contact, corners: &[DVec3; 3]) -> Meeting {
        if contact.t + contact.error < 1.0 {
            return Meeting::Contact(contact);
        }
        let [a, b, c] = *corners;
        match orient3d(a, b, c, self.to).map(|s| s * contact.facing()) {
            Some(-1) => Meeting::Contact(contact),
            Some(1) => Meeting::Miss,
            _ => Meeting::Contact(Contact { signs: [0; 3], ..contact }),
        }
    }

    /// The line lies in the plane of the triangle, or the triangle has no area.
    fn in_plane(&self, id: u32, corners: &[DVec3; 3]) -> Meeting {
        let Some(drop_axis) = (0..3).find(|&axis| self.turn(corners, axis) != Some(0)) else {
            return Meeting::Miss;
        };
        if self.separated(corners, drop_axis) {
            return Meeting::Miss;
        }
        let (near, far) = self.corner_range(corners);
        let (near, far) = (near.max(0.0), far.min(1.0));
        let (t, error) = ((near + far) / 2.0, (far - near) / 2.0);
        Meeting::Contact(Contact { triangle: id, t, error, signs: [0; 3] })
    }

    /// The turn of the triangle seen along an axis.
    fn turn(&self, corners: &[DVec3; 3], axis: usize) -> Option<i8> {
        let [a, b, c] = corners.map(|v| without(v, axis));
        orient2d(a, b, c)
    }

    /// Whether segment and triangle, both in one plane, are apart: then an edge of the triangle or
    /// the segment itself separates them.
    fn separated(&self, corners: &[DVec3; 3], axis: usize) -> bool {
        let flat = corners.map(|v| without(v, axis));
        let ends = [without(self.from, axis), without(self.to, axis)];
        let outward = self.turn(corners, axis).map(|s| -s);
        let apart_by_edge = (0..3).any(|k| {
            ends.iter().all(|&end| {
                let side = orient2d(flat[k], flat[(k + 1) % 3], end);
                side.is_some() && side == outward
            })
        });
        let sides = flat.map(|v| orient2d(ends[0], ends[1], v));
        apart_by_edge || sides == [Some(1); 3] || sides == [Some(-1); 3]
    }
}

/// The point seen along an axis.
fn without(v: DVec3, axis: usize) -> DVec2 {
    match axis {
        0 => DVec2::new(v.y, v.z),
        1 => DVec2::new(v.z, v.x),
        _ => DVec2::new(v.x, v.y),
    }
}
