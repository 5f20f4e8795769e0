//! Reading a chart: receivers at their own places, moved by a bias, under another map, reversed.

use super::chart::Chart;
use super::drawn::{Drawn, Places};
use super::field::Sample;
use super::looks::{Look, Looks};
use super::maps::Surface;
use super::store::Store;
use super::tally::SHARE;
use crate::analysis::classify::StoredCaster;
use crate::analysis::verdict::deciding_in_a_mix;
use crate::light::Lens;
use crate::raster::NO_TRIANGLE;
use crate::scene::TexelFormat;
use crate::shadow::bias::{Follow, Recipe};
use crate::shadow::{self, Few, Footprint, Footprints, Texels};
use glam::{DMat4, DVec3, DVec4, Vec4};

/// One receiver's look-up.
pub(super) struct Glance<'g> {
    pub(super) sample: &'g Sample,
    pub(super) coord: [f32; 3],
    pub(super) footprint: Footprint<'g>,
}

impl Chart<'_, '_> {
    /// All comparisons without a bias under reversed depth (1 at near, 0 at far, clip z in [0, 1]): the
    /// same coverage, depths of the reversed f32 matrix, both sides negated so that the case's rule holds.
    #[must_use]
    pub fn looks_reversed(&self, texel: TexelFormat) -> Vec<Looks> {
        let observer = &self.field.observer;
        let subject = &observer.subject;
        let z_column = DVec4::new(0.0, 0.0, -0.5, 0.0);
        let w_column = DVec4::new(0.0, 0.0, 0.5, 1.0);
        let reverse = DMat4::from_cols(DVec4::X, DVec4::Y, z_column, w_column);
        let clip = |lens: &Lens| -> Vec<Vec4> {
            let matrix = (reverse * lens.clip_from_world).as_mat4();
            let clip = |p: &DVec3| self.device().mat_vec(&matrix, p.as_vec3().extend(1.0));
            observer.geometry.positions.iter().map(clip).collect()
        };
        let clip: Vec<Vec<Vec4>> = observer.lenses.iter().map(clip).collect();
        let fragments = self.fragments();
        let corners = |map: usize, t: u32| {
            observer.geometry.triangles[t as usize].map(|v| clip[map][v as usize])
        };
        let depth = |t: u32| match (self.raster.triangle[t as usize], self.layout.map_of(t)) {
            (NO_TRIANGLE, _) | (_, None) => 0.0,
            (id, Some(map)) => fragments.value(map, t, id, corners(map, id).map(|v| v.z)),
        };
        // Cleared texels are drawn with 0.
        let drawn = Drawn {
            depth: self.slots.over_texels(depth).into(),
            triangle: vec![0; self.slots.len()].into(),
        };
        let receiver = |sample: &Sample| {
            let triangle = sample.receiver.triangle;
            let varyings = subject.camera_setup(triangle).varyings(self.device());
            let [x, y] = sample.pixel.map(|c| c as f32);
            let of = |pick: fn(Vec4) -> f32| {
                varyings.scalar(corners(sample.map, triangle).map(pick), x, y)
            };
            of(|v| v.z) / of(|v| v.w)
        };
        let places = Places::Slots(&self.slots);
        let store = self.other_store(texel, &drawn, &places);
        let mut looks = self.looks_in_place(&store, &Recipe::default(), &|i, tap, _| {
            (self.own_caster(i, tap), 0.0)
        });
        for (look, sample) in looks.iter_mut().zip(&self.field.samples) {
            let z = receiver(sample);
            for tap in look.taps.iter_mut() {
                (tap.z, tap.stored) = (-z, -tap.stored);
            }
        }
        looks
    }

    /// All comparisons of all receivers under a format and a recipe.
    #[must_use]
    pub fn looks(&self, texel: TexelFormat, recipe: &Recipe) -> Vec<Looks> {
        self.with_maps(&[texel], recipe, &self.all(), |stores, surface| {
            if self.field.chooses() {
                return self.looks_chosen(&stores[0], recipe);
            }
            match recipe.moves_receiver() {
                true => self.looks_moved(&stores[0], recipe, surface),
                false => self.looks_in_place(&stores[0], recipe, surface),
            }
        })
    }

    /// The owner of the surface that tap `tap` of receiver `i` finds in a texel: known where both are
    /// those that it finds without a bias.
    pub(super) fn caster(&self, i: usize, tap: usize, triangle: u32, texel: u32) -> StoredCaster {
        let own = self.reads.slots(i).get(tap).map(|&slot| slot as usize);
        let same =
            |&slot: &usize| self.slots.texel(slot) == texel && self.own.triangle[slot] == triangle;
        if own.filter(same).is_some() {
            return self.own_caster(i, tap);
        }
        self.field.caster(&self.field.samples[i], triangle, texel, &self.layout)
    }

    fn looks_in_place(
        &self,
        store: &Store<'_>,
        recipe: &Recipe,
        surface: &Surface<'_>,
    ) -> Vec<Looks> {
        let mut footprints = Footprints::new(self.sampling, true);
        let of = |(i, sample): (usize, &Sample)| {
            let [u, v, _] = sample.coord;
            let at = Glance {
                sample,
                coord: sample.coord,
                footprint: footprints.only(self.layout.rect(sample.map), [u, v], sample.pixel),
            };
            self.look(store, recipe, &at, &|tap, texel| surface(i, tap, texel))
        };
        self.field.samples.iter().enumerate().map(of).collect()
    }

    /// Receivers moved in f64; the change of their exact window coordinates is added to the subject's
    /// own with one rounding.
    fn looks_moved(&self, store: &Store<'_>, recipe: &Recipe, surface: &Surface<'_>) -> Vec<Looks> {
        let case = self.field.case();
        let moves = self.moves(recipe, &self.all());
        let mut footprints = Footprints::new(self.sampling, true);
        let one = |(i, sample): (usize, &Sample)| {
            let Some(coord) = moves.coord(i) else { return unlooked(sample) };
            let at = Glance {
                sample,
                coord,
                footprint: footprints.only(
                    self.layout.rect(sample.map),
                    [coord[0], coord[1]],
                    sample.pixel,
                ),
            };
            let mut looks = self.look(store, recipe, &at, &|tap, texel| surface(i, tap, texel));
            let lit = |l: &Look| case.lookup.compare.is_lit(l.z, l.stored, 0.0);
            looks.moved_into_light = !sample.lit && looks.taps.iter().any(lit) && moves.is_lit(i);
            looks
        };
        self.field.samples.iter().enumerate().map(one).collect()
    }

    /// The comparisons of one receiver.
    fn look(
        &self,
        store: &Store<'_>,
        recipe: &Recipe,
        at: &Glance<'_>,
        surface: &dyn Fn(usize, u32) -> (StoredCaster, f64),
    ) -> Looks {
        let tested = self.field.case().lookup.range_test;
        match tested && !shadow::in_square(at.coord) {
            true => unlooked(at.sample),
            false => self.comparisons(store, recipe, at, surface),
        }
    }

    /// The comparisons of one receiver in one map, whatever a range test says.
    pub(super) fn comparisons(
        &self,
        store: &Store<'_>,
        recipe: &Recipe,
        at: &Glance<'_>,
        surface: &dyn Fn(usize, u32) -> (StoredCaster, f64),
    ) -> Looks {
        let Glance { sample, coord, ref footprint } = *at;
        let (device, empty) = (self.device(), unlooked(sample));
        let one = |i: usize, stored: f32| {
            let texel = footprint.texels[i];
            let (caster, gained) = surface(i, texel);
            let read = store.depth(device, texel as usize);
            let sound = store.is_sound(store.drawn(texel), read);
            let share = (footprint.share(i) * SHARE) as i64;
            let z = compared(recipe.follow, sample, coord[2], footprint, i);
            let Sample { map, gap, .. } = *sample;
            Look { z, stored, share, caster, sound, gained, map, gap }
        };
        if footprint.mixed.is_some() {
            let depth = shadow::mixed_depth(store, device, footprint);
            let read = |i: usize| store.depth(device, footprint.texels[i] as usize);
            let i = deciding_in_a_mix(sample.lit, footprint.texels.len(), read);
            return Looks { taps: Few::One(one(i, depth)), ..empty };
        }
        let depth = |&texel: &u32| store.depth(device, texel as usize);
        let list = footprint.texels.iter().map(depth).enumerate().map(|(i, d)| one(i, d));
        Looks { taps: list.collect(), centre: footprint.centre(), ..empty }
    }
}

/// The receiver depth that tap `i` compares; offsets are needed where it follows the plane.
pub(super) fn compared(
    follow: Follow,
    sample: &Sample,
    z: f32,
    footprint: &Footprint<'_>,
    i: usize,
) -> f32 {
    match follow {
        Follow::Receiver => z,
        Follow::TexelCentre | Follow::Sample | Follow::NearerOfCentre => {
            z + follow.shift(sample.gradient, footprint.offsets[i])
        }
    }
}

/// A receiver without comparisons.
pub(super) fn unlooked(sample: &Sample) -> Looks {
    Looks { lit: sample.lit, inside: sample.inside, ..Looks::default() }
}
