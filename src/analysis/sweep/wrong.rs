//! Who is wrong at one amount, and how: the literal verdicts, without keeping anybody's comparisons.

use super::block::{Block, RECEIVERS, Source};
use super::chart::Chart;
use super::looks::{light_kind, shadow_kind};
use super::maps::Surface;
use super::reading::{compared, is_sound, mixed_tap};
use super::store::Store;
use super::tally::{Kind, SHARE, Tally};
use crate::analysis::classify::StoredCaster;
use crate::scene::{Filter, LookupSpec, TexelFormat};
use crate::shadow::bias::{Follow, Recipe};
use crate::shadow::{self, Footprint, Footprints, Texels};
use crate::simd::Level;

/// A receiver with a wrong verdict.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wrong {
    /// Its index.
    pub receiver: u32,
    /// What went wrong.
    pub kind: Kind,
    /// Share of its visibility that is wrong, in 2⁻⁴⁰.
    pub share: i64,
}

impl Wrong {
    /// A receiver that is lit without a look-up.
    fn unlooked(receiver: u32, lit: bool) -> Option<Self> {
        let lost = Self { receiver, kind: Kind::LightLeak, share: SHARE as i64 };
        (!lit).then_some(lost)
    }

    /// Adds it to a tally.
    pub fn tally(&self, tally: &mut Tally) {
        tally.kinds[self.kind as usize] += 1;
        *(if self.kind.is_shadow() { &mut tally.shadow } else { &mut tally.light }) += self.share;
    }
}

/// One receiver under one recipe.
struct Look<'l> {
    lit: bool,
    coord: [f32; 3],
    footprint: Footprint<'l>,
    /// Where what its taps read lies, if it looks from its own place.
    slots: &'l [u32],
}

/// A recipe on a chart under one format.
struct Verdicts<'v> {
    chart: &'v Chart<'v, 'v>,
    recipe: &'v Recipe,
    store: &'v Store<'v>,
    surface: &'v Surface<'v>,
}

impl Chart<'_, '_> {
    /// The receivers of `which` that are wrong under a recipe, in that order, format by format: the same
    /// verdicts as [`super::looks::Looks::verdict`] of [`Chart::looks`]. The formats share where receivers
    /// look and, if the recipe changes the map, its depths before they are stored: they need the same
    /// depth attachment then.
    #[must_use]
    pub fn wrong(
        &self,
        formats: &[TexelFormat],
        recipe: &Recipe,
        which: &[u32],
    ) -> Vec<Vec<Wrong>> {
        self.with_maps(formats, recipe, which, |stores, surface| {
            let verdict = |store| Verdicts { chart: self, recipe, store, surface };
            let verdicts: Vec<Verdicts<'_>> = stores.iter().map(verdict).collect();
            match recipe.moves_receiver() {
                true => self.wrong_moved(&verdicts, recipe, which),
                false => verdicts.iter().map(|v| v.in_place(which)).collect(),
            }
        })
    }

    /// Of receivers that a recipe moves: each looks once for all formats.
    fn wrong_moved(
        &self,
        verdicts: &[Verdicts<'_>],
        recipe: &Recipe,
        which: &[u32],
    ) -> Vec<Vec<Wrong>> {
        let mut found = vec![Vec::new(); verdicts.len()];
        let moves = self.moves(recipe, which);
        let follows = recipe.follow != Follow::Receiver;
        let mut footprints = Footprints::new(self.sampling, follows);
        let screen = verdicts.first().and_then(Screen::of);
        let widest = verdicts.iter().map(|v| v.store.error()).fold(0.0, f32::max);
        for &receiver in which {
            let i = receiver as usize;
            let lit = self.field.receivers.lit[i];
            let Some(coord) = moves.coord(i) else {
                found.iter_mut().for_each(|list| list.extend(Wrong::unlooked(receiver, lit)));
                continue;
            };
            let footprint =
                footprints.only(self.layout.rect(self.field.samples[i].map), [coord[0], coord[1]]);
            let look = Look { lit, coord, footprint, slots: &[] };
            let agrees = |error: f32| screen.as_ref().is_some_and(|s| s.agrees(&look, error));
            if agrees(widest) {
                continue;
            }
            for (list, under) in found.iter_mut().zip(verdicts) {
                if !agrees(under.store.error()) {
                    list.extend(under.wrong(receiver, &look, || moves.is_lit(i)));
                }
            }
        }
        found
    }
}

/// Tells of most moved receivers that they are right by the depths drawn alone: what a format stores lies
/// within its error of them, and every rule is monotone in the stored depth.
struct Screen<'v> {
    spec: &'v LookupSpec,
    drawn: &'v [f32],
    bias: f32,
}

impl<'v> Screen<'v> {
    /// None where taps differ in bias, depth or texels, or the effort leaves nothing out.
    fn of(verdicts: &Verdicts<'v>) -> Option<Self> {
        let Verdicts { chart, recipe, store, .. } = verdicts;
        let plain = recipe.follow == Follow::Receiver && chart.filter != Filter::Linear;
        let plain = plain && chart.field.skips();
        let bias = recipe.common_bias().filter(|_| plain)?;
        Some(Self { spec: &chart.field.case().lookup, drawn: &store.drawn.depth, bias })
    }

    /// Whether a receiver is surely right where no stored depth errs by more than `error`.
    fn agrees(&self, look: &Look<'_>, error: f32) -> bool {
        let Look { lit, coord, footprint, .. } = look;
        if self.spec.range_test && !shadow::in_square(*coord) {
            return *lit;
        }
        footprint.texels.iter().all(|&texel| {
            let drawn = self.drawn[texel as usize];
            let utmost = match lit {
                true => (drawn - error).next_down(),
                false => (drawn + error).next_up(),
            };
            self.spec.compare.is_lit(coord[2], utmost, self.bias) == *lit
        })
    }
}

/// Tells of receivers at their own places, many at a time, whether they are right.
#[derive(Default)]
struct Screened {
    block: Block,
    lit: Vec<bool>,
}

impl Screened {
    /// Those of some receivers with a comparison that does not say what is true, or without any.
    fn suspects(&mut self, verdicts: &Verdicts<'_>, which: &[u32]) -> Vec<u32> {
        let Verdicts { chart, recipe, store, .. } = verdicts;
        let (receivers, spec) = (&chart.field.receivers, &chart.field.case().lookup);
        let source = Source { chart, store, follow: recipe.follow };
        self.block.read(&source, which, |i| verdicts.bias(i));
        self.lit.resize(self.block.len(), false);
        self.block.margins(f32::INFINITY).lit(Level::best(), spec.compare, 1.0, &mut self.lit);
        let suspect = |&(place, &receiver): &(usize, &u32)| {
            let i = receiver as usize;
            let says = self.block.of(place, &self.lit);
            says.is_empty() || says.iter().any(|&lit| lit != receivers.lit[i])
        };
        let places = which.iter().enumerate().filter(suspect);
        places.map(|(_, &receiver)| receiver).collect()
    }
}

impl Verdicts<'_> {
    /// Of receivers that look from where they are.
    fn in_place(&self, which: &[u32]) -> Vec<Wrong> {
        let follows = self.recipe.follow != Follow::Receiver;
        let mut footprints = Footprints::new(self.chart.sampling, true);
        let receivers = &self.chart.field.receivers;
        let mut of = |receiver: u32| {
            let i = receiver as usize;
            let (coord, lit) = (receivers.coord(i), receivers.lit[i]);
            let footprint = match follows {
                true => footprints.only(
                    self.chart.layout.rect(self.chart.field.samples[i].map),
                    [coord[0], coord[1]],
                ),
                false => self.chart.reads.footprint(i),
            };
            let slots = self.chart.reads.slots(i);
            self.wrong(receiver, &Look { lit, coord, footprint, slots }, || false)
        };
        if !self.chart.field.skips() {
            return which.iter().filter_map(|&receiver| of(receiver)).collect();
        }
        let mut screened = Screened::default();
        let blocks = which.chunks(RECEIVERS);
        blocks.flat_map(|block| screened.suspects(self, block)).filter_map(&mut of).collect()
    }

    /// The bias of every tap of a receiver.
    fn bias(&self, i: usize) -> f32 {
        let weighed = || self.recipe.tap_bias(&self.chart.weights(self.store.format(), i));
        self.recipe.common_bias().unwrap_or_else(weighed)
    }

    /// What is wrong about one receiver; `moved_into_light` is asked where the answer depends on it.
    fn wrong(
        &self,
        receiver: u32,
        look: &Look<'_>,
        moved_into_light: impl Fn() -> bool,
    ) -> Option<Wrong> {
        let Look { lit, coord, ref footprint, .. } = *look;
        let bias = self.bias(receiver as usize);
        let (chart, follow) = (self.chart, self.recipe.follow);
        let sample = || &chart.field.samples[receiver as usize];
        let spec = &chart.field.case().lookup;
        if spec.range_test && !shadow::in_square(coord) {
            return Wrong::unlooked(receiver, lit);
        }
        let is_wrong = |i: usize, depth: f32| {
            let z = match follow {
                Follow::Receiver => coord[2],
                _ => compared(follow, sample(), coord[2], footprint, i),
            };
            spec.compare.is_lit(z, depth, bias) != lit
        };
        let (deciding, share) = if footprint.mixed.is_some() {
            let depth = match look.slots.is_empty() {
                true => shadow::mixed_depth(self.store, chart.device(), footprint),
                false => chart.mixed_depth(self.store, receiver as usize),
            };
            if follow == Follow::Receiver && !is_wrong(0, depth) {
                return None;
            }
            let i = mixed_tap(lit, |tap| self.depth(look, tap));
            is_wrong(i, depth).then_some((i, SHARE as i64))?
        } else {
            self.deciding(look, is_wrong)?
        };
        let texel = footprint.texels[deciding];
        let (caster, gained) = (self.surface)(receiver as usize, deciding, texel);
        let kind = if lit {
            let read = self.depth(look, deciding);
            shadow_kind(caster, is_sound(self.store.drawn(texel), read))
        } else {
            let hidden = || {
                f64::from(bias) + gained >= chart.field.receivers.gap[receiver as usize]
                    || moved_into_light()
            };
            light_kind(caster, caster == StoredCaster::Occluder && hidden())
        };
        Some(Wrong { receiver, kind, share })
    }

    /// What a tap reads.
    fn depth(&self, look: &Look<'_>, tap: usize) -> f32 {
        match look.slots.get(tap) {
            Some(&slot) => self.store.at_slot(slot),
            None => self.store.depth(self.chart.device(), look.footprint.texels[tap] as usize),
        }
    }

    /// The tap that names the error, the centre before the others in order, and the share that is wrong.
    fn deciding(
        &self,
        look: &Look<'_>,
        is_wrong: impl Fn(usize, f32) -> bool,
    ) -> Option<(usize, i64)> {
        let footprint = &look.footprint;
        let centre = footprint.centre();
        let mut found: Option<(usize, i64)> = None;
        for i in 0..footprint.texels.len() {
            if is_wrong(i, self.depth(look, i)) {
                let (first, share) = found.unwrap_or((i, 0));
                let deciding = if i == centre { i } else { first };
                found = Some((deciding, share + (footprint.share(i) * SHARE) as i64));
            }
        }
        found
    }
}
