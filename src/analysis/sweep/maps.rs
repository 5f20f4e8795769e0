//! What the maps of a chart hold under a recipe: drawn texel by texel that is read, then stored in each
//! of some formats.

use super::chart::{Attachment, Chart};
use super::drawn::{Drawn, Places};
use super::field::Field;
use super::store::Store;
use crate::analysis::classify::StoredCaster;
use crate::depth::DepthFormat;
use crate::light::{Lens, Rect};
use crate::raster::{Fragments, NO_TRIANGLE, Resolve};
use crate::scene::{CullRule, TexelFormat};
use crate::shadow::bias::{Layers, Recipe, Site};
use crate::view::ClipSpace;
use glam::{DVec3, Vec4};
use std::borrow::Cow;

/// The owner of the surface that a tap holds, given receiver, tap and texel, and how far the bias moved it.
pub(super) type Surface<'s> = dyn Fn(usize, usize, u32) -> (StoredCaster, f64) + Sync + 's;

impl Chart<'_, '_> {
    /// The maps under a recipe as the receivers of `which` read them, one a format.
    pub(super) fn with_maps<T>(
        &self,
        texels: &[TexelFormat],
        recipe: &Recipe,
        which: &[u32],
        then: impl FnOnce(&[Store<'_>], &Surface<'_>) -> T,
    ) -> T {
        if recipe.moves_vertices() {
            self.with_resolved(texels, recipe, &self.fragments_moved(recipe), which, then)
        } else if recipe.changes_map() {
            self.with_resolved(texels, recipe, self.fragments(), which, then)
        } else {
            self.with_own(texels, recipe.moves_receiver(), then)
        }
    }

    /// The map without a bias: all of it where receivers move, else what they read.
    fn with_own<T>(
        &self,
        texels: &[TexelFormat],
        moved: bool,
        then: impl FnOnce(&[Store<'_>], &Surface<'_>) -> T,
    ) -> T {
        let raster = &self.raster;
        let (depth, triangle, places) = match moved {
            true => (self.compared(&raster.depth), &*raster.triangle, Places::Texels),
            false => ((&*self.own.depth).into(), &*self.own.triangle, Places::Slots(&self.slots)),
        };
        let drawn = Drawn { depth, triangle: triangle.into() };
        let store = |&texel: &TexelFormat| self.own_store(texel, &drawn, &places);
        let stores: Vec<Store<'_>> = texels.iter().map(store).collect();
        then(&stores, &|i, tap, t| {
            let caster = match moved {
                true => self.caster(i, tap, raster.triangle[t as usize], t),
                false => self.own_caster(i, tap),
            };
            (caster, 0.0)
        })
    }

    /// Casters under another offset, culling or layer: resolved from the fragments of each texel that
    /// somebody of `which` reads.
    fn with_resolved<T>(
        &self,
        texels: &[TexelFormat],
        recipe: &Recipe,
        fragments: &Fragments,
        which: &[u32],
        then: impl FnOnce(&[Store<'_>], &Surface<'_>) -> T,
    ) -> T {
        let depth_texture = self.attachment == Attachment::Depth;
        assert!(texels.len() == 1 || !depth_texture, "depth textures are their own attachments");
        let (slots, places) = match which.len() == self.field.samples.len() {
            true => ((0..self.slots.len() as u32).collect(), Places::Slots(&self.slots)),
            false => {
                let (slots, place) = self.reads.by(which, self.slots.len());
                (slots, Places::Read { slots: &self.slots, place })
            }
        };
        let drawn = self.resolved(texels[0], recipe, fragments, &slots);
        let store = |&texel: &TexelFormat| self.other_store(texel, &drawn, &places);
        let stores: Vec<Store<'_>> = texels.iter().map(store).collect();
        then(&stores, &|i, tap, t| {
            let slot = self.reads.slots(i)[tap];
            let place = places.of_slot(slot);
            let caster = self.caster(i, tap, drawn.triangle[place], t);
            let layered = recipe.layers != Layers::Nearest && !self.field.chooses();
            let gained = match layered {
                // A texel's centre may see a silhouette that the receiver does not.
                true if caster == StoredCaster::Occluder => {
                    self.field.layer_gain(&self.field.samples[i], recipe)
                }
                true => 0.0,
                false => f64::from(drawn.depth[place] - self.own.depth[slot as usize]),
            };
            (caster, gained)
        })
    }

    /// What a recipe draws on some slots: depth and surface of each.
    fn resolved(
        &self,
        texel: TexelFormat,
        recipe: &Recipe,
        fragments: &Fragments,
        slots: &[u32],
    ) -> Drawn<'static> {
        let spec = self.spec(texel);
        let resolvable = spec.attachment();
        // A depth texture is monotone: floats find the same nearest surface for every format.
        let depth_buffer = if texel.is_packed() { resolvable } else { DepthFormat::F32 };
        let cull = match recipe.layers {
            Layers::Nearest => spec.cull,
            Layers::BackFaces => CullRule::Front,
            Layers::Second | Layers::Midpoint | Layers::Dual => CullRule::None,
        };
        let cull = &self.field.observer.geometry.surfaces.culls(cull);
        let compared = |z: f32| self.layout.compared(z);
        let write = |map: usize, front: bool, z: f32| {
            compared(self.oriented(recipe.oriented, map, front, compared(z)))
        };
        let write: Option<&dyn Fn(usize, bool, f32) -> f32> =
            if recipe.oriented == 0.0 { None } else { Some(&write) };
        let offset = recipe.polygon;
        let pass = Resolve { depth_buffer, cull, offset, resolvable, write };
        let cleared = compared(self.layout.cleared());
        let mut drawn = (vec![cleared; slots.len()], vec![NO_TRIANGLE; slots.len()]);
        fragments.resolve(slots, &pass, |k, [first, second]| {
            let Some(first) = first else { return };
            let behind = second.map(|layer| compared(layer.depth));
            let depth = recipe.layers.combine(compared(first.depth), behind, recipe.layer_offset);
            let layer = if recipe.layers == Layers::Second { second } else { Some(first) };
            if let (Some(depth), Some(layer)) = (depth, layer) {
                (drawn.0[k], drawn.1[k]) = (depth, layer.triangle);
            }
        });
        Drawn { depth: drawn.0.into(), triangle: drawn.1.into() }
    }

    /// Window depths as they are compared.
    fn compared<'z>(&self, depths: &'z [f32]) -> Cow<'z, [f32]> {
        match self.layout.reversed() {
            false => depths.into(),
            true => depths.iter().map(|&z| self.layout.compared(z)).collect(),
        }
    }

    /// The compared depth that an oriented bias writes, world units along the light.
    fn oriented(&self, amount: f32, map: usize, front: bool, z: f32) -> f32 {
        let map = &self.field.observer.lenses[map].map;
        let per_world = map.depth_per_world(map.world_from_depth(f64::from(z)));
        let world = f64::from(if front { amount } else { -amount });
        z + (world * per_world) as f32
    }

    /// The fragments after casters' vertices have moved in world space (f64), transformed by the f32
    /// clip matrix of each map; their slots are the chart's own.
    fn fragments_moved(&self, recipe: &Recipe) -> Fragments {
        let observer = &self.field.observer;
        let (light, device) = (&self.field.case().light, self.device());
        let (normals, geometry) = (vertex_normals(self.field), &observer.geometry);
        let under = |(lens, rect): (&Lens, &Rect)| -> (ClipSpace, Vec<Vec4>) {
            let matrix = lens.clip_from_world.as_mat4();
            let clip = |(&p, &normal): (&DVec3, &DVec3)| -> Vec4 {
                let distance = lens.map.axial_distance(p);
                let site = Site {
                    position: p,
                    normal,
                    normals: None,
                    to_light: light.direction_from(p),
                    texel_world: lens.map.texel_world(rect.size[0], distance),
                    window_per_world: 0.0,
                    gradient: glam::DVec2::ZERO,
                    map_size: rect.size,
                    w: 1.0,
                };
                let moved = p + recipe.vertex_offset(&site);
                device.mat_vec(&matrix, moved.as_vec3().extend(1.0))
            };
            (lens.map.clip, geometry.positions.iter().zip(&normals).map(clip).collect())
        };
        let maps: Vec<_> = observer.lenses.iter().zip(self.layout.rects()).map(under).collect();
        let maps: Vec<_> =
            maps.iter().map(|(clip, vertices)| (*clip, vertices.as_slice())).collect();
        Fragments::collect(device, &maps, &geometry.triangles, &geometry.surfaces, &self.slots)
    }
}

/// Unit vertex normals: the meshes' own, else the triangles' area normals summed over each vertex, zero where
/// there are none.
fn vertex_normals(field: &Field<'_>) -> Vec<DVec3> {
    let geometry = &field.observer.geometry;
    let mut normals = vec![DVec3::ZERO; geometry.positions.len()];
    for (id, triangle) in geometry.triangles.iter().enumerate() {
        let area = geometry.area_normal(id as u32);
        triangle.iter().for_each(|&v| normals[v as usize] += area);
    }
    let unit = |n: DVec3| {
        let size = crate::view::length(n);
        if size > 0.0 { n / size } else { n }
    };
    let own = field.observer.vertex_normals.as_ref();
    let given = |v: usize| own.map(|own| own[v]).filter(|n| *n != DVec3::ZERO);
    normals.into_iter().enumerate().map(|(v, n)| given(v).unwrap_or_else(|| unit(n))).collect()
}
