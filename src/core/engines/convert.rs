//! One bias in every unit: window depth to a strategy's amount at a place, and back.

use crate::shadow::bias::{Follow, Layers, NormalMove, Recipe, Strategy};

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

    /// What one unit of a strategy lifts, read off its recipe. A normal offset d lifts d/cos θ along the
    /// light (it moves the look-up sideways too), one without its component along the light d·sin θ·tan θ.
    fn lever(&self, strategy: Strategy) -> Option<Lever> {
        let (none, one) = (strategy.at(0.0), strategy.at(1.0));
        let sized = matches!(one.follow, Follow::Receiver | Follow::NearerOfCentre)
            && one.layers == Layers::Nearest
            && one.oriented == 0.0
            && one.rule.is_none();
        if !sized || none == one {
            return None;
        }
        let lifts = self.lifts(&one);
        Some(match (self.offset(&one, &none), self.window_depth(&one)) {
            (Some(slope), _) => {
                Lever::Slope { slope, unit: f64::from(none.polygon.units) * self.unit }
            }
            (None, Some(window)) => Lever::Window(window),
            (None, None) => Lever::World(lifts),
        })
    }

    /// What one unit of a polygon offset adds, window depth. The larger of factor and units is taken out,
    /// so that equal ones round once.
    fn offset(&self, one: &Recipe, none: &Recipe) -> Option<f64> {
        let factor = f64::from(one.polygon.factor);
        let units = f64::from(one.polygon.units) - f64::from(none.polygon.units);
        let larger = factor.max(units);
        let part = |share: f64, of: f64| if share == 0.0 { 0.0 } else { share / larger * of };
        (larger > 0.0).then(|| larger * (part(factor, self.caster_slope) + part(units, self.unit)))
    }

    /// What a bias in window depth, steps or slopes adds.
    fn window_depth(&self, one: &Recipe) -> Option<f64> {
        let terms = [(one.window, 1.0), (one.steps, self.step), (one.slope, self.slope)];
        let term = terms.into_iter().find(|(amount, _)| *amount != 0.0);
        term.map(|(amount, size)| f64::from(amount) * size)
    }

    /// How far a bias in lengths lifts, world units along the light.
    fn lifts(&self, one: &Recipe) -> f64 {
        let sine = f64::sqrt(1.0 - self.cosine * self.cosine);
        let along = |normal: &NormalMove| {
            let unit = normal.amount * if normal.in_texels { self.texel_world } else { 1.0 };
            let unit = if normal.sideways { unit * sine * sine } else { unit };
            normal.weight.at(self.cosine) * unit / self.cosine
        };
        let tangent = (sine / self.cosine).min(1.0);
        let away = (one.caster_light + one.caster_light_texels * self.texel_world)
            * (1.0 + one.caster_light_slope * tangent);
        let tap = f64::from(one.world) + f64::from(one.texels) * self.texel_world;
        along(&one.normal) + along(&one.caster_normal) + one.light + away + tap
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
