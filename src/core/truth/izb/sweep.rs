//! The sweep: every triangle over the receivers near it, sixteen at a time.
#![allow(clippy::needless_range_loop, reason = "loops over indices become vectors")]

use std::ops::Range;

use glam::DVec3;

use super::super::intersect::{Contact, Meeting, Segment};
use super::super::plane::{Line, side_by_side};
use super::super::{LightEnd, Receiver};
use super::bins::{Bins, Block, LANES, ROWS};
use super::frame::Frame;
use super::hits::{Hit, Hits, Known};
use super::setup::{Batch, Plane};
use super::vertices::{Item, Vertices};
use super::work::{Skipped, Skips, Work};
use crate::scene::Geometry;
use crate::simd::Kernel;
use crate::simd::lanes::{BATCH, Lanes};

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

impl Shared<'_> {
    /// The segment of the receiver at a place.
    pub(super) fn segment(&self, place: u32) -> Segment {
        self.segment_of(self.bins.index[place as usize])
    }

    /// The segment of a receiver.
    pub(super) fn segment_of(&self, receiver: u32) -> Segment {
        let from = self.receivers[receiver as usize].position;
        Segment::of_scene(from, self.light.of(from), self.extent)
    }

    /// The lines of eight receivers: lane by lane those of [`Self::segment_of`].
    #[inline(always)]
    pub(super) fn lines_of(&self, receivers: &[u32; BATCH]) -> Line<Lanes> {
        let mut from = [DVec3::ZERO; BATCH];
        for k in 0..BATCH {
            from[k] = self.receivers[receivers[k] as usize].position;
        }
        let from = side_by_side(&from);
        let to = match self.light {
            LightEnd::Point(p) => [Lanes::splat(p.x), Lanes::splat(p.y), Lanes::splat(p.z)],
            LightEnd::Along(v) => {
                let v = [Lanes::splat(v.x), Lanes::splat(v.y), Lanes::splat(v.z)];
                [from[0] + v[0], from[1] + v[1], from[2] + v[2]]
            }
        };
        Line::of_scene(from, &to, self.extent)
    }

    /// Whether a hit is certain to be at no end of its segment, by what is known now.
    pub(super) fn is_between(&self, hit: &Hit) -> bool {
        self.skips.between && self.known.surround(hit)
    }
}

/// What a chunk of triangles found, by sorted receiver.
#[derive(Debug, Default)]
pub(super) struct Found {
    /// Certain hits, not yet put in order.
    pub(super) hits: Hits,
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
    pub(super) ids: Range<u32>,
    pub(super) found: Found,
}

/// Places that a triangle of a batch is run over.
#[derive(Clone, Copy, Debug)]
struct Run {
    slot: u16,
    group: u16,
    start: u32,
    end: u32,
}

impl Kernel for Chunk<'_> {
    type Output = Found;

    #[inline(always)]
    fn run(mut self, _has_fma: bool) -> Found {
        let Shared { geometry, vertices, frame, .. } = self.shared;
        self.found.work.triangles = self.ids.len() as u64;
        let (mut batch, mut runs) = (Batch::EMPTY, Vec::new());
        for first in self.ids.clone().step_by(BATCH) {
            let ids = first as usize..self.ids.end.min(first + BATCH as u32) as usize;
            let triangles = &geometry.triangles[ids];
            let items = vertices.items(triangles, frame.cells);
            for (k, &corners) in triangles.iter().enumerate() {
                let Some(item) = items.get(k) else {
                    self.found.work.outside += 1;
                    continue;
                };
                match self.runs(&item, batch.len, &mut runs) {
                    None => batch.push(first + k as u32, vertices.corners(corners), &item),
                    Some(skipped) => self.found.work.skip(skipped),
                }
                if batch.len == BATCH {
                    self.sweep(&mut batch, &mut runs);
                }
            }
        }
        self.sweep(&mut batch, &mut runs);
        self.found
    }
}

impl Chunk<'_> {
    /// Notes the runs of receivers that a triangle may shadow, or why there are none: no receiver is
    /// there, or all are nearer to the light than the triangle.
    #[inline(always)]
    fn runs(&self, item: &Item, slot: usize, runs: &mut Vec<Run>) -> Option<Skipped> {
        let Shared { bins, skips, .. } = self.shared;
        let (mut swept, mut behind) = (false, false);
        for row in usize::from(item.rows[0])..usize::from(item.rows[1]) + 1 {
            let run = bins.run(row, item.columns);
            if run.is_empty() {
                continue;
            }
            if skips.behind && bins.is_before(&run, item.nearest) {
                behind = true;
                continue;
            }
            swept = true;
            runs.push(Run {
                slot: slot as u16,
                group: (row / ROWS) as u16,
                start: run.start as u32,
                end: run.end as u32,
            });
        }
        match (swept, behind) {
            (true, _) => None,
            (_, true) => Some(Skipped::Behind),
            _ => skips.empty.then_some(Skipped::Empty),
        }
    }

    /// Runs the triangles of a batch over their receivers, and empties it.
    #[inline(always)]
    fn sweep(&mut self, batch: &mut Batch, runs: &mut Vec<Run>) {
        let planes = batch.planes(self.shared.frame);
        self.found.work.swept += batch.len as u64;
        for run in &*runs {
            let slot = usize::from(run.slot);
            self.found.work.evaluated += u64::from(run.end - run.start);
            self.sweep_run(batch.ids[slot], &planes.get(slot), run);
        }
        runs.clear();
        batch.len = 0;
    }

    /// Runs a triangle over the receivers of a run, block by block.
    #[inline(always)]
    fn sweep_run(&mut self, id: u32, plane: &Plane, run: &Run) {
        let (start, end) = (run.start as usize, run.end as usize);
        let group = &self.shared.bins.groups[usize::from(run.group)];
        let mut first = start - start % LANES;
        while first < end {
            let block = group.block(first);
            let lanes = start.saturating_sub(first)..LANES.min(end - first);
            if Tests::new(plane, block).any(block, &lanes, id) {
                self.candidates(id, plane, block, first, lanes);
            }
            first = first.wrapping_add(LANES);
        }
    }

    /// The receivers of a block that the triangle may shadow or touch.
    #[inline(always)]
    fn candidates(
        &mut self,
        id: u32,
        plane: &Plane,
        block: &Block,
        first: usize,
        lanes: Range<usize>,
    ) {
        let tests = Tests::new(plane, block);
        for lane in lanes {
            let (inside, nearer) = (tests.inside[lane], tests.nearer[lane]);
            if (inside >= -1.0) & (nearer >= -1.0) & (block.own[lane] != id) {
                let here = (first + lane, block.depth[lane]);
                self.candidate(id, plane.depth_error, (inside, nearer), here);
            }
        }
    }

    /// A receiver that the triangle may shadow or touch.
    #[inline(always)]
    fn candidate(
        &mut self,
        id: u32,
        error: f32,
        (inside, nearer): (f32, f32),
        (place, receiver_depth): (usize, f32),
    ) {
        if inside < 1.0 || nearer < 1.0 {
            return self.undecided(id, place);
        }
        let Shared { known, frame, skips, .. } = self.shared;
        let depth = receiver_depth + nearer * error;
        let depths = [depth - 2.0 * error, depth + 2.0 * error];
        let hit = Hit { place: place as u32, triangle: id, depths };
        let ordered = depths[1] < frame.order_limit(receiver_depth);
        if !(skips.between && ordered && known.surround(&hit)) {
            self.keep(hit, ordered);
        }
    }

    /// A hit that may be at an end of its segment.
    #[inline(never)]
    fn keep(&mut self, mut hit: Hit, ordered: bool) {
        let Shared { known, skips, .. } = self.shared;
        if !skips.between {
            return self.found.hits.push(hit, None);
        }
        known.tighten(&hit);
        if !ordered {
            hit.depths = [f32::NEG_INFINITY, f32::INFINITY];
        }
        self.found.hits.push(hit, Some(known));
    }

    /// A candidate that f32 does not decide.
    #[cold]
    fn undecided(&mut self, id: u32, place: usize) {
        self.found.work.escalated += 1;
        let place = place as u32;
        let segment = self.shared.segment(place);
        if segment.is_void() {
            return self.found.void.push(place);
        }
        match segment.meet(id, &self.shared.geometry.corners(id)) {
            Meeting::Miss => {}
            Meeting::Touching => self.found.touching.push(place),
            Meeting::Contact(contact) if contact.is_inside() => {
                self.found.inside.push((place, contact));
            }
            Meeting::Contact(contact) => self.found.marginal.push((place, contact)),
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
    fn new(plane: &Plane, receivers: &Block) -> Self {
        let Block { x, y, depth, .. } = receivers;
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

    /// Whether any receiver of these lanes does not lie on triangle `id` and may be shadowed by it.
    #[inline(always)]
    fn any(&self, receivers: &Block, lanes: &Range<usize>, id: u32) -> bool {
        let (start, end) = (&BELOW[lanes.start], &BELOW[lanes.end]);
        let mut any = false;
        for k in 0..LANES {
            let meets = (self.inside[k] >= -1.0) & (self.nearer[k] >= -1.0);
            any |= meets & (receivers.own[k] != id) & (start[k] != end[k]);
        }
        any
    }
}

/// For each number of lanes, 1 in the lanes below it. A table: comparing lanes with numbers compiles to
/// more than a load.
static BELOW: [[u32; LANES]; LANES + 1] = {
    let mut below = [[0; LANES]; LANES + 1];
    let mut n = 0;
    while n <= LANES {
        let mut k = 0;
        while k < n {
            below[n][k] = 1;
            k += 1;
        }
        n += 1;
    }
    below
};
