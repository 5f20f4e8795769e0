//! World-space resolution: the length that one step of a depth format is worth at a distance.

use crate::depth::{DepthFormat, DepthMapping};
use serde::Serialize;

/// One format under one mapping.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct WorldResolution {
    /// The format.
    pub format: DepthFormat,
    /// The mapping with its planes.
    pub mapping: DepthMapping,
}

impl WorldResolution {
    /// The longer of the two lengths, in world units, from the stored depth of distance `z` to its
    /// neighbours in the format: no smaller difference can be seen there. Exact but for the
    /// mapping's own rounding; `None` where the step reaches past far (or an infinite distance).
    #[must_use]
    pub fn step_at(&self, z: f64) -> Option<f64> {
        let code = self.format.encode(self.mapping.window_from_distance(z) as f32);
        let distance = |code: u32| {
            let depth = f64::from(self.format.decode(code));
            (0.0..=1.0).contains(&depth).then(|| self.mapping.distance_from_window(depth))
        };
        let here = distance(code)?;
        let length = |code: Option<u32>| {
            let there = code.and_then(distance)?;
            there.is_finite().then_some((there - here).abs())
        };
        let (below, above) = (length(code.checked_sub(1)), length(code.checked_add(1)));
        match (below, above) {
            (Some(a), Some(b)) => Some(a.max(b)),
            (a, b) => a.or(b),
        }
        .filter(|step| step.is_finite())
    }

    /// First-order theory: quantum of the format times |dZ/dd|.
    #[must_use]
    pub fn theory_at(&self, z: f64) -> f64 {
        let depth = self.mapping.window_from_distance(z) as f32;
        self.format.quantum(depth.min(1.0f32.next_down())) * self.mapping.world_per_window(z)
    }

    /// (distance, step, theory) at `n` distances from near to far, evenly spaced in the logarithm.
    #[must_use]
    pub fn curve(&self, n: usize) -> Vec<(f64, Option<f64>, f64)> {
        let (near, far) = (self.mapping.near(), self.mapping.far());
        let ratio = libm::log(far / near);
        let at = |i: usize| near * libm::exp(ratio * (i as f64 + 0.5) / n as f64);
        (0..n).map(at).map(|z| (z, self.step_at(z), self.theory_at(z))).collect()
    }
}
