//! Breakpoints, not re-runs: false shadow and false light at *every* constant bias from one pass.

use super::classify::StoredCaster;
use super::observe::Observation;
use crate::num::ordinal;

/// The breakpoints of all counted receivers, sorted.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Of each tap of truly lit receivers.
    lit: Vec<f32>,
    /// Of each tap of truly shadowed receivers.
    shadowed: Vec<f32>,
    /// The largest of each truly lit receiver: from it on the receiver is fully lit.
    lit_last: Vec<f32>,
    /// The smallest of each truly shadowed receiver: from it on the receiver is partly lit.
    shadowed_first: Vec<f32>,
    taps: usize,
}

/// Errors at one bias.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Errors {
    /// Truly lit receivers with visibility below 1.
    pub false_shadow: u64,
    /// Truly shadowed receivers with visibility above 0.
    pub false_light: u64,
    /// Σ(1 − v) over truly lit receivers.
    pub false_shadow_weight: f64,
    /// Σ v over truly shadowed receivers.
    pub false_light_weight: f64,
}

/// The three biases that say whether a constant bias can work.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Thresholds {
    /// Largest breakpoint of truly lit receivers whose texels hold their own surface.
    pub critical: Option<f32>,
    /// Smallest breakpoint of truly shadowed receivers whose texels hold a true occluder.
    pub detachment: Option<f32>,
}

impl Thresholds {
    /// detachment − critical: positive if some constant bias is free of artifacts.
    #[must_use]
    pub fn headroom(&self) -> Option<f64> {
        Some(f64::from(self.detachment?) - f64::from(self.critical?))
    }

    /// Reads them off the observations.
    #[must_use]
    pub fn of(observations: &[Observation]) -> Self {
        let mut thresholds = Self { critical: None, detachment: None };
        for o in observations {
            match (o.truly_lit(), o.caster) {
                (Some(true), _) if o.own_surface => {
                    let last = largest(&o.breakpoints);
                    thresholds.critical = Some(thresholds.critical.map_or(last, |b| b.max(last)));
                }
                (Some(false), StoredCaster::Occluder) => {
                    let first = smallest(&o.breakpoints);
                    thresholds.detachment =
                        Some(thresholds.detachment.map_or(first, |b| b.min(first)));
                }
                _ => {}
            }
        }
        thresholds
    }
}

fn largest(breakpoints: &[f32]) -> f32 {
    breakpoints.iter().copied().fold(f32::NEG_INFINITY, f32::max)
}

fn smallest(breakpoints: &[f32]) -> f32 {
    breakpoints.iter().copied().fold(f32::INFINITY, f32::min)
}

impl Curve {
    /// Sorts the breakpoints of all counted receivers.
    #[must_use]
    pub fn new(observations: &[Observation]) -> Self {
        let of = |lit: bool| observations.iter().filter(move |o| o.truly_lit() == Some(lit));
        let all = |lit: bool| sorted(of(lit).flat_map(|o| o.breakpoints.iter().copied()));
        Self {
            lit: all(true),
            shadowed: all(false),
            lit_last: sorted(of(true).map(|o| largest(&o.breakpoints))),
            shadowed_first: sorted(of(false).map(|o| smallest(&o.breakpoints))),
            taps: observations.first().map_or(1, |o| o.breakpoints.len()),
        }
    }

    /// Truly lit and truly shadowed receivers.
    #[must_use]
    pub fn populations(&self) -> [u64; 2] {
        [self.lit_last.len() as u64, self.shadowed_first.len() as u64]
    }

    /// The errors at `bias`, equal to evaluating the literal f32 rule for every receiver there.
    #[must_use]
    pub fn at(&self, bias: f32) -> Errors {
        let reached = |list: &[f32]| list.partition_point(|&b| b <= bias);
        let share = 1.0 / self.taps as f64;
        Errors {
            false_shadow: (self.lit_last.len() - reached(&self.lit_last)) as u64,
            false_light: reached(&self.shadowed_first) as u64,
            false_shadow_weight: (self.lit.len() - reached(&self.lit)) as f64 * share,
            false_light_weight: reached(&self.shadowed) as f64 * share,
        }
    }
}

fn sorted(values: impl Iterator<Item = f32>) -> Vec<f32> {
    let mut list: Vec<f32> = values.collect();
    list.sort_unstable_by_key(|&b| ordinal(b));
    list
}
