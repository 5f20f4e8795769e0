//! Reading a chart: receivers at their own places, moved by a bias, under another map, reversed.

use super::chart::Chart;
use super::field::{Head, Sample};
use super::looks::{Look, Looks};
use super::maps::Surface;
use super::store::{Drawn, Places, Store};
use super::tally::SHARE;
use crate::analysis::classify::StoredCaster;
use crate::device::Device;
use crate::raster::NO_TRIANGLE;
use crate::scene::TexelFormat;
use crate::shadow::bias::{Follow, Recipe};
use crate::shadow::{self, Few, Footprint, Footprints, Texels};
use glam::{DMat4, DVec3, DVec4, Vec4};

/// Which receivers are read.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Reading {
    /// All of them.
    All,
    /// Those that can be wrong at a tap bias ≥ 0: truly lit ones that are lit at 0 are left out.
    Breakable,
}

/// One receiver's look-up.
struct Glance<'g> {
    sample: &'g Sample,
    coord: [f32; 3],
    footprint: Footprint<'g>,
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
        let depth = |t: u32| match self.raster.triangle[t as usize] {
            NO_TRIANGLE => 0.0,
            id => self.fragments.value(t, id, corners(id).map(|v| v.z)),
        };
        // Cleared texels are drawn with 0.
        let drawn = Drawn {
            depth: self.fragments.over_texels(depth).into(),
            triangle: vec![0; self.fragments.len()].into(),
        };
        let receiver = |sample: &Sample| {
            let triangle = sample.receiver.triangle;
            let varyings = subject.camera_setup(triangle).varyings(self.device());
            let [x, y] = sample.pixel.map(|c| c as f32);
            let of = |pick: fn(Vec4) -> f32| varyings.scalar(corners(triangle).map(pick), x, y);
            of(|v| v.z) / of(|v| v.w)
        };
        let places = Places::Slots(&self.fragments);
        let store = self.other_store(texel, &drawn, &places);
        let read = self.looks_in_place(&store, &Recipe::default(), Reading::All, &|i, tap, _| {
            (self.own_casters(i)[tap], 0.0)
        });
        let mut looks: Vec<Looks> = read.into_iter().map(|(_, looks)| looks).collect();
        for (look, sample) in looks.iter_mut().zip(&self.field.samples) {
            let z = receiver(sample);
            for tap in look.taps.iter_mut() {
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
        self.with_maps(&[texel], recipe, &self.all(), |stores, surface| {
            match recipe.moves_receiver() {
                true => self.looks_moved(&stores[0], recipe, reading, surface),
                false => self.looks_in_place(&stores[0], recipe, reading, surface),
            }
        })
    }

    /// Whose surface a triangle is that tap `tap` of receiver `i` finds in a texel: known where both are
    /// those that it finds without a bias.
    pub(super) fn caster(&self, i: usize, tap: usize, triangle: u32, texel: u32) -> StoredCaster {
        let own = self.reads.slots(i).get(tap).map(|&slot| slot as usize);
        let same = |&slot: &usize| {
            self.fragments.texel(slot) == texel && self.own.triangle[slot] == triangle
        };
        if own.filter(same).is_some() {
            return self.own_casters(i)[tap];
        }
        self.field.caster(&self.field.samples[i], triangle, texel, self.size)
    }

    /// Whether every tap of a receiver, looking from where it is at its own depth, says what is true.
    pub(super) fn agrees(&self, store: &Store<'_>, i: usize, bias: f32) -> bool {
        let Head { coord, lit, .. } = self.field.heads[i];
        let spec = &self.field.case().lookup;
        if spec.range_test && !shadow::in_square(coord) {
            return lit;
        }
        let says = |depth: f32| spec.compare.is_lit(coord[2], depth, bias) == lit;
        match (self.reads.mixed(i), self.reads.footprint(i).mixed) {
            (Some(slots), Some(mixed)) => says(store.mixed(slots, mixed.weights)),
            _ => self.reads.slots(i).iter().all(|&slot| says(store.at_slot(slot))),
        }
    }

    fn looks_in_place(
        &self,
        store: &Store<'_>,
        recipe: &Recipe,
        reading: Reading,
        surface: &Surface<'_>,
    ) -> Vec<(u32, Looks)> {
        let screened = reading == Reading::Breakable && recipe.follow == Follow::Receiver;
        let of = |(i, sample): (usize, &Sample)| {
            if screened && self.field.heads[i].lit && self.agrees(store, i, 0.0) {
                return None;
            }
            let footprint = self.reads.footprint(i);
            let at = Glance { sample, coord: sample.coord, footprint };
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
        let mut footprints = Footprints::new(self.sampling, true);
        let mut one = |(i, sample): (usize, &Sample)| {
            let Some(coord) = moves.coord(i) else {
                let wanted = reading == Reading::All || !sample.lit;
                return wanted.then(|| (i as u32, unlooked(sample)));
            };
            let footprint = footprints.only([coord[0], coord[1]]);
            let at = Glance { sample, coord, footprint };
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
        let Glance { sample, coord, ref footprint } = *at;
        let spec = &self.field.case().lookup;
        let empty = unlooked(sample);
        let whole = reading == Reading::All || !sample.lit;
        if spec.range_test && !shadow::in_square(coord) {
            return whole.then_some(empty);
        }
        let device = self.device();
        let taps = footprint.taps;
        let mixed = footprint.mixed.is_some();
        let compared = |i: usize| compared(recipe.follow, sample, coord[2], footprint, i);
        let is_lit = |i: usize, depth: f32| spec.compare.is_lit(compared(i), depth, 0.0);
        let one = |i: usize, depth: f32, share: f64| {
            let texel = taps[i].texel;
            let (caster, gained) = surface(i, texel);
            let read = if mixed { store.depth(device, texel as usize) } else { depth };
            let sound = is_sound(store.drawn(texel), read);
            let share = (share * SHARE) as i64;
            Look { z: compared(i), stored: depth, share, caster, sound, gained }
        };
        if mixed {
            let depth = shadow::mixed_depth(store, device, footprint);
            if !whole && recipe.follow == Follow::Receiver && is_lit(0, depth) {
                return None;
            }
            let i = mixed_tap(store, device, sample.lit, footprint);
            let kept = whole || !is_lit(i, depth);
            return kept.then(|| Looks { taps: Few::One(one(i, depth, 1.0)), ..empty });
        }
        let depth = |tap: &shadow::Tap| store.depth(device, tap.texel as usize);
        if !whole && (0..taps.len()).all(|i| is_lit(i, depth(&taps[i]))) {
            return None;
        }
        let list = taps.iter().enumerate().map(|(i, tap)| one(i, depth(tap), tap.weight));
        Some(Looks { taps: list.collect(), centre: footprint.centre(), ..empty })
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
        _ => z + follow.shift(sample.gradient, footprint.offsets[i]),
    }
}

/// The texel that decides a mix: the nearest to the light for a truly lit receiver, else the one that
/// NEAREST reads.
pub(super) fn mixed_tap(
    store: &Store<'_>,
    device: &Device,
    lit: bool,
    footprint: &Footprint<'_>,
) -> usize {
    if !lit {
        return 0;
    }
    let depth = |i: usize| store.depth(device, footprint.taps[i].texel as usize);
    let nearer = |best: usize, i: usize| if depth(i) < depth(best) { i } else { best };
    (0..footprint.taps.len()).fold(0, nearer)
}

/// A receiver without comparisons.
fn unlooked(sample: &Sample) -> Looks {
    Looks { lit: sample.lit, gap: sample.gap, inside: sample.inside, ..Looks::default() }
}

/// Whether the depth read is the one drawn, up to two codes of 8 bits.
pub(super) fn is_sound(drawn: Option<f32>, read: f32) -> bool {
    drawn.is_some_and(|z| (f64::from(read) - f64::from(z.clamp(0.0, 1.0))).abs() <= 2.0 / 255.0)
}
