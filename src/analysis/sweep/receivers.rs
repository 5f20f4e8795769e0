//! What is known of the receivers of a case: of each all, and what every verdict asks in lists side by
//! side, 29 bytes a receiver.

use crate::light::Lookup;
use crate::shadow::Few;
use crate::truth::{Answer, Receiver};
use glam::{DVec2, DVec3};
use rayon::prelude::*;

/// One counted receiver.
#[derive(Clone, Debug)]
pub struct Sample {
    /// Pixel of the canvas, from the bottom left.
    pub pixel: [u32; 2],
    /// Where it is.
    pub receiver: Receiver,
    /// Coordinates and compared depth in each map as the subject computes them.
    pub coords: Few<[f32; 3]>,
    /// What it looks up: one map, or two that are mixed.
    pub lookups: Few<Lookup>,
    /// The map that it looks up, or of two that are mixed the one with the larger share.
    pub map: usize,
    /// Its coordinates there.
    pub coord: [f32; 3],
    /// Exact map coordinates and depth, f64.
    pub exact: DVec3,
    /// What it truly sees.
    pub answer: Answer,
    /// Whether it is truly lit.
    pub lit: bool,
    /// Window depth between it and its first occluder; +∞ where it has none.
    pub gap: f64,
    /// Way on the surface towards the light until the true shadow ends, world units; 0 for the lit.
    pub inside: f64,
    /// Unit normal on the side that is seen.
    pub normal: DVec3,
    /// Window depth of its plane per unit of u and v.
    pub gradient: DVec2,
}

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
