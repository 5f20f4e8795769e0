//! Every fragment over chosen texels, kept so that any offset, culling or layer can be resolved from
//! one pass.

use super::{Plane, PolygonOffset, Setup, Slots, depth_key};
use crate::depth::DepthFormat;
use crate::device::Device;
use crate::scene::Cull;
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
    pub cull: Cull,
    /// Polygon offset.
    pub offset: PolygonOffset,
    /// Format whose resolvable difference the offset counts.
    pub resolvable: DepthFormat,
    /// Written instead of a fragment's depth, if anything: (front face, depth) → depth.
    pub write: Option<&'s dyn Fn(bool, f32) -> f32>,
}

/// Fragments over chosen texels, in drawing order.
#[derive(Clone, Debug)]
pub struct Fragments {
    device: Device,
    setups: Vec<(Setup, bool)>,
    slots: Arc<Slots>,
    /// Where the fragments of each slot begin; one more at the end.
    starts: Vec<u32>,
    triangles: Vec<u32>,
}

impl Fragments {
    /// Rasterises all triangles, both faces, and keeps what falls on the texels of `slots`.
    #[must_use]
    pub fn collect(
        device: &Device,
        clip: &[Vec4],
        triangles: &[[u32; 3]],
        slots: &Arc<Slots>,
    ) -> Self {
        let size = [slots.size(); 2];
        let setup = |t: &[u32; 3]| Setup::new(device, size, t.map(|v| clip[v as usize]));
        let setups: Vec<_> = triangles.iter().map(setup).map(|s| (s, s.is_front())).collect();
        let mut pairs: Vec<(u32, u32)> = Vec::new();
        let mut starts = vec![0u32; slots.len() + 1];
        for (id, (setup, _)) in setups.iter().enumerate() {
            setup.cover(device, size, Cull::None, |y, first, end| {
                for slot in (y * size[0] + first..y * size[0] + end).filter_map(|t| slots.found(t))
                {
                    pairs.push((slot as u32, id as u32));
                    starts[slot + 1] += 1;
                }
            });
        }
        for i in 0..slots.len() {
            starts[i + 1] += starts[i];
        }
        let (mut next, mut triangles) = (starts.clone(), vec![0; pairs.len()]);
        for (slot, id) in pairs {
            let place = &mut next[slot as usize];
            triangles[*place as usize] = id;
            *place += 1;
        }
        Self { device: *device, setups, slots: slots.clone(), starts, triangles }
    }

    /// The depth of every triangle under a pass, and whether its front is seen; `None` where it is culled.
    fn planes(&self, pass: &Resolve<'_>) -> Vec<Option<(bool, Plane)>> {
        let of = |(setup, front): &(Setup, bool)| {
            let culled = match pass.cull {
                Cull::None => false,
                Cull::Back => !front,
                Cull::Front => *front,
            };
            let offset = || setup.offset(&self.device, pass.resolvable, pass.offset);
            (!culled).then(|| (*front, setup.depth().moved(offset())))
        };
        self.setups.iter().map(of).collect()
    }

    /// The value of a quantity over w at a texel's centre, given at the three vertices of `triangle`:
    /// f64, rounded once.
    #[must_use]
    pub fn value(&self, texel: u32, triangle: u32, at_vertices: [f32; 3]) -> f32 {
        let plane = self.setups[triangle as usize].0.exact_plane(at_vertices);
        let size = self.slots.size();
        plane.at((texel % size) as f32, (texel / size) as f32)
    }

    /// For each slot, the nearest surface over its texel and the second nearest, as a depth test LESS into
    /// a buffer cleared to 1 would meet them: of equal codes the first drawn wins. Bit for bit what
    /// [`super::draw`] writes. `found` is called with the place in `slots`.
    pub fn resolve(
        &self,
        slots: &[u32],
        pass: &Resolve<'_>,
        mut found: impl FnMut(usize, [Option<Layer>; 2]),
    ) {
        let key_of = depth_key(&self.device, pass.depth_buffer);
        let (clear, planes) = (key_of(1.0), self.planes(pass));
        for (k, &slot) in slots.iter().enumerate() {
            let range =
                self.starts[slot as usize] as usize..self.starts[slot as usize + 1] as usize;
            let (texel, size) = (self.slots.texel(slot as usize), self.slots.size());
            let at = [texel % size, texel / size].map(|c| c as f32);
            let mut layers: [Option<(u32, Layer)>; 2] = [None; 2];
            for &triangle in &self.triangles[range] {
                let Some((front, plane)) = &planes[triangle as usize] else { continue };
                let z = plane.row(at[1]).at(at[0]);
                let z = pass.write.map_or(z, |write| write(*front, z));
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
