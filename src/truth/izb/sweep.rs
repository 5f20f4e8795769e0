//! The sweep: every triangle over the receivers of its cells, sixteen at a time.
#![allow(clippy::needless_range_loop, reason = "loops over indices become vectors")]

use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

use rayon::prelude::*;

use super::super::intersect::{Contact, Meeting, Segment};
use super::super::{LightEnd, Receiver};
use super::bins::{Bins, LANES};
use super::frame::Frame;
use super::setup::{Batch, Plane};
use super::vertices::{Item, Vertices};
use super::work::{Skips, Work};
use crate::scene::Geometry;
use crate::simd::Kernel;
use crate::simd::lanes::BATCH;

/// What all chunks share.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shared<'a> {
    pub(super) geometry: &'a Geometry,
    pub(super) receivers: &'a [Receiver],
    pub(super) light: LightEnd,
    /// The largest |coordinate| of the scene.
    pub(super) extent: f64,
    pub(super) frame: &'a Frame,
    pub(super) bins: &'a Bins,
    pub(super) vertices: &'a Vertices<'a>,
    pub(super) known: &'a Known,
    pub(super) skips: Skips,
}

/// Depth bounds of the occluders found so far, by sorted receiver: that of the nearest is at most
/// the first, that of the farthest at least the second. Threads may overwrite a better bound by a
/// weaker one; both hold, and no answer depends on them.
#[derive(Debug)]
pub(super) struct Known {
    bounds: Vec<[AtomicU32; 2]>,
}

impl Known {
    pub(super) fn new(len: usize) -> Self {
        let lit = |_| [f32::INFINITY, f32::NEG_INFINITY].map(|x| AtomicU32::new(x.to_bits()));
        let mut bounds = Vec::new();
        let places = (0..len).into_par_iter().with_min_len(1 << 16);
        places.map(lit).collect_into_vec(&mut bounds);
        Self { bounds }
    }

    #[inline(always)]
    fn get(&self, place: usize) -> [f32; 2] {
        let [near, far] = &self.bounds[place];
        [f32::from_bits(near.load(Relaxed)), f32::from_bits(far.load(Relaxed))]
    }

    fn tighten(&self, place: usize, depths: [f32; 2]) {
        let [near, far] = self.get(place);
        self.bounds[place][0].store(near.min(depths[1]).to_bits(), Relaxed);
        self.bounds[place][1].store(far.max(depths[0]).to_bits(), Relaxed);
    }
}

/// The inside contacts of one receiver nearest to it and to the light: position and triangle.
#[derive(Clone, Copy, Debug)]
pub(super) struct State {
    pub(super) nearest: (f64, u32),
    pub(super) farthest: (f64, u32),
}

/// What a chunk of triangles found, by sorted receiver.
#[derive(Debug, Default)]
pub(super) struct Found {
    pub(super) inside: Vec<(u32, Contact)>,
    pub(super) marginal: Vec<(u32, Contact)>,
    pub(super) touching: Vec<u32>,
    /// Segments about which nothing can be said.
    pub(super) void: Vec<u32>,
    pub(super) work: Work,
}

/// A chunk of triangles to be run over all receivers.
#[derive(Debug)]
pub(super) struct Chunk<'a> {
    pub(super) shared: Shared<'a>,
    pub(super) ids: std::ops::Range<u32>,
    pub(super) found: Found,
}

impl Kernel for Chunk<'_> {
    type Output = Found;

    #[inline(always)]
    fn run(mut self, _has_fma: bool) -> Found {
        let Shared { geometry, vertices, bins, skips, .. } = self.shared;
        let mut batch = Batch::EMPTY;
        for id in self.ids.clone() {
            let corners = geometry.triangles[id as usize];
            self.found.work.triangles += 1;
            match vertices.item(corners, bins, skips) {
                Ok(item) => batch.push(id, vertices.corners(corners), item),
                Err(skipped) => self.found.work.skip(skipped),
            }
            if batch.len == BATCH {
                self.sweep(&mut batch);
            }
        }
        self.sweep(&mut batch);
        self.found
    }
}

impl Chunk<'_> {
    /// Runs the triangles of a batch over the receivers of their cells, and empties it.
    #[inline(always)]
    fn sweep(&mut self, batch: &mut Batch) {
        let planes = batch.planes(self.shared.frame);
        self.found.work.swept += batch.len as u64;
        for k in 0..batch.len {
            self.sweep_one(batch.ids[k], batch.items[k], &planes.get(k));
        }
        batch.len = 0;
    }

    #[inline(always)]
    fn sweep_one(&mut self, id: u32, item: Item, plane: &Plane) {
        let bins = self.shared.bins;
        let (left, right) = (usize::from(item.columns[0]), usize::from(item.columns[1]) + 1);
        for row in item.rows[0]..=item.rows[1] {
            let run = bins.run(usize::from(row), left, right);
            self.found.work.evaluated += run.len() as u64;
            let mut at = run.start;
            while at < run.end {
                let lanes = (run.end - at).min(LANES);
                if any(plane, bins, at, lanes, id) {
                    let tests = Tests::new(plane, bins, at);
                    let own = load(&bins.own, at);
                    for lane in 0..lanes {
                        let test = (tests.inside[lane], tests.nearer[lane]);
                        if (test.0 >= -1.0) & (test.1 >= -1.0) & (own[lane] != id) {
                            self.candidate(id, plane.depth_error, test, at + lane);
                        }
                    }
                }
                at += lanes;
            }
        }
    }

    /// A receiver that the triangle may shadow or touch.
    #[inline(never)]
    fn candidate(&mut self, id: u32, error: f32, (inside, nearer): (f32, f32), place: usize) {
        let Shared { bins, known, frame, skips, .. } = self.shared;
        if inside < 1.0 || nearer < 1.0 {
            return self.undecided(id, place);
        }
        let receiver_depth = bins.depth[place];
        let depth = receiver_depth + nearer * error;
        let depths = [depth - 2.0 * error, depth + 2.0 * error];
        let [near, far] = known.get(place);
        let between = skips.between && depths[0] > near && depths[1] < far;
        if !(between && depths[1] < frame.order_limit(receiver_depth)) {
            self.inside(id, place, depths);
        }
    }

    /// A contact inside the triangle, for certain.
    fn inside(&mut self, id: u32, place: usize, depths: [f32; 2]) {
        let segment = self.segment(place);
        let meeting = segment.meet_inside(id, &self.shared.geometry.corners(id));
        if matches!(&meeting, Meeting::Contact(contact) if contact.is_inside()) {
            self.shared.known.tighten(place, depths);
        }
        self.settle(place, meeting);
    }

    /// A candidate that f32 does not decide.
    #[cold]
    fn undecided(&mut self, id: u32, place: usize) {
        self.found.work.escalated += 1;
        let segment = self.segment(place);
        if segment.is_void() {
            return self.found.void.push(place as u32);
        }
        let meeting = segment.meet(id, &self.shared.geometry.corners(id));
        self.settle(place, meeting);
    }

    fn segment(&self, place: usize) -> Segment {
        let Shared { receivers, light, extent, bins, .. } = self.shared;
        let from = receivers[bins.index[place] as usize].position;
        Segment::of_scene(from, light.of(from), extent)
    }

    fn settle(&mut self, place: usize, meeting: Meeting) {
        let place = place as u32;
        match meeting {
            Meeting::Miss => {}
            Meeting::Touching => self.found.touching.push(place),
            Meeting::Contact(contact) if contact.is_inside() => {
                self.found.inside.push((place, contact));
            }
            Meeting::Contact(contact) => self.found.marginal.push((place, contact)),
        }
    }
}

impl State {
    pub(super) const LIT: Self =
        Self { nearest: (f64::INFINITY, u32::MAX), farthest: (f64::NEG_INFINITY, u32::MAX) };

    /// Keeps a contact that is nearer to an end; ties go to the lowest triangle id.
    pub(super) fn add(&mut self, contact: &Contact) {
        let Contact { t, triangle, .. } = *contact;
        if t < self.nearest.0 || (t == self.nearest.0 && triangle < self.nearest.1) {
            self.nearest = (t, triangle);
        }
        if t > self.farthest.0 || (t == self.farthest.0 && triangle < self.farthest.1) {
            self.farthest = (t, triangle);
        }
    }
}

/// Sixteen receivers against one triangle, in units of the error bounds.
struct Tests {
    /// The least of the three edges.
    inside: [f32; LANES],
    /// How much nearer to the light the triangle is.
    nearer: [f32; LANES],
}

impl Tests {
    #[inline(always)]
    fn new(plane: &Plane, bins: &Bins, at: usize) -> Self {
        let (x, y, depth) = (load(&bins.x, at), load(&bins.y, at), load(&bins.depth, at));
        let mut tests = Self { inside: [0.0; LANES], nearer: [0.0; LANES] };
        let [[a0, b0, c0], [a1, b1, c1], [a2, b2, c2]] = plane.edges;
        let [a, b, c] = plane.depth;
        for k in 0..LANES {
            let (dx, dy) = (x[k] - plane.origin[0], y[k] - plane.origin[1]);
            let e0 = a0 * dx + b0 * dy + c0;
            let e1 = a1 * dx + b1 * dy + c1;
            let e2 = a2 * dx + b2 * dy + c2;
            let least = if e0 < e1 { e0 } else { e1 };
            tests.inside[k] = if least < e2 { least } else { e2 };
            tests.nearer[k] = a * dx + b * dy + (c - depth[k] * plane.per_depth);
        }
        tests
    }
}

/// Whether any of so many receivers that do not lie on triangle `id` may be shadowed by it.
#[inline(always)]
fn any(plane: &Plane, bins: &Bins, at: usize, lanes: usize, id: u32) -> bool {
    let tests = Tests::new(plane, bins, at);
    let own = load(&bins.own, at);
    let mut any = false;
    for k in 0..LANES {
        let meets = (tests.inside[k] >= -1.0) & (tests.nearer[k] >= -1.0);
        any |= meets & (own[k] != id) & ((k as u32) < lanes as u32);
    }
    any
}

#[inline(always)]
fn load<T>(values: &[T], at: usize) -> &[T; LANES] {
    values[at..at + LANES].first_chunk().expect("as long as that")
}
