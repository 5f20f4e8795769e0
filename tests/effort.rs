//! What is skipped changes no result: raster against rays, skips against none, on every case.

use gnomon::analysis::curve::Curve;
use gnomon::analysis::documents::{self, Options, Which};
use gnomon::analysis::effort::{Effort, TruthBy};
use gnomon::analysis::foremost::Foremost;
use gnomon::analysis::interior;
use gnomon::analysis::measure::{Measured, measure_by};
use gnomon::analysis::observe::Observer;
use gnomon::report::Profile;
use gnomon::scene::{Case, cases};
use gnomon::truth::{Faces, SeenFaces, izb};

/// Everything that a measurement says, every receiver's chain to the bit.
fn all_of(m: &Measured<'_>) -> (String, String) {
    let receivers = m.observations.iter().map(|o| format!("{o:?}\n")).collect();
    (receivers, serde_json::to_string(&m.measurement).expect("numbers"))
}

fn efforts() -> [Effort; 3] {
    [
        Effort::default(),
        Effort { truth: TruthBy::Rays, skip: true },
        Effort { truth: TruthBy::Raster, skip: false },
    ]
}

fn every_effort_says_the_same(case: &Case, step: u32) {
    let arbiter = all_of(&measure_by(case, step, Effort::ARBITER));
    for effort in efforts() {
        let (receivers, numbers) = all_of(&measure_by(case, step, effort));
        assert_eq!(numbers, arbiter.1, "{} by {effort:?}", case.name);
        for (ours, theirs) in receivers.lines().zip(arbiter.0.lines()) {
            assert_eq!(ours, theirs, "{} by {effort:?}", case.name);
        }
        assert_eq!(receivers.len(), arbiter.0.len(), "{} by {effort:?}", case.name);
    }
}

#[test]
fn documents_and_closed_forms_are_the_same_by_every_effort() {
    for case in cases::main_job() {
        every_effort_says_the_same(&case, 40);
    }
}

#[test]
fn standard_scenes_are_the_same_by_every_effort() {
    for name in cases::standard::NAMES {
        let mut case = cases::named(name).expect("a standard scene");
        case.map.size = 512;
        every_effort_says_the_same(&case, 40);
    }
}

#[test]
fn a_report_is_the_same_bytes_by_every_effort() {
    let files = |effort: Effort| {
        let which = Which::Named("exam-pcf".to_string());
        let options = Options { profile: Profile::Quick, which, effort, ..Options::default() };
        let report = documents::report(&options, || ()).expect("a known case");
        assert!(report.sections.iter().any(|s| s.id == "exam-pcf-work"), "the work is shown");
        let names_work = |name: &str| name.contains("work") || name.ends_with(".html");
        let files = report
            .files()
            .into_iter()
            .filter(|f| !names_work(&f.name) && f.name != "manifest.json");
        files.map(|f| (f.name, f.bytes)).collect::<Vec<_>>()
    };
    let arbiter = files(Effort::ARBITER);
    assert!(arbiter.len() > 5);
    for effort in efforts() {
        for (ours, theirs) in files(effort).iter().zip(&arbiter) {
            assert!(ours == theirs, "{} by {effort:?}", ours.0);
        }
    }
}

#[test]
fn skips_save_work_and_count_it() {
    let case = cases::named("teapot").expect("a standard scene");
    let skipped = measure_by(&case, 2, Effort::default()).work;
    let plain = measure_by(&case, 2, Effort::ARBITER).work;
    let of = |work: &[gnomon::analysis::effort::Count], what: &str| {
        *work.iter().find(|c| c.what.contains(what)).unwrap_or_else(|| panic!("{what}: {work:?}"))
    };
    for what in ["texel centres", "map points"] {
        let (few, all) = (of(&skipped, what), of(&plain, what));
        assert_eq!(few.answered, all.answered, "{what}");
        assert_eq!(all.evaluated, all.answered, "{what}: the arbiter works everything out");
        assert!(few.evaluated * 100 < few.answered, "{few:?}");
    }
    let casters = of(&skipped, "casters");
    assert!(casters.evaluated < casters.answered, "{casters:?}");
}

/// The goal of two seconds on two cores: run by hand, alone on the machine.
#[test]
#[ignore = "a timing; prints wall and processor seconds of one analysed case"]
fn a_hundred_thousand_triangles_at_1080p() {
    let mut case = cases::named("terrain-100000").expect("a standard scene");
    case.canvas = [1920, 1080];
    case.map.size = 2048;
    for effort in [Effort::default(), Effort { truth: TruthBy::Rays, skip: true }] {
        let (wall, cpu) = (std::time::Instant::now(), cpu_seconds());
        let m = measure_by(&case, 1, effort);
        let errors: Vec<_> = (0..=1000).map(|k| m.curve.at(k as f32 * 1e-5)).collect();
        let (wall, cpu) = (wall.elapsed().as_secs_f64(), cpu_seconds() - cpu);
        println!("{effort:?}: {wall:.2} s wall, {cpu:.2} s processor; {}", m.measurement.verdict);
        for count in &m.work {
            println!("  {}: {} of {}", count.what, count.evaluated, count.answered);
        }
        assert!(errors[1000].false_shadow <= errors[0].false_shadow);
    }
    phases(&case);
}

/// Processor seconds of each phase by itself.
fn phases(case: &Case) {
    fn timed<T>(what: &str, run: impl FnOnce() -> T) -> T {
        let before = cpu_seconds();
        let value = run();
        println!("  {:5.2} s {what}", cpu_seconds() - before);
        value
    }
    let device = case.device.device();
    let observer = timed("passes, tree, neighbours", || Observer::new(case, &device));
    let (list, _) = timed("receivers, truth, verdicts", || observer.observe_all(1));
    timed("interior", || interior::counted(&observer, &list));
    timed("curve", || Curve::new(&list));
    let receivers: Vec<_> = list.iter().map(|o| o.receiver).collect();
    timed("truth alone", || izb::truths(&observer.geometry, &receivers, observer.light()));
    for (map, lens) in observer.lenses.iter().enumerate() {
        let foremost =
            timed("planes", || Foremost::new(&observer, lens, &SeenFaces::Alike(Faces::Both)));
        let within = list.iter().filter(|o| o.map == map);
        let points: Vec<_> = within.map(|o| o.exact.truncate()).collect();
        timed("one look at every point", || foremost.at(&points));
    }
    timed("dropping", || drop(list));
}

/// Processor time of this process, from the kernel's own account in hundredths of a second.
fn cpu_seconds() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let after = stat.rsplit_once(')').map_or("", |(_, rest)| rest);
    let fields: Vec<f64> = after.split_whitespace().filter_map(|f| f.parse().ok()).collect();
    fields.get(10..12).map_or(0.0, |f| (f[0] + f[1]) / 100.0)
}

/// A sweep asks rays and leaves nothing out, and says the same of every amount.
#[test]
fn sweeps_do_not_depend_on_the_effort() {
    use gnomon::analysis::sweep::{self, Plan, Range, plan};
    use gnomon::shadow::bias::Strategy;
    let strategies = ["constant", "slope-raster", "normal-offset", "adaptive", "midpoint"];
    let plan = Plan {
        cases: ["book-rgba8-y7", "exam-pcf"].map(|c| cases::named(c).expect("a case")).to_vec(),
        sizes: vec![128],
        formats: ["r8", "book", "unorm16", "f16", "f32"]
            .map(|f| plan::format_named(f).expect("a format"))
            .to_vec(),
        filters: vec![None],
        strategies: strategies.map(|s| s.parse::<Strategy>().expect("a strategy")).to_vec(),
        bias: Range { low: 1e-6, high: 1e-1, log: true, count: 12 },
        step: 8,
        max_acne: 0.0,
    };
    let usual = sweep::run(&plan, || ());
    let arbiter = sweep::run_by(&plan, Effort::ARBITER, || ());
    for (usual, arbiter) in usual.iter().zip(&arbiter) {
        assert_eq!(usual.swept.len(), 25);
        for (a, b) in usual.swept.iter().zip(&arbiter.swept) {
            let name = format!("{} {} {}", usual.name, a.format.name(), a.strategy);
            assert_eq!(format!("{a:?}"), format!("{b:?}"), "{name}");
        }
    }
}

/// The goal of six formats in 1.2 times the time of one: run by hand.
#[test]
#[ignore = "a timing; prints the time of six formats from one raster over that of one"]
fn six_formats_from_one_raster() {
    use gnomon::analysis::sweep::{self, Plan, Range};
    use gnomon::scene::Filter;
    use gnomon::shadow::bias::Strategy;
    let mut case = cases::named("terrain-100000").expect("a standard scene");
    case.map.size = 2048;
    let seconds = |formats: &[&str]| {
        let named = |f: &&str| gnomon::analysis::sweep::plan::format_named(f).expect("a format");
        let plan = Plan {
            cases: vec![case.clone()],
            sizes: vec![2048],
            formats: formats.iter().map(named).collect(),
            filters: vec![Some(Filter::Nearest)],
            strategies: vec![Strategy::Constant],
            bias: Range { low: 1e-6, high: 1e-1, log: true, count: 256 },
            step: 1,
            max_acne: 0.0,
        };
        let before = cpu_seconds();
        let sweeps = sweep::run(&plan, || ());
        assert_eq!(sweeps[0].swept.len(), formats.len());
        cpu_seconds() - before
    };
    let one = seconds(&["f32"]);
    let six = seconds(&["f32", "f16", "unorm16", "unorm24", "unorm32", "bf16"]);
    println!("one format {one:.2} s, six {six:.2} s: {:.3}", six / one);
}
