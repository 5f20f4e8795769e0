//! The rim of the programs: any name, any place for `--json`, any end of a stream, any limit of the system.
#![cfg(unix)]

use std::ffi::OsStr;
use std::fs;
use std::io::Read;
use std::os::unix::ffi::OsStrExt;
use std::os::unix::fs::{FileTypeExt, symlink};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

const TUNE: &str = env!("CARGO_BIN_EXE_gnomon-tune");

fn tune(out: &Path) -> Command {
    let mut command = Command::new(TUNE);
    command.args(["--quick", "--out"]).arg(out);
    command
}

/// Runs `script` in bash with the program as `$1` and the folder as `$2`.
fn shell(script: &str, folder: &Path) -> Output {
    let mut bash = Command::new("bash");
    bash.args(["-c", script, "bash", TUNE]).arg(folder).output().expect("bash runs")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).expect("UTF-8")
}

#[track_caller]
fn expect(output: &Output, code: i32) -> String {
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{said}");
    assert!(said.lines().count() <= 1, "{said}");
    said
}

/// A published report, which later runs are to replace or to leave.
fn published() -> (tempfile::TempDir, PathBuf) {
    let scratch = tempfile::tempdir().unwrap();
    let out = scratch.path().join("o");
    expect(&tune(&out).output().unwrap(), 0);
    (scratch, out)
}

fn is_json(bytes: &[u8]) -> bool {
    serde_json::from_slice::<serde_json::Value>(bytes)
        .is_ok_and(|value| value["schema"].is_string())
}

#[test]
fn json_is_written_into_devices_pipes_and_links() {
    let (scratch, out) = published();
    let at = |name: &str| scratch.path().join(name);
    let json = |path: &Path| tune(&out).arg("--json").arg(path).output().unwrap();

    assert!(Command::new("mkfifo").arg(at("fifo")).status().unwrap().success());
    let fifo = at("fifo");
    let reader = std::thread::spawn(move || fs::read(fifo).unwrap());
    expect(&json(&at("fifo")), 0);
    assert!(is_json(&reader.join().unwrap()));
    assert!(fs::symlink_metadata(at("fifo")).unwrap().file_type().is_fifo());

    fs::create_dir(at("far")).unwrap();
    fs::write(at("far/real.json"), "old").unwrap();
    symlink("far/real.json", at("link")).unwrap();
    symlink("far/none.json", at("dangling")).unwrap();
    for (link, target) in [("link", "far/real.json"), ("dangling", "far/none.json")] {
        expect(&json(&at(link)), 0);
        assert!(fs::symlink_metadata(at(link)).unwrap().is_symlink(), "{link}");
        assert!(is_json(&fs::read(at(target)).unwrap()), "{target}");
    }
    let long = at(&format!("{}.json", "n".repeat(250)));
    expect(&json(&long), 0);
    assert!(is_json(&fs::read(long).unwrap()));

    let node = Command::new("mknod").arg(at("null")).args(["c", "1", "3"]).output().unwrap();
    if node.status.success() {
        expect(&json(&at("null")), 0);
        assert!(fs::symlink_metadata(at("null")).unwrap().file_type().is_char_device());
    } else {
        println!("no right to make a device");
    }
    let left = fs::read_dir(scratch.path()).unwrap().flatten();
    let left: Vec<_> = left.filter(|e| e.path().extension().is_some_and(|e| e == "tmp")).collect();
    assert!(left.is_empty(), "{left:?}");
}

#[test]
fn json_reaches_the_handles_of_a_shell() {
    let (_scratch, out) = published();
    let whole = "\"$1\" --quick --out \"$2/r\" --json";
    for script in [
        format!("{whole} /dev/stdout"),
        format!("{whole} /dev/stdout > \"$2/x\"; cat \"$2/x\""),
        format!("{whole} /dev/fd/3 3> \"$2/x\" > /dev/null; cat \"$2/x\""),
        format!("{whole} >(cat > \"$2/x\") > /dev/null; sleep 0.3; cat \"$2/x\""),
        format!("{whole} - | cat"),
    ] {
        let output = shell(&script, &out);
        expect(&output, 0);
        let (value, rest) = text(&output.stdout)
            .split_once("\n}\n")
            .map(|(v, r)| (format!("{v}\n}}"), r.to_string()))
            .unwrap();
        assert!(is_json(value.as_bytes()), "{script}: {value}");
        assert_eq!(rest.contains("open "), script.contains("stdout"), "{script}: {rest}");
    }
}

#[test]
fn json_that_cannot_be_written_leaves_the_report() {
    let (scratch, out) = published();
    let before = fs::read(out.join("manifest.json")).unwrap();
    fs::create_dir(scratch.path().join("folder")).unwrap();
    for path in ["/dev/full", "folder", "o/index.html/x.json"] {
        let path = scratch.path().join(path);
        let output = tune(&out).args(["--seed", "2", "--json"]).arg(&path).output().unwrap();
        let said = expect(&output, 4);
        assert!(said.contains("cannot be written") && said.contains("untouched"), "{said}");
        assert!(fs::read(out.join("manifest.json")).unwrap() == before, "{}", path.display());
    }
    let output = shell("\"$1\" --quick --seed 2 --out \"$2\" > /dev/full", &out);
    assert!(expect(&output, 4).contains("o had already been written"));
    assert!(fs::read(out.join("manifest.json")).unwrap() != before);
}

#[test]
fn the_users_files_are_named_and_kept() {
    let scratch = tempfile::tempdir().unwrap();
    for name in ["index.html", "manifest.json", "results.csv", "report.json"] {
        let out = scratch.path().join(name.replace('.', "-"));
        fs::create_dir(&out).unwrap();
        fs::write(out.join(name), "mine").unwrap();
        let said = expect(&tune(&out).output().unwrap(), 2);
        assert!(
            said.contains(name) && said.contains("--out") && said.contains("--force"),
            "{said}"
        );
        assert_eq!(fs::read_dir(&out).unwrap().count(), 1, "{name}: nothing else is left");
        assert_eq!(fs::read(out.join(name)).unwrap(), b"mine");
        expect(&tune(&out).arg("--force").output().unwrap(), 0);
        fs::write(out.join("notes.txt"), "mine").unwrap();
        expect(&tune(&out).output().unwrap(), 0);
        assert_eq!(fs::read(out.join("notes.txt")).unwrap(), b"mine");
        assert!(!out.join(".lock.tmp").exists());
    }
}

#[test]
fn names_that_are_no_text_work() {
    let scratch = tempfile::tempdir().unwrap();
    let out = scratch.path().join(OsStr::from_bytes(b"o\xff\x1b\n\xe2\x80\xae"));
    let mut command = tune(&out);
    let output =
        command.arg("--json").arg(out.join(OsStr::from_bytes(b"\xfe.json"))).output().unwrap();
    expect(&output, 0);
    let said = text(&output.stdout);
    assert!(said.contains(r"o\xff\u{1b}\n\u{202e}/index.html"), "{said}");
    assert!(is_json(&fs::read(out.join(OsStr::from_bytes(b"\xfe.json"))).unwrap()));
    // The same folder, the flag and its value in one word, by a program that resumes.
    let sweep = |more: &[&str]| {
        let mut flag = OsStr::new("--out=").to_os_string();
        flag.push(&out);
        let axes = [
            "--quick",
            "--case",
            "upc",
            "--map",
            "32",
            "--format",
            "f32",
            "--strategy",
            "constant",
        ];
        Command::new(env!("CARGO_BIN_EXE_gnomon-sweep"))
            .args(axes)
            .args(more)
            .arg(flag)
            .output()
            .unwrap()
    };
    expect(&sweep(&["--force"]), 0);
    let report = fs::read_to_string(out.join("report.json")).unwrap();
    assert!(report.contains("\"gnomon-sweep --quick") && !report.contains("--out"), "{report}");
}

#[test]
fn nothing_that_steers_a_terminal_reaches_it() {
    let scratch = tempfile::tempdir().unwrap();
    let odd = "a\u{1b}]0;x\u{7}\u{202e}\n\u{9b}31m";
    for arguments in [
        vec!["--scene", odd],
        vec!["--case", odd],
        vec!["--engine", odd],
        vec!["--map", odd],
        vec!["--format", odd],
        vec!["--max-acne", odd],
        vec![odd],
        vec!["--verify", odd],
    ] {
        let output = tune(&scratch.path().join(odd)).args(&arguments).output().unwrap();
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{said}");
        let steers = |c: char| c.is_control() && c != '\n' || c == '\u{202e}';
        assert!(!said.contains(steers), "{arguments:?}: {said:?}");
        assert!(!said.contains("\n\u{9b}") && said.contains("\\u{1b}"), "{arguments:?}: {said:?}");
    }
}

#[test]
fn a_full_or_closed_stderr_changes_no_exit_code() {
    let scratch = tempfile::tempdir().unwrap();
    for end in ["2> /dev/full", "2>&-", "2>&- >&- <&-", "> /dev/full 2> /dev/full"] {
        let output = shell(&format!("\"$1\" --case none --out \"$2/r\" {end}"), scratch.path());
        assert_eq!(output.status.code(), Some(2), "{end}");
    }
}

#[test]
fn limits_of_the_system_are_a_sentence_and_a_code() {
    let (scratch, out) = published();
    let before = fs::read(out.join("manifest.json")).unwrap();
    let output = shell("ulimit -f 1; exec \"$1\" --quick --seed 2 --out \"$2\"", &out);
    assert!(expect(&output, 4).contains("cannot be written"));
    assert!(fs::read(out.join("manifest.json")).unwrap() == before, "a limited run replaced files");
    // An address space of 300 MB holds the program, but not its work.
    let output = shell(
        "ulimit -v 300000; exec \"$1\" --quick --case t4-wall --threads 1 --out \"$2/r\"",
        scratch.path(),
    );
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("memory") || said.contains("threads"), "{said}");
    assert!(!scratch.path().join("r/index.html").exists());
}

/// A reader that takes nothing holds the program, which a signal still ends.
#[test]
fn a_pipe_that_nobody_reads_is_ended_by_a_signal() {
    let (scratch, out) = published();
    let before = fs::read(out.join("manifest.json")).unwrap();
    let fifo = scratch.path().join("fifo");
    assert!(Command::new("mkfifo").arg(&fifo).status().unwrap().success());
    let mut command = tune(&out);
    let command = command.args(["--seed", "2", "--json"]).arg(&fifo).stdout(Stdio::null());
    let mut child = command.stderr(Stdio::piped()).spawn().unwrap();
    while !out.join(".lock.tmp").exists() {
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
    std::thread::sleep(std::time::Duration::from_millis(300));
    let kill = Command::new("kill").args(["-TERM", &child.id().to_string()]).status().unwrap();
    assert!(kill.success());
    assert_eq!(child.wait().unwrap().code(), Some(143));
    let mut said = String::new();
    child.stderr.take().unwrap().read_to_string(&mut said).unwrap();
    assert!(said.starts_with("interrupted: earlier files are untouched"), "{said}");
    assert!(fs::read(out.join("manifest.json")).unwrap() == before);
    assert!(!out.join(".lock.tmp").exists());
}
