//! The ray-traced truth: a tree of conservative boxes, exact tests at its leaves.

use glam::DVec3;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::{BvhBuildParams, aabb::Aabb, ray::Ray};

use super::cover::Contacts;
use super::holes::{Holes, Presence};
use super::intersect::{Contact, Meeting, Segment};
use super::{Answer, Faces, FirstHit, LightEnd, Receiver, SeenFaces, Truth};
use crate::scene::Geometry;

/// Below this many triangles testing all of them is quicker than a tree.
const BRUTE: usize = 16;

/// Boxes grow by this much in the space where the scene spans [-1, 1]. A segment clamped to
/// [-2, 2] is tested against them in f32: origin and box are off by 2^-23, the plane distance
/// (at most 3) by a factor of 1 + 2^-22 (direction, reciprocal, two products), and `obvhs`
/// replaces direction components below 2^-23 by 2^-23. Together below 2^-19.4.
const PAD: f64 = 1.0 / (1 << 18) as f64;

/// Answers what meets a segment. Built once for a scene, shared by any number of threads.
pub struct Tracer {
    /// Corners by triangle id.
    corners: Vec<[DVec3; 3]>,
    /// Triangles in the order of the leaves.
    leaves: Vec<Leaf>,
    bvh: Option<Bvh2>,
    centre: DVec3,
    /// World length to the space of the boxes; a power of two.
    scale: f64,
    /// The largest |coordinate|.
    extent: f64,
    /// Where surfaces have holes, if any has.
    holes: Option<Box<Holes>>,
}

struct Leaf {
    corners: [DVec3; 3],
    id: u32,
}

impl std::fmt::Debug for Tracer {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Tracer({} of {} triangles)", self.leaves.len(), self.corners.len())
    }
}

impl Tracer {
    /// A tracer in which every triangle occludes that casts.
    #[must_use]
    pub fn new(geometry: &Geometry) -> Self {
        Self::with_objects(geometry, |_| true)
    }

    /// A tracer that tests every triangle: the arbiter of the tree, with the same answers.
    #[must_use]
    pub fn brute_force(geometry: &Geometry) -> Self {
        Self::bare(geometry, |_| true)
    }

    /// A tracer in which only the triangles of accepted objects occlude, if they cast. Triangle ids stay
    /// those of `geometry`.
    #[must_use]
    pub fn with_objects(geometry: &Geometry, accept: impl Fn(u16) -> bool) -> Self {
        Self::bare(geometry, accept).planted()
    }

    fn bare(geometry: &Geometry, accept: impl Fn(u16) -> bool) -> Self {
        let ids = 0..geometry.triangles.len() as u32;
        let corners: Vec<_> = ids.clone().map(|id| geometry.corners(id)).collect();
        let object = |id: &u32| geometry.object.get(*id as usize);
        let casters = geometry.surfaces.casters(ids.end).into_iter().flatten();
        let accepted = casters.filter(|id| object(id).is_none_or(|&o| accept(o)));
        let leaves: Vec<_> =
            accepted.map(|id| Leaf { corners: corners[id as usize], id }).collect();
        let (low, high) = bounds(geometry.positions.iter());
        let extent = low.abs().max(high.abs()).max_element();
        let centre = (low + high) / 2.0;
        let scale = power_of_two_below(2.0 / (high - low).max_element());
        let holes = Holes::of(geometry);
        Self { corners, leaves, bvh: None, centre, scale, extent, holes }
    }

    /// Grows the tree and puts the triangles in its order.
    fn planted(mut self) -> Self {
        if self.leaves.len() >= BRUTE && self.scale.is_normal() {
            let boxes: Vec<_> = self.leaves.iter().map(|leaf| self.padded_box(leaf)).collect();
            let bvh = build_bvh2(&boxes, BvhBuildParams::fast_build(), &mut Default::default());
            let order = &bvh.primitive_indices;
            let leaf = |&k: &u32| Leaf { ..self.leaves[k as usize] };
            self.leaves = order.iter().map(leaf).collect();
            self.bvh = Some(bvh);
        }
        self
    }

    fn padded_box(&self, leaf: &Leaf) -> Aabb {
        let (low, high) = bounds(leaf.corners.iter());
        let pad = DVec3::splat(PAD);
        Aabb::new((self.box_space(low) - pad).as_vec3a(), (self.box_space(high) + pad).as_vec3a())
    }

    fn box_space(&self, p_world: DVec3) -> DVec3 {
        (p_world - self.centre) * self.scale
    }

    /// A distance that leaves the scene from any point of its bounding box: a power of two, so
    /// that a direction keeps its bits when multiplied with it.
    #[must_use]
    pub fn reach(&self) -> f64 {
        if self.scale.is_normal() { 8.0 / self.scale } else { 1.0 }
    }

    /// What `receiver` sees towards `light_end`. Both sides of every triangle occlude, the
    /// receiver's own triangle and touching ones do not.
    #[must_use]
    pub fn truth(&self, receiver: &Receiver, light_end: DVec3) -> Answer {
        let segment = self.segment(receiver.position, light_end);
        if segment.is_void() {
            return Answer { truth: Truth::Ambiguous, touching: 0 };
        }
        let contacts = self.contacts(&segment, &SeenFaces::Alike(Faces::Both), receiver.triangle);
        contacts.answer(&segment, |id| self.corners[id as usize])
    }

    /// The truth about many receivers under one light, in their order.
    #[must_use]
    pub fn truths(&self, receivers: &[Receiver], light: LightEnd) -> Vec<Answer> {
        use rayon::prelude::*;
        let one = |receiver: &Receiver| self.truth(receiver, light.of(receiver.position));
        receivers.par_iter().with_min_len(256).map(one).collect()
    }

    /// The first triangle strictly between `from` and `to` of which `faces` are seen from `from`;
    /// `exclude` skips one id.
    #[must_use]
    pub fn first_hit(
        &self,
        from: DVec3,
        to: DVec3,
        faces: Faces,
        exclude: Option<u32>,
    ) -> FirstHit {
        self.first_of(from, to, &SeenFaces::Alike(faces), exclude)
    }

    /// As [`Self::first_hit`], where the sides that are seen may differ from triangle to triangle.
    #[must_use]
    pub fn first_of(
        &self,
        from: DVec3,
        to: DVec3,
        drawn: &SeenFaces,
        exclude: Option<u32>,
    ) -> FirstHit {
        let segment = self.segment(from, to);
        if segment.is_void() {
            return FirstHit::Ambiguous;
        }
        let contacts = self.contacts(&segment, drawn, exclude.unwrap_or(u32::MAX));
        contacts.first_hit(&segment, |id| self.corners[id as usize])
    }

    /// Where triangle `id` alone blocks the segment: the position that [`Self::first_hit`] gives if
    /// that triangle is the first; `None` where the segment does not pass through its inside.
    #[must_use]
    pub fn hit_of(&self, id: u32, from: DVec3, to: DVec3) -> Option<f64> {
        let segment = self.segment(from, to);
        match segment.meet(id, &self.corners[id as usize]) {
            Meeting::Contact(contact) if self.stops(&segment, &contact) => Some(contact.t),
            Meeting::Miss | Meeting::Touching | Meeting::Contact(_) => None,
        }
    }

    /// Whether a contact passes through the inside of its triangle where that is certainly there.
    fn stops(&self, segment: &Segment, contact: &Contact) -> bool {
        contact.is_inside() && self.presence(segment, contact) == Presence::There
    }

    /// Whether a triangle is there at its contact.
    fn presence(&self, segment: &Segment, contact: &Contact) -> Presence {
        let corners = &self.corners[contact.triangle as usize];
        let holes = self.holes.as_ref();
        holes.map_or(Presence::There, |holes| holes.presence(segment, contact, corners))
    }

    /// Whether the segment of a receiver touches anything, or meets it, be it there or not.
    pub(super) fn meets(&self, receiver: &Receiver, light_end: DVec3) -> bool {
        let segment = self.segment(receiver.position, light_end);
        let mut found = segment.is_void();
        self.candidates(&segment, |leaf| {
            let other = leaf.id != receiver.triangle;
            found |= other && segment.meet(leaf.id, &leaf.corners) != Meeting::Miss;
        });
        found
    }

    /// Any triangle that blocks `receiver` with its inside, which alone makes its truth
    /// [`Truth::Shadowed`]; `guess`, a triangle that occludes in this tracer or the receiver's own, is
    /// asked first. `None` says nothing: edges may still close up.
    #[must_use]
    pub fn blocker(&self, receiver: &Receiver, light_end: DVec3, guess: u32) -> Option<u32> {
        let segment = self.segment(receiver.position, light_end);
        let blocks = |id: u32| {
            let meeting = || segment.meet(id, &self.corners[id as usize]);
            id != receiver.triangle
                && matches!(meeting(), Meeting::Contact(contact) if self.stops(&segment, &contact))
        };
        if segment.is_void() || blocks(guess) {
            return (!segment.is_void()).then_some(guess);
        }
        let Some(bvh) = &self.bvh else {
            return self.leaves.iter().map(|leaf| leaf.id).find(|&id| blocks(id));
        };
        let (from, to) = segment.clamped(|p| self.box_space(p))?;
        let ray = Ray::new(from.as_vec3a(), (to - from).as_vec3a(), 0.0, 1.0);
        let mut found = None;
        bvh.ray_traverse_miss(ray, |_, k| {
            found = Some(self.leaves[k].id).filter(|&id| blocks(id));
            if found.is_some() { f32::NEG_INFINITY } else { f32::INFINITY }
        });
        found
    }

    fn segment(&self, from: DVec3, to: DVec3) -> Segment {
        Segment::of_scene(from, to, self.extent)
    }

    /// Everything that meets the segment.
    fn contacts(&self, segment: &Segment, drawn: &SeenFaces, exclude: u32) -> Contacts {
        let mut contacts = Contacts::default();
        self.candidates(segment, |leaf| {
            if leaf.id == exclude {
                return;
            }
            match segment.meet(leaf.id, &leaf.corners) {
                Meeting::Miss => {}
                Meeting::Touching => contacts.touch(),
                Meeting::Contact(contact) if counts(drawn.of(leaf.id), contact.facing()) => {
                    match self.presence(segment, &contact) {
                        Presence::There => contacts.add(contact),
                        Presence::Hole => {}
                        // As if it met nothing but an edge: it neither blocks nor lets through.
                        Presence::Unsure => contacts.add(Contact { signs: [0; 3], ..contact }),
                    }
                }
                Meeting::Contact(_) => {}
            }
        });
        contacts
    }

    /// Calls `visit` for every triangle whose box the segment may meet.
    fn candidates(&self, segment: &Segment, mut visit: impl FnMut(&Leaf)) {
        let Some(bvh) = &self.bvh else {
            return self.leaves.iter().for_each(visit);
        };
        if let Some((from, to)) = segment.clamped(|p| self.box_space(p)) {
            let ray = Ray::new(from.as_vec3a(), (to - from).as_vec3a(), 0.0, 1.0);
            bvh.ray_traverse_anyhit(ray, |_, k| visit(&self.leaves[k]));
        }
    }
}

/// Whether a triangle seen from this side is wanted; one seen edge-on always is.
fn counts(faces: Option<Faces>, facing: i8) -> bool {
    match faces {
        Some(Faces::Both) => true,
        Some(Faces::Front) => facing <= 0,
        Some(Faces::Back) => facing >= 0,
        None => false,
    }
}

/// The smallest box around the points.
pub(super) fn bounds<'a>(points: impl Iterator<Item = &'a DVec3>) -> (DVec3, DVec3) {
    points.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), &p| (low.min(p), high.max(p)))
}

/// The largest power of two not above a positive normal number; others are kept.
fn power_of_two_below(x: f64) -> f64 {
    f64::from_bits(x.to_bits() & (0x7ff << 52))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_stated_pad_covers_the_rounding_of_the_box_test() {
        let origin_and_box = 2.0 * 2.0 / f64::from(1 << 23);
        let distance = 3.0 / f64::from(1 << 22);
        let replaced = 2.0 * f64::from(f32::EPSILON);
        assert!(origin_and_box + distance + replaced < PAD);
        assert!(origin_and_box + distance + replaced > PAD / 4.0, "the pad is needlessly wide");
    }

    #[test]
    fn box_space_is_reached_without_a_degenerate_scale() {
        let empty = Tracer::new(&Geometry::default());
        assert_eq!(empty.reach(), 1.0);
        let answer = empty.truth(&Receiver { position: DVec3::X, triangle: 0 }, DVec3::Y);
        assert_eq!(answer, Answer { truth: Truth::Lit, touching: 0 });
        assert_eq!(power_of_two_below(3.9), 2.0);
    }
}
