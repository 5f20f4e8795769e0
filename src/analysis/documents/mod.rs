//! The documents' systems measured end to end, and the report that shows them.

mod ask;
mod case_page;
mod device_panel;
mod explore;
pub mod findings;
mod layers;
pub mod overview;
mod probes;
mod shade;

pub use ask::Ask;

use super::captured::Captured;
use super::curve::Curve;
use super::effort::{self, Effort};
use super::measure::{Measured, measure_by, measure_captured};
use super::measurement::{Measurement, share};
use crate::device::DeviceProfile;
use crate::report::slug::slugs;
use crate::report::{Finding, Profile, Report, Section};
use crate::scene::{Case, CullRule, Filter, cases};
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
    /// One for each light of a user's own.
    Each(Vec<Case>),
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
            Which::Each(cases) => cases.clone(),
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
    Change { of: "exam-pcf", suffix: "cull-none", edit: |case| case.map.cull = CullRule::None },
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

/// Ids of the page beside those of cases and claims.
const OWN: [&str; 9] = [
    "overview",
    "windows",
    "cases",
    "cases-bias",
    "findings",
    "this-gpu",
    "gpu",
    "method",
    "about-run",
];
/// What the page appends to the id of a case.
const PARTS: [&str; 10] = [
    "classes",
    "shaded",
    "map",
    "explorer",
    "curve",
    "formats",
    "numbers",
    "causes",
    "receivers",
    "work",
];

/// The ids of cases on the page, in their order.
fn ids(cases: &[Case]) -> Vec<String> {
    let claims = findings::CLAIMS.iter().map(|claim| claim.id);
    let own: Vec<&str> = OWN.into_iter().chain(["main"]).chain(claims).collect();
    slugs(cases.iter().map(|case| case.name.as_str()), &own, &PARTS)
}

/// Measures and builds the report. `progress` is called once for each finished case.
///
/// # Errors
/// [`crate::Error::BadInput`] for an unknown case.
pub fn report(options: &Options, progress: impl Fn() + Sync) -> crate::Result<Report> {
    let cases = options.cases()?;
    let step = options.step();
    let ids = ids(&cases);
    let page = |(case, id): (&Case, &String)| {
        let variants = variants(case);
        let (measured, compared) = rayon::join(
            || measured(case, options),
            || {
                let variant = |variant| measure_by(variant, step, options.effort);
                variants.par_iter().map(variant).collect::<Vec<_>>()
            },
        );
        let mut sections = vec![case_page::section(id, &measured, &compared, step)];
        if !matches!(options.which, Which::All) {
            sections.push(work(id, &measured));
        }
        progress();
        Page {
            sections,
            wrong: wrong_shares(&measured.curve),
            measurement: measured.measurement,
            compared: compared.into_iter().map(|c| c.measurement).collect(),
        }
    };
    let device = options.device.unwrap_or(DeviceProfile::WebglSwiftshader).device();
    let (pages, probes) = rayon::join(
        || cases.par_iter().zip(&ids).map(page).collect::<Vec<_>>(),
        || probes::probes(&device),
    );
    let measurements: Vec<_> = pages.iter().map(|page| &page.measurement).collect();
    let compared: Vec<_> = pages.iter().flat_map(|page| &page.compared).collect();
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
    Ok(assemble(options, &ids, pages, findings, results))
}

/// A case's part of the report.
struct Page {
    measurement: Measurement,
    compared: Vec<Measurement>,
    sections: Vec<Section>,
    /// Share of wrong receivers at the biases of [`overview::columns`].
    wrong: Vec<Option<f64>>,
}

fn wrong_shares(curve: &Curve) -> Vec<Option<f64>> {
    let receivers = curve.populations().iter().sum();
    let at = |(_, bias): (usize, f32)| {
        let errors = curve.at(bias);
        share(errors.false_shadow + errors.false_light, receivers)
    };
    overview::columns().into_iter().map(at).collect()
}

fn measured<'c>(case: &'c Case, options: &Options) -> Measured<'c> {
    match &options.captured {
        None => measure_by(case, options.step(), options.effort),
        Some(captured) => measure_captured(case, options.step(), options.effort, captured),
    }
}

/// What the skips saved on one case.
fn work(case: &str, measured: &Measured<'_>) -> Section {
    let id = format!("{case}-work");
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
    ids: &[String],
    pages: Vec<Page>,
    findings: Vec<Finding>,
    results: Value,
) -> Report {
    let split = |page: Page| (page.measurement, (page.wrong, page.sections));
    let (measurements, rest): (Vec<_>, Vec<_>) = pages.into_iter().map(split).unzip();
    let (wrong, sections): (Vec<_>, Vec<_>) = rest.into_iter().unzip();
    let mut report = Report {
        name: "documents".to_string(),
        title: "Five documents on WebGL shadow mapping, measured".to_string(),
        question: "How much acne and peter-panning do the documents' systems have, and why?"
            .to_string(),
        lead: overview::lead(&measurements, &findings),
        unmeasured: overview::unmeasured(&measurements),
        profile: options.profile,
        seed: options.seed,
        command: format!("gnomon-report --{}", options.profile),
        results,
        results_csv: Some(overview::numbers(&measurements)),
        ..Report::default()
    };
    report.parameters.insert("pixels".into(), format!("every {}", options.step()));
    let mut found = Section::new(
        "findings",
        "What the documents get wrong or leave out",
        "Each sentence follows the measured numbers: it turns over when they do.",
    );
    found.push(findings);
    report.sections.extend([overview::section(&measurements, ids, wrong), found]);
    report.sections.extend(sections.concat());
    report.sections.push(device_panel::section());
    report.sections.push(method());
    report
}

fn method() -> Section {
    let mut section = Section::new("method", "Method and words", "").folded();
    for text in [
        "Receiver: a pixel centre of the subject's own camera pass, as triangle and barycentric \
         coordinates, promoted to f64. Truth: the f64 segment from the receiver to the light, decided by \
         exact signs; the receiver's own triangle and triangles that touch it do not occlude.",
        "Rates are over receivers that face the light, lie in its cone and map, and whose truth is \
         certain; all others are counted apart.",
        "Cause: each receiver is judged on six rungs: culling (whether any drawn face occludes it), \
         then, each with the case's bias, bias (exact depth of the nearest occluder), sampling (exact depth at the texel's centre), arithmetic (f32 transform \
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
