//! A scene may be called anything: ids are made of its name, and people read the name as it is.

use gnomon::analysis::documents::{self, Options, Which};
use gnomon::analysis::sweep::{Plan, Range, report, run};
use gnomon::analysis::tune::{self, Request};
use gnomon::analysis::{formats, pareto};
use gnomon::depth::DepthFormat;
use gnomon::engines::Engine;
use gnomon::output::OutFile;
use gnomon::report::slug::slugs;
use gnomon::report::{Profile, Report};
use gnomon::scene::cases;
use gnomon::scene::{Case, TexelFormat};
use gnomon::scene_file::SceneFile;
use gnomon::shadow::bias::Strategy;
use std::collections::BTreeSet;
use std::path::Path;

const SCENE: &str = "o =floor\nv -2 0 -2\nv 2 0 -2\nv 2 0 2\nv -2 0 2\nf 1 2 3\nf 1 3 4\n\
                     o tri\nv -0.5 1 -0.5\nv 0.5 1 -0.5\nv 0 1 0.5\nf 5 7 6\n";
const SETTINGS: &str = "canvas = [16, 16]\n[map]\nsize = 16\n[light]\ndirection = [0.2, -1, 0.1]\n";

/// The little scene in a file of this stem.
fn scene(folder: &Path, stem: &str) -> Case {
    let path = folder.join(format!("{stem}.obj"));
    std::fs::write(&path, SCENE).unwrap();
    let config = folder.join("settings of all.toml");
    std::fs::write(&config, SETTINGS).unwrap();
    let file = SceneFile { scene: Some(path), config: Some(config), ..SceneFile::default() };
    file.case().unwrap().unwrap()
}

/// The same case under another name, without a file.
fn named(case: &Case, name: &str) -> Case {
    Case { name: name.to_string(), ..case.clone() }
}

fn plan(cases: Vec<Case>) -> Plan {
    Plan {
        cases,
        sizes: vec![16],
        formats: vec![TexelFormat::Depth(DepthFormat::F32)],
        filters: vec![None],
        strategies: vec![Strategy::Constant],
        bias: Range { low: 1e-6, high: 1e-1, log: true, count: 4 },
        step: 1,
        max_acne: 0.0,
    }
}

fn swept(cases: &[Case]) -> Report {
    let plan = plan(cases.to_vec());
    report::report(&plan, &run(&plan, || {}), Profile::Quick, 1, String::new())
}

fn compared(cases: &[Case]) -> Report {
    formats::report(cases, Profile::Quick, 1, || {})
}

fn measured(cases: &[Case]) -> Report {
    let which = Which::Own(Box::new(cases[0].clone()));
    let options = Options { which, profile: Profile::Quick, ..Options::default() };
    documents::report(&options, || {}).unwrap()
}

/// The reports whose ids are made of names.
const REPORTS: [fn(&[Case]) -> Report; 3] = [measured, swept, compared];

fn tuned(case: &Case) -> Report {
    tune::report(&Request {
        case: case.clone(),
        engine: Engine::Vulkan,
        max_acne: 0.001,
        profile: Profile::Quick,
        seed: 1,
        command: String::new(),
    })
}

fn page(files: &[OutFile]) -> String {
    let page = files.iter().find(|f| f.name == "index.html").unwrap();
    String::from_utf8(page.bytes.clone()).unwrap()
}

/// Everything that must hold of a report on a scene of this name.
fn check(report: &Report, name: &str) {
    let files = report.files();
    let page = page(&files);
    let mut ids = BTreeSet::new();
    for id in page.split(" id=\"").skip(1).map(|rest| rest.split('"').next().unwrap()) {
        assert!(ids.insert(id.to_string()), "{name}: two elements are called '{id}'");
        assert!(!id.is_empty() && id.len() <= 110, "{name}: {id}");
    }
    for to in page.split("href=\"#").skip(1).map(|rest| rest.split('"').next().unwrap()) {
        assert!(ids.contains(to), "{name}: nothing is called '{to}'");
    }
    for file in &files {
        let good = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || "-./".contains(c);
        assert!(file.name.chars().all(good), "{name}: {}", file.name);
        assert!(file.name.rsplit('/').next().unwrap().len() <= 110, "{name}: {}", file.name);
    }
    let escaped = name.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
    let escaped = escaped.replace('"', "&quot;").replace('\'', "&#x27;").replace('/', "&#x2f;");
    assert!(page.contains(&escaped), "{name} is not to be read on the page");
}

/// Names that met a panic, or could: of files, of the page's own parts, of nothing that is a letter.
const NAMES: [&str; 26] = [
    "Model",
    "my model",
    "model_1",
    "model.v2",
    "ü",
    "Füße",
    "模型",
    "😀",
    "...",
    "-",
    "--out",
    "=1+1",
    "@SUM(A1)",
    "a&b",
    "it's <b>\"bold\"</b>",
    "windows",
    "Windows",
    "cases",
    "cases-bias",
    "overview",
    "findings",
    "method",
    "gpu",
    "upc-acne",
    "scene",
    "upc",
];

#[test]
fn every_file_name_is_reported_on() {
    let folder = tempfile::tempdir().unwrap();
    let long = "x".repeat(240);
    for stem in NAMES.into_iter().filter(|name| !name.contains('/')).chain([long.as_str()]) {
        let case = scene(folder.path(), stem);
        assert_eq!(case.name, stem, "the visible name stays");
        for report in REPORTS {
            check(&report(std::slice::from_ref(&case)), stem);
        }
    }
    check(&tuned(&scene(folder.path(), "It's my Model")), "It's my Model");
}

#[test]
fn a_name_may_be_that_of_any_part_of_the_page() {
    let folder = tempfile::tempdir().unwrap();
    let case = scene(folder.path(), "plain");
    for report in REPORTS {
        let page = page(&report(std::slice::from_ref(&case)).files());
        let ids: BTreeSet<&str> =
            page.split(" id=\"").skip(1).map(|rest| rest.split('"').next().unwrap()).collect();
        for id in ids {
            check(&report(&[named(&case, id)]), id);
        }
    }
}

#[test]
fn scenes_whose_names_are_alike_stay_apart() {
    let folder = tempfile::tempdir().unwrap();
    let case = scene(folder.path(), "plain");
    let names = ["A b", "a-b", "a b", "a-b-curve", "a-b-formats", "a-b-f32", "", "ü", "a-b-front"];
    let cases: Vec<Case> = names.iter().map(|name| named(&case, name)).collect();
    check(&swept(&cases), "a-b-curve");
    check(&compared(&cases), "a-b-curve");
    let plan = plan(cases);
    let entries = pareto::entries(&plan, || {});
    check(&pareto::report::report(&plan, &entries, &[], Profile::Quick, 1), "a-b-front");
}

#[test]
fn the_catalogues_names_are_their_ids() {
    let names: Vec<String> = cases::all().into_iter().map(|case| case.name).collect();
    assert_eq!(slugs(names.iter().map(String::as_str), &[], &[]), names);
}

#[test]
fn control_characters_of_a_name_are_not_shown() {
    let folder = tempfile::tempdir().unwrap();
    let case = scene(folder.path(), "a\u{1b}[31m\nb");
    assert_eq!(case.name, "a\u{fffd}[31m\u{fffd}b");
}

#[test]
fn no_cell_is_a_formula() {
    let folder = tempfile::tempdir().unwrap();
    let case = scene(folder.path(), "=cmd|' !A0");
    for report in REPORTS {
        for file in report(std::slice::from_ref(&case)).files() {
            if file.name.ends_with(".csv") {
                no_formula(&file);
            }
        }
    }
}

fn no_formula(file: &OutFile) {
    let mut reader = csv::ReaderBuilder::new().has_headers(false).from_reader(&*file.bytes);
    for record in reader.records().map(Result::unwrap) {
        for cell in &record {
            let formula = cell.starts_with(['=', '+', '-', '@', '\t', '\r']);
            assert!(!formula || cell.parse::<f64>().is_ok(), "{}: {cell}", file.name);
        }
    }
}
