//! The report of all stresses: the verdict table, one figure per stress, the numbers as JSON and CSV.

use super::row::AGREEMENT;
use super::{Row, Sampling, Stress, run};
use crate::report::{
    Axis, Block, Cell, Colour, Marker, Plot, Profile, Report, Section, Series, Style, Table,
};
use serde_json::json;
use std::collections::BTreeMap;

/// What a run is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StressOptions {
    /// Quick takes an eighth of the samples.
    pub profile: Profile,
    /// Seed of every random choice.
    pub seed: u64,
}

impl StressOptions {
    /// Samples of a phase.
    #[must_use]
    pub const fn samples(&self) -> u32 {
        match self.profile {
            Profile::Quick => 512,
            Profile::Full => 4096,
        }
    }
}

/// Runs every stress and reports it; `done` is called after each.
#[must_use]
pub fn report(options: &StressOptions, done: impl Fn() + Sync) -> Report {
    let effort = Sampling { samples: options.samples(), seed: options.seed };
    render(options, &run(&effort, done))
}

/// The report of stresses that were run with these options.
#[must_use]
pub fn render(options: &StressOptions, stresses: &[Stress]) -> Report {
    let rows: Vec<&Row> = stresses.iter().flat_map(|s| &s.rows).collect();
    let table = verdicts("verdicts", stresses);
    let mut overview = Section::new("overview", "Verdicts", OVERVIEW);
    overview.push(table.clone());
    let mut sections = vec![overview];
    sections.extend(stresses.iter().map(section));
    let (quick, flag) = (options.profile == Profile::Quick, " --quick");
    Report {
        name: "stress".to_string(),
        title: "Where shadow mapping breaks numerically".to_string(),
        question:
            "From which value of each stress on does a shadow map degrade or break, and is it \
                   where theory says?"
                .to_string(),
        lead: lead(&rows),
        profile: options.profile,
        seed: options.seed,
        parameters: BTreeMap::from([("samples".to_string(), options.samples().to_string())]),
        command: format!("gnomon-stress{}", if quick { flag } else { "" }),
        sections,
        results: results(options, stresses),
        results_csv: Some(table),
        vectors_only: true,
        ..Report::default()
    }
}

const OVERVIEW: &str = "The predicted onset is a formula, evaluated before anything is drawn; the \
measured onset is where the subject's own code first shows the event. A row without an onset holds over \
the whole range.";

const CAPTION: &str = "Points are measured, dashes are theory; vertical lines mark the onsets that theory \
gave beforehand.";

fn lead(rows: &[&Row]) -> Vec<String> {
    let agreeing = rows.iter().filter(|r| r.agrees()).count();
    let never = rows.iter().filter(|r| r.measured.is_none()).count();
    let onsets = rows.iter().map(|r| r.relative_error()).filter(|e| e.is_finite());
    let worst = crate::report::number::percent(onsets.fold(0.0, f64::max), 2);
    let outside: Vec<_> =
        rows.iter().filter(|r| !r.agrees()).map(|r| r.forecast.name.as_str()).collect();
    let mut lead = vec![format!(
        "{agreeing} of {} rows meet their forecast within {:.0} %; the largest difference of an onset \
         is {worst}. {never} rows hold over the whole range of their parameter.",
        rows.len(),
        AGREEMENT * 100.0
    )];
    if !outside.is_empty() {
        lead.push(format!("Outside: {}.", outside.join(", ")));
    }
    lead
}

fn verdicts(id: &str, stresses: &[Stress]) -> Table {
    let mut table = Table::new(id, "Every row: where it breaks, and where theory says it does.")
        .column("row", "", "Name of the row.")
        .column("verdict", "", "Holds, degrades at, breaks at: as measured.")
        .column("parameter", "", "What is driven to its extreme.")
        .column("predicted", "", "Onset by formula, before the run; none where it never happens.")
        .column("measured", "", "Onset on the subject's code; none where it was not seen.")
        .column("difference", "", "|measured − predicted| / predicted.")
        .column(
            "event",
            "",
            "What begins at the onset, or never does; why stands beside the figure.",
        );
    for stress in stresses {
        table.rows.extend(stress.rows.iter().map(|row| cells(stress, row)));
    }
    table
}

fn cells(stress: &Stress, row: &Row) -> Vec<Cell> {
    let to = format!("#{}", stress.id);
    let error = row.relative_error();
    let class = if row.agrees() { Colour::Green } else { Colour::Vermilion };
    vec![
        Cell::Link { text: row.forecast.name.clone(), to },
        Cell::Class(class, row.verdict()),
        stress.parameter.into(),
        Cell::number(row.forecast.onset),
        Cell::number(row.measured),
        if error.is_finite() { Cell::Percent(error) } else { Cell::Missing },
        row.forecast.event.as_str().into(),
    ]
}

fn section(stress: &Stress) -> Section {
    let mut section = Section::new(stress.id, stress.title, stress.lead.as_str());
    // A row of one: figures at half the page's width.
    section.push(Block::Row(vec![Block::Plot(plot(stress))]));
    for row in &stress.rows {
        section.push(format!("{}: {}", row.forecast.name, row.sentence()));
    }
    section
}

/// Error against the parameter: measured points, and the theory of all rows as one dashed series.
fn plot(stress: &Stress) -> Plot {
    let parted =
        |row: &Row| row.forecast.theory.iter().copied().chain([(f64::NAN, f64::NAN)]).collect();
    let theory = Series {
        name: "theory".to_string(),
        style: Style::Theory,
        colour: Colour::Ink,
        points: stress.rows.iter().flat_map(|row| -> Vec<(f64, f64)> { parted(row) }).collect(),
    };
    let points = |(i, row): (usize, &Row)| Series {
        name: row.forecast.name.clone(),
        style: Style::Points,
        colour: Colour::series(i),
        points: row.curve.clone(),
    };
    let measured = stress.rows.iter().enumerate().map(points);
    let marker = |(i, row): (usize, &Row)| {
        let label = "onset by theory".to_string();
        Some(Marker { x: row.forecast.onset?, label, colour: Colour::series(i) })
    };
    // More than three lines would hide what they mark; the table has them all.
    let marked = stress.rows.iter().enumerate().take(if stress.rows.len() > 3 { 0 } else { 3 });
    Plot {
        id: format!("{}-plot", stress.id),
        title: stress.title.to_string(),
        caption: CAPTION.to_string(),
        x: Axis { scale: stress.scale, ..Axis::linear(stress.parameter) },
        y: Axis::log(stress.error),
        series: std::iter::once(theory).chain(measured).collect(),
        markers: marked.filter_map(marker).collect(),
    }
}

/// Seven significant digits: a curve is for the eye, onsets are given in full.
fn column(points: &[(f64, f64)], of: impl Fn(&(f64, f64)) -> f64) -> Vec<f64> {
    let rounded = |x: f64| format!("{x:.6e}").parse().expect("a number as it was written");
    points.iter().map(|p| rounded(of(p))).collect()
}

fn results(options: &StressOptions, stresses: &[Stress]) -> serde_json::Value {
    let row = |row: &Row| {
        let error = row.relative_error();
        json!({
            "row": row.forecast.name,
            "event": row.forecast.event,
            "formula": row.forecast.formula,
            "predicted_onset": row.forecast.onset,
            "measured_onset": row.measured,
            "relative_error": error.is_finite().then_some(error),
            "within_5_percent": row.agrees(),
            "verdict": row.verdict(),
            "note": row.note,
            "curve": {
                "parameter": column(&row.curve, |p| p.0),
                "error": column(&row.curve, |p| p.1),
                "theory": column(&row.forecast.theory, |p| p.1),
            },
        })
    };
    let stress = |s: &Stress| {
        json!({
            "stress": s.id,
            "parameter": s.parameter,
            "error": s.error,
            "rows": s.rows.iter().map(row).collect::<Vec<_>>(),
        })
    };
    json!({
        "schema": "gnomon-stress-1",
        "profile": options.profile.name(),
        "seed": options.seed,
        "samples": options.samples(),
        "stresses": stresses.iter().map(stress).collect::<Vec<_>>(),
    })
}
