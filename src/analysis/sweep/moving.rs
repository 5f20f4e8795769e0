//! Receivers moved by a bias: where they look, and whether the move alone lights them.

use super::chart::Chart;
use super::moves::Moved;
use super::receivers::Sample;
use crate::shadow::bias::Recipe;
use glam::DVec3;
use std::sync::atomic::{AtomicU8, Ordering};
use std::sync::{Arc, OnceLock};

/// Where receivers look after a move: found for all of them, or one by one as they are asked.
pub(super) struct Moving<'m> {
    chart: &'m Chart<'m, 'm>,
    recipe: &'m Recipe,
    known: Option<Arc<OnceLock<Moved>>>,
}

impl Moving<'_> {
    fn known(&self) -> Option<&Moved> {
        self.known.as_ref().and_then(|moves| moves.get())
    }

    fn offset(&self, i: usize) -> DVec3 {
        self.recipe.receiver_offset(&self.chart.site(i))
    }

    /// The subject's coordinates of receiver `i`; `None` behind the light.
    pub(super) fn coord(&self, i: usize) -> Option<[f32; 3]> {
        let field = self.chart.field;
        match self.known() {
            Some(known) => known.coords[i],
            None => field.moved(&field.samples[i], self.offset(i)),
        }
    }

    /// Whether the move alone lights receiver `i`; asked of the truth once where moves are kept.
    pub(super) fn is_lit(&self, i: usize) -> bool {
        let ask = || self.chart.field.is_lit_from(&self.chart.field.samples[i], self.offset(i));
        let Some(place) = self.known().map(|known| &known.lit[i]) else { return ask() };
        match place.load(Ordering::Relaxed) {
            0 => {
                let lit = ask();
                place.store(1 + u8::from(lit), Ordering::Relaxed);
                lit
            }
            known => known == 2,
        }
    }
}

impl Chart<'_, '_> {
    /// The receivers of `which` after a recipe's move; kept where these are all.
    pub(super) fn moves<'m>(&'m self, recipe: &'m Recipe, which: &[u32]) -> Moving<'m> {
        let samples = &self.field.samples;
        let all = which.len() == samples.len();
        let known = all.then(|| {
            let entry = self.field.moves.of(recipe, self.size);
            let coord = |(i, sample): (usize, &Sample)| {
                self.field.moved(sample, recipe.receiver_offset(&self.site(i)))
            };
            entry.get_or_init(|| Moved {
                coords: samples.iter().enumerate().map(coord).collect(),
                lit: samples.iter().map(|_| AtomicU8::new(0)).collect(),
            });
            entry
        });
        Moving { chart: self, recipe, known }
    }
}
