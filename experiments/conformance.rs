//! Does the emulation write, bit for bit, what a real WebGL wrote?

use clap::Parser;
use gnomon::conformance::device_json::{self, MeasuredDevice};
use gnomon::conformance::{self, Compared};
use gnomon::device::{Device, DeviceProfile};
use gnomon::harness;
use gnomon::{Error, Result};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Runs the subject on every scene and section of a folder of WebGL dumps and compares each value
/// bit by bit; turns the JSON of a report's panel "Measure this GPU" into a device profile.
#[derive(Debug, Parser)]
#[command(
    version,
    after_help = "Examples:
  gnomon-conformance dumps/                      the emulated WebGL against its dumps
  gnomon-conformance dumps/ --allow-missing      listed files that are not there are only reported
  gnomon-conformance dumps/ --device ideal       where an ideal device differs
  gnomon-conformance --device phone.json         a measured GPU beside the known profiles
  gnomon-conformance dumps/ --device phone.json  and where it differs from the dumps
  gnomon-conformance dumps/ --json -             everything as JSON
Exit codes: 0 nothing differs, 1 something differs, 2 nothing to compare or a listed file is missing."
)]
struct Arguments {
    /// Folder with scenes/, encodings/, depth/, raster/, filter/, arith/, unorm/, polyoffset.json
    #[arg(required_unless_present = "device")]
    folder: Option<PathBuf>,
    /// Report listed files that are missing, but do not fail on them
    #[arg(long)]
    allow_missing: bool,
    /// The device under test: a known profile, or a JSON file that a report's panel copied
    #[arg(long, value_name = "PROFILE|FILE.json")]
    device: Option<String>,
    /// Also write the outcome as JSON here; `-` prints it instead of the table
    #[arg(long, value_name = "PATH")]
    json: Option<PathBuf>,
}

fn main() -> ExitCode {
    let arguments: Arguments = harness::arguments();
    harness::run(|| check(&arguments))
}

/// A known profile, or one that was measured.
enum Subject {
    Known(DeviceProfile),
    Measured(Box<MeasuredDevice>),
}

impl Subject {
    fn of(text: &str) -> Result<Self> {
        let path = Path::new(text);
        let known = text.parse().map(Self::Known);
        match known.is_err() && path.exists()
            || path.is_file()
            || text.ends_with(".json")
            || text == "-"
        {
            true => Ok(Self::Measured(Box::new(device_json::read(path)?))),
            false => known,
        }
    }

    fn device(&self) -> Device {
        match self {
            Self::Known(profile) => profile.device(),
            Self::Measured(measured) => measured.device,
        }
    }
}

fn check(arguments: &Arguments) -> Result<()> {
    let subject = Subject::of(arguments.device.as_deref().unwrap_or("webgl-swiftshader"))?;
    let compare = |folder: &PathBuf| conformance::compare(folder, &subject.device());
    let outcome = arguments.folder.as_ref().map(compare).transpose()?;
    harness::check_follows(true);
    if outcome.is_none() && matches!(subject, Subject::Known(_)) {
        let fix = "give a folder of dumps, or a JSON file as --device";
        return Err(Error::bad_input("DIR", "is missing", fix));
    }
    let json = json(&subject, outcome.as_ref());
    if let Some(path) = &arguments.json {
        harness::write_json(path, &json)?;
    }
    if arguments.json.as_deref() != Some(Path::new("-")) {
        print(&subject, outcome.as_ref())?;
    }
    let place = arguments.folder.as_deref().unwrap_or(Path::new("")).display().to_string();
    outcome.map_or(Ok(()), |outcome| outcome.verdict(&place, arguments.allow_missing))
}

fn json(subject: &Subject, outcome: Option<&Compared>) -> serde_json::Value {
    let entries = outcome.map(|outcome| &outcome.entries[..]).unwrap_or_default();
    let mut json = serde_json::json!({ "schema": "gnomon-conformance-1", "entries": entries });
    if let Subject::Measured(measured) = subject {
        json["device"] = measured.to_json();
    }
    json
}

fn print(subject: &Subject, outcome: Option<&Compared>) -> Result<()> {
    if let Subject::Measured(measured) = subject {
        harness::print_table(&measured.table())?;
        harness::print(&format!("\n{}\n\n", measured.notes().join("\n")))?;
    }
    let Some(outcome) = outcome else { return Ok(()) };
    harness::print_table(&outcome.table())?;
    harness::print(&format!(
        "\n{} values compared, {} differing, {} listed files missing\n",
        outcome.compared(""),
        outcome.differing(""),
        outcome.missing()
    ))
}
