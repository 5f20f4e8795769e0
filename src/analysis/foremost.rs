//! Which triangle the light sees first at many map points at once.
//!
//! The rays through map points are parallel lines in window space, so the triangles are run over the
//! points as a raster runs them over texels. f64 planes decide what is certain and leave the rest
//! *open*, for the exact ray to decide; so no answer depends on the roundings here.
//!
//! # What is certain
//! A ray is given by two world points on the near and the far plane. Both project to within
//! [`SIDEWAYS`]/100 texels of the map point (measured on a lattice over the map when the planes are set
//! up; else everything is open), and so does, w being positive between them, every point of the ray.
//! Projected corners are off by far less. Hence a ray passes through a triangle if the map point lies
//! inside its outline by more than [`SIDEWAYS`], and misses it if it lies outside by more. Window depth
//! grows along the ray, so of two triangles the one whose plane is nearer by more than [`IN_DEPTH`] is
//! met first. Triangles whose plane is known less well than that (slivers) are taken to be anywhere
//! between their corners' depths, and open every point of their box that they may be first at.
//! A part before the near plane is clipped away (with a margin, inside of which points are open).

use super::observe::Observer;
use crate::truth::Faces;
use glam::{DMat4, DVec2, DVec3, DVec4};

/// Distance from an outline, in texels, within which nothing is certain.
const SIDEWAYS: f64 = 1e-6;

/// Difference of window depths within which nothing is certain.
const IN_DEPTH: f64 = 1e-7;

/// Corners are known within this many texels.
const CORNER: f64 = 1e-9;

/// Corners farther than this from the map, in texels, are not known so well.
const FAR_AWAY: f64 = 1e6;

/// Depths change too steeply along rays where far is more than so many times near.
const STEEPEST: f64 = 1e5;

/// What the light sees at a map point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Seen {
    /// No triangle meets the ray.
    Nothing,
    /// The ray passes through the inside of this triangle before it meets any other.
    First(u32),
    /// Too close to an edge, or to a second triangle.
    Open,
}

/// A triangle as the map sees it.
#[derive(Clone, Copy, Debug)]
struct Flat {
    id: u32,
    low: DVec2,
    high: DVec2,
    /// Inward unit normals of the edges and their offsets: distance = n·p − d.
    edges: [[f64; 3]; 3],
    /// Window depth = x·p.x + y·p.y + z.
    plane: DVec3,
    /// What the plane may be off within [`SIDEWAYS`] of an edge.
    slack: f64,
    /// The nearest corner.
    nearest: f64,
    /// Whether the plane is not known well enough.
    vague: bool,
}

/// All triangles of a case as its map sees them.
#[derive(Debug)]
pub struct Foremost {
    flats: Vec<Flat>,
    /// Whether projection and its inverse agree well enough for anything to be certain.
    sound: bool,
    size: f64,
}

impl Foremost {
    /// Sets up the triangles of which `faces` are seen.
    #[must_use]
    pub fn new(observer: &Observer<'_>, faces: Faces) -> Self {
        use rayon::prelude::*;
        let size = f64::from(observer.case().map.size);
        let geometry = &observer.geometry;
        let ids = 0..geometry.triangles.len() as u32;
        let flats = ids.into_par_iter().with_min_len(1024).flat_map_iter(|id| {
            let clip = geometry.corners(id).map(|p| observer.clip_from_world * p.extend(1.0));
            parts(clip).filter_map(move |part| Flat::new(id, part, size, faces))
        });
        Self { flats: flats.collect(), sound: is_sound(observer), size }
    }

    /// What the light sees at each of `points` (map coordinates).
    #[must_use]
    pub fn at(&self, points: &[DVec2]) -> Vec<Seen> {
        self.beside(&self.sorted(points, 0.0), DVec2::ZERO)
    }

    /// Points (map coordinates) sorted for any number of looks at most `reach` texels beside them.
    #[must_use]
    pub fn sorted(&self, points: &[DVec2], reach: f64) -> Points {
        let texels: Vec<DVec2> = points.iter().map(|p| *p * self.size).collect();
        let bins = Bins::new(&texels);
        let (low, high) = (bins.low - reach - SIDEWAYS, bins.high + reach + SIDEWAYS);
        let near = |f: &&Flat| !(f.high.cmplt(low).any() || f.low.cmpgt(high).any());
        Points { flats: self.flats.iter().filter(near).copied().collect(), bins, reach }
    }

    /// What the light sees at each point moved by `offset` (map coordinates).
    #[must_use]
    pub fn beside(&self, points: &Points, offset: DVec2) -> Vec<Seen> {
        let bins = &points.bins;
        let mut seen = vec![Seen::Open; bins.index.len()];
        if !self.sound {
            return seen;
        }
        let offset = offset * self.size;
        let far = offset.abs().max_element() > points.reach;
        let flats = if far { &self.flats } else { &points.flats };
        let mut states = vec![State::EMPTY; seen.len()];
        for flat in flats {
            flat.run(bins, offset, &mut states);
        }
        for (state, &index) in states.iter().zip(&bins.index) {
            seen[index as usize] = state.seen();
        }
        seen
    }

    /// Points of one call that make good use of a pass over all triangles.
    #[must_use]
    pub fn chunk(&self) -> usize {
        (self.flats.len() / 2).clamp(1 << 12, 1 << 16)
    }
}

/// The part of a clip-space triangle beyond the near plane, less its margin, as triangles.
fn parts(clip: [DVec4; 3]) -> impl Iterator<Item = [DVec4; 3]> {
    let depth = |v: DVec4| v.z + v.w * (1.0 + IN_DEPTH);
    let mut corners = Vec::new();
    for i in 0..3 {
        let (a, b) = (clip[i], clip[(i + 1) % 3]);
        let (da, db) = (depth(a), depth(b));
        if da >= 0.0 {
            corners.push(a);
        }
        if (da >= 0.0) != (db >= 0.0) {
            corners.push(a + (b - a) * (da / (da - db)));
        }
    }
    let count = corners.len().saturating_sub(2);
    (0..count).map(move |i| [corners[0], corners[i + 1], corners[i + 2]])
}

/// Whether rays and projected corners agree: on a lattice of map points, at both ends of the ray.
fn is_sound(observer: &Observer<'_>) -> bool {
    let size = f64::from(observer.case().map.size);
    let (near, far) = observer.case().light.projection.near_far();
    let gentle = observer.case().light.is_directional() || far <= STEEPEST * near;
    let at = |m: &DMat4, p: DVec3| {
        let clip = *m * p.extend(1.0);
        DVec2::new(clip.x, clip.y) / clip.w * 0.5 + 0.5
    };
    let lattice =
        (0..=4).flat_map(|i| (0..=4).map(move |j| DVec2::new(f64::from(i), f64::from(j))));
    let mut off = lattice.flat_map(|p| {
        let uv = p / 4.0;
        let ends = observer.light_ray(uv);
        ends.map(|end| (at(&observer.clip_from_world, end) - uv).abs().max_element() * size)
    });
    gentle && off.all(|texels| texels < SIDEWAYS / 100.0)
}

impl Flat {
    fn new(id: u32, clip: [DVec4; 3], size: f64, faces: Faces) -> Option<Self> {
        let window = clip.map(|v| v.truncate() / v.w * 0.5 + 0.5);
        let [a, b, c] = window.map(|w| w.truncate() * size);
        let depths = window.map(|w| w.z);
        let twice_area = (b - a).perp_dot(c - a);
        let longest = [b - a, c - b, a - c].map(|e| e.length()).into_iter().fold(0.0, f64::max);
        let reach = longest.max(1.0) * 4.0 * CORNER;
        let facing_known = twice_area.abs() > reach * 1e3;
        let hidden = match faces {
            Faces::Both => false,
            Faces::Front => twice_area < 0.0,
            Faces::Back => twice_area > 0.0,
        };
        if hidden && facing_known {
            return None;
        }
        let turn = if twice_area < 0.0 { -1.0 } else { 1.0 };
        let edge = |p: DVec2, q: DVec2| {
            let along = (q - p) * turn;
            let n = DVec2::new(-along.y, along.x) / along.length();
            [n.x, n.y, n.dot(p)]
        };
        let (p, q) = (b - a, c - a);
        let (dp, dq) = (depths[1] - depths[0], depths[2] - depths[0]);
        let gradient = DVec2::new(dp * q.y - dq * p.y, dq * p.x - dp * q.x) / twice_area;
        let range = dp.abs().max(dq.abs()).max((dp - dq).abs());
        let slack = 2.0 * SIDEWAYS * gradient.abs().element_sum();
        let depth_error = 1e-10 + 3.0 * range * reach / twice_area.abs() + slack / 200.0;
        let far_away = [a, b, c].iter().any(|p| !(p.abs().max_element() < FAR_AWAY));
        let flat = Self {
            id,
            low: a.min(b).min(c) - SIDEWAYS,
            high: a.max(b).max(c) + SIDEWAYS,
            edges: [edge(a, b), edge(b, c), edge(c, a)],
            plane: gradient.extend(depths[0] - gradient.dot(a)),
            slack: slack + IN_DEPTH,
            nearest: depths[0].min(depths[1]).min(depths[2]) - IN_DEPTH,
            vague: far_away || !facing_known || !(depth_error < IN_DEPTH / 10.0),
        };
        let beyond = flat.nearest > 1.0 + IN_DEPTH;
        (!beyond).then_some(flat)
    }

    /// Meets every point, moved by `offset` texels, of the cells under the box.
    fn run(&self, bins: &Bins, offset: DVec2, states: &mut [State]) {
        let ([x0, y0], [x1, y1]) = (bins.cell(self.low - offset), bins.cell(self.high - offset));
        for y in y0..=y1 {
            let row = y * bins.cells;
            let places = bins.start[row + x0] as usize..bins.start[row + x1 + 1] as usize;
            let points = &bins.points[places.clone()];
            for (p, state) in points.iter().zip(&mut states[places]) {
                self.meet(*p + offset, state);
            }
        }
    }

    #[inline(always)]
    fn meet(&self, p: DVec2, state: &mut State) {
        if self.vague {
            let inside = p.cmpge(self.low).all() && p.cmple(self.high).all();
            return if inside {
                state.maybe(self.nearest)
            };
        }
        let [e0, e1, e2] = self.edges.map(|[x, y, d]| x * p.x + y * p.y - d);
        let inside = e0.min(e1).min(e2);
        if inside < -SIDEWAYS {
            return;
        }
        let depth = self.plane.x * p.x + self.plane.y * p.y + self.plane.z;
        if inside <= SIDEWAYS || depth <= IN_DEPTH || depth >= 1.0 - IN_DEPTH {
            let on_the_ray = depth > -self.slack && depth < 1.0 + self.slack;
            return if on_the_ray {
                state.maybe(depth - self.slack)
            };
        }
        state.certain(depth, self.id);
    }
}

/// What is known of a point.
#[derive(Clone, Copy, Debug)]
struct State {
    /// Depth of the nearest certain triangle.
    depth: f64,
    /// Depth from which on something else may be met.
    other: f64,
    id: u32,
}

impl State {
    const EMPTY: Self = Self { depth: f64::INFINITY, other: f64::INFINITY, id: u32::MAX };

    #[inline(always)]
    fn maybe(&mut self, from: f64) {
        self.other = if from < self.other { from } else { self.other };
    }

    #[inline(always)]
    fn certain(&mut self, depth: f64, id: u32) {
        if depth < self.depth {
            let before = self.depth;
            (self.depth, self.id) = (depth, id);
            self.maybe(before);
        } else {
            self.maybe(depth);
        }
    }

    fn seen(&self) -> Seen {
        match (self.id, self.other) {
            (u32::MAX, f64::INFINITY) => Seen::Nothing,
            (u32::MAX, _) => Seen::Open,
            (id, other) if other > self.depth + IN_DEPTH => Seen::First(id),
            _ => Seen::Open,
        }
    }
}

/// Map points in the order of their cells.
#[derive(Debug)]
pub struct Points {
    bins: Bins,
    /// The triangles whose boxes come within `reach` texels of the box of all points.
    flats: Vec<Flat>,
    reach: f64,
}

/// Points sorted into cells, about two to a cell.
#[derive(Debug)]
struct Bins {
    cells: usize,
    low: DVec2,
    high: DVec2,
    scale: DVec2,
    start: Vec<u32>,
    points: Vec<DVec2>,
    index: Vec<u32>,
}

impl Bins {
    fn new(points: &[DVec2]) -> Self {
        let low = points.iter().copied().fold(DVec2::INFINITY, DVec2::min);
        let high = points.iter().copied().fold(DVec2::NEG_INFINITY, DVec2::max);
        let cells = ((points.len() as f64 / 2.0).sqrt() as usize).clamp(1, 2048);
        let scale = cells as f64 / (high - low).max(DVec2::splat(1e-6));
        let mut bins = Self {
            cells,
            low,
            high,
            scale,
            start: vec![0; cells * cells + 1],
            points: vec![DVec2::ZERO; points.len()],
            index: vec![0; points.len()],
        };
        let cell = |bins: &Self, p: DVec2| {
            let [x, y] = bins.cell(p);
            y * cells + x
        };
        for &p in points {
            let at = cell(&bins, p);
            bins.start[at + 1] += 1;
        }
        for i in 0..cells * cells {
            bins.start[i + 1] += bins.start[i];
        }
        let mut next = bins.start.clone();
        for (i, &p) in points.iter().enumerate() {
            let place = &mut next[cell(&bins, p)];
            (bins.points[*place as usize], bins.index[*place as usize]) = (p, i as u32);
            *place += 1;
        }
        bins
    }

    /// The cell of a point; those outside belong to the border's cells. Monotone in each coordinate,
    /// so a box reaches every cell of its points.
    #[inline(always)]
    fn cell(&self, p: DVec2) -> [usize; 2] {
        let at = (p - self.low) * self.scale;
        [at.x, at.y].map(|x| (x.max(0.0) as usize).min(self.cells - 1))
    }
}
