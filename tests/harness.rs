//! What every binary promises a shell: exit codes, one sentence on stderr, quiet pipes, devices in files.

use std::path::Path;
use std::process::{Command, Output, Stdio};

fn report(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_gnomon-report"));
    command.args(arguments);
    command
}

fn conformance(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_gnomon-conformance"));
    command.args(arguments).output().expect("the binary runs")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).expect("UTF-8")
}

/// Exit code 2 and one sentence on stderr that has all `words`.
fn refused(output: &Output, words: &[&str]) {
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert_eq!(said.lines().count(), 1, "{said}");
    assert!(said.starts_with("error: "), "{said}");
    for word in words {
        assert!(said.contains(word), "'{word}' is not in: {said}");
    }
    assert!(output.stdout.is_empty(), "{}", text(&output.stdout));
}

const QUICK: [&str; 3] = ["--quick", "--case", "book-r8-y7"];

#[test]
fn a_run_that_is_done_exits_0_and_is_silent_in_a_pipe() {
    let out = tempfile::tempdir().unwrap();
    let folder = out.path().join("r").display().to_string();
    let output = report(&QUICK).args(["--out", &folder]).output().unwrap();
    assert_eq!(output.status.code(), Some(0));
    assert_eq!(text(&output.stderr), "");
    assert!(text(&output.stdout).contains("| book-r8-y7"), "{}", text(&output.stdout));
    assert!(Path::new(&folder).join("index.html").is_file());
}

#[test]
fn bad_input_exits_2_and_writes_nothing() {
    let out = tempfile::tempdir().unwrap();
    let folder = out.path().join("r").display().to_string();
    let output = report(&["--case", "no-such", "--out", &folder]).output().unwrap();
    refused(&output, &["--case 'no-such'", "book-r8-y7"]);
    assert!(!Path::new(&folder).exists());
}

#[test]
fn an_output_that_cannot_be_written_exits_4() {
    let out = tempfile::tempdir().unwrap();
    let file = out.path().join("file");
    std::fs::write(&file, "in the way").unwrap();
    let folder = file.join("r").display().to_string();
    let output = report(&QUICK).args(["--out", &folder]).output().unwrap();
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(4), "{said}");
    assert_eq!(said.lines().count(), 1, "{said}");
    assert_eq!(std::fs::read_to_string(&file).unwrap(), "in the way");
}

#[test]
fn a_reader_that_goes_away_ends_the_program_quietly() {
    let out = tempfile::tempdir().unwrap();
    let folder = out.path().display().to_string();
    let mut command = report(&QUICK);
    let command = command.args(["--out", &folder, "--json", "-"]);
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    assert_eq!(text(&output.stderr), "");
}

/// R50: how a run is watched and where its numbers go changes no byte of the report.
#[test]
fn threads_and_json_change_no_published_byte() {
    let out = tempfile::tempdir().unwrap();
    let published = |name: &str, more: &[&str]| {
        let folder = out.path().join(name);
        let output = report(&QUICK).arg("--out").arg(&folder).args(more).output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        std::fs::read_to_string(folder.join("manifest.json")).unwrap()
    };
    let plain = published("plain", &["--threads", "1"]);
    assert_eq!(published("json", &["--json", "-", "--threads", "3"]), plain);
    let verified = report(&["--verify"]).arg(out.path().join("json")).output().unwrap();
    assert_eq!(verified.status.code(), Some(0), "{}", text(&verified.stderr));
    assert!(text(&verified.stdout).contains("are as they were written"));
    std::fs::write(out.path().join("json/results.json"), "{}").unwrap();
    let verified = report(&["--verify"]).arg(out.path().join("json")).output().unwrap();
    assert_eq!(verified.status.code(), Some(1), "{}", text(&verified.stderr));
}

/// R50: with a terminal (which `script` provides) there is a progress bar, and the same files.
#[cfg(unix)]
#[test]
fn a_terminal_changes_no_published_byte() {
    let out = tempfile::tempdir().unwrap();
    let manifest = |name: &str| std::fs::read(out.path().join(name).join("manifest.json")).unwrap();
    let folder = |name: &str| out.path().join(name).display().to_string();
    assert!(report(&QUICK).args(["--out", &folder("pipe")]).output().unwrap().status.success());
    let binary = env!("CARGO_BIN_EXE_gnomon-report");
    let command = format!("{binary} {} --out {}", QUICK.join(" "), folder("terminal"));
    let mut script = Command::new("script");
    let script = script.args(["--quiet", "--return", "--command", &command, "/dev/null"]);
    let output = script.stdin(Stdio::null()).output().expect("util-linux has script");
    let said = text(&output.stdout);
    assert!(output.status.success(), "{said}");
    assert!(said.contains("measuring ["), "a bar is shown: {said}");
    assert_eq!(manifest("terminal"), manifest("pipe"));
}

#[cfg(unix)]
#[test]
fn an_interrupt_exits_130_and_leaves_earlier_files() {
    let out = tempfile::tempdir().unwrap();
    let folder = out.path().display().to_string();
    assert!(report(&QUICK).args(["--out", &folder]).output().unwrap().status.success());
    let before = std::fs::read(out.path().join("manifest.json")).unwrap();
    let mut child = report(&["--full", "--out", &folder, "--threads", "1"])
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    std::thread::sleep(std::time::Duration::from_millis(300));
    let kill = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(kill.success() && child.try_wait().unwrap().is_none(), "it was still at work");
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130), "{}", text(&output.stderr));
    assert_eq!(std::fs::read(out.path().join("manifest.json")).unwrap(), before);
}

/// R47: every binary that writes a folder holds it from before its work.
#[test]
fn a_held_folder_is_refused_at_once_by_every_binary() {
    let out = tempfile::tempdir().unwrap();
    let _held = gnomon::output::Lock::hold(out.path()).unwrap();
    for binary in [
        env!("CARGO_BIN_EXE_gnomon-report"),
        env!("CARGO_BIN_EXE_gnomon-roundtrip"),
        env!("CARGO_BIN_EXE_gnomon-formats"),
        env!("CARGO_BIN_EXE_gnomon-sweep"),
        env!("CARGO_BIN_EXE_gnomon-tune"),
        env!("CARGO_BIN_EXE_gnomon-stress"),
        env!("CARGO_BIN_EXE_gnomon-pareto"),
    ] {
        let mut command = Command::new(binary);
        let start = std::time::Instant::now();
        let output = command.args(["--quick", "--out"]).arg(out.path()).output().unwrap();
        refused(&output, &[&format!("locked by pid {}", std::process::id())]);
        assert!(start.elapsed() < std::time::Duration::from_secs(2), "{binary}");
    }
}

/// A folder with one file of that text, and the file's path.
fn device_file(text: &str) -> (tempfile::TempDir, String) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("gpu.json");
    std::fs::write(&path, text).unwrap();
    let path = path.display().to_string();
    (folder, path)
}

#[test]
fn a_measured_device_stands_beside_the_nearest_profiles() {
    let (_folder, path) = device_file(
        r#"{"schema": "gnomon-device-1", "renderer": "Phone 3000",
            "device": {"subpixel_bits": 8, "store": "truncate", "load": "divide", "depth24": "unorm24",
                       "fma": false, "flush_denormals": false, "clamp_frag_z": true,
                       "slope_norm": "unknown"},
            "polygon_offset": {"unorm16": {"r": 3.0517578125e-5}}}"#,
    );
    let output = conformance(&["--device", &path]);
    let said = text(&output.stdout);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    assert!(said.contains("Phone 3000"), "{said}");
    assert!(said.contains("differs from truncating in offset_unit."), "{said}");
    assert!(said.contains("differs from ideal in store, offset_unit."), "{said}");
    assert!(said.contains("taken from ideal: setup, nearest, slope_norm."), "{said}");
    assert!(said.contains("explain it: doubled, amd-pal."), "{said}");
    let json = conformance(&["--device", &path, "--json", "-"]);
    let json: serde_json::Value = serde_json::from_slice(&json.stdout).unwrap();
    assert_eq!(json["device"]["profile"]["offset_unit"], "doubled");
    assert_eq!(json["device"]["nearest"], serde_json::json!(["truncating", "ideal"]));
}

#[test]
fn what_is_no_device_is_refused_in_a_sentence() {
    for (given, words) in [
        ("{", &["gpu.json", "valid JSON"][..]),
        ("{}", &["schema", "is missing"]),
        (r#"{"schema": "other-1", "device": {}}"#, &["other-1", "panel"]),
        (r#"{"schema": "gnomon-device-1"}"#, &["device", "is missing"]),
        (
            r#"{"schema": "gnomon-device-1", "device": {"store": "up"}}"#,
            &["device.store", "truncate"],
        ),
        (r#"{"schema": "gnomon-device-1", "device": {"fma": [1]}}"#, &["device.fma", "list"]),
        (
            r#"{"schema": "gnomon-device-1", "device": {"snap": 4}}"#,
            &["device.snap", "subpixel_bits"],
        ),
        (r#"{"schema": "gnomon-device-1", "device": {"subpixel_bits": 4.5}}"#, &["whole number"]),
    ] {
        let (_folder, path) = device_file(given);
        refused(&conformance(&["--device", &path]), words);
    }
    refused(&conformance(&["--device", "absent.json"]), &["absent.json", "cannot be read"]);
    refused(&conformance(&["--device", "ideal"]), &["DIR", "--device"]);
}
