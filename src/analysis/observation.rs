//! What is known about one receiver: standing, truth, look-up, rungs and outcome.

use super::classify::{Outcome, StoredCaster};
use super::ladder::{Rung, WrongRungs};
use crate::light::Lookup;
use crate::shadow::{Few, Taps};
use crate::truth::{Answer, Receiver, Truth};
use glam::DVec3;

crate::catalogue! {
    /// Whether a receiver counts in the rates, and if not, why.
    pub enum Standing {
        /// The receiver counts.
        Counted = "counted",
        /// The truth cannot be decided in f64.
        Ambiguous = "ambiguous",
        /// The surface faces away from the light.
        FacingAway = "facing-away",
        /// Outside the spot's cone.
        OutsideCone = "outside-cone",
        /// Outside the map's volume.
        OutsideMap = "outside-map",
        /// No shadow falls on its surface.
        ReceivesNone = "receives-none",
    }
}

/// Everything known about one receiver.
#[derive(Clone, Debug, PartialEq)]
pub struct Observation {
    /// Pixel of the canvas, from the bottom left.
    pub pixel: [u32; 2],
    /// Where it is, f64.
    pub receiver: Receiver,
    /// Object that it belongs to.
    pub object: u16,
    /// What it looks up: one map, or two that are mixed.
    pub lookups: Few<Lookup>,
    /// The map with the largest share, in which the rungs before *filter* are climbed.
    pub map: usize,
    /// Coordinates and depth in that map as the subject computes them.
    pub coord: [f32; 3],
    /// Exact map coordinates and depth, f64.
    pub exact: DVec3,
    /// Whether it counts.
    pub standing: Standing,
    /// What it truly sees.
    pub answer: Answer,
    /// What the look-up read.
    pub taps: Taps,
    /// Lit taps at the case's bias.
    pub lit_taps: usize,
    /// Their share of the visibility, in [0, 1].
    pub lit_share: f64,
    /// Smallest bias that lights each tap.
    pub breakpoints: Few<f32>,
    /// Stored depth on each rung; +∞ where nothing is in front.
    pub stored: [f64; Rung::ALL.len()],
    /// Whether each rung is wrong.
    pub wrong: WrongRungs,
    /// The verdict's fault, if it counts and is wrong.
    pub outcome: Outcome,
    /// The owner of the surface that the deciding texel holds.
    pub caster: StoredCaster,
    /// The texel that decided.
    pub texel: u32,
    /// Whether every texel read holds the receiver's own or an adjacent surface.
    pub own_surface: bool,
}

impl Observation {
    /// Whether the truth is *lit*; `None` where it does not count.
    #[must_use]
    pub fn truly_lit(&self) -> Option<bool> {
        (self.standing == Standing::Counted).then_some(self.answer.truth == Truth::Lit)
    }

    /// Fractional visibility in [0, 1].
    #[must_use]
    pub const fn visibility(&self) -> f64 {
        self.lit_share
    }
}
