//! Which bias strategy, at which amount, ends acne at the least cost, on which map and format?
use clap::Parser;
use gnomon::analysis::effort::EffortArguments;
use gnomon::analysis::sweep::{self, CaseSweep, Plan, Range, gate, plan, shard};
use gnomon::harness::{Common, Division, Job, arguments, check_follows, print, run};
use gnomon::shadow::bias::Strategy;
use gnomon::{Error, Result};
use serde_json::Value;
use std::{path::PathBuf, process::ExitCode};

/// Sweeps bias strategies over cases, map sizes, formats and filters: exact counts of acne, lost shadow
/// and every other artifact along each strategy's parameter.
///
/// Examples:
///   gnomon-sweep --quick
///   gnomon-sweep --case book-r8-y7 --map 256,512 --format unorm16,f32 --bias 1e-7:1e-2:log:200
///   gnomon-sweep --case upc --strategy constant --bias 0.001 --fail-acne 0.1%
///   gnomon-sweep --case exam-pcf --baseline old/results.json
///   gnomon-sweep --scene room.glb --light-dir 1,-2,0.5 --map 1024,2048 --format unorm16,f32
///   gnomon-sweep --shard 3/8 --out parts    (and, once all 8 are there: gnomon-sweep --merge parts)
#[derive(Parser)]
#[command(name = "gnomon-sweep", version, verbatim_doc_comment)]
struct Args {
    /// Cases: names, `documents` or `all`
    #[arg(long, value_delimiter = ',', default_value = "documents", conflicts_with = "scene")]
    case: Vec<String>,
    #[command(flatten)]
    scene: gnomon::scene_file::SceneFile,
    /// Map sizes in texels per side
    #[arg(long, value_delimiter = ',', default_value = "256,512,1024,2048")]
    map: Vec<u32>,
    /// Depth formats and packings
    #[arg(long, value_delimiter = ',', default_value = "r8,book,unorm16,unorm24,f16,f32")]
    format: Vec<String>,
    /// Filters; `own` is the case's
    #[arg(long, value_delimiter = ',', default_value = "own")]
    filter: Vec<String>,
    /// Strategies
    #[arg(
        long,
        value_delimiter = ',',
        default_value = "constant,slope-raster,receiver-slope,\
normal-offset,receiver-plane,adaptive,front-culling,midpoint"
    )]
    strategy: Vec<Strategy>,
    /// Amounts in window depth, lo:hi:log:n or one value; other units take ranges of their own
    #[arg(long, default_value = "1e-6:1e-1:log:200")]
    bias: String,
    /// Acne that counts as none, as a share of the truly lit
    #[arg(long, default_value = "0")]
    max_acne: String,
    /// Exit with 1 where no amount keeps acne within this share
    #[arg(long, value_name = "SHARE")]
    fail_acne: Option<String>,
    /// Exit with 1 where no amount keeps contact gaps within this length (2texels, or world units)
    #[arg(long, value_name = "LENGTH")]
    fail_peter_panning: Option<gate::LengthLimit>,
    /// Exit with 1 where a combination is worse than in this results.json
    #[arg(long, value_name = "PATH")]
    baseline: Option<PathBuf>,
    #[command(flatten)]
    division: Division,
    #[command(flatten)]
    effort: EffortArguments,
    #[command(flatten)]
    common: Common,
}
fn main() -> ExitCode {
    let args: Args = arguments();
    run(move || body(&args))
}

fn body(args: &Args) -> Result<()> {
    args.common.start()?;
    let plan = Plan {
        cases: match args.scene.cases()? {
            own if own.is_empty() => plan::cases_named(&args.case)?,
            own => own,
        },
        sizes: args.map.clone(),
        formats: args.format.iter().map(|f| plan::format_named(f)).collect::<Result<_>>()?,
        filters: args.filter.iter().map(|f| plan::filter_named(f)).collect::<Result<_>>()?,
        strategies: args.strategy.clone(),
        bias: args.bias.parse::<Range>()?,
        step: if args.common.quick { 4 } else { 1 },
        max_acne: gate::share(&args.max_acne)?,
    }
    .checked()?;
    let limits = gate::Limits {
        acne: args.fail_acne.as_deref().map(gate::share).transpose()?,
        peter_panning: args.fail_peter_panning,
    };
    let baseline = args.baseline.as_deref().map(gate::baseline).transpose()?;
    check_follows(baseline.is_some() || limits.acne.is_some() || limits.peter_panning.is_some());
    let job = Job { name: "sweep", key: shard::key(&plan), items: shard::items(&plan) };
    let mut worker = shard::Worker::new(&plan, args.effort.effort());
    let compute = |item| worker.compute(item);
    let Some(mut done) = args.division.run(&args.common, &job, compute)? else { return Ok(()) };
    let sweeps = shard::assemble(&plan, std::mem::take(&mut done.results));
    let (profile, seed) = (args.common.profile(), args.common.seed);
    let command = Common::command("gnomon-sweep");
    let mut report = sweep::report::report(&plan, &sweeps, profile, seed, command);
    report.warnings.extend(done.warnings());
    args.common.finish(&report)?;
    done.close()?;
    judge(&sweeps, &limits, baseline.as_ref()).and_then(|()| report.complete())
}

fn judge(sweeps: &[CaseSweep], limits: &gate::Limits, baseline: Option<&Value>) -> Result<()> {
    let mut failed = gate::failures(sweeps, limits);
    if let Some(baseline) = baseline {
        let gate::Comparison { worse, better, same, unmatched } = gate::compare(baseline, sweeps)?;
        print(&format!(
            "against the baseline: {} worse, {better} better, {same} same, {unmatched} in one run only\n",
            worse.len()
        ))?;
        failed.extend(worse);
    }
    if failed.is_empty() { Ok(()) } else { Err(Error::CheckFailed(failed.join("; "))) }
}
