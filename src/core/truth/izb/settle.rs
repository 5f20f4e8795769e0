//! From what the chunks found to answers.

use glam::DVec3;
use rayon::prelude::*;

use super::super::cover::Contacts;
use super::super::intersect::{Contact, Meeting};
use super::super::plane::{Vector, side_by_side};
use super::super::{Answer, Answers, Occlusion, Truth};
use super::hits::Hits;
use super::sweep::{Found, Shared};
use crate::simd::lanes::{BATCH, Lanes};
use crate::simd::{Kernel, Level};

/// An inside contact: of which receiver, where on its segment and with which triangle.
#[derive(Clone, Copy, Debug)]
struct Met {
    receiver: u32,
    triangle: u32,
    t: f64,
}

/// What is known about one receiver: the inside contacts nearest to it and to the light, position and
/// triangle, and how many triangles it touches.
#[derive(Clone, Copy, Debug)]
struct State {
    receiver: u32,
    touching: u32,
    nearest: (f64, u32),
    farthest: (f64, u32),
}

impl State {
    const fn lit(receiver: u32) -> Self {
        let (nearest, farthest) = ((f64::INFINITY, u32::MAX), (f64::NEG_INFINITY, u32::MAX));
        Self { receiver, touching: 0, nearest, farthest }
    }

    /// Keeps a contact that is nearer to an end; ties go to the lowest triangle id.
    fn add(&mut self, t: f64, triangle: u32) {
        if t < self.nearest.0 || (t == self.nearest.0 && triangle < self.nearest.1) {
            self.nearest = (t, triangle);
        }
        if t > self.farthest.0 || (t == self.farthest.0 && triangle < self.farthest.1) {
            self.farthest = (t, triangle);
        }
    }

    fn answer(&self, shared: Shared) -> Answer {
        let touching = self.touching;
        if self.nearest.1 == u32::MAX {
            return Answer { truth: Truth::Lit, touching };
        }
        let length = shared.segment_of(self.receiver).length();
        let truth = Truth::Shadowed(Occlusion {
            occluder: self.nearest.1,
            gap: self.nearest.0 * length,
            first: self.farthest.1,
            first_gap: self.farthest.0 * length,
        });
        Answer { truth, touching }
    }
}

/// States of the receivers of a frame that have any, side by side with their answers.
#[derive(Debug)]
struct States<'a> {
    answers: &'a mut Answers,
    /// Where in the answers that are not *lit* those of this frame begin.
    first: usize,
    list: Vec<State>,
}

impl States<'_> {
    /// The state of a receiver; it gets one.
    fn of(&mut self, receiver: u32) -> &mut State {
        let slot = self.answers.slot(receiver as usize) - self.first;
        if slot == self.list.len() {
            self.list.push(State::lit(receiver));
        }
        &mut self.list[slot]
    }
}

/// Turns what the chunks found into answers, and returns the receivers about which nothing is said:
/// hits were dropped because others surround them, and one of those is no inside contact after all.
pub(super) fn settle(
    shared: Shared,
    found: &[Found],
    answers: &mut Answers,
    level: Level,
) -> Vec<u32> {
    let index = |place: u32| shared.bins.index[place as usize];
    let first = answers.others();
    let mut states = States { answers, first, list: Vec::new() };
    for place in found.iter().flat_map(|found| &found.touching) {
        states.of(index(*place)).touching += 1;
    }
    for (place, contact) in found.iter().flat_map(|found| &found.inside) {
        states.of(index(*place)).add(contact.t, contact.triangle);
    }
    let mut open = Vec::new();
    let measure = |found: &Found| level.run(Measure { shared, hits: &found.hits });
    let measured: Vec<Measured> = found.par_iter().map(measure).collect();
    for Measured { met, open: left } in measured {
        met.iter().for_each(|met| states.of(met.receiver).add(met.t, met.triangle));
        open.extend(left);
    }
    let mut marginal: Vec<_> = found.iter().flat_map(|found| &found.marginal).collect();
    marginal.sort_unstable_by_key(|(place, contact)| (*place, contact.triangle));
    let marginal = marginal.chunk_by(|a, b| a.0 == b.0);
    let marginal = marginal.map(|group| {
        let place = group[0].0;
        (index(place), with_marginal(shared, place, states.of(index(place)), group))
    });
    let marginal: Vec<_> = marginal.collect();
    let States { answers, list, .. } = states;
    let frame = answers.others_from(first).par_iter_mut().zip(&list);
    frame.with_min_len(1 << 10).for_each(|(answer, state)| *answer = state.answer(shared));
    for (receiver, truth) in marginal {
        answers.at(receiver as usize).truth = truth;
    }
    for place in found.iter().flat_map(|found| &found.void) {
        let ambiguous = Answer { truth: Truth::Ambiguous, touching: 0 };
        *answers.at(index(*place) as usize) = ambiguous;
    }
    open.sort_unstable();
    open.dedup();
    open
}

/// The hits of a chunk that may be at an end, to be measured in f64.
struct Measure<'a> {
    shared: Shared<'a>,
    hits: &'a Hits,
}

/// What they are: inside contacts, and the receivers of hits that are none.
#[derive(Debug, Default)]
struct Measured {
    met: Vec<Met>,
    open: Vec<u32>,
}

impl Kernel for Measure<'_> {
    type Output = Measured;

    #[inline(always)]
    fn run(self, _: bool) -> Measured {
        let mut measured = Measured::default();
        measured.met.reserve(self.hits.len());
        let mut hits = self.hits.iter().filter(|hit| !self.shared.is_between(hit));
        loop {
            let (mut receivers, mut triangles, mut count) = ([0; BATCH], [0; BATCH], 0);
            for hit in hits.by_ref().take(BATCH) {
                receivers[count] = self.shared.bins.index[hit.place as usize];
                triangles[count] = hit.triangle;
                count += 1;
            }
            if count == 0 {
                return measured;
            }
            // Lanes beyond `count` measure receiver 0 against triangle 0, for nobody.
            let crossings = self.shared.lines_of(&receivers).crossing(&self.corners(&triangles));
            for k in 0..count {
                let (crossing, receiver, triangle) =
                    (crossings.lane(k), receivers[k], triangles[k]);
                if crossing.is_between_ends() {
                    measured.met.push(Met { receiver, triangle, t: crossing.t });
                } else {
                    measured.add(self.shared, receiver, triangle);
                }
            }
        }
    }
}

impl Measure<'_> {
    /// The corners of eight triangles.
    #[inline(always)]
    fn corners(&self, triangles: &[u32; BATCH]) -> [Vector<Lanes>; 3] {
        let mut corners = [[DVec3::ZERO; BATCH]; 3];
        for (k, &triangle) in triangles.iter().enumerate() {
            let [a, b, c] = self.shared.geometry.triangles[triangle as usize];
            let position = |vertex: u32| self.shared.geometry.positions[vertex as usize];
            (corners[0][k], corners[1][k], corners[2][k]) = (position(a), position(b), position(c));
        }
        [side_by_side(&corners[0]), side_by_side(&corners[1]), side_by_side(&corners[2])]
    }
}

impl Measured {
    /// Adds a hit near an end of its segment, or on a plane nearly parallel to it.
    #[cold]
    fn add(&mut self, shared: Shared, receiver: u32, triangle: u32) {
        let corners = shared.geometry.corners(triangle);
        match shared.segment_of(receiver).meet_inside(triangle, &corners) {
            Meeting::Contact(contact) if contact.is_inside() => {
                self.met.push(Met { receiver, triangle, t: contact.t });
            }
            Meeting::Miss | Meeting::Touching | Meeting::Contact(_) => self.open.push(receiver),
        }
    }
}

/// The verdict where an edge, a vertex or a plane is met beside what lies inside.
fn with_marginal(shared: Shared, place: u32, state: &State, group: &[&(u32, Contact)]) -> Truth {
    let segment = shared.segment(place);
    let corners = |id| shared.geometry.corners(id);
    let mut contacts = Contacts::default();
    let ends = [state.nearest.1, state.farthest.1];
    for id in ends.into_iter().filter(|&id| id != u32::MAX) {
        if let Meeting::Contact(contact) = segment.meet(id, &corners(id)) {
            contacts.add(contact);
        }
    }
    group.iter().for_each(|(_, contact)| contacts.add(*contact));
    contacts.answer(&segment, corners).truth
}
