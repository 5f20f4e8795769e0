//! Does the emulation write, bit for bit, what a real WebGL wrote?

use clap::Parser;
use gnomon::conformance::{self, Outcome};
use gnomon::device::DeviceProfile;
use gnomon::harness;
use gnomon::report::{Cell, Column, Table};
use gnomon::{Error, Result};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Runs the subject on every scene and section of a folder of WebGL dumps and compares each value
/// bit by bit.
#[derive(Debug, Parser)]
#[command(
    version,
    after_help = "Examples:
  gnomon-conformance dumps/                      the emulated WebGL against its dumps
  gnomon-conformance dumps/ --allow-missing      listed files that are not there are only reported
  gnomon-conformance dumps/ --device ideal       where an ideal device differs
  gnomon-conformance dumps/ --json -             everything as JSON
Exit codes: 0 nothing differs, 1 something differs, 2 nothing to compare or a listed file is missing."
)]
struct Arguments {
    /// Folder with scenes/, encodings/, depth/, raster/, filter/, arith/, unorm/, polyoffset.json
    folder: PathBuf,
    /// Report listed files that are missing, but do not fail on them
    #[arg(long)]
    allow_missing: bool,
    /// The device profile under test
    #[arg(long, value_name = "PROFILE", default_value = "webgl-swiftshader")]
    device: DeviceProfile,
    /// Also write the outcome as JSON here; `-` prints it instead of the table
    #[arg(long, value_name = "PATH")]
    json: Option<PathBuf>,
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    harness::run(|| check(&arguments))
}

fn check(arguments: &Arguments) -> Result<()> {
    let outcome = conformance::compare(&arguments.folder, &arguments.device.device())?;
    let json = serde_json::json!({ "schema": "gnomon-conformance-1", "entries": outcome.entries });
    match &arguments.json {
        Some(path) if path == Path::new("-") => harness::print(&format!("{json:#}\n"))?,
        Some(path) => harness::write_json(path, &json)?,
        None => {}
    }
    if arguments.json.as_deref() != Some(Path::new("-")) {
        harness::print_table(&table(&outcome))?;
        harness::print(&summary(&outcome))?;
    }
    verdict(arguments, &outcome)
}

fn table(outcome: &Outcome) -> Table {
    let column = |name: &str| Column { name: name.to_string(), ..Column::default() };
    let row = |e: &conformance::Entry| {
        let state = if e.missing { "missing" } else { e.first.as_deref().unwrap_or("equal") };
        vec![
            e.section.as_str().into(),
            e.file.as_str().into(),
            Cell::count(e.compared),
            Cell::count(e.differing),
            state.into(),
        ]
    };
    Table {
        id: "conformance".to_string(),
        caption: String::new(),
        columns: ["section", "file", "compared", "differing", "first difference"]
            .map(column)
            .into(),
        rows: outcome.entries.iter().map(row).collect(),
    }
}

fn summary(outcome: &Outcome) -> String {
    format!(
        "\n{} values compared, {} differing, {} listed files missing\n",
        outcome.compared(""),
        outcome.differing(""),
        outcome.missing()
    )
}

fn verdict(arguments: &Arguments, outcome: &Outcome) -> Result<()> {
    let place = arguments.folder.display().to_string();
    if outcome.differing("") > 0 {
        let first = outcome.entries.iter().find(|e| e.differing > 0);
        let what = first.map_or_else(String::new, |e| {
            format!("{}/{} {}", e.section, e.file, e.first.as_deref().unwrap_or_default())
        });
        return Err(Error::CheckFailed(format!(
            "{} values differ, first {what}",
            outcome.differing("")
        )));
    }
    let empty = outcome.sections().into_iter().find(|s| outcome.compared(s) == 0);
    if outcome.missing() > 0 && !arguments.allow_missing {
        let reason = format!("{} listed files are missing", outcome.missing());
        return Err(Error::bad_input(place, reason, "add them, or pass --allow-missing"));
    }
    match empty {
        Some(section) if !arguments.allow_missing => Err(Error::bad_input(
            format!("{place}: {section}"),
            "nothing was compared",
            "add its files, or pass --allow-missing",
        )),
        _ if outcome.compared("") == 0 => {
            Err(Error::bad_input(place, "nothing was compared", "give a folder of dumps"))
        }
        _ => Ok(()),
    }
}
