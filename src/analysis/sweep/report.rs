//! The report of a sweep: which strategy wins where, trade-offs, and what amounts look like.

use super::pictures::Gallery;
use super::tally::Kind;
use super::{CaseSweep, Field, Plan, Point, Swept, gate};
use crate::report::{
    Axis, Block, Cell, Colour, HeatMap, Marker, Plot, Profile, Report, Scale, Section, Series,
    Style, Table,
};
use crate::scene::Case;
use crate::shadow::bias::Strategy;
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// One combination as it stands in `results.json`.
#[must_use]
pub fn combination(s: &Swept) -> Value {
    let wrong = |p: &Point| p.tally.false_shadow() + p.tally.false_light();
    json!({
        "acne_free": s.acne_free.map(|p| p.amount),
        "wrong_at_acne_free": s.acne_free.as_ref().map(wrong),
        "contact_gap_world": s.acne_free.map(|p| p.gap),
        "least_wrong": s.least().map(wrong),
        "detachment": s.detachment.filter(|b| b.is_finite()),
    })
}

/// The order in which strategies win: acne-free, then the least false light, then false shadow, then the
/// smaller amount.
fn merit(s: &Swept) -> (bool, i64, i64) {
    let of = |p: Point| (false, p.tally.light, p.tally.shadow);
    s.acne_free.map_or((true, i64::MAX, i64::MAX), of)
}

/// The winner among combinations of one map, format and filter.
fn winner<'s>(list: &[&'s Swept]) -> Option<&'s Swept> {
    list.iter().copied().filter(|s| s.acne_free.is_some()).min_by_key(|s| merit(s))
}

/// Combinations at the case's own map size and format (or the first of each that was swept).
fn own(case: &CaseSweep) -> Vec<&Swept> {
    let has = |name: &str| case.swept.iter().any(|s| s.format.name() == name);
    let first = case.swept.first();
    let format =
        if has(case.own_format) { case.own_format } else { first.map_or("", |s| s.format.name()) };
    let sized = case.swept.iter().any(|s| s.size == case.own_size);
    let size = if sized { case.own_size } else { first.map_or(0, |s| s.size) };
    case.swept.iter().filter(|s| s.size == size && s.format.name() == format).collect()
}

/// Sentences on top: who wins, where nothing works.
fn lead(sweeps: &[CaseSweep]) -> Vec<String> {
    let mut wins: BTreeMap<Strategy, usize> = BTreeMap::new();
    for case in sweeps {
        if let Some(best) = winner(&own(case)) {
            *wins.entry(best.strategy).or_default() += 1;
        }
    }
    let mut ranked: Vec<_> = wins.into_iter().collect();
    ranked.sort_by_key(|&(strategy, n)| (std::cmp::Reverse(n), strategy));
    let named: Vec<String> = ranked.iter().map(|(s, n)| format!("{s} ({n})")).collect();
    let total: usize = sweeps.iter().map(|c| c.swept.len()).sum();
    let infeasible = sweeps.iter().flat_map(|c| &c.swept).filter(|s| s.acne_free.is_none()).count();
    vec![
        format!(
            "At each case's own map and format, the strategy that ends acne at the least false light: {}.",
            if named.is_empty() { "none".to_string() } else { named.join(", ") }
        ),
        format!(
            "{infeasible} of {total} combinations have no amount in the swept range that ends acne."
        ),
    ]
}

fn table(sweeps: &[CaseSweep]) -> Table {
    let total: usize = sweeps.iter().map(|c| c.swept.len()).sum();
    let mut table = Table::new(
        "strategies",
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
    .column("wins", "", "least false light of this map, format and filter");
    for case in sweeps {
        let shown = if total <= 400 { case.swept.iter().collect() } else { own(case) };
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
    let share = |n: i64, of: u64| Cell::Percent(n as f64 / of.max(1) as f64);
    let at = s.acne_free.as_ref();
    let texel = case.texel_world * f64::from(case.own_size) / f64::from(s.size);
    vec![
        Cell::from(case.name.as_str()),
        Cell::count(s.size),
        Cell::from(s.format.name()),
        Cell::from(s.filter.name()),
        Cell::from(s.strategy.name()),
        Cell::number(at.map(|p| f64::from(p.amount))),
        Cell::from(s.strategy.unit()),
        at.map_or(Cell::Missing, |p| share(p.tally.false_shadow(), s.populations[0])),
        at.map_or(Cell::Missing, |p| share(p.tally.false_light(), s.populations[1])),
        Cell::number(at.map(|p| p.gap / texel)),
        Cell::number(s.detachment.map(f64::from).filter(|b| b.is_finite())),
        Cell::from(if best { "wins" } else { "" }),
    ]
}

/// Rates at every amount, and those that no other amount of any strategy beats on both.
/// `None` where one amount of one strategy beats all others on both axes: there is nothing to trade.
fn trade_off(case: &CaseSweep, id: &str) -> Option<Plot> {
    let list = own(case);
    let rate = |s: &Swept, p: &Point| {
        let share = |n: i64, of: u64| 100.0 * n as f64 / of.max(1) as f64;
        (
            share(p.tally.false_shadow(), s.populations[0]),
            share(p.tally.false_light(), s.populations[1]),
        )
    };
    let series = |(i, s): (usize, &&Swept)| Series {
        name: s.strategy.name().to_string(),
        style: Style::Line,
        colour: Colour::series(i),
        points: s.points.iter().map(|p| rate(s, p)).collect(),
    };
    let mut all: Vec<(f64, f64)> =
        list.iter().flat_map(|s| s.points.iter().map(|p| rate(s, p))).collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let mut lowest = f64::INFINITY;
    all.retain(|&(_, y)| {
        let kept = y < lowest;
        lowest = lowest.min(y);
        kept
    });
    if all.len() < 2 {
        return None;
    }
    let mut plot = Plot {
        id: id.to_string(),
        title: format!("{}: false shadow against false light", case.name),
        caption: "Each line is a strategy, its amount growing from right to left; dots are the Pareto front: nothing else is better on both axes.".into(),
        x: Axis { label: "false shadow [% of the lit]".into(), scale: Scale::SymLog { linear: 0.1 }, ..Axis::default() },
        y: Axis { label: "false light [% of the shadowed]".into(), scale: Scale::SymLog { linear: 0.1 }, ..Axis::default() },
        series: list.iter().enumerate().map(series).collect(),
        markers: Vec::new(),
    };
    plot.series.push(Series {
        name: "Pareto front".into(),
        style: Style::Points,
        colour: Colour::Ink,
        points: all,
    });
    Some(plot)
}

/// False shadow and false light along the first strategy's amount.
fn curves(case: &CaseSweep, id: &str) -> Option<Plot> {
    let list = own(case);
    let s = list.iter().find(|s| s.strategy == Strategy::Constant).or(list.first())?;
    let line = |name: &str, colour, style, of: &dyn Fn(&Point) -> f64| Series {
        name: name.into(),
        style,
        colour,
        points: s.points.iter().map(|p| (f64::from(p.amount), of(p))).collect(),
    };
    let share = |n: i64, of: u64| 100.0 * n as f64 / of.max(1) as f64;
    let [lit, shadowed] = s.populations;
    let mut markers = Vec::new();
    let mut mark = |x: Option<f64>, label: &str, colour| {
        markers.extend(x.filter(|x| x.is_finite() && *x > 0.0).map(|x| Marker {
            x,
            label: label.into(),
            colour,
        }));
    };
    mark(s.acne_free.map(|p| f64::from(p.amount)), "acne ends", Colour::Vermilion);
    mark(s.detachment.map(f64::from), "shadows detach", Colour::Blue);
    if s.strategy == Strategy::Constant {
        mark(Some(f64::from(case.own_bias)), "its own bias", Colour::Ink);
    }
    Some(Plot {
        id: id.to_string(),
        title: format!("{}: {} bias, {} {}²", case.name, s.strategy, s.format.name(), s.size),
        caption: "Every value follows from one pass: acne falls and lost shadow grows with the bias; edge aliasing stays.".into(),
        x: Axis::log(format!("amount [{}]", s.strategy.unit())),
        y: Axis { label: "wrong receivers [%]".into(), scale: Scale::SymLog { linear: 0.1 }, ..Axis::default() },
        series: vec![
            line("false shadow", Colour::Vermilion, Style::Steps, &|p| share(p.tally.false_shadow(), lit)),
            line("of it acne", Colour::Orange, Style::Theory, &|p| share(p.tally.of(Kind::Acne), lit)),
            line("false light", Colour::Blue, Style::Steps, &|p| share(p.tally.false_light(), shadowed)),
            line("of it peter-panning", Colour::Sky, Style::Theory, &|p| share(p.tally.of(Kind::PeterPanning), shadowed)),
        ],
        markers,
    })
}

/// False light where acne ends, strategies against formats, at the own map size.
fn heat_map(case: &CaseSweep, id: &str) -> HeatMap {
    let size = own(case).first().map_or(0, |s| s.size);
    let at_size: Vec<&Swept> = case.swept.iter().filter(|s| s.size == size).collect();
    let mut rows: Vec<&str> = Vec::new();
    let mut columns: Vec<&str> = Vec::new();
    for s in &at_size {
        if !rows.contains(&s.strategy.name()) {
            rows.push(s.strategy.name());
        }
        if !columns.contains(&s.format.name()) {
            columns.push(s.format.name());
        }
    }
    let value = |row: &str, column: &str| {
        let s = at_size.iter().find(|s| s.strategy.name() == row && s.format.name() == column)?;
        Some(s.acne_free?.tally.false_light() as f64 / s.populations[1].max(1) as f64)
    };
    HeatMap {
        id: id.to_string(),
        title: format!("{}: false light where acne ends, {size}² texels", case.name),
        caption: "Share of the truly shadowed receivers that each strategy lights at its smallest acne-free amount; empty where no amount ends acne.".into(),
        row_name: "strategy".into(),
        column_name: "format".into(),
        values: rows.iter().flat_map(|r| columns.iter().map(move |c| (r, c))).map(|(r, c)| value(r, c)).collect(),
        rows: rows.iter().map(ToString::to_string).collect(),
        columns: columns.iter().map(ToString::to_string).collect(),
        scale: Scale::SymLog { linear: 0.001 },
        unit: "%".into(),
        digits: 2,
    }
}

/// Pictures of the own configuration along the bias axis: nothing, below, at and above the threshold.
fn multiples(case: &Case, sweep: &CaseSweep, step: u32) -> Option<(Block, Block)> {
    let list = own(sweep);
    let s = list.iter().find(|s| s.strategy == Strategy::Constant)?;
    let field = Field::new(case, step);
    let gallery = Gallery::new(&field, s.format, step);
    let ends = s.acne_free.map_or(case.bias, |p| p.amount);
    let amounts = [0.0, ends / 4.0, ends, case.bias, case.bias.max(ends) * 4.0];
    let labels = ["no bias", "a quarter", "acne ends", "its own bias", "four times"];
    let picture = |(i, amount): (usize, f32)| {
        let caption = format!("{}: {amount:.3e}", labels[i]);
        let id = format!("{}-{}", case.name, labels[i].replace(' ', "-"));
        let mut picture = gallery.picture(&id, Strategy::Constant, amount, caption);
        if i == 0 {
            picture.legend = Gallery::legend();
        }
        Block::Picture(picture)
    };
    let row = amounts.into_iter().enumerate().map(picture).collect();
    let exr = gallery.exr(&format!("{}-layers", case.name), Strategy::Constant, case.bias);
    Some((Block::Row(row), Block::Exr(exr)))
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
    let table = table(sweeps);
    let mut overview = Section::new("overview", "Which strategy wins", "");
    overview.push(table.clone());
    let mut sections = vec![overview];
    for (i, (case, sweep)) in plan.cases.iter().zip(sweeps).enumerate() {
        let name = &case.name;
        let best = winner(&own(sweep)).map_or_else(
            || "No strategy ends acne within the swept range.".to_string(),
            |s| format!("{} wins at its own map and format.", s.strategy),
        );
        let mut section = Section::new(name.clone(), name.clone(), best);
        section.push(heat_map(sweep, &format!("{name}-formats")));
        if is_detailed(i, sweeps.len()) {
            let curves = curves(sweep, &format!("{name}-curve"));
            let plots = curves.into_iter().chain(trade_off(sweep, &format!("{name}-trade-off")));
            section.push(Block::Row(plots.map(Block::Plot).collect()));
            if let Some((row, exr)) = multiples(case, sweep, plan.step) {
                section.push(row);
                section.push(exr);
            }
        }
        sections.push(section.folded());
    }
    let entries = sweeps
        .iter()
        .flat_map(|c| c.swept.iter().map(move |s| (gate::key(&c.name, s), combination(s))));
    let entries: serde_json::Map<String, Value> = entries.collect();
    Report {
        name: "sweep".into(),
        title: "Bias strategies, swept".into(),
        question: "Which bias strategy, at which amount, ends acne at the least cost, on which map and format?".into(),
        lead: lead(sweeps),
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
        results_csv: Some(table),
        ..Report::default()
    }
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
