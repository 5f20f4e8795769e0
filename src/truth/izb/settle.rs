//! From what the chunks found to answers.

use rayon::prelude::*;

use super::super::cover::Contacts;
use super::super::intersect::{Contact, Meeting};
use super::super::{Answer, Answers, Occlusion, Truth};
use super::hits::Hit;
use super::sweep::{Found, Shared};

/// The inside contacts of one receiver nearest to it and to the light: position and triangle.
#[derive(Clone, Copy, Debug)]
struct State {
    nearest: (f64, u32),
    farthest: (f64, u32),
}

impl State {
    const LIT: Self =
        Self { nearest: (f64::INFINITY, u32::MAX), farthest: (f64::NEG_INFINITY, u32::MAX) };

    /// Keeps a contact that is nearer to an end; ties go to the lowest triangle id.
    fn add(&mut self, contact: &Contact) {
        let Contact { t, triangle, .. } = *contact;
        if t < self.nearest.0 || (t == self.nearest.0 && triangle < self.nearest.1) {
            self.nearest = (t, triangle);
        }
        if t > self.farthest.0 || (t == self.farthest.0 && triangle < self.farthest.1) {
            self.farthest = (t, triangle);
        }
    }
}

/// States of the places that have any.
#[derive(Debug)]
struct States {
    /// One more than the index in `list`; 0 of a place without a state.
    slots: Vec<u32>,
    list: Vec<(u32, State)>,
}

impl States {
    fn add(&mut self, place: u32, contact: &Contact) {
        let slot = &mut self.slots[place as usize];
        if *slot == 0 {
            self.list.push((place, State::LIT));
            *slot = self.list.len() as u32;
        }
        self.list[*slot as usize - 1].1.add(contact);
    }

    fn get(&self, place: u32) -> Option<&State> {
        let slot = (self.slots[place as usize] as usize).checked_sub(1)?;
        Some(&self.list[slot].1)
    }
}

/// Turns what the chunks found into answers, and returns the receivers about which nothing is said:
/// hits were dropped because others surround them, and one of those is no inside contact after all.
pub(super) fn settle(shared: Shared, found: &[Found], answers: &mut Answers) -> Vec<u32> {
    let index = |place: u32| shared.bins.index[place as usize];
    for place in found.iter().flat_map(|found| &found.touching) {
        answers.at(index(*place) as usize).touching += 1;
    }
    let mut states = States { slots: vec![0; shared.bins.index.len()], list: Vec::new() };
    for (place, contact) in found.iter().flat_map(|found| &found.inside) {
        states.add(*place, contact);
    }
    let mut open = Vec::new();
    for (place, meeting) in meetings(shared, found) {
        match meeting {
            Meeting::Contact(contact) if contact.is_inside() => states.add(place, &contact),
            _ => open.push(index(place)),
        }
    }
    for (place, state) in &states.list {
        answers.at(index(*place) as usize).truth = shadowed(shared, *place, state);
    }
    let mut marginal: Vec<_> = found.iter().flat_map(|found| &found.marginal).collect();
    marginal.sort_unstable_by_key(|(place, contact)| (*place, contact.triangle));
    for group in marginal.chunk_by(|a, b| a.0 == b.0) {
        let place = group[0].0;
        let truth = with_marginal(shared, place, states.get(place), group);
        answers.at(index(place) as usize).truth = truth;
    }
    for place in found.iter().flat_map(|found| &found.void) {
        let ambiguous = Answer { truth: Truth::Ambiguous, touching: 0 };
        *answers.at(index(*place) as usize) = ambiguous;
    }
    open.sort_unstable();
    open.dedup();
    open
}

/// How the triangles of hits that may be at an end meet their segments.
fn meetings(shared: Shared, found: &[Found]) -> Vec<(u32, Meeting)> {
    let meet = |hit: &Hit| {
        if shared.skips.between && shared.known.surround(hit) {
            return None;
        }
        let corners = shared.geometry.corners(hit.triangle);
        let meeting = shared.segment(hit.place).meet_inside(hit.triangle, &corners);
        Some((hit.place, meeting))
    };
    found.par_iter().flat_map_iter(|found| found.hits.iter().filter_map(meet)).collect()
}

fn shadowed(shared: Shared, place: u32, state: &State) -> Truth {
    let length = shared.segment(place).length();
    Truth::Shadowed(Occlusion {
        occluder: state.nearest.1,
        gap: state.nearest.0 * length,
        first: state.farthest.1,
        first_gap: state.farthest.0 * length,
    })
}

/// The verdict where an edge, a vertex or a plane is met beside what lies inside.
fn with_marginal(
    shared: Shared,
    place: u32,
    state: Option<&State>,
    group: &[&(u32, Contact)],
) -> Truth {
    let segment = shared.segment(place);
    let corners = |id| shared.geometry.corners(id);
    let mut contacts = Contacts::default();
    for id in state.iter().flat_map(|state| [state.nearest.1, state.farthest.1]) {
        if let Meeting::Contact(contact) = segment.meet(id, &corners(id)) {
            contacts.add(contact);
        }
    }
    group.iter().for_each(|(_, contact)| contacts.add(*contact));
    contacts.answer(&segment, corners).truth
}
