//! Truth as a raster problem: the irregular z-buffer.
//!
//! All segments of one light share an end or a direction. In light space each is a point, so the
//! receivers are sorted into a grid once and every triangle is run over the receivers near it
//! (Aila and Laine 2004; Johnson et al. 2005; Wyman, Hoetzlein and Lefohn 2015). There is no tree
//! to build, and the occluders nearest to the receiver and to the light come for the same price.
//!
//! # Why the answers are those of the rays
//! A receiver's position and a triangle's planes are rounded to f32 and tested with a proven bound
//! of all roundings. Certain misses are dropped. Certain hits, and whatever the bound leaves open,
//! go to the very functions that a [`Tracer`] calls on the same f64 inputs (hits once
//! all are known, as far as they may be at an end), and the occluders are picked by the same order.
//! Skipped are only triangles with no receiver in their rows and columns, triangles farther from the
//! light than all receivers there, and hits that lie, by more than their bounds, between others.
//!
//! Memory: 16 bytes a vertex and about 40 a receiver (16 of its block, 8 of what is known about its
//! occluders, 4 each of its order, its column and its answer; more where rows are short),
//! 40 for each answer that is not *lit*; nothing a triangle.

mod bins;
mod frame;
mod hits;
mod members;
mod settle;
mod setup;
mod sort;
mod sweep;
mod vertices;
mod work;

use glam::DVec3;
use rayon::prelude::*;
use std::ops::Range;

use super::{Answers, LightEnd, Receiver, Tracer};
use crate::scene::Geometry;
use crate::simd::Level;
use bins::Bins;
use frame::Frame;
use hits::Known;
use members::Members;
use sweep::{Chunk, Found, Shared};
use vertices::Vertices;
pub use work::{Skips, Work};

/// Receivers per square of the grid, on average: rows are four times as high as receivers lie apart.
/// Lower ones mean more runs a triangle, higher ones more receivers tested in vain; 8 and 16 measured
/// alike, and better than 1, 2 and 4, on a terrain of a million triangles.
const PER_CELL: usize = 16;

/// A scene is swept in so many chunks of triangles, if they are within [`CHUNK`].
const CHUNKS: u32 = 64;

/// Fewest and most triangles of a chunk.
const CHUNK: [u32; 2] = [1 << 6, 1 << 14];

/// How the raster is run; no answer depends on it.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// The instruction set.
    pub level: Level,
    /// What is left out.
    pub skips: Skips,
}

impl Default for Options {
    fn default() -> Self {
        Self { level: Level::best(), skips: Skips::ALL }
    }
}

/// The truth about many receivers under one light, in their order: equal to that of
/// [`Tracer::truth`] on every receiver, on all of rayon's threads.
///
/// Scenes whose coordinates are larger than 2^16 times their size, and directional lights whose
/// vector is longer than 64 times the scene, are left to the rays.
#[must_use]
pub fn truths(geometry: &Geometry, receivers: &[Receiver], light: LightEnd) -> Answers {
    truths_with(geometry, receivers, light, Options::default()).0
}

/// As [`truths`], with options, and with a count of the work.
#[must_use]
pub fn truths_with(
    geometry: &Geometry,
    receivers: &[Receiver],
    light: LightEnd,
    options: Options,
) -> (Answers, Work) {
    let space = Space::new(geometry, light);
    let mut job = Job { geometry, receivers, light, space, options, work: Work::default() };
    let mut answers = Answers::lit(receivers.len());
    let left = if space.is_sane() {
        job.frames(&mut answers)
    } else {
        (0..receivers.len() as u32).collect()
    };
    job.leftovers(&left, &mut answers);
    job.holes(&mut answers);
    (answers, job.work)
}

/// Where the scene and the light lie.
#[derive(Clone, Copy, Debug)]
struct Space {
    centre: DVec3,
    /// The largest side of the box around the scene.
    size: f64,
    /// The largest |coordinate| of the scene.
    extent: f64,
    light: LightEnd,
}

impl Space {
    fn new(geometry: &Geometry, light: LightEnd) -> Self {
        let part = |positions: &[DVec3]| super::bvh::bounds(positions.iter());
        let join = |a: (DVec3, DVec3), b: (DVec3, DVec3)| (a.0.min(b.0), a.1.max(b.1));
        let nothing = || part(&[]);
        let parts = geometry.positions.par_chunks(1 << 14).map(part);
        let (low, high) = parts.reduce(nothing, join);
        let extent = low.abs().max(high.abs()).max_element();
        let size = (high - low).max_element();
        Self { centre: (low + high) / 2.0, size, extent, light }
    }

    /// Whether the error bounds of the raster hold: see [`truths`].
    fn is_sane(&self) -> bool {
        let light_is = match self.light {
            LightEnd::Along(v) => (2.0..64.0).contains(&(v.length() / self.size)),
            LightEnd::Point(p) => self.is_near(p),
        };
        let size_is = self.size > 1e-30 && self.size < 1e30;
        size_is && light_is && self.extent < 65_536.0 * self.size
    }

    fn is_near(&self, p: DVec3) -> bool {
        (p - self.centre).length() < 64.0 * self.size
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
    /// Answers the receivers that some frame holds; returns those that are left to the rays.
    fn frames(&mut self, answers: &mut Answers) -> Vec<u32> {
        let axis = Frame::axis(self.light, self.receivers);
        let scale = 1.0 / self.space.size;
        let mut left: Option<Vec<u32>> = None;
        let mut open = Vec::new();
        for frame in Frame::candidates(self.light, self.space.centre, scale, axis) {
            let members = match &left {
                None => Members::All(self.receivers.len()),
                Some(left) => Members::Some(left),
            };
            if let Some((frame, bins)) = self.sorted(&frame, members) {
                open.extend(self.run(&frame, &bins, members.len(), answers));
                return open;
            }
            let held = |&k: &u32| frame.holds(self.receivers[k as usize].position);
            let all = (0..members.len()).map(|k| members.index(k) as u32);
            let (inside, mut outside): (Vec<u32>, Vec<u32>) = all.partition(held);
            match self.sorted(&frame, Members::Some(&inside)) {
                Some((frame, bins)) => open.extend(self.run(&frame, &bins, inside.len(), answers)),
                None => outside.extend(inside),
            }
            left = Some(outside);
        }
        open.extend(left.unwrap_or_default());
        open
    }

    /// What no frame answers (receivers at the light, absurd numbers) goes to the rays.
    fn leftovers(&self, left: &[u32], answers: &mut Answers) {
        if left.is_empty() {
            return;
        }
        let receivers: Vec<Receiver> = left.iter().map(|&k| self.receivers[k as usize]).collect();
        let tracer = if left.len() < 64 {
            Tracer::brute_force(self.geometry)
        } else {
            Tracer::new(self.geometry)
        };
        for (&k, answer) in left.iter().zip(tracer.truths(&receivers, self.light)) {
            *answers.at(k as usize) = answer;
        }
    }

    /// The receivers in the grid of a frame; none unless it holds them all, or there is none.
    ///
    /// The box of the grid is guessed from a sample; only where a receiver lies beside it are all
    /// asked.
    fn sorted(&self, frame: &Frame, members: Members) -> Option<(Frame, Bins)> {
        if members.len() == 0 {
            return None;
        }
        let (receivers, level) = (self.receivers, self.options.level);
        let side = ((members.len() / PER_CELL) as f64).sqrt() as usize;
        let fill = |range| {
            let frame = frame.with_grid(range, side.clamp(1, 4096));
            sort::sorted(&frame, receivers, members, level).map(|bins| (frame, bins))
        };
        let sample = members.sample();
        if !sample.is_empty() {
            let [low, high] = frame.survey(receivers, Members::Some(&sample), level)?;
            let pad = (high - low) / 16.0;
            if let Some(sorted) = fill([low - pad, high + pad]) {
                return Some(sorted);
            }
        }
        fill(frame.survey(receivers, members, level)?)
    }

    /// Answers the receivers of a frame but for those that it returns.
    fn run(
        &mut self,
        frame: &Frame,
        bins: &Bins,
        receivers_held: usize,
        answers: &mut Answers,
    ) -> Vec<u32> {
        let vertices = &Vertices::new(frame, self.geometry, self.options.level);
        let known = &Known::new(bins.index.len());
        let Self { geometry, receivers, light, .. } = *self;
        let extent = self.space.extent;
        let skips = self.options.skips;
        let shared =
            Shared { geometry, receivers, light, extent, frame, bins, vertices, known, skips };
        let found = self.sweep(shared);
        found.iter().for_each(|found| self.work += found.work);
        let casters: usize = self.casters().iter().map(|ids| ids.len()).sum();
        self.work.answered += receivers_held as u64 * casters as u64;
        settle::settle(shared, &found, answers, self.options.level)
    }

    /// Runs all triangles, in chunks side by side. Chunks that follow each other are far apart in the
    /// scene: layers often come in their order, and then each would be nearer to an end than all before.
    fn sweep(&self, shared: Shared) -> Vec<Found> {
        let (count, level) = (self.geometry.triangles.len() as u32, self.options.level);
        let chunk = (count / CHUNKS).clamp(CHUNK[0], CHUNK[1]);
        let chunks = |ids: Range<u32>| {
            let chunk = chunk as usize;
            ids.clone().step_by(chunk).map(move |k| k..ids.end.min(k.saturating_add(chunk as u32)))
        };
        let mut order: Vec<(u32, Range<u32>)> =
            (0..).zip(self.casters().into_iter().flat_map(chunks)).collect();
        order.sort_by_key(|(k, _)| k.reverse_bits());
        let run = |(_, ids)| level.run(Chunk { shared, ids, found: Found::default() });
        order.into_par_iter().map(run).collect()
    }

    /// The triangles that cast and have no holes, in runs.
    fn casters(&self) -> Vec<Range<u32>> {
        let surfaces = &self.geometry.surfaces;
        let mut runs = surfaces.casters(self.geometry.triangles.len() as u32);
        runs.retain(|ids| surfaces.mask(ids.start).is_none());
        runs
    }

    /// Receivers whose segments meet a caster with holes are answered anew, by the rays.
    fn holes(&self, answers: &mut Answers) {
        let Self { geometry, receivers, light, .. } = *self;
        if !geometry.surfaces.have_holes() {
            return;
        }
        let casts = |object: u16| geometry.surfaces.casts_with_holes(object);
        let cut = Tracer::with_objects(geometry, casts);
        let meets = |&k: &u32| {
            let receiver = &receivers[k as usize];
            cut.meets(receiver, light.of(receiver.position))
        };
        let all = (0..receivers.len() as u32).into_par_iter().with_min_len(256);
        let met: Vec<u32> = all.filter(meets).collect();
        self.leftovers(&met, answers);
    }
}
