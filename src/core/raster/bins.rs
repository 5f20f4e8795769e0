//! Which tiles each triangle may touch: vertices are snapped once, triangles between the sample
//! centres and culled ones are left out, the others are sorted by tile in drawing order.

use super::tile::TILE;
use super::triangle::snap;
use super::{Pass, Setup, Triangles, clip};
use crate::device::Device;
use crate::scene::Cull;
use crate::simd::{Kernel, Level};
use glam::Vec4;
use rayon::prelude::*;

/// Triangles of one chunk.
const CHUNK: usize = 1 << 15;

/// A place in sub-pixels; [`CLIPPED`] where the vertex lies outside the view volume.
pub(super) type Place = [i32; 2];
const CLIPPED: Place = [i32::MIN; 2];

/// The places of a triangle.
#[inline(always)]
pub(super) fn places(places: &[Place], [a, b, c]: [u32; 3]) -> [Place; 3] {
    [places[a as usize], places[b as usize], places[c as usize]]
}

/// Whether a vertex lies outside the view volume.
#[inline(always)]
pub(super) fn is_clipped([a, b, c]: [Place; 3]) -> bool {
    let least = a[0].min(b[0]).min(c[0]);
    least == CLIPPED[0]
}

/// What a pass draws.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scene<'a> {
    pub(super) device: &'a Device,
    pub(super) pass: &'a Pass,
    pub(super) triangles: &'a Triangles<'a>,
}

impl Scene<'_> {
    /// The set-up of one triangle.
    pub(super) fn setup(&self, id: u32) -> Setup {
        let corners = self.triangles.corners[id as usize].map(|v| self.triangles.clip[v as usize]);
        Setup::in_space(self.device, self.pass.size, self.pass.clip, corners)
    }

    /// The snapped vertices.
    pub(super) fn places(&self, level: Level) -> Vec<Place> {
        let vertices = self.triangles.clip;
        let mut places = vec![CLIPPED; vertices.len()];
        let chunks = places.par_chunks_mut(CHUNK).zip(vertices.par_chunks(CHUNK));
        let near = clip::least(self.pass.clip.range);
        chunks.for_each(|(places, clip)| {
            level.run(Snap { device: self.device, size: self.pass.size, near, clip, places });
        });
        places
    }

    /// The triangles sorted by tile, chunk by chunk.
    pub(super) fn bins(&self, places: &[Place], level: Level) -> Vec<Bins> {
        let chunks = 0..self.triangles.corners.len().div_ceil(CHUNK);
        let sort = |k: usize| {
            let ids = k * CHUNK..((k + 1) * CHUNK).min(self.triangles.corners.len());
            level.run(Sort { scene: *self, places, ids })
        };
        chunks.into_par_iter().map(sort).collect()
    }

    /// Tiles along x and y.
    pub(super) fn tiles(&self) -> [usize; 2] {
        [0, 1].map(|axis| self.pass.size[axis].div_ceil(TILE[axis]) as usize)
    }
}

struct Snap<'a> {
    device: &'a Device,
    size: [u32; 2],
    near: f32,
    clip: &'a [Vec4],
    places: &'a mut [Place],
}

impl Kernel for Snap<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self, _: bool) {
        for (place, &v) in self.places.iter_mut().zip(self.clip) {
            if v.is_finite() && v.w > 0.0 && clip::is_inside(v, self.near) {
                // Within the view volume, so within the viewport: at most 2^16 pixels of 2^8.
                let [x, y] = snap(self.device, self.size, v);
                *place = [x as i32, y as i32];
            }
        }
    }
}

/// Triangles of a chunk, tile after tile, each tile's in drawing order.
#[derive(Debug, Default)]
pub(super) struct Bins {
    /// Where each tile begins; one more at the end.
    starts: Vec<u32>,
    ids: Vec<u32>,
}

impl Bins {
    #[inline(always)]
    pub(super) fn tile(&self, tile: usize) -> &[u32] {
        &self.ids[self.starts[tile] as usize..self.starts[tile + 1] as usize]
    }
}

struct Sort<'a> {
    scene: Scene<'a>,
    places: &'a [Place],
    ids: std::ops::Range<usize>,
}

/// First and last tile along x and along y.
type Tiles = [[u16; 2]; 2];

impl Kernel for Sort<'_> {
    type Output = Bins;

    #[inline(always)]
    fn run(self, _: bool) -> Bins {
        let [columns, rows] = self.scene.tiles();
        let mut starts = vec![0u32; columns * rows + 1];
        let mut found: Vec<(u32, Tiles)> = Vec::with_capacity(self.ids.len());
        for id in self.ids.clone() {
            if let Some(tiles) = self.tiles(id) {
                each(tiles, columns, |tile| starts[tile + 1] += 1);
                found.push((id as u32, tiles));
            }
        }
        for tile in 0..columns * rows {
            starts[tile + 1] += starts[tile];
        }
        let mut ids = vec![0u32; starts[columns * rows] as usize];
        for (id, tiles) in found {
            // `starts` runs ahead to the end of each tile, and is moved back by one tile below.
            each(tiles, columns, |tile| {
                ids[starts[tile] as usize] = id;
                starts[tile] += 1;
            });
        }
        starts.pop();
        starts.insert(0, 0);
        Bins { starts, ids }
    }
}

#[inline(always)]
fn each([[left, right], [bottom, top]]: Tiles, columns: usize, mut visit: impl FnMut(usize)) {
    for row in bottom..=top {
        for column in left..=right {
            visit(usize::from(row) * columns + usize::from(column));
        }
    }
}

impl Sort<'_> {
    /// The tiles that a triangle may cover, or none.
    #[inline(always)]
    fn tiles(&self, id: usize) -> Option<Tiles> {
        let corners = places(self.places, self.scene.triangles.corners[id]);
        if is_clipped(corners) {
            return self.clipped_tiles(id as u32);
        }
        let s = self.scene.device.subpixel_bits;
        let [a, b, c] = corners;
        let left = ceil(a[0].min(b[0]).min(c[0]), s);
        let right = ceil(a[0].max(b[0]).max(c[0]), s);
        let bottom = ceil(a[1].min(b[1]).min(c[1]), s);
        let top = ceil(a[1].max(b[1]).max(c[1]), s);
        let culled = match self.scene.triangles.screen_cull(self.scene.pass, id as u32) {
            Some(Cull::None) => false,
            Some(Cull::Back) => area(corners) <= 0,
            Some(Cull::Front) => area(corners) >= 0,
            None => true,
        };
        let column = |pixel: i32| (pixel as u32 / TILE[0]) as u16;
        let row = |pixel: i32| (pixel as u32 / TILE[1]) as u16;
        if (left >= right) | (bottom >= top) | culled {
            return None;
        }
        Some([[column(left), column(right - 1)], [row(bottom), row(top - 1)]])
    }

    #[inline(never)]
    fn clipped_tiles(&self, id: u32) -> Option<Tiles> {
        let Scene { device, pass, triangles } = self.scene;
        let cull = triangles.screen_cull(pass, id)?;
        let outline = self.scene.setup(id).projected.outline(device, cull)?;
        let samples = outline.samples();
        let mut tiles = Tiles::default();
        for axis in 0..2 {
            let [first, end] = samples[axis];
            let end = end.min(i64::from(pass.size[axis]));
            if first >= end {
                return None;
            }
            let tile = |pixel: i64| (pixel / i64::from(TILE[axis])) as u16;
            tiles[axis] = [first, end - 1].map(tile);
        }
        Some(tiles)
    }
}

/// The first pixel centre at or above a place: a box holds the centres from that of its low side to
/// that of its high side, which is outside, as by the rule of `Outline::spans`.
#[inline(always)]
pub(super) fn ceil(x: i32, subpixel_bits: u32) -> i32 {
    let last = 1i32.wrapping_shl(subpixel_bits).wrapping_sub(1);
    x.wrapping_add(last).wrapping_shr(subpixel_bits)
}

/// Twice the signed area: |coordinates| ≤ 2²⁴, products ≤ 2⁵⁰.
#[inline(always)]
fn area([a, b, c]: [Place; 3]) -> i64 {
    let step = |to: i32, from: i32| i64::from(to.wrapping_sub(from));
    let (bx, by) = (step(b[0], a[0]), step(b[1], a[1]));
    let (cx, cy) = (step(c[0], a[0]), step(c[1], a[1]));
    bx.wrapping_mul(cy).wrapping_sub(cx.wrapping_mul(by))
}
