//! Which bias does this scene need, in this engine's own parameters?
use clap::Parser;
use gnomon::Result;
use gnomon::analysis::need::Need;
use gnomon::analysis::sweep::{gate, plan};
use gnomon::analysis::tune::{self, Request};
use gnomon::engines::Engine;
use gnomon::harness::{Common, arguments, print, print_table, run};
use gnomon::report::Block;
use gnomon::scene::{Filter, cases};
use gnomon::scene_file::SceneFile;
use std::path::Path;
use std::process::ExitCode;

/// Finds the smallest bias that ends acne on a scene and prints it as the line to paste into an engine,
/// with what stays wrong, the same bias in other units, and the engine's default beside it.
///
/// Examples:
///   gnomon-tune --case fundamentals-spot --engine threejs
///   gnomon-tune --case upc --engine vulkan --map 1024 --format unorm24 --filter pcf3x3 --max-acne 0.1%
///   gnomon-tune --scene room.glb --light-dir 1,-2,0.5 --engine bevy
#[derive(Parser)]
#[command(name = "gnomon-tune", version, verbatim_doc_comment)]
struct Args {
    /// A named case
    #[arg(long, default_value = "fundamentals-spot", conflicts_with = "scene")]
    case: String,
    #[command(flatten)]
    scene: SceneFile,
    /// The engine or API
    #[arg(long, default_value = "threejs")]
    engine: Engine,
    /// Map size in texels per side [default: the case's]
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=8192))]
    map: Option<u32>,
    /// Depth format or packing [default: the case's]
    #[arg(long)]
    format: Option<String>,
    /// Filter [default: the case's]
    #[arg(long)]
    filter: Option<Filter>,
    /// Acne that counts as none, as a share of the truly lit
    #[arg(long, default_value = "0.1%")]
    max_acne: String,
    #[command(flatten)]
    common: Common,
}

fn main() -> ExitCode {
    let args: Args = arguments();
    run(move || body(&args))
}

fn body(args: &Args) -> Result<()> {
    args.common.start()?;
    let mut case = match args.scene.case()? {
        Some(own) => own,
        None => cases::named(&args.case)?,
    };
    let format = args.format.as_deref().map_or(Ok(case.map.texel), plan::format_named)?;
    case.map = case.map.with(args.map.unwrap_or(case.map.size), format);
    case.lookup.filter = format.usable(args.filter.unwrap_or(case.lookup.filter));
    Need::TUNE.check(&case, if args.common.quick { 4 } else { 1 })?;
    let (engine, profile, seed) = (args.engine, args.common.profile(), args.common.seed);
    let max_acne = gate::share(&args.max_acne)?;
    let command = Common::command("gnomon-tune");
    let request = Request { case, engine, max_acne, profile, seed, command };
    let (report, _) = args.common.publish("tune", || Ok(tune::report(&request)))?;
    if args.common.json.as_deref() == Some(Path::new("-")) {
        return report.complete();
    }
    for block in report.blocks() {
        if let Block::Code { text, .. } = block {
            print(&format!("{text}\n"))?;
        }
        if let Block::Table(table) = block
            && table.id == "units"
        {
            print_table(table)?;
        }
    }
    report.complete()
}
