//! The report's tables: advice, certificates, ranges, unusual depths, formats, moments.

use super::{Dossier, Measured, SETTINGS};
use crate::analysis::roundtrip::certificate::Certificate;
use crate::analysis::roundtrip::moments::{MomentStore, moment_precision};
use crate::analysis::roundtrip::verdict::Advice;
use crate::report::{Cell, Colour, Section, Table};

fn max_column(table: Table) -> Table {
    table.column("max error", "window depth", "largest |decoded - z| for z < 1")
}

fn colour(advice: Advice) -> Colour {
    match advice {
        Advice::Use => Colour::Green,
        Advice::Care => Colour::Yellow,
        Advice::Avoid => Colour::Vermilion,
    }
}

/// One sentence per packing.
pub(super) fn advice(measured: &Measured) -> Table {
    let mut table = Table::new("advice-table", "What to do with each packing, and why.")
        .column("packing", "", "name on the command line")
        .column("advice", "", "")
        .column("why", "", "")
        .column("where it is from", "", "");
    for dossier in &measured.dossiers {
        table.push(vec![
            dossier.name.as_str().into(),
            Cell::Class(colour(dossier.advice), dossier.advice.to_string()),
            dossier.sentence.clone().into(),
            dossier.about.clone().into(),
        ]);
    }
    table
}

/// The table on stdout and in `results.csv`.
pub(super) fn summary(measured: &Measured) -> Table {
    let table = Table::new("summary", "Every packing in f32 with a store that rounds.")
        .column("packing", "", "")
        .column("advice", "", "");
    let mut table = max_column(table)
        .column("at depth", "", "")
        .column("bound", "window depth", "proved")
        .column("bits", "", "-log2 of the largest error")
        .column("far reads", "", "decoded value of z = 1")
        .column("exact from", "window depth", "no depth from here to 1 is changed")
        .column("inversions", "", "neighbours in the wrong order")
        .column("max truncated", "window depth", "with a store that truncates")
        .column("bias forced", "window depth", "smallest constant bias without self-shadowing")
        .column("method", "", "");
    for dossier in &measured.dossiers {
        let c = &dossier.certificates[0];
        table.push(vec![
            dossier.name.as_str().into(),
            dossier.advice.name().into(),
            Cell::Number(c.max.error, 4),
            Cell::Number(c.max.at.into(), 6),
            Cell::number(c.bound.as_ref().map(|b| b.value)),
            Cell::Number(c.equivalent_bits, 4),
            Cell::Number(c.at_one, 6),
            Cell::number(c.exact_from.map(f64::from)),
            c.order.map_or(Cell::Missing, |o| Cell::count(o.inversions)),
            Cell::Number(dossier.certificates[1].max.error, 4),
            Cell::Number(c.forced_bias.into(), 4),
            c.method.name().into(),
        ]);
    }
    table
}

/// Every certificate's numbers.
pub(super) fn certificates(measured: &Measured) -> Section {
    let mut section = Section::new(
        "certificates",
        "Certificates",
        "Every packing under every store, sampler and arithmetic; bound beside measured where a \
         bound is proved.",
    );
    let table = Table::new(
        "certificate-table",
        "One row per combination; packings with the same operations share theirs. results.json has \
         every digit.",
    )
    .column("packing", "", "")
    .column("hardware", "", "store, sampler or arithmetic; else rounding, k/255, f32");
    let mut table = max_column(table)
        .column("at depth", "", "")
        .column("bound", "window depth", "proved upper bound of the largest error")
        .column("mean", "window depth", "of decoded - z over uniform depth")
        .column("rms", "window depth", "over uniform depth")
        .column("far reads", "", "decoded value of z = 1")
        .column("inversions", "", "neighbours in the wrong order; none told of a set of stores")
        .column("largest drop", "window depth", "")
        .column("not idempotent", "", "share of looked-at depths that change when repacked")
        .column("not invertible", "", "share of looked-at texels that change when repacked")
        .column("overflow", "", "share of looked-at depths that meet infinity or NaN")
        .column("bias forced", "window depth", "smallest constant bias without self-shadowing")
        .column("floats", "", "answered for")
        .column("evaluated", "", "to do so");
    for dossier in measured.distinct() {
        for (setting, c) in SETTINGS.iter().zip(&dossier.certificates) {
            table.push(certificate_row(setting.name, c));
        }
    }
    section.push(table);
    section.folded()
}

fn share(promise: crate::analysis::roundtrip::Promise) -> Cell {
    let share = promise.broken as f64 / promise.tested.max(1) as f64;
    Cell::Percent(shown(share))
}

/// A number to the six digits that a table needs; `results.json` has them all.
fn shown(x: f64) -> f64 {
    format!("{x:.5e}").parse().unwrap_or(x)
}

fn certificate_row(setting: &str, c: &Certificate) -> Vec<Cell> {
    let shown = |x: f64| Cell::Number(shown(x), 4);
    vec![
        c.name.as_str().into(),
        setting.into(),
        Cell::Number(c.max.error, 5),
        Cell::Number(c.max.at.into(), 9),
        c.bound.as_ref().map_or(Cell::Missing, |b| shown(b.value)),
        shown(c.mean),
        shown(c.rms),
        Cell::Number(c.at_one, 9),
        c.order.map_or(Cell::Missing, |o| Cell::count(o.inversions)),
        c.order.map_or(Cell::Missing, |o| shown(o.largest_drop.error)),
        share(c.idempotent),
        share(c.invertible),
        share(c.sound),
        shown(c.forced_bias.into()),
        Cell::count(c.answered),
        Cell::count(c.evaluated),
    ]
}

/// Error by depth range, and what unusual depths give.
pub(super) fn details(measured: &Measured) -> Section {
    let mut section = Section::new(
        "details",
        "By depth range, and unusual depths",
        "f32, a store that rounds. A packing may look fine in a scene whose depths lie near 1.",
    );
    let dossiers: Vec<&Dossier> = measured.distinct().collect();
    section.push(ranges(&dossiers));
    section.push(specials(&dossiers));
    section.folded()
}

fn ranges(dossiers: &[&Dossier]) -> Table {
    let mut table =
        Table::new("ranges", "Largest error in each range of depth.").column("packing", "", "");
    let heading = |c: &Certificate| -> Vec<String> {
        c.ranges.iter().map(|r| range_name(r.from, r.to)).collect()
    };
    for name in dossiers.first().map(|d| heading(&d.certificates[0])).unwrap_or_default() {
        table = table.column(&name, "", "");
    }
    for dossier in dossiers {
        let errors =
            dossier.certificates[0].ranges.iter().map(|r| Cell::Number(shown(r.max.error), 3));
        table.push(std::iter::once(dossier.name.as_str().into()).chain(errors).collect());
    }
    table
}

fn range_name(from: f64, to: f64) -> String {
    let text = |x: f64| match x {
        x if x == 1.0 / 65_536.0 => "2^-16".to_string(),
        x if x == 1.0 / 256.0 => "2^-8".to_string(),
        x => crate::report::number::significant(x, 3),
    };
    if from == to { "1".to_string() } else { format!("{}–{}", text(from), text(to)) }
}

fn specials(dossiers: &[&Dossier]) -> Table {
    let mut table =
        Table::new("unusual", "What unusual depths decode to.").column("packing", "", "");
    let names = dossiers.first().map(|d| &d.certificates[0].specials);
    for special in names.into_iter().flatten() {
        table = table.column(special.depth, "", "");
    }
    for dossier in dossiers {
        let decoded = dossier.certificates[0].specials.iter().map(|s| s.decoded.as_str().into());
        table.push(std::iter::once(dossier.name.as_str().into()).chain(decoded).collect());
    }
    table
}

/// Depth formats by break points.
pub(super) fn formats(measured: &Measured) -> Section {
    let mut section = Section::new(
        "formats",
        "Depth formats",
        "Stored to nearest, read back exactly; f32 is the input itself.",
    );
    let table = Table::new("format-table", "Every float of [0, 1] through each format.")
        .column("format", "", "");
    let mut table = max_column(table)
        .column("at depth", "", "")
        .column("bound", "window depth", "proved")
        .column("rms", "window depth", "over uniform depth")
        .column("bits", "", "")
        .column("method", "", "")
        .column("evaluated", "", "");
    for c in &measured.formats {
        table.push(vec![
            c.name.as_str().into(),
            Cell::Number(c.max.error, 5),
            Cell::Number(c.max.at.into(), 9),
            Cell::number(c.bound.as_ref().map(|b| b.value)),
            Cell::Number(c.rms, 4),
            Cell::Number(c.equivalent_bits, 4),
            c.method.name().into(),
            Cell::count(c.evaluated),
        ]);
    }
    section.push(table);
    section
}

/// VSM and EVSM.
pub(super) fn moments() -> Section {
    let mut section = Section::new(
        "moments",
        "Variance and exponential shadow maps, a first look",
        "A flat surface has no variance; what the storage and a 3 × 3 blur leave is false, and the \
         variance floor must cover it.",
    );
    let mut table =
        Table::new("moment-table", "False variance of flat surfaces over 65,536 depths.")
            .column("moments in", "", "")
            .column("variance floor", "depth²", "largest false variance")
            .column("at depth", "", "")
            .column("deviation", "window depth", "its square root")
            .column("EVSM exponent below", "", "so that the second moment stays finite");
    for &store in MomentStore::ALL {
        let precision = moment_precision(store, 65_536);
        table.push(vec![
            store.name().into(),
            Cell::Number(precision.variance_floor, 3),
            Cell::Number(precision.at.into(), 4),
            Cell::Number(precision.deviation, 3),
            Cell::number(precision.exponent_limit),
        ]);
    }
    section.push(table);
    section
}
