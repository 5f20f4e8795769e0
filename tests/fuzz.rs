//! Every reader of untrusted bytes survives its corpus, byte mutations of it, and (by hand) millions more.

#[path = "fuzz/mutate.rs"]
#[allow(unreachable_pub, reason = "the fuzz crate uses it too")]
mod mutate;
#[path = "fuzz/readers.rs"]
#[allow(unreachable_pub, reason = "the fuzz crate uses it too")]
mod readers;

use mutate::{Random, mutant};
use rayon::prelude::*;
use readers::{READERS, Reader};
use std::cell::RefCell;
use std::collections::BTreeSet;
use std::fs;
use std::panic::{self, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::Once;
use std::time::{Duration, Instant};

/// R31: an input of at most 64 KiB is done within this.
const SLOWEST: Duration = Duration::from_secs(1);

fn folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fuzz/corpus").join(name)
}

/// The corpus files of a reader in order of their names, the empty file among them.
fn corpus(name: &str) -> Vec<Vec<u8>> {
    let mut paths: Vec<_> =
        fs::read_dir(folder(name)).unwrap().map(|e| e.unwrap().path()).collect();
    paths.sort();
    let files = paths.iter().map(|path| fs::read(path).unwrap());
    files.chain([Vec::new()]).collect()
}

thread_local! {
    /// Where the input that is being read panicked; `None` outside of [`feed`].
    static PANIC: RefCell<Option<String>> = const { RefCell::new(None) };
}

/// Panics of a reader are noted, all others are printed as ever.
fn note_panics() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let usual = panic::take_hook();
        panic::set_hook(Box::new(move |info| {
            let noted = PANIC.with_borrow_mut(|place| {
                let reading = place.is_some();
                *place = reading.then(|| info.to_string().replace('\n', " "));
                reading
            });
            if !noted {
                usual(info);
            }
        }));
    });
}

/// What a run of one reader saw.
#[derive(Default)]
struct Seen {
    slowest: Duration,
    /// Panics and inputs beyond [`SLOWEST`], each place once.
    faults: BTreeSet<String>,
}

impl Seen {
    /// Feeds one input; the first of each fault is kept as a file.
    fn feed(&mut self, (name, reader): Reader, bytes: &[u8]) {
        PANIC.set(Some(String::new()));
        let timed = || {
            let start = Instant::now();
            (catch_unwind(|| reader(bytes)).is_ok(), start.elapsed())
        };
        let (calm, mut taken) = timed();
        // The machine may have been busy: an input is slow if it is slow three times.
        for _ in 0..2 {
            taken = if calm && taken > SLOWEST { taken.min(timed().1) } else { taken };
        }
        let place = PANIC.take().unwrap_or_default();
        self.slowest = self.slowest.max(taken);
        if !calm || taken > SLOWEST {
            let number = self.faults.len();
            let fault = if calm { format!("{name} is slow") } else { format!("{name} {place}") };
            if self.faults.insert(fault) {
                let path = std::env::temp_dir().join(format!("gnomon-fuzz-{name}-{number}"));
                fs::write(path, bytes).unwrap();
            }
        }
    }

    fn join(mut self, other: Self) -> Self {
        self.faults.extend(other.faults);
        Self { slowest: self.slowest.max(other.slowest), faults: self.faults }
    }
}

/// Mutants of a reader's corpus from a seed.
fn stress(reader: Reader, seed: u64, executions: u64) -> Seen {
    note_panics();
    let (corpus, mut random) = (corpus(reader.0), Random::new(seed));
    let mut seen = Seen::default();
    (0..executions).for_each(|_| seen.feed(reader, &mutant(&corpus, &mut random)));
    seen
}

#[track_caller]
fn none(faults: &BTreeSet<String>) {
    let list: Vec<_> = faults.iter().map(String::as_str).collect();
    assert!(
        list.is_empty(),
        "inputs lie in {}:\n{}",
        std::env::temp_dir().display(),
        list.join("\n")
    );
}

#[test]
fn the_corpus_is_small_and_each_reader_has_one() {
    let mut bytes = 0;
    for (name, _) in READERS {
        let files = corpus(name);
        assert!(files.len() >= 5, "{name} has {} files", files.len());
        bytes += files.iter().map(Vec::len).sum::<usize>();
        let target = folder("../fuzz_targets").join(format!("{name}.rs"));
        assert!(target.exists(), "{} is missing", target.display());
    }
    assert!(bytes <= 200_000, "{bytes} bytes");
}

#[test]
fn every_reader_survives_its_corpus_and_mutations_of_it() {
    let mut faults = BTreeSet::new();
    for reader in READERS {
        let mut seen = stress(reader, 1, 2_000);
        corpus(reader.0).iter().for_each(|file| seen.feed(reader, file));
        faults.extend(seen.faults);
    }
    none(&faults);
}

/// R31. `GNOMON_FUZZ=1000000` executions a reader (the default), `GNOMON_FUZZ_SEED` another sequence,
/// `GNOMON_FUZZ_READER` one reader alone.
#[test]
#[ignore = "soak: 10^6 executions a reader, minutes"]
fn every_reader_survives_a_long_run() {
    const PARTS: u64 = 64;
    let number = |name: &str, default: u64| {
        std::env::var(name).map_or(default, |text| text.parse().expect("a whole number"))
    };
    let (executions, seed) = (number("GNOMON_FUZZ", 1_000_000), number("GNOMON_FUZZ_SEED", 2));
    let only = std::env::var("GNOMON_FUZZ_READER").unwrap_or_default();
    let mut faults = BTreeSet::new();
    for reader in READERS.into_iter().filter(|r| only.is_empty() || only == r.0) {
        let start = Instant::now();
        let part = |i: u64| stress(reader, (seed << 32) + i, executions.div_ceil(PARTS));
        let seen = (0..PARTS).into_par_iter().map(part).reduce(Seen::default, Seen::join);
        let (name, took, slowest) = (reader.0, start.elapsed(), seen.slowest);
        let rate = executions as f64 / took.as_secs_f64();
        println!(
            "{name:14} {executions} executions in {took:.0?}, {rate:.0} a second, slowest {slowest:.1?}"
        );
        faults.extend(seen.faults);
    }
    none(&faults);
}
