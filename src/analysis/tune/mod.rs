//! The bias that a scene needs, in an engine's own parameters.

mod cheapest;
mod tables;
mod words;

use super::budget::Budget;
use super::measure::unmeasured;
use super::sweep::chart::{Attachment, Chart};
use super::sweep::field::Sample;
use super::sweep::tally::{Kind, Tally};
use super::sweep::{Field, Question, Range, Scales, Swept, amounts, sweep};
use crate::engines::withdrawn::Withdrawal;
use crate::engines::{Engine, Knob, Place, Setting};
use crate::report::number::significant;
use crate::report::{Block, Profile, Report, Section};
use crate::scene::{Case, TexelFormat};
use crate::shadow::bias::slope::receiver_slope;
use crate::shadow::bias::{NormalMove, Recipe, Strategy};
pub use cheapest::Configuration;
use cheapest::cheapest;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use tables::{artifacts, units};

/// What is tuned.
#[derive(Clone, Debug)]
pub struct Request {
    /// The scene.
    pub case: Case,
    /// The engine.
    pub engine: Engine,
    /// Acne allowed as a share of the truly lit.
    pub max_acne: f64,
    /// Quick or full.
    pub profile: Profile,
    /// Seed, for the record.
    pub seed: u64,
    /// The command that asks this again.
    pub command: String,
}

/// What comes of one parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outcome {
    /// The smallest value that meets the target, in the engine's unit.
    Set(f64),
    /// The target is met without any bias.
    NotNeeded,
    /// No amount meets the target.
    Infeasible,
    /// The target takes this value, which the engine does not keep, or more than the whole depth range.
    OutOfRange(f64),
    /// The line is known to be wrong here.
    Withdrawn(&'static Withdrawal),
}

/// One parameter and what comes of it.
#[derive(Clone, Debug)]
pub struct Tuned {
    /// The parameter.
    pub knob: Knob,
    /// What comes of it.
    pub outcome: Outcome,
    /// The sweep behind it.
    pub swept: Swept,
}

/// A strategy along its amounts on a chart.
fn swept(chart: &Chart<'_, '_>, format: TexelFormat, strategy: Strategy, max_acne: f64) -> Swept {
    let field = chart.field;
    let range = Range { low: 1e-7, high: 1e-1, log: true, count: 100 };
    let amounts = amounts(strategy, &range, &Scales::on(field, chart.size, format, strategy));
    let mut swept = sweep(chart, format, strategy, &Question { amounts: &amounts, max_acne });
    // Where no bias meets the target none is needed, even if more of this one brings acne back.
    let limit = (max_acne * field.populations[0] as f64) as i64;
    let none = swept.points.first().filter(|p| p.amount == 0.0 && p.tally.of(Kind::ACNE) <= limit);
    swept.acne_free = none.copied().filter(|_| field.populations[0] > 0).or(swept.acne_free);
    swept
}

impl Tuned {
    fn new(chart: &Chart<'_, '_>, format: TexelFormat, knob: Knob, max_acne: f64) -> Self {
        let swept = swept(chart, format, knob.strategy, max_acne);
        let setting = Setting::of(chart.field.case(), chart.filter);
        let amount = swept.acne_free.map(|p| f64::from(p.amount));
        let outcome = match (amount, knob.withdrawn(&setting)) {
            (Some(0.0), _) => Outcome::NotNeeded,
            (_, Some(withdrawal)) => Outcome::Withdrawn(withdrawal),
            (None, None) => Outcome::Infeasible,
            (Some(amount), None) => {
                let value = knob.value(amount);
                let beyond = knob.strategy == Strategy::Constant && amount > 1.0;
                match knob.accepts(value) && !beyond {
                    true => Outcome::Set(value),
                    false => Outcome::OutOfRange(value),
                }
            }
        };
        Self { knob, outcome, swept }
    }

    /// The value to set; `None` where none is recommended.
    #[must_use]
    pub const fn value(&self) -> Option<f64> {
        match self.outcome {
            Outcome::Set(value) => Some(value),
            Outcome::NotNeeded => Some(0.0),
            Outcome::Infeasible | Outcome::OutOfRange(_) | Outcome::Withdrawn(_) => None,
        }
    }

    /// Order of preference: feasible, then the least false light, then false shadow.
    fn merit(&self) -> (bool, i64, i64) {
        let end = self.swept.acne_free.filter(|_| self.value().is_some());
        end.map_or((true, i64::MAX, i64::MAX), |p| (false, p.tally.light, p.tally.shadow))
    }
}

/// Where units are converted: the receiver in the middle of those counted.
#[must_use]
pub fn place(field: &Field<'_>, size: u32, format: TexelFormat) -> Option<Place> {
    Some(place_at(field, field.middle()?, size, format))
}

/// Where units are converted at one receiver. A polygon offset lifts its own triangle by the slope and the
/// unit that the sweeps draw it with, so that an amount times its lever is the window depth swept.
#[must_use]
pub fn place_at(field: &Field<'_>, sample: &Sample, size: u32, format: TexelFormat) -> Place {
    let light = &field.case().light;
    let site = field.site(sample, size);
    let (near, far) = light.projection.near_far();
    let z = light.axial_distance(sample.receiver.position);
    let [caster_slope, unit] = field.offset_terms(sample, size, format).map(f64::from);
    Place {
        near,
        far,
        distance: (!light.is_directional()).then_some(z),
        texel_world: site.texel_world,
        cosine: site.normal.dot(site.to_light).clamp(1e-6, 1.0),
        slope: receiver_slope(site.gradient, size),
        caster_slope,
        unit,
        step: format.step(sample.coord[2]),
    }
}

/// The measured setting of an engine's defaults: casters' and receivers' hooks together.
fn defaults(chart: &Chart<'_, '_>, format: TexelFormat, engine: Engine) -> Tally {
    let recipe = engine.defaults();
    let casters = Recipe { normal: NormalMove::default(), light: 0.0, ..recipe };
    let field = chart.field.looking_from(&recipe, chart.size);
    let there = Chart::new(&field, chart.size, chart.filter, Attachment::of(format));
    let rule = field.case().lookup.compare;
    let mut tally = Tally::default();
    for (i, mut looks) in there.looks(format, &casters).into_iter().enumerate() {
        let sample = &chart.field.samples[i];
        let bias = recipe.tap_bias(&chart.weights(format, i));
        let wrong = looks.verdict(rule, bias).0.is_some();
        if recipe.moves_receiver() && !sample.lit && wrong {
            let offset = recipe.receiver_offset(&chart.site(i));
            looks.moved_into_light = chart.field.is_lit_from(sample, offset);
        }
        looks.tally(rule, bias, &mut tally);
    }
    tally
}

/// Everything that is worked out for one request.
struct Answer<'r> {
    request: &'r Request,
    populations: [u64; 2],
    /// In order of preference; empty where nothing is lit and acne is not measured.
    tuned: Vec<Tuned>,
    /// Each setting and what it leaves wrong; the engine's defaults last, where they are known.
    rows: Vec<(String, Tally)>,
    /// Why what the defaults leave is not said.
    no_default: Option<&'static Withdrawal>,
    /// The constant bias that ends acne, window depth; asked where a line is withdrawn.
    constant: Option<f32>,
    /// The best value in window depth at the middle receiver.
    window: Option<f64>,
    place: Option<Place>,
    setting: Setting,
}

impl<'r> Answer<'r> {
    fn new(request: &'r Request, chart: &Chart<'_, '_>, format: TexelFormat) -> Self {
        let (engine, populations) = (request.engine, chart.field.populations);
        let knobs = if populations[0] > 0 { engine.knobs() } else { Vec::new() };
        let tune = |knob| Tuned::new(chart, format, knob, request.max_acne);
        let mut tuned: Vec<Tuned> = knobs.into_iter().map(tune).collect();
        tuned.sort_by_key(Tuned::merit);
        let setting = Setting::of(&request.case, chart.filter);
        let no_default = engine.default_withdrawn(&setting);
        let row = |t: &Tuned| {
            let name = match t.outcome {
                Outcome::Set(value) => format!("{} = {}", t.knob.name, significant(value, 6)),
                Outcome::NotNeeded => format!("{}: none", t.knob.name),
                Outcome::Infeasible | Outcome::OutOfRange(_) | Outcome::Withdrawn(_) => {
                    return None;
                }
            };
            Some((name, t.swept.acne_free?.tally))
        };
        let mut rows: Vec<(String, Tally)> = tuned.iter().filter_map(row).collect();
        if no_default.is_none() && populations != [0, 0] {
            rows.push((format!("{engine} defaults"), defaults(chart, format, engine)));
        }
        let is_withdrawn = |t: &Tuned| matches!(t.outcome, Outcome::Withdrawn(_));
        let constant = tuned.iter().any(is_withdrawn).then(|| {
            let swept = swept(chart, format, Strategy::Constant, request.max_acne);
            swept.acne_free.map(|p| p.amount)
        });
        let place = place(chart.field, chart.size, format);
        let best = tuned.iter().find(|t| t.value().is_some());
        let window = best.zip(place.as_ref()).and_then(|(t, place)| {
            let amount = f64::from(t.swept.acne_free?.amount);
            place.window(t.knob.strategy, amount).filter(|depth| depth.abs() <= 1.0)
        });
        let constant = constant.flatten();
        Self { request, populations, rows, no_default, constant, window, place, setting, tuned }
    }

    fn best(&self) -> Option<&Tuned> {
        self.tuned.iter().find(|t| t.value().is_some())
    }

    /// The lines to paste, or why there are none, and the tables.
    fn section(&self) -> Section {
        let engine = self.request.engine;
        let lead = match self.best() {
            Some(_) => "Each line alone ends acne; the first one costs the least light.",
            None => "No line is recommended.",
        };
        let mut section = Section::new("answer", "The value", lead);
        for t in &self.tuned {
            match t.outcome {
                Outcome::Set(value) => {
                    let line = t.knob.line(value);
                    section.push(Block::Code { language: engine.name().into(), text: line });
                }
                Outcome::NotNeeded
                | Outcome::Infeasible
                | Outcome::OutOfRange(_)
                | Outcome::Withdrawn(_) => section.push(self.reason(t)),
            }
        }
        if self.tuned.is_empty() {
            section.push(self.nothing_lit());
        }
        if !self.rows.is_empty() {
            section.push(artifacts(&self.rows, self.populations));
        }
        let bias = self.window.filter(|bias| *bias != 0.0);
        if let (Some(bias), Some(place)) = (bias, &self.place) {
            let (table, left_out) = units(place, bias, &self.setting);
            section.push(table);
            if !left_out.is_empty() {
                section.push(format!(
                    "Left out, since they are known to be wrong here or beyond what the engine keeps: {}.",
                    left_out.join(", ")
                ));
            }
        }
        section.push(format!("Formula and defaults of {engine} are those of {}.", engine.source()));
        section
    }

    fn results(&self, cheap: Option<&Configuration>, budget: Option<&Budget>) -> Value {
        let request = self.request;
        let value = |knob: &Knob| {
            let tuned = self.tuned.iter().find(|t| t.knob.name == knob.name);
            (knob.name, tuned.and_then(Tuned::value))
        };
        let values: BTreeMap<&str, Option<f64>> =
            request.engine.knobs().iter().map(value).collect();
        json!({
            "schema": "gnomon-tune-1",
            "profile": request.profile,
            "seed": request.seed,
            "case": request.case.name,
            "engine": request.engine,
            "values": values,
            "window_depth": self.window,
            "budget": budget,
            "cheapest": cheap.map(|c| json!({
                "map": c.size, "format": c.format.name(), "filter": c.filter, "bytes": c.bytes,
                "value": c.value, "false_light": c.false_light,
            })),
        })
    }
}

/// The report of one request.
#[must_use]
pub fn report(request: &Request) -> Report {
    let (case, engine) = (&request.case, request.engine);
    let step = if request.profile == Profile::Quick { 4 } else { 1 };
    let field = Field::new(case, step);
    let format = case.map.texel;
    let filter = format.usable(case.lookup.filter);
    let chart = Chart::new(&field, case.map.size, filter, Attachment::of(format));
    let answer = Answer::new(request, &chart, format);
    let none = (field.populations == [0, 0]).then(|| unmeasured(case, step));
    let mut lead = vec![match &none {
        Some(why) => format!("{why}. No bias is recommended."),
        None => answer.sentence(),
    }];
    let (cheap, budget) = match field.populations[0] {
        0 => (None, None),
        _ => (cheapest(&field, request, &answer), Some(Budget::of(&field))),
    };
    lead.extend(answer.withdrawn());
    lead.extend(answer.cheapest_sentence(cheap.as_ref()));
    lead.extend(budget.as_ref().map(|budget| budget.sentence(&case.name)));
    if !engine.remark().is_empty() {
        lead.push(format!("Of {engine}: {}.", engine.remark()));
    }
    Report {
        name: "tune".into(),
        title: format!("{}: the bias for {engine}", case.name),
        question: "Which bias does this scene need, in this engine's own parameters?".into(),
        lead,
        profile: request.profile,
        seed: request.seed,
        parameters: BTreeMap::from([
            ("case".into(), case.name.clone()),
            ("engine".into(), engine.to_string()),
            ("map".into(), case.map.size.to_string()),
            ("format".into(), format.name().into()),
            ("filter".into(), filter.to_string()),
            ("allowed acne".into(), request.max_acne.to_string()),
        ]),
        command: request.command.clone(),
        sections: vec![answer.section()],
        results_csv: Some(artifacts(&answer.rows, field.populations)),
        results: answer.results(cheap.as_ref(), budget.as_ref()),
        unmeasured: none.into_iter().collect(),
        ..Report::default()
    }
}
