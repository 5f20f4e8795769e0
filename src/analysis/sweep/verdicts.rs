//! What a sweep says of each case in one line: who wins, at which amount, and whether a constant works.

use super::results::{own, winner};
use super::tally::Tally;
use super::{CaseSweep, Swept};
use crate::report::number::significant;
use crate::report::{Cell, Table};
use crate::shadow::bias::Strategy;

fn constant<'s>(list: &[&'s Swept]) -> Option<&'s Swept> {
    list.iter().copied().find(|s| s.strategy == Strategy::Constant)
}

/// One row a case.
pub(super) fn table(sweeps: &[CaseSweep]) -> Table {
    let caption = "The winner ends acne and leaves the fewest receivers wrong, either way. Beside it what a constant bias needs, all in window depth.";
    let mut table = Table::new("verdicts", caption)
        .column("case", "", "")
        .column("winner", "", "")
        .column("least amount", "", "smallest amount that ends acne")
        .column("false shadow", "", "share of the truly lit that is wrong there")
        .column("false light", "", "share of the truly shadowed that is wrong there")
        .column("constant needs", "", "smallest constant bias that ends acne")
        .column(
            "detaches at",
            "",
            "smallest constant bias that exceeds a gap: from it on peter-panning by the bias alone",
        )
        .column(
            "headroom",
            "",
            "detachment less need: not positive where no constant is free of both",
        )
        .column("its own bias", "", "")
        .column("which is", "", "its own bias against both thresholds");
    for case in sweeps {
        table.push(row(case));
    }
    table
}

fn row(case: &CaseSweep) -> Vec<Cell> {
    let list = own(case);
    let best = winner(&list);
    let at = best.and_then(|s| s.acne_free);
    let share = |side: usize, of: fn(&Tally) -> i64| {
        best.zip(at).map_or(Cell::Missing, |(s, p)| {
            Cell::Percent(of(&p.tally) as f64 / s.populations[side].max(1) as f64)
        })
    };
    let need = constant(&list).and_then(|s| s.acne_free).map(|p| f64::from(p.amount));
    let detach = constant(&list).and_then(|s| s.detachment).map(f64::from);
    vec![
        Cell::from(case.name.as_str()),
        Cell::from(best.map_or("none", |s| s.strategy.name())),
        Cell::from(best.zip(at).map_or_else(String::new, |(s, p)| {
            format!("{} {}", significant(p.amount.into(), 4), s.strategy.unit())
        })),
        share(0, Tally::false_shadow),
        share(1, Tally::false_light),
        Cell::number(need),
        Cell::number(detach.filter(|b| b.is_finite())),
        Cell::number(need.zip(detach).map(|(n, d)| d - n)),
        Cell::number(f64::from(case.own_bias)),
        Cell::from(judged(case.own_bias.into(), need, detach)),
    ]
}

/// A constant bias against the thresholds.
fn judged(bias: f64, need: Option<f64>, detach: Option<f64>) -> &'static str {
    match (need.map(|n| bias >= n), detach.map(|d| bias >= d)) {
        (Some(true), Some(true)) => "enough, but shadows detach",
        (Some(true), _) => "enough",
        (_, Some(true)) => "too little, and shadows detach",
        (Some(false), _) => "too little",
        (None, _) => "hopeless: no constant ends acne",
    }
}

/// Who wins a case and by how much, in one sentence.
pub(super) fn sentence(case: &CaseSweep, best: &Swept) -> String {
    let list = own(case);
    let amount = best.acne_free.map_or(0.0, |p| f64::from(p.amount));
    let start = format!(
        "{} wins on {} texels of {} with {} {}",
        best.strategy,
        format_args!("{0} x {0}", best.size),
        best.format.name(),
        significant(amount, 4),
        best.strategy.unit()
    );
    let need = constant(&list).and_then(|s| s.acne_free).map(|p| f64::from(p.amount));
    let detach = constant(&list).and_then(|s| s.detachment).map(f64::from);
    match (need, detach) {
        (Some(n), Some(d)) if d > n => format!(
            "{start}; a constant bias works from {} to {}.",
            significant(n, 4),
            significant(d, 4)
        ),
        (Some(n), Some(d)) => format!(
            "{start}; no constant bias is free of both: acne ends at {}, shadows detach from {}.",
            significant(n, 4),
            significant(d, 4)
        ),
        (Some(n), None) => {
            format!("{start}; a constant bias works from {} on.", significant(n, 4))
        }
        (None, _) => format!("{start}; no constant bias ends its acne."),
    }
}
