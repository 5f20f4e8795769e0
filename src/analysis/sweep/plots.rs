//! Plots of a swept case: the trade-off with its Pareto front, the curve with its closed form, the heat
//! map of strategies and formats.

use super::results::own;
use super::tally::Kind;
use super::{CaseSweep, Point, Swept};
use crate::report::{Axis, Colour, HeatMap, Marker, Plot, Scale, Series, Style};
use crate::scene::Filter;
use crate::shadow::bias::Strategy;

/// The points of a line without those whose neighbours lie at the same height: it looks the same.
pub(in crate::analysis) fn thinned(points: impl Iterator<Item = (f64, f64)>) -> Vec<(f64, f64)> {
    let mut kept: Vec<(f64, f64)> = Vec::new();
    for point in points {
        if let [.., before, last] = kept[..]
            && before.1 == last.1
            && last.1 == point.1
        {
            kept.pop();
        }
        kept.push(point);
    }
    kept
}

/// Rates at every amount, and those that no other amount of any strategy beats on both.
/// `None` where one amount of one strategy beats all others on both axes: there is nothing to trade.
pub(super) fn trade_off(case: &CaseSweep, id: &str) -> Option<Plot> {
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
        points: thinned(s.points.iter().map(|p| rate(s, p))),
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
        caption: "Each line is a strategy, its amount growing from right to left; dots are the Pareto front: nothing else is better on both axes. Where lines coincide the last of the legend is seen.".into(),
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
pub(super) fn curves(case: &CaseSweep, id: &str) -> Option<Plot> {
    let list = own(case);
    let s = list.iter().find(|s| s.strategy == Strategy::Constant).or(list.first())?;
    let line = |name: &str, colour, style, of: &dyn Fn(&Point) -> f64| Series {
        name: name.into(),
        style,
        colour,
        points: thinned(s.points.iter().map(|p| (f64::from(p.amount), of(p)))),
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
    let mut predicted = Vec::new();
    if s.strategy == Strategy::Constant {
        mark(Some(f64::from(case.own_bias)), "its own bias", Colour::Ink);
        mark(case.known_critical, "closed form b*", Colour::Green);
        if s.filter == Filter::Nearest && s.size == case.own_size {
            let points = case.theory.iter().map(|&(b, share)| (f64::from(b), 100.0 * share));
            predicted.push(Series {
                name: "acne, closed form".into(),
                style: Style::Theory,
                colour: Colour::Green,
                points: points.collect(),
            });
        }
    }
    let mut plot = Plot {
        id: id.to_string(),
        title: format!("{}: {} bias, {} {}²", case.name, s.strategy, s.format.name(), s.size),
        caption: "Every value follows from one pass: acne falls and lost shadow grows with the bias; edge aliasing stays. Dashed: each receiver's own plane under NEAREST without quantization.".into(),
        x: Axis::log(format!("amount [{}]", s.strategy.unit())),
        y: Axis { label: "wrong receivers [%]".into(), scale: Scale::SymLog { linear: 0.1 }, ..Axis::default() },
        series: vec![
            line("false shadow", Colour::Vermilion, Style::Steps, &|p| share(p.tally.false_shadow(), lit)),
            line("of it acne", Colour::Orange, Style::Steps, &|p| share(p.tally.of(Kind::ACNE), lit)),
            line("false light", Colour::Blue, Style::Steps, &|p| share(p.tally.false_light(), shadowed)),
            line("of it peter-panning", Colour::Sky, Style::Steps, &|p| share(p.tally.of(Kind::PETER_PANNING), shadowed)),
        ],
        markers,
    };
    plot.series.extend(predicted);
    Some(plot)
}

/// False light where acne ends, strategies against formats, at the own map size.
pub(super) fn heat_map(case: &CaseSweep, id: &str) -> HeatMap {
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
