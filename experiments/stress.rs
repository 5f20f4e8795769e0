//! Where does shadow mapping break numerically, and is it where theory says?

use clap::Parser;
use gnomon::Result;
use gnomon::harness::{self, Common, Progress};
use gnomon::stress::{self, document};
use std::process::ExitCode;

/// Drives one parameter after the other to its extreme (near/far ratio, distance from the origin, grazing
/// light, slivers, w ≤ 0, denormals, mediump, …) and compares where things break with a forecast that
/// was made before the run.
#[derive(Debug, Parser)]
#[command(
    version,
    after_help = "Examples:
  gnomon-stress                        all rows, report in reports/local/stress/
  gnomon-stress --quick --out quick/   an eighth of the samples
  gnomon-stress --quick --json -       the numbers on stdout
Exit codes: 0 done, 1 this machine's floating-point mode is not the default, 2 bad input,
  4 cannot write, 130 or 143 interrupted."
)]
struct Arguments {
    #[command(flatten)]
    common: Common,
}

fn main() -> ExitCode {
    let Arguments { common } = harness::arguments();
    harness::run(|| stress_all(&common))
}

fn stress_all(common: &Common) -> Result<()> {
    common.start()?;
    let options = document::StressOptions { profile: common.profile(), seed: common.seed };
    let stress = || {
        let progress = Progress::new(stress::count(), "stressing");
        Ok(document::report(&options, || progress.step()))
    };
    common.publish("stress", stress)?;
    Ok(())
}
