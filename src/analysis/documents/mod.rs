//! The documents' systems measured end to end, and the report that shows them.

mod ask;
mod case_page;
mod device_panel;
mod explore;
pub mod findings;
mod layers;
mod probes;
mod shade;

pub use ask::Ask;

use super::captured::Captured;
use super::effort::{self, Effort};
use super::measure::{Measured, measure_by, measure_captured};
use super::measurement::Measurement;
use crate::device::DeviceProfile;
use crate::report::{Cell, Column, Finding, Profile, Report, Section, Table, Verdict};
use crate::scene::{Case, Cull, Filter, cases};
use rayon::prelude::*;
use serde_json::{Value, json};

/// Version of the layout of `results.json`.
pub const SCHEMA: &str = "gnomon-documents-1";

/// What to measure.
#[derive(Clone, Debug)]
pub struct Options {
    /// Quick looks at every 4th pixel in x and y.
    pub profile: Profile,
    /// Seed, carried into the report (nothing here is random).
    pub seed: u64,
    /// What to measure.
    pub which: Which,
    /// Another device than the cases' own.
    pub device: Option<DeviceProfile>,
    /// How it is measured; the results do not depend on it.
    pub effort: Effort,
    /// A map to be looked up in place of the one that the case draws.
    pub captured: Option<Captured>,
}

/// The cases of a run.
#[derive(Clone, Debug)]
pub enum Which {
    /// The documents' systems and the closed forms beside them.
    All,
    /// One named case.
    Named(String),
    /// A user's own.
    Own(Box<Case>),
}

impl Default for Options {
    fn default() -> Self {
        Self {
            profile: Profile::Full,
            seed: 1,
            which: Which::All,
            device: None,
            effort: Effort::default(),
            captured: None,
        }
    }
}

impl Options {
    /// Every how many pixels a receiver is taken, in x and y.
    #[must_use]
    pub const fn step(&self) -> u32 {
        match self.profile {
            Profile::Quick => 4,
            Profile::Full => 1,
        }
    }

    /// The cases to be measured, on the device asked for.
    ///
    /// # Errors
    /// [`crate::Error::BadInput`] for an unknown case.
    pub fn cases(&self) -> crate::Result<Vec<Case>> {
        let mut list = match &self.which {
            Which::All => cases::main_job(),
            Which::Named(name) => vec![cases::named(name)?],
            Which::Own(case) => vec![Case::clone(case)],
        };
        if let Some(device) = self.device {
            list.iter_mut().for_each(|case| case.device = device);
        }
        Ok(list)
    }
}

/// A case with one thing changed, for findings that compare.
struct Change {
    of: &'static str,
    suffix: &'static str,
    edit: fn(&mut Case),
}

const CHANGES: [Change; 2] = [
    Change {
        of: "runnable-rgba8",
        suffix: "nearest",
        edit: |case| case.lookup.filter = Filter::Nearest,
    },
    Change { of: "exam-pcf", suffix: "cull-none", edit: |case| case.map.cull = Cull::None },
];

/// The variants of a case that findings compare it with.
fn variants(case: &Case) -> Vec<Case> {
    let of_case = CHANGES.iter().filter(|change| change.of == case.name);
    let changed = of_case.map(|change| {
        let mut variant = Case { name: format!("{}-{}", case.name, change.suffix), ..case.clone() };
        (change.edit)(&mut variant);
        variant
    });
    changed.collect()
}

/// Measures and builds the report. `progress` is called once for each finished case.
///
/// # Errors
/// [`crate::Error::BadInput`] for an unknown case.
pub fn report(options: &Options, progress: impl Fn() + Sync) -> crate::Result<Report> {
    let cases = options.cases()?;
    let step = options.step();
    let page = |case: &Case| {
        let variants = variants(case);
        let (measured, compared) = rayon::join(
            || measured(case, options),
            || {
                let variant = |variant| measure_by(variant, step, options.effort);
                variants.par_iter().map(variant).collect::<Vec<_>>()
            },
        );
        let mut sections = vec![case_page::section(&measured, &compared, step)];
        if !matches!(options.which, Which::All) {
            sections.push(work(&measured));
        }
        progress();
        let compared: Vec<_> = compared.into_iter().map(|c| c.measurement).collect();
        (measured.measurement, (sections, compared))
    };
    let device = options.device.unwrap_or(DeviceProfile::WebglSwiftshader).device();
    let (measured, probes) = rayon::join(
        || cases.par_iter().map(page).unzip::<_, _, Vec<_>, Vec<_>>(),
        || probes::probes(&device),
    );
    let (measurements, pages) = measured;
    let (sections, compared): (Vec<_>, Vec<Vec<Measurement>>) = pages.into_iter().unzip();
    let (sections, compared) = (sections.concat(), compared.concat());
    let mut results = json!({
        "schema": SCHEMA,
        "profile": options.profile.name(),
        "seed": options.seed,
        "cases": measurements,
        "variants": compared,
        "probes": probes,
    });
    let findings = findings::evaluate(&findings::by_name(&results));
    results["findings"] = findings.iter().map(finding_json).collect();
    Ok(assemble(options, &measurements, sections, findings, results))
}

fn measured<'c>(case: &'c Case, options: &Options) -> Measured<'c> {
    match &options.captured {
        None => measure_by(case, options.step(), options.effort),
        Some(captured) => measure_captured(case, options.step(), options.effort, captured),
    }
}

/// What the skips saved on one case.
fn work(measured: &Measured<'_>) -> Section {
    let id = format!("{}-work", measured.measurement.name);
    let mut section = Section::new(
        id.clone(),
        "Work done and left out",
        "No result depends on what is left out; --no-skip works everything out.",
    )
    .folded();
    section.push(effort::table(&format!("{id}-table"), &measured.work));
    section
}

fn finding_json(finding: &Finding) -> Value {
    json!({
        "id": finding.id,
        "verdict": finding.verdict.name(),
        "sentence": finding.sentence,
        "expression": finding.expression,
    })
}

fn assemble(
    options: &Options,
    measurements: &[Measurement],
    sections: Vec<Section>,
    findings: Vec<Finding>,
    results: Value,
) -> Report {
    let table = summary(measurements);
    let mut report = Report {
        name: "documents".to_string(),
        title: "Five documents on WebGL shadow mapping, measured".to_string(),
        question: "How much acne and peter-panning do the documents' systems have, and why?"
            .to_string(),
        lead: lead(measurements, &findings),
        profile: options.profile,
        seed: options.seed,
        command: format!("gnomon-report --{}", options.profile),
        results,
        results_csv: Some(table.clone()),
        ..Report::default()
    };
    report.parameters.insert("pixels".into(), format!("every {}", options.step()));
    let mut overview = Section::new("overview", "All cases", "");
    overview.push(table);
    let mut found = Section::new(
        "findings",
        "What the documents get wrong or leave out",
        "Each sentence follows the measured numbers: it turns over when they do.",
    );
    found.push(findings);
    report.sections.extend([overview, found]);
    report.sections.extend(sections);
    report.sections.push(device_panel::section());
    report.sections.push(method());
    report
}

fn lead(measurements: &[Measurement], findings: &[Finding]) -> Vec<String> {
    let worst = |rate: fn(&Measurement) -> f64| {
        let of_documents = measurements.iter().filter(|m| m.facts.is_empty());
        of_documents.max_by(|a, b| rate(a).total_cmp(&rate(b)))
    };
    let percent = |rate: f64| crate::report::number::percent(rate, 3);
    let mut lead = Vec::new();
    if let Some(m) = worst(|m| m.false_shadow.rate).filter(|m| m.false_shadow.count > 0) {
        lead.push(format!(
            "Most false shadow among the documents: {} ({} of its lit receivers at its bias {}).",
            m.name,
            percent(m.false_shadow.rate),
            m.bias
        ));
    }
    if let Some(m) = worst(|m| m.false_light.rate).filter(|m| m.false_light.count > 0) {
        lead.push(format!(
            "Most false light among the documents: {} ({} of its shadowed receivers).",
            m.name,
            percent(m.false_light.rate)
        ));
    }
    let of = |v: Verdict| findings.iter().filter(|f| f.verdict == v).count();
    lead.push(format!(
        "{} of {} claims about the documents are borne out by these numbers, {} contradicted, {} undecided.",
        of(Verdict::Supported),
        findings.len(),
        of(Verdict::Contradicted),
        of(Verdict::Undecided),
    ));
    lead
}

fn summary(measurements: &[Measurement]) -> Table {
    let column = |name: &str, unit: &str| Column {
        name: name.to_string(),
        unit: unit.to_string(),
        ..Column::default()
    };
    let row = |m: &Measurement| {
        let depth = |b: Option<f32>| Cell::number(b.map(f64::from));
        vec![
            Cell::Link { text: m.name.clone(), to: format!("#{}", m.name) },
            m.format.into(),
            Cell::count(m.map_size),
            Cell::Number(f64::from(m.bias), 4),
            Cell::count(m.lit),
            Cell::Percent(m.false_shadow.rate),
            Cell::count(m.shadowed),
            Cell::Percent(m.false_light.rate),
            Cell::count(m.samples.ambiguous),
            depth(m.thresholds.critical),
            depth(m.thresholds.detachment),
            Cell::number(m.peter_panning.map(|l| l.world)),
        ]
    };
    Table {
        id: "cases".to_string(),
        caption: "Every case at its own bias, against the ray-traced truth".to_string(),
        columns: vec![
            column("case", ""),
            column("format", ""),
            column("map", "texels"),
            column("bias", "window depth"),
            column("lit", "receivers"),
            column("false shadow", ""),
            column("shadowed", "receivers"),
            column("false light", ""),
            column("ambiguous", "receivers"),
            column("critical bias", "window depth"),
            column("detachment bias", "window depth"),
            column("peter-panning", "world units"),
        ],
        rows: measurements.iter().map(row).collect(),
    }
}

fn method() -> Section {
    let mut section = Section::new("method", "Method and words", "").folded();
    for text in [
        "Receiver: a pixel centre of the subject's own camera pass, as triangle and barycentric \
         coordinates, promoted to f64. Truth: the f64 segment from the receiver to the light, decided by \
         exact signs; the receiver's own triangle and triangles that touch it do not occlude.",
        "Rates are over receivers that face the light, lie in its cone and map, and whose truth is \
         certain; all others are counted apart.",
        "Cause: each receiver is judged on five rungs, each with the case's bias: bias (exact depth of \
         the nearest occluder), sampling (exact depth at the texel's centre), arithmetic (f32 transform \
         and raster), quantization (store, packing, sampler, depth attachment), filter. The cause is the \
         first rung from which the verdict stays wrong to the end.",
        "Artifact, by the stored caster at the deciding texel: acne (own or adjacent surface), edge \
         aliasing (the texel centre sees another surface), encoding fault (cleared texel, broken \
         packing), peter-panning (the bias hides the true occluder), light leak (anything else).",
        "Critical bias: the largest breakpoint of truly lit receivers whose texels hold their own \
         surface. Detachment bias: the smallest breakpoint of truly shadowed receivers whose texel \
         holds a true occluder. A breakpoint is the smallest f32 bias at which the document's own f32 \
         rule says lit.",
        "Peter-panning length: the longest falsely lit strip through a sample, along the light's \
         direction on the receiver. Stripe period: the mean distance between starts of false-shadow \
         stripes along that direction, without bias.",
    ] {
        section.push(text);
    }
    section
}
