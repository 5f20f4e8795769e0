//! Who is wrong at one amount, and how: the literal verdicts, without keeping anybody's comparisons.

use super::block::{Block, RECEIVERS, Source};
use super::chart::Chart;
use super::maps::Surface;
use super::reading::compared;
use super::store::Store;
use super::tally::{Kind, SHARE, Tally};
use crate::analysis::classify::StoredCaster;
use crate::analysis::verdict::{Held, LookUp, WHOLE, deciding_in_a_mix, verdict};
use crate::scene::{Filter, LookupSpec, TexelFormat};
use crate::shadow::bias::{Follow, Recipe};
use crate::shadow::{self, Footprint, Footprints, Texels};
use crate::simd::Level;
use std::cell::Cell;

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
        let lost = Self { receiver, kind: Kind::LIGHT_LEAK, share: WHOLE };
        (!lit).then_some(lost)
    }

    /// Adds it to a tally.
    pub fn tally(&self, tally: &mut Tally) {
        tally.kinds[self.kind.index()] += 1;
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
        if self.field.chooses() {
            return formats.iter().map(|&f| self.wrong_chosen(f, recipe, which)).collect();
        }
        self.with_maps(formats, recipe, which, |stores, surface| {
            let verdict = |store| Verdicts { chart: self, recipe, store, surface };
            let verdicts: Vec<Verdicts<'_>> = stores.iter().map(verdict).collect();
            match recipe.moves_receiver() {
                true => self.wrong_moved(&verdicts, recipe, which),
                false => verdicts.iter().map(|v| v.in_place(which)).collect(),
            }
        })
    }

    /// Wrong verdicts of receivers that a recipe moves; each looks once for all formats.
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
            let sample = &self.field.samples[i];
            let rect = self.layout.rect(sample.map);
            let footprint = footprints.only(rect, [coord[0], coord[1]], sample.pixel);
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

/// A test by the depths drawn alone, which most moved receivers pass as right: what a format stores lies
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
    /// The receivers among some that have a comparison that does not say what is true, or none at all.
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
    /// Wrong verdicts of receivers that look from where they are.
    fn in_place(&self, which: &[u32]) -> Vec<Wrong> {
        let follows = self.recipe.follow != Follow::Receiver;
        let mut footprints = Footprints::new(self.chart.sampling, true);
        let receivers = &self.chart.field.receivers;
        let mut of = |receiver: u32| {
            let i = receiver as usize;
            let (coord, lit) = (receivers.coord(i), receivers.lit[i]);
            let footprint = match follows {
                true => {
                    let sample = &self.chart.field.samples[i];
                    let rect = self.chart.layout.rect(sample.map);
                    footprints.only(rect, [coord[0], coord[1]], sample.pixel)
                }
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
        let weighed = || self.chart.bias(self.recipe, self.store.format(), i);
        self.recipe.common_bias().unwrap_or_else(weighed)
    }

    /// What is wrong about one receiver; `moved_into_light` is asked where the answer depends on it.
    fn wrong(
        &self,
        receiver: u32,
        look: &Look<'_>,
        moved_into_light: impl Fn() -> bool,
    ) -> Option<Wrong> {
        let bias = self.bias(receiver as usize);
        let mixed = look.footprint.mixed.is_some().then(|| self.mixed_depth(receiver, look));
        let found = Cell::new(None);
        let seen = Seen { under: self, receiver, look, bias, mixed, moved_into_light, found };
        let verdict = verdict(&seen, look.lit)?;
        Some(Wrong { receiver, kind: verdict.kind, share: verdict.share })
    }

    /// What a receiver finds whose texels are mixed.
    fn mixed_depth(&self, receiver: u32, look: &Look<'_>) -> f32 {
        match look.slots.is_empty() {
            true => shadow::mixed_depth(self.store, self.chart.device(), &look.footprint),
            false => self.chart.mixed_depth(self.store, receiver as usize),
        }
    }

    /// What a tap reads.
    fn depth(&self, look: &Look<'_>, tap: usize) -> f32 {
        match look.slots.get(tap) {
            Some(&slot) => self.store.at_slot(slot),
            None => self.store.depth(self.chart.device(), look.footprint.texels[tap] as usize),
        }
    }
}

/// What one receiver reads under a recipe.
struct Seen<'s, M> {
    under: &'s Verdicts<'s>,
    receiver: u32,
    look: &'s Look<'s>,
    bias: f32,
    /// The depth of the only part, where texels are mixed.
    mixed: Option<f32>,
    moved_into_light: M,
    /// The tap whose surface was asked for last.
    found: Cell<Option<(usize, (StoredCaster, f64))>>,
}

impl<M> Seen<'_, M> {
    /// The tap that a part rests on.
    #[inline(always)]
    fn tap(&self, part: usize) -> usize {
        if self.mixed.is_none() {
            return part;
        }
        let Look { lit, footprint, .. } = self.look;
        let depth = |tap: usize| self.under.depth(self.look, tap);
        deciding_in_a_mix(*lit, footprint.texels.len(), depth)
    }

    /// The owner of the surface that a part holds, and how far the bias moved it.
    fn surface(&self, part: usize) -> (StoredCaster, f64) {
        let tap = self.tap(part);
        if let Some((_, surface)) = self.found.get().filter(|found| found.0 == tap) {
            return surface;
        }
        let texel = self.look.footprint.texels[tap];
        let surface = (self.under.surface)(self.receiver as usize, tap, texel);
        self.found.set(Some((tap, surface)));
        surface
    }
}

impl<M> Held for Seen<'_, M> {
    fn caster(&self, part: usize) -> StoredCaster {
        self.surface(part).0
    }

    fn is_sound(&self, part: usize) -> bool {
        let tap = self.tap(part);
        let drawn = self.under.store.drawn(self.look.footprint.texels[tap]);
        self.under.store.is_sound(drawn, self.under.depth(self.look, tap))
    }

    #[inline(always)]
    fn share(&self, part: usize) -> i64 {
        match self.mixed {
            Some(_) => WHOLE,
            None => (self.look.footprint.share(part) * SHARE) as i64,
        }
    }
}

impl<M: Fn() -> bool> LookUp for Seen<'_, M> {
    #[inline(always)]
    fn parts(&self) -> usize {
        let tested = self.under.chart.field.case().lookup.range_test;
        match (tested && !shadow::in_square(self.look.coord), self.mixed) {
            (true, _) => 0,
            (false, Some(_)) => 1,
            (false, None) => self.look.footprint.texels.len(),
        }
    }

    #[inline(always)]
    fn centre(&self) -> usize {
        if self.mixed.is_some() { 0 } else { self.look.footprint.centre() }
    }

    #[inline(always)]
    fn visibility(&self, part: usize) -> f64 {
        let Verdicts { chart, recipe, .. } = *self.under;
        let Look { coord, footprint, .. } = self.look;
        let depth = self.mixed.unwrap_or_else(|| self.under.depth(self.look, part));
        let z = match recipe.follow {
            Follow::Receiver => coord[2],
            Follow::TexelCentre | Follow::Sample | Follow::NearerOfCentre => {
                let sample = &chart.field.samples[self.receiver as usize];
                compared(recipe.follow, sample, coord[2], footprint, self.tap(part))
            }
        };
        let lit = chart.field.case().lookup.compare.is_lit(z, depth, self.bias);
        if lit { 1.0 } else { 0.0 }
    }

    fn is_hidden(&self, part: usize) -> bool {
        let gained = self.surface(part).1;
        let gap = self.under.chart.field.receivers.gap[self.receiver as usize];
        f64::from(self.bias) + gained >= gap || (self.moved_into_light)()
    }
}
