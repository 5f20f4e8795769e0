//! The command line of `gnomon-roundtrip`: a user's own pair, what the files say, and bad input.

use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output};

fn roundtrip(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_gnomon-roundtrip"));
    command.current_dir(folder).args(["--quick", "--out", "out"]).args(arguments);
    command.output().expect("the binary runs")
}

fn json(path: &Path) -> Value {
    serde_json::from_str(&std::fs::read_to_string(path).expect("written")).expect("JSON")
}

const MINE: &str = "base = 255.0\norder = \"low-first\"\nat_one = [0.0, 0.0, 0.0, 1.0]\n";

/// Babylon's operations with an end case for 1: the user's pair errs alike below 1 and keeps far.
#[test]
#[ignore = "soak: two whole runs of the quick profile"]
fn a_pair_in_toml_is_certified_beside_the_catalogue() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("mine.toml"), MINE).expect("a file");
    let arguments = ["--packing", "babylon,godot-3", "--pair", "mine.toml", "--threads", "1"];
    let output = roundtrip(folder.path(), &arguments);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let stdout = String::from_utf8_lossy(&output.stdout);
    assert!(stdout.contains("| mine "), "a row in the table: {stdout}");

    let results = json(&folder.path().join("out/results.json"));
    let packings = results["packings"].as_array().expect("a list");
    let names: Vec<&str> = packings.iter().filter_map(|p| p["name"].as_str()).collect();
    assert_eq!(names, ["babylon", "godot-3", "mine"]);
    assert_eq!(packings[1]["same_operations_as"], "babylon");
    let plain = |i: usize| &packings[i]["certificates"][0];
    assert_eq!(plain(0)["max"], plain(2)["max"]);
    assert_eq!((&plain(0)["at_one"], &plain(2)["at_one"]), (&0.0.into(), &1.0.into()));
    assert_eq!(plain(2)["answered"], 1_065_353_217u64);
    assert!(plain(0)["bound"].as_f64() >= plain(0)["max"].as_f64());

    // Any number of threads gives the same bytes.
    let page = std::fs::read(folder.path().join("out/index.html")).expect("a page");
    let again = roundtrip(folder.path(), &[&arguments[..5], &["2"]].concat());
    assert!(again.status.success());
    assert_eq!(page, std::fs::read(folder.path().join("out/index.html")).expect("a page"));
}

#[test]
fn bad_input_is_one_sentence_and_exit_code_2() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("bad.toml"), "base = 255.0\norder = \"up\"").expect("a file");
    std::fs::write(folder.path().join("nan.toml"), "base = nan\norder = \"low-first\"")
        .expect("a file");
    let cases: [(&[&str], &str); 6] = [
        (&["--fraction", "1.5"], "--fraction"),
        (&["--pair", "bad.toml"], "bad.toml"),
        (&["--pair", "nan.toml"], "base"),
        (&["--pair", "missing.toml"], "missing.toml"),
        (&["--pair", "."], "."),
        (&["--packing", "bok"], "bok"),
    ];
    for (arguments, place) in cases {
        let output = roundtrip(folder.path(), arguments);
        let message = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
        assert!(message.contains(place), "{arguments:?}: {message}");
        assert!(!message.contains("panicked"), "{arguments:?}: {message}");
        assert!(!folder.path().join("out").exists(), "nothing is written");
    }
}
