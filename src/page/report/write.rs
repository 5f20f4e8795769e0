//! A report as files: figures are made in parallel, then everything is published in one step.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use rayon::prelude::*;
use serde_json::json;

use super::files::Figure;
use super::{Block, Plot, Report, Size, page};
use crate::output::{self, Manifest, OutFile};
use gnomon_core::Result;

/// What was written where.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Written {
    /// The report's folder.
    pub folder: PathBuf,
    /// Every file, sorted.
    pub files: Vec<PathBuf>,
}

impl Written {
    /// The page to open.
    #[must_use]
    pub fn page(&self) -> PathBuf {
        self.folder.join("index.html")
    }
}

impl Report {
    /// Writes the whole report into `folder`: all files appear together or the old ones stay.
    /// The same report gives the same bytes.
    ///
    /// # Errors
    /// [`gnomon_core::Error::Write`] where the folder cannot be written, [`gnomon_core::Error::BadInput`]
    /// where another process holds it.
    ///
    /// # Panics
    /// Where two blocks share an id, an id is not made of `a–z 0–9 -`, or `results` has no
    /// `schema`: mistakes of the program, not of its user.
    pub fn write(&self, folder: &Path) -> Result<Written> {
        let files = output::publish(folder, &self.files())?;
        Ok(Written { folder: folder.to_path_buf(), files })
    }

    /// Every file of the report, the manifest last.
    ///
    /// # Panics
    /// As [`Report::write`].
    #[must_use]
    pub fn files(&self) -> Vec<OutFile> {
        self.check();
        let figures = self.figures();
        let mut files: Vec<_> = figures.values().flat_map(|f| f.files.iter().cloned()).collect();
        files.push(OutFile::new("results.json", pretty(&self.results)));
        files.extend(self.results_csv.iter().map(|t| OutFile::new("results.csv", t.to_csv())));
        files.push(OutFile::new("report.json", pretty(&self.summary())));
        files.sort_by(|a, b| a.name.cmp(&b.name));
        let names: Vec<_> = files.iter().map(|file| file.name.as_str()).collect();
        let page = page::render(self, &figures, &names);
        files.push(OutFile::new("index.html", page));
        let manifest = self.manifest(&files);
        files.push(manifest.to_file());
        files
    }

    fn check(&self) {
        assert!(self.results.get("schema").is_some(), "results of {} lack a schema", self.name);
        let sections = self.sections.iter().map(|section| section.id.as_str());
        let findings = self.blocks().flat_map(|block| {
            let Block::Findings(findings) = block else { return vec![] };
            findings.iter().map(|f| f.id.as_str()).collect()
        });
        let mut ids: Vec<&str> =
            sections.chain(self.blocks().filter_map(Block::id)).chain(findings).collect();
        let good = |id: &str| {
            !id.is_empty() && id.bytes().all(|b| matches!(b, b'a'..=b'z' | b'0'..=b'9' | b'-'))
        };
        if let Some(bad) = ids.iter().find(|id| !good(id)) {
            panic!("'{bad}' is no id: use a-z, 0-9 and hyphens");
        }
        ids.sort_unstable();
        if let Some(twice) = ids.windows(2).find(|pair| pair[0] == pair[1]) {
            panic!("two parts of report {} are called '{}'", self.name, twice[0]);
        }
    }

    fn figures(&self) -> BTreeMap<&str, Figure> {
        let sized = |block: &'_ Block| {
            if matches!(block, Block::Row(_)) { Size::Half } else { Size::Whole }
        };
        let blocks =
            self.sections.iter().flat_map(|section| &section.blocks).map(|b| (b, sized(b)));
        let blocks =
            blocks.flat_map(|(block, size)| block.flat().into_iter().map(move |b| (b, size)));
        let named: Vec<_> = blocks.filter_map(|(b, size)| Some((b.id()?, b, size))).collect();
        let figure = |(id, block, size): (_, &Block, _)| {
            if let (Block::Plot(plot), true) = (block, self.vectors_only) {
                return (id, vector(id, plot, size));
            }
            (id, figure(id, block, size))
        };
        named.into_par_iter().map(figure).collect()
    }

    /// What an index over reports shows.
    fn summary(&self) -> serde_json::Value {
        json!({
            "schema": "gnomon-report-1",
            "name": self.name,
            "title": self.title,
            "question": self.question,
            "lead": self.lead,
            "profile": self.profile.name(),
            "seed": self.seed,
            "parameters": self.parameters,
            "command": self.command,
        })
    }

    fn manifest(&self, files: &[OutFile]) -> Manifest {
        Manifest {
            schema: "gnomon-manifest-1".to_string(),
            tool: concat!("gnomon ", env!("CARGO_PKG_VERSION")).to_string(),
            seed: self.seed,
            parameters: self.parameters.clone(),
            inputs: self.inputs.clone(),
            outputs: files.iter().map(|f| (f.name.clone(), output::digest(&f.bytes))).collect(),
        }
    }
}

fn vector(id: &str, plot: &Plot, size: Size) -> Figure {
    let svg = plot.to_svg(size);
    let files = vec![OutFile::new(format!("plots/{id}.svg"), svg.clone())];
    Figure { svg, files, ..Figure::default() }
}

fn figure(id: &str, block: &Block, size: Size) -> Figure {
    let file = |name, bytes: Vec<u8>| OutFile { name, bytes };
    match block {
        Block::Table(table) => csv(id, table.to_csv()),
        Block::HeatMap(map) => csv(id, map.to_table().to_csv()),
        Block::Plot(plot) => {
            let (svg, png) = rayon::join(|| plot.to_svg(size), || plot.to_png(size));
            let files = vec![
                file(format!("plots/{id}.svg"), svg.clone().into_bytes()),
                file(format!("plots/{id}.png"), png),
            ];
            Figure { svg, files, ..Figure::default() }
        }
        Block::Picture(picture) => with_png(id, picture.to_png()),
        Block::Explorer(explorer) => {
            explorer.check();
            let (pack, still) = rayon::join(|| page::pack(explorer), || explorer.to_png());
            Figure { pack, ..with_png(id, still) }
        }
        Block::Gpu(panel) => Figure { pack: page::pack_panel(panel), ..Figure::default() },
        Block::Exr(image) => Figure {
            files: vec![file(format!("exr/{id}.exr"), image.to_exr())],
            ..Figure::default()
        },
        Block::Text(_)
        | Block::Row(_)
        | Block::Code { .. }
        | Block::Findings(_)
        | Block::Gallery(_) => Figure::default(),
    }
}

fn with_png(id: &str, png: Vec<u8>) -> Figure {
    let files = vec![OutFile::new(format!("pictures/{id}.png"), png.clone())];
    Figure { png, files, ..Figure::default() }
}

fn csv(id: &str, text: String) -> Figure {
    Figure { files: vec![OutFile::new(format!("tables/{id}.csv"), text)], ..Figure::default() }
}

fn pretty(value: &serde_json::Value) -> String {
    let mut text = serde_json::to_string_pretty(value).expect("a JSON value is JSON");
    text.push('\n');
    text
}
