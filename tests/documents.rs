//! The main job: counts add up, findings turn over, bytes repeat, mistakes are one sentence.

#[path = "support/schema.rs"]
mod schema;

use gnomon::analysis::documents::findings::{CLAIMS, by_name, evaluate};
use gnomon::analysis::documents::{self, Options, Which};
use gnomon::analysis::measure::measure;
use gnomon::analysis::observe::Standing;
use gnomon::report::{Profile, Verdict};
use gnomon::scene::cases;
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::Command;
use std::sync::OnceLock;

fn options() -> Options {
    Options { profile: Profile::Quick, ..Options::default() }
}

/// The quick results, measured once for all tests of this file.
fn results() -> &'static Value {
    static RESULTS: OnceLock<Value> = OnceLock::new();
    RESULTS.get_or_init(|| documents::report(&options(), || ()).expect("the main job").results)
}

#[test]
fn results_follow_their_schema() {
    let text = include_str!("fixtures/results.schema.json");
    let rules: Value = serde_json::from_str(text).expect("a schema");
    let found = schema::violations(&rules, &rules, results(), "results");
    assert!(found.is_empty(), "{found:#?}");
    let mut broken = results().clone();
    broken["cases"][0]["false_shadow"]["rate"] = 1.5.into();
    broken["cases"][1].as_object_mut().expect("a case").remove("verdict");
    broken["findings"][0]["verdict"] = "perhaps".into();
    let found = schema::violations(&rules, &rules, &broken, "results");
    assert_eq!(found.len(), 3, "the checker can fail: {found:#?}");
}

fn number(v: &Value) -> u64 {
    v.as_u64().unwrap_or_else(|| panic!("{v} is no count"))
}

#[test]
fn every_count_adds_up() {
    let list = results()["cases"].as_array().expect("cases");
    assert_eq!(list.len(), 17, "13 systems of the documents and 4 closed forms");
    for case in list {
        let name = case["name"].as_str().expect("a name");
        let s = &case["samples"];
        let parts =
            ["background", "counted", "ambiguous", "facing_away", "outside_cone", "outside_map"];
        let sum: u64 = parts.iter().map(|p| number(&s[*p])).sum();
        assert_eq!(sum, number(&s["pixels"]), "{name}: every pixel has one standing");
        assert_eq!(
            number(&case["lit"]) + number(&case["shadowed"]),
            number(&s["counted"]),
            "{name}"
        );
        for wrong in ["false_shadow", "false_light"] {
            for group in ["by_cause", "by_artifact"] {
                let parts = case[wrong][group].as_object().expect("a group");
                let sum: u64 = parts.values().map(number).sum();
                assert_eq!(sum, number(&case[wrong]["count"]), "{name} {wrong} {group}");
            }
        }
        let kinds = case["seen_by_kind"].as_object().expect("shares by kind").values();
        let sum: f64 = kinds.map(|share| share.as_f64().expect("a share")).sum();
        let seen = case["seen"].as_f64().expect("receivers face the light");
        assert!((sum - seen).abs() <= 1e-12, "{name}: {sum} by kind, {seen} seen");
        let wrong_at_end = number(&case["wrong_on_rung"]["filter"]);
        let total = number(&case["false_shadow"]["count"]) + number(&case["false_light"]["count"]);
        assert_eq!(wrong_at_end, total, "{name}: the last rung is the subject");
        assert!(number(&s["ambiguous"]) * 1_000_000 <= number(&s["pixels"]), "{name}: ambiguous");
    }
}

#[test]
fn findings_hold_and_turn_over() {
    let named = by_name(results());
    for (finding, claim) in evaluate(&named).iter().zip(CLAIMS) {
        assert_eq!(finding.verdict, Verdict::Supported, "{}: {}", claim.id, finding.sentence);
        assert!(!finding.sentence.contains("Undecided"), "{}: {}", claim.id, finding.sentence);
        let (place, value) = claim.counter_example;
        let mut other = named.clone();
        let target = other.pointer_mut(place).unwrap_or_else(|| panic!("{}: no {place}", claim.id));
        *target = serde_json::json!(value);
        let index = CLAIMS.iter().position(|c| c.id == claim.id).expect("itself");
        let turned = evaluate(&other).swap_remove(index);
        assert_eq!(turned.verdict, Verdict::Contradicted, "{} with {place} = {value}", claim.id);
        assert_ne!(turned.sentence, finding.sentence, "{}", claim.id);
    }
}

#[test]
fn a_finding_without_its_numbers_is_undecided() {
    let one = Options { which: Which::Named("upc".to_string()), ..options() };
    let report = documents::report(&one, || ()).expect("one case");
    let findings = evaluate(&by_name(&report.results));
    let of = |id: &str| findings.iter().find(|f| f.id == id).expect("a finding").verdict;
    assert_eq!(of("upc-acne"), Verdict::Supported);
    assert_eq!(of("bias-exceeds-gap"), Verdict::Undecided);
}

#[test]
fn the_curve_equals_the_literal_rule() {
    for name in ["book-r8-y7", "upc", "fundamentals-spot", "exam-pcf"] {
        let case = cases::named(name).expect("a case");
        let measured = measure(&case, 8);
        let rule = case.lookup.compare;
        let mut biases: Vec<f32> = vec![0.0, case.bias, -1e-3, 0.5, 1e-7];
        let some = measured.observations.iter().step_by(97).flat_map(|o| o.breakpoints.to_vec());
        biases.extend(some.flat_map(|b| [b.next_down(), b, b.next_up()]));
        for bias in biases {
            let (mut false_shadow, mut false_light) = (0, 0);
            for o in measured.observations.iter().filter(|o| o.standing == Standing::Counted) {
                let lit =
                    (0..o.taps.depths().len()).filter(|&i| o.taps.is_lit(rule, i, bias)).count();
                match o.truly_lit() {
                    Some(true) => false_shadow += u64::from(lit < o.taps.depths().len()),
                    _ => false_light += u64::from(lit > 0),
                }
            }
            let errors = measured.curve.at(bias);
            assert_eq!(errors.false_shadow, false_shadow, "{name} at {bias:e}");
            assert_eq!(errors.false_light, false_light, "{name} at {bias:e}");
        }
    }
}

fn run(arguments: &[&str]) -> (i32, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_gnomon-report"))
        .args(arguments)
        .output()
        .expect("the binary runs");
    (output.status.code().unwrap_or(-1), String::from_utf8_lossy(&output.stderr).into_owned())
}

fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    let mut folders = vec![folder.to_path_buf()];
    while let Some(next) = folders.pop() {
        for entry in fs::read_dir(&next).expect("a folder").flatten() {
            let path = entry.path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_none_or(|e| e != "tmp") {
                let name = path.strip_prefix(folder).expect("inside").display().to_string();
                found.insert(name, fs::read(&path).expect("a file"));
            }
        }
    }
    found
}

#[test]
fn the_same_bytes_with_any_number_of_threads() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut first: Option<BTreeMap<String, Vec<u8>>> = None;
    for threads in ["1", "2", "8"] {
        let out = folder.path().join(threads);
        let (code, message) = run(&[
            "--quick",
            "--case",
            "exam-pcf",
            "--threads",
            threads,
            "--out",
            out.to_str().unwrap(),
        ]);
        assert_eq!(code, 0, "{message}");
        let written = files(&out);
        assert!(written.contains_key("results.json") && written.contains_key("index.html"));
        let reference = first.get_or_insert_with(|| written.clone());
        assert_eq!(reference.keys().collect::<Vec<_>>(), written.keys().collect::<Vec<_>>());
        for (name, bytes) in reference {
            assert!(written[name] == *bytes, "{name} differs with {threads} threads");
        }
    }
}

#[test]
fn mistakes_are_one_sentence_and_write_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("out");
    let out = out.to_str().unwrap();
    for (arguments, word) in [
        (vec!["--case", "nonsense", "--out", out], "book-r8-y7"),
        (vec!["explain", "--case", "upc", "--pixel", "0,0"], "background"),
        (vec!["explain", "--case", "upc", "--pixel", "4000,0"], "outside the canvas"),
    ] {
        let (code, message) = run(&arguments);
        assert_eq!(code, 2, "{message}");
        assert_eq!(message.trim_end().lines().count(), 1, "{message}");
        assert!(message.contains(word), "{message} lacks {word}");
    }
    assert!(!Path::new(out).exists(), "nothing is written");
    let file = folder.path().join("file");
    fs::write(&file, "in the way").unwrap();
    let (code, message) =
        run(&["--quick", "--case", "upc", "--out", file.join("x").to_str().unwrap()]);
    assert_eq!(code, 4, "{message}");
    assert_eq!(fs::read_to_string(&file).unwrap(), "in the way");
}
