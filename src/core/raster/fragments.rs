//! Every fragment over chosen texels, kept so that any offset, culling or layer can be resolved from
//! one pass.

use super::cut::Cut;
use super::{Plane, PolygonOffset, Setup, Slots, depth_key};
use crate::depth::DepthFormat;
use crate::device::Device;
use crate::scene::{Cull, Culls, Surfaces};
use crate::view::ClipSpace;
use glam::Vec4;
use std::sync::Arc;

/// One surface over a texel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layer {
    /// Its depth as rasterised, offsets included.
    pub depth: f32,
    /// Its triangle.
    pub triangle: u32,
}

/// What a pass would do to the fragments.
pub struct Resolve<'s> {
    /// Format whose codes the depth test compares.
    pub depth_buffer: DepthFormat,
    /// Faces left out.
    pub cull: &'s Culls,
    /// Polygon offset.
    pub offset: PolygonOffset,
    /// Format whose resolvable difference the offset counts.
    pub resolvable: DepthFormat,
    /// Written instead of a fragment's depth, if anything: (map, front face, depth) → depth.
    pub write: Option<&'s dyn Fn(usize, bool, f32) -> f32>,
}

/// A triangle as a map sees it.
#[derive(Clone, Copy, Debug)]
struct Face {
    setup: Setup,
    /// Whether it turns counter-clockwise.
    turns: bool,
    /// Whether its front is seen: that, unless its model is mirrored.
    front: bool,
}

/// Fragments over chosen texels, in drawing order.
#[derive(Clone, Debug)]
pub struct Fragments {
    device: Device,
    /// The triangles of each map, map by map.
    faces: Vec<Face>,
    /// How many of each.
    count: usize,
    slots: Arc<Slots>,
    /// Where the fragments of each slot begin; one more at the end.
    starts: Vec<u32>,
    /// The set-up of each.
    found: Vec<u32>,
}

impl Fragments {
    /// Rasterises all triangles in every map, both faces, and keeps what falls on the texels of `slots`.
    /// `maps` gives each map's clip space and the vertices in it, `surfaces` which triangles cast.
    #[must_use]
    pub fn collect(
        device: &Device,
        maps: &[(ClipSpace, &[Vec4])],
        triangles: &[[u32; 3]],
        surfaces: &Surfaces,
        slots: &Arc<Slots>,
    ) -> Self {
        let (count, mut faces) = (triangles.len(), Vec::new());
        let mut pairs: Vec<(u32, u32)> = Vec::new();
        let mut starts = vec![0u32; slots.len() + 1];
        for (rect, &(clip, vertices)) in slots.layout().rects().iter().zip(maps) {
            for (t, triangle) in triangles.iter().zip(0u32..) {
                let corners = t.map(|v| vertices[v as usize]);
                let setup = Setup::in_space(device, rect.size, clip, corners);
                let (id, turns) = (faces.len() as u32, setup.is_front());
                faces.push(Face { setup, turns, front: turns != surfaces.is_mirrored(triangle) });
                if !surfaces.casts(triangle) {
                    continue;
                }
                let cut = Cut::of(device, &setup, surfaces, (triangle, *t));
                let is_there = |x: u32, y: u32| {
                    cut.as_ref().is_none_or(|cut| cut.is_there(x as f32, y as f32))
                };
                setup.cover(device, rect.size, Cull::None, |y, first, end| {
                    let there = (first..end).filter(|&x| is_there(x, y));
                    for slot in there.filter_map(|x| slots.found(rect.texel(x, y))) {
                        pairs.push((slot as u32, id));
                        starts[slot + 1] += 1;
                    }
                });
            }
        }
        for i in 0..slots.len() {
            starts[i + 1] += starts[i];
        }
        let (mut next, mut found) = (starts.clone(), vec![0; pairs.len()]);
        for (slot, id) in pairs {
            let place = &mut next[slot as usize];
            found[*place as usize] = id;
            *place += 1;
        }
        Self { device: *device, faces, count, slots: slots.clone(), starts, found }
    }

    /// Column and row, within its map, of the texel at a slot.
    fn place(&self, map: usize, texel: u32) -> [f32; 2] {
        self.slots.layout().rect(map).place(texel).map(|c| c as f32)
    }

    /// The depth of every triangle under a pass, and whether its front is seen; `None` where it is culled.
    fn planes(&self, pass: &Resolve<'_>) -> Vec<Option<(bool, Plane)>> {
        let of = |(id, face): (usize, &Face)| {
            let culled = match pass.cull.of((id % self.count) as u32) {
                Some(Cull::None) => false,
                Some(Cull::Back) => !face.turns,
                Some(Cull::Front) => face.turns,
                None => true,
            };
            let plane = || face.setup.offset_depth(&self.device, pass.resolvable, pass.offset);
            (!culled).then(|| (face.front, plane()))
        };
        self.faces.iter().enumerate().map(of).collect()
    }

    /// The value of a quantity over w at a texel's centre in a map, given at the three vertices of
    /// `triangle`: f64, rounded once.
    #[must_use]
    pub fn value(&self, map: usize, texel: u32, triangle: u32, at_vertices: [f32; 3]) -> f32 {
        let plane = self.faces[map * self.count + triangle as usize].setup.exact_plane(at_vertices);
        let [x, y] = self.place(map, texel);
        plane.at(x, y)
    }

    /// For each slot, the nearest surface over its texel and the second nearest, as the pass' depth test
    /// would meet them: of equal codes the first drawn wins. Bit for bit what [`super::draw`] writes.
    /// `found` is called with the place in `slots`.
    pub fn resolve(
        &self,
        slots: &[u32],
        pass: &Resolve<'_>,
        mut found: impl FnMut(usize, [Option<Layer>; 2]),
    ) {
        let layout = self.slots.layout();
        let key_of = depth_key(&self.device, pass.depth_buffer, layout.reversed());
        let (clear, planes) = (key_of(layout.cleared()), self.planes(pass));
        for (k, &slot) in slots.iter().enumerate() {
            let range =
                self.starts[slot as usize] as usize..self.starts[slot as usize + 1] as usize;
            let over = &self.found[range];
            // A texel belongs to one map.
            let map = over.first().map_or(0, |&id| id as usize / self.count);
            let at = self.place(map, self.slots.texel(slot as usize));
            let mut layers: [Option<(u32, Layer)>; 2] = [None; 2];
            for &id in over {
                let Some((front, plane)) = &planes[id as usize] else { continue };
                let triangle = (id as usize - map * self.count) as u32;
                let z = plane.row(at[1]).at(at[0]);
                let z = pass.write.map_or(z, |write| write(map, *front, z));
                let depth = if self.device.clamp_frag_z { z.clamp(0.0, 1.0) } else { z };
                let (key, layer) = (key_of(depth), Layer { depth, triangle });
                let before = |kept: &Option<(u32, Layer)>| kept.is_none_or(|(k, _)| key < k);
                if key >= clear {
                    continue;
                }
                if before(&layers[0]) {
                    layers = [Some((key, layer)), layers[0]];
                } else if before(&layers[1]) {
                    layers[1] = Some((key, layer));
                }
            }
            found(k, layers.map(|kept| kept.map(|(_, layer)| layer)));
        }
    }
}

impl std::fmt::Debug for Resolve<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Resolve").field("depth_buffer", &self.depth_buffer).finish_non_exhaustive()
    }
}
