//! Receivers moved by a bias: where they look and whether the move alone lights them, found once for
//! all formats (and all map sizes where the move is in world units).

use super::chart::Chart;
use super::field::{Field, Sample};
use crate::shadow::bias::{Recipe, Site};
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

impl Moved {
    /// Whether the move alone lights receiver `i`; `ask` is called at most once a receiver.
    pub(super) fn is_lit(&self, i: usize, ask: impl Fn() -> bool) -> bool {
        match self.lit[i].load(Ordering::Relaxed) {
            0 => {
                let lit = ask();
                self.lit[i].store(1 + u8::from(lit), Ordering::Relaxed);
                lit
            }
            known => known == 2,
        }
    }

    pub(super) fn coord(&self, i: usize) -> Option<[f32; 3]> {
        self.coords[i]
    }
}

/// The subject's own coordinates of a receiver plus the change of the exact ones, one rounding each;
/// `None` behind the light.
pub(super) fn moved(field: &Field<'_>, sample: &Sample, offset: DVec3) -> Option<[f32; 3]> {
    let light = &field.case().light;
    let position = sample.receiver.position + offset;
    let window = light.window_from_world(&field.observer.clip_from_world, position)?;
    let change = (window - sample.exact).as_vec3().to_array();
    Some(std::array::from_fn(|i| sample.coord[i] + change[i]))
}

impl Chart<'_, '_> {
    /// All receivers after a recipe's move.
    pub(super) fn moved(&self, recipe: &Recipe) -> Arc<OnceLock<Moved>> {
        let entry = self.field.moves.of(recipe, self.size);
        let coord = |(sample, site): (&Sample, &Site)| {
            moved(self.field, sample, recipe.receiver_offset(site))
        };
        entry.get_or_init(|| Moved {
            coords: self.field.samples.iter().zip(&self.sites).map(coord).collect(),
            lit: self.field.samples.iter().map(|_| AtomicU8::new(0)).collect(),
        });
        entry
    }
}
