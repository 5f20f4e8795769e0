//! 8, 16, 24 and 32 bits of depth, plain and reversed: what each costs on a case.

use super::measure::unmeasured;
use super::measurement::share;
use super::outside::named;
use super::sweep::chart::{Attachment, Chart};
use super::sweep::curve::SweptCurve;
use super::sweep::pictures::Gallery;
use super::sweep::plots::thinned;
use super::sweep::tally::{Kind, Tally};
use super::sweep::taps::Taps;
use super::sweep::{Field, Range};
use crate::depth::{DepthFormat, Packing};
use crate::report::number::{percent, significant};
use crate::report::slug::slugs;
use crate::report::{
    Axis, Block, Cell, Colour, HeatMap, Marker, Plot, Profile, Report, Scale, Section, Series,
    Style, Table,
};
use crate::scene::{Case, TexelFormat};
use crate::shadow::bias::Strategy;
use rayon::prelude::*;
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// The formats compared: one channel, the book's four, four sound ones, and depth textures.
pub const FORMATS: [TexelFormat; 7] = [
    TexelFormat::Packed(Packing::R8),
    TexelFormat::Packed(Packing::Book),
    TexelFormat::Packed(Packing::Digits32),
    TexelFormat::Depth(DepthFormat::Unorm16),
    TexelFormat::Depth(DepthFormat::Unorm24),
    TexelFormat::Depth(DepthFormat::F16),
    TexelFormat::Depth(DepthFormat::F32),
];

/// Whether reversed depth makes sense: sound formats under a perspective light.
fn reverses(case: &Case, format: TexelFormat) -> bool {
    case.light.only_map().is_some_and(|map| !map.is_orthographic() && !map.clip.reversed)
        && matches!(format, TexelFormat::Depth(_))
}

/// A format on a case.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct FormatAnswer {
    /// The format.
    pub format: TexelFormat,
    /// Whether 1 is near.
    pub reversed: bool,
    /// Smallest constant bias from which no acne is left; `None` where there is none.
    pub critical: Option<f32>,
    /// Share of the truly lit with acne at the case's bias; `None` where there are none.
    pub acne: Option<f64>,
    /// Share of the truly lit that a cleared or broken texel darkens at the case's bias.
    pub faults: Option<f64>,
    /// Share of the truly shadowed that is wrongly lit at the case's bias; `None` where there are none.
    pub false_light: Option<f64>,
    /// Longest contact gap at the critical bias, world units.
    pub gap: Option<f64>,
    /// World length of one step of the format at the middle receiver, if there is one.
    pub quantum_world: Option<f64>,
    /// Share of the truly lit in false shadow at each of [`biases`]; empty where there are none.
    pub curve: Vec<f64>,
    /// Share of all counted receivers with a wrong verdict at each of [`biases`].
    pub wrong: Vec<Option<f64>>,
}

/// The biases of the plots, window depth.
#[must_use]
pub fn biases() -> Vec<f32> {
    let mut list = Range { low: 1e-7, high: 1e-1, log: true, count: 121 }.values();
    list.insert(0, 0.0);
    list
}

impl FormatAnswer {
    /// Its name in tables.
    #[must_use]
    pub fn name(&self) -> String {
        format!("{}{}", self.format.name(), if self.reversed { " reversed" } else { "" })
    }

    fn new(chart: &Chart<'_, '_>, format: TexelFormat, reversed: bool) -> Self {
        let field = chart.field;
        let case = field.case();
        let looks = match reversed {
            true => chart.looks_reversed(format),
            false => chart.looks(format, &Strategy::Constant.with(0.0)),
        };
        let taps = Taps::on(chart, format, Strategy::Constant);
        let curve = taps.curve(&looks, case.lookup.compare);
        let [lit, shadowed] = field.populations;
        let critical = curve.quiet_from(0, Kind::ACNE).filter(|_| lit > 0);
        let own = curve.at(&[case.bias])[0];
        Self {
            format,
            reversed,
            critical,
            acne: share(own.of(Kind::ACNE) as u64, lit),
            faults: share(own.of(Kind::ENCODING_FAULT) as u64, lit),
            false_light: share(own.false_light() as u64, shadowed),
            gap: critical.map(|b| curve.gaps_at(&[b])[0]),
            quantum_world: quantum_world(field, format, reversed),
            curve: shares(&curve, lit),
            wrong: wrong_shares(&curve, field.samples.len()),
        }
    }

    /// One sentence.
    #[must_use]
    pub fn sentence(&self, case: &Case) -> String {
        let name = self.name();
        let Some(step) = self.quantum_world.map(|step| significant(step, 3)) else {
            return format!("{name}: no receiver was measured.");
        };
        let ends = match self.critical {
            None if self.acne.is_none() => "no receiver is truly lit".to_string(),
            None => "no constant bias ends its acne".to_string(),
            Some(b) if b > case.bias => {
                format!(
                    "acne ends at {}, above the document's {}",
                    significant(b.into(), 3),
                    case.bias
                )
            }
            Some(b) => {
                format!(
                    "acne ends at {}, within the document's {}",
                    significant(b.into(), 3),
                    case.bias
                )
            }
        };
        format!(
            "{name}: one step is {step} world units at the middle receiver; {ends}; there {} of the lit have acne and {} of the shadowed are lit.",
            rate(self.acne),
            rate(self.false_light),
        )
    }
}

/// A rate in a sentence.
fn rate(rate: Option<f64>) -> String {
    rate.map_or_else(|| "an unmeasured share".to_string(), |rate| percent(rate, 3))
}

fn shares(curve: &SweptCurve, lit: u64) -> Vec<f64> {
    curve.at(&biases()).iter().filter_map(|t| share(t.false_shadow() as u64, lit)).collect()
}

fn wrong_shares(curve: &SweptCurve, receivers: usize) -> Vec<Option<f64>> {
    let wrong = |t: &Tally| share((t.false_shadow() + t.false_light()) as u64, receivers as u64);
    curve.at(&biases()).iter().map(wrong).collect()
}

/// One step of the format at the middle receiver, world units.
fn quantum_world(field: &Field<'_>, format: TexelFormat, reversed: bool) -> Option<f64> {
    let middle = field.samples.get(field.samples.len() / 2)?;
    let z = field.case().layout().compared(middle.exact.z as f32);
    let step = format.step(if reversed { 1.0 - z } else { z });
    Some(step / field.site(middle, &field.case().layout()).window_per_world)
}

/// All formats of a case at its own map size and filter: those of [`FORMATS`], then the reversed ones.
///
/// ```
/// use gnomon::analysis::formats;
/// use gnomon::analysis::sweep::Field;
/// use gnomon::scene::cases;
///
/// let case = cases::named("upc")?;
/// let answers = formats::measure(&Field::new(&case, 8)); // every eighth pixel, both ways
/// for answer in &answers {
///     println!("{}: {:?} of window depth end acne", answer.name(), answer.critical);
/// }
/// let [r8, float] = [0, 6].map(|i| answers[i].critical.expect("a bias that ends acne"));
/// assert!(r8 > float, "8 bits need more bias");
/// # Ok::<(), gnomon::Error>(())
/// ```
#[must_use]
pub fn measure(field: &Field<'_>) -> Vec<FormatAnswer> {
    let case = field.case();
    let chart = |attachment| {
        let format = *FORMATS.iter().find(|&&f| Attachment::of(f) == attachment)?;
        let filter = format.usable(case.lookup.filter);
        Some(Chart::new(field, case.map.size, filter, attachment))
    };
    let (depth, colour) = (chart(Attachment::Depth), chart(Attachment::Colour));
    let plain = FORMATS.iter().map(|&f| (f, false));
    let reversed = FORMATS.iter().filter(|&&f| reverses(case, f)).map(|&f| (f, true));
    let all: Vec<_> = plain.chain(reversed).collect();
    let one = |&(format, reversed): &(TexelFormat, bool)| {
        let chart = match Attachment::of(format) {
            Attachment::Depth => depth.as_ref(),
            Attachment::Colour => colour.as_ref(),
        };
        Some(FormatAnswer::new(chart?, format, reversed))
    };
    all.par_iter().filter_map(one).collect()
}

fn plot(id: &str, case: &Case, formats: &[FormatAnswer]) -> Plot {
    let xs = biases();
    let line = |(i, m): (usize, &FormatAnswer)| Series {
        name: m.name(),
        style: if m.reversed { Style::Theory } else { Style::Steps },
        colour: Colour::series(FORMATS.iter().position(|&f| f == m.format).unwrap_or(i)),
        points: thinned(xs.iter().zip(&m.curve).map(|(&x, &y)| (f64::from(x), 100.0 * y))),
    };
    Plot {
        id: format!("{id}-formats"),
        title: format!("{}: false shadow under each format", case.name),
        caption: "Where lines coincide the slope of the surface decides and the format does not matter; dashed lines are reversed depth.".into(),
        x: Axis::log("constant bias [window depth]"),
        y: Axis { label: "false shadow [% of the lit]".into(), scale: Scale::SymLog { linear: 0.1 }, ..Axis::default() },
        series: formats.iter().enumerate().map(line).collect(),
        markers: vec![Marker { x: f64::from(case.bias), label: "its own bias".into(), colour: Colour::Ink }],
    }
}

/// The critical bias of every case under every plain format.
fn overview_map(cases: &[Case], criticals: &[Option<f64>]) -> HeatMap {
    HeatMap {
        id: "critical-bias".into(),
        title: "Smallest constant bias that ends acne".into(),
        caption: "Window depth. Empty where no constant bias ends acne; equal along a line where the slope of the surfaces decides and not the format.".into(),
        row_name: "case".into(),
        column_name: "format".into(),
        rows: cases.iter().map(|c| c.name.clone()).collect(),
        columns: FORMATS.iter().map(|f| f.name().to_string()).collect(),
        values: criticals.to_vec(),
        scale: Scale::Log,
        unit: String::new(),
        digits: 2,
    }
}

fn row(case: &Case, m: &FormatAnswer, texel: f64) -> Vec<Cell> {
    vec![
        Cell::from(case.name.as_str()),
        Cell::from(m.name()),
        Cell::number(m.critical.map(f64::from)),
        Cell::share(m.acne),
        Cell::share(m.faults),
        Cell::share(m.false_light),
        Cell::number(m.gap),
        Cell::number(m.gap.map(|g| g / texel)),
        Cell::number(m.quantum_world),
    ]
}

/// The table of every format, without rows.
fn columns() -> Table {
    Table::new("formats", "Each format at the case's own map size and filter.")
        .column("case", "", "")
        .column("format", "", "")
        .column("critical bias", "window depth", "smallest constant bias that ends acne")
        .column("acne", "", "share of the truly lit at the document's bias")
        .column("faults", "", "share of the truly lit that cleared or broken texels darken there")
        .column("false light", "", "share of the truly shadowed at the document's bias")
        .column("contact gap", "world", "longest peter-panned way at the critical bias")
        .column("contact gap", "texels", "the same in texels")
        .column("one step", "world", "of the format at the middle receiver")
}

/// The ids of cases on the page, in their order.
fn ids(cases: &[Case]) -> Vec<String> {
    let own = ["overview", "critical-bias", "numbers", "formats", "main", "about-run"];
    let parts: Vec<_> = FORMATS.iter().map(|format| format.name()).chain(["formats"]).collect();
    slugs(cases.iter().map(|case| case.name.as_str()), &own, &parts)
}

/// The EXR layers of a case under every plain format.
fn layers<'m>(
    field: &'m Field<'_>,
    id: &'m str,
    formats: &'m [FormatAnswer],
    step: u32,
) -> impl Iterator<Item = Block> + 'm {
    formats.iter().filter(|m| !m.reversed).map(move |m| {
        let gallery = Gallery::new(field, m.format, step);
        let id = format!("{id}-{}", m.format.name());
        Block::Exr(gallery.exr(&id, Strategy::Constant, field.case().bias))
    })
}

/// The report over cases; EXR layers of every format where at most two cases are asked for, else of the
/// first case.
#[must_use]
pub fn report(cases: &[Case], profile: Profile, seed: u64, done: impl Fn() + Sync) -> Report {
    let step = if profile == Profile::Quick { 4 } else { 1 };
    let mut table = columns();
    let ids = ids(cases);
    let one = |(i, (case, id)): (usize, (&Case, &String))| {
        let field = Field::new(case, step);
        let formats = measure(&field);
        let mut section = Section::new(id, &case.name, "");
        if i.is_multiple_of(cases.len().div_ceil(6)) {
            section.push(plot(id, case, &formats));
        }
        for m in &formats {
            section.push(m.sentence(case));
        }
        if cases.len() <= 2 || i == 0 {
            layers(&field, id, &formats, step).for_each(|block| section.push(block));
        }
        let middle = field.samples.get(field.samples.len() / 2);
        let texel = middle.map_or(f64::NAN, |s| field.site(s, &case.layout()).texel_world);
        done();
        let none = field.samples.is_empty().then(|| unmeasured(case, step));
        (formats, section.folded(), texel, (none, field.first_lines()))
    };
    let measured: Vec<_> = cases.par_iter().zip(&ids).enumerate().map(one).collect();
    let mut results: Vec<Value> = Vec::new();
    let mut sections = Vec::new();
    let mut alike = 0;
    let mut criticals: Vec<Option<f64>> = Vec::new();
    let (mut first, mut missing): (Vec<String>, Vec<String>) = Default::default();
    for (case, (formats, section, texel, (none, lines))) in cases.iter().zip(measured) {
        let of = |f: TexelFormat| {
            formats.iter().find(|m| m.format == f && !m.reversed).and_then(|m| m.critical)
        };
        let depth = |format| of(TexelFormat::Depth(format));
        criticals.extend(FORMATS.iter().map(|&f| of(f).map(f64::from)));
        let (fine, finest) = (depth(DepthFormat::Unorm16), depth(DepthFormat::F32));
        alike += usize::from(matches!((fine, finest), (Some(a), Some(b)) if a <= 1.1 * b));
        for m in &formats {
            table.push(row(case, m, texel));
            results.push(json!({
                "case": case.name, "format": m.format.name(), "reversed": m.reversed,
                "critical": m.critical, "acne": m.acne, "faults": m.faults, "false_light": m.false_light,
                "contact_gap_world": m.gap, "quantum_world": m.quantum_world,
            }));
        }
        sections.push(section);
        missing.extend(none);
        first.extend(named(cases.len(), &case.name, &lines));
    }
    let mut overview = Section::new(
        "overview",
        "Which bias each format needs",
        "One line a case, at its own map size and filter; its part below has a sentence on every format.",
    );
    overview.push(overview_map(cases, &criticals));
    sections.insert(0, overview);
    let mut all = Section::new("numbers", "Every format in numbers", "");
    all.push(table.clone());
    sections.push(all.folded());
    Report {
        name: "formats".into(),
        title: "8-bit versus 16-bit versus 24-bit versus float depth".into(),
        question: "Which bias does each depth format need, and what is left at the documents' own?"
            .into(),
        lead: first.into_iter().chain(missing.iter().map(|why| format!("{why}."))).chain([format!(
            "In {alike} of {} cases 16 bits need at most a tenth more bias than 32-bit float: there the slope of the surfaces decides, not the format.",
            cases.len()
        )]).collect(),
        unmeasured: missing,
        profile,
        seed,
        parameters: BTreeMap::from([("biases".into(), "0, 1e-7:1e-1:log:121".into())]),
        command: format!("gnomon-formats --{profile}"),
        sections,
        results: json!({ "schema": "gnomon-formats-1", "profile": profile, "seed": seed, "formats": results }),
        results_csv: Some(table),
        ..Report::default()
    }
}
