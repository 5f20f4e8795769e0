//! One strategy along its parameter: exact from breakpoints, or evaluated value by value.

use super::chart::{Attachment, Chart};
use super::tally::{Kind, Tally};
use super::taps::Taps;
use super::values;
use crate::scene::{Filter, TexelFormat};
use crate::shadow::bias::{Family, Strategy};
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
    /// The smallest amount from which acne stays within the limit; `None` where nothing is truly lit,
    /// since then acne is not measured.
    pub acne_free: Option<Point>,
    /// Largest breakpoint of truly lit receivers that see their own surface alone (tap families).
    pub critical: Option<f32>,
    /// The smallest amount that loses a true shadow by itself, whatever the format: peter-panning begins.
    pub detachment: Option<f32>,
    /// Truly lit and truly shadowed receivers.
    pub populations: [u64; 2],
}

impl Swept {
    /// The point that says what is left wrong: where acne ends, or, where nothing is lit and acne is not
    /// measured, the smallest amount that was asked for.
    #[must_use]
    pub fn told(&self) -> Option<&Point> {
        let unlit = (self.populations[0] == 0).then(|| self.points.first()).flatten();
        self.acne_free.as_ref().or(unlit)
    }

    /// The share of a count among the truly lit (0) or the truly shadowed (1); `None` where there are none.
    #[must_use]
    pub fn share(&self, count: i64, side: usize) -> Option<f64> {
        let all = self.populations[side];
        (all > 0).then(|| count as f64 / all as f64)
    }

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
///
/// # Panics
/// Never: one format gives one sweep.
#[must_use]
pub fn sweep(
    chart: &Chart<'_, '_>,
    format: TexelFormat,
    strategy: Strategy,
    question: &Question<'_>,
) -> Swept {
    sweep_formats(chart, &[format], strategy, question).pop().expect("one format gives one sweep")
}

/// Sweeps a strategy on a chart in several of its formats, in no order; they share what they can.
#[must_use]
pub fn sweep_formats(
    chart: &Chart<'_, '_>,
    formats: &[TexelFormat],
    strategy: Strategy,
    question: &Question<'_>,
) -> Vec<Swept> {
    let populations = chart.field.populations;
    let (amounts, limit) = (question.amounts, (question.max_acne * populations[0] as f64) as i64);
    let base = |&format: &TexelFormat| Swept {
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
    let bases: Vec<Swept> = formats.iter().map(base).collect();
    let mut swept: Vec<Swept> = match strategy.family() {
        Family::Tap => {
            bases.into_par_iter().map(|s| by_breakpoints(chart, s, amounts, limit)).collect()
        }
        Family::Map | Family::Vertex if chart.attachment == Attachment::Depth => {
            let one = |s: Swept| values::by_values(chart, vec![s], amounts, limit);
            bases.into_par_iter().flat_map(one).collect()
        }
        _ => values::by_values(chart, bases, amounts, limit),
    };
    if populations[0] == 0 {
        swept.iter_mut().for_each(|s| s.acne_free = None);
    }
    swept
}

fn by_breakpoints(chart: &Chart<'_, '_>, mut swept: Swept, amounts: &[f32], limit: i64) -> Swept {
    let taps = Taps::on(chart, swept.format, swept.strategy);
    let curve = taps.curve_on(chart, swept.format, swept.strategy);
    let point = |((&amount, tally), gap): ((&f32, Tally), f64)| Point { amount, tally, gap };
    let tallies = amounts.iter().zip(curve.at(amounts));
    swept.points = tallies.zip(curve.gaps_at(amounts)).map(point).collect();
    swept.critical = curve.critical;
    swept.detachment = curve.first(Kind::PeterPanning);
    swept.acne_free = curve.quiet_from(limit, Kind::Acne).map(|amount| Point {
        amount,
        tally: curve.at(&[amount])[0],
        gap: curve.gaps_at(&[amount])[0],
    });
    swept
}
