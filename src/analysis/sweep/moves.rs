//! Receivers moved by a bias: where they look and whether the move alone lights them, found once for
//! all formats (and all map sizes where the move is in world units).

use super::chart::Chart;
use super::field::{Field, Sample};
use crate::shadow::bias::Recipe;
use glam::DVec3;
use std::collections::HashMap;
use std::sync::atomic::{AtomicU8, Ordering};
use std::sync::{Arc, Mutex, OnceLock};

/// Everything that a move of receivers depends on, as bits.
type Key = (u64, u8, bool, bool, u64, u32);

/// The moves of a field so far.
#[derive(Debug, Default)]
pub(super) struct Moves(Mutex<HashMap<Key, Arc<OnceLock<Moved>>>>);

/// All receivers of a field after one move.
#[derive(Debug)]
pub(super) struct Moved {
    /// The subject's coordinates there; `None` behind the light.
    coords: Vec<Option<[f32; 3]>>,
    /// Whether the move alone lights a truly shadowed receiver: 0 not asked yet, 1 no, 2 yes.
    lit: Vec<AtomicU8>,
}

impl Moves {
    fn of(&self, recipe: &Recipe, size: u32) -> Arc<OnceLock<Moved>> {
        let normal = recipe.normal;
        let key = (
            normal.amount.to_bits(),
            normal.weight as u8,
            normal.in_texels,
            normal.sideways,
            recipe.light.to_bits(),
            if normal.in_texels { size } else { 0 },
        );
        let mut moves = self.0.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        moves.entry(key).or_default().clone()
    }
}

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
            None => moved(field, &field.samples[i], self.offset(i)),
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

/// The subject's own coordinates of a receiver plus the change of the exact ones, one rounding each;
/// `None` behind the light.
pub(super) fn moved(field: &Field<'_>, sample: &Sample, offset: DVec3) -> Option<[f32; 3]> {
    let look = field.observer.lenses[sample.map].look(sample.receiver.position + offset)?;
    let change = (look - sample.exact).as_vec3().to_array();
    Some(std::array::from_fn(|i| sample.coord[i] + change[i]))
}

impl Chart<'_, '_> {
    /// The receivers of `which` after a recipe's move; kept where these are all.
    pub(super) fn moves<'m>(&'m self, recipe: &'m Recipe, which: &[u32]) -> Moving<'m> {
        let samples = &self.field.samples;
        let all = which.len() == samples.len();
        let known = all.then(|| {
            let entry = self.field.moves.of(recipe, self.size);
            let coord = |(i, sample): (usize, &Sample)| {
                moved(self.field, sample, recipe.receiver_offset(&self.site(i)))
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
