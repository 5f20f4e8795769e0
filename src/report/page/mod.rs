//! The page: one HTML file with its style, script, plots and pictures inside.

mod view;

use std::collections::BTreeMap;

use minijinja::syntax::SyntaxConfig;
use minijinja::value::Serde;
use minijinja::{Environment, Value, context};

use super::Report;
use super::index::Entry;
use super::write::Figure;

const TEMPLATES: [(&str, &str); 3] = [
    ("page.html", include_str!("page.html")),
    ("block.html", include_str!("block.html")),
    ("index.html", include_str!("index.html")),
];
const STYLE: &str = include_str!("style.css");
const SCRIPT: &str = include_str!("page.js");

/// The page of `report`; `files` are the names of what lies beside it.
pub(super) fn render(report: &Report, figures: &BTreeMap<&str, Figure>, files: &[&str]) -> String {
    let sections: Vec<_> =
        report.sections.iter().map(|section| view::section(section, report, figures)).collect();
    let values = context! {
        report => Value::from(Serde(view::header(report))),
        sections => Value::from(Serde(sections)),
        files => Value::from(Serde(files)),
        style => STYLE,
        script => SCRIPT,
    };
    fill("page.html", values)
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
