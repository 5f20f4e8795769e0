//! Every fragment over chosen texels, kept so that any offset, culling or layer can be resolved from
//! one pass.

use super::{Plane, PolygonOffset, Setup, depth_key};
use crate::depth::DepthFormat;
use crate::device::Device;
use crate::scene::Cull;
use glam::Vec4;

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

/// Fragments over a set of texels, in drawing order.
#[derive(Clone, Debug)]
pub struct Fragments {
    device: Device,
    size: u32,
    setups: Vec<(Setup, bool)>,
    /// Slot of each texel, or `u32::MAX`.
    slots: Vec<u32>,
    /// Texel of each slot.
    texels: Vec<u32>,
    /// Where the fragments of each slot begin.
    starts: Vec<u32>,
    triangles: Vec<u32>,
}

impl Fragments {
    /// Rasterises all triangles, both faces, and keeps what falls on `wanted` texels.
    #[must_use]
    pub fn collect(
        device: &Device,
        size: u32,
        clip: &[Vec4],
        triangles: &[[u32; 3]],
        wanted: impl Iterator<Item = u32>,
    ) -> Self {
        let mut slots = vec![u32::MAX; size as usize * size as usize];
        let mut texels = Vec::new();
        for texel in wanted {
            if slots[texel as usize] == u32::MAX {
                slots[texel as usize] = texels.len() as u32;
                texels.push(texel);
            }
        }
        let count = texels.len();
        let setup = |t: &[u32; 3]| Setup::new(device, [size; 2], t.map(|v| clip[v as usize]));
        let setups: Vec<_> = triangles.iter().map(setup).map(|s| (s, s.is_front())).collect();
        let mut pairs: Vec<(u32, u32)> = Vec::new();
        for (id, (setup, _)) in setups.iter().enumerate() {
            setup.cover(device, [size; 2], Cull::None, |y, first, end| {
                let row = &slots[(y * size) as usize..((y + 1) * size) as usize];
                let here = row[first as usize..end as usize].iter().filter(|&&s| s != u32::MAX);
                pairs.extend(here.map(|&slot| (slot, id as u32)));
            });
        }
        pairs.sort_by_key(|&(slot, _)| slot);
        let mut starts = vec![0u32; count + 1];
        pairs.iter().for_each(|&(slot, _)| starts[slot as usize + 1] += 1);
        for i in 0..count {
            starts[i + 1] += starts[i];
        }
        let triangles = pairs.into_iter().map(|(_, id)| id).collect();
        Self { device: *device, size, setups, slots, texels, starts, triangles }
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
        plane.at((texel % self.size) as f32, (texel / self.size) as f32)
    }

    /// The place of a texel in [`Self::over_texels`].
    ///
    /// # Panics
    /// Where the texel was not wanted.
    #[must_use]
    pub fn slot(&self, texel: u32) -> usize {
        let slot = self.slots[texel as usize];
        assert!(slot != u32::MAX, "texel {texel} was not collected");
        slot as usize
    }

    /// The texel of a slot.
    #[must_use]
    pub fn texel(&self, slot: usize) -> u32 {
        self.texels[slot]
    }

    /// Something of every wanted texel, by slot.
    #[must_use]
    pub fn over_texels<T>(&self, of: impl Fn(u32) -> T) -> Vec<T> {
        self.texels.iter().map(|&texel| of(texel)).collect()
    }

    /// How many texels were wanted.
    #[must_use]
    pub fn len(&self) -> usize {
        self.texels.len()
    }

    /// Whether none was.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.texels.is_empty()
    }

    /// Of each slot the nearest surface over its texel and the second nearest, as a depth test LESS into
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
            let texel = self.texels[slot as usize];
            let at = [texel % self.size, texel / self.size].map(|c| c as f32);
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
