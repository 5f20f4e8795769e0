//! Which format, map size, filter and bias strategy are worth their cost?
use clap::Parser;
use gnomon::analysis::pareto::{self, algorithms, report::report, time};
use gnomon::analysis::sweep::{Plan, Range, gate, plan};
use gnomon::harness::{Common, Progress, arguments, print, run, write_json};
use gnomon::scene::Filter;
use gnomon::shadow::bias::Strategy;
use gnomon::{Error, Result};
use std::path::PathBuf;
use std::process::ExitCode;

/// Sets what a shadow map costs (bytes, passes, fetches, operations) against what is left wrong with it,
/// over formats, map sizes, filters and bias strategies, and marks the Pareto front. Times of this
/// machine are printed and written with --times, never into the report.
///
/// Examples:
///   gnomon-pareto --quick
///   gnomon-pareto --case terrain-100000 --map 1024,2048,4096 --format unorm16,f32
///   gnomon-pareto --case staircase --times times.json
#[derive(Parser)]
#[command(name = "gnomon-pareto", version, verbatim_doc_comment)]
struct Args {
    /// Cases: names, `documents` or `all`
    #[arg(long, value_delimiter = ',', default_value = "staircase")]
    case: Vec<String>,
    /// Map sizes in texels per side
    #[arg(long, value_delimiter = ',', default_value = "512,1024")]
    map: Vec<u32>,
    /// Depth formats and packings
    #[arg(long, value_delimiter = ',', default_value = "unorm16,f32,digits-24")]
    format: Vec<String>,
    /// Filters
    #[arg(long, value_delimiter = ',', default_values_t = pareto::FILTERS)]
    filter: Vec<Filter>,
    /// Strategies
    #[arg(long, value_delimiter = ',', default_values_t = pareto::STRATEGIES)]
    strategy: Vec<Strategy>,
    /// Acne that counts as none, as a share of the truly lit
    #[arg(long, default_value = "0.1%")]
    max_acne: String,
    /// Measure times too: print them and write them to this JSON file, outside the report's folder
    #[arg(long, value_name = "FILE")]
    times: Option<PathBuf>,
    #[command(flatten)]
    common: Common,
}

fn main() -> ExitCode {
    let args: Args = arguments();
    run(move || body(&args))
}

fn body(args: &Args) -> Result<()> {
    args.common.start()?;
    let step = if args.common.quick { 4 } else { 1 };
    let plan = Plan {
        cases: plan::cases_named(&args.case)?,
        sizes: args.map.clone(),
        formats: args.format.iter().map(|f| plan::format_named(f)).collect::<Result<_>>()?,
        filters: args.filter.iter().copied().map(Some).collect(),
        strategies: args.strategy.clone(),
        bias: Range { low: 1e-6, high: 1e-1, log: true, count: 100 },
        step,
        max_acne: gate::share(&args.max_acne)?,
    }
    .checked()?;
    let folder = args.common.folder("pareto");
    if args.times.as_ref().is_some_and(|file| file.starts_with(&folder)) {
        let fix = "name a file elsewhere";
        return Err(Error::bad_input("--times", "lies in the report's folder", fix));
    }
    let (profile, seed) = (args.common.profile(), args.common.seed);
    let mut times: Vec<_> = Vec::new();
    let measure = || {
        let bar = Progress::new(plan.cases.len() * plan.sizes.len(), "sweeping");
        let entries = pareto::entries(&plan, || bar.step());
        let ways: Vec<_> =
            plan.cases.iter().map(|c| (c.name.clone(), algorithms::ways(c, step))).collect();
        if args.times.is_some() {
            let timed = plan.cases.iter().zip(&ways);
            times.extend(timed.map(|(c, (_, w))| time::times(c, &args.filter, w)));
        }
        Ok(report(&plan, &entries, &ways, profile, seed))
    };
    let (report, _) = args.common.publish("pareto", measure)?;
    if let Some(path) = &args.times {
        let written = times.iter().try_for_each(|times| print(&time::text(times)));
        let written = written.and_then(|()| write_json(path, &times));
        written.map_err(|e| e.having_written("the report"))?;
    }
    report.complete()
}
