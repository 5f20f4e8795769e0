//! Homogeneous clipping of a triangle against the view volume, in the subject's f32.

use crate::view::ClipRange;
use glam::Vec4;

/// A convex polygon of at most nine clip-space corners.
#[derive(Clone, Copy, Debug)]
pub(super) struct Polygon {
    corners: [Vec4; 9],
    len: usize,
}

impl Polygon {
    fn new() -> Self {
        Self { corners: [Vec4::ZERO; 9], len: 0 }
    }

    fn push(&mut self, corner: Vec4) {
        if self.len < self.corners.len() {
            self.corners[self.len] = corner;
            self.len += 1;
        }
    }

    /// The corners in order.
    pub(super) fn corners(&self) -> &[Vec4] {
        &self.corners[..self.len]
    }
}

/// Multiple of w in the distance to the plane of least z.
#[inline(always)]
pub(super) const fn least(range: ClipRange) -> f32 {
    match range {
        ClipRange::MinusOneToOne => 1.0,
        ClipRange::ZeroToOne => 0.0,
    }
}

/// Signed distances to the six planes, positive inside: near, far, left, right, bottom last but for
/// the measured order top before bottom.
#[inline(always)]
fn distances(v: Vec4, near: f32) -> [f32; 6] {
    [v.z + v.w * near, v.w - v.z, v.x + v.w, v.w - v.x, v.w - v.y, v.y + v.w]
}

/// Whether a vertex lies inside the volume (NaN does not).
#[inline(always)]
pub(super) fn is_inside(v: Vec4, near: f32) -> bool {
    let [a, b, c, d, e, f] = distances(v, near);
    (a >= 0.0) & (b >= 0.0) & (c >= 0.0) & (d >= 0.0) & (e >= 0.0) & (f >= 0.0)
}

/// Whether some corner lies outside the volume (NaN counts as outside).
pub(super) fn needs_clipping(clip: &[Vec4; 3], range: ClipRange) -> bool {
    clip.iter().any(|&v| !is_inside(v, least(range)))
}

/// The part of a triangle inside the view volume; empty if there is none.
///
/// New corners are f32((f32(db·a) − f32(da·b)) · f32(1/(db − da))) with a inside, so that an edge
/// shared by two triangles is cut at the same point from both sides.
pub(super) fn clip(clip: &[Vec4; 3], range: ClipRange) -> Polygon {
    let mut polygon = Polygon::new();
    clip.iter().for_each(|&v| polygon.push(v));
    for plane in 0..6 {
        polygon = clip_plane(&polygon, plane, least(range));
    }
    polygon
}

fn clip_plane(polygon: &Polygon, plane: usize, near: f32) -> Polygon {
    let mut out = Polygon::new();
    let corners = polygon.corners();
    for (i, &current) in corners.iter().enumerate() {
        let next = corners[(i + 1) % corners.len()];
        let (d, d_next) = (distances(current, near)[plane], distances(next, near)[plane]);
        let (inside, inside_next) = (d >= 0.0, d_next >= 0.0);
        if inside {
            out.push(current);
        }
        if inside && !inside_next {
            out.push(cut(current, d, next, d_next));
        } else if !inside && inside_next {
            out.push(cut(next, d_next, current, d));
        }
    }
    out
}

/// The point of the edge a–b on the plane; a is inside (da ≥ 0), b outside.
fn cut(a: Vec4, da: f32, b: Vec4, db: f32) -> Vec4 {
    let scale = 1.0 / (db - da);
    let mix = |a: f32, b: f32| (db * a - da * b) * scale;
    Vec4::new(mix(a.x, b.x), mix(a.y, b.y), mix(a.z, b.z), mix(a.w, b.w))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_triangle_inside_is_left_alone() {
        let t = [Vec4::W, Vec4::new(0.5, 0.0, 0.0, 1.0), Vec4::new(0.0, 0.5, 0.0, 1.0)];
        assert!(!needs_clipping(&t, ClipRange::MinusOneToOne), "inside");
        assert_eq!(clip(&t, ClipRange::MinusOneToOne).corners(), &t, "unchanged");
    }

    #[test]
    fn crossing_the_near_plane_leaves_positive_w() {
        let t = [
            Vec4::new(0.0, 0.0, -3.0, -1.0),
            Vec4::new(1.0, 0.0, 1.0, 2.0),
            Vec4::new(-1.0, 0.0, 1.0, 2.0),
        ];
        let polygon = clip(&t, ClipRange::MinusOneToOne);
        assert!(polygon.corners().len() >= 3, "something is left");
        assert!(polygon.corners().iter().all(|v| v.w > 0.0), "{polygon:?}");
    }

    #[test]
    fn a_triangle_behind_vanishes() {
        let t = [
            Vec4::new(0.0, 0.0, 5.0, 1.0),
            Vec4::new(1.0, 0.0, 5.0, 1.0),
            Vec4::new(0.0, 1.0, 5.0, 1.0),
        ];
        assert!(clip(&t, ClipRange::MinusOneToOne).corners().is_empty(), "beyond far");
        let behind = t.map(|v| Vec4::new(v.x, v.y, -0.5, v.w));
        assert!(clip(&behind, ClipRange::ZeroToOne).corners().is_empty(), "before near");
        assert!(!clip(&behind, ClipRange::MinusOneToOne).corners().is_empty(), "beyond near");
    }
}
