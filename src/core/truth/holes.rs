//! Whether a surface with holes is there where a segment meets it, decided in f64.
//!
//! The point is the segment's at the contact, its texture coordinates are barycentric combinations; both
//! are off by a few 2⁻⁵³ of their size. Where alpha is within [`CERTAIN`] of the cutoff, or a NEAREST
//! texture changes its mind within [`CERTAIN`] texels, nothing is said.

use super::intersect::{Contact, Segment};
use crate::scene::alpha::{AlphaImage, Mask, Tiling};
use crate::scene::{Geometry, Surfaces};
use glam::{DVec2, DVec3};
use std::sync::Arc;

/// How near to the cutoff, or to the border of a NEAREST texel, nothing is certain.
const CERTAIN: f64 = 1e-9;

/// What is known of a surface at a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Presence {
    /// There.
    There,
    /// A hole.
    Hole,
    /// Too near to a border of one.
    Unsure,
}

/// The surfaces with holes of a scene.
#[derive(Clone, Debug)]
pub(super) struct Holes {
    surfaces: Arc<Surfaces>,
    /// The vertices of each triangle.
    triangles: Vec<[u32; 3]>,
}

impl Holes {
    /// The surfaces of a geometry; `None` where nothing has holes.
    pub(super) fn of(geometry: &Geometry) -> Option<Box<Self>> {
        let surfaces = geometry.surfaces.clone();
        let holes = || Box::new(Self { surfaces, triangles: geometry.triangles.clone() });
        geometry.surfaces.have_holes().then(holes)
    }

    /// What is there of triangle `id` at its contact with a segment.
    pub(super) fn presence(
        &self,
        segment: &Segment,
        contact: &Contact,
        corners: &[DVec3; 3],
    ) -> Presence {
        let Some(mask) = self.surfaces.mask(contact.triangle) else { return Presence::There };
        let Some(image) = &mask.image else { return decided(f64::from(mask.factor), mask) };
        let p = segment.from + (segment.to - segment.from) * contact.t;
        let Some(weights) = barycentrics(p, corners) else { return Presence::Unsure };
        let uvs = self.surfaces.uvs(self.triangles[contact.triangle as usize]);
        let [a, b, c] = uvs.map(|uv| mask.moved(uv.as_dvec2()));
        let uv = a * weights.x + b * weights.y + c * weights.z;
        sampled(mask, image, uv * DVec2::new(image.size[0].into(), image.size[1].into()))
    }
}

/// Weights of the corners at a point of their plane; `None` of a triangle without area.
fn barycentrics(p: DVec3, [a, b, c]: &[DVec3; 3]) -> Option<DVec3> {
    let normal = (*b - *a).cross(*c - *a);
    let area = normal.dot(normal);
    let part = |from: DVec3, to: DVec3| (to - from).cross(p - from).dot(normal) / area;
    let weights = DVec3::new(part(*b, *c), part(*c, *a), part(*a, *b));
    (area > 0.0 && weights.is_finite()).then_some(weights)
}

fn decided(alpha: f64, mask: &Mask) -> Presence {
    let over = alpha - f64::from(mask.cutoff);
    // Without a texture both sides are one f32 each, and their comparison is exact.
    match mask.image.is_some() && over.abs() < CERTAIN {
        true => Presence::Unsure,
        false if over >= 0.0 => Presence::There,
        false => Presence::Hole,
    }
}

/// The presence at a place in texels.
fn sampled(mask: &Mask, image: &AlphaImage, at: DVec2) -> Presence {
    let texel = |x: f64, y: f64| {
        let column = place(x, image.size[0], image.tiling[0]);
        let row = place(y, image.size[1], image.tiling[1]);
        f64::from(image.alpha[row * image.size[0] as usize + column]) / 255.0
    };
    let decided = |alpha: f64| decided(f64::from(mask.factor) * alpha, mask);
    if image.linear {
        let low = (at - 0.5).floor();
        let part = at - 0.5 - low;
        let row = |y: f64| texel(low.x, y) * (1.0 - part.x) + texel(low.x + 1.0, y) * part.x;
        return decided(row(low.y) * (1.0 - part.y) + row(low.y + 1.0) * part.y);
    }
    let near = |dx: f64, dy: f64| {
        let there = (at + DVec2::new(dx, dy) * CERTAIN).floor();
        decided(texel(there.x, there.y))
    };
    let first = near(-1.0, -1.0);
    let agree = [(1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)].iter().all(|&(x, y)| near(x, y) == first);
    if agree { first } else { Presence::Unsure }
}

/// The texel along an axis that a whole number stands for.
fn place(index: f64, size: u32, tiling: Tiling) -> usize {
    let size = f64::from(size);
    let turn = |x: f64, all: f64| x - (x / all).floor() * all;
    let inside = match tiling {
        Tiling::Clamp => index,
        Tiling::Repeat => turn(index, size),
        Tiling::Mirror => {
            let there = turn(index, 2.0 * size);
            there.min(2.0 * size - 1.0 - there)
        }
    };
    inside.clamp(0.0, size - 1.0) as usize
}
