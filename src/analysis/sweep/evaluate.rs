//! One strategy along its parameter: exact from breakpoints, or evaluated value by value.

use super::chart::{Attachment, Chart};
use super::swept::{Point, Swept};
use super::tally::{Kind, Tally};
use super::taps::Taps;
use super::values;
use crate::scene::TexelFormat;
use crate::shadow::bias::{Family, Strategy};
use rayon::prelude::*;

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
        Family::Map | Family::Vertex | Family::Receiver | Family::Rule => {
            values::by_values(chart, bases, amounts, limit)
        }
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
    swept.detachment = curve.first(Kind::PETER_PANNING);
    swept.acne_free = curve.quiet_from(limit, Kind::ACNE).map(|amount| Point {
        amount,
        tally: curve.at(&[amount])[0],
        gap: curve.gaps_at(&[amount])[0],
    });
    swept
}
