//! Biases of the taps: of every receiver at any amount of a strategy, and the curves along it.

use super::chart::Chart;
use super::curve::SweptCurve;
use super::looks::{self, Looks};
use crate::scene::{CompareRule, TexelFormat};
use crate::shadow::bias::{Strategy, Weights};
use crate::shadow::margins::biased;

/// Tap biases of every receiver at any amount of a strategy: min(amount · weight, bound).
#[derive(Debug)]
pub struct Taps {
    weight: Weight,
    /// Where receivers choose among several maps and weights differ: of each map, of each receiver.
    maps: Vec<Vec<f32>>,
    bound: f32,
}

/// Window depth per unit of the amount.
#[derive(Debug)]
enum Weight {
    /// One weight for all receivers.
    Common(f32),
    /// A weight for each receiver.
    Own(Vec<f32>),
}

impl Taps {
    /// The taps of a strategy with one tap-side parameter, in a format of a chart.
    #[must_use]
    pub fn on(chart: &Chart<'_, '_>, format: TexelFormat, strategy: Strategy) -> Self {
        let (weight, bound) = Weights::default().of(strategy);
        if strategy.with(1.0).common_bias().is_some() {
            return Self { weight: Weight::Common(weight), maps: Vec::new(), bound };
        }
        let all = || 0..chart.field.samples.len();
        let own = all().map(|i| chart.weights(format, i).of(strategy).0).collect();
        let maps = if chart.field.chooses() { chart.layout.rects().len() } else { 0 };
        let of_map = |map: usize| {
            all().map(|i| chart.weights_in(format, i, map).of(strategy).0).collect::<Vec<f32>>()
        };
        Self { weight: Weight::Own(own), maps: (0..maps).map(of_map).collect(), bound }
    }

    /// Window depth per unit of the amount at receiver i.
    #[inline]
    pub(super) fn weight(&self, i: usize) -> f32 {
        match &self.weight {
            Weight::Common(weight) => *weight,
            Weight::Own(weights) => weights[i],
        }
    }

    /// No bias is larger.
    pub(super) const fn bound(&self) -> f32 {
        self.bound
    }

    /// The literal f32 bias of receiver i at an amount.
    #[must_use]
    pub fn bias(&self, i: usize, amount: f32) -> f32 {
        biased(amount, self.weight(i), self.bound)
    }

    /// This bias in one of several maps.
    #[must_use]
    pub fn bias_in(&self, i: usize, map: usize, amount: f32) -> f32 {
        let weight = self.maps.get(map).map_or_else(|| self.weight(i), |weights| weights[i]);
        biased(amount, weight, self.bound)
    }

    /// Bias per amount, roughly.
    pub(super) fn scale(&self, i: usize) -> f32 {
        let weight = self.weight(i);
        if weight > 0.0 { weight } else { 1.0 }
    }

    /// The exact curve of the comparisons of all receivers, one after the other: the arbiter of
    /// [`Self::curve_on`].
    #[must_use]
    pub fn curve(&self, looks: &[Looks], rule: CompareRule) -> SweptCurve {
        let bias = |i: usize, map: usize, a: f32| self.bias_in(i, map, a);
        looks::curve(looks.iter().enumerate(), rule, bias, |i| self.scale(i))
    }

    /// The exact curve of the strategy on its chart.
    #[must_use]
    pub fn curve_on(
        &self,
        chart: &Chart<'_, '_>,
        format: TexelFormat,
        strategy: Strategy,
    ) -> SweptCurve {
        if chart.field.skips() && !chart.field.chooses() {
            return chart.curve(format, strategy, self);
        }
        let looks = chart.looks(format, &strategy.with(0.0));
        self.curve(&looks, chart.field.case().lookup.compare)
    }
}
