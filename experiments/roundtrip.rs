//! Does this pack/unpack pair lose bits, where, why, and on which hardware?

use clap::Parser;
use gnomon::analysis::roundtrip::report::{self, CertifyOptions};
use gnomon::depth::Packing;
use gnomon::depth::packing::TextPair;
use gnomon::harness::{self, Common, Progress};
use gnomon::{Error, input};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Certifies every depth packing and format in real use: largest, mean and rms error and where,
/// order, ends, unusual depths, and the bias that the loss alone forces.
#[derive(Debug, Parser)]
#[command(
    version,
    after_help = "Examples:
  gnomon-roundtrip                                 all packings, report in reports/local/roundtrip/
  gnomon-roundtrip --packing book,digits-24        two of them
  gnomon-roundtrip --exhaustive                    every f32 of [0, 1] under every store
  gnomon-roundtrip --brute --packing book          the plain loop instead of interval proofs
  gnomon-roundtrip --pair mine.toml --json -       your own pair, numbers on stdout

A pair in TOML (only base and order are required):
  base = 255.0              # ratio between neighbouring digits
  order = \"high-first\"      # or \"low-first\": where the most significant digit lives
  channels = 4              # 1 to 4
  unmasked = [3]            # digits (0 = most significant) that keep what lies below them
  upscale = 1.0             # multiplies every channel after masking (three.js r86: 1.003921568)
  offset = 0.0              # added to every channel (Aras 2007: 0.00196078)
  scales = [1, 255, 65025, 16581375]   # instead of powers of the base
  weights = [1, 3.9e-3, 1.5e-5, 6e-8]  # instead of 1/(scale * upscale)
  decode = \"dot\"            # or \"digits\": round(255 c) in base 256
  at_one = [1, 1, 1, 1]     # channels for z >= 1, in R G B A (default: no end case)
  at_zero = [0, 0, 0, 0]    # channels for z <= 0
  limit = 0.999             # z is first clamped to this
Exit codes: 0 done, 2 bad input, 4 cannot write, 130 interrupted."
)]
struct Arguments {
    /// Only these packings
    #[arg(long, value_name = "NAME,...", value_delimiter = ',')]
    packing: Vec<Packing>,
    /// Also certify your own pair
    #[arg(long, value_name = "FILE.toml")]
    pair: Option<PathBuf>,
    /// Answer for all 1,065,353,217 floats of [0, 1] under every store, FMA and both samplers
    #[arg(long)]
    exhaustive: bool,
    /// Fraction of the LINEAR filter that has a column of its own
    #[arg(long, value_name = "T", default_value_t = 0.5)]
    fraction: f32,
    /// Evaluate every float where intervals would be proved
    #[arg(long)]
    brute: bool,
    #[command(flatten)]
    common: Common,
}

fn main() -> ExitCode {
    let arguments: Arguments = harness::arguments();
    harness::run(|| {
        arguments.common.start()?;
        let options = CertifyOptions {
            profile: arguments.common.profile(),
            seed: arguments.common.seed,
            exhaustive: arguments.exhaustive,
            brute: arguments.brute,
            packings: arguments.packing,
            pair: arguments.pair.as_deref().map(read_pair).transpose()?,
            fraction: fraction(arguments.fraction)?,
        };
        let certify = || {
            let progress = Progress::new(options.steps(), "certifying");
            Ok(report::report(&options, || progress.step()))
        };
        arguments.common.publish("roundtrip", certify)?;
        Ok(())
    })
}

fn fraction(t: f32) -> gnomon::Result<f32> {
    if (0.0..=1.0).contains(&t) {
        return Ok(t);
    }
    Err(Error::bad_input(format!("--fraction {t}"), "must lie in [0, 1]", "0.5 is half way"))
}

fn read_pair(path: &Path) -> gnomon::Result<(String, TextPair)> {
    let text = input::text(path, input::SETTINGS)?;
    let stem = path.file_stem().filter(|_| path != Path::new("-"));
    let name = stem.map_or("pair".into(), |stem| stem.to_string_lossy().into_owned());
    Ok((name, TextPair::from_toml(&path.display().to_string(), &text)?))
}
