//! How much acne and peter-panning do the documents' systems have, and why?

use clap::{Parser, Subcommand};
use gnomon::analysis::documents::{self, Ask};
use gnomon::analysis::explain::explain;
use gnomon::analysis::observe::Observer;
use gnomon::device::DeviceProfile;
use gnomon::harness::{self, Common, Progress};
use gnomon::scene::cases;
use gnomon::{Error, Result};
use std::process::ExitCode;

/// Measures the shadow-map systems of five WebGL documents against a ray-traced truth and writes a
/// report: how much acne and peter-panning each has, and why.
#[derive(Debug, Parser)]
#[command(
    version,
    after_help = "Examples:
  gnomon-report                                  all cases, report in reports/local/documents/
  gnomon-report --quick --out quick/             every 4th pixel
  gnomon-report --case upc --json -              one case, numbers on stdout
  gnomon-report --scene model.glb --light-dir 1,-2,0.5 --map 1024 --bias 0.001
  gnomon-report --case terrain-100000            a standard scene: fence, foliage, room, teapot, ...
  gnomon-report --scene model.glb --map-file shadow.png --packing unorm16 --light-matrix 1,0,...
  gnomon-report --device ideal                   the same systems on correctly rounded hardware
  gnomon-report explain --case upc --pixel 200,150
Exit codes: 0 done, 2 bad input, 3 nothing was measured, 4 cannot write, 130 interrupted."
)]
struct Arguments {
    #[command(subcommand)]
    command: Option<Command>,
    #[command(flatten)]
    what: Ask,
    #[command(flatten)]
    common: Common,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Print one receiver's whole chain: coordinates, texels, all rungs, cause
    Explain {
        /// The case
        #[arg(long, value_name = "NAME")]
        case: String,
        /// Pixel from the bottom left
        #[arg(long, value_name = "X,Y", value_parser = pixel)]
        pixel: [u32; 2],
        /// Device profile instead of the case's own
        #[arg(long, value_name = "PROFILE")]
        device: Option<DeviceProfile>,
    },
}

fn pixel(text: &str) -> std::result::Result<[u32; 2], String> {
    let parsed = text
        .split_once(',')
        .and_then(|(x, y)| Some([x.trim().parse().ok()?, y.trim().parse().ok()?]));
    parsed.ok_or_else(|| format!("'{text}' is no pixel; give two whole numbers such as 200,150"))
}

fn main() -> ExitCode {
    let arguments: Arguments = harness::arguments();
    harness::run(|| match arguments.command {
        Some(Command::Explain { case, pixel, device }) => print_chain(&case, pixel, device),
        None => measure(&arguments.common, &arguments.what),
    })
}

fn measure(common: &Common, what: &Ask) -> Result<()> {
    common.start()?;
    let options = what.options(common.profile(), common.seed)?;
    let cases = options.cases()?.len();
    let measure = || {
        let progress = Progress::new(cases, "measuring");
        documents::report(&options, || progress.step())
    };
    let (report, _) = common.publish("documents", measure)?;
    report.complete()
}

fn print_chain(case: &str, [x, y]: [u32; 2], device: Option<DeviceProfile>) -> Result<()> {
    let mut case = cases::named(case)?;
    case.device = device.unwrap_or(case.device);
    let [width, height] = case.canvas;
    if x >= width || y >= height {
        return Err(Error::bad_input(
            format!("--pixel {x},{y}"),
            format!("lies outside the canvas of {width} x {height}"),
            "count from 0 at the bottom left",
        ));
    }
    let observer = Observer::new(&case, &case.device.device());
    let text = explain(&observer, x, y).ok_or_else(|| {
        Error::bad_input(
            format!("--pixel {x},{y}"),
            "is background: nothing is drawn there",
            "choose a pixel on a surface",
        )
    })?;
    harness::print(&text)
}
