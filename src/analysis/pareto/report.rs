//! The benchmark as a report: fronts, plots, and the toolkit's own algorithms. No times.

use super::algorithms::Way;
use super::{Combination, STRATEGIES};
use crate::analysis::measure::unmeasured;
use crate::analysis::sweep::Plan;
use crate::report::number::percent;
use crate::report::slug::slugs;
use crate::report::{
    Axis, Block, Cell, Colour, Plot, Profile, Report, Scale, Section, Series, Style, Table,
};
use crate::shadow::bias::Strategy;
use serde_json::json;
use std::collections::BTreeMap;

/// Ids of the page beside those of cases.
const OWN: [&str; 4] = ["method", "strategy-operations", "main", "about-run"];
/// What the page appends to the id of a case.
const PARTS: [&str; 5] = ["bytes", "operations", "front", "algorithms", "ways"];

/// The report of a plan's entries and of the toolkit's own ways on one case.
#[must_use]
pub fn report(
    plan: &Plan,
    entries: &[Combination],
    ways: &[(String, Vec<Way>)],
    profile: Profile,
    seed: u64,
) -> Report {
    let mut sections = Vec::new();
    let ids = slugs(plan.cases.iter().map(|case| case.name.as_str()), &OWN, &PARTS);
    for (case, id) in plan.cases.iter().zip(&ids) {
        let own: Vec<&Combination> = entries.iter().filter(|e| e.case == case.name).collect();
        sections.push(front(id, &case.name, &own));
    }
    for ((case, ways), id) in ways.iter().zip(&ids) {
        sections.push(algorithms(id, case, ways));
    }
    sections.push(method());
    let none = plan.cases.iter().filter(|case| entries.iter().all(|e| e.case != case.name));
    let unmeasured: Vec<String> = none.map(|case| unmeasured(case, plan.step)).collect();
    let names: Vec<&str> = plan.cases.iter().map(|c| c.name.as_str()).collect();
    let ways_json: Vec<_> =
        ways.iter().map(|(case, ways)| json!({ "case": case, "ways": ways })).collect();
    Report {
        name: "pareto".into(),
        title: "Run time against error".into(),
        question: "Which format, map size, filter and bias are worth their cost?".into(),
        lead: unmeasured
            .iter()
            .map(|why| format!("{why}."))
            .chain(lead(plan, entries, ways))
            .collect(),
        unmeasured,
        profile,
        seed,
        parameters: BTreeMap::from([
            ("cases".into(), names.join(", ")),
            ("max acne".into(), plan.max_acne.to_string()),
        ]),
        command: format!("gnomon-pareto --{profile}"),
        sections,
        results: json!({
            "schema": "gnomon-pareto-1", "profile": profile, "seed": seed,
            "entries": entries, "algorithms": ways_json,
        }),
        results_csv: Some(table("combinations", "Every combination", entries.iter())),
        ..Report::default()
    }
}

fn lead(plan: &Plan, entries: &[Combination], ways: &[(String, Vec<Way>)]) -> Vec<String> {
    let mut lead = Vec::new();
    for case in &plan.cases {
        let own = || entries.iter().filter(|e| e.case == case.name);
        let Some(best) = own().min_by(|a, b| a.wrong().total_cmp(&b.wrong())) else { continue };
        let cheap = own().filter(|e| e.wrong() <= 1.1 * best.wrong() + 1e-4);
        let Some(cheap) = cheap.min_by_key(|e| (e.cost.operations, e.cost.map_bytes)) else {
            continue;
        };
        lead.push(format!(
            "{}: {} of {} combinations are on the front; the least wrong visibility is {} ({}); within a tenth of that the least operations a look-up are {} ({}).",
            case.name,
            own().filter(|e| e.front).count(),
            own().count(),
            percent(best.wrong(), 3),
            words(best),
            cheap.cost.operations,
            words(cheap),
        ));
    }
    let different = |f32: bool| -> u64 {
        let all = ways.iter().flat_map(|(_, ways)| ways);
        let kind = all.filter(|w| w.error.is_none() && w.way.contains("f32") == f32);
        kind.map(|w| w.different).sum()
    };
    lead.push(format!(
        "Truth by plain f32 rays differs from the exact one on {} receivers; the irregular z-buffer and every skip on {}.",
        different(true),
        different(false),
    ));
    lead
}

fn words(e: &Combination) -> String {
    format!("{} {}², {}, {}", e.format.name(), e.size, e.filter, e.strategy)
}

/// One case: the plots and the members of its front.
fn front(id: &str, case: &str, own: &[&Combination]) -> Section {
    let lead = "Each point is one combination at the smallest bias that ends its acne.";
    let mut section = Section::new(id, case, lead);
    let bytes = |e: &Combination| e.cost.map_bytes as f64;
    let operations = |e: &Combination| f64::from(e.cost.operations);
    section.push(Block::Row(vec![
        plot([id, case], "bytes", "bytes of the map", own, bytes).into(),
        plot([id, case], "operations", "operations a look-up", own, operations).into(),
    ]));
    let caption = "The front: nothing is at most as costly and as wrong in everything, and better in something";
    let members = own.iter().copied().filter(|e| e.front);
    section.push(table(&format!("{id}-front"), caption, members));
    section
}

/// Wrong visibility over one cost, a colour for each strategy, and the least wrong up to each cost.
fn plot(
    [id, case]: [&str; 2],
    part: &str,
    label: &str,
    own: &[&Combination],
    cost: impl Fn(&Combination) -> f64,
) -> Plot {
    let place = |e: &&Combination| (cost(e), 100.0 * e.wrong());
    let mut strategies: Vec<Strategy> = own.iter().map(|e| e.strategy).collect();
    strategies.sort_by_key(|strategy| STRATEGIES.iter().position(|s| s == strategy));
    strategies.dedup();
    let series = |(i, strategy): (usize, &Strategy)| Series {
        name: strategy.to_string(),
        style: Style::Points,
        colour: Colour::series(i),
        points: own.iter().filter(|e| e.strategy == *strategy).map(place).collect(),
    };
    let mut all: Vec<Series> = strategies.iter().enumerate().map(series).collect();
    let least = Series {
        name: "least wrong up to this cost".to_string(),
        style: Style::Steps,
        colour: Colour::Ink,
        points: least(own.iter().map(place).collect()),
    };
    all.insert(0, least);
    Plot {
        id: format!("{id}-{part}"),
        title: format!("{case}: wrong visibility over {label}"),
        caption: format!(
            "Points low and on the left are good; the line is the front over {label} alone."
        ),
        x: Axis::log(label),
        y: Axis {
            label: "false shadow + false light [%]".into(),
            scale: Scale::SymLog { linear: 0.1 },
            ..Axis::default()
        },
        series: all,
        markers: Vec::new(),
    }
}

/// The least value up to each position.
fn least(mut points: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    points.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let Some(last) = points.last().map(|p| p.0) else { return points };
    let mut lowest = f64::INFINITY;
    points.retain(|p| {
        let lower = p.1 < lowest;
        lowest = lowest.min(p.1);
        lower
    });
    points.push((last, lowest));
    points
}

fn table<'e>(id: &str, caption: &str, entries: impl Iterator<Item = &'e Combination>) -> Table {
    let mut table = Table::new(id, caption)
        .column("case", "", "")
        .column("format", "", "")
        .column("map", "texels", "texels per side")
        .column("filter", "", "")
        .column("strategy", "", "")
        .column("amount", "", "of the strategy's parameter, in its own unit")
        .column("acne ends", "", "whether acne is within the limit there")
        .column("map", "bytes", "")
        .column("passes", "", "over the casters")
        .column("fetches", "texels", "a look-up")
        .column("operations", "", "arithmetic operations of a look-up")
        .column("false shadow", "", "light that the truly lit lose: mean of 1 - visibility")
        .column("false light", "", "light that the truly shadowed get: mean visibility")
        .column("peter-panning", "world units", "longest way inside the true shadow")
        .column("front", "", "nothing is better in everything");
    for e in entries {
        let yes = |b: bool| Cell::from(if b { "yes" } else { "no" });
        table.push(vec![
            e.case.as_str().into(),
            e.format.name().into(),
            Cell::count(e.size),
            e.filter.name().into(),
            e.strategy.name().into(),
            Cell::Number(f64::from(e.amount), 3),
            e.acne_free.map_or(Cell::Missing, yes),
            Cell::count(e.cost.map_bytes),
            Cell::count(e.cost.passes),
            Cell::count(e.cost.fetches),
            Cell::count(e.cost.operations),
            Cell::share(e.errors.false_shadow),
            Cell::share(e.errors.false_light),
            Cell::Number(e.errors.peter_panning, 3),
            yes(e.front),
        ]);
    }
    table
}

/// The toolkit's own algorithms on one case.
fn algorithms(id: &str, case: &str, ways: &[Way]) -> Section {
    let mut table = Table::new(format!("{id}-algorithms"), "Ways to the same answers")
        .column("job", "", "")
        .column("way", "", "")
        .column("answered", "", "answers given: receivers, pairs of caster and receiver, or floats")
        .column("evaluated", "", "worked out one by one")
        .column("different", "", "answers that differ from the arbiter's")
        .column("error found", "window depth", "the largest, where the answer is a number");
    for w in ways {
        table.push(vec![
            w.job.into(),
            w.way.into(),
            Cell::count(w.answered),
            Cell::count(w.evaluated),
            Cell::count(w.different),
            Cell::number(w.error),
        ]);
    }
    let title = format!("The toolkit's own algorithms, on {case}");
    let lead =
        "What each works out, and what it gets wrong against its arbiter; --times adds seconds.";
    let mut section = Section::new(format!("{id}-ways"), title, lead);
    section.push(table);
    section
}

fn method() -> Section {
    let mut section = Section::new("method", "How costs are counted", "").folded();
    for text in [
        "Map bytes: texels times the bytes of one in graphics memory (unorm24 takes 4, packings are \
         RGBA8). Passes: 2 where the two nearest surfaces are needed.",
        "Operations of a look-up, after the projection that all share: one for each scalar addition, \
         subtraction, multiplication, division, comparison, minimum, maximum, floor, rounding or \
         derivative. Per comparison: two for its coordinates (unless it is the only one), one for the \
         bias, one to compare, and the packing's unpack, counted by running it. Filters add their \
         average and, where bilinear, 13 for fractions and interpolation. Strategies add their own.",
        "Errors are means of |visibility - truth|, so that a soft edge counts by how soft it is. They are \
         those at the smallest amount from which acne stays within the limit; where there is none, at \
         the amount with the fewest wrong verdicts.",
    ] {
        section.push(text);
    }
    let mut own = Table::new("strategy-operations", "Operations of strategies at the receiver")
        .column("strategy", "", "")
        .column("a look-up", "", "")
        .column("a comparison", "", "");
    for &strategy in Strategy::ALL {
        let [once, each] = super::cost::strategy_operations(strategy);
        own.push(vec![strategy.name().into(), Cell::count(once), Cell::count(each)]);
    }
    section.push(own);
    section
}
