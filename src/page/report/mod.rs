//! The report as plain data: what an experiment found, before any file is written.
//!
//! Experiments fill a [`Report`]; [`Report::write`] turns it into one self-contained page and the
//! files behind it. Nothing here knows what is measured. Texts are plain text, never HTML.

mod blob;
pub mod explorer;
mod exr;
mod files;
pub mod gpu;
mod heatmap;
mod image;
mod index;
pub mod number;
mod page;
pub mod palette;
mod plot;
pub mod slug;
mod table;
mod write;

use std::collections::BTreeMap;

pub use explorer::Explorer;
pub use exr::ExrImage;
pub use gpu::GpuPanel;
pub use heatmap::HeatMap;
pub use image::Picture;
pub use index::write_index;
pub use palette::Colour;
pub use plot::{Axis, Marker, Plot, Scale, Series, Size, Style};
pub use table::{Cell, Column, Table};
pub use write::Written;

gnomon_core::catalogue! {
    /// How much of the work was done.
    pub enum Profile {
        /// All cases and parameters on every fourth pixel in x and y.
        Quick = "quick",
        /// Every pixel.
        Full = "full",
    }
}

gnomon_core::catalogue! {
    /// What the numbers say about a claim.
    pub enum Verdict {
        /// The numbers bear the claim out.
        Supported = "supported",
        /// The numbers contradict the claim.
        Contradicted = "contradicted",
        /// The run did not measure what the claim needs.
        Undecided = "undecided",
    }
}

/// Everything an experiment found and how to find it again.
#[derive(Clone, Debug, Default)]
pub struct Report {
    /// Short name in lower case with hyphens; the report's folder is usually called so.
    pub name: String,
    /// Heading of the page.
    pub title: String,
    /// The question that the experiment answers.
    pub question: String,
    /// The verdict: the few sentences that stand on top.
    pub lead: Vec<String>,
    /// Quick or full.
    pub profile: Profile,
    /// Seed of every random choice.
    pub seed: u64,
    /// Parameters, given and defaulted.
    pub parameters: BTreeMap<String, String>,
    /// SHA-256 of each input file by name; goes to the manifest.
    pub inputs: BTreeMap<String, String>,
    /// The command that makes this report again.
    pub command: String,
    /// The page, top to bottom.
    pub sections: Vec<Section>,
    /// The body of `results.json`: an object with a `schema` member.
    pub results: serde_json::Value,
    /// The body of `results.csv`.
    pub results_csv: Option<Table>,
    /// Caveats, shown beside what they qualify.
    pub warnings: Vec<Warning>,
    /// Plots as SVG files alone, without a PNG each: for reports of many plots.
    pub vectors_only: bool,
    /// What nothing was measured of, why, and what to change: a sentence each, without its full stop.
    pub unmeasured: Vec<String>,
}

/// A part of the page with a heading of its own.
#[derive(Clone, Debug, Default)]
pub struct Section {
    /// Anchor: lower case, digits, hyphens; unique in the report.
    pub id: String,
    /// Heading.
    pub title: String,
    /// What the contents call it; the heading where empty.
    pub nav: String,
    /// One or two sentences under the heading; may be empty.
    pub lead: String,
    /// Content, top to bottom.
    pub blocks: Vec<Block>,
    /// Closed until the reader opens it (method, definitions, per-case pages).
    pub folded: bool,
}

/// A piece of content.
#[derive(Clone, Debug)]
pub enum Block {
    /// A paragraph.
    Text(String),
    /// A table, and its CSV file.
    Table(Table),
    /// A plot, as SVG and PNG.
    Plot(Plot),
    /// A coloured table of numbers, and its CSV file.
    HeatMap(HeatMap),
    /// A picture, as PNG.
    Picture(Picture),
    /// Pictures of the report side by side, small, each leading to its part.
    Gallery(Vec<Tile>),
    /// Blocks side by side where the page is wide enough.
    Row(Vec<Self>),
    /// Preformatted text with a button that copies it.
    Code {
        /// What it is written in, for the accessible name: `shell`, `GLSL`, `JSON`.
        language: String,
        /// The text.
        text: String,
    },
    /// Claims and what the numbers say about them.
    Findings(Vec<Finding>),
    /// An image of measured values for viewers outside, linked from the page.
    Exr(ExrImage),
    /// A picture whose classes follow a slider.
    Explorer(Explorer),
    /// Shaders that the reader runs on their own GPU.
    Gpu(GpuPanel),
}

/// A picture of the report shown again, small, as the way to a part of the page.
#[derive(Clone, Debug)]
pub struct Tile {
    /// Id of a [`Picture`] of the same report.
    pub picture: String,
    /// Where it leads: `#id`.
    pub to: String,
    /// Its name.
    pub title: String,
    /// One short line.
    pub text: String,
}

/// A claim, the numbers and the sentence that follows from them.
#[derive(Clone, Debug)]
pub struct Finding {
    /// Anchor; unique in the report.
    pub id: String,
    /// What is claimed, and where ("Programming Guide, ch. 10: …").
    pub claim: String,
    /// What the numbers say.
    pub verdict: Verdict,
    /// The measured statement with its numbers.
    pub sentence: String,
    /// The expression over `results.json` that decides.
    pub expression: String,
    /// The values that went into it, by name.
    pub values: Vec<(String, Cell)>,
}

/// A caveat.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Warning {
    /// The id of the section or block it qualifies; empty for the whole report.
    pub about: String,
    /// One sentence.
    pub text: String,
}

#[allow(clippy::derivable_impls, reason = "a catalogue's members carry names, not attributes")]
impl Default for Profile {
    fn default() -> Self {
        Self::Full
    }
}

impl Section {
    /// An open section.
    pub fn new(id: impl Into<String>, title: impl Into<String>, lead: impl Into<String>) -> Self {
        let (id, title, lead) = (id.into(), title.into(), lead.into());
        Self { id, title, lead, ..Self::default() }
    }

    /// This section under another name in the contents.
    #[must_use]
    pub fn called(self, nav: impl Into<String>) -> Self {
        Self { nav: nav.into(), ..self }
    }

    /// This section, closed until opened.
    #[must_use]
    pub fn folded(self) -> Self {
        Self { folded: true, ..self }
    }

    /// Adds a block at the end.
    pub fn push(&mut self, block: impl Into<Block>) {
        self.blocks.push(block.into());
    }
}

impl Block {
    /// The block's own id, where it has one.
    #[must_use]
    pub fn id(&self) -> Option<&str> {
        match self {
            Self::Table(table) => Some(&table.id),
            Self::Plot(plot) => Some(&plot.id),
            Self::HeatMap(map) => Some(&map.id),
            Self::Picture(picture) => Some(&picture.id),
            Self::Exr(image) => Some(&image.id),
            Self::Explorer(explorer) => Some(&explorer.id),
            Self::Gpu(panel) => Some(&panel.id),
            Self::Text(_)
            | Self::Row(_)
            | Self::Code { .. }
            | Self::Findings(_)
            | Self::Gallery(_) => None,
        }
    }

    /// The block and all blocks inside it, in page order.
    #[must_use]
    pub fn flat(&self) -> Vec<&Self> {
        let Self::Row(blocks) = self else { return vec![self] };
        blocks.iter().flat_map(Self::flat).collect()
    }
}

macro_rules! block_from {
    ($($Kind:ident),+) => {
        $(impl From<$Kind> for Block {
            fn from(block: $Kind) -> Self { Self::$Kind(block) }
        })+
    };
}
block_from!(Table, Plot, HeatMap, Picture, Explorer);

impl From<ExrImage> for Block {
    fn from(image: ExrImage) -> Self {
        Self::Exr(image)
    }
}

impl From<GpuPanel> for Block {
    fn from(panel: GpuPanel) -> Self {
        Self::Gpu(panel)
    }
}

impl From<&str> for Block {
    fn from(text: &str) -> Self {
        Self::Text(text.to_string())
    }
}

impl From<String> for Block {
    fn from(text: String) -> Self {
        Self::Text(text)
    }
}

impl From<Vec<Finding>> for Block {
    fn from(findings: Vec<Finding>) -> Self {
        Self::Findings(findings)
    }
}

impl Report {
    /// Whether everything was measured; call once the report is written and its gates are judged.
    ///
    /// # Errors
    /// [`gnomon_core::Error::Partial`] where nothing was measured of something.
    pub fn complete(&self) -> gnomon_core::Result<()> {
        match self.unmeasured.as_slice() {
            [] => Ok(()),
            list => Err(gnomon_core::Error::Partial(list.join("; "))),
        }
    }

    /// Every block of the report, rows opened, in page order.
    pub fn blocks(&self) -> impl Iterator<Item = &Block> {
        self.sections.iter().flat_map(|section| &section.blocks).flat_map(Block::flat)
    }

    /// Every plain table of the report in page order, heat maps among them.
    #[must_use]
    pub fn tables(&self) -> Vec<Table> {
        self.blocks()
            .filter_map(|block| match block {
                Block::Table(table) => Some(table.clone()),
                Block::HeatMap(map) => Some(map.to_table()),
                Block::Text(_)
                | Block::Plot(_)
                | Block::Picture(_)
                | Block::Gallery(_)
                | Block::Row(_)
                | Block::Code { .. }
                | Block::Findings(_)
                | Block::Exr(_)
                | Block::Explorer(_)
                | Block::Gpu(_) => None,
            })
            .collect()
    }
}
