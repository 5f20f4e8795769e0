//! Scenes whose artifacts are known in closed form.

use crate::scene::Case;

/// The analytic cases.
#[must_use]
pub fn all() -> Vec<Case> {
    Vec::new()
}
