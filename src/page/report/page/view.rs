//! What the page's template reads: report blocks as strings, ready to place.

use std::collections::BTreeMap;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde::Serialize;

use crate::report::files::Figure;
use crate::report::heatmap::Shade;
use crate::report::palette::Colour;
use crate::report::{
    Block, Cell, Explorer, Finding, HeatMap, Picture, Plot, Report, Section, Table, Tile, number,
};

#[derive(Serialize)]
pub(super) struct Header {
    name: String,
    title: String,
    question: String,
    lead: Vec<String>,
    profile: &'static str,
    profile_about: String,
    seed: u64,
    parameters: Vec<(String, String)>,
    command: String,
    warnings: Vec<String>,
}

#[derive(Serialize)]
pub(super) struct SectionView {
    id: String,
    title: String,
    nav: String,
    lead: String,
    folded: bool,
    warnings: Vec<String>,
    blocks: Vec<BlockView>,
}

#[derive(Serialize)]
struct BlockView {
    id: Option<String>,
    warnings: Vec<String>,
    #[serde(flatten)]
    content: Content,
}

#[derive(Serialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
enum Content {
    Text { text: String },
    Table(TableView),
    Plot(PlotView),
    HeatMap(HeatMapView),
    Picture(PictureView),
    Gallery { tiles: Vec<TileView> },
    Row { blocks: Vec<BlockView> },
    Code { language: String, text: String },
    Findings { findings: Vec<FindingView> },
    Explorer(ExplorerView),
    Gpu { title: String, caption: String, about: String, blob: String },
    Exr { file: String, width: usize, height: usize, names: String, metadata: String },
}

#[derive(Serialize)]
struct TableView {
    caption: String,
    columns: Vec<ColumnView>,
    rows: Vec<Vec<CellView>>,
    file: String,
}

#[derive(Serialize)]
struct ColumnView {
    name: String,
    unit: String,
    help: String,
    numeric: bool,
}

#[derive(Serialize)]
struct CellView {
    kind: &'static str,
    text: String,
    /// All digits, where `text` has fewer; sorting reads it.
    exact: String,
    to: String,
    colour: String,
}

#[derive(Serialize)]
struct PlotView {
    caption: String,
    svg: String,
    file: String,
}

#[derive(Serialize)]
struct HeatMapView {
    title: String,
    caption: String,
    summary: String,
    row_name: String,
    column_name: String,
    columns: Vec<String>,
    rows: Vec<(String, Vec<Shade>)>,
    bar: (String, Vec<String>, String),
    unit: String,
    file: String,
}

#[derive(Serialize)]
struct PictureView {
    caption: String,
    alt: String,
    width: u32,
    height: u32,
    shown: u32,
    data: String,
    legend: Vec<(String, String)>,
}

#[derive(Serialize)]
struct TileView {
    to: String,
    title: String,
    text: String,
    data: String,
}

#[derive(Serialize)]
struct ExplorerView {
    title: String,
    caption: String,
    width: u32,
    height: u32,
    data: String,
    slider: String,
    value: String,
    counts: Vec<(String, String, String)>,
    about: String,
    blob: String,
}

#[derive(Serialize)]
struct FindingView {
    id: String,
    claim: String,
    verdict: &'static str,
    sentence: String,
    expression: String,
    values: Vec<(String, CellView)>,
}

pub(super) fn header(report: &Report) -> Header {
    Header {
        name: report.name.clone(),
        title: report.title.clone(),
        question: report.question.clone(),
        lead: report.lead.clone(),
        profile: report.profile.name(),
        profile_about: report.profile.about(),
        seed: report.seed,
        parameters: report.parameters.iter().map(|(k, v)| (k.clone(), v.clone())).collect(),
        command: report.command.clone(),
        warnings: warnings(report, ""),
    }
}

pub(super) fn section(
    section: &Section,
    report: &Report,
    figures: &BTreeMap<&str, Figure>,
) -> SectionView {
    let view = |block| BlockView::new(block, report, figures);
    SectionView {
        id: section.id.clone(),
        title: section.title.clone(),
        nav: if section.nav.is_empty() { &section.title } else { &section.nav }.clone(),
        lead: section.lead.clone(),
        folded: section.folded,
        warnings: warnings(report, &section.id),
        blocks: section.blocks.iter().map(view).collect(),
    }
}

fn warnings(report: &Report, id: &str) -> Vec<String> {
    report.warnings.iter().filter(|w| w.about == id).map(|w| w.text.clone()).collect()
}

impl BlockView {
    fn new(block: &Block, report: &Report, figures: &BTreeMap<&str, Figure>) -> Self {
        let figure = block.id().and_then(|id| figures.get(id));
        let id = block.id().map(ToString::to_string);
        let warnings = block.id().map(|id| warnings(report, id)).unwrap_or_default();
        let content = match (block, figure) {
            (Block::Row(blocks), _) => {
                let view = |block| Self::new(block, report, figures);
                Content::Row { blocks: blocks.iter().map(view).collect() }
            }
            (Block::Gallery(tiles), _) => Content::Gallery {
                tiles: tiles.iter().map(|tile| TileView::new(tile, figures)).collect(),
            },
            (block, Some(figure)) => with_files(block, figure),
            (block, None) => without_files(block),
        };
        Self { id, warnings, content }
    }
}

fn without_files(block: &Block) -> Content {
    match block {
        Block::Code { language, text } => {
            Content::Code { language: language.clone(), text: text.clone() }
        }
        Block::Findings(findings) => {
            Content::Findings { findings: findings.iter().map(FindingView::new).collect() }
        }
        Block::Text(text) => Content::Text { text: text.clone() },
        Block::Table(_)
        | Block::Plot(_)
        | Block::HeatMap(_)
        | Block::Picture(_)
        | Block::Gallery(_)
        | Block::Row(_)
        | Block::Exr(_)
        | Block::Explorer(_)
        | Block::Gpu(_) => unreachable!("every block with an id has a figure"),
    }
}

fn with_files(block: &Block, figure: &Figure) -> Content {
    let file = figure.files.first().map(|file| file.name.clone()).unwrap_or_default();
    match block {
        Block::Table(table) => Content::Table(TableView::new(table, file)),
        Block::Plot(plot) => Content::Plot(PlotView::new(plot, figure, file)),
        Block::HeatMap(map) => Content::HeatMap(HeatMapView::new(map, file)),
        Block::Picture(picture) => Content::Picture(PictureView::new(picture, figure)),
        Block::Explorer(explorer) => Content::Explorer(ExplorerView::new(explorer, figure)),
        Block::Gpu(panel) => Content::Gpu {
            title: panel.title.clone(),
            caption: panel.caption.clone(),
            about: figure.pack.0.clone(),
            blob: figure.pack.1.clone(),
        },
        Block::Exr(image) => Content::Exr {
            file,
            width: image.width,
            height: image.height,
            names: image.names().join(" "),
            metadata: image.metadata.to_string(),
        },
        Block::Text(_)
        | Block::Gallery(_)
        | Block::Row(_)
        | Block::Code { .. }
        | Block::Findings(_) => unreachable!("only the others have files"),
    }
}

impl TileView {
    fn new(tile: &Tile, figures: &BTreeMap<&str, Figure>) -> Self {
        let Tile { picture, to, title, text } = tile.clone();
        let figure = figures.get(picture.as_str());
        let figure = figure.unwrap_or_else(|| panic!("no picture is called '{picture}'"));
        Self { to, title, text, data: STANDARD.encode(&figure.png) }
    }
}

impl TableView {
    fn new(table: &Table, file: String) -> Self {
        let columns = table.columns.iter().enumerate().map(|(index, column)| ColumnView {
            name: column.name.clone(),
            unit: column.unit.clone(),
            help: column.help.clone(),
            numeric: table.is_numeric(index),
        });
        let rows = table.rows.iter().map(|row| row.iter().map(CellView::new).collect());
        Self {
            caption: table.caption.clone(),
            columns: columns.collect(),
            rows: rows.collect(),
            file,
        }
    }
}

impl CellView {
    fn new(cell: &Cell) -> Self {
        let (kind, to, colour) = match cell {
            Cell::Code(_) => ("code", String::new(), String::new()),
            Cell::Link { to, .. } => ("link", to.clone(), String::new()),
            Cell::Class(colour, _) => ("class", String::new(), colour.css()),
            Cell::Missing => ("missing", String::new(), String::new()),
            Cell::Text(_) => ("text", String::new(), String::new()),
            Cell::Integer(_) | Cell::Number(..) | Cell::Percent(_) => {
                ("number", String::new(), String::new())
            }
        };
        let exact = if cell.is_numeric() { cell.to_csv() } else { String::new() };
        Self { kind, text: cell.to_page(), exact, to, colour }
    }
}

impl PlotView {
    fn new(plot: &Plot, figure: &Figure, file: String) -> Self {
        let (caption, alt) = (plot.caption.clone(), plot.summary());
        Self { caption, svg: inline(&figure.svg, &alt), file }
    }
}

/// A standalone SVG as a part of a page: it scales, and it has an accessible name.
fn inline(svg: &str, alt: &str) -> String {
    let (head, body) = svg.split_once('>').unwrap_or_default();
    let view = head.split_once("viewBox=\"").map_or("", |(_, rest)| rest);
    let view = view.split('"').next().unwrap_or_default();
    let alt = alt.replace('&', "&amp;").replace('"', "&quot;").replace('<', "&lt;");
    format!("<svg role=\"img\" aria-label=\"{alt}\" viewBox=\"{view}\">{body}")
}

impl HeatMapView {
    fn new(map: &HeatMap, file: String) -> Self {
        Self {
            title: map.title.clone(),
            caption: map.caption.clone(),
            summary: map.summary(),
            row_name: map.row_name.clone(),
            column_name: map.column_name.clone(),
            columns: map.columns.clone(),
            rows: map.rows.iter().cloned().zip(map.shades()).collect(),
            bar: map.bar(),
            unit: map.unit_suffix(),
            file,
        }
    }
}

impl PictureView {
    fn new(picture: &Picture, figure: &Figure) -> Self {
        Self {
            caption: picture.caption.clone(),
            alt: picture.alt.clone(),
            width: picture.width,
            height: picture.height,
            shown: picture.width * picture.magnify.max(1),
            data: STANDARD.encode(&figure.png),
            legend: picture.legend.iter().map(|(c, t)| (Colour::css(*c), t.clone())).collect(),
        }
    }
}

impl ExplorerView {
    fn new(explorer: &Explorer, figure: &Figure) -> Self {
        let value = explorer.slider.value;
        let tally = explorer.views.first().map(|view| explorer.tally(view, value));
        let counts = explorer.classes.iter().zip(tally.unwrap_or_default().classes);
        let counts = counts.map(|(class, count)| {
            (class.colour.css(), class.name.clone(), Cell::count(count).to_page())
        });
        Self {
            title: explorer.title.clone(),
            caption: explorer.caption.clone(),
            width: explorer.width,
            height: explorer.height,
            data: STANDARD.encode(&figure.png),
            slider: explorer.slider.label.clone(),
            value: number::pretty(f64::from(value), 4),
            counts: counts.collect(),
            about: figure.pack.0.clone(),
            blob: figure.pack.1.clone(),
        }
    }
}

impl FindingView {
    fn new(finding: &Finding) -> Self {
        let values = finding.values.iter().map(|(name, cell)| (name.clone(), CellView::new(cell)));
        Self {
            id: finding.id.clone(),
            claim: finding.claim.clone(),
            verdict: finding.verdict.name(),
            sentence: finding.sentence.clone(),
            expression: finding.expression.clone(),
            values: values.collect(),
        }
    }
}
