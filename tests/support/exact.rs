//! An oracle in integers: what a segment meets, by another method than the one under test.
//!
//! Coordinates are integers with |x| <= 64, so every number below fits i128.

#![allow(unreachable_pub, reason = "shared by test binaries")]

use gnomon::scene::Geometry;

pub type Point = [i128; 3];

fn sub(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn cross(a: Point, b: Point) -> Point {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn dot(a: Point, b: Point) -> i128 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn scaled(a: Point, k: i128) -> Point {
    a.map(|x| x * k)
}

pub fn point(p: glam::DVec3) -> Point {
    p.to_array().map(|x| {
        assert_eq!(x, x.round(), "the oracle takes integers");
        x as i128
    })
}

/// `numerator / denominator` with a positive denominator.
#[derive(Clone, Copy, Debug)]
pub struct Ratio(pub i128, pub i128);

impl Ratio {
    pub fn cmp(self, other: Self) -> std::cmp::Ordering {
        (self.0 * other.1).cmp(&(other.0 * self.1))
    }
}

/// Where the line through both ends meets the plane of a triangle.
#[derive(Clone, Copy, Debug)]
pub enum Meeting {
    /// Outside the closed triangle or the closed segment, or the triangle has no area.
    Miss,
    /// In the triangle's inside.
    Inside(Ratio),
    /// On its boundary.
    Boundary(Ratio),
    /// The segment lies in the plane.
    InPlane,
}

/// Solves `n (from + t along - a) = 0` in rationals and tests the point against the three sides.
pub fn meet(from: Point, to: Point, [a, b, c]: [Point; 3]) -> Meeting {
    let (along, n) = (sub(to, from), cross(sub(b, a), sub(c, a)));
    let (height, slope) = (dot(n, sub(a, from)), dot(n, along));
    if n == [0; 3] || (slope == 0 && height != 0) {
        return Meeting::Miss;
    }
    if slope == 0 {
        return Meeting::InPlane;
    }
    let t = Ratio(height * slope.signum(), slope.abs());
    if t.0 < 0 || t.0 > t.1 {
        return Meeting::Miss;
    }
    // The point times the denominator of t.
    let hit: Point = std::array::from_fn(|k| from[k] * t.1 + along[k] * t.0);
    let side = |p: Point, q: Point| dot(n, cross(sub(q, p), sub(hit, scaled(p, t.1)))).signum();
    let sides = [side(a, b), side(b, c), side(c, a)];
    match sides {
        _ if sides.contains(&-1) => Meeting::Miss,
        _ if sides.contains(&0) => Meeting::Boundary(t),
        _ => Meeting::Inside(t),
    }
}

pub fn triangle(scene: &Geometry, id: u32) -> [Point; 3] {
    scene.corners(id).map(point)
}

/// Whether segments next to this one are all blocked: the segment is moved sideways by 2^-17 in
/// every direction between two corners of the triangles it meets, and in 64 more.
/// `skip` names triangles that do not occlude.
pub fn neighbours_blocked(
    scene: &Geometry,
    from: Point,
    to: Point,
    skip: impl Fn(u32) -> bool,
) -> bool {
    const FINE: i128 = 1 << 24;
    let triangles: Vec<_> = (0..scene.triangles.len() as u32)
        .filter(|&id| !skip(id))
        .map(|id| triangle(scene, id))
        .collect();
    let offsets = offsets(from, to, &triangles);
    let fine: Vec<_> = triangles.iter().map(|t| t.map(|p| scaled(p, FINE))).collect();
    offsets.iter().all(|offset| {
        let moved: Vec<Point> =
            [from, to].iter().map(|p| std::array::from_fn(|k| p[k] * FINE + offset[k])).collect();
        fine.iter().any(|t| crosses(moved[0], moved[1], *t))
    })
}

/// Crossing of the closed triangle by volumes; the plane strictly.
fn crosses(from: Point, to: Point, [a, b, c]: [Point; 3]) -> bool {
    let along = sub(to, from);
    let (a, b, c) = (sub(a, from), sub(b, from), sub(c, from));
    let volume = |p, q| dot(along, cross(p, q)).signum();
    let sides = [volume(a, b), volume(b, c), volume(c, a)];
    let n = cross(sub(b, a), sub(c, a));
    let (start, end) = (dot(n, a).signum(), dot(n, sub(a, along)).signum());
    !(sides.contains(&1) && sides.contains(&-1)) && start * end < 0
}

/// Sideways offsets, about 128 long: between every two directions to corners of the triangles
/// that the segment meets, and all around.
fn offsets(from: Point, to: Point, triangles: &[[Point; 3]]) -> Vec<Point> {
    let axis = float(sub(to, from)).normalize();
    let met = triangles.iter().filter(|&&t| !matches!(meet(from, to, t), Meeting::Miss));
    let mut rays: Vec<glam::DVec3> = Vec::new();
    for p in met.flatten() {
        let sideways = float(sub(*p, from)).reject_from_normalized(axis);
        if sideways.length() > 1e-9 {
            rays.extend([sideways.normalize(), -sideways.normalize()]);
        }
    }
    let (u, v) = axis.any_orthonormal_pair();
    let mut out: Vec<glam::DVec3> = (0..64)
        .map(|k| u * libm::cos(f64::from(k) * 0.0982) + v * libm::sin(f64::from(k) * 0.0982))
        .collect();
    for (k, a) in rays.iter().enumerate() {
        out.extend(rays[..k].iter().map(|b| *a + *b).filter(|m| m.length() > 1e-6));
    }
    out.iter().map(|d| (d.normalize() * 128.0).to_array().map(|x| x.round() as i128)).collect()
}

fn float(p: Point) -> glam::DVec3 {
    glam::DVec3::from_array(p.map(|x| x as f64))
}
