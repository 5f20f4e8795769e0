//! Which triangle the light sees first at many map points at once.
//!
//! The rays through map points are parallel lines in window space, so the triangles are run over the
//! points as a raster runs them over texels. f64 planes decide what is certain and leave the rest
//! *open*, for the exact ray to decide; so no answer depends on the roundings here.
//!
//! # What is certain
//! A ray is given by two world points on the near and the far plane. Both project to within
//! `SIDEWAYS`/100 texels of the map point (measured on a lattice over the map when the planes are set
//! up; else everything is open), and so does, w being positive between them, every point of the ray.
//! Projected corners are off by far less. Hence a ray passes through a triangle if the map point lies
//! inside its outline by more than `SIDEWAYS`, and misses it if it lies outside by more. Window depth
//! grows along the ray, so of two triangles the one whose plane is nearer by more than `IN_DEPTH` is
//! met first. Triangles whose plane is known less well than that (slivers) are taken to be anywhere
//! between their corners' depths, and open every point of their box that they may be first at.
//! A part before the near plane is clipped away (with a margin, inside of which points are open).

mod blocks;
mod flat;
mod points;

use super::observe::Observer;
use crate::light::Lens;
use crate::simd::Level;
use crate::truth::{Faces, SeenFaces};
use crate::view::ClipSpace;
use blocks::Blocks;
use flat::Flat;
use glam::{DMat4, DVec2, DVec3, DVec4};
use points::Look;
pub use points::{Points, States};
use rayon::prelude::*;

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

/// All triangles of a case as one of its maps sees them.
#[derive(Debug)]
pub struct Foremost {
    flats: Vec<Flat>,
    /// Whether projection and its inverse agree well enough for anything to be certain.
    sound: bool,
    size: DVec2,
}

impl Foremost {
    /// Sets up the casters of which the `drawn` faces are seen from a map. Which is first does not depend on how
    /// the map writes depth: OpenGL's clip space tells.
    #[must_use]
    pub fn new(observer: &Observer<'_>, lens: &Lens, drawn: &SeenFaces) -> Self {
        let clip = ClipSpace { y_down: lens.map.clip.y_down, ..ClipSpace::OPENGL };
        let lens = &lens.in_clip_space(clip);
        let on_screen = |faces: Faces| match (faces, clip.y_down) {
            (Faces::Front, true) => Faces::Back,
            (Faces::Back, true) => Faces::Front,
            (faces, _) => faces,
        };
        let (size, geometry) = (lens.texels(DVec2::ONE), &observer.geometry);
        let ids = 0..geometry.triangles.len() as u32;
        let ids = ids.into_par_iter().with_min_len(1024);
        let seen = |id| Some((id, drawn.of(id).filter(|_| geometry.surfaces.casts(id))?));
        let flats = ids.filter_map(seen).flat_map_iter(|(id, faces)| {
            let clip = geometry.corners(id).map(|p| lens.clip_from_world * p.extend(1.0));
            parts(clip).filter_map(move |part| Flat::new(id, part, size, on_screen(faces)))
        });
        // A point of a surface with holes may not be there: rays decide then.
        let sound = is_sound(lens) && !geometry.surfaces.have_holes();
        Self { flats: flats.collect(), sound, size }
    }

    /// What the light sees at each of `points` (map coordinates).
    #[must_use]
    pub fn at(&self, points: &[DVec2]) -> Vec<Seen> {
        let found = self.by_block(points, 0.0, |block, states| {
            self.look(block, DVec2::ZERO, states);
            let seen = |(place, &index): (usize, &u32)| (index, self.seen(states, place));
            block.index().iter().enumerate().map(seen).collect::<Vec<_>>()
        });
        let mut seen = vec![Seen::Open; points.len()];
        found.into_iter().flatten().for_each(|(index, here)| seen[index as usize] = here);
        seen
    }

    /// Does a job on all points (map coordinates), block by block of the map, on all threads. Looks
    /// may go `reach` texels beside the points.
    pub fn by_block<R: Send>(
        &self,
        points: &[DVec2],
        reach: f64,
        job: impl Fn(&Points, &mut States) -> R + Sync,
    ) -> Vec<R> {
        let blocks = Blocks::new(points, self.size, &self.flats, reach);
        let one = |states: &mut States, k: usize| job(&blocks.points(k, points), states);
        (0..blocks.count()).into_par_iter().map_init(States::default, one).collect()
    }

    /// Looks from each point moved by `offset` (map coordinates), which is within their reach.
    pub fn look(&self, points: &Points, offset: DVec2, states: &mut States) {
        states.clear(points.index().len());
        let offset = offset * self.size;
        Level::best().run(Look { flats: &self.flats, points, offset, states });
    }

    /// What the light sees at the point at `place` in the sorted order.
    #[inline]
    #[must_use]
    pub fn seen(&self, states: &States, place: usize) -> Seen {
        if self.sound { states.seen(place) } else { Seen::Open }
    }
}

/// The part of a clip-space triangle beyond the near plane, less its margin, as triangles: at most
/// two.
fn parts(clip: [DVec4; 3]) -> impl Iterator<Item = [DVec4; 3]> {
    let depth = |v: DVec4| v.z + v.w * (1.0 + IN_DEPTH);
    let (mut corners, mut count) = ([DVec4::ZERO; 4], 0);
    let mut keep = |v: DVec4| {
        corners[count] = v;
        count += 1;
    };
    for i in 0..3 {
        let (a, b) = (clip[i], clip[(i + 1) % 3]);
        let (da, db) = (depth(a), depth(b));
        if da >= 0.0 {
            keep(a);
        }
        if (da >= 0.0) != (db >= 0.0) {
            keep(a + (b - a) * (da / (da - db)));
        }
    }
    (2..count).map(move |i| [corners[0], corners[i - 1], corners[i]])
}

/// Whether rays and projected corners agree: on a lattice of map points, at both ends of the ray.
fn is_sound(lens: &Lens) -> bool {
    let (near, far) = lens.map.projection.near_far();
    let gentle = lens.map.is_orthographic() || far <= STEEPEST * near;
    let at = |m: &DMat4, p: DVec3| {
        let clip = *m * p.extend(1.0);
        DVec2::new(clip.x, clip.y) / clip.w * 0.5 + 0.5
    };
    let lattice =
        (0..=4).flat_map(|i| (0..=4).map(move |j| DVec2::new(f64::from(i), f64::from(j))));
    let mut off = lattice.flat_map(|p| {
        let uv = p / 4.0;
        let off = |end: DVec3| lens.texels((at(&lens.clip_from_world, end) - uv).abs());
        lens.ray(uv).map(|end| off(end).max_element())
    });
    gentle && off.all(|texels| texels < SIDEWAYS / 100.0)
}
