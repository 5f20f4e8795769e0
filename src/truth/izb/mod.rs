//! Truth as a raster problem: the irregular z-buffer.
//!
//! All segments of one light share an end or a direction. In light space each is a point, so the
//! receivers are sorted into a grid once and every triangle is run over the receivers of its cells
//! (Aila and Laine 2004; Johnson et al. 2005; Wyman, Hoetzlein and Lefohn 2015). There is no tree
//! to build, and the occluders nearest to the receiver and to the light come for the same price.
//!
//! # Why the answers are those of the rays
//! A receiver's position and a triangle's planes are rounded to f32 and tested with a proven bound
//! of all roundings. Certain misses are dropped. Certain hits, and whatever the bound leaves open,
//! go to the very functions that a [`Tracer`](super::Tracer) calls on the same f64 inputs, and the
//! occluders are picked by the same order. Skipped are only triangles whose cells hold no receiver,
//! triangles farther from the light than all receivers of their cells, and hits that lie, by more
//! than their bounds, between the occluders already known.
//!
//! Cost: 40 bytes a triangle at most (12 where it can shadow something), 44 a vertex, 24 a receiver
//! and 40 for its state, beside the answers.

mod bins;
mod frame;
mod setup;
mod sweep;

use std::ops::Range;

use glam::DVec3;
use rayon::prelude::*;

use super::intersect::{Contact, Segment};
use super::{Answer, LightEnd, Occlusion, Receiver, Tracer, Truth};
use crate::scene::Geometry;
use crate::simd::Level;
use bins::Bins;
use frame::Frame;
use setup::Vertices;
use sweep::{Band, Rare, Shared, State};

/// Receivers per cell, on average. Measured: below 1 the rows of cells cost, above 8 the tests.
const PER_CELL: usize = 2;

/// How the raster is run; no answer depends on it.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// The instruction set.
    pub level: Level,
}

impl Default for Options {
    fn default() -> Self {
        Self { level: Level::best() }
    }
}

/// How much was tested.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Work {
    /// Triangles that can shadow a receiver, over all frames.
    pub triangles: u64,
    /// Pairs that f32 left open.
    pub escalated: u64,
}

/// The truth about many receivers under one light, in their order: equal to that of
/// [`Tracer::truth`] on every receiver, on all of rayon's threads.
///
/// Scenes whose coordinates are larger than 2^16 times their size, and directional lights whose
/// vector is longer than 64 times the scene, are left to the rays.
#[must_use]
pub fn truths(geometry: &Geometry, receivers: &[Receiver], light: LightEnd) -> Vec<Answer> {
    truths_with(geometry, receivers, light, Options::default()).0
}

/// As [`truths`], with options, and with a count of the work.
#[must_use]
pub fn truths_with(
    geometry: &Geometry,
    receivers: &[Receiver],
    light: LightEnd,
    options: Options,
) -> (Vec<Answer>, Work) {
    let space = Space::new(geometry, receivers, light);
    if !space.is_sane() {
        return (Tracer::new(geometry).truths(receivers, light), Work::default());
    }
    let mut job = Job { geometry, receivers, light, space, options, work: Work::default() };
    let axis = Frame::axis(light, receivers);
    let frames = Frame::candidates(light, space.centre, 1.0 / space.size, axis);
    let mut answers = vec![Answer { truth: Truth::Lit, touching: 0 }; receivers.len()];
    let mut members: Vec<u32> = (0..receivers.len() as u32).collect();
    for frame in frames {
        let held = |&r: &u32| frame.holds(receivers[r as usize].position);
        let (inside, outside): (Vec<u32>, Vec<u32>) = members.par_iter().copied().partition(held);
        job.run(&frame, &inside, &mut answers);
        members = outside;
        if members.is_empty() {
            break;
        }
    }
    if !members.is_empty() {
        // At the light or not a number: too few to build anything for.
        let arbiter = Tracer::brute_force(geometry);
        for receiver in members.into_iter().map(|r| r as usize) {
            let end = light.of(receivers[receiver].position);
            answers[receiver] = arbiter.truth(&receivers[receiver], end);
        }
    }
    (answers, job.work)
}

/// Where scene, receivers and light lie.
#[derive(Clone, Copy, Debug)]
struct Space {
    centre: DVec3,
    /// The largest side of the box around scene and receivers.
    size: f64,
    /// The largest |coordinate| of the scene.
    extent: f64,
    /// The largest |coordinate| of anything.
    largest: f64,
    light: LightEnd,
}

impl Space {
    fn new(geometry: &Geometry, receivers: &[Receiver], light: LightEnd) -> Self {
        let (low, high) = super::bvh::bounds(geometry.positions.iter());
        let extent = low.abs().max(high.abs()).max_element();
        let (near, far) = super::bvh::bounds(receivers.iter().map(|r| &r.position));
        let (low, high) = (low.min(near), high.max(far));
        let largest = low.abs().max(high.abs()).max_element();
        let size = (high - low).max_element();
        Self { centre: (low + high) / 2.0, size, extent, largest, light }
    }

    /// Whether the error bounds of the raster hold: see [`truths`].
    fn is_sane(&self) -> bool {
        let light_is = match self.light {
            LightEnd::Along(v) => (4.0..64.0).contains(&(v.length() / self.size)),
            LightEnd::Point(p) => p.is_finite() && (p - self.centre).length() < 64.0 * self.size,
        };
        let size_is = self.size > 1e-30 && self.size < 1e30;
        size_is && light_is && self.largest < 65_536.0 * self.size
    }
}

struct Job<'a> {
    geometry: &'a Geometry,
    receivers: &'a [Receiver],
    light: LightEnd,
    space: Space,
    options: Options,
    work: Work,
}

impl Job<'_> {
    /// Answers the receivers that a frame holds.
    fn run(&mut self, frame: &Frame, members: &[u32], answers: &mut [Answer]) {
        if members.is_empty() {
            return;
        }
        let side = ((members.len() / PER_CELL) as f64).sqrt() as usize;
        let places = members.iter().map(|&r| self.receivers[r as usize].position);
        let frame = &frame.with_grid(places, side.clamp(1, 4096));
        let bins = &Bins::new(frame, self.receivers, members);
        let vertices = &Vertices::new(frame, self.geometry);
        let items = &vertices.items(self.geometry, bins);
        let Self { geometry, receivers, light, .. } = *self;
        let extent = self.space.extent;
        let shared = Shared { geometry, receivers, light, extent, frame, bins, vertices, items };
        let mut states = vec![State::LIT; bins.len()];
        let rare = self.sweep(&shared, &mut states);
        self.work.triangles += items.len() as u64;
        self.work.escalated += rare.escalated;
        self.settle(bins, &states, rare, answers);
    }

    /// Runs the bands, one after the other or side by side.
    fn sweep(&self, shared: &Shared, states: &mut [State]) -> Rare {
        let bands: Vec<Band> = bands(shared, states);
        let level = self.options.level;
        let rare: Vec<Rare> = bands.into_par_iter().map(|band| level.run(band)).collect();
        rare.into_iter().fold(Rare::default(), |mut all, mut next| {
            all.marginal.append(&mut next.marginal);
            all.touching.append(&mut next.touching);
            all.void.append(&mut next.void);
            all.escalated += next.escalated;
            all
        })
    }

    /// Turns states into answers.
    fn settle(&self, bins: &Bins, states: &[State], mut rare: Rare, answers: &mut [Answer]) {
        for (&index, state) in bins.index.iter().zip(states) {
            if state.nearest.1 != u32::MAX {
                answers[index as usize].truth = self.shadowed(index, state);
            }
        }
        for place in &rare.touching {
            answers[bins.index[*place as usize] as usize].touching += 1;
        }
        rare.marginal.sort_unstable_by_key(|(place, contact)| (*place, contact.triangle));
        for group in rare.marginal.chunk_by(|a, b| a.0 == b.0) {
            let index = bins.index[group[0].0 as usize];
            let answer = &mut answers[index as usize];
            answer.truth = self.marginal(index, &states[group[0].0 as usize], group);
        }
        for place in rare.void {
            answers[bins.index[place as usize] as usize] =
                Answer { truth: Truth::Ambiguous, touching: 0 };
        }
    }

    fn segment(&self, index: u32) -> Segment {
        let from = self.receivers[index as usize].position;
        Segment::of_scene(from, self.light.of(from), self.space.extent)
    }

    fn shadowed(&self, index: u32, state: &State) -> Truth {
        let length = self.segment(index).length();
        Truth::Shadowed(Occlusion {
            occluder: state.nearest.1,
            gap: state.nearest.0 * length,
            first: state.farthest.1,
            first_gap: state.farthest.0 * length,
        })
    }

    fn marginal(&self, index: u32, state: &State, group: &[(u32, Contact)]) -> Truth {
        let segment = self.segment(index);
        let corners = |id| self.geometry.corners(id);
        let marginal = group.iter().map(|(_, contact)| *contact);
        sweep::gather(state, &segment, marginal, &corners).answer(&segment, corners).truth
    }
}

/// Splits the grid into bands of about as many receivers: one on one thread, else a few each, so
/// that threads that finish early help.
fn bands<'a>(shared: &Shared<'a>, mut states: &'a mut [State]) -> Vec<Band<'a>> {
    let threads = rayon::current_num_threads();
    let wanted = if threads == 1 { 1 } else { 4 * threads };
    let (bins, mut bands) = (shared.bins, Vec::new());
    let (mut row, mut first) = (0, 0);
    for k in 1..=wanted {
        let until = bins.len() * k / wanted;
        let end = if k == wanted { bins.cells } else { row_of(bins, until).max(row) };
        let last = bins.start[end * bins.cells] as usize;
        let (mine, rest) = states.split_at_mut(last - first);
        states = rest;
        let rows: Range<usize> = row..end;
        bands.push(Band { shared: *shared, rows, first, states: mine, rare: Rare::default() });
        (row, first) = (end, last);
    }
    bands
}

/// The first row that starts at or after a receiver.
fn row_of(bins: &Bins, receiver: usize) -> usize {
    let rows = (0..=bins.cells).collect::<Vec<_>>();
    rows.partition_point(|row| (bins.start[row * bins.cells] as usize) < receiver)
}
