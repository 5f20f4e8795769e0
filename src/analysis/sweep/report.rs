//! The report of a sweep: which strategy wins where, trade-offs, and what amounts look like.

use super::pictures::Gallery;
use super::plots::{curves, heat_map, trade_off};
pub use super::results::combination;
use super::results::{key, own, winner};
use super::tally::Kind;
use super::{CaseSweep, Field, Plan, Swept, verdicts};
use crate::analysis::measure::unmeasured;
use crate::analysis::measurement::half_measured;
use crate::analysis::outside::named;
use crate::report::slug::slugs;
use crate::report::{Block, Cell, Profile, Report, Section, Table};
use crate::scene::Case;
use crate::shadow::bias::Strategy;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::slice;

/// Sentences on top: who wins, where nothing works.
fn lead(sweeps: &[CaseSweep], unmeasured: &[String]) -> Vec<String> {
    let first = |case: &CaseSweep| named(sweeps.len(), &case.name, &case.first_lines);
    let mut lead: Vec<String> = sweeps.iter().flat_map(first).collect();
    lead.extend(unmeasured.iter().map(|why| format!("{why}.")));
    let half = |case: &CaseSweep| {
        let missing = half_measured(case.swept.first()?.populations)?;
        Some(format!("{}: {missing}.", case.name))
    };
    lead.extend(sweeps.iter().filter_map(half));
    let lit = |case: &&CaseSweep| case.swept.first().is_some_and(|s| s.populations[0] > 0);
    let sweeps: Vec<&CaseSweep> = sweeps.iter().filter(lit).collect();
    if sweeps.is_empty() {
        return lead;
    }
    let mut wins: BTreeMap<Strategy, usize> = BTreeMap::new();
    for case in &sweeps {
        if let Some(best) = winner(&own(case)) {
            *wins.entry(best.strategy).or_default() += 1;
        }
    }
    let mut ranked: Vec<_> = wins.into_iter().collect();
    ranked.sort_by_key(|&(strategy, n)| (std::cmp::Reverse(n), strategy));
    let named: Vec<String> = ranked.iter().map(|(s, n)| format!("{s} ({n})")).collect();
    let total: usize = sweeps.iter().map(|c| c.swept.len()).sum();
    let infeasible = sweeps.iter().flat_map(|c| &c.swept).filter(|s| s.acne_free.is_none()).count();
    lead.extend([
        format!(
            "At each case's own map and format, the strategy that ends acne and leaves least wrong: {}.",
            if named.is_empty() { "none".to_string() } else { named.join(", ") }
        ),
        format!(
            "{infeasible} of {total} combinations have no amount in the swept range that ends acne."
        ),
    ]);
    lead
}

/// More combinations than this are shown at each case's own map and format only.
const SHOWN: usize = 400;

/// The combinations of a case that tables show.
fn shown(case: &CaseSweep, all: usize) -> Vec<&Swept> {
    if all <= SHOWN { case.swept.iter().collect() } else { own(case) }
}

/// Every strategy of the given cases, for `results.csv` and for the part of one case.
fn table(id: &str, sweeps: &[CaseSweep], all: usize) -> Table {
    let mut table = Table::new(
        id,
        "Each strategy at the smallest amount that ends acne: what is wrong there, and the room above it.",
    )
    .column("case", "", "")
    .column("map", "texels", "texels per side")
    .column("format", "", "")
    .column("filter", "", "")
    .column("strategy", "", "")
    .column("acne-free", "unit", "smallest amount from which acne stays within the limit")
    .column("unit", "", "of the amount")
    .column("false shadow", "", "share of the truly lit that is wrong there")
    .column("false light", "", "share of the truly shadowed that is wrong there")
    .column("contact gap", "texels", "longest peter-panned way inside a true shadow")
    .column("detachment", "unit", "smallest amount that loses a true shadow")
    .column("wins", "", "least left wrong of this map, format and filter");
    for case in sweeps {
        let shown = shown(case, all);
        for s in &shown {
            let same = |o: &&&Swept| {
                (o.size, o.format.name(), o.filter) == (s.size, s.format.name(), s.filter)
            };
            let peers: Vec<&Swept> = shown.iter().filter(same).copied().collect();
            let best = winner(&peers).is_some_and(|w| w.strategy == s.strategy);
            table.push(row(case, s, best));
        }
    }
    table
}

fn row(case: &CaseSweep, s: &Swept, best: bool) -> Vec<Cell> {
    let at = s.told();
    let gap = at.filter(|_| s.populations[1] > 0).map(|p| p.gap);
    let texel = case.texel_world * f64::from(case.own_size) / f64::from(s.size);
    vec![
        Cell::from(case.name.as_str()),
        Cell::count(s.size),
        Cell::from(s.format.name()),
        Cell::from(s.filter.name()),
        Cell::from(s.strategy.name()),
        Cell::number(s.acne_free.map(|p| f64::from(p.amount))),
        Cell::from(s.strategy.unit().name()),
        Cell::share(at.and_then(|p| s.share(p.tally.false_shadow(), 0))),
        Cell::share(at.and_then(|p| s.share(p.tally.false_light(), 1))),
        Cell::number(gap.map(|gap| gap / texel)),
        Cell::number(s.detachment.map(f64::from).filter(|b| b.is_finite())),
        Cell::from(if best { "wins" } else { "" }),
    ]
}

/// A case's table without the columns that say the same in every row, up to the strategy.
fn brief(mut table: Table) -> Table {
    for i in (0..4).rev() {
        if table.rows.windows(2).all(|pair| pair[0][i] == pair[1][i]) {
            table.columns.remove(i);
            table.rows.iter_mut().for_each(|row| drop(row.remove(i)));
        }
    }
    table
}

/// The amounts that pictures show.
const AMOUNTS: [&str; 5] = ["no bias", "a quarter", "acne ends", "its own bias", "four times"];
/// What the page appends to the id of a case.
const PARTS: [&str; 9] = [
    "strategies",
    "formats",
    "curve",
    "trade-off",
    "no-bias",
    "a-quarter",
    "acne-ends",
    "its-own-bias",
    "four-times",
];
/// Ids of the page beside those of cases.
const OWN: [&str; 4] = ["overview", "verdicts", "main", "about-run"];

/// Pictures of the own configuration along the bias axis: nothing, below, at and above the threshold.
///
/// One EXR at the case's own bias; for a list of at most two cases one of every picture.
fn multiples(
    part: &str,
    case: &Case,
    sweep: &CaseSweep,
    step: u32,
    few: bool,
) -> Option<Vec<Block>> {
    let list = own(sweep);
    let s = list.iter().find(|s| s.strategy == Strategy::Constant)?;
    let field = Field::new(case, step);
    let gallery = Gallery::new(&field, s.format, step);
    let ends = s.acne_free.map_or(case.bias, |p| p.amount);
    let amounts = [0.0, ends / 4.0, ends, case.bias, case.bias.max(ends) * 4.0];
    let picture = |(i, amount): (usize, f32)| {
        let caption = format!("{}: {amount:.3e}", AMOUNTS[i]);
        let id = format!("{part}-{}", AMOUNTS[i].replace(' ', "-"));
        let mut picture = gallery.picture(&id, Strategy::Constant, amount, caption);
        if i == 0 {
            picture.legend = Gallery::legend();
        }
        Block::Picture(picture)
    };
    let mut blocks = vec![Block::Row(amounts.into_iter().enumerate().map(picture).collect())];
    let exr = |(i, amount): (usize, f32)| {
        let id = format!("{part}-{}-layers", AMOUNTS[i].replace(' ', "-"));
        Block::Exr(gallery.exr(&id, Strategy::Constant, amount))
    };
    let chosen = amounts.into_iter().enumerate().filter(|&(i, _)| few || i == 3);
    blocks.extend(chosen.map(exr));
    Some(blocks)
}

/// Plots and pictures stand for all cases of a short list, else for at most six spread over it.
const fn is_detailed(i: usize, cases: usize) -> bool {
    i.is_multiple_of(cases.div_ceil(6))
}

/// The whole report.
#[must_use]
pub fn report(
    plan: &Plan,
    sweeps: &[CaseSweep],
    profile: Profile,
    seed: u64,
    command: String,
) -> Report {
    let all: usize = sweeps.iter().map(|c| c.swept.len()).sum();
    let unmeasured = unmeasured_cases(plan, sweeps);
    let mut overview = Section::new(
        "overview",
        "Which strategy wins",
        "One line a case, at its own map and format; every strategy is in the case's own part below.",
    );
    overview.push(verdicts::table(sweeps));
    let mut sections = vec![overview];
    let ids = slugs(plan.cases.iter().map(|case| case.name.as_str()), &OWN, &PARTS);
    for (i, ((case, sweep), id)) in plan.cases.iter().zip(sweeps).zip(&ids).enumerate() {
        let name = &case.name;
        let best = winner(&own(sweep))
            .map_or_else(|| verdicts::no_winner(sweep), |s| verdicts::sentence(sweep, s));
        let mut section = Section::new(id, name, best);
        section.push(brief(table(&format!("{id}-strategies"), slice::from_ref(sweep), all)));
        section.push(heat_map(sweep, &format!("{id}-formats")));
        if is_detailed(i, sweeps.len()) {
            let curves = curves(sweep, &format!("{id}-curve"));
            let plots = curves.into_iter().chain(trade_off(sweep, &format!("{id}-trade-off")));
            section.push(Block::Row(plots.map(Block::Plot).collect()));
            let few = sweeps.len() <= 2;
            multiples(id, case, sweep, plan.step, few)
                .into_iter()
                .flatten()
                .for_each(|block| section.push(block));
        }
        sections.push(section.folded());
    }
    let entries =
        sweeps.iter().flat_map(|c| c.swept.iter().map(move |s| (key(&c.name, s), combination(s))));
    let entries: serde_json::Map<String, Value> = entries.collect();
    Report {
        name: "sweep".into(),
        title: "Bias strategies, swept".into(),
        question: "Which bias strategy, at which amount, ends acne at the least cost, on which map and format?".into(),
        lead: lead(sweeps, &unmeasured),
        unmeasured,
        profile,
        seed,
        parameters: parameters(plan),
        command,
        sections,
        results: json!({
            "schema": "gnomon-sweep-1",
            "profile": profile,
            "seed": seed,
            "kinds": Kind::ALL,
            "max_acne": plan.max_acne,
            "combinations": entries,
        }),
        results_csv: Some(table("strategies", sweeps, all)),
        ..Report::default()
    }
}

/// What nothing was measured of, and why.
fn unmeasured_cases(plan: &Plan, sweeps: &[CaseSweep]) -> Vec<String> {
    let empty = |sweep: &CaseSweep| sweep.swept.iter().all(|s| s.populations == [0, 0]);
    let none = plan.cases.iter().zip(sweeps).filter(|(_, sweep)| empty(sweep));
    none.map(|(case, _)| unmeasured(case, plan.step)).collect()
}

fn parameters(plan: &Plan) -> BTreeMap<String, String> {
    let join = |list: Vec<String>| list.join(", ");
    let filter = |f: &Option<crate::scene::Filter>| f.map_or("own".into(), |f| f.to_string());
    BTreeMap::from([
        ("cases".into(), join(plan.cases.iter().map(|c| c.name.clone()).collect())),
        ("maps".into(), join(plan.sizes.iter().map(u32::to_string).collect())),
        ("formats".into(), join(plan.formats.iter().map(|f| f.name().to_string()).collect())),
        ("filters".into(), join(plan.filters.iter().map(filter).collect())),
        ("strategies".into(), join(plan.strategies.iter().map(|s| s.to_string()).collect())),
        ("bias".into(), format!("{:?}", plan.bias)),
        ("allowed acne".into(), plan.max_acne.to_string()),
    ])
}
