//! One case on the page: verdict, pictures, trade-off curve, numbers.

use super::{explore, layers, overview, shade};
use crate::analysis::budget::Budget;
use crate::analysis::classify::Artifact;
use crate::analysis::formats;
use crate::analysis::ladder::Rung;
use crate::analysis::measure::Measured;
use crate::analysis::measurement::{Measurement, Wrongs};
use crate::analysis::sweep::Field;
use crate::load::fit::YOURS;
use crate::report::{
    Axis, Block, Cell, Colour, Column, HeatMap, Marker, Plot, Section, Series, Style, Table,
};

/// Formats and the budget are surveyed on every so many pixels in x and y, in every profile: they compare
/// settings with each other, which few receivers show as well as many.
const SURVEY_STEP: u32 = 4;

/// Colour of false shadow and false light in every curve.
const FALSE_SHADOW: Colour = Colour::Vermilion;
const FALSE_LIGHT: Colour = Colour::Blue;

/// The case's section, folded, and its blocks under ids that begin with `id`; `compared` are its
/// variants.
pub(super) fn section(
    id: &str,
    measured: &Measured<'_>,
    compared: &[Measured<'_>],
    step: u32,
) -> Section {
    let m = &measured.measurement;
    let observer = &measured.observer;
    let mut section =
        Section::new(id, format!("{} ({})", m.name, m.document), m.after_first_lines())
            .called(m.name.clone())
            .folded();
    let shaded = shade::shaded(id, observer, &measured.observations, step);
    let exr = layers::layers(id, observer, &measured.observations, step, &shaded.rgb);
    section.push(Block::Row(vec![
        shade::classified(id, observer, &measured.observations, step).into(),
        shaded.into(),
        shade::map(id, observer).into(),
    ]));
    section.push(explore::explorer(id, measured, compared, step));
    section.push(curve(id, measured));
    let field = Field::over(measured.observer.clone(), step.max(SURVEY_STEP));
    section.push(formats_by_bias(id, &m.name, &field));
    if m.lit > 0 {
        section.push(Budget::of(&field).sentence(&m.name));
    }
    section.push(numbers(id, m));
    section.push(causes(id, m));
    section.push(assumptions(m));
    section.push(exr);
    if m.document != YOURS {
        section.push(Block::Code {
            language: "shell".to_string(),
            text: format!(
                "gnomon-report --case {0} --full\ngnomon-report explain --case {0} --pixel X,Y",
                m.name
            ),
        });
    }
    section
}

fn assumptions(m: &Measurement) -> Block {
    let facts = m.facts.iter().map(|f| format!("{} = {} ({})", f.quantity, f.value, f.source));
    let known: Vec<String> = m.assumptions.iter().cloned().chain(facts).collect();
    Block::Text(if known.is_empty() {
        "Nothing is assumed beyond the case's definition.".to_string()
    } else {
        format!("Assumed or known: {}.", known.join("; "))
    })
}

/// Biases of the curve: 0, then 16 a decade from 10⁻⁶ to 1 (multiples of powers of ten, no logarithm
/// of the machine's own).
fn biases() -> Vec<f32> {
    let decade = |e: i32| {
        let power = (0..e.unsigned_abs()).fold(1.0f64, |p, _| p / 10.0);
        (0..16).map(move |i| (power * libm::exp10(f64::from(i) / 16.0)) as f32)
    };
    std::iter::once(0.0).chain((-6..0).flat_map(decade)).chain([1.0]).collect()
}

/// False shadow and false light against every constant bias.
fn curve(id: &str, measured: &Measured<'_>) -> Plot {
    let m = &measured.measurement;
    let [lit, shadowed] = measured.curve.populations().map(|n| n as f64);
    let at = |share: &dyn Fn(f32) -> f64| {
        biases().into_iter().map(|b| (f64::from(b), 100.0 * share(b))).collect::<Vec<_>>()
    };
    let series = |name: &str, colour, points| Series {
        name: name.to_string(),
        style: Style::Line,
        colour,
        points,
    };
    let mark = |x: Option<f32>, label: &str, colour| {
        x.filter(|x| *x > 0.0).map(|x| Marker { x: f64::from(x), label: label.to_string(), colour })
    };
    Plot {
        id: format!("{id}-curve"),
        title: format!("{}: errors at every constant bias", m.name),
        caption: "Exact for every bias: read off the sorted breakpoints of all receivers"
            .to_string(),
        x: Axis::log("constant bias [window depth]"),
        y: Axis { range: Some((0.0, 100.0)), ..Axis::linear("share of receivers [%]") },
        series: [
            series(
                "false shadow (of the lit)",
                FALSE_SHADOW,
                at(&|b| measured.curve.at(b).false_shadow_weight / lit),
            ),
            series(
                "false light (of the shadowed)",
                FALSE_LIGHT,
                at(&|b| measured.curve.at(b).false_light_weight / shadowed),
            ),
        ]
        .into_iter()
        .zip([lit, shadowed])
        .filter_map(|(series, population)| (population > 0.0).then_some(series))
        .collect(),
        markers: [
            mark(Some(m.bias), "document's bias", Colour::Ink),
            mark(m.thresholds.critical, "critical", FALSE_SHADOW),
            mark(m.thresholds.detachment, "detachment", FALSE_LIGHT),
        ]
        .into_iter()
        .flatten()
        .collect(),
    }
}

/// Wrong verdicts under each format at each bias.
fn formats_by_bias(id: &str, name: &str, field: &Field<'_>) -> HeatMap {
    let row = |m: formats::FormatAnswer| {
        (m.name(), overview::columns().into_iter().map(|(i, _)| m.wrong[i]).collect())
    };
    let rows = formats::measure(field).into_iter().map(row).collect();
    let title = format!("{name}: wrong verdicts, format by bias");
    let mut map = overview::heat_map(&format!("{id}-formats"), &title, "format", rows);
    map.caption.push_str(" On every 4th pixel in x and y.");
    map
}

fn numbers(id: &str, m: &Measurement) -> Table {
    let mut rows: Vec<Vec<Cell>> = Vec::new();
    let mut row = |name: &str, value: Cell, unit: &str| {
        rows.push(vec![name.into(), value, unit.into()]);
    };
    let s = &m.samples;
    for (name, n) in [
        ("pixels", s.pixels),
        ("truly lit", m.lit),
        ("truly shadowed", m.shadowed),
        ("ambiguous", s.ambiguous),
        ("facing away", s.facing_away),
        ("outside the cone", s.outside_cone),
        ("outside the map", s.outside_map),
        ("background", s.background),
    ] {
        row(name, Cell::count(n), "receivers");
    }
    let depth = |b: Option<f32>| Cell::number(b.map(f64::from));
    row("document's bias", depth(Some(m.bias)), "window depth");
    row("critical bias", depth(m.thresholds.critical), "window depth");
    row("detachment bias", depth(m.thresholds.detachment), "window depth");
    row("headroom", Cell::number(m.headroom), "window depth");
    row("smallest exact gap", Cell::number(m.exact_gap.map(|g| g.min)), "window depth");
    row("longest falsely lit strip", Cell::number(m.peter_panning.map(|l| l.world)), "world units");
    row("longest falsely lit strip", Cell::number(m.peter_panning.map(|l| l.texels)), "texels");
    row(
        "stripe period without bias",
        Cell::number(m.stripe_period.map(|l| l.world)),
        "world units",
    );
    row("stripe period without bias", Cell::number(m.stripe_period.map(|l| l.texels)), "texels");
    let column = |name: &str| Column { name: name.to_string(), ..Column::default() };
    Table {
        id: format!("{id}-numbers"),
        caption: "Receivers, thresholds and lengths".to_string(),
        columns: vec![column("quantity"), column("value"), column("unit")],
        rows,
    }
}

/// Wrong verdicts by cause and artifact.
fn causes(id: &str, m: &Measurement) -> Table {
    let column = |name: &str, help: &str| Column {
        name: name.to_string(),
        help: help.to_string(),
        ..Column::default()
    };
    let rows = |kind: &str, w: &Wrongs| {
        let mut cells: Vec<Cell> =
            vec![kind.into(), Cell::count(w.count), Cell::share(w.rate), Cell::Number(w.weight, 4)];
        cells.extend(Rung::ALL.iter().map(|r| Cell::count(w.by_cause[r])));
        cells.extend(Artifact::ALL.iter().map(|a| Cell::count(w.by_artifact[a])));
        cells
    };
    let mut columns = vec![
        column("verdict", ""),
        column("receivers", "receivers with a wrong verdict"),
        column("rate", "of the truly lit, or of the truly shadowed"),
        column("weight", "sum of |visibility - truth|"),
    ];
    columns.extend(Rung::ALL.iter().map(|r| column(&format!("by {r}"), &r.about())));
    columns.extend(Artifact::ALL.iter().map(|a| column(&a.name().replace('-', " "), &a.about())));
    Table {
        id: format!("{id}-causes"),
        caption:
            "Wrong verdicts by cause (first rung from which they stay wrong) and by artifact; \
                  each group adds up to the receivers"
                .to_string(),
        columns,
        rows: vec![rows("false shadow", &m.false_shadow), rows("false light", &m.false_light)],
    }
}
