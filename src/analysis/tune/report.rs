//! The report of a tuned scene: the lines to paste, what each setting leaves wrong, and other units.

use super::tables::{artifacts, units};
use super::{Found, Tuned, Tuning, moves_along_vertices, tune};
use crate::analysis::measure::unmeasured;
use crate::analysis::sweep::Field;
use crate::analysis::sweep::tally::Tally;
use crate::engines::{Engine, Knob};
use crate::report::number::significant;
use crate::report::{Block, Profile, Report, Section};
use crate::scene::Case;
use serde_json::{Value, json};
use std::collections::BTreeMap;

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

impl Tuning {
    /// Each setting that has a value and what it leaves wrong; the engine's defaults last.
    fn rows(&self) -> Vec<(String, Tally)> {
        let row = |t: &Tuned| {
            let name = match t.found {
                Found::Set(value) => format!("{} = {}", t.knob.name, significant(value, 6)),
                Found::NotNeeded => format!("{}: none", t.knob.name),
                Found::Infeasible | Found::OutOfRange(_) | Found::Withdrawn(_) => {
                    return None;
                }
            };
            Some((name, t.swept.acne_free?.tally))
        };
        let defaults = self.defaults.map(|tally| (format!("{} defaults", self.engine), tally));
        self.tuned.iter().filter_map(row).chain(defaults).collect()
    }

    /// The lines to paste, or why there are none, and the tables.
    fn section(&self) -> Section {
        let engine = self.engine;
        let lead = match self.best() {
            Some(_) => "Each line alone ends acne; the first one costs the least light.",
            None => "No line is recommended.",
        };
        let mut section = Section::new("answer", "The value", lead);
        for t in &self.tuned {
            match t.found {
                Found::Set(value) => {
                    let line = t.knob.line(value);
                    section.push(Block::Code { language: engine.name().into(), text: line });
                }
                Found::NotNeeded
                | Found::Infeasible
                | Found::OutOfRange(_)
                | Found::Withdrawn(_) => section.push(self.reason(t)),
            }
        }
        if self.tuned.is_empty() {
            section.push(self.nothing_lit());
        }
        let rows = self.rows();
        if !rows.is_empty() {
            section.push(artifacts(&rows, self.populations));
        }
        let bias = self.window.filter(|bias| *bias != 0.0);
        if let (Some(bias), Some(place)) = (bias, &self.place) {
            let converts = |strategy| !(self.is_curved && moves_along_vertices(strategy));
            let (table, left_out) = units(place, bias, &self.setting, converts);
            section.push(table);
            if !left_out.is_empty() {
                let curved = match self.is_curved {
                    true => ", go along the vertices' normals, which are not the face's there,",
                    false => "",
                };
                section.push(format!(
                    "Left out, since they are known to be wrong here{curved} or beyond what the engine keeps: {}.",
                    left_out.join(", ")
                ));
            }
        }
        section.push(format!("Formula and defaults of {engine} are those of {}.", engine.source()));
        section
    }

    fn results(&self, request: &Request) -> Value {
        let value = |knob: &Knob| {
            let tuned = self.tuned.iter().find(|t| t.knob.name == knob.name);
            (knob.name, tuned.and_then(Tuned::value))
        };
        let values: BTreeMap<&str, Option<f64>> = self.engine.knobs().iter().map(value).collect();
        json!({
            "schema": "gnomon-tune-1",
            "profile": request.profile,
            "seed": request.seed,
            "case": request.case.name,
            "engine": self.engine,
            "values": values,
            "window_depth": self.window,
            "budget": self.budget,
            "cheapest": self.cheapest.as_ref().map(|c| json!({
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
    let tuning = tune(&field, engine, request.max_acne);
    let none = (field.populations == [0, 0]).then(|| unmeasured(case, step));
    let mut lead = field.first_lines();
    lead.push(match &none {
        Some(why) => format!("{why}. No bias is recommended."),
        None => tuning.sentence(),
    });
    lead.extend(tuning.withdrawn());
    lead.extend(tuning.cheapest_sentence());
    lead.extend(tuning.budget.as_ref().map(|budget| budget.sentence(&case.name)));
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
        sections: vec![tuning.section()],
        results_csv: Some(artifacts(&tuning.rows(), field.populations)),
        results: tuning.results(request),
        unmeasured: none.into_iter().collect(),
        ..Report::default()
    }
}
