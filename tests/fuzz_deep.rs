//! Scenes and files that are sound but for a fault, from a seed: through reader, fit, raster, truth and report.

#[path = "fuzz/files.rs"]
#[allow(unreachable_pub, reason = "as its neighbours")]
mod files;
#[path = "fuzz/mutate.rs"]
#[allow(unreachable_pub, dead_code, reason = "the fuzz crate and the shallow test use the rest")]
mod mutate;
#[path = "fuzz/readers.rs"]
#[allow(unreachable_pub, dead_code, reason = "the fuzz crate uses it too")]
mod readers;
#[path = "fuzz/scenes.rs"]
#[allow(unreachable_pub, reason = "as its neighbours")]
mod scenes;

use gnomon::analysis::captured::CapturedArguments;
use gnomon::analysis::documents::{self, Options, Which};
use gnomon::analysis::need::Need;
use gnomon::load::Limits;
use gnomon::load::config::Settings;
use gnomon::load::fit;
use gnomon::scene::{Case, cases};
use gnomon::scene_file::parse;
use gnomon::{Error, Result};
use mutate::Random;
use rayon::prelude::*;
use std::fs;
use std::panic::catch_unwind;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// How far an input came.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Stage {
    Refused,
    /// The readers took it.
    Read,
    /// It was drawn, traced and reported.
    Reported,
}

/// A refusal is one sentence for the user's eyes, and exit code 2.
fn refused(error: &Error) -> Stage {
    let text = error.to_string();
    assert!(
        error.exit_code() == 2 && !text.contains(char::is_control),
        "not one sentence: {text:?}"
    );
    Stage::Refused
}

/// A scene end to end; counts add up and no number of the results is missing.
fn scene(seed: u64) -> Stage {
    let scenes::Scene { extension, bytes, toml } = scenes::scene(&mut Random::new(seed));
    let path = PathBuf::from(format!("absent/fuzz.{extension}"));
    let read = || -> Result<_> {
        let loaded = parse(&path, &bytes, &Limits::default())?;
        Ok((loaded, Settings::parse("fuzz.toml", &toml)?))
    };
    let (loaded, settings) = match read() {
        Ok(read) => read,
        Err(error) => return refused(&error),
    };
    let case = match fit::case("fuzz", loaded, &settings) {
        Ok(case) => case,
        Err(error) => {
            refused(&error);
            return Stage::Read;
        }
    };
    Need::REPORT.check(&case, 1).expect("a hundred pixels are affordable");
    let options = Options { which: Which::Own(Box::new(case)), ..Options::default() };
    let report = documents::report(&options, || {}).expect("a case of one's own is reported");
    let objects = report.results["cases"][0]["by_object"].as_object().expect("a case by objects");
    let count = |object: &serde_json::Value, key: &str| object[key].as_u64().expect("a count");
    let receivers: u64 = objects.values().map(|o| count(o, "lit") + count(o, "shadowed")).sum();
    let wrong: u64 =
        objects.values().map(|o| count(o, "false_light") + count(o, "false_shadow")).sum();
    assert!(wrong <= receivers && receivers <= 12 * 9, "{wrong} of {receivers} in 108 pixels");
    if seed.is_multiple_of(16) {
        assert!(report.files().len() > 3, "pages and tables");
    }
    Stage::Reported
}

/// A map file of one of our kinds, looked up by a small case.
fn map(seed: u64, folder: &Path) -> Stage {
    let mut random = Random::new(seed);
    let (extension, bytes) = match seed % 3 {
        0 => ("png", files::png(&mut random)),
        1 => ("exr", files::exr(&mut random)),
        _ => ("raw", files::raw(&mut random)),
    };
    let path = folder.join(format!("{}-{seed}.{extension}", std::process::id()));
    fs::write(&path, bytes).expect("a scratch file");
    let packing = match extension {
        "exr" => None,
        _ => Some(["unorm8", "unorm16", "f32", "digits-24", "book"][random.below(5)].to_string()),
    };
    let arguments = CapturedArguments {
        map_file: Some(path.clone()),
        packing,
        map_width: Some(4),
        map_height: Some(4),
        ..CapturedArguments::default()
    };
    let mut case: Case = cases::named("t4-wall").expect("a standard case");
    let applied = arguments.apply(&mut case, false);
    let _ = fs::remove_file(path);
    match applied {
        Ok(captured) => {
            assert!(
                captured.is_some_and(|c| c.map.layout().side() == case.map.size),
                "the map's own size"
            );
            Stage::Read
        }
        Err(error) => refused(&error),
    }
}

/// A file of the kinds that the shallow readers take, which assert for themselves.
fn small(seed: u64) -> Stage {
    let mut random = Random::new(seed);
    match seed % 4 {
        0 => readers::device_json_file(&files::device(&mut random)),
        1 => readers::packing_toml(&files::packing(&mut random)),
        2 => readers::manifest(&files::manifest(&mut random)),
        _ => readers::journal(&files::journal(&mut random)),
    }
    Stage::Read
}

/// What a run of many seeds saw.
#[derive(Debug, Default)]
struct Seen {
    stages: Vec<(u64, Option<Stage>, Duration)>,
}

impl Seen {
    fn of(seeds: std::ops::Range<u64>, run: impl Fn(u64) -> Stage + Sync) -> Self {
        let one = |seed| {
            let start = Instant::now();
            let stage = catch_unwind(std::panic::AssertUnwindSafe(|| run(seed))).ok();
            (seed, stage, start.elapsed())
        };
        Self { stages: seeds.into_par_iter().map(one).collect() }
    }

    fn share(&self, stage: Stage) -> f64 {
        let reached = self.stages.iter().filter(|run| run.1 >= Some(stage)).count();
        reached as f64 / self.stages.len() as f64
    }

    fn panicked(&self) -> Vec<u64> {
        self.stages.iter().filter(|run| run.1.is_none()).map(|run| run.0).collect()
    }

    fn say(&self, what: &str) -> Duration {
        let slowest = self.stages.iter().map(|run| run.2).max().unwrap_or_default();
        println!(
            "{what}: {} executions, {:.1} % read, {:.1} % reported, slowest {slowest:.1?}, panics {:?}",
            self.stages.len(),
            100.0 * self.share(Stage::Read),
            100.0 * self.share(Stage::Reported),
            self.panicked()
        );
        slowest
    }
}

#[test]
fn most_scenes_reach_the_report_and_none_panics() {
    let seen = Seen::of(0..64, scene);
    seen.say("scenes");
    assert_eq!(seen.panicked(), [0; 0], "seeds that panic");
    assert!(seen.share(Stage::Read) >= 0.5 && seen.share(Stage::Reported) >= 0.5, "too shallow");
}

#[test]
fn maps_and_small_files_are_read_or_refused_in_a_sentence() {
    let folder = tempfile::tempdir().expect("a folder");
    let maps = Seen::of(0..1500, |seed| map(seed, folder.path()));
    maps.say("maps");
    assert_eq!(maps.panicked(), [0; 0], "seeds that panic");
    assert!(maps.share(Stage::Read) >= 0.3, "too shallow");
    let small = Seen::of(0..8000, small);
    small.say("small files");
    assert_eq!(small.panicked(), [0; 0], "seeds that panic");
}

/// The largest resident set so far in bytes, where the system tells.
fn resident() -> u64 {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    line.and_then(|l| l.split_whitespace().next()?.parse::<u64>().ok()).unwrap_or(0) << 10
}

/// `GNOMON_FUZZ_DEEP=100000` scenes end to end (the default) and ten times as many files,
/// `GNOMON_FUZZ_SEED` the first seed.
#[test]
#[ignore = "soak: 10^5 scenes end to end, an hour"]
fn many_scenes_reach_the_report_and_none_panics() {
    let number = |name: &str, default: u64| {
        std::env::var(name).map_or(default, |text| text.parse().expect("a whole number"))
    };
    let (count, first) = (number("GNOMON_FUZZ_DEEP", 100_000), number("GNOMON_FUZZ_SEED", 1 << 20));
    let folder = tempfile::tempdir().expect("a folder");
    let runs = [
        ("scenes", Seen::of(first..first + count, scene)),
        ("maps", Seen::of(first..first + 10 * count, |seed| map(seed, folder.path()))),
        ("small files", Seen::of(first..first + 10 * count, small)),
    ];
    for (what, seen) in runs {
        assert!(seen.say(what) < Duration::from_secs(5), "{what}: an input takes too long");
        assert_eq!(seen.panicked(), [0; 0], "{what}: seeds that panic");
    }
    let most = resident();
    println!("largest resident set {} MiB", most >> 20);
    assert!(most < 2 << 30, "beyond 2 GiB");
}
