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
            return Self { weight: Weight::Common(weight), bound };
        }
        let receivers = chart.site_weights().iter().zip(&chart.field.receivers.z);
        let of = |(weights, &z): (&Weights, &f32)| weights.with_step(format.step(z)).of(strategy).0;
        Self { weight: Weight::Own(receivers.map(of).collect()), bound }
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

    /// Bias per amount, roughly.
    pub(super) fn scale(&self, i: usize) -> f32 {
        let weight = self.weight(i);
        if weight > 0.0 { weight } else { 1.0 }
    }

    /// The exact curve of the comparisons of all receivers, one after the other: the arbiter of
    /// [`Self::curve_on`].
    #[must_use]
    pub fn curve(&self, looks: &[Looks], rule: CompareRule) -> SweptCurve {
        looks::curve(looks.iter().enumerate(), rule, |i, a| self.bias(i, a), |i| self.scale(i))
    }

    /// The exact curve of the strategy on its chart.
    #[must_use]
    pub fn curve_on(
        &self,
        chart: &Chart<'_, '_>,
        format: TexelFormat,
        strategy: Strategy,
    ) -> SweptCurve {
        if chart.field.skips() {
            return chart.curve(format, strategy, self);
        }
        let looks = chart.looks(format, &strategy.with(0.0));
        self.curve(&looks, chart.field.case().lookup.compare)
    }
}
