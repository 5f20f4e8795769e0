//! Breakpoints, not re-runs: false shadow and false light at *every* constant bias from one pass.

use super::classify::StoredCaster;
use super::observe::Observation;
use crate::num::ordinal;
use rayon::prelude::*;

/// The breakpoints of all counted receivers, sorted.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Breakpoints of the taps of truly lit receivers.
    lit: Weighted,
    /// Breakpoints of the taps of truly shadowed receivers.
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

/// Breakpoints of one population in the order of its receivers.
#[derive(Default)]
struct Gathered {
    /// Taps of each receiver, as long as all have as many.
    taps: usize,
    breakpoints: Vec<f32>,
    /// Shares of the taps, from where on they differ; else empty.
    shares: Vec<f64>,
    /// The breakpoint of each receiver at which its verdict turns; empty as long as each has one alone.
    ends: Vec<f32>,
}

impl Gathered {
    fn add(&mut self, o: &Observation, end: fn(&[f32]) -> f32) {
        let taps = o.breakpoints.len();
        if taps != 1 || !self.ends.is_empty() {
            self.spell_ends();
            self.ends.push(end(&o.breakpoints));
        }
        let weights = o.taps.weights();
        if weights.is_some() || !self.is_even(taps) {
            self.spell_shares();
            match weights {
                Some(weights) => self.shares.extend(weights),
                None => self.shares.extend(std::iter::repeat_n(1.0 / taps as f64, taps)),
            }
        }
        self.taps = taps;
        self.breakpoints.extend_from_slice(&o.breakpoints);
    }

    /// Whether receivers with so many taps of one weight leave all shares the same.
    fn is_even(&self, taps: usize) -> bool {
        self.shares.is_empty() && (self.breakpoints.is_empty() || self.taps == taps)
    }

    /// The turns of receivers with one breakpoint each are these.
    fn spell_ends(&mut self) {
        if self.ends.is_empty() {
            self.ends.clone_from(&self.breakpoints);
        }
    }

    /// The shares of taps that were the same so far.
    fn spell_shares(&mut self) {
        self.shares.resize(self.breakpoints.len(), 1.0 / self.taps.max(1) as f64);
    }

    fn join(&mut self, other: &mut Self) {
        if other.breakpoints.is_empty() {
            return;
        }
        if !(self.ends.is_empty() && other.ends.is_empty()) {
            self.spell_ends();
            other.spell_ends();
        }
        if !(other.shares.is_empty() && self.is_even(other.taps)) {
            self.spell_shares();
            other.spell_shares();
        }
        self.taps = other.taps;
        self.shares.extend(&other.shares);
        self.breakpoints.extend(&other.breakpoints);
        self.ends.extend(&other.ends);
    }
}

/// The breakpoints of truly lit and of truly shadowed receivers.
fn gathered(observations: &[Observation]) -> [Gathered; 2] {
    let chunk = |observations: &[Observation]| {
        let mut found: [Gathered; 2] = Default::default();
        for o in observations {
            match o.truly_lit() {
                Some(true) => found[0].add(o, largest),
                Some(false) => found[1].add(o, smallest),
                None => {}
            }
        }
        found
    };
    let mut chunks: Vec<[Gathered; 2]> = observations.par_chunks(1 << 14).map(chunk).collect();
    let mut all: [Gathered; 2] = Default::default();
    for chunk in &mut chunks {
        all.iter_mut().zip(chunk).for_each(|(all, found)| all.join(found));
    }
    all
}

impl Weighted {
    fn new(all: Gathered) -> Self {
        if all.shares.is_empty() {
            let share = 1.0 / all.taps.max(1) as f64;
            return Self { breakpoints: sorted(all.breakpoints), reached: Vec::new(), share };
        }
        let mut pairs: Vec<(f32, f64)> = all.breakpoints.into_iter().zip(all.shares).collect();
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
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
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

    /// Takes a receiver into account.
    pub(super) fn add(&mut self, o: &Observation) {
        let found = match (o.truly_lit(), o.caster) {
            (Some(true), _) if o.own_surface => {
                Self { critical: Some(largest(&o.breakpoints)), detachment: None }
            }
            (Some(false), StoredCaster::Occluder) => {
                Self { critical: None, detachment: Some(smallest(&o.breakpoints)) }
            }
            _ => return,
        };
        *self = self.joined(found);
    }

    /// The errors of both populations together.
    pub(super) fn joined(self, other: Self) -> Self {
        let pick = |a: Option<f32>, b: Option<f32>, of: fn(f32, f32) -> f32| match (a, b) {
            (Some(a), Some(b)) => Some(of(a, b)),
            _ => a.or(b),
        };
        Self {
            critical: pick(self.critical, other.critical, f32::max),
            detachment: pick(self.detachment, other.detachment, f32::min),
        }
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
        let population = |mut all: Gathered| {
            let ends = std::mem::take(&mut all.ends);
            let all = Weighted::new(all);
            let ends = if ends.is_empty() { all.breakpoints.clone() } else { sorted(ends) };
            (all, ends)
        };
        let [lit, shadowed] = gathered(observations);
        let ((lit, lit_last), (shadowed, shadowed_first)) =
            rayon::join(|| population(lit), || population(shadowed));
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

fn sorted(mut list: Vec<f32>) -> Vec<f32> {
    list.par_sort_unstable_by_key(|&b| ordinal(b));
    list
}
