//! Breakpoints, not re-runs: false shadow and false light at *every* constant bias from one pass.

use super::classify::StoredCaster;
use super::observe::Observation;
use crate::num::ordinal;
use rayon::prelude::*;

/// The breakpoints of all counted receivers, sorted.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Of each tap of truly lit receivers.
    lit: Weighted,
    /// Of each tap of truly shadowed receivers.
    shadowed: Weighted,
    /// The largest of each truly lit receiver: from it on the receiver is fully lit.
    lit_last: Vec<f32>,
    /// The smallest of each truly shadowed receiver: from it on the receiver is partly lit.
    shadowed_first: Vec<f32>,
}

/// Sorted breakpoints of taps with their shares of a receiver's visibility.
#[derive(Clone, Debug, PartialEq)]
struct Weighted {
    breakpoints: Vec<f32>,
    /// Sum of the shares up to each breakpoint where shares differ.
    reached: Vec<f64>,
    /// The share of each where they do not.
    share: f64,
}

impl Weighted {
    fn new<'o>(observations: impl Iterator<Item = &'o Observation> + Clone) -> Self {
        let breakpoints = observations.clone().flat_map(|o| o.breakpoints.iter().copied());
        let taps = observations.clone().next().map_or(1, |o| o.breakpoints.len());
        if observations.clone().all(|o| o.taps.weights().is_none()) {
            let share = 1.0 / taps as f64;
            return Self { breakpoints: sorted(breakpoints), reached: Vec::new(), share };
        }
        let share = |o: &'o Observation, i: usize| o.taps.weights().map_or(1.0, |w| w[i]);
        let of = |o: &'o Observation| {
            (0..o.breakpoints.len()).map(move |i| (o.breakpoints[i], share(o, i)))
        };
        let mut pairs: Vec<(f32, f64)> = observations.flat_map(of).collect();
        pairs.sort_by_key(|&(b, _)| ordinal(b));
        let mut sum = 0.0;
        let reached = pairs.iter().map(|&(_, share)| {
            sum += share;
            sum
        });
        Self {
            reached: reached.collect(),
            breakpoints: pairs.into_iter().map(|(b, _)| b).collect(),
            share: 0.0,
        }
    }

    /// Whether every look-up has one tap, so that its first and last breakpoint are the same.
    fn is_of_single_taps(&self) -> bool {
        self.reached.is_empty() && self.share == 1.0
    }

    /// Sum of the shares of all taps lit at `bias`, and of the others.
    fn at(&self, bias: f32) -> [f64; 2] {
        let n = self.breakpoints.partition_point(|&b| b <= bias);
        let total = self.reached.last().copied();
        match total {
            None => [n as f64 * self.share, (self.breakpoints.len() - n) as f64 * self.share],
            Some(total) => {
                let reached = n.checked_sub(1).map_or(0.0, |last| self.reached[last]);
                [reached, total - reached]
            }
        }
    }
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
        let ends = |lit: bool, end: fn(&[f32]) -> f32, all: &Weighted| match all.is_of_single_taps()
        {
            true => all.breakpoints.clone(),
            false => sorted(of(lit).map(|o| end(&o.breakpoints))),
        };
        let ((lit, lit_last), (shadowed, shadowed_first)) = rayon::join(
            || {
                let lit = Weighted::new(of(true));
                let last = ends(true, largest, &lit);
                (lit, last)
            },
            || {
                let shadowed = Weighted::new(of(false));
                let first = ends(false, smallest, &shadowed);
                (shadowed, first)
            },
        );
        Self { lit, shadowed, lit_last, shadowed_first }
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
        Errors {
            false_shadow: (self.lit_last.len() - reached(&self.lit_last)) as u64,
            false_light: reached(&self.shadowed_first) as u64,
            false_shadow_weight: self.lit.at(bias)[1],
            false_light_weight: self.shadowed.at(bias)[0],
        }
    }
}

fn sorted(values: impl Iterator<Item = f32>) -> Vec<f32> {
    let mut list: Vec<f32> = values.collect();
    list.par_sort_unstable_by_key(|&b| ordinal(b));
    list
}
