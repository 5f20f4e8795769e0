//! The tables of a tuned scene: what each setting leaves wrong, and one bias in every unit.

use crate::analysis::measurement::share;
use crate::analysis::sweep::tally::{Kind, Tally};
use crate::engines::{Engine, Place, Setting};
use crate::report::{Cell, Table};
use crate::shadow::bias::Strategy;

fn shares(tally: &Tally, populations: [u64; 2]) -> Vec<Cell> {
    let of = |kind: Kind| {
        let population = populations[usize::from(!kind.is_shadow())];
        Cell::share(share(tally.of(kind).unsigned_abs(), population))
    };
    Kind::ALL.iter().map(|&kind| of(kind)).collect()
}

/// What is wrong with each setting.
pub(super) fn artifacts(rows: &[(String, Tally)], populations: [u64; 2]) -> Table {
    let mut table = Table::new(
        "artifacts",
        "What is wrong with each setting, as shares of the truly lit or shadowed.",
    )
    .column("setting", "", "");
    for kind in Kind::ALL {
        table = table.column(kind.name(), "", "");
    }
    for (name, tally) in rows {
        let mut row = vec![Cell::from(name.as_str())];
        row.extend(shares(tally, populations));
        table.push(row);
    }
    table
}

/// One bias in every unit and engine at the middle receiver, and the parameters that are left out,
/// since they are known to be wrong here, do not convert or their engine does not keep such a value.
pub(super) fn units(
    place: &Place,
    bias: f64,
    setting: &Setting,
    converts: impl Fn(Strategy) -> bool,
) -> (Table, Vec<String>) {
    let mut table = Table::new("units", "The same lift at the middle receiver in other units; a normal offset is worth it there only.")
        .column("unit", "", "")
        .column("value", "", "");
    let world = place.world_from_window(bias);
    let mut push =
        |name: String, value: f64| table.push(vec![Cell::from(name), Cell::number(value)]);
    push("window depth".into(), bias);
    push("world units".into(), world);
    push("texels".into(), world / place.texel_world);
    push("format steps".into(), bias / place.step);
    let mut left_out = Vec::new();
    for &engine in Engine::ALL {
        for knob in engine.knobs() {
            let Some(amount) = place.amount(knob.strategy, bias) else { continue };
            let (name, value) = (format!("{engine} {}", knob.name), knob.value(amount));
            let fits = knob.accepts(value) && converts(knob.strategy);
            if knob.withdrawn(setting).is_none() && fits {
                push(name, value);
            } else {
                left_out.push(name);
            }
        }
    }
    (table, left_out)
}
