//! What every verdict asks of a receiver: lists side by side, 29 bytes a receiver.

use super::field::Sample;
use rayon::prelude::*;

/// All counted receivers, in their order; every list is as long.
#[derive(Debug)]
pub(super) struct Receivers {
    /// Map coordinates and depth as the subject computes them.
    pub(super) u: Vec<f32>,
    pub(super) v: Vec<f32>,
    pub(super) z: Vec<f32>,
    /// Whether it is truly lit.
    pub(super) lit: Vec<bool>,
    /// Window depth between it and its first occluder; +∞ where it has none.
    pub(super) gap: Vec<f64>,
    /// Way inside its true shadow, world units.
    pub(super) inside: Vec<f64>,
}

impl Receivers {
    pub(super) fn of(samples: &[Sample]) -> Self {
        fn list<T: Send>(samples: &[Sample], of: impl Fn(&Sample) -> T + Sync + Send) -> Vec<T> {
            samples.par_iter().map(of).collect()
        }
        Self {
            u: list(samples, |s| s.coord[0]),
            v: list(samples, |s| s.coord[1]),
            z: list(samples, |s| s.coord[2]),
            lit: list(samples, |s| s.lit),
            gap: list(samples, |s| s.gap),
            inside: list(samples, |s| s.inside),
        }
    }

    pub(super) fn len(&self) -> usize {
        self.z.len()
    }

    /// Map coordinates and depth of a receiver.
    #[inline]
    pub(super) fn coord(&self, i: usize) -> [f32; 3] {
        [self.u[i], self.v[i], self.z[i]]
    }
}
