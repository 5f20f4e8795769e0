//! Interior receivers: those whose neighbourhood in the map sees one object first, so that edges play
//! no part.

use super::observe::{Observation, Observer, Standing};
use crate::truth::{Faces, FirstHit};
use glam::DVec2;
use rayon::prelude::*;

/// Distance of the eight neighbours from the receiver in map texels.
const REACH: f64 = 1.5;

/// For each observation: whether nine light rays (its own and eight around it at 1.5 map texels) hit
/// the same object first. Receivers outside the map or of undecided truth are never interior;
/// receivers facing away from the light may be.
#[must_use]
pub fn interior(observer: &Observer<'_>, observations: &[Observation]) -> Vec<bool> {
    observations.par_iter().map(|o| is_interior(observer, o)).collect()
}

fn is_interior(observer: &Observer<'_>, o: &Observation) -> bool {
    if !matches!(o.standing, Standing::Counted | Standing::FacingAway) || !in_map(o) {
        return false;
    }
    let texel = 1.0 / f64::from(observer.case().map.size);
    let object = |dx: f64, dy: f64| {
        let uv = o.exact.truncate() + DVec2::new(dx, dy) * REACH * texel;
        match observer.first_along(uv, Faces::Both) {
            FirstHit::Hit { triangle, .. } => Some(observer.geometry.object[triangle as usize]),
            FirstHit::None | FirstHit::Ambiguous => None,
        }
    };
    let Some(centre) = object(0.0, 0.0) else { return false };
    const AROUND: [[f64; 2]; 8] = [
        [-1.0, -1.0],
        [1.0, 1.0],
        [-1.0, 1.0],
        [1.0, -1.0],
        [0.0, -1.0],
        [0.0, 1.0],
        [-1.0, 0.0],
        [1.0, 0.0],
    ];
    AROUND.iter().all(|&[dx, dy]| object(dx, dy) == Some(centre))
}

fn in_map(o: &Observation) -> bool {
    o.exact.min_element() >= 0.0 && o.exact.max_element() <= 1.0
}
