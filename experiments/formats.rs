//! What do 8, 16, 24 and 32 bits of depth cost, plain and reversed, on each of the documents' scenes?
use clap::Parser;
use gnomon::Result;
use gnomon::analysis::formats;
use gnomon::analysis::sweep::plan;
use gnomon::harness::{Common, Progress, arguments, run};
use std::process::ExitCode;

/// Compares R8, the book's RGBA8, a sound RGBA8, unorm16, unorm24, f16 and f32 depth, plain and
/// reversed: the bias each needs, the acne at the document's own, contact gaps, and the size of a step.
///
/// Examples:
///   gnomon-formats --quick
///   gnomon-formats --case book-rgba8-y7 --json -
#[derive(Parser)]
#[command(name = "gnomon-formats", version, verbatim_doc_comment)]
struct Args {
    /// Cases: names, `documents` or `all`
    #[arg(long, value_delimiter = ',', default_value = "documents")]
    case: Vec<String>,
    #[command(flatten)]
    common: Common,
}

fn main() -> ExitCode {
    let args: Args = arguments();
    run(move || body(&args))
}

fn body(args: &Args) -> Result<()> {
    args.common.start()?;
    let cases = plan::cases_named(&args.case)?;
    let measure = || {
        let bar = Progress::new(cases.len(), "measuring");
        Ok(formats::report(&cases, args.common.profile(), args.common.seed, || bar.step()))
    };
    args.common.publish("formats", measure)?.0.complete()
}
