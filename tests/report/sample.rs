//! A report with awkward data: zeros on log axes, a single point, equal values, eight series, long
//! labels, markers that collide.

use gnomon::report::{
    Axis, Block, Cell, Colour, ExrImage, Finding, HeatMap, Marker, Picture, Plot, Report, Scale,
    Section, Series, Style, Table, Tile, Verdict, Warning,
};
use serde_json::json;

/// Every kind of block, each with data that is hard to show.
pub(crate) fn report() -> Report {
    Report {
        name: "sample".into(),
        title: "Which bias does the sample need?".into(),
        question: "Does a page survive <awkward> & 'quoted' data?".into(),
        lead: vec![
            "book-r8-y7 needs a constant bias of 0.0021 and has 0.4 % false light left.".into(),
            "No constant bias is free of artifacts at book-r8-y40: headroom −0.0016.".into(),
        ],
        seed: 7,
        parameters: [("bias".to_string(), "1e-7:1e-2:log:25".to_string())].into(),
        command: "cargo run --release -- --quick --out reports/documents".into(),
        sections: vec![explorers(), curves(), tables(), pictures(), text().folded()],
        results: json!({"schema": "gnomon-sample-1", "cases": [{"name": "a", "rate": 0.1}]}),
        results_csv: Some(table()),
        warnings: vec![
            Warning { about: String::new(), text: "Assumes the plane is slanted by 45°.".into() },
            Warning { about: "rates".into(), text: "12 ambiguous samples are left out.".into() },
        ],
        ..Report::default()
    }
}

fn series(name: &str, style: Style, colour: Colour, points: Vec<(f64, f64)>) -> Series {
    Series { name: name.into(), style, colour, points }
}

/// False shadow and false light over the bias, with zeros on both axes.
pub(crate) fn trade_off() -> Plot {
    let biases: Vec<f64> = (0..=60).map(|i| 1e-7 * 10_f64.powf(f64::from(i) / 10.0)).collect();
    let falling = |b: f64| if b > 3e-3 { 0.0 } else { 0.3 / (1.0 + b * 3e4) };
    let rising = |b: f64| if b < 2e-5 { 0.0 } else { b * 8.0 };
    let with_zero = |f: &dyn Fn(f64) -> f64| {
        [(0.0, f(0.0))].into_iter().chain(biases.iter().map(|b| (*b, f(*b)))).collect()
    };
    Plot {
        id: "trade-off".into(),
        title: "Trade-off at book-rgba8-y7".into(),
        caption: "False shadow falls and false light rises with the constant bias.".into(),
        x: Axis::log("constant bias [window depth]"),
        y: Axis::log("share of judged samples"),
        series: vec![
            series("false shadow", Style::Steps, Colour::Vermilion, with_zero(&falling)),
            series("false light", Style::Steps, Colour::Blue, with_zero(&rising)),
            series(
                "theory: ½ s ‖g‖₁",
                Style::Theory,
                Colour::Ink,
                vec![(1e-7, 0.3), (1e-3, 1e-4), (1e-1, 1e-9)],
            ),
        ],
        markers: vec![
            marker(0.0015, "document's bias 0.0015", Colour::Ink),
            marker(0.0021, "critical bias 0.0021", Colour::Vermilion),
            marker(0.003, "detachment 0.003", Colour::Blue),
            marker(0.095, "last one, near the right end of the axis", Colour::Purple),
        ],
    }
}

fn marker(x: f64, label: &str, colour: Colour) -> Marker {
    Marker { x, label: label.into(), colour }
}

fn small(id: &str, title: &str, y: Scale, points: Vec<(f64, f64)>) -> Plot {
    Plot {
        id: id.into(),
        title: title.into(),
        caption: format!("{title}."),
        x: Axis::linear("distance [world length]"),
        y: Axis { label: "error [codes]".into(), scale: y, ..Axis::default() },
        series: vec![series("measured", Style::Line, Colour::Green, points)],
        markers: vec![],
    }
}

/// Eight series, two with names longer than the figure is wide.
pub(crate) fn eight() -> Plot {
    let name = |i: usize| match i {
        2 => "a name that goes on about rounding, truncation and the admissible set ".repeat(3),
        5 => "constant bias with 3×3 PCF and receiver-plane bias, reversed depth".to_string(),
        _ => format!("format {i}"),
    };
    let points = |i: usize| {
        (0..200).map(move |x| {
            let x = f64::from(x) / 20.0;
            (x, (x * (1.0 + i as f64 / 3.0)).sin() * 10_f64.powi(i as i32 - 4))
        })
    };
    Plot {
        id: "eight".into(),
        title: "Signed error of eight formats".into(),
        caption: "Values of both signs over eight decades.".into(),
        x: Axis { range: Some((2.0, 8.0)), ..Axis::linear("distance [world length]") },
        y: Axis {
            label: "stored − exact [window depth]".into(),
            scale: Scale::SymLog { linear: 1e-4 },
            ..Axis::default()
        },
        series: (0..8)
            .map(|i| {
                let style = if i == 7 { Style::Points } else { Style::Line };
                series(&name(i), style, Colour::series(i), points(i).collect())
            })
            .collect(),
        markers: vec![],
    }
}

fn curves() -> Section {
    let mut section = Section::new("curves", "Curves", "Each plot has awkward data.");
    section.push(windows());
    section.push(trade_off());
    section.push(eight());
    section.push(Block::Row(vec![
        small("single", "A single point", Scale::Log, vec![(3.0, 2e-6)]).into(),
        small("equal", "All values equal", Scale::Linear, vec![(0.0, 5.0), (1.0, 5.0), (2.0, 5.0)])
            .into(),
    ]));
    section.push(Block::Row(vec![
        small("zeros", "Only zeros", Scale::Log, vec![(0.0, 0.0), (1.0, 0.0)]).into(),
        small("gap", "A gap, and 262144 points", Scale::Linear, dense()).into(),
    ]));
    section.push(Block::Row(vec![
        small("narrow", "Less than a decade", Scale::Log, vec![(0.0, 2.2), (1.0, 3.1)]).into(),
        small("empty", "Nothing measured", Scale::Log, vec![]).into(),
    ]));
    section
}

fn dense() -> Vec<(f64, f64)> {
    let value = |i: i32| {
        let x = f64::from(i) / 1000.0;
        let y = if (100_000..120_000).contains(&i) { f64::NAN } else { 1e5 + (x * 0.2).sin() };
        (x, y)
    };
    (0..262_144).map(value).collect()
}

/// A table with every kind of cell.
pub(crate) fn table() -> Table {
    let mut table = Table::new("rates", "Rates per case.")
        .column("case", "", "The scene and its light.")
        .column("class", "", "")
        .column("samples", "", "Judged receivers.")
        .column("false shadow", "%", "Truth lit, map says shadowed.")
        .column("critical bias", "window depth", "The largest breakpoint of truly lit samples.")
        .column("reproduce", "", "");
    let row = |name: &str, count: i64, rate: f64, bias: Option<f64>| {
        vec![
            Cell::Link { text: name.into(), to: "#method".into() },
            Cell::Class(Colour::Vermilion, "acne".into()),
            Cell::Integer(count),
            Cell::Percent(rate),
            Cell::number(bias),
            Cell::Code(format!("gnomon-report explain --case {name} --pixel 3,4")),
        ]
    };
    table.push(row("book-r8-y7", 160_000, 0.1234, Some(0.003_456_7)));
    table.push(row("a|b \"quoted\", comma", 12, 1e-7, None));
    table.push(row("upc", 4_194_304, 0.0, Some(1.2e-9)));
    table
}

fn tables() -> Section {
    let mut section = Section::new("tables", "Tables and heat maps", "");
    section.push(table());
    section.push(HeatMap {
        id: "heat".into(),
        title: "False shadow by format and bias".into(),
        caption: "The darker, the less.".into(),
        row_name: "format".into(),
        column_name: "bias [window depth]".into(),
        rows: ["r8", "unorm24", "f16"].map(String::from).to_vec(),
        columns: ["0", "10⁻⁵", "10⁻³"].map(String::from).to_vec(),
        values: vec![
            Some(0.5),
            Some(0.01),
            Some(0.0),
            Some(1e-5),
            None,
            Some(2e-3),
            Some(0.9),
            Some(f64::NAN),
            Some(1.0),
        ],
        scale: Scale::Log,
        unit: "%".into(),
        digits: 3,
    });
    section.push(vec![
        finding("f-gap", Verdict::Supported, "The gap 0.00345 is below the bias 0.005."),
        finding("f-bits", Verdict::Contradicted, "R has 255 steps, not 256."),
        finding("f-open", Verdict::Undecided, "No mediump device was measured."),
    ]);
    section
}

fn finding(id: &str, verdict: Verdict, sentence: &str) -> Finding {
    Finding {
        id: id.into(),
        claim: "Programming Guide, ch. 10: the shadow vanishes because R has 8 bits.".into(),
        verdict,
        sentence: sentence.into(),
        expression: "cases[book-r8-y40].gap < cases[book-r8-y40].bias".into(),
        values: vec![("gap".into(), Cell::Number(0.003_45, 3)), ("bias".into(), Cell::Missing)],
    }
}

/// A disc of classes on a grey ground.
pub(crate) fn picture(id: &str) -> Picture {
    let (width, height) = (64_u32, 48_u32);
    let pixel = |i: u32| {
        let (x, y) = (f64::from(i % width) - 32.0, f64::from(i / width) - 24.0);
        let inside = x * x + y * y < 300.0;
        let colour = match (inside, x < 0.0) {
            (true, true) => Colour::Vermilion,
            (true, false) => Colour::Blue,
            _ => Colour::Light,
        };
        colour.rgb()
    };
    Picture {
        id: id.into(),
        caption: "Acne left, peter-panning right.".into(),
        alt: "A disc, its left half acne, its right half peter-panning.".into(),
        width,
        height,
        rgb: (0..width * height).flat_map(pixel).collect(),
        legend: vec![
            (Colour::Vermilion, "acne".into()),
            (Colour::Blue, "peter-panning".into()),
            (Colour::Light, "agrees".into()),
        ],
        magnify: 6,
    }
}

/// Values that only a bit-exact file keeps: NaN with payload, −0, denormals, infinities.
pub(crate) fn exr() -> ExrImage {
    let special = [f32::NAN, -0.0, 1e-45, f32::INFINITY, f32::MIN_POSITIVE, 0.1];
    let (width, height) = (37, 21);
    let values = |salt: usize| -> Vec<f32> {
        let mut values: Vec<f32> =
            (0..width * height).map(|i| (i * 31 + salt) as f32 / 7.0).collect();
        values[..special.len()].copy_from_slice(&special);
        values[special.len()] = f32::from_bits(0x7fc0_1234);
        values
    };
    let names = ["R", "G", "B", "margin.Y", "depth.stored.Z", "cause.Y"];
    ExrImage {
        id: "exr-sample".into(),
        width,
        height,
        channels: names.iter().enumerate().map(|(i, n)| (n.to_string(), values(i))).collect(),
        metadata: json!({"schema": "gnomon-exr-1", "class": {"0": "lit", "1": "acne"}}),
    }
}

/// A picture as the way to a section.
fn tile(picture: &str) -> Tile {
    Tile {
        picture: picture.into(),
        to: "#tables".into(),
        title: format!("{picture}, small"),
        text: "leads to the tables".into(),
    }
}

/// Ranges of two categories; the second has none.
fn windows() -> Plot {
    let points = vec![(1e-4, 0.0), (1e-2, 0.0), (f64::NAN, f64::NAN)];
    let series = Series { name: "usable".into(), style: Style::Bar, colour: Colour::Green, points };
    Plot {
        id: "windows".into(),
        title: "Usable biases".into(),
        x: Axis::log("bias [window depth]"),
        y: Axis::named(vec!["plane".into(), "fence".into()]),
        series: vec![series],
        ..Plot::default()
    }
}

fn pictures() -> Section {
    let mut section = Section::new("pictures", "Pictures", "Same colours everywhere.");
    section.push(Block::Row(vec![picture("classes").into(), picture("shaded").into()]));
    section.push(Block::Gallery(vec![tile("classes"), tile("shaded")]));
    section.push(exr());
    section
}

fn explorers() -> Section {
    let mut section = Section::new("drag", "Drag the bias", "Every mask is exact at every f32.");
    section.push(crate::explored::explorer("small", (96, 80)));
    section.push(crate::measured::panel());
    section
}

fn text() -> Section {
    let mut section = Section::new("method", "Method", "How it was measured.");
    section.push("Breakpoints are f32; every <tag> here is text & stays text.");
    section.push(Block::Code { language: "GLSL".into(), text: "if (z > D + b) lit = 0.0;".into() });
    section
}
