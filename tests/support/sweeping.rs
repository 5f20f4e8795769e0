//! A small sweep as a process: run, started, signalled, killed, and its files.

#![allow(dead_code, reason = "each test file uses some of it")]

use std::collections::BTreeMap;
use std::fs;
use std::io::Read;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};

/// Six items of a few milliseconds each.
pub(crate) const AXES: [&str; 9] = [
    "--quick",
    "--case",
    "upc",
    "--map",
    "32,64,96,128,192,256",
    "--format",
    "book,f32",
    "--strategy",
    "receiver-slope",
];

pub(crate) fn sweep(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_gnomon-sweep"));
    command.args(AXES);
    if !arguments.contains(&"--bias") {
        command.args(["--bias", "1e-6:1e-1:log:20"]);
    }
    command.args(arguments);
    command
}

fn into(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = sweep(arguments);
    command.arg("--out").arg(folder);
    command
}

pub(crate) fn run_in(folder: &Path, arguments: &[&str]) -> Output {
    into(folder, arguments).output().expect("the binary runs")
}

pub(crate) fn spawn(folder: &Path, arguments: &[&str]) -> Child {
    let mut command = into(folder, arguments);
    command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().expect("the binary starts")
}

pub(crate) fn signal(child: &Child, name: &str) {
    let sent = Command::new("kill").args([name, &child.id().to_string()]).status();
    assert!(sent.expect("kill runs").success(), "{name}");
}

pub(crate) fn stderr(child: &mut Child) -> String {
    let mut text = String::new();
    child.stderr.take().expect("a pipe").read_to_string(&mut text).expect("UTF-8");
    text
}

pub(crate) fn said(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).expect("UTF-8")
}

#[track_caller]
pub(crate) fn expect(output: &Output, code: i32) {
    let words = said(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{words}");
    assert!(words.lines().count() <= 1, "{words}");
}

/// Every published file below the folder by its name; temporary ones are not.
pub(crate) fn content(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    let mut pending = vec![folder.to_path_buf()];
    while let Some(path) = pending.pop() {
        for entry in fs::read_dir(path).expect("a folder").flatten() {
            let path = entry.path();
            if path.is_dir() {
                pending.push(path);
            } else if path.extension().is_none_or(|e| e != "tmp") {
                let name = path.strip_prefix(folder).expect("below it").display().to_string();
                found.insert(name, fs::read(&path).expect("a file"));
            }
        }
    }
    found
}
