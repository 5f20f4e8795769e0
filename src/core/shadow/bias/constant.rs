//! Biases added to each comparison: window depth, world units, texels, format steps, slopes.

use super::{Recipe, Site, Strategy};

/// Window depth per unit of each tap-side parameter at one receiver, rounded to f32 once.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Weights {
    /// Per world unit along the light's axis: 1/(f − n), or nf/((f − n)Z²) in perspective (first
    /// order, as Dou et al. write it; the exact form is kZ²/(1 + kZ)).
    pub world: f32,
    /// Per texel edge at the receiver.
    pub texel: f32,
    /// Per step of the format at the receiver's depth.
    pub step: f32,
    /// Per depth slope m of the receiver's plane (window depth per texel, Euclidean).
    pub slope: f32,
}

impl Weights {
    /// Weights at a receiver; `step` is the format's quantum there.
    #[must_use]
    pub fn at(site: &Site, step: f64) -> Self {
        let weights = Self {
            world: finite(site.window_per_world),
            texel: finite(site.window_per_world * site.texel_world),
            step: 0.0,
            slope: finite(super::slope::receiver_slope(site.gradient, site.map_size)),
        };
        weights.with_step(step)
    }

    /// The bias at another quantum of the format.
    #[must_use]
    pub fn with_step(self, step: f64) -> Self {
        Self { step: finite(step), ..self }
    }
}

/// Rounded to f32; the largest of them where it is not finite.
fn finite(x: f64) -> f32 {
    if x.is_finite() { x as f32 } else { f32::MAX }
}

impl Weights {
    /// The weight w and the bound c with which min(a·w, c) is [`Recipe::tap_bias`] of a strategy with
    /// one tap-side parameter a ≥ 0, to the bit; 0 for strategies without one.
    #[must_use]
    pub fn of(&self, strategy: Strategy) -> (f32, f32) {
        let unit = strategy.with(1.0);
        let bound = if unit.slope_clamp > 0.0 { unit.slope_clamp } else { f32::INFINITY };
        let terms = [
            (unit.window, 1.0),
            (unit.world, self.world),
            (unit.texels, self.texel),
            (unit.steps, self.step),
            (unit.slope, self.slope),
        ];
        let weight = terms.iter().find(|(parameter, _)| *parameter != 0.0).map_or(0.0, |t| t.1);
        (weight, if unit.slope != 0.0 { bound } else { f32::INFINITY })
    }
}

impl Recipe {
    /// The bias of every tap of every receiver, where no weight plays a part.
    #[must_use]
    pub fn common_bias(&self) -> Option<f32> {
        let weighed = [self.world, self.texels, self.steps, self.slope];
        (weighed == [0.0; 4] && self.rule.is_none()).then_some(self.window)
    }

    /// The bias of every tap of a receiver: [`Self::tap_bias`] and its rule's, where it has one.
    #[must_use]
    pub fn bias(&self, weights: &Weights, site: impl FnOnce() -> Site) -> f32 {
        let bias = self.tap_bias(weights);
        self.rule.map_or(bias, |rule| bias + rule.bias(&site()))
    }

    /// The bias of every tap of a receiver but for a rule's: window + Σ parameter·weight, each operation
    /// rounded to f32; parameters of 0 add nothing. Monotone in every parameter.
    #[must_use]
    pub fn tap_bias(&self, weights: &Weights) -> f32 {
        let mut bias = self.window;
        let mut add = |parameter: f32, weight: f32| {
            if parameter != 0.0 {
                bias += parameter * weight;
            }
        };
        add(self.world, weights.world);
        add(self.texels, weights.texel);
        add(self.steps, weights.step);
        if self.slope != 0.0 {
            let clamp = if self.slope_clamp > 0.0 { self.slope_clamp } else { f32::INFINITY };
            bias += (self.slope * weights.slope).min(clamp);
        }
        bias
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shadow::bias::Family;

    #[test]
    fn one_product_is_the_bias_of_every_tap_family() {
        let weights = Weights { world: 0.0625, texel: 3.1e-4, step: 1.0 / 65_535.0, slope: 1.7e-3 };
        for &strategy in Strategy::ALL.iter().filter(|s| s.family() == Family::Tap) {
            let (weight, bound) = weights.of(strategy);
            for amount in [0.0f32, 1e-7, 0.003, 0.9, 17.25, 4e6] {
                let literal = strategy.with(amount).tap_bias(&weights);
                assert_eq!((amount * weight).min(bound), literal, "{strategy} at {amount}");
            }
        }
    }
}
