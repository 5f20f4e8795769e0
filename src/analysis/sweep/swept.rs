//! What a sweep of one strategy found: counts at each amount, and the amounts where something turns.

use super::tally::Tally;
use crate::scene::{Filter, TexelFormat};
use crate::shadow::bias::Strategy;

/// Counts at one amount.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Point {
    /// The strategy's parameter.
    pub amount: f32,
    /// Wrong verdicts there.
    pub tally: Tally,
    /// Longest way that a peter-panned receiver lies inside its true shadow, towards the light on the
    /// surface, world units: the contact gap to within a pixel.
    pub gap: f64,
}

/// A strategy on one map, format and filter.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Swept {
    /// The strategy.
    pub strategy: Strategy,
    /// Format of a texel.
    pub format: TexelFormat,
    /// Filter of the look-ups.
    pub filter: Filter,
    /// Texels per side.
    pub size: u32,
    /// Counts at the asked amounts.
    pub points: Vec<Point>,
    /// The smallest amount from which acne stays within the limit; `None` where nothing is truly lit,
    /// since then acne is not measured.
    pub acne_free: Option<Point>,
    /// Largest breakpoint of truly lit receivers that see their own surface alone (tap families).
    pub critical: Option<f32>,
    /// The smallest amount that loses a true shadow by itself, whatever the format: peter-panning begins.
    pub detachment: Option<f32>,
    /// Truly lit and truly shadowed receivers.
    pub populations: [u64; 2],
}

impl Swept {
    /// The point that says what is left wrong: where acne ends, or, where nothing is lit and acne is not
    /// measured, the smallest amount that was asked for.
    #[must_use]
    pub fn told(&self) -> Option<&Point> {
        let unlit = (self.populations[0] == 0).then(|| self.points.first()).flatten();
        self.acne_free.as_ref().or(unlit)
    }

    /// The share of a count among the truly lit (0) or the truly shadowed (1); `None` where there are none.
    #[must_use]
    pub fn share(&self, count: i64, side: usize) -> Option<f64> {
        let all = self.populations[side];
        (all > 0).then(|| count as f64 / all as f64)
    }

    /// detachment − the acne-free amount: positive if an amount is free of both.
    #[must_use]
    pub fn headroom(&self) -> Option<f64> {
        let free = self.acne_free?.amount;
        Some(self.detachment.map_or(f64::INFINITY, f64::from) - f64::from(free))
    }

    /// The asked amount with the fewest wrong verdicts; the smallest of equals.
    #[must_use]
    pub fn least(&self) -> Option<&Point> {
        let wrong = |p: &&Point| p.tally.false_shadow() + p.tally.false_light();
        self.points.iter().min_by_key(wrong)
    }
}
