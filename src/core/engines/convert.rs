//! One bias in every unit: window depth to a strategy's amount at a place, and back.

use crate::shadow::bias::{NormalWeight, Strategy, UNREAL_SLOPE};

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
    /// Depth slope m of the caster's triangle per texel in the device's norm, window depth: what a polygon
    /// offset multiplies by its factor.
    pub caster_slope: f64,
    /// Smallest resolvable difference r of the depth attachment, window depth.
    pub unit: f64,
    /// One step of the format, window depth.
    pub step: f64,
}

impl Place {
    /// World length along the axis of a bias in window depth: b(f − n), or in perspective the exact
    /// kZ²/(1 + kZ) with k = b(f − n)/(nf). Rounded once.
    #[must_use]
    pub fn world_from_window(&self, bias: f64) -> f64 {
        self.lift(bias, 1.0)
    }

    /// The window depth whose [`Self::world_from_window`] is `world`: its inverse, rounded once.
    #[must_use]
    pub fn window_from_world(&self, world: f64) -> f64 {
        self.drop(world, 1.0)
    }

    /// (A, B) of the world length b·A/(1 + b·B) of a bias b.
    fn projection(&self) -> (f64, f64) {
        let range = self.far - self.near;
        self.distance.map_or((range, 0.0), |z| {
            let c = range / (self.near * self.far);
            (c * z * z, c * z)
        })
    }

    /// b·A/(1 + b·B) in multiples of `unit`.
    fn lift(&self, bias: f64, unit: f64) -> f64 {
        let (a, b) = self.projection();
        Double::product(bias, a).over(Double::product(bias, b).plus(Double::ONE).times(unit))
    }

    /// The inverse of [`Self::lift`]: a·unit/(A − a·unit·B).
    fn drop(&self, amount: f64, unit: f64) -> f64 {
        let (a, b) = self.projection();
        let world = Double::product(amount, unit);
        world.over(world.times(-b).plus(Double::product(a, 1.0)))
    }

    /// Amount of a strategy that is worth `bias` window depth on this surface: how far it lifts the
    /// comparison. `None` where the strategy has no such size (layers, planes) or none here (sin 0, less
    /// than the one unit r that comes with a slope).
    #[must_use]
    pub fn amount(&self, strategy: Strategy, bias: f64) -> Option<f64> {
        let amount = match self.lever(strategy)? {
            Lever::Window(scale) => bias / scale,
            Lever::Slope { slope, unit } if bias >= unit => (bias - unit) / slope,
            Lever::Slope { .. } => return None,
            Lever::World(scale) => self.lift(bias, scale),
        };
        amount.is_finite().then_some(amount)
    }

    /// The window depth that an amount ≥ 0 is worth; the inverse of [`Self::amount`]: each is rounded once,
    /// so that going to and fro stays within 2 ulp where the bias is worth at most a third of the distance.
    /// `None` also where it would be more than the whole window depth.
    #[must_use]
    pub fn window(&self, strategy: Strategy, amount: f64) -> Option<f64> {
        let bias = match self.lever(strategy)? {
            Lever::Window(scale) => amount * scale,
            Lever::Slope { slope, unit } => amount * slope + unit,
            Lever::World(scale) => self.drop(amount, scale),
        };
        (0.0..=1.0).contains(&bias).then_some(bias)
    }

    /// What one unit of a strategy lifts. A normal offset d lifts d/cos θ along the light (it moves
    /// the look-up sideways too), one without its component along the light d·sin θ·tan θ.
    fn lever(&self, strategy: Strategy) -> Option<Lever> {
        let normal = |weight: NormalWeight, unit: f64| {
            Some(Lever::World(weight.at(self.cosine) * unit / self.cosine))
        };
        let sine = f64::sqrt(1.0 - self.cosine * self.cosine);
        let texel = self.texel_world;
        let tangent = (sine / self.cosine).min(1.0);
        let root2 = std::f64::consts::SQRT_2;
        use NormalWeight::{Blender, One, OneMinusCos, Sin};
        match strategy {
            Strategy::Constant => Some(Lever::Window(1.0)),
            Strategy::FormatSteps => Some(Lever::Window(self.step)),
            Strategy::RasterUnits => Some(Lever::Window(self.unit)),
            Strategy::SlopeRaster => {
                Some(Lever::Slope { slope: self.caster_slope, unit: self.unit })
            }
            Strategy::ReceiverSlope => Some(Lever::Window(self.slope)),
            Strategy::RasterPlaycanvas => {
                Some(Lever::Window(10.0 * (self.caster_slope + self.unit)))
            }
            Strategy::World | Strategy::LightOffset | Strategy::Adaptive => Some(Lever::World(1.0)),
            Strategy::Texels | Strategy::CasterLight => Some(Lever::World(texel)),
            Strategy::NormalOffset => normal(One, 1.0),
            Strategy::NormalBevy => normal(One, root2 * texel),
            Strategy::NormalHdrp => normal(One, texel),
            Strategy::NormalFilament => normal(Sin, texel / 2.0),
            Strategy::NormalBlender => normal(Blender, root2 * texel),
            Strategy::NormalGodot => normal(OneMinusCos, texel * sine * sine),
            Strategy::NormalCesium => normal(OneMinusCos, 1.0),
            Strategy::CasterUnity => normal(Sin, texel),
            Strategy::CasterUrp => normal(OneMinusCos, texel),
            Strategy::CasterBabylon => normal(Sin, 1.0),
            Strategy::CasterUnreal => {
                Some(Lever::World(texel / 4.0 * (1.0 + UNREAL_SLOPE * tangent)))
            }
            _ => None,
        }
    }
}

/// What an amount is worth: so much window depth each, so many slopes beside one unit r, or so much world
/// length along the light each.
enum Lever {
    Window(f64),
    Slope { slope: f64, unit: f64 },
    World(f64),
}

/// An unevaluated sum of two f64: every operation errs by at most 2⁻¹⁰⁰ of its result (Dekker 1971).
#[derive(Clone, Copy)]
struct Double(f64, f64);

impl Double {
    const ONE: Self = Self(1.0, 0.0);

    fn product(a: f64, b: f64) -> Self {
        let p = a * b;
        Self(p, a.mul_add(b, -p))
    }

    /// a + b of |a| ≥ |b|.
    fn ordered(a: f64, b: f64) -> Self {
        let sum = a + b;
        Self(sum, b - (sum - a))
    }

    fn plus(self, other: Self) -> Self {
        let sum = self.0 + other.0;
        let shift = sum - self.0;
        let lost = (self.0 - (sum - shift)) + (other.0 - shift);
        Self::ordered(sum, lost + (self.1 + other.1))
    }

    fn times(self, factor: f64) -> Self {
        let p = Self::product(self.0, factor);
        Self::ordered(p.0, self.1.mul_add(factor, p.1))
    }

    /// The quotient, rounded to f64 once.
    fn over(self, other: Self) -> f64 {
        let quotient = self.0 / other.0;
        let rest = self.plus(other.times(-quotient));
        quotient + rest.0 / other.0
    }
}
