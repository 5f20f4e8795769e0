//! The sweep: every triangle over the receivers of its cells, sixteen at a time.

use glam::DVec3;

use super::super::cover::Contacts;
use super::super::intersect::{Contact, Meeting, Segment};
use super::super::{LightEnd, Receiver};
use super::bins::{Bins, LANES};
use super::frame::Frame;
use super::setup::{Item, Planes, Vertices};
use crate::scene::Geometry;
use crate::simd::Kernel;

/// What all bands share.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shared<'a> {
    pub(super) geometry: &'a Geometry,
    pub(super) receivers: &'a [Receiver],
    pub(super) light: LightEnd,
    /// The largest |coordinate| of the scene.
    pub(super) extent: f64,
    pub(super) frame: &'a Frame,
    pub(super) bins: &'a Bins,
    pub(super) vertices: &'a Vertices,
    pub(super) items: &'a [Item],
}

/// What is known about one receiver.
#[derive(Clone, Copy, Debug)]
pub(super) struct State {
    /// Inside contacts nearest to the receiver and to the light: position and triangle.
    pub(super) nearest: (f64, u32),
    pub(super) farthest: (f64, u32),
    /// The depth of `nearest` is at most this, that of `farthest` at least that.
    depths: [f32; 2],
}

impl State {
    pub(super) const LIT: Self = Self {
        nearest: (f64::INFINITY, u32::MAX),
        farthest: (f64::NEG_INFINITY, u32::MAX),
        depths: [f32::INFINITY, f32::NEG_INFINITY],
    };
}

/// Rare contacts, by sorted receiver.
#[derive(Debug, Default)]
pub(super) struct Rare {
    pub(super) marginal: Vec<(u32, Contact)>,
    pub(super) touching: Vec<u32>,
    /// Segments about which nothing can be said.
    pub(super) void: Vec<u32>,
    /// Candidates that f32 left open.
    pub(super) escalated: u64,
}

/// A run of rows of the grid.
#[derive(Debug)]
pub(super) struct Band<'a> {
    pub(super) shared: Shared<'a>,
    pub(super) rows: std::ops::Range<usize>,
    /// The first receiver of `states`.
    pub(super) first: usize,
    pub(super) states: &'a mut [State],
    pub(super) rare: Rare,
}

impl Kernel for Band<'_> {
    type Output = Rare;

    #[inline(always)]
    fn run(mut self) -> Rare {
        for item in self.shared.items {
            let rows = [usize::from(item.rows[0]), usize::from(item.rows[1])];
            if rows[0] < self.rows.end && rows[1] >= self.rows.start {
                let rows = rows[0].max(self.rows.start)..(rows[1] + 1).min(self.rows.end);
                self.sweep(item, rows);
            }
        }
        self.rare
    }
}

impl Band<'_> {
    #[inline(always)]
    fn sweep(&mut self, item: &Item, rows: std::ops::Range<usize>) {
        let Shared { geometry, vertices, frame, bins, .. } = self.shared;
        let corners = geometry.triangles[item.id as usize];
        let planes = vertices.planes(corners, item, frame);
        let (left, right) = (usize::from(item.columns[0]), usize::from(item.columns[1]) + 1);
        for row in rows {
            let run = bins.run(row, left, right);
            let mut at = run.start;
            while at < run.end {
                let lanes = (run.end - at).min(LANES);
                let tests = Tests::new(&planes, bins, at);
                let mut candidates = tests.candidates() & (u32::MAX >> (32 - lanes));
                while candidates != 0 {
                    let lane = candidates.trailing_zeros() as usize;
                    candidates &= candidates - 1;
                    self.candidate(item.id, &planes, &tests, at, lane);
                }
                at += lanes;
            }
        }
    }

    /// A receiver that the triangle may shadow or touch.
    #[inline(always)]
    fn candidate(&mut self, id: u32, planes: &Planes, tests: &Tests, at: usize, lane: usize) {
        let (bins, place) = (self.shared.bins, at + lane);
        if bins.own[place] == id {
            return;
        }
        if tests.inside[lane] < 1.0 || tests.nearer[lane] < 1.0 {
            return self.undecided(id, place);
        }
        let receiver_depth = bins.depth[place];
        let depth = receiver_depth + tests.nearer[lane] * planes.depth_error;
        let depths = [depth - 2.0 * planes.depth_error, depth + 2.0 * planes.depth_error];
        let state = &self.states[place - self.first];
        let between = depths[0] > state.depths[0] && depths[1] < state.depths[1];
        if !(between && depths[1] < self.shared.frame.order_limit(receiver_depth)) {
            self.inside(id, place, depths);
        }
    }

    /// A contact inside the triangle, for certain.
    #[inline(never)]
    fn inside(&mut self, id: u32, place: usize, depths: [f32; 2]) {
        let segment = self.segment(place);
        let meeting = segment.meet_inside(id, &self.shared.geometry.corners(id));
        if let Meeting::Contact(contact) = meeting
            && contact.is_inside()
        {
            let state = &mut self.states[place - self.first];
            state.depths[0] = state.depths[0].min(depths[1]);
            state.depths[1] = state.depths[1].max(depths[0]);
        }
        self.settle(place, meeting);
    }

    /// A candidate that f32 does not decide.
    #[cold]
    #[inline(never)]
    fn undecided(&mut self, id: u32, place: usize) {
        self.rare.escalated += 1;
        let segment = self.segment(place);
        if segment.is_void() {
            return self.rare.void.push(place as u32);
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
        match meeting {
            Meeting::Miss => {}
            Meeting::Touching => self.rare.touching.push(place as u32),
            Meeting::Contact(contact) if contact.is_inside() => {
                self.states[place - self.first].add(&contact);
            }
            Meeting::Contact(contact) => self.rare.marginal.push((place as u32, contact)),
        }
    }
}

impl State {
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

/// Sixteen receivers against one triangle, in units of the error bounds.
struct Tests {
    /// The least of the three edges.
    inside: [f32; LANES],
    /// How much nearer to the light the triangle is.
    nearer: [f32; LANES],
}

impl Tests {
    #[inline(always)]
    fn new(planes: &Planes, bins: &Bins, at: usize) -> Self {
        let load =
            |values: &[f32]| -> [f32; LANES] { std::array::from_fn(|k| values[at..at + LANES][k]) };
        let (x, y, depth) = (load(&bins.x), load(&bins.y), load(&bins.depth));
        let mut tests = Self { inside: [0.0; LANES], nearer: [0.0; LANES] };
        for k in 0..LANES {
            let (dx, dy) = (x[k] - planes.origin[0], y[k] - planes.origin[1]);
            let [e0, e1, e2] = planes.edges.map(|[a, b, c]| a * dx + b * dy + c);
            let [a, b, c] = planes.depth;
            let least = if e0 < e1 { e0 } else { e1 };
            tests.inside[k] = if least < e2 { least } else { e2 };
            tests.nearer[k] = a * dx + b * dy + (c - depth[k] * planes.per_depth);
        }
        tests
    }

    /// One bit for each receiver that may be shadowed.
    #[inline(always)]
    fn candidates(&self) -> u32 {
        let mut bits = 0;
        for k in 0..LANES {
            bits |= u32::from(self.inside[k] >= -1.0 && self.nearer[k] >= -1.0) << k;
        }
        bits
    }
}

/// The contacts of a receiver whose verdict is not settled by inside contacts alone.
pub(super) fn gather(
    state: &State,
    segment: &Segment,
    marginal: impl Iterator<Item = Contact>,
    corners: &impl Fn(u32) -> [DVec3; 3],
) -> Contacts {
    let mut contacts = Contacts::default();
    for id in [state.nearest.1, state.farthest.1] {
        if id != u32::MAX
            && let Meeting::Contact(contact) = segment.meet(id, &corners(id))
        {
            contacts.add(contact);
        }
    }
    marginal.for_each(|contact| contacts.add(contact));
    contacts
}
