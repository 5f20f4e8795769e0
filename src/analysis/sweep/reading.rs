//! Reading a chart: receivers at their own places, moved by a bias, under another map, reversed.

use super::chart::{Attachment, Chart, wanted_texels};
use super::field::{Field, Sample};
use super::looks::{Look, Looks};
use super::store::Store;
use super::tally::SHARE;
use crate::analysis::classify::StoredCaster;
use crate::depth::DepthFormat;
use crate::device::Device;
use crate::raster::{Fragments, Layer, NO_TRIANGLE, Resolve};
use crate::scene::{Cull, DepthBuffer, TexelFormat};
use crate::shadow::bias::{Follow, Layers, Recipe, Site};
use crate::shadow::{self, Footprint, Texels};
use glam::{DMat4, DVec3, DVec4, Vec4};
use std::cell::OnceCell;

/// Which receivers are read.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Reading {
    /// All of them.
    All,
    /// Those that can be wrong at a tap bias ≥ 0: truly lit ones that are lit at 0 are left out.
    Breakable,
}

/// Whose surface a tap holds, given receiver, tap and texel, and how far the bias moved it.
pub(super) type Surface<'s> = dyn Fn(usize, usize, u32) -> (StoredCaster, f64) + 's;

/// One receiver's look-up.
struct Glance<'g> {
    sample: &'g Sample,
    coord: [f32; 3],
    footprint: &'g Footprint,
}

impl Chart<'_, '_> {
    /// All comparisons without a bias under reversed depth (1 at near, 0 at far, clip z in [0,1]): the
    /// same coverage, depths of the reversed f32 matrix, both sides negated so that the case's rule holds.
    #[must_use]
    pub fn looks_reversed(&self, texel: TexelFormat) -> Vec<Looks> {
        let observer = &self.field.observer;
        let subject = &observer.subject;
        let z_column = DVec4::new(0.0, 0.0, -0.5, 0.0);
        let w_column = DVec4::new(0.0, 0.0, 0.5, 1.0);
        let reverse = DMat4::from_cols(DVec4::X, DVec4::Y, z_column, w_column);
        let matrix = (reverse * observer.clip_from_world).as_mat4();
        let clip = |p: &DVec3| self.device().mat_vec(&matrix, p.as_vec3().extend(1.0));
        let clip: Vec<Vec4> = observer.geometry.positions.iter().map(clip).collect();
        let corners = |t: u32| observer.geometry.triangles[t as usize].map(|v| clip[v as usize]);
        let drawn = |t: u32| {
            let triangle = self.raster.triangle[t as usize];
            let depth = |id: u32| self.fragments.value(t, id, corners(id).map(|v| v.z));
            Some(if triangle == NO_TRIANGLE { 0.0 } else { depth(triangle) })
        };
        let receiver = |sample: &Sample| {
            let triangle = sample.receiver.triangle;
            let varyings = subject.camera_setup(triangle).varyings(self.device());
            let [x, y] = sample.pixel.map(|c| c as f32);
            let of = |pick: fn(Vec4) -> f32| varyings.scalar(corners(triangle).map(pick), x, y);
            of(|v| v.z) / of(|v| v.w)
        };
        let casters = &self.casters;
        let texels = self.size as usize * self.size as usize;
        let store = self.other_store(texel, drawn, None, texels);
        let read = self.looks_in_place(&store, &Recipe::default(), Reading::All, &|i, tap, _| {
            (casters[i][tap], 0.0)
        });
        let mut looks: Vec<Looks> = read.into_iter().map(|(_, looks)| looks).collect();
        for (look, sample) in looks.iter_mut().zip(&self.field.samples) {
            let z = receiver(sample);
            for tap in &mut look.taps {
                (tap.z, tap.stored) = (-z, -tap.stored);
            }
        }
        looks
    }

    /// The comparisons of all receivers that a reading asks for, by index.
    pub(super) fn read(
        &self,
        texel: TexelFormat,
        recipe: &Recipe,
        reading: Reading,
    ) -> Vec<(u32, Looks)> {
        self.with_maps(&[texel], recipe, |stores, surface| match recipe.moves_receiver() {
            true => self.looks_moved(&stores[0], recipe, reading, surface),
            false => self.looks_in_place(&stores[0], recipe, reading, surface),
        })
    }

    /// What a map holds under a recipe, in each of some formats.
    pub(super) fn with_maps<T>(
        &self,
        texels: &[TexelFormat],
        recipe: &Recipe,
        then: impl FnOnce(&[Store<'_>], &Surface<'_>) -> T,
    ) -> T {
        let own_caster = |i: usize, tap: usize, t: u32| {
            let caster = match recipe.moves_receiver() {
                true => self.caster(i, self.raster.triangle[t as usize], t),
                false => self.casters[i][tap],
            };
            (caster, 0.0)
        };
        if recipe.moves_vertices() {
            self.with_resolved(texels, recipe, &self.fragments_moved(recipe), then)
        } else if recipe.changes_map() {
            self.with_resolved(texels, recipe, &self.fragments, then)
        } else {
            let stores: Vec<Store<'_>> = texels.iter().map(|&t| self.own_store(t)).collect();
            then(&stores, &own_caster)
        }
    }

    fn caster(&self, i: usize, triangle: u32, texel: u32) -> StoredCaster {
        self.field.caster(&self.field.samples[i], triangle, texel, self.size)
    }

    fn looks_in_place(
        &self,
        store: &Store<'_>,
        recipe: &Recipe,
        reading: Reading,
        surface: &Surface<'_>,
    ) -> Vec<(u32, Looks)> {
        let of = |(i, sample): (usize, &Sample)| {
            let at = Glance { sample, coord: sample.coord, footprint: &self.footprints[i] };
            let caster = |tap: usize, texel: u32| surface(i, tap, texel);
            Some((i as u32, self.look(store, recipe, reading, &at, &caster)?))
        };
        self.field.samples.iter().enumerate().filter_map(of).collect()
    }

    /// Receivers moved in f64; the change of their exact window coordinates is added to the subject's
    /// own with one rounding.
    fn looks_moved(
        &self,
        store: &Store<'_>,
        recipe: &Recipe,
        reading: Reading,
        surface: &Surface<'_>,
    ) -> Vec<(u32, Looks)> {
        let case = self.field.case();
        let moves = self.moves(recipe, &self.all());
        let mut footprint = Footprint::default();
        let mut one = |(i, sample): (usize, &Sample)| {
            let Some(coord) = moves.coord(i) else {
                let wanted = reading == Reading::All || !sample.lit;
                return wanted.then(|| (i as u32, unlooked(sample)));
            };
            footprint.place(
                self.filter,
                case.lookup.wrap,
                self.size,
                self.fixed,
                [coord[0], coord[1]],
            );
            let at = Glance { sample, coord, footprint: &footprint };
            let caster = |tap: usize, texel: u32| surface(i, tap, texel);
            let mut looks = self.look(store, recipe, reading, &at, &caster)?;
            let lit = |l: &Look| case.lookup.compare.is_lit(l.z, l.stored, 0.0);
            looks.moved_into_light = !sample.lit && looks.taps.iter().any(lit) && moves.is_lit(i);
            Some((i as u32, looks))
        };
        self.field.samples.iter().enumerate().filter_map(&mut one).collect()
    }

    /// The comparisons of one receiver; `None` where the reading leaves it out.
    fn look(
        &self,
        store: &Store<'_>,
        recipe: &Recipe,
        reading: Reading,
        at: &Glance<'_>,
        surface: &dyn Fn(usize, u32) -> (StoredCaster, f64),
    ) -> Option<Looks> {
        let Glance { sample, coord, footprint } = *at;
        let spec = &self.field.case().lookup;
        let empty = unlooked(sample);
        let whole = reading == Reading::All || !sample.lit;
        if spec.range_test && !shadow::in_square(coord) {
            return whole.then_some(empty);
        }
        let device = self.device();
        let taps = footprint.taps();
        let mixed = footprint.mixed.is_some();
        let compared = |i: usize| {
            coord[2] + recipe.follow.shift(sample.gradient, taps[i].sample, taps[i].centre)
        };
        let is_lit = |i: usize, depth: f32| spec.compare.is_lit(compared(i), depth, 0.0);
        let one = |i: usize, depth: f32, share: f64| {
            let texel = taps[i].texel;
            let (caster, gained) = surface(i, texel);
            let read = if mixed { store.depth(device, texel as usize) } else { depth };
            let sound = is_sound((store.drawn)(texel), read);
            let share = (share * SHARE) as i64;
            Look { z: compared(i), stored: depth, share, caster, sound, gained }
        };
        if mixed {
            let depth = shadow::mixed_depth(store, device, footprint);
            if !whole && recipe.follow == Follow::Receiver && is_lit(0, depth) {
                return None;
            }
            let i = mixed_tap(store, device, sample, footprint);
            let kept = whole || !is_lit(i, depth);
            return kept.then(|| Looks { taps: vec![one(i, depth, 1.0)], ..empty });
        }
        let depth = |tap: &shadow::Tap| store.depth(device, tap.texel as usize);
        if !whole && (0..taps.len()).all(|i| is_lit(i, depth(&taps[i]))) {
            return None;
        }
        let list = taps.iter().enumerate().map(|(i, tap)| one(i, depth(tap), tap.weight));
        Some(Looks { taps: list.collect(), centre: footprint.centre(), ..empty })
    }

    /// Casters under another offset, culling or layer: resolved from the fragments of each texel.
    fn with_resolved<T>(
        &self,
        texels: &[TexelFormat],
        recipe: &Recipe,
        fragments: &Fragments,
        then: impl FnOnce(&[Store<'_>], &Surface<'_>) -> T,
    ) -> T {
        let spec = self.spec(texels[0]);
        let depth_texture = matches!(texels[0], TexelFormat::Depth(_));
        assert!(texels.len() == 1 || !depth_texture, "depth textures are their own attachments");
        let attachment = match texels[0] {
            TexelFormat::Depth(format) => format,
            TexelFormat::Packed(_) if spec.depth_buffer == DepthBuffer::Unorm16 => {
                DepthFormat::Unorm16
            }
            TexelFormat::Packed(_) => DepthFormat::F32,
        };
        let offsets = fragments.offsets(attachment, recipe.polygon);
        let light = &self.field.case().light;
        let (near, far) = light.projection.near_far();
        let per_world = |z: f32| {
            let distance = light.world_from_window(f64::from(z));
            match light.is_directional() {
                true => 1.0 / (far - near),
                false => near * far / ((far - near) * distance * distance),
            }
        };
        let write = |front: bool, z: f32| {
            if recipe.oriented == 0.0 {
                return z;
            }
            let world = f64::from(if front { recipe.oriented } else { -recipe.oriented });
            z + (world * per_world(z)) as f32
        };
        let cull = match recipe.layers {
            Layers::Nearest => spec.cull,
            Layers::BackFaces => Cull::Front,
            Layers::Second | Layers::Midpoint | Layers::Dual => Cull::None,
        };
        let depth_buffer =
            if attachment == DepthFormat::Unorm16 && self.attachment == Attachment::Colour {
                attachment
            } else {
                DepthFormat::F32
            };
        let pass = Resolve { depth_buffer, cull, offsets: &offsets, write: &write };
        let resolve = |t: u32| -> Option<(f32, Layer)> {
            let [first, second] = fragments.layers(t, &pass);
            let first = first?;
            let depth =
                recipe.layers.combine(first.depth, second.map(|l| l.depth), recipe.layer_offset)?;
            let moved = recipe.layers == Layers::Second;
            Some((depth, if moved { second? } else { first }))
        };
        let resolved: Vec<OnceCell<_>> = fragments.over_texels(|_| OnceCell::new());
        let at = |t: u32| *resolved[fragments.slot(t)].get_or_init(|| resolve(t));
        let drawn = |t: u32| at(t).map(|(depth, _)| depth);
        let store =
            |&texel: &TexelFormat| self.other_store(texel, drawn, Some(fragments), resolved.len());
        let stores: Vec<Store<'_>> = texels.iter().map(store).collect();
        then(&stores, &|i, _, t| {
            let triangle = at(t).map_or(NO_TRIANGLE, |(_, layer)| layer.triangle);
            let gained = drawn(t).unwrap_or(1.0) - self.drawn(t).unwrap_or(1.0);
            (self.caster(i, triangle, t), f64::from(gained))
        })
    }

    /// The fragments after casters' vertices have moved in world space (f64), transformed by the f32
    /// clip matrix of the light.
    fn fragments_moved(&self, recipe: &Recipe) -> Fragments {
        let observer = &self.field.observer;
        let case = self.field.case();
        let device = self.device();
        let normals = vertex_normals(self.field);
        let matrix = observer.clip_from_world.as_mat4();
        let clip = |(&p, &normal): (&DVec3, &DVec3)| -> Vec4 {
            let distance = case.light.axial_distance(p);
            let site = Site {
                position: p,
                normal,
                to_light: case.light.direction_from(p),
                texel_world: case.light.texel_world(self.size, distance),
                window_per_world: 0.0,
                gradient: glam::DVec2::ZERO,
                map_size: self.size,
            };
            let moved = p + recipe.vertex_offset(&site);
            device.mat_vec(&matrix, moved.as_vec3().extend(1.0))
        };
        let geometry = &observer.geometry;
        let clip: Vec<Vec4> = geometry.positions.iter().zip(&normals).map(clip).collect();
        let wanted = wanted_texels(&self.footprints);
        Fragments::collect(device, self.size, &clip, &geometry.triangles, wanted.into_iter())
    }
}

/// The texel that decides a mix: the nearest to the light for a truly lit receiver, else the one that
/// NEAREST reads.
pub(super) fn mixed_tap(
    store: &Store<'_>,
    device: &Device,
    sample: &Sample,
    footprint: &Footprint,
) -> usize {
    if !sample.lit {
        return 0;
    }
    let depth = |i: usize| store.depth(device, footprint.taps()[i].texel as usize);
    let nearer = |best: usize, i: usize| if depth(i) < depth(best) { i } else { best };
    (0..footprint.taps().len()).fold(0, nearer)
}

/// Unit vertex normals: the triangles' area normals summed over each vertex, zero where there are none.
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
    normals.into_iter().map(unit).collect()
}

/// A receiver without comparisons.
fn unlooked(sample: &Sample) -> Looks {
    Looks { lit: sample.lit, gap: sample.gap, inside: sample.inside, ..Looks::default() }
}

/// Whether the depth read is the one drawn, up to two codes of 8 bits.
pub(super) fn is_sound(drawn: Option<f32>, read: f32) -> bool {
    drawn.is_some_and(|z| (f64::from(read) - f64::from(z.clamp(0.0, 1.0))).abs() <= 2.0 / 255.0)
}
