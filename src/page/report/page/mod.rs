//! The page: one HTML file with its style, script, plots and pictures inside.

mod explorer_view;
mod view;

use std::collections::BTreeMap;

use minijinja::syntax::SyntaxConfig;
use minijinja::value::Serde;
use minijinja::{Environment, Value, context};

use super::files::{Entry, Figure};
use super::{Block, Report};

pub(super) use explorer_view::{pack, pack_panel};

const TEMPLATES: [(&str, &str); 3] = [
    ("page.html", include_str!("page.html")),
    ("block.html", include_str!("block.html")),
    ("index.html", include_str!("index.html")),
];
const STYLE: &str = include_str!("style.css");
const SCRIPT: &str = include_str!("page.js");
const PARTS: &str = include_str!("parts.js");
const EXPLORER: [&str; 3] =
    [include_str!("judge.js"), include_str!("inspect.js"), include_str!("explorer.js")];
const GPU: [&str; 3] =
    [include_str!("gpu.js"), include_str!("webgpu.js"), include_str!("panel.js")];

/// The page of `report`; `files` are the names of what lies beside it.
pub(super) fn render(report: &Report, figures: &BTreeMap<&str, Figure>, files: &[&str]) -> String {
    let sections: Vec<_> =
        report.sections.iter().map(|section| view::section(section, report, figures)).collect();
    let values = context! {
        report => Value::from(Serde(view::header(report))),
        sections => Value::from(Serde(sections)),
        files => Value::from(Serde(files)),
        style => STYLE,
        script => scripts(report),
    };
    fill("page.html", values)
}

/// The scripts that the report's blocks need; without explorer and panel that is one.
fn scripts(report: &Report) -> String {
    let explorers = report.blocks().any(|block| matches!(block, Block::Explorer(_)));
    let panels = report.blocks().any(|block| matches!(block, Block::Gpu(_)));
    let parts = (explorers || panels).then_some(PARTS);
    let explorers = EXPLORER.into_iter().filter(|_| explorers);
    let panels = GPU.into_iter().filter(|_| panels);
    std::iter::once(SCRIPT).chain(parts).chain(explorers).chain(panels).collect()
}

/// The index over several reports.
pub(super) fn render_index(entries: &[Entry]) -> String {
    let entries = Value::from(Serde(entries));
    fill("index.html", context! { entries => entries, style => STYLE })
}

fn fill(template: &str, values: Value) -> String {
    let mut environment = Environment::new();
    let trimmed = SyntaxConfig::builder().trim_blocks(true).lstrip_blocks(true).build();
    environment.set_syntax(trimmed.expect("the usual delimiters"));
    for (name, text) in TEMPLATES {
        environment.add_template(name, text).expect("the program's own templates are well formed");
    }
    let template = environment.get_template(template).expect("the template is listed");
    template.render(values).expect("the template asks only for what the page has")
}
