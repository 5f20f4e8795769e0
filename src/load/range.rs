//! The range of coordinates in which the f32 pipeline measures right; what lies beyond is refused.

use glam::DVec3;
use gnomon_core::num::exp2;
use gnomon_core::{Error, Result};

/// World coordinates lie below this: where a triangle is clipped, products of two clip coordinates
/// overflow f32 from 2¹²⁸ on, and clip coordinates are a few times as large as those of the world.
pub const FARTHEST: f64 = exp2(62);
/// A scene with extent is at least as large as this: below, the same products vanish.
pub const SMALLEST: f64 = exp2(-72);

/// Refuses a world point beyond the range.
///
/// # Errors
/// [`Error::BadInput`] naming the place, the largest coordinate and the range.
pub fn point(place: impl FnOnce() -> String, p: DVec3) -> Result<()> {
    let largest = p.abs().max_element();
    if largest < FARTHEST {
        return Ok(());
    }
    let reason = format!("has a coordinate of {largest:e}, f32 pipelines end at {FARTHEST:e}");
    Err(Error::bad_input(place(), reason, "scale the scene down"))
}

/// Refuses a given point beyond the range; `key` names it.
///
/// # Errors
/// As [`point`].
pub(super) fn setting(key: &str, given: Option<[f64; 3]>) -> Result<()> {
    given.map_or(Ok(()), |p| point(|| key.to_string(), DVec3::from_array(p)))
}

/// Refuses a scene that is not a point and yet too small.
///
/// # Errors
/// [`Error::BadInput`] naming the place, the extent and the range.
pub fn extent(place: &str, low: DVec3, high: DVec3) -> Result<()> {
    let largest = (high - low).max_element();
    if largest == 0.0 || largest >= SMALLEST {
        return Ok(());
    }
    let reason = format!("is {largest:e} large, f32 pipelines begin at {SMALLEST:e}");
    Err(Error::bad_input(place, reason, "scale the scene up"))
}
