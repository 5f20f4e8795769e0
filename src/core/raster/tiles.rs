//! Drawing by tiles: triangles are binned once, and each band of tiles is drawn by one thread.
//!
//! Memory: 8 bytes a texel of the result; beside it 8 a vertex, about 5 a triangle and 12 a pixel of
//! the one tile that a thread holds.
#![allow(clippy::needless_range_loop, reason = "loops over indices become vectors")]

use super::batch::{self, Batch, FINEST};
use super::bins::{Bins, Place, Scene, is_clipped, places};
use super::plane::Plane;
use super::test::{DepthTest, Test, Turned};
use super::tile::{Exact, Surface, TILE, Tile};
use super::{Pass, Raster, Triangles, draw_each_of};
use crate::device::{Device, PlaneSetup};
use crate::simd::lanes::BATCH;
use crate::simd::{Kernel, Level};
use glam::Vec4;
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

/// Targets with a longer side are drawn triangle by triangle: places must fit into 2²⁴.
const LARGEST: u32 = 1 << 16;

/// Draws triangles in order with depth test LESS into a buffer cleared to 1, on all of rayon's
/// threads: bit for bit what [`draw_each`](super::draw_each) writes.
#[must_use]
pub fn draw(device: &Device, pass: &Pass, clip: &[Vec4], triangles: &[[u32; 3]]) -> Raster {
    draw_at(quickest(), device, pass, clip, triangles)
}

/// [`draw`] of triangles that need not be drawn alike: bit for bit what
/// [`draw_each_of`] writes.
#[must_use]
pub fn draw_of(device: &Device, pass: &Pass, triangles: &Triangles<'_>) -> Raster {
    let mut raster = Raster::of_nothing(pass.size);
    draw_over(&mut raster, quickest(), device, pass, triangles);
    raster
}

/// Eight pixels fill the vectors of AVX2; wider ones measured no quicker.
#[must_use]
pub fn quickest() -> Level {
    Level::best().min(Level::Avx2)
}

/// [`draw`] with a chosen instruction set.
///
/// # Panics
/// When the machine lacks the level.
#[must_use]
pub fn draw_at(
    level: Level,
    device: &Device,
    pass: &Pass,
    clip: &[Vec4],
    triangles: &[[u32; 3]],
) -> Raster {
    let mut raster = Raster::of_nothing(pass.size);
    draw_into(&mut raster, level, device, pass, clip, triangles);
    raster
}

/// [`draw_at`] over an older raster, whose memory is used again.
///
/// # Panics
/// When the machine lacks the level.
pub fn draw_into(
    raster: &mut Raster,
    level: Level,
    device: &Device,
    pass: &Pass,
    clip: &[Vec4],
    triangles: &[[u32; 3]],
) {
    draw_over(raster, level, device, pass, &Triangles::alike(clip, triangles));
}

fn draw_over(
    raster: &mut Raster,
    level: Level,
    device: &Device,
    pass: &Pass,
    triangles: &Triangles<'_>,
) {
    let [width, height] = pass.size;
    // Fragments of surfaces with holes are asked one by one.
    let literal = triangles.holes.is_some() || device.subpixel_bits > FINEST;
    if literal || width.max(height) > LARGEST {
        *raster = draw_each_of(device, pass, triangles);
        return;
    }
    let scene = Scene { device, pass, triangles };
    let places = &scene.places(level);
    let bins = &scene.bins(places, level);
    let drawn: &Vec<AtomicBool> =
        &triangles.corners.iter().map(|_| AtomicBool::new(false)).collect();
    let texels = width as usize * height as usize;
    if raster.depth.len() != texels || raster.triangle.len() != texels {
        // Zeroed pages are first touched by the thread that draws them.
        (raster.depth, raster.triangle) = (vec![0.0; texels], vec![0; texels]);
    }
    let band = (width * TILE[1]).max(1) as usize;
    let depths = raster.depth.par_chunks_mut(band);
    let bands = depths.zip(raster.triangle.par_chunks_mut(band)).enumerate();
    bands.for_each(|(row, (depth, triangle))| {
        level.run(Band { scene, places, bins, drawn, row, depth, triangle });
    });
    raster.size = pass.size;
    raster.empty_triangles = drawn.iter().map(|drawn| u64::from(!drawn.load(Relaxed))).sum();
}

/// A row of tiles, and where it goes.
struct Band<'a> {
    scene: Scene<'a>,
    places: &'a [Place],
    bins: &'a [Bins],
    /// Triangles that cover a pixel.
    drawn: &'a [AtomicBool],
    row: usize,
    depth: &'a mut [f32],
    triangle: &'a mut [u32],
}

impl Kernel for Band<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self, _: bool) {
        let Scene { device, pass, .. } = self.scene;
        let test = DepthTest::new(device, pass.depth_buffer);
        match (test.plain(), pass.clip.reversed) {
            (Some(plain), false) => self.paint(plain),
            (None, false) => self.paint(test),
            (Some(plain), true) => self.paint(Turned(plain)),
            (None, true) => self.paint(Turned(test)),
        }
    }
}

impl Band<'_> {
    /// Draws the tiles one after another.
    #[inline(always)]
    fn paint<T: Test>(self, test: T) {
        let width = self.scene.pass.size[0] as usize;
        let [columns, _] = self.scene.tiles();
        let tile = Tile::new(test);
        let mut brush = Brush {
            scene: self.scene,
            places: self.places,
            drawn: self.drawn,
            batch: Batch::new(self.scene.pass.clip.range),
            tile,
            origin: [0, self.row as u32 * TILE[1]],
        };
        for column in 0..columns {
            brush.origin[0] = column as u32 * TILE[0];
            brush.tile.clear();
            let number = self.row * columns + column;
            // Loops, not closures: those would not be compiled for the level.
            for bins in self.bins {
                brush.draw(bins.tile(number));
            }
            let left = column * TILE[0] as usize;
            let right = (left + TILE[0] as usize).min(width);
            let rows = self.depth.chunks_mut(width).zip(self.triangle.chunks_mut(width));
            for (y, (depth, triangle)) in rows.enumerate() {
                brush.tile.copy_row(y, &mut depth[left..right], &mut triangle[left..right]);
            }
        }
    }
}

/// First pixel and end along x and along y.
type Window = [[i32; 2]; 2];

/// Whether a window has some columns, and no more than are drawn at once.
#[inline(always)]
fn is_narrow([[left, right], _]: Window) -> bool {
    let width = right.wrapping_sub(left);
    (width > 0) & (width <= BATCH as i32)
}

/// Draws into one tile.
struct Brush<'a, T> {
    scene: Scene<'a>,
    places: &'a [Place],
    drawn: &'a [AtomicBool],
    batch: Batch,
    tile: Tile<T>,
    /// The tile's first pixel.
    origin: [u32; 2],
}

impl<T: Test> Brush<'_, T> {
    /// Draws triangles in order: small ones eight at a time, those before a large one first.
    #[inline(always)]
    fn draw(&mut self, ids: &[u32]) {
        let Triangles { clip, corners, .. } = *self.scene.triangles;
        let mut at = 0;
        while at < ids.len() {
            let mut large = None;
            while at < ids.len() && self.batch.len < BATCH && large.is_none() {
                let id = ids[at];
                let [a, b, c] = corners[id as usize];
                let places = places(self.places, [a, b, c]);
                if is_clipped(places) || !batch::fits(places) {
                    large = Some(id);
                } else {
                    let corners = [clip[a as usize], clip[b as usize], clip[c as usize]];
                    self.batch.push(id, places, corners);
                }
                at += 1;
            }
            self.sweep();
            if let Some(id) = large {
                self.large(id);
            }
        }
    }

    /// Draws the triangles of the batch, and empties it.
    #[inline(always)]
    fn sweep(&mut self) {
        let len = std::mem::take(&mut self.batch.len);
        let Scene { device, pass, .. } = self.scene;
        let edges = self.batch.edges(device.subpixel_bits);
        let planes = self.batch.planes(device.subpixel_bits);
        let is_moved = pass.offset.factor != 0.0 || pass.offset.units != 0.0;
        let in_lanes = device.setup == PlaneSetup::Exact && !is_moved;
        for k in 0..len {
            let (id, edges) = (self.batch.ids[k], edges.get(k));
            if !in_lanes {
                if let Some(plane) = self.plane(id) {
                    self.small(id, &edges, &plane);
                }
                continue;
            }
            let [a, b, c] = [planes[0].0[k], planes[1].0[k], planes[2].0[k]];
            if a.is_finite() & b.is_finite() & c.is_finite() {
                // An offset of 0 is added as well: it makes −0 to 0.
                let plane = Exact([a + 0.0, b + 0.0, c + 0.0]);
                let window = self.window(&edges);
                if is_narrow(window) {
                    self.narrow(id, &edges, &plane, window);
                } else {
                    self.small(id, &edges, &plane);
                }
            }
        }
    }

    /// The offset plane of a triangle, if it has one.
    #[inline(never)]
    fn plane(&self, id: u32) -> Option<Plane> {
        let Scene { device, pass, .. } = self.scene;
        let setup = self.scene.setup(id);
        setup.depth.is_finite().then(|| setup.offset_depth(device, pass.depth_buffer, pass.offset))
    }

    /// First pixel and end along x and along y of what the tile holds of a triangle's box.
    #[inline(always)]
    fn window(&self, edges: &batch::Edge3) -> Window {
        let [[left, right], [bottom, top]] = edges.samples;
        let (x0, y0) = (self.origin[0] as i32, self.origin[1] as i32);
        let (end_x, end_y) = (x0.wrapping_add(TILE[0] as i32), y0.wrapping_add(TILE[1] as i32));
        [[left.max(x0), right.min(end_x)], [bottom.max(y0), top.min(end_y)]]
    }

    /// Draws a triangle of which the tile holds few columns: all of a row at a time.
    #[inline(always)]
    fn narrow(&mut self, id: u32, edges: &batch::Edge3, plane: &Exact, window: Window) {
        let [[left, _], [bottom, top]] = window;
        let (x0, y0) = (self.origin[0] as i32, self.origin[1] as i32);
        let (mut ramps, rise) = (edges.ramps(), edges.rise(left, bottom));
        for i in 0..3 {
            for k in 0..BATCH {
                ramps[i][k] = ramps[i][k].wrapping_add(rise[i]);
            }
        }
        let across = plane.across(left);
        let mut missed = [-1; BATCH];
        for y in bottom..top {
            let outside = batch::outside(&ramps, [0; 3]);
            for k in 0..BATCH {
                missed[k] &= outside[k];
            }
            let place = [left.wrapping_sub(x0) as u32, y.wrapping_sub(y0) as u32];
            self.tile.draw(place, outside, plane.depths(&across, y), id);
            batch::climb(&mut ramps, &edges.step);
        }
        let mut all = -1;
        for k in 0..BATCH {
            all &= missed[k];
        }
        if all >= 0 {
            self.drawn[id as usize].store(true, Relaxed);
        }
    }

    /// Draws a triangle by its edge functions.
    #[inline(always)]
    fn small<S: Surface>(&mut self, id: u32, edges: &batch::Edge3, plane: &S) {
        let [[first_x, end_x], [first_y, end_y]] = self.window(edges);
        let (x0, y0) = (self.origin[0] as i32, self.origin[1] as i32);
        let (ramps, mut rise) = (edges.ramps(), edges.rise(first_x, first_y));
        let mut drawn = false;
        for y in first_y..end_y {
            let row = S::row(plane, y as f32);
            let (mut x, mut along) = (first_x, rise);
            while x < end_x {
                let outside = batch::outside(&ramps, along);
                let mut all = -1;
                for k in 0..BATCH {
                    all &= outside[k];
                }
                if all >= 0 {
                    drawn = true;
                    let place = [x.wrapping_sub(x0) as u32, y.wrapping_sub(y0) as u32];
                    self.tile.draw(place, outside, S::along(row, x as u32), id);
                }
                x = x.wrapping_add(BATCH as i32);
                for i in 0..3 {
                    let eight = edges.step[i][0].wrapping_mul(BATCH as i32);
                    along[i] = along[i].wrapping_add(eight);
                }
            }
            for i in 0..3 {
                rise[i] = rise[i].wrapping_add(edges.step[i][1]);
            }
        }
        if drawn {
            self.drawn[id as usize].store(true, Relaxed);
        }
    }

    /// Draws a triangle row by row, clipped where it must be.
    #[inline(always)]
    fn large(&mut self, id: u32) {
        let Scene { device, pass, .. } = self.scene;
        let setup = self.scene.setup(id);
        if !setup.depth.is_finite() {
            return;
        }
        let plane = setup.offset_depth(device, pass.depth_buffer, pass.offset);
        let cull = self.scene.triangles.screen_cull(pass, id);
        let outline = cull.and_then(|cull| setup.projected.outline(device, cull));
        let Some(outline) = outline else { return };
        let window = [0, 1].map(|k| {
            let first = self.origin[k];
            [first, (first + TILE[k]).min(pass.size[k])]
        });
        for y in outline.rows(&window) {
            let row = plane.row(y as f32);
            let [mut x, end] = outline.span(&window, y);
            if x < end {
                self.drawn[id as usize].store(true, Relaxed);
            }
            while x < end {
                let mut outside = [0; BATCH];
                for k in 0..BATCH {
                    outside[k] = (end - x) as i32 - 1 - k as i32;
                }
                let place = [x - self.origin[0], y - self.origin[1]];
                self.tile.draw(place, outside, Plane::along(row, x), id);
                x += BATCH as u32;
            }
        }
    }
}
