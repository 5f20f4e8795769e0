//! Where no receiver was measured nothing is recommended, no rate is a number, and no gate is passed.
#![allow(clippy::wildcard_enum_match_arm, reason = "singles one member out")]

use gnomon::analysis::documents::{self, Options, Which};
use gnomon::analysis::sweep::{Plan, Range, gate, report, run};
use gnomon::analysis::tune::{self, Request};
use gnomon::analysis::{formats, pareto};
use gnomon::depth::DepthFormat;
use gnomon::engines::Engine;
use gnomon::report::{Block, Profile, Report};
use gnomon::scene::{Case, TexelFormat};
use gnomon::scene_file::SceneFile;
use gnomon::shadow::bias::Strategy;
use std::process::Command;

const FLOOR: &str = "v -2 0 -2\nv 2 0 -2\nv 2 0 2\nv -2 0 2\nf 3 2 1\nf 4 3 1\n";
const TRIANGLE: &str = "v -0.5 1 -0.5\nv 0.5 1 -0.5\nv 0 1 0.5\nf 5 7 6\n";
const CEILING: &str = "v -9 2 -9\nv 9 2 -9\nv 9 2 9\nv -9 2 9\nf 5 6 7\nf 5 7 8\n";
const BELOW: &str = "[camera]\nposition = [0, 1.5, 3]\ntarget = [0, 0, 0]\n";
const HEAD: &str = "canvas = [16, 16]\n[map]\nsize = 16\n";

fn case(geometry: &[&str], settings: &[&str]) -> Case {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("Scene 1.obj");
    std::fs::write(&path, geometry.concat()).unwrap();
    std::fs::write(path.with_extension("toml"), settings.concat()).unwrap();
    let file = SceneFile { scene: Some(path), ..SceneFile::default() };
    file.case().unwrap().unwrap()
}

/// Scenes of which nothing is measured, each for another reason, and the words for it.
fn nothing() -> Vec<(Case, &'static str)> {
    let sun = "[light]\ndirection = [1, -2, 0.5]\n";
    let narrow = "[light]\nposition = [0, 3, 0]\ntarget = [90, 3, 0]\nfovy = 5\n";
    let corner = "[light]\nposition = [0, 5, 0]\ntarget = [-1.9, 0, -1.9]\nfovy = 2\n";
    let small =
        "[light]\nposition = [0, 3, 0]\ntarget = [0, 0, 0]\nwidth = 8\nnear = 1\nfar = 1.5\n";
    let away = "[camera]\nposition = [0, 1, 0]\ntarget = [0, 9, 0]\n";
    vec![
        (case(&["v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"], &[HEAD, sun]), "face away"),
        (
            case(
                &[FLOOR, TRIANGLE],
                &[HEAD, "[light]\nposition = [0, 0, 0]\ntarget = [1, 0, 0]\n"],
            ),
            "no receiver was measured",
        ),
        (
            case(
                &[FLOOR],
                &[
                    HEAD,
                    corner,
                    "[camera]\nposition = [1.9, 1, 1.9]\ntarget = [1.9, 0, 1.8]\nfovy = 20\n",
                ],
            ),
            "outside the light's cone",
        ),
        (case(&[FLOOR, TRIANGLE], &[HEAD, narrow]), "no receiver was measured"),
        (case(&[FLOOR], &[HEAD, small]), "outside the map"),
        (case(&[FLOOR], &[HEAD, sun, away]), "turn the camera towards the scene"),
    ]
}

fn plan(case: &Case) -> Plan {
    Plan {
        cases: vec![case.clone()],
        sizes: vec![16, 32],
        formats: vec![
            TexelFormat::Depth(DepthFormat::F32),
            TexelFormat::Packed(gnomon::depth::Packing::Book),
        ],
        filters: vec![None],
        strategies: vec![Strategy::Constant, Strategy::NormalOffset, Strategy::SlopeRaster],
        bias: Range { low: 1e-6, high: 1e-1, log: true, count: 4 },
        step: 1,
        max_acne: 0.0,
    }
}

fn measured(case: &Case) -> Report {
    let which = Which::Own(Box::new(case.clone()));
    documents::report(&Options { which, ..Options::default() }, || {}).unwrap()
}

fn swept(case: &Case) -> Report {
    let plan = plan(case);
    report::report(&plan, &run(&plan, || {}), Profile::Full, 1, String::new())
}

fn compared(case: &Case) -> Report {
    formats::report(std::slice::from_ref(case), Profile::Full, 1, || {})
}

fn costed(case: &Case) -> Report {
    let plan = plan(case);
    pareto::report::report(&plan, &pareto::entries(&plan, || {}), &[], Profile::Full, 1)
}

fn tuned(case: &Case, engine: Engine) -> Report {
    tune::report(&Request {
        case: case.clone(),
        engine,
        max_acne: 0.001,
        profile: Profile::Full,
        seed: 1,
        command: String::new(),
    })
}

/// The lines to paste.
fn lines(report: &Report) -> Vec<&str> {
    fn line(block: &Block) -> Option<&str> {
        if let Block::Code { text, .. } = block { Some(text) } else { None }
    }
    report.blocks().filter_map(line).collect()
}

/// Every text that people read but the page's own method and claims.
fn words(report: &Report) -> String {
    let mut words = report.lead.clone();
    words.extend(report.sections.iter().filter(|s| s.id != "method").map(|s| s.lead.clone()));
    words.extend(report.blocks().filter_map(|b| match b {
        Block::Text(text) => Some(text.clone()),
        Block::Gallery(tiles) => Some(tiles.iter().map(|t| t.text.as_str()).collect()),
        Block::Plot(plot) => Some(plot.to_svg(gnomon::report::Size::Half)),
        _ => None,
    }));
    let tables = report.tables().into_iter().chain(report.results_csv.clone());
    let cells = tables.flat_map(|table| table.rows.concat());
    words.extend(cells.map(|cell| format!("{} | {}", cell.to_text(), cell.to_csv())));
    words.join("\n")
}

#[test]
fn nothing_measured_is_said_and_recommends_nothing() {
    for (case, why) in nothing() {
        let mut reports = vec![measured(&case), swept(&case), compared(&case), costed(&case)];
        reports.extend(Engine::ALL.iter().map(|&engine| tuned(&case, engine)));
        for report in &reports {
            let name = &report.name;
            let lead = report.lead.join(" ");
            assert!(lead.contains("Scene 1: no receiver was measured"), "{name}: {lead}");
            assert!(lead.contains(why), "{name}: {why}: {lead}");
            let error = report.complete().unwrap_err();
            assert_eq!(error.exit_code(), 3, "{name}: {error}");
            let words = words(report);
            for banned in ["NaN", "wins", "inside the window", "Set ", "falls to", "0.00 %", "-0 "]
            {
                assert!(!words.contains(banned), "{name}, {why}: '{banned}' in {words}");
            }
            assert!(lines(report).is_empty() || name != "tune", "{name}: {:?}", lines(report));
            assert!(report.files().len() > 3);
        }
        let results = &reports[0].results["cases"][0];
        for side in ["false_shadow", "false_light"] {
            assert!(results[side]["rate"].is_null() && results[side]["count"] == 0);
        }
        for report in &reports[4..] {
            let values = report.results["values"].as_object().unwrap();
            assert!(values.values().all(serde_json::Value::is_null), "{values:?}");
        }
    }
}

#[test]
fn gates_fail_where_their_rate_is_not_measured() {
    let limits = |acne, peter_panning: Option<&str>| gate::Limits {
        acne,
        peter_panning: peter_panning.map(|text| text.parse().unwrap()),
    };
    let [acne, gap] = [limits(Some(1.0), None), limits(None, Some("1e9"))];
    let failed = |case: &Case, limits| gate::failures(&run(&plan(case), || {}), &limits);
    let (empty, _) = nothing().swap_remove(0);
    for limits in [acne, gap, limits(Some(1.0), Some("1e9"))] {
        assert_eq!(failed(&empty, limits).len(), plan(&empty).combinations());
    }
    let closed = closed_room();
    assert!(failed(&closed, acne)[0].contains("no receiver is truly lit"));
    assert_eq!(failed(&closed, gap), Vec::<String>::new());
    let open = open_floor();
    assert!(failed(&open, gap)[0].contains("no receiver is truly shadowed"));
    assert!(!failed(&open, acne).iter().any(|f| f.contains("not measured")));
    // A baseline is a gate too.
    let sweeps = run(&plan(&empty), || {});
    let old = swept(&open).results;
    let comparison = gate::compare(&old, &sweeps).unwrap();
    assert_eq!(comparison.worse.len(), plan(&empty).combinations());
}

/// A floor under a ceiling: nothing that the camera sees is lit.
fn closed_room() -> Case {
    let sun = "[light]\ndirection = [0.1, -1, 0.05]\n";
    case(&[FLOOR, CEILING], &[HEAD, sun, BELOW])
}

/// A floor alone, under a slanted sun.
fn open_floor() -> Case {
    case(&[FLOOR], &[HEAD, "[light]\ndirection = [0.4, -1, 0.05]\n"])
}

#[test]
fn a_closed_room_is_measured() {
    let room = closed_room();
    let report = measured(&room);
    let found = &report.results["cases"][0];
    assert!(found["lit"] == 0 && found["shadowed"].as_u64() > Some(100), "{found}");
    assert!(found["false_shadow"]["rate"].is_null() && found["false_light"]["rate"].is_number());
    assert!(found["verdict"].as_str().unwrap().contains("acne is not measured"), "{found}");
    for report in [report, swept(&room), compared(&room), costed(&room), tuned(&room, Engine::Gl)] {
        report.complete().unwrap();
        let words = words(&report);
        assert!(!words.contains("NaN") && !words.contains("wins"), "{}: {words}", report.name);
    }
    for &engine in Engine::ALL {
        let report = tuned(&room, engine);
        assert!(lines(&report).is_empty(), "{engine}: {:?}", lines(&report));
        assert!(
            report.lead[0].contains("No receiver is truly lit"),
            "{engine}: {}",
            report.lead[0]
        );
    }
    let table = swept(&room).results_csv.unwrap().to_csv();
    let light: Vec<&str> =
        table.lines().skip(1).map(|row| row.split(',').nth(8).unwrap()).collect();
    assert!(light.iter().all(|cell| cell.parse::<f64>().is_ok()), "leaks count: {table}");
}

#[test]
fn without_a_shadow_what_it_costs_is_not_measured() {
    let floor = open_floor();
    let report = measured(&floor);
    let found = &report.results["cases"][0];
    assert!(found["shadowed"] == 0 && found["false_light"]["rate"].is_null(), "{found}");
    assert!(found["verdict"].as_str().unwrap().contains("lost shadow is not measured"));
    report.complete().unwrap();
    let report = tuned(&floor, Engine::Vulkan);
    assert!(report.lead[0].contains("lost shadow is not measured"), "{}", report.lead[0]);
    assert!(!lines(&report).is_empty(), "acne is measured, so a bias is recommended");
}

#[test]
fn no_bias_is_needed_where_there_is_no_acne() {
    let flat = case(&[FLOOR, TRIANGLE], &[HEAD, "[light]\ndirection = [0, -1, 0]\n"]);
    for &engine in Engine::ALL {
        let report = tuned(&flat, engine);
        assert!(lines(&report).is_empty(), "{engine}: {:?}", lines(&report));
        assert!(report.lead[0].contains("No bias is needed"), "{engine}: {}", report.lead[0]);
        let texts = report.lead.join(" ") + &report.results.to_string() + &words(&report);
        for banned in ["-0.0", "-0 ", "-0,", "to -0", "−0 "] {
            assert!(!texts.contains(banned), "{engine}: '{banned}' in {texts}");
        }
    }
}

#[test]
fn the_programs_exit_with_3_and_gates_with_1() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("Model A.obj");
    std::fs::write(&scene, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    let run = |program: &str, more: &[&str]| {
        let out = folder.path().join("out");
        let mut command = Command::new(program);
        command.arg("--scene").arg(&scene).args(["--light-dir", "1,-2,0.5", "--quick", "--out"]);
        let output = command.arg(&out).args(more).output().unwrap();
        let errors = String::from_utf8(output.stderr).unwrap();
        assert!(out.join("index.html").is_file(), "{program} wrote its report: {errors}");
        (output.status.code(), errors)
    };
    let sweep = env!("CARGO_BIN_EXE_gnomon-sweep");
    let small = ["--map", "16", "--format", "f32", "--strategy", "constant"];
    for (program, more) in [
        (env!("CARGO_BIN_EXE_gnomon-report"), &["--map", "16"][..]),
        (env!("CARGO_BIN_EXE_gnomon-tune"), &["--map", "16"]),
        (sweep, &small),
    ] {
        let (code, errors) = run(program, more);
        assert_eq!(code, Some(3), "{program}: {errors}");
        assert!(errors.contains("Model A: no receiver was measured"), "{errors}");
    }
    for gate in [["--fail-acne", "100%"], ["--fail-peter-panning", "9"]] {
        let (code, errors) = run(sweep, &[&small[..], &gate].concat());
        assert_eq!(code, Some(1), "{errors}");
        assert!(errors.contains("not measured"), "{errors}");
    }
}
