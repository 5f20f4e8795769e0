//! A signal at any moment: the old files and the signal's code, or the new files and 0; never a mixture.
#![cfg(unix)]

#[path = "support/sweeping.rs"]
mod sweeping;

use std::collections::BTreeMap;
use std::fs;
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use sweeping::{content, said};

type Files = BTreeMap<String, Vec<u8>>;

/// Each program with a run of a fraction of a second.
fn programs() -> Vec<(&'static str, Vec<&'static str>)> {
    vec![
        (env!("CARGO_BIN_EXE_gnomon-report"), vec!["--quick", "--case", "book-r8-y7"]),
        (env!("CARGO_BIN_EXE_gnomon-tune"), vec!["--quick"]),
        (
            env!("CARGO_BIN_EXE_gnomon-sweep"),
            [&sweeping::AXES[..], &["--bias", "1e-6:1e-1:log:20"]].concat(),
        ),
        (env!("CARGO_BIN_EXE_gnomon-stress"), vec!["--quick"]),
        (env!("CARGO_BIN_EXE_gnomon-roundtrip"), vec!["--quick", "--packing", "book"]),
        (env!("CARGO_BIN_EXE_gnomon-formats"), vec!["--quick", "--case", "book-r8-y7"]),
    ]
}

fn start(program: &str, arguments: &[&str], seed: &str, folder: &Path) -> Child {
    let mut command = Command::new(program);
    command.args(arguments).args(["--seed", seed, "--out"]).arg(folder);
    command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().expect("the binary starts")
}

fn copy(files: &Files, folder: &Path) {
    for (name, bytes) in files {
        let path = folder.join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, bytes).unwrap();
    }
}

/// What became of signals, and the slowest stop.
#[derive(Debug, Default)]
struct Tally {
    stopped: u32,
    too_late: u32,
    over: u32,
    not_yet: u32,
    slowest: Duration,
}

/// A program over an older report, signalled after `wait`.
struct Trial<'a> {
    program: &'a str,
    arguments: &'a [&'a str],
    old: &'a Files,
    new: &'a Files,
}

impl Trial<'_> {
    fn run(&self, wait: Duration, signal: (&str, i32), tally: &mut Tally) {
        let out = tempfile::tempdir().unwrap();
        copy(self.old, out.path());
        let mut child = start(self.program, self.arguments, "2", out.path());
        std::thread::sleep(wait);
        let over = child.try_wait().unwrap().is_some();
        let sent = Instant::now();
        let kill = Command::new("kill").args([signal.0, &child.id().to_string()]).output().unwrap();
        let output = child.wait_with_output().unwrap();
        tally.slowest = tally.slowest.max(if over { Duration::ZERO } else { sent.elapsed() });
        let (words, left) = (said(&output.stderr), content(out.path()));
        let told =
            format!("{} {signal:?} after {wait:?}: {:?} {words}", self.program, output.status);
        match output.status.code() {
            Some(0) => {
                assert!(left == *self.new, "0, but not the new files: {told}");
                let late = words.starts_with("interrupted, but the run had already ended");
                assert!(late || words.is_empty(), "{told}");
                *if late { &mut tally.too_late } else { &mut tally.over } += 1;
                assert!(
                    late || over || !kill.status.success() || sent.elapsed().as_millis() < 500,
                    "{told}"
                );
            }
            Some(code) => {
                assert_eq!(code, signal.1, "{told}");
                assert!(left == *self.old, "stopped, but not the old files: {told}");
                assert!(words.starts_with("interrupted: ") && words.lines().count() == 1, "{told}");
                tally.stopped += 1;
            }
            None => {
                assert_eq!(output.status.signal(), Some(signal.1 - 128), "{told}");
                assert!(left == *self.old, "{told}");
                tally.not_yet += 1;
            }
        }
        assert!(!out.path().join(".lock.tmp").exists() || output.status.code().is_none(), "{told}");
    }
}

fn signalled(each: u32, seed: u64) -> Tally {
    let mut generator = fastrand::Rng::with_seed(seed);
    let mut random = move || generator.f64();
    let mut tally = Tally::default();
    for (program, arguments) in programs() {
        let scratch = tempfile::tempdir().unwrap();
        let undisturbed = |seed: &str| {
            let folder = scratch.path().join(seed);
            let begun = Instant::now();
            let output = start(program, &arguments, seed, &folder).wait_with_output().unwrap();
            assert!(output.status.success(), "{program}: {}", said(&output.stderr));
            (content(&folder), begun.elapsed())
        };
        let ((old, _), (new, length)) = (undisturbed("1"), undisturbed("2"));
        assert!(old != new, "{program}: the seed is in the report");
        let trial = Trial { program, arguments: &arguments, old: &old, new: &new };
        for turn in 0..each {
            // Half of them where the files are written, near the end.
            let part = if turn % 2 == 0 { random() * 1.05 } else { 0.75 + 0.3 * random() };
            let signal = if random() < 0.5 { ("-INT", 130) } else { ("-TERM", 143) };
            trial.run(length.mul_f64(part), signal, &mut tally);
        }
    }
    tally
}

#[test]
fn a_signal_leaves_the_old_or_the_new_files() {
    let tally = signalled(2, 1);
    assert!(tally.stopped > 3 && tally.slowest < Duration::from_secs(5), "{tally:?}");
}

#[test]
#[ignore = "soak: 300 signals, some minutes"]
fn three_hundred_signals_leave_no_mixture() {
    println!("{:?}", signalled(50, 16));
}
