//! The sweep's shortcut against the literal f32 rule, and how it behaves at its edges.
#![allow(clippy::wildcard_enum_match_arm, reason = "singles one member out")]

use gnomon::analysis::sweep::chart::{Attachment, Chart};
use gnomon::analysis::sweep::tally::Kind;
use gnomon::analysis::sweep::taps::Taps;
use gnomon::analysis::sweep::{
    Field, Plan, Question, Range, Scales, gate, looks, plan, report, run, sweep,
};
use gnomon::num::{from_ordinal, ordinal};
use gnomon::raster::PolygonOffset;
use gnomon::raster::passes::{MapPass, MapRaster, Subject};
use gnomon::report::Profile;
use gnomon::scene::{Case, Filter, FilterKernel, TexelFormat, cases};
use gnomon::shadow::bias::{Family, Strategy};
use gnomon::shadow::{ShadowMap, visibility};

fn random(seed: &mut u64) -> f64 {
    *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*seed >> 11) as f64 / (1u64 << 53) as f64
}

fn scales(world_per_window: f64) -> Scales {
    Scales { world_per_window, ..Scales::default() }
}

fn chart<'f, 'a>(field: &'f Field<'a>, size: u32, format: TexelFormat) -> Chart<'f, 'a> {
    let filter = format.usable(field.case().lookup.filter);
    Chart::new(field, size, filter, Attachment::of(format))
}

/// How many amounts of a tap family were compared: `drawn` random ones, and about `breakpoints` of its
/// breakpoints with both neighbours. Panics where the curve and the literal rule count differently.
fn compare(
    chart: &Chart<'_, '_>,
    format: TexelFormat,
    strategy: Strategy,
    sizes: [usize; 2],
) -> usize {
    let [drawn, breakpoints] = sizes;
    let mut seed = 7;
    let case = chart.field.case();
    let rule = case.lookup.compare;
    let looks = chart.looks(format, &strategy.with(0.0));
    let taps = Taps::on(chart, format, strategy);
    let curve = taps.curve_on(chart, format, strategy);
    let list = curve.breakpoints();
    let around = |&b: &f32| [from_ordinal(ordinal(b) - 1), b, from_ordinal(ordinal(b) + 1)];
    let around = list.iter().step_by((list.len() / breakpoints).max(1)).flat_map(around);
    let random = (0..drawn).map(|_| libm::exp2(random(&mut seed) * 30.0 - 24.0) as f32);
    let mut amounts: Vec<f32> = random.chain(around).filter(|a| *a >= 0.0).collect();
    amounts.sort_by_key(|&a| ordinal(a));
    let literal = looks::literal_all(&looks, rule, &amounts, |i, a| taps.bias(i, a));
    let kept = taps.curve(&looks, rule);
    assert_eq!(kept.critical, curve.critical, "{} {strategy}", case.name);
    assert_eq!(kept.at(&amounts), curve.at(&amounts), "{} {strategy}", case.name);
    assert_eq!(kept.gaps_at(&amounts), curve.gaps_at(&amounts), "{} {strategy}", case.name);
    for kind in Kind::ALL.iter().copied() {
        assert_eq!(kept.first(kind), curve.first(kind), "{} {strategy} {kind}", case.name);
        assert_eq!(kept.quiet_from(2, kind), curve.quiet_from(2, kind), "{strategy} {kind}");
    }
    for ((a, fast), slow) in amounts.iter().zip(curve.at(&amounts)).zip(literal) {
        assert_eq!(fast, slow, "{} {} {strategy} at {a:e}", case.name, format.name());
    }
    amounts.len()
}

/// As [`compare`] of every tap family over some cases, each at every `step`-th pixel.
fn compare_all(cases: &[&str], step: u32, sizes: [usize; 2]) -> usize {
    let mut compared = 0;
    for name in cases {
        let case = cases::named(name).unwrap();
        let field = Field::new(&case, step);
        for format in ["unorm16", "book"].map(|f| plan::format_named(f).unwrap()) {
            let chart = chart(&field, 256, format);
            let families = Strategy::ALL.iter().filter(|s| s.family() == Family::Tap);
            compared += families.map(|&s| compare(&chart, format, s, sizes)).sum::<usize>();
        }
    }
    compared
}

#[test]
fn curves_equal_the_literal_rule() {
    let cases = ["book-r8-y7", "fundamentals-spot", "exam-pcf", "t11-plates"];
    let compared = compare_all(&cases, 16, [150, 60]);
    assert!(compared > 10_000, "{compared} amounts compared");
}

#[test]
fn curves_equal_the_literal_rule_at_every_breakpoint() {
    let compared = compare_all(&["book-r8-y7", "exam-pcf"], 16, [10_000, usize::MAX]);
    assert!(compared > 400_000, "{compared} amounts compared");
}

/// The sweep's own counts of a case equal a map drawn, stored and looked up in full.
fn full_pipeline(case: &Case, field: &Field<'_>, offset: PolygonOffset, bias: f32) -> [i64; 2] {
    let device = case.device.device();
    let subject = Subject::draw(case, &device);
    let format = gnomon::raster::passes::map_depth_buffer(case);
    let pass = MapPass { cull: case.map.cull, depth_buffer: format, offset };
    let raster = MapRaster::draw(&case.light, case.layout(), &device, &subject.vertices, pass);
    let map = ShadowMap::store(&device, &case.map, &raster.layout, raster.drawn());
    let mut wrong = [0, 0];
    for sample in &field.samples {
        let lookups = subject.lookups(sample.receiver.position, &sample.coords);
        let taps = map.taps(&device, &case.lookup, &lookups, sample.pixel);
        let lit = visibility(&case.lookup, &lookups, &taps, bias);
        let right = if sample.lit { taps.depths().len() } else { 0 };
        wrong[usize::from(!sample.lit)] += i64::from(lit != right);
    }
    wrong
}

#[test]
fn sweeps_equal_the_full_pipeline_of_every_document() {
    for case in cases::documents::all() {
        let field = Field::new(&case, 8);
        let chart = chart(&field, case.map.size, case.map.texel);
        let question = Question { amounts: &[0.0, case.bias, 0.5], max_acne: 0.0 };
        let swept = sweep(&chart, case.map.texel, Strategy::Constant, &question);
        for point in &swept.points {
            let full = full_pipeline(&case, &field, PolygonOffset::default(), point.amount);
            let found = [point.tally.false_shadow(), point.tally.false_light()];
            assert_eq!(found, full, "{} at {}", case.name, point.amount);
        }
        let question = Question { amounts: &[0.0, 0.7, 3.0], max_acne: 0.0 };
        let swept = sweep(&chart, case.map.texel, Strategy::SlopeRaster, &question);
        for point in &swept.points {
            let offset = PolygonOffset { factor: point.amount, units: 1.0, clamp: 0.0 };
            let full = full_pipeline(&case, &field, offset, 0.0);
            let found = [point.tally.false_shadow(), point.tally.false_light()];
            assert_eq!(found, full, "{} slope-raster at {}", case.name, point.amount);
        }
    }
}

/// Leaving receivers out whose verdict cannot change changes no count, and the thresholds found on few
/// receivers are thresholds of all.
#[test]
fn value_families_equal_the_literal_counts_of_every_receiver() {
    let families = [
        Strategy::SlopeRaster,
        Strategy::RasterUnits,
        Strategy::NormalOffset,
        Strategy::NormalGodot,
        Strategy::LightOffset,
        Strategy::CasterUrp,
        Strategy::CasterUnreal,
        Strategy::DualLayer,
    ];
    for name in ["book-r8-y7", "fundamentals-spot", "exam-pcf", "t12-stairs"] {
        let case = cases::named(name).unwrap();
        let field = Field::new(&case, 16);
        let rule = case.lookup.compare;
        for format in ["unorm16", "book"].map(|f| plan::format_named(f).unwrap()) {
            let chart = chart(&field, 256, format);
            let tally = |strategy: Strategy, amount: f32| {
                let recipe = strategy.with(amount);
                let looks = chart.looks(format, &recipe);
                looks::literal(&looks, rule, |i| recipe.tap_bias(&chart.weights(format, i)))
            };
            for strategy in families {
                let bias: Range = "1e-5:1e-1:log:12".parse().unwrap();
                let amounts = gnomon::analysis::sweep::amounts(strategy, &bias, &scales(10.0));
                let question = Question { amounts: &amounts, max_acne: 0.0 };
                let swept = sweep(&chart, format, strategy, &question);
                for point in &swept.points {
                    let literal = tally(strategy, point.amount);
                    assert_eq!(point.tally, literal, "{name} {strategy} at {}", point.amount);
                }
                if let Some(point) = swept.acne_free {
                    assert_eq!(point.tally, tally(strategy, point.amount), "{name} {strategy}");
                    assert_eq!(point.tally.of(Kind::ACNE), 0, "{name} {strategy}");
                }
                if let Some(amount) = swept.detachment {
                    let panned = tally(strategy, amount).of(Kind::PETER_PANNING);
                    assert!(panned > 0, "{name} {strategy}: nothing is lost at {amount}");
                }
            }
        }
    }
}

/// A larger constant bias never makes a receiver acne and never repairs a leak.
#[test]
fn errors_are_nested() {
    let mut seed = 3;
    let case = cases::named("fundamentals-directional").unwrap();
    let field = Field::new(&case, 16);
    let chart = chart(&field, case.map.size, case.map.texel);
    let looks = chart.looks(case.map.texel, &Strategy::Constant.with(0.0));
    let rule = case.lookup.compare;
    for _ in 0..10_000 {
        let mut pair = [0, 1].map(|_| libm::exp2(random(&mut seed) * 24.0 - 22.0) as f32);
        pair.sort_by(f32::total_cmp);
        let look = &looks[(random(&mut seed) * looks.len() as f64) as usize];
        let [few, many] = pair.map(|b| look.verdict(rule, b).0);
        if look.lit {
            assert!(many.is_none() || few.is_some(), "{pair:?}: acne appears with more bias");
        } else {
            assert!(few.is_none() || many.is_some(), "{pair:?}: a leak is repaired by more bias");
        }
    }
}

/// Every strategy ends the acne of a plane under every filter, but where its own definition says not:
/// receiver-slope and tutorial-tangent stop at their clamp of 0.01, tutorial-cosine begins at its floor,
/// Godot's offset only moves the look-up, receiver-plane at the tap leaves a filter's texels to its constant.
#[test]
fn every_strategy_ends_acne_on_a_plane_or_its_reach_says_why() {
    let case = cases::named("t1-tilted-plane").unwrap();
    let field = Field::new(&case, 16);
    for &filter in Filter::ALL.iter().filter(|&&f| f != Filter::Linear) {
        let chart = Chart::new(&field, 64, filter, Attachment::Depth);
        // h·s·|g|₁ over the depth range: closed form of what the filter needs.
        let need = filter.half_width() * 0.125 * 0.75 / 16.0;
        for &strategy in Strategy::ALL.iter().filter(|&&s| s != Strategy::None) {
            let bias: Range = "1e-6:1:log:25".parse().unwrap();
            let amounts = gnomon::analysis::sweep::amounts(strategy, &bias, &scales(16.0));
            let question = Question { amounts: &amounts, max_acne: 0.0 };
            let swept = sweep(&chart, case.map.texel, strategy, &question);
            let acne = swept.points[0].tally.of(Kind::ACNE);
            let none_at_zero = matches!(
                strategy,
                Strategy::FrontCulling
                    | Strategy::SecondDepth
                    | Strategy::Midpoint
                    | Strategy::Oriented
                    | Strategy::ReceiverPlane
                    | Strategy::Adaptive
            );
            // Its floor, which it keeps at every amount.
            let floored = strategy == Strategy::TutorialCosine && need <= 0.005;
            assert!(acne > 0 || none_at_zero || floored, "{strategy} {filter}: acne without bias");
            match strategy {
                Strategy::ReceiverSlope | Strategy::TutorialTangent => {
                    // Disks of points do not reach their half-width in every direction.
                    let found = swept.acne_free.is_some();
                    let disk = ["poisson16", "vogel16", "vogel5-bilinear"].contains(&filter.name())
                        || matches!(filter.kernel(), FilterKernel::Turned(_));
                    let predicted = need <= 0.01;
                    let right = found == predicted || (disk && found);
                    assert!(right, "{filter} needs {need}, the clamp is 0.01: {found}");
                }
                Strategy::NormalGodot | Strategy::Oriented => {}
                _ => assert!(swept.acne_free.is_some(), "{strategy} {filter}: never ends acne"),
            }
        }
    }
}

#[test]
fn impossible_sweeps_are_refused_in_a_sentence() {
    let plan = |sizes: Vec<u32>, count: u32| Plan {
        cases: cases::all(),
        sizes,
        formats: vec![plan::format_named("f32").unwrap()],
        filters: vec![None],
        strategies: Strategy::ALL.to_vec(),
        bias: Range { low: 1e-6, high: 1e-2, log: true, count },
        step: 4,
        max_acne: 0.0,
    };
    assert!(plan(vec![256], 200).checked().is_ok());
    for bad in
        [plan(vec![], 200), plan(vec![0], 200), plan(vec![9000], 1), plan(vec![256], 1_000_000)]
    {
        let error = bad.checked().unwrap_err();
        assert_eq!(error.exit_code(), 2, "{error}");
        assert!(error.to_string().lines().count() == 1, "{error}");
    }
    assert!(plan::format_named("unorm13").is_err());
    assert!(plan::cases_named(&["no-such".into()]).is_err());
}

/// A bias that leaves acne fails its limit, one that does not passes.
#[test]
fn gates_judge_the_amounts_that_were_asked_for() {
    let plan = |bias: &str| Plan {
        cases: plan::cases_named(&["t1-tilted-plane".into()]).unwrap(),
        sizes: vec![64],
        formats: vec![plan::format_named("f32").unwrap()],
        filters: vec![None],
        strategies: vec![Strategy::Constant],
        bias: bias.parse().unwrap(),
        step: 8,
        max_acne: 0.0,
    };
    let acne = gate::Limits { acne: Some(0.001), peter_panning: None };
    let both = gate::Limits { peter_panning: Some(gate::LengthLimit::Texels(2.0)), ..acne };
    let judged = |bias: &str, limits| gate::failures(&run(&plan(bias), || {}), limits);
    let failures = |bias: &str| judged(bias, &acne);
    assert_eq!(failures("0.0001").len(), 1, "half of the plane is dark");
    assert!(failures("0.01").is_empty(), "beyond the plane's threshold");
    assert!(judged("0.01", &both)[0].contains("not measured"), "nothing is shadowed");
    let sweeps = run(&plan("1e-6:1e-1:log:9"), || {});
    let baseline = report::report(&plan("0.01"), &sweeps, Profile::Quick, 1, String::new()).results;
    let same = gate::compare(&baseline, &sweeps).unwrap();
    assert_eq!((same.worse.len(), same.better, same.same), (0, 0, 1), "{same:?}");
    assert!(gate::compare(&serde_json::json!({}), &sweeps).is_err());
}

fn command(arguments: &[&str]) -> (i32, String, String) {
    let output = std::process::Command::new(env!("CARGO_BIN_EXE_gnomon-sweep"))
        .args(arguments)
        .output()
        .expect("it starts");
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("text");
    (output.status.code().unwrap_or(-1), text(output.stdout), text(output.stderr))
}

/// 0 pass, 1 fail, 2 bad input: one sentence, at once, nothing written.
#[test]
fn continuous_integration_reads_the_exit_code() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).display().to_string();
    let out = path("out");
    let base = ["--case", "t1-tilted-plane", "--map", "64", "--format", "f32", "--quick"];
    let with = |more: &[&str]| {
        let fixed = ["--strategy", "constant", "--out", &out];
        command(&[&base[..], &fixed[..], more].concat())
    };
    let (code, _, error) = with(&["--bias", "0.01", "--fail-acne", "0.1%"]);
    assert_eq!(code, 0, "{error}");
    let old = path("old.json");
    std::fs::copy(folder.path().join("out/results.json"), &old).unwrap();
    let (code, _, error) = with(&["--bias", "0.0001", "--fail-acne", "0.1%"]);
    assert_eq!(code, 1, "{error}");
    assert!(error.contains("t1-tilted-plane 64 f32 nearest constant"), "{error}");
    let (code, text, _) = with(&["--bias", "0.01", "--baseline", &old]);
    assert!(code == 0 && text.contains("0 worse"), "{text}");
    let mut better: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(&old).unwrap()).unwrap();
    better["combinations"]["t1-tilted-plane 64 f32 nearest constant"]["acne_free"] =
        serde_json::json!(0.001);
    std::fs::write(&old, better.to_string()).unwrap();
    let (code, text, error) = with(&["--bias", "0.01", "--baseline", &old]);
    assert!(code == 1 && text.contains("1 worse"), "{text}{error}");
    let gaps = ["--case", "t4-wall", "--map", "1024", "--format", "f32", "--quick", "--strategy"];
    let gaps = |limit: &str| {
        let more = ["constant", "--bias", "0.05", "--fail-peter-panning", limit, "--out", &out];
        command(&[&gaps[..], &more[..]].concat()).0
    };
    assert_eq!((gaps("1texel"), gaps("0.6")), (1, 0), "the gap is 0.48 world units");
}

#[test]
fn bad_input_is_one_sentence_within_a_second() {
    let start = std::time::Instant::now();
    let bad: [&[&str]; 10] = [
        &["--case", "no-such"],
        &["--format", "unorm13"],
        &["--filter", "pcf2x2"],
        &["--map", "0"],
        &["--bias", "1e-2:1e-7:log:5"],
        &["--bias", "1e-7:1e-2:log:1000000"],
        &["--max-acne", "120%"],
        &["--fail-peter-panning", "2 parsecs"],
        &["--scene", "no-such-file.glb"],
        &["--baseline", "no-such-file.json"],
    ];
    for arguments in bad {
        let (code, text, error) = command(arguments);
        assert_eq!((code, text.as_str()), (2, ""), "{arguments:?}: {error}");
        assert!(error.starts_with("error: "), "{arguments:?}: {error}");
        let sentence = error.lines().next().unwrap_or_default();
        assert!(sentence.len() > 20 && !error.contains("panicked"), "{arguments:?}: {error}");
    }
    let each = start.elapsed().as_secs_f64() / bad.len() as f64;
    assert!(each < 1.0, "{each} s each");
}

/// A scene file is swept and tuned as a named case is.
#[test]
fn scene_files_are_swept_and_tuned() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("room.obj");
    let room = "v -4 0 -4\nv 4 0 -4\nv 4 0 4\nv -4 0 4\nv -1 1 -1\nv 1 1 -1\nv 0 1.5 1\n";
    std::fs::write(&scene, format!("{room}f 1 3 2\nf 1 4 3\nf 5 7 6\n")).unwrap();
    let out = folder.path().join("out");
    let own =
        ["--scene", &scene.display().to_string(), "--light-dir", "1,-2,0.5"].map(String::from);
    let rest = ["--map", "128", "--format", "f32", "--quick", "--out", &out.display().to_string()]
        .map(String::from);
    for (program, more) in [
        (env!("CARGO_BIN_EXE_gnomon-sweep"), ["--strategy", "constant"]),
        (env!("CARGO_BIN_EXE_gnomon-tune"), ["--engine", "bevy"]),
    ] {
        let output = std::process::Command::new(program)
            .args(own.iter().chain(&rest))
            .args(more)
            .output()
            .expect("it starts");
        let error = String::from_utf8_lossy(&output.stderr).to_string();
        assert!(output.status.success(), "{error}");
        let results = std::fs::read_to_string(out.join("results.json")).unwrap();
        assert!(results.contains("room"), "{results}");
    }
}
