//! The bias that a scene needs, in an engine's own parameters.

mod cheapest;

use super::budget::Budget;
use super::sweep::chart::{Attachment, Chart};
use super::sweep::field::Sample;
use super::sweep::looks::Look;
use super::sweep::tally::{Kind, Tally};
use super::sweep::{Field, Point, Question, Range, Scales, Swept, amounts, sweep};
use crate::engines::{Engine, Knob, Place};
use crate::report::number::{percent, significant};
use crate::report::{Block, Cell, Profile, Report, Section, Table};
use crate::scene::{Case, TexelFormat};
use crate::shadow::bias::slope::receiver_slope;
use crate::shadow::bias::{NormalMove, Recipe};
pub use cheapest::Configuration;
use cheapest::cheapest;
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

/// One parameter at its smallest value that meets the target.
#[derive(Clone, Debug)]
pub struct Tuned {
    /// The parameter.
    pub knob: Knob,
    /// Its value; `None` where none ends acne.
    pub value: Option<f64>,
    /// The sweep behind it.
    pub swept: Swept,
}

impl Tuned {
    fn new(chart: &Chart<'_, '_>, format: TexelFormat, knob: Knob, max_acne: f64) -> Self {
        let range = Range { low: 1e-7, high: 1e-1, log: true, count: 100 };
        let scales = Scales::on(chart.field, chart.size, format, knob.strategy);
        let amounts = amounts(knob.strategy, &range, &scales);
        let question = Question { amounts: &amounts, max_acne };
        let swept = sweep(chart, format, knob.strategy, &question);
        let value = swept.acne_free.map(|p| knob.value(f64::from(p.amount)));
        Self { knob, value, swept }
    }

    /// Why no value of the parameter meets the target, in one sentence.
    fn reason(&self, populations: [u64; 2]) -> String {
        let acne = |p: &&Point| p.tally.of(Kind::ACNE);
        let share = |n: i64, side: usize| percent(n as f64 / populations[side].max(1) as f64, 3);
        let least = self.swept.points.iter().min_by_key(acne);
        least.map_or_else(String::new, |p| {
            format!(
                "{} alone cannot do it: at best, at {}, it leaves {} of the lit with acne and lights {} of the shadowed.",
                self.knob.name,
                significant(self.knob.value(p.amount.into()), 4),
                share(acne(&p), 0),
                share(p.tally.false_light(), 1),
            )
        })
    }

    /// Whether shadows detach before acne has ended, in words for the end of a sentence.
    fn conflict(&self) -> String {
        let ends = self.swept.acne_free.map(|p| p.amount);
        match (ends, self.swept.detachment) {
            (Some(free), Some(first)) if first <= free => format!(
                " No value is free of both: shadows detach from {} on.",
                significant(self.knob.value(first.into()), 4)
            ),
            (Some(_), Some(first)) if first.is_finite() => {
                format!(
                    " Shadows detach from {} on.",
                    significant(self.knob.value(first.into()), 4)
                )
            }
            _ => String::new(),
        }
    }

    /// Order of preference: feasible, then the least false light, then false shadow.
    fn merit(&self) -> (bool, i64, i64) {
        self.swept
            .acne_free
            .map_or((true, i64::MAX, i64::MAX), |p| (false, p.tally.light, p.tally.shadow))
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
    let layout = field.case().light.layout(size);
    let site = field.site(sample, &layout);
    let map = &field.observer.lenses[sample.map].map;
    let (near, far) = map.projection.near_far();
    let z = map.axial_distance(sample.receiver.position);
    let [caster_slope, unit] = field.offset_terms(sample, &layout, format).map(f64::from);
    Place {
        near,
        far,
        distance: (!map.is_orthographic()).then_some(z),
        texel_world: site.texel_world,
        cosine: site.normal.dot(site.to_light).clamp(1e-6, 1.0),
        slope: receiver_slope(site.gradient, site.map_size),
        caster_slope,
        unit,
        step: format.step(map.clip.compared(sample.coord[2])),
    }
}

fn shares(tally: &Tally, populations: [u64; 2]) -> Vec<Cell> {
    let share = |kind: Kind| {
        let of = populations[usize::from(!kind.is_shadow())].max(1) as f64;
        Cell::Percent(tally.of(kind) as f64 / of)
    };
    Kind::ALL.iter().map(|&kind| share(kind)).collect()
}

fn artifacts(rows: &[(String, Tally)], populations: [u64; 2]) -> Table {
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

/// The same bias in every unit and engine at the middle receiver.
fn units(place: &Place, bias: f64) -> Table {
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
    for &engine in Engine::ALL {
        for knob in engine.knobs() {
            if let Some(amount) = place.amount(knob.strategy, bias) {
                push(format!("{engine} {}", knob.name), knob.value(amount));
            }
        }
    }
    table
}

/// The measured setting of an engine's defaults: casters' and receivers' hooks together.
fn defaults(chart: &Chart<'_, '_>, format: TexelFormat, engine: Engine) -> Tally {
    let recipe = engine.defaults();
    let casters = Recipe { normal: NormalMove::default(), light: 0.0, ..recipe };
    let field = chart.field.looking_from(&recipe, &chart.layout);
    let there = Chart::new(&field, chart.size, chart.filter, Attachment::of(format));
    let rule = field.case().lookup.compare;
    let mut tally = Tally::default();
    for (i, mut looks) in there.looks(format, &casters).into_iter().enumerate() {
        let sample = &chart.field.samples[i];
        let bias = |look: &Look| chart.tap_bias(&recipe, format, i, look.map);
        let wrong = looks.verdict_by(rule, bias).0.is_some();
        if recipe.moves_receiver() && !sample.lit && wrong {
            let offset = recipe.receiver_offset(&chart.site(i));
            looks.moved_into_light = chart.field.is_lit_from(sample, offset);
        }
        looks.tally_by(rule, bias, &mut tally);
    }
    tally
}

/// What is said instead of other units where the value lifts by more than all of window depth.
const BEYOND: &str = "At the middle receiver the value lifts by more than the whole depth range, so it is not shown in other units.";

/// The report of one request.
#[must_use]
pub fn report(request: &Request) -> Report {
    let (case, engine) = (&request.case, request.engine);
    let step = if request.profile == Profile::Quick { 4 } else { 1 };
    let field = Field::new(case, step);
    let format = case.map.texel;
    let filter = format.usable(case.lookup.filter);
    let chart = Chart::new(&field, case.map.size, filter, Attachment::of(format));
    let mut tuned: Vec<Tuned> =
        engine.knobs().iter().map(|&k| Tuned::new(&chart, format, k, request.max_acne)).collect();
    tuned.sort_by_key(Tuned::merit);
    let populations = field.populations;
    let best = tuned.iter().find(|t| t.value.is_some());
    let mut section = Section::new(
        "answer",
        "The value",
        "Each line alone ends acne; the first one costs the least light.",
    );
    let mut rows: Vec<(String, Tally)> = Vec::new();
    for t in &tuned {
        match (t.value, t.swept.acne_free) {
            (Some(value), Some(point)) => {
                let line = engine.line(&t.knob, value);
                section.push(Block::Code { language: engine.name().into(), text: line });
                rows.push((format!("{} = {}", t.knob.name, significant(value, 6)), point.tally));
            }
            _ => section.push(t.reason(populations)),
        }
    }
    rows.push((format!("{engine} defaults"), defaults(&chart, format, engine)));
    section.push(artifacts(&rows, populations));
    let window = best.and_then(|t| {
        let amount = f64::from(t.swept.acne_free?.amount);
        place(&field, chart.size, format)?.window(t.knob.strategy, amount)
    });
    match (window, place(&field, chart.size, format)) {
        (Some(bias), Some(place)) => section.push(units(&place, bias)),
        (None, Some(_)) if best.is_some() => section.push(BEYOND),
        _ => {}
    }
    let light = best.and_then(|t| t.swept.acne_free).map_or(0.0, |p| p.tally.false_light() as f64);
    let allowed = light / populations[1].max(1) as f64 + 0.005;
    let knob = best.map_or(engine.knobs()[0], |t| t.knob);
    let cheap = cheapest(&field, request, knob, allowed);
    let budget = Budget::of(&field);
    let reason = tuned.first().map_or_else(String::new, |t| t.reason(populations));
    let mut lead = vec![answer(request, best, &rows, populations, &reason)];
    lead.push(cheap.as_ref().map_or_else(
        || "No smaller configuration meets the target.".to_string(),
        |c| c.sentence(knob),
    ));
    lead.push(budget.sentence(&case.name));
    if !engine.remark().is_empty() {
        lead.push(format!("Of {engine}: {}.", engine.remark()));
    }
    section.push(format!("Formula and defaults of {engine} are those of {}.", engine.source()));
    let values: BTreeMap<&str, Option<f64>> =
        tuned.iter().map(|t| (t.knob.name, t.value)).collect();
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
        sections: vec![section],
        results_csv: Some(artifacts(&rows, populations)),
        results: results(request, &values, window, cheap.as_ref(), &budget),
        ..Report::default()
    }
}

fn results(
    request: &Request,
    values: &BTreeMap<&str, Option<f64>>,
    window: Option<f64>,
    cheap: Option<&Configuration>,
    budget: &Budget,
) -> Value {
    json!({
        "schema": "gnomon-tune-1",
        "profile": request.profile,
        "seed": request.seed,
        "case": request.case.name,
        "engine": request.engine,
        "values": values,
        "window_depth": window,
        "budget": budget,
        "cheapest": cheap.map(|c| json!({
            "map": c.size, "format": c.format.name(), "filter": c.filter, "bytes": c.bytes,
            "value": c.value, "false_light": c.false_light,
        })),
    })
}

/// The sentence on top.
fn answer(
    request: &Request,
    best: Option<&Tuned>,
    rows: &[(String, Tally)],
    populations: [u64; 2],
    reason: &str,
) -> String {
    let engine = request.engine;
    let share = |n: i64, side: usize| percent(n as f64 / populations[side].max(1) as f64, 3);
    let default = rows.last().map_or_else(String::new, |(_, t)| {
        let (shadow, light) = (share(t.of(Kind::ACNE), 0), share(t.false_light(), 1));
        format!(
            " The default leaves {shadow} of the lit with acne and {light} of the shadowed lit."
        )
    });
    match best.and_then(|t| Some((t, t.value?, t.swept.acne_free?))) {
        Some((t, value, point)) => format!(
            "Set {} to {}: acne falls to {} of the lit, false light is {} of the shadowed.{}{default}",
            t.knob.name,
            significant(value, 6),
            share(point.tally.of(Kind::ACNE), 0),
            share(point.tally.false_light(), 1),
            t.conflict(),
        ),
        None => format!(
            "Infeasible: no value of any of {engine}'s parameters brings acne to {} or below on this map. {}{default}",
            percent(request.max_acne, 3),
            reason,
        ),
    }
}
