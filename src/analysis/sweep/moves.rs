//! The moves of receivers that a field has met: kept for all formats (and all map sizes where a move is in
//! world units).

use crate::shadow::bias::Recipe;
use std::collections::HashMap;
use std::sync::atomic::AtomicU8;
use std::sync::{Arc, Mutex, OnceLock};

/// Everything that a move of receivers depends on, as bits.
type Key = (u64, u8, u8, bool, bool, u64, u32);

/// The moves of a field so far.
#[derive(Debug, Default)]
pub(super) struct Moves(Mutex<HashMap<Key, Arc<OnceLock<Moved>>>>);

/// All receivers of a field after one move.
#[derive(Debug)]
pub(super) struct Moved {
    /// The subject's coordinates there; `None` behind the light.
    pub(super) coords: Vec<Option<[f32; 3]>>,
    /// Whether the move alone lights a truly shadowed receiver: 0 not asked yet, 1 no, 2 yes.
    pub(super) lit: Vec<AtomicU8>,
}

impl Moves {
    pub(super) fn of(&self, recipe: &Recipe, size: u32) -> Arc<OnceLock<Moved>> {
        let normal = recipe.normal;
        let key = (
            normal.amount.to_bits(),
            normal.weight as u8,
            normal.along as u8,
            normal.in_texels,
            normal.sideways,
            recipe.light.to_bits(),
            if normal.in_texels { size } else { 0 },
        );
        let mut moves = self.0.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        moves.entry(key).or_default().clone()
    }
}
