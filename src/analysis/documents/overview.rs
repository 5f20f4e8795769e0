//! The top of the page: which bias each system has and needs, what remains, which knob to turn.

use crate::analysis::formats;
use crate::analysis::ladder::Rung;
use crate::analysis::measurement::{Measurement, half_measured};
use crate::analysis::outside::named;
use crate::report::number::percent;
use crate::report::{
    Axis, Block, Cell, Colour, Finding, HeatMap, Plot, Scale, Section, Series, Style, Table, Tile,
    Verdict,
};

crate::catalogue! {
    /// Where a system's own bias stands against what its scene needs.
    pub enum Fit {
        /// From the critical bias up to the detachment bias.
        Inside = "inside the window",
        /// Below the critical bias: acne remains.
        TooSmall = "too small",
        /// From the detachment bias on: shadows come off.
        TooLarge = "too large",
        /// Detachment comes before the end of acne: every constant bias leaves artifacts.
        NoWindow = "no window",
        /// From the critical bias up; no shadow was seen that could come off.
        Enough = "enough, no shadow seen",
        /// What would decide was not seen.
        NotMeasured = "not measured",
    }
}

impl Fit {
    /// Reads it off a measured case.
    #[must_use]
    pub fn of(m: &Measurement) -> Self {
        let critical = m.thresholds.critical.unwrap_or(f32::NEG_INFINITY);
        let detachment = m.thresholds.detachment.unwrap_or(f32::INFINITY);
        if m.lit + m.shadowed == 0 {
            Self::NotMeasured
        } else if critical >= detachment {
            Self::NoWindow
        } else if m.bias < critical {
            Self::TooSmall
        } else if m.bias >= detachment {
            Self::TooLarge
        } else if m.lit == 0 {
            Self::NotMeasured
        } else if m.shadowed == 0 {
            Self::Enough
        } else {
            Self::Inside
        }
    }

    const fn colour(self) -> Colour {
        match self {
            Self::Inside | Self::Enough => Colour::Green,
            Self::TooSmall => Colour::Vermilion,
            Self::TooLarge => Colour::Blue,
            Self::NoWindow => Colour::Purple,
            Self::NotMeasured => Colour::Grey,
        }
    }
}

/// What to change where a rung causes most of the wrong verdicts.
const fn knob(cause: Rung) -> &'static str {
    match cause {
        Rung::Culling => "drawing both faces of the casters into the map",
        Rung::Bias => "a smaller bias",
        Rung::Sampling => "a larger or tighter map, or a bias that follows the slope",
        Rung::Arithmetic => "a tighter near and far plane",
        Rung::Quantization => "a sound depth format",
        Rung::Filter => "comparing before averaging",
    }
}

/// Wrong receivers of both kinds by cause.
fn by_cause(m: &Measurement) -> [u64; Rung::ALL.len()] {
    let of = |r: &Rung| m.false_shadow.by_cause[r] + m.false_light.by_cause[r];
    std::array::from_fn(|i| of(&Rung::ALL[i]))
}

/// The most frequent cause and its count; `None` where nothing is wrong.
fn main_cause(counts: [u64; Rung::ALL.len()]) -> Option<(Rung, u64)> {
    let largest = *counts.iter().max()?;
    let at = counts.iter().position(|&n| n == largest && n > 0)?;
    Some((Rung::ALL[at], largest))
}

/// The verdict: which bias, what remains, which knob.
pub(super) fn lead(measurements: &[Measurement], findings: &[Finding]) -> Vec<String> {
    let documents: Vec<_> = measurements.iter().filter(|m| m.facts.is_empty()).collect();
    let mut lead = first_lines(measurements);
    lead.extend(unmeasured(measurements).iter().map(|why| format!("{why}.")));
    let half = |m: &&Measurement| {
        let missing = half_measured([m.lit, m.shadowed])?;
        Some(format!("{}: {missing}.", m.name))
    };
    lead.extend(documents.iter().filter_map(half));
    lead.push(fits(&documents));
    lead.extend(worst(&documents));
    let mut counts = [0; Rung::ALL.len()];
    for m in &documents {
        counts.iter_mut().zip(by_cause(m)).for_each(|(sum, n)| *sum += n);
    }
    if let Some((cause, n)) = main_cause(counts) {
        let share = percent(n as f64 / counts.iter().sum::<u64>() as f64, 3);
        lead.push(format!(
            "Which knob: {cause} causes {share} of all wrong verdicts; {} is what helps there.",
            knob(cause)
        ));
    }
    if !findings.is_empty() {
        let of = |v: Verdict| findings.iter().filter(|f| f.verdict == v).count();
        lead.push(format!(
            "{} of {} claims about the documents are borne out by these numbers, {} contradicted, {} undecided.",
            of(Verdict::Supported),
            findings.len(),
            of(Verdict::Contradicted),
            of(Verdict::Undecided),
        ));
    }
    lead
}

/// What comes before all else; of several cases each with its name.
fn first_lines(measurements: &[Measurement]) -> Vec<String> {
    let of = |m: &Measurement| named(measurements.len(), &m.name, &m.first_lines);
    measurements.iter().flat_map(of).collect()
}

/// What nothing was measured of, and why.
pub(super) fn unmeasured(measurements: &[Measurement]) -> Vec<String> {
    let none = measurements.iter().filter(|m| m.lit + m.shadowed == 0);
    none.map(|m| format!("{}: {}", m.name, m.samples.unmeasured())).collect()
}

/// One sentence: how the biases of all systems fit their scenes.
fn fits(documents: &[&Measurement]) -> String {
    let part = |fit: &Fit| {
        let named: Vec<_> =
            documents.iter().filter(|m| Fit::of(m) == *fit).map(|m| m.name.as_str()).collect();
        (!named.is_empty()).then(|| match fit {
            Fit::Inside => format!("inside the scene's window for {}", named.len()),
            Fit::TooSmall => format!("too small for {}", named.join(", ")),
            Fit::TooLarge => format!("too large for {}", named.join(", ")),
            Fit::NoWindow => format!(
                "useless for {}, where no constant bias is free of both acne and peter-panning",
                named.join(", ")
            ),
            Fit::Enough => {
                format!("enough for {}, where no shadow was seen", named.join(", "))
            }
            Fit::NotMeasured => format!("not measured for {}", named.join(", ")),
        })
    };
    let parts: Vec<_> = Fit::ALL.iter().filter_map(part).collect();
    let systems = if documents.len() == 1 { "system" } else { "systems" };
    format!("Which bias: of {} {systems} it is {}.", documents.len(), parts.join("; "))
}

/// The largest error rates.
fn worst(documents: &[&Measurement]) -> Option<String> {
    let largest = |rate: fn(&Measurement) -> Option<f64>| {
        let rate = |m: &Measurement| rate(m).unwrap_or(0.0);
        let found = documents.iter().max_by(|a, b| rate(a).total_cmp(&rate(b)))?;
        (rate(found) > 0.0).then(|| format!("{} ({})", percent(rate(found), 3), found.name))
    };
    let shadow = largest(|m| m.false_shadow.rate);
    let shadow = shadow.map(|rate| format!("false shadow on up to {rate} of the lit"));
    let light = largest(|m| m.false_light.rate);
    let light = light.map(|rate| format!("false light on up to {rate} of the shadowed"));
    let parts: Vec<_> = shadow.into_iter().chain(light).collect();
    (!parts.is_empty())
        .then(|| format!("What remains at the systems' own biases: {}.", parts.join(", ")))
}

/// The biases of heat maps: positions in [`formats::biases`] and values; 0, then two a decade from 10⁻⁵.
pub(super) fn columns() -> Vec<(usize, f32)> {
    let all: Vec<_> = formats::biases().into_iter().enumerate().collect();
    let zero = all.iter().take(1);
    zero.chain(all.iter().skip(41).step_by(10)).copied().collect()
}

/// A heat map of wrong receivers over [`columns`]; rows are names with the share at each.
pub(super) fn heat_map(
    id: &str,
    title: &str,
    row_name: &str,
    rows: Vec<(String, Vec<Option<f64>>)>,
) -> HeatMap {
    let label = |(_, b): (usize, f32)| crate::report::number::pretty(f64::from(b), 2);
    let (names, values): (Vec<_>, Vec<_>) = rows.into_iter().unzip();
    HeatMap {
        id: id.to_string(),
        title: title.to_string(),
        caption: "Share of the counted receivers whose verdict is wrong, either way; a dark band \
                  between two bright ends is the window of usable biases."
            .to_string(),
        row_name: row_name.to_string(),
        column_name: "constant bias [window depth]".to_string(),
        rows: names,
        columns: columns().into_iter().map(label).collect(),
        values: values.concat(),
        scale: Scale::SymLog { linear: 0.001 },
        unit: "%".to_string(),
        digits: 2,
    }
}

/// The section on top: every case at a glance.
pub(super) fn section(
    measurements: &[Measurement],
    ids: &[String],
    wrong: Vec<Vec<Option<f64>>>,
) -> Section {
    let mut section = Section::new("overview", "All cases", "");
    section.push(Block::Gallery(measurements.iter().zip(ids).map(tile).collect()));
    section.push(windows(measurements));
    let rows = measurements.iter().map(|m| m.name.clone()).zip(wrong).collect();
    section.push(heat_map("cases-bias", "Wrong verdicts, case by bias", "case", rows));
    section.push(table(measurements, ids));
    section
}

/// A rate for a tile.
fn rate(rate: Option<f64>) -> String {
    rate.map_or_else(|| "not measured".to_string(), |rate| percent(rate, 2))
}

fn tile((m, id): (&Measurement, &String)) -> Tile {
    Tile {
        picture: format!("{id}-classes"),
        to: format!("#{id}"),
        title: m.name.clone(),
        text: format!(
            "{}: false shadow {}, false light {}",
            Fit::of(m),
            rate(m.false_shadow.rate),
            rate(m.false_light.rate)
        ),
    }
}

/// For every case the biases that are free of acne and of peter-panning.
fn windows(measurements: &[Measurement]) -> Plot {
    let lowest = |b: Option<f32>| f64::from(b.unwrap_or(0.0)).max(0.0);
    let highest = |b: Option<f32>| b.map_or(1.0, f64::from);
    let rows: Vec<_> = measurements.iter().rev().enumerate().collect();
    let measured = rows.iter().filter(|(_, m)| Fit::of(m) != Fit::NotMeasured);
    let bars = |fits: bool| {
        let kept = measured.clone().filter(move |(_, m)| (Fit::of(m) != Fit::NoWindow) == fits);
        let ends = |(i, m): &(usize, &Measurement)| {
            let ends = [lowest(m.thresholds.critical), highest(m.thresholds.detachment)];
            [(ends[0], *i as f64), (ends[1], *i as f64), (f64::NAN, f64::NAN)]
        };
        kept.flat_map(ends).collect()
    };
    let own = measured.clone().map(|(i, m)| (f64::from(m.bias), *i as f64)).collect();
    let series =
        |name: &str, style, colour, points| Series { name: name.into(), style, colour, points };
    Plot {
        id: "windows".to_string(),
        title: "The window of usable constant biases".to_string(),
        caption: "Green: from the end of acne to the first shadow that comes off. Purple: the ends \
                  have changed places, so every constant bias leaves acne, peter-panning or both. Dot: \
                  the system's own bias."
            .to_string(),
        x: Axis { range: None, ..Axis::log("constant bias [window depth]") },
        y: Axis::named(rows.iter().map(|(_, m)| m.name.clone()).collect()),
        series: vec![
            series("free of acne and peter-panning", Style::Bar, Colour::Green, bars(true)),
            series("no window", Style::Bar, Colour::Purple, bars(false)),
            series("its own bias", Style::Points, Colour::Ink, own),
        ],
        markers: Vec::new(),
    }
}

/// What a reader asks first, case by case.
fn table(measurements: &[Measurement], ids: &[String]) -> Table {
    let mut table = Table::new("cases", "Every case at its own bias, against the ray-traced truth")
        .column("case", "", "")
        .column("own bias", "window depth", "")
        .column("needed", "window depth", "critical bias: from it on no acne is left")
        .column("at most", "window depth", "detachment bias: from it on shadows come off")
        .column("its bias is", "", "own bias against these two")
        .column("false shadow", "", "share of the truly lit receivers")
        .column("false light", "", "share of the truly shadowed receivers")
        .column("cause", "", "rung of the ladder that causes most wrong verdicts");
    for (m, id) in measurements.iter().zip(ids) {
        let depth = |b: Option<f32>| b.map_or(Cell::Missing, |b| Cell::Number(b.into(), 3));
        let fit = Fit::of(m);
        table.push(vec![
            Cell::Link { text: m.name.clone(), to: format!("#{id}") },
            depth(Some(m.bias)),
            depth(m.thresholds.critical),
            depth(m.thresholds.detachment),
            Cell::Class(fit.colour(), fit.name().to_string()),
            Cell::share(m.false_shadow.rate),
            Cell::share(m.false_light.rate),
            main_cause(by_cause(m)).map_or(Cell::Missing, |(cause, _)| cause.name().into()),
        ]);
    }
    table
}

/// `results.csv`: the numbers of every case.
pub(super) fn numbers(measurements: &[Measurement]) -> Table {
    let mut table =
        Table::new("results", "Every case at its own bias, against the ray-traced truth")
            .column("case", "", "")
            .column("format", "", "")
            .column("map", "texels", "")
            .column("bias", "window depth", "")
            .column("lit", "receivers", "")
            .column("false shadow", "", "")
            .column("shadowed", "receivers", "")
            .column("false light", "", "")
            .column("ambiguous", "receivers", "")
            .column("critical bias", "window depth", "")
            .column("detachment bias", "window depth", "")
            .column("peter-panning", "world units", "");
    for m in measurements {
        let depth = |b: Option<f32>| Cell::number(b.map(f64::from));
        table.push(vec![
            m.name.as_str().into(),
            m.format.into(),
            Cell::count(m.map_size),
            Cell::Number(f64::from(m.bias), 4),
            Cell::count(m.lit),
            Cell::share(m.false_shadow.rate),
            Cell::count(m.shadowed),
            Cell::share(m.false_light.rate),
            Cell::count(m.samples.ambiguous),
            depth(m.thresholds.critical),
            depth(m.thresholds.detachment),
            Cell::number(m.peter_panning.map(|l| l.world)),
        ]);
    }
    table
}
