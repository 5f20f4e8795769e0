//! A sweep divided, interrupted, killed and merged gives the bytes of an undisturbed one.

#[path = "support/sweeping.rs"]
mod sweeping;

use gnomon::analysis::effort::Effort;
use gnomon::analysis::sweep::{self, Plan, Range, plan, shard};
use gnomon::harness::{Common, Division, Done, Job, Shard};
use gnomon::report::Profile;
use gnomon::shadow::bias::Strategy;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};
use sweeping::{content, expect, run_in, said, sweep};

#[test]
fn shards_cover_every_item_once() {
    for items in [0, 1, 7, 8, 52, 1000] {
        for count in 1..=12u32 {
            let shard = |i: u32| Shard::parse(&format!("{i}/{count}"), |_| None).unwrap();
            let all: Vec<u32> = (1..=count).flat_map(|i| shard(i).range(items)).collect();
            assert_eq!(all, (0..items).collect::<Vec<_>>(), "{items} items in {count} parts");
            let lengths: Vec<_> = (1..=count).map(|i| shard(i).range(items).len()).collect();
            assert!(lengths.iter().max().unwrap() - lengths.iter().min().unwrap() <= 1);
        }
    }
}

#[test]
fn array_jobs_say_which_shard_they_are() {
    let parse = |text: &str, env: &[(&str, &str)]| {
        let env: BTreeMap<_, _> = env.iter().copied().collect();
        Shard::parse(text, |name| env.get(name).map(ToString::to_string))
    };
    let third = Shard::parse("3/8", |_| None).unwrap();
    let slurm = [
        ("SLURM_ARRAY_TASK_ID", "12"),
        ("SLURM_ARRAY_TASK_MIN", "10"),
        ("SLURM_ARRAY_TASK_COUNT", "8"),
    ];
    assert_eq!(parse("auto", &slurm).unwrap(), third);
    assert_eq!(parse("auto/8", &[("JOB_COMPLETION_INDEX", "2")]).unwrap(), third);
    for (text, env) in [
        ("0/8", &[][..]),
        ("9/8", &[]),
        ("1/0", &[]),
        ("x/8", &[]),
        ("auto", &[]),
        ("auto/8", &[]),
        ("auto/8", &[("JOB_COMPLETION_INDEX", "8")]),
        ("auto/8", &[("JOB_COMPLETION_INDEX", "4294967295")]),
    ] {
        let error = parse(text, env).unwrap_err();
        assert!(error.exit_code() == 2 && error.to_string().contains("--shard"), "{error}");
    }
}

/// The plan, 5 shards out of order and one of them twice, the merge in any order of folders.
#[test]
fn merged_shards_equal_a_single_run() {
    let out = tempfile::tempdir().unwrap();
    let at = |name: &str| out.path().join(name);
    let run_in = |folder: &Path, more: &[&str]| {
        sweeping::run_in(folder, &[&["--case", "book-r8-y7"], more].concat())
    };
    expect(&run_in(&at("single"), &[]), 0);
    let plan = || said(&sweep(&["--case", "book-r8-y7", "--plan"]).output().unwrap().stdout);
    assert_eq!(plan(), plan());
    assert_eq!(plan().lines().filter(|l| !l.starts_with('#')).count(), 12);
    for (part, folder) in [(4, "a"), (1, "b"), (5, "a"), (2, "b"), (3, "c"), (2, "c")] {
        expect(&run_in(&at(folder), &["--shard", &format!("{part}/5")]), 0);
    }
    assert_eq!(content(&at("b"))["shard-2-of-5.items"], content(&at("c"))["shard-2-of-5.items"]);
    let [a, b, c] = ["a", "b", "c"].map(|name| at(name).display().to_string());
    for (name, folders) in [("m1", [&a, &b, &c]), ("m2", [&c, &b, &a])] {
        expect(&run_in(&at(name), &["--merge", folders[0], folders[1], folders[2]]), 0);
        assert_eq!(content(&at(name)), content(&at("single")), "{name}");
    }
    let lacking = run_in(&at("m3"), &["--merge", &a, &b]);
    expect(&lacking, 2);
    assert!(said(&lacking.stderr).contains("3 of 12 items are missing, first 4"));
    assert!(!at("m3").exists(), "a refused merge writes nothing");
    expect(&run_in(&at("m3"), &["--merge", &a, &b, &c, "--max-acne", "1%"]), 5);
}

#[test]
fn a_damaged_shard_is_named() {
    let out = tempfile::tempdir().unwrap();
    expect(&run_in(out.path(), &["--shard", "1/6"]), 0);
    let path = out.path().join("shard-1-of-6.items");
    let mut bytes = fs::read(&path).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    fs::write(&path, bytes).unwrap();
    let folder = out.path().display().to_string();
    let refused = run_in(&out.path().join("m"), &["--merge", &folder]);
    expect(&refused, 2);
    assert!(said(&refused.stderr).contains("shard-1-of-6.items: is damaged from byte"));
    expect(&run_in(out.path(), &["--shard", "1/6"]), 0);
}

#[test]
fn a_journal_of_other_settings_is_refused() {
    let out = tempfile::tempdir().unwrap();
    let journal = out.path().join(".sweep.journal.tmp");
    let mut child = sweeping::spawn(out.path(), &[]);
    while !fs::metadata(&journal).is_ok_and(|m| m.len() > 1000) {
        std::thread::sleep(Duration::from_millis(2));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    if !journal.exists() {
        return println!("SKIPPED: the run was over before it could be killed");
    }
    let refused = run_in(out.path(), &["--resume", "--max-acne", "2%"]);
    expect(&refused, 5);
    assert!(said(&refused.stderr).contains("belongs to another run"), "{}", said(&refused.stderr));
    expect(&run_in(out.path(), &["--resume"]), 0);
    assert!(!journal.exists(), "a journal that has served is gone");
}

/// Ctrl-C and SIGTERM: within 2 s, the command that goes on, and going on gives the same bytes.
#[cfg(unix)]
#[test]
fn an_interrupted_sweep_says_how_to_go_on() {
    let out = tempfile::tempdir().unwrap();
    expect(&run_in(&out.path().join("single"), &[]), 0);
    for (signal, code) in [("-INT", 130), ("-TERM", 143)] {
        let folder = out.path().join(signal);
        let mut child = sweeping::spawn(&folder, &[]);
        while !folder.join(".sweep.journal.tmp").exists() {
            std::thread::sleep(Duration::from_millis(1));
        }
        let sent = Instant::now();
        sweeping::signal(&child, signal);
        let status = child.wait().unwrap();
        assert!(sent.elapsed() < Duration::from_secs(4), "{:?}", sent.elapsed());
        assert_eq!(status.code(), Some(code), "{signal}");
        let words = sweeping::stderr(&mut child);
        assert!(words.starts_with("interrupted: finished items are kept; go on with: "), "{words}");
        assert!(words.trim_end().ends_with("--resume") && words.lines().count() == 1, "{words}");
        expect(&run_in(&folder, &["--resume"]), 0);
        assert_eq!(content(&folder), content(&out.path().join("single")), "{signal}");
    }
}

#[cfg(unix)]
#[test]
fn a_second_interrupt_ends_at_once() {
    let out = tempfile::tempdir().unwrap();
    let mut child = sweeping::spawn(out.path(), &["--bias", "1e-7:1e-1:log:20000"]);
    while !out.path().join(".sweep.journal.tmp").exists() {
        std::thread::sleep(Duration::from_millis(1));
    }
    sweeping::signal(&child, "-INT");
    std::thread::sleep(Duration::from_millis(100));
    let second = Instant::now();
    sweeping::signal(&child, "-INT");
    assert_eq!(child.wait().unwrap().code(), Some(130));
    assert!(second.elapsed() < Duration::from_millis(900), "{:?}", second.elapsed());
}

/// R47.
#[test]
fn the_second_of_two_processes_is_refused_within_a_second() {
    let out = tempfile::tempdir().unwrap();
    let mut first = sweeping::spawn(out.path(), &["--bias", "1e-7:1e-1:log:20000"]);
    while !out.path().join(".sweep.journal.tmp").exists() {
        std::thread::sleep(Duration::from_millis(1));
    }
    let start = Instant::now();
    let second = run_in(out.path(), &[]);
    assert!(start.elapsed() < Duration::from_secs(1), "{:?}", start.elapsed());
    expect(&second, 2);
    let words = said(&second.stderr);
    assert!(words.contains(&format!("locked by pid {}", first.id())), "{words}");
    first.kill().unwrap();
    first.wait().unwrap();
    expect(&run_in(out.path(), &[]), 0);
}

fn common(out: &Path) -> Common {
    let out = Some(out.to_path_buf());
    Common {
        out,
        json: None,
        quick: true,
        full: false,
        threads: None,
        seed: 1,
        force: false,
        verify: None,
        max_memory: None,
    }
}

fn job() -> Job {
    let items = ["zero", "one", "two", "three", "four"].map(String::from).to_vec();
    Job { name: "work", key: "k".into(), items }
}

/// What a run of [`job`] gives.
type Bytes = Done<Vec<u8>>;

/// Runs the job; item 2 panics where `broken`. Also says which items were computed.
fn work(
    division: &Division,
    out: &Path,
    broken: bool,
) -> (gnomon::Result<Option<Bytes>>, Vec<u32>) {
    let computed = RefCell::new(Vec::new());
    let done = division.run(&common(out), &job(), |item| {
        computed.borrow_mut().push(item);
        assert!(!(broken && item == 2), "item {item} fell\nover");
        vec![item as u8; 3]
    });
    (done, computed.into_inner())
}

fn finished(done: &Bytes) -> Vec<u32> {
    done.results.keys().copied().collect()
}

/// R41.
#[test]
fn a_panicking_item_fails_alone_and_is_tried_again() {
    let out = tempfile::tempdir().unwrap();
    let (done, computed) = work(&Division::default(), out.path(), true);
    let done = done.unwrap().unwrap();
    assert_eq!((computed, finished(&done)), (vec![0, 1, 2, 3, 4], vec![0, 1, 3, 4]));
    assert_eq!(done.failures, ["two: panicked: item 2 fell over"]);
    assert!(done.warnings()[0].text.contains("two: panicked"), "{:?}", done.warnings());
    let error = done.close().unwrap_err();
    assert!(error.exit_code() == 3 && error.to_string().contains("two: panicked"), "{error}");
    // What was done is kept: the item that failed is computed again, and it alone.
    let resume = Division { resume: true, ..Division::default() };
    let (done, computed) = work(&resume, out.path(), false);
    let done = done.unwrap().unwrap();
    assert_eq!((computed, finished(&done)), (vec![2], vec![0, 1, 2, 3, 4]));
    done.close().unwrap();
    assert!(!out.path().join(".work.journal.tmp").exists(), "a journal that has served is gone");
}

/// R41 on several machines: a shard with a failed item is written and merged, and mended by `--resume`.
#[test]
fn a_panicking_item_of_a_shard_reaches_the_merge() {
    let out = tempfile::tempdir().unwrap();
    let shard = |text: &str| Division { shard: Some(text.parse().unwrap()), ..Division::default() };
    assert!(work(&shard("1/2"), out.path(), true).0.unwrap().is_none());
    let refused = work(&shard("2/2"), out.path(), true).0.unwrap_err();
    assert!(refused.exit_code() == 3, "{refused}");
    let merge = Division { merge: vec![out.path().to_path_buf()], ..Division::default() };
    let merged = work(&merge, &out.path().join("m"), false).0.unwrap().unwrap();
    assert_eq!((finished(&merged), merged.failures.len()), (vec![0, 1, 3, 4], 1));
    assert_eq!(merged.close().unwrap_err().exit_code(), 3);
    let again = Division { resume: true, ..shard("2/2") };
    assert_eq!(work(&again, out.path(), false).1, [2, 3, 4], "a shard's journal has served");
    let merged = work(&merge, &out.path().join("m"), false).0.unwrap().unwrap();
    assert_eq!(finished(&merged).len(), 5);
    merged.close().unwrap();
}

/// R41: the report of a sweep that lost an item holds the others and says which is missing.
#[test]
fn a_sweep_that_lost_an_item_reports_the_rest() {
    let out = tempfile::tempdir().unwrap();
    let plan = Plan {
        cases: plan::cases_named(&["upc".to_string()]).unwrap(),
        sizes: vec![32, 64],
        formats: vec![plan::format_named("f32").unwrap()],
        filters: vec![None],
        strategies: vec![Strategy::ReceiverSlope],
        bias: Range { low: 1e-6, high: 1e-1, log: true, count: 5 },
        step: 4,
        max_acne: 0.001,
    };
    let job = Job { name: "sweep", key: shard::key(&plan), items: shard::items(&plan) };
    let mut worker = shard::Worker::new(&plan, Effort::default());
    let common = common(out.path());
    let compute = |item| {
        assert!(item != 0, "fell over");
        worker.compute(item)
    };
    let mut done = Division::default().run(&common, &job, compute).unwrap().unwrap();
    let sweeps = shard::assemble(&plan, std::mem::take(&mut done.results));
    assert!(sweeps[0].swept.iter().all(|s| s.size == 64) && !sweeps[0].swept.is_empty());
    let mut report = sweep::report::report(&plan, &sweeps, Profile::Quick, 1, "c".to_string());
    report.warnings.extend(done.warnings());
    common.finish(&report).unwrap();
    let page = fs::read_to_string(out.path().join("index.html")).unwrap();
    assert!(page.contains("upc 32: panicked: fell over"), "the page names what is missing");
    assert_eq!(done.close().unwrap_err().exit_code(), 3);
}
