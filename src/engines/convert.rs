//! One bias in every unit: window depth to a strategy's amount at a place, and back.

use crate::shadow::bias::{NormalWeight, Strategy};

/// Where a bias is converted: its worth depends on the distance, the slope and the map. f64.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Distance of the near plane.
    pub near: f64,
    /// Distance of the far plane.
    pub far: f64,
    /// Distance along the light's axis; `None` under a directional light.
    pub distance: Option<f64>,
    /// Edge of a texel there, world units.
    pub texel_world: f64,
    /// Cosine of the angle between normal and light, in (0, 1].
    pub cosine: f64,
    /// Largest depth slope of the surface per texel, window depth.
    pub slope: f64,
    /// Smallest resolvable difference r of the format.
    pub unit: f64,
    /// One step of the format, window depth.
    pub step: f64,
}

impl Place {
    /// World length along the axis of a bias in window depth: b(f − n), or in perspective the exact
    /// kZ²/(1 + kZ) with k = b(f − n)/(nf).
    #[must_use]
    pub fn world_from_window(&self, bias: f64) -> f64 {
        self.lift(bias, 1.0)
    }

    /// [`Self::world_from_window`] in multiples of `unit`: everything but the bias is one constant, so
    /// that only three roundings depend on it.
    fn lift(&self, bias: f64, unit: f64) -> f64 {
        let range = self.far - self.near;
        match self.distance {
            None => bias * (range / unit),
            Some(z) => {
                let c = range / (self.near * self.far);
                bias * (c * z * z / unit) / bias.mul_add(c * z, 1.0)
            }
        }
    }

    /// The window depth whose [`Self::world_from_window`] is nearest to `world`: the closed inverse
    /// dW/(Z(Z − dW))·nf/(f − n), then the best of its neighbours, so that going to and fro stays
    /// within 2 ulp up to dW = Z/3 (beyond, ulps of dW are worth ever more of b).
    #[must_use]
    pub fn window_from_world(&self, world: f64) -> f64 {
        let range = self.far - self.near;
        let guess = match self.distance {
            None => world / range,
            Some(z) => world / (z * (z - world)) * (self.near * self.far / range),
        };
        nearest(guess, world, |b| self.world_from_window(b))
    }

    /// Amount of a strategy that is worth `bias` window depth on this surface: how far it lifts the
    /// comparison. `None` where the strategy has no such size (layers, planes) or none here (sin 0).
    #[must_use]
    pub fn amount(&self, strategy: Strategy, bias: f64) -> Option<f64> {
        let amount = match self.lever(strategy)? {
            Lever::Window(scale) => bias / scale,
            Lever::World(scale) => self.lift(bias, scale),
        };
        amount.is_finite().then_some(amount)
    }

    /// The window depth that an amount is worth; the inverse of [`Self::amount`] within 2 ulp.
    #[must_use]
    pub fn window(&self, strategy: Strategy, amount: f64) -> Option<f64> {
        let guess = match self.lever(strategy)? {
            Lever::Window(scale) => amount * scale,
            Lever::World(scale) => self.window_from_world(amount * scale),
        };
        let back = |b: f64| self.amount(strategy, b).unwrap_or(f64::NAN);
        guess.is_finite().then(|| nearest(guess, amount, back))
    }

    /// What one unit of a strategy lifts. A normal offset d lifts d/cos θ along the light (it moves
    /// the look-up sideways too), one without its component along the light d·sin θ·tan θ.
    fn lever(&self, strategy: Strategy) -> Option<Lever> {
        let normal = |weight: NormalWeight, unit: f64| {
            Some(Lever::World(weight.at(self.cosine) * unit / self.cosine))
        };
        let sine = f64::sqrt(1.0 - self.cosine * self.cosine);
        let texel = self.texel_world;
        let root2 = std::f64::consts::SQRT_2;
        use NormalWeight::{Blender, One, OneMinusCos, Sin};
        match strategy {
            Strategy::Constant => Some(Lever::Window(1.0)),
            Strategy::FormatSteps => Some(Lever::Window(self.step)),
            Strategy::RasterUnits => Some(Lever::Window(self.unit)),
            Strategy::SlopeRaster | Strategy::ReceiverSlope => Some(Lever::Window(self.slope)),
            Strategy::RasterPlaycanvas => Some(Lever::Window(10.0 * (self.slope + self.unit))),
            Strategy::World | Strategy::LightOffset | Strategy::Adaptive => Some(Lever::World(1.0)),
            Strategy::Texels | Strategy::CasterLight => Some(Lever::World(texel)),
            Strategy::NormalOffset => normal(One, 1.0),
            Strategy::NormalBevy => normal(One, root2 * texel),
            Strategy::NormalHdrp => normal(One, texel),
            Strategy::NormalFilament => normal(Sin, texel / 2.0),
            Strategy::NormalBlender => normal(Blender, root2 * texel),
            Strategy::NormalGodot => normal(OneMinusCos, texel * sine * sine),
            Strategy::CasterUnity => normal(Sin, texel),
            Strategy::CasterUrp => normal(OneMinusCos, texel),
            Strategy::CasterBabylon => normal(Sin, 1.0),
            _ => None,
        }
    }
}

/// What one unit of an amount is: window depth or world length along the light.
enum Lever {
    Window(f64),
    World(f64),
}

/// Of `guess` and its neighbours within 4 ulp, the one that `forward` brings nearest to `target`; the
/// middle one of equals.
fn nearest(guess: f64, target: f64, forward: impl Fn(f64) -> f64) -> f64 {
    let miss = |x: f64| (forward(x) - target).abs();
    let mut candidates = vec![guess];
    let (mut below, mut above) = (guess, guess);
    for _ in 0..4 {
        (below, above) = (below.next_down(), above.next_up());
        candidates.extend([below, above]);
    }
    let least = candidates.iter().map(|&x| miss(x)).fold(f64::INFINITY, f64::min);
    let mut equal: Vec<f64> = candidates.into_iter().filter(|&x| miss(x) == least).collect();
    equal.sort_by(f64::total_cmp);
    equal.get(equal.len() / 2).copied().unwrap_or(guess)
}
