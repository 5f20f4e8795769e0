//! One strategy along its parameter: exact from breakpoints, or evaluated value by value.

use super::chart::Chart;
use super::looks::{self, Looks};
use super::tally::{Curve, Kind, Tally};
use crate::scene::{CompareRule, Filter, TexelFormat};
use crate::shadow::bias::{Family, Strategy, Weights};
use rayon::prelude::*;

/// Counts at one amount.
#[derive(Clone, Copy, Debug, PartialEq)]
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
    /// The smallest amount from which acne stays within the limit.
    pub acne_free: Option<Point>,
    /// Largest breakpoint of truly lit receivers that see their own surface alone (tap families).
    pub critical: Option<f32>,
    /// The smallest amount that loses a true shadow.
    pub detachment: Option<f32>,
    /// Truly lit and truly shadowed receivers.
    pub populations: [u64; 2],
}

impl Swept {
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

/// What is asked of every strategy.
#[derive(Clone, Debug)]
pub struct Question<'q> {
    /// Amounts, ascending.
    pub amounts: &'q [f32],
    /// As much acne as is allowed, as a share of the truly lit.
    pub max_acne: f64,
}

/// Sweeps a strategy on a chart.
#[must_use]
pub fn sweep(
    chart: &Chart<'_, '_>,
    format: TexelFormat,
    strategy: Strategy,
    question: &Question<'_>,
) -> Swept {
    let populations = chart.field.populations;
    let limit = (question.max_acne * populations[0] as f64) as i64;
    let base = Swept {
        strategy,
        format,
        filter: chart.filter,
        size: chart.size,
        points: Vec::new(),
        acne_free: None,
        critical: None,
        detachment: None,
        populations,
    };
    match strategy.family() {
        Family::Tap => by_breakpoints(chart, base, question.amounts, limit),
        _ => by_values(chart, base, question.amounts, limit),
    }
}

/// Tap biases of every receiver at any amount of a strategy.
#[derive(Debug)]
pub struct Taps<'c> {
    strategy: Strategy,
    weights: &'c [Weights],
}

impl<'c> Taps<'c> {
    /// Of a strategy under given weights.
    #[must_use]
    pub const fn new(strategy: Strategy, weights: &'c [Weights]) -> Self {
        Self { strategy, weights }
    }

    /// The literal f32 bias of receiver i at an amount.
    #[must_use]
    pub fn bias(&self, i: usize, amount: f32) -> f32 {
        self.strategy.with(amount).tap_bias(&self.weights[i])
    }

    /// Bias per amount, roughly.
    fn scale(&self, i: usize) -> f32 {
        const SMALL: f32 = 1.0 / 65_536.0;
        let scale = self.bias(i, SMALL) / SMALL;
        if scale > 0.0 { scale } else { 1.0 }
    }

    /// The exact curve of given comparisons.
    #[must_use]
    pub fn curve(&self, looks: &[Looks], rule: CompareRule) -> Curve {
        looks::curve(looks, rule, |i, a| self.bias(i, a), |i| self.scale(i))
    }
}

fn by_breakpoints(chart: &Chart<'_, '_>, mut swept: Swept, amounts: &[f32], limit: i64) -> Swept {
    let rule = chart.field.case().lookup.compare;
    let looks = chart.looks(swept.format, &swept.strategy.with(0.0), None);
    let weights = chart.weights(swept.format);
    let taps = Taps::new(swept.strategy, &weights);
    let curve = taps.curve(&looks, rule);
    let point = |((&amount, tally), gap): ((&f32, Tally), f64)| Point { amount, tally, gap };
    let tallies = amounts.iter().zip(curve.at(amounts));
    swept.points = tallies.zip(curve.gaps_at(amounts)).map(point).collect();
    swept.critical = curve.critical;
    swept.detachment = curve.first(Kind::PeterPanning);
    swept.acne_free = curve.quiet_from(limit, &[Kind::Acne]).map(|amount| Point {
        amount,
        tally: curve.at(&[amount])[0],
        gap: curve.gaps_at(&[amount])[0],
    });
    swept
}

/// The longest way inside the true shadow of any peter-panned receiver.
fn longest_gap(chart: &Chart<'_, '_>, looks: &[Looks], bias: impl Fn(usize) -> f32) -> f64 {
    let rule = chart.field.case().lookup.compare;
    let panned = |&(i, look): &(usize, &Looks)| {
        !look.lit && look.verdict(rule, bias(i)).0 == Some(Kind::PeterPanning)
    };
    let inside = looks.iter().enumerate().filter(panned);
    inside.map(|(i, _)| chart.field.samples[i].inside).fold(0.0, f64::max)
}

/// Bisections of a threshold between two evaluated amounts: 2⁻¹⁰ of their distance.
const BISECTIONS: u32 = 10;

fn by_values(chart: &Chart<'_, '_>, mut swept: Swept, amounts: &[f32], limit: i64) -> Swept {
    let (strategy, format) = (swept.strategy, swept.format);
    let at = |amount: f32| evaluate(chart, format, strategy, amount);
    swept.points = amounts.par_iter().map(|&a| at(a)).collect();
    let quiet = |p: &Point| p.tally.of(Kind::Acne) <= limit;
    let points = &swept.points;
    let free = points.iter().rposition(|p| !quiet(p)).map_or(0, |i| i + 1);
    let acne_free = (free < points.len()).then(|| match free {
        0 => points[0],
        _ => bisect(points[free - 1].amount, points[free], at, quiet),
    });
    let pans = |p: &Point| p.tally.of(Kind::PeterPanning) > 0;
    let detachment = points.iter().position(pans).map(|i| match i {
        0 => points[0].amount,
        _ => bisect(points[i - 1].amount, points[i], at, pans).amount,
    });
    (swept.acne_free, swept.detachment) = (acne_free, detachment);
    swept
}

/// The smallest amount found between one where `wanted` does not hold and a point where it does.
fn bisect(
    mut without: f32,
    mut with: Point,
    at: impl Fn(f32) -> Point,
    wanted: impl Fn(&Point) -> bool,
) -> Point {
    for _ in 0..BISECTIONS {
        let middle = without + (with.amount - without) * 0.5;
        if middle <= without || middle >= with.amount {
            break;
        }
        let point = at(middle);
        if wanted(&point) { with = point } else { without = middle }
    }
    with
}

/// The literal counts at one amount.
fn evaluate(chart: &Chart<'_, '_>, format: TexelFormat, strategy: Strategy, amount: f32) -> Point {
    let rule = chart.field.case().lookup.compare;
    let recipe = strategy.with(amount);
    let weights = chart.weights(format);
    let looks = chart.looks(format, &recipe, Some(&weights));
    let bias = |i: usize| recipe.tap_bias(&weights[i]);
    Point {
        amount,
        tally: looks::literal(&looks, rule, bias),
        gap: longest_gap(chart, &looks, bias),
    }
}
