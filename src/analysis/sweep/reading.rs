//! Reading a chart: receivers at their own places, moved by a bias, under another map, reversed.

use super::chart::{Attachment, Chart, wanted_texels};
use super::field::{Field, Sample};
use super::looks::{Look, Looks};
use super::moves::moved;
use super::store::Store;
use super::tally::SHARE;
use crate::analysis::classify::StoredCaster;
use crate::depth::DepthFormat;
use crate::raster::{Fragments, Layer, NO_TRIANGLE, Resolve};
use crate::scene::{Cull, DepthBuffer, TexelFormat};
use crate::shadow::bias::{Follow, Layers, Recipe, Site, Weights};
use crate::shadow::{self, Footprint, Texels};
use glam::{DMat4, DVec3, DVec4, Vec4};
use std::cell::OnceCell;

/// Which receivers are read, and how much of each.
#[derive(Clone, Copy)]
pub(super) enum Reading<'w> {
    /// All of every receiver.
    All,
    /// All of those that can be wrong at a tap bias ≥ 0: truly lit ones that are lit at 0 are left out.
    Breakable,
    /// Those that are wrong at the recipe's own tap bias; taps that are right read as *own*.
    Wrong(&'w [Weights]),
}

/// One receiver's look-up: where, and how much of it is read.
struct Glance<'g> {
    sample: &'g Sample,
    coord: [f32; 3],
    footprint: &'g Footprint,
    /// The bias at which it is left out where every tap is right.
    unless_right_at: Option<f32>,
    /// Whether taps that are right there have no caster looked up.
    brief: bool,
}

impl<'g> Glance<'g> {
    fn new(
        reading: Reading<'_>,
        recipe: &Recipe,
        i: usize,
        place: (&'g Sample, [f32; 3], &'g Footprint),
    ) -> Self {
        let (sample, coord, footprint) = place;
        let (unless_right_at, brief) = match reading {
            Reading::All => (None, false),
            Reading::Breakable => (sample.lit.then_some(0.0), false),
            Reading::Wrong(weights) => (Some(recipe.tap_bias(&weights[i])), true),
        };
        Self { sample, coord, footprint, unless_right_at, brief }
    }
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
        let store = self.other_store(texel, drawn, |t| t as usize, texels);
        let all = self.all();
        let plain = Recipe::default();
        let read = self
            .looks_with(&store, &plain, Reading::All, &all, &|i, tap, _| (casters[i][tap], 0.0));
        let mut looks: Vec<Looks> = read.into_iter().map(|(_, looks)| looks).collect();
        for (look, sample) in looks.iter_mut().zip(&self.field.samples) {
            let z = receiver(sample);
            for tap in &mut look.taps {
                (tap.z, tap.stored) = (-z, -tap.stored);
            }
        }
        looks
    }

    /// Receivers at their own places; `stored` gives whose surface tap `tap` of sample i holds and how
    /// far the bias moved it.
    pub(super) fn looks_with(
        &self,
        store: &Store<'_>,
        recipe: &Recipe,
        reading: Reading<'_>,
        which: &[u32],
        stored: &dyn Fn(usize, usize, u32) -> (StoredCaster, f64),
    ) -> Vec<(u32, Looks)> {
        let of = |&id: &u32| {
            let i = id as usize;
            let (sample, footprint) = (&self.field.samples[i], &self.footprints[i]);
            let caster = |tap: usize, texel: u32| stored(i, tap, texel);
            let at = Glance::new(reading, recipe, i, (sample, sample.coord, footprint));
            Some((id, self.look(store, recipe, &at, &caster)?))
        };
        which.iter().filter_map(of).collect()
    }

    /// The comparisons of one receiver; `None` where it is right at the bias that is given.
    fn look(
        &self,
        store: &Store<'_>,
        recipe: &Recipe,
        at: &Glance<'_>,
        stored: &dyn Fn(usize, u32) -> (StoredCaster, f64),
    ) -> Option<Looks> {
        let Glance { sample, coord, footprint, unless_right_at, brief } = *at;
        let spec = &self.field.case().lookup;
        let empty = unlooked(sample);
        if spec.range_test && !shadow::in_square(coord) {
            return (unless_right_at.is_none() || !sample.lit).then_some(empty);
        }
        let device = self.device();
        let taps = footprint.taps();
        let mixed = footprint.mixed.is_some();
        let compared = |i: usize| {
            coord[2] + recipe.follow.shift(sample.gradient, taps[i].sample, taps[i].centre)
        };
        let right = |z: f32, depth: f32| {
            unless_right_at.is_some_and(|b| spec.compare.is_lit(z, depth, b) == sample.lit)
        };
        let one = |i: usize, depth: f32, share: f64| {
            let z = compared(i);
            let share = (share * SHARE) as i64;
            if brief && right(z, depth) {
                let caster = StoredCaster::Own;
                return Look { z, stored: depth, share, caster, sound: true, gained: 0.0 };
            }
            let texel = taps[i].texel;
            let (caster, gained) = stored(i, texel);
            let read = if mixed { store.depth(device, texel as usize) } else { depth };
            let sound = is_sound((store.drawn)(texel), read);
            Look { z, stored: depth, share, caster, sound, gained }
        };
        if mixed {
            let depth = shadow::mixed_depth(store, device, footprint);
            if recipe.follow == Follow::Receiver && right(coord[2], depth) {
                return None;
            }
            let i = self.mixed_tap(store, sample, footprint);
            let wrong = !right(compared(i), depth);
            return wrong.then(|| Looks { taps: vec![one(i, depth, 1.0)], ..empty });
        }
        let depth = |tap: &shadow::Tap| store.depth(device, tap.texel as usize);
        if (0..taps.len()).all(|i| right(compared(i), depth(&taps[i]))) {
            return None;
        }
        let list = taps.iter().enumerate().map(|(i, tap)| one(i, depth(tap), tap.weight));
        let heaviest = |best: usize, i: usize| {
            if taps[i].weight > taps[best].weight { i } else { best }
        };
        let centre =
            if footprint.weighted { (0..taps.len()).fold(0, heaviest) } else { taps.len() / 2 };
        Some(Looks { taps: list.collect(), centre, ..empty })
    }

    /// The texel that decides a mix: the nearest to the light for a truly lit receiver, else the one
    /// that NEAREST reads.
    fn mixed_tap(&self, store: &Store<'_>, sample: &Sample, footprint: &Footprint) -> usize {
        if !sample.lit {
            return 0;
        }
        let depth = |i: usize| store.depth(self.device(), footprint.taps()[i].texel as usize);
        let nearer = |best: usize, i: usize| if depth(i) < depth(best) { i } else { best };
        (0..footprint.taps().len()).fold(0, nearer)
    }

    /// Receivers moved in f64; the change of their exact window coordinates is added to the subject's
    /// own with one rounding.
    pub(super) fn looks_moved(
        &self,
        texel: TexelFormat,
        recipe: &Recipe,
        reading: Reading<'_>,
        which: &[u32],
    ) -> Vec<(u32, Looks)> {
        let case = self.field.case();
        let store = self.own_store(texel);
        let fixed = shadow::fixed_coordinates(self.device(), texel);
        let mut footprint = Footprint::default();
        let all = (which.len() == self.field.samples.len()).then(|| self.moved(recipe));
        let known = all.as_ref().and_then(|moves| moves.get());
        let mut one = |&id: &u32| {
            let i = id as usize;
            let sample = &self.field.samples[i];
            let offset = || recipe.receiver_offset(&self.sites[i]);
            let coord =
                known.map_or_else(|| moved(self.field, sample, offset()), |known| known.coord(i));
            let Some(coord) = coord else {
                let wanted = matches!(reading, Reading::All) || !sample.lit;
                return wanted.then(|| (id, unlooked(sample)));
            };
            footprint.place(self.filter, case.lookup.wrap, self.size, fixed, [coord[0], coord[1]]);
            let caster = |_: usize, t: u32| {
                (self.field.caster(sample, self.raster.triangle[t as usize], t, self.size), 0.0)
            };
            let at = Glance::new(reading, recipe, i, (sample, coord, &footprint));
            let mut looks = self.look(&store, recipe, &at, &caster)?;
            let rule = case.lookup.compare;
            let bias = at.unless_right_at.unwrap_or(0.0);
            let lit = |l: &Look| rule.is_lit(l.z, l.stored, bias);
            if !sample.lit && looks.taps.iter().any(lit) {
                let ask = || self.field.is_lit_from(sample, offset());
                looks.moved_into_light = known.map_or_else(ask, |known| known.is_lit(i, ask));
            }
            Some((id, looks))
        };
        which.iter().filter_map(&mut one).collect()
    }

    /// Casters under another offset, culling or layer: resolved from the fragments of each texel.
    pub(super) fn looks_resolved(
        &self,
        texel: TexelFormat,
        recipe: &Recipe,
        reading: Reading<'_>,
        fragments: &Fragments,
        which: &[u32],
    ) -> Vec<(u32, Looks)> {
        let spec = self.spec(texel);
        let attachment = match texel {
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
        let place = |t: u32| fragments.slot(t);
        let store = self.other_store(texel, drawn, place, resolved.len());
        self.looks_with(&store, recipe, reading, which, &|i, _, t| {
            let triangle = at(t).map_or(NO_TRIANGLE, |(_, layer)| layer.triangle);
            let caster = self.field.caster(&self.field.samples[i], triangle, t, self.size);
            let gained = drawn(t).unwrap_or(1.0) - self.drawn(t).unwrap_or(1.0);
            (caster, f64::from(gained))
        })
    }

    /// The fragments after casters' vertices have moved in world space (f64), transformed by the f32
    /// clip matrix of the light.
    pub(super) fn fragments_moved(&self, recipe: &Recipe) -> Fragments {
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

fn is_sound(drawn: Option<f32>, read: f32) -> bool {
    drawn.is_some_and(|z| (f64::from(read) - f64::from(z.clamp(0.0, 1.0))).abs() <= 2.0 / 255.0)
}
