//! A long run as work items: planned, divided among machines, kept in a journal, merged again.
//!
//! The items of a run are numbered; what item k gives depends on the run's settings and k alone. A
//! single run computes all of them, shard i of N a contiguous part, and a merge reads what shards have
//! written. All three end with the same outcomes, so whatever is made from them is the same too.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::fs;
use std::ops::Range;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::str::FromStr;

use super::shell::quoted;
use super::{Common, Progress, interrupted, print, signals};
use crate::error::shown;
use crate::output::journal::{Contents, Header, Item, Journal, Outcome, check_ours, encode};
use crate::output::{self, Lock, put};
use crate::report::Warning;
use crate::{Error, Result};

/// Flags that divide a run, resume it and put it together again.
#[derive(Clone, Debug, Default, clap::Args)]
pub struct Division {
    /// Print the numbered work items and stop
    #[arg(long, conflicts_with_all = ["shard", "merge", "resume"])]
    pub plan: bool,
    /// Compute part I of N into a file in --out, for --merge. `auto` takes both from a Slurm array job,
    /// `auto/N` the part from JOB_COMPLETION_INDEX of a Kubernetes indexed job
    #[arg(long, value_name = "I/N", conflicts_with = "merge")]
    pub shard: Option<Shard>,
    /// Make the report from the shards in these folders; give the same axes as to the shards
    #[arg(long, value_name = "DIR", num_args = 1.., conflicts_with = "resume")]
    pub merge: Vec<PathBuf>,
    /// Go on where an interrupted run or shard with the same settings stopped
    #[arg(long)]
    pub resume: bool,
}

/// Part `index` (from 0) of `count`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    index: u32,
    count: u32,
}

impl Shard {
    /// Its items out of `items`: contiguous, and all shards together are every item once.
    #[must_use]
    pub fn range(self, items: u32) -> Range<u32> {
        let cut = |i: u32| (u64::from(items) * u64::from(i) / u64::from(self.count)) as u32;
        cut(self.index)..cut(self.index + 1)
    }

    /// Reads `I/N`, `auto` or `auto/N`, with `env` in place of the environment.
    ///
    /// # Errors
    /// [`Error::BadInput`] where there is no such part, or no such variable.
    pub fn parse(text: &str, env: impl Fn(&str) -> Option<String>) -> Result<Self> {
        let place = format!("--shard '{text}'");
        let bad = |reason: String| {
            let fix = "give I/N such as 3/8, or auto inside an array job";
            Error::bad_input(&place, reason, fix)
        };
        let number = |what: &str, text: &str| {
            text.trim().parse::<u32>().map_err(|_| bad(format!("{what} '{text}' is no number")))
        };
        let variable = |name: &str| env(name).map(|value| number(name, &value)).transpose();
        let (part, count) = text.split_once('/').map_or((text, None), |(i, n)| (i, Some(n)));
        let count = match count {
            Some(count) => number("the count", count)?,
            None => variable("SLURM_ARRAY_TASK_COUNT")?
                .ok_or_else(|| bad("N is not given and SLURM_ARRAY_TASK_COUNT not set".into()))?,
        };
        let part = if part != "auto" {
            number("the part", part)?
        } else if let Some(task) = variable("SLURM_ARRAY_TASK_ID")? {
            let first = variable("SLURM_ARRAY_TASK_MIN")?.unwrap_or(0);
            let step = variable("SLURM_ARRAY_TASK_STEP")?.unwrap_or(1).max(1);
            task.checked_sub(first).map_or(0, |offset| offset / step + 1)
        } else {
            let index = variable("JOB_COMPLETION_INDEX")?.ok_or_else(|| {
                bad("neither SLURM_ARRAY_TASK_ID nor JOB_COMPLETION_INDEX is set".into())
            })?;
            index.saturating_add(1)
        };
        if count == 0 || part == 0 || part > count {
            return Err(bad(format!("there is no part {part} of {count}")));
        }
        Ok(Self { index: part - 1, count })
    }

    /// Name of its file.
    fn file(self) -> String {
        format!("shard-{}-of-{}.items", self.index + 1, self.count)
    }
}

impl FromStr for Shard {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        Self::parse(text, |name| std::env::var(name).ok())
    }
}

/// A run that can be divided.
#[derive(Clone, Debug)]
pub struct Job {
    /// Name of the experiment.
    pub name: &'static str,
    /// SHA-256 of everything the items depend on.
    pub key: String,
    /// Each item in words.
    pub items: Vec<String>,
}

impl Job {
    fn header(&self) -> Header {
        let about =
            format!("gnomon-{}, {} items, key {:.12}", self.name, self.items.len(), self.key);
        Header { key: self.key.clone(), about, items: self.items.len() as u32 }
    }

    fn failures<T>(&self, outcomes: &Finished<T>) -> Vec<String> {
        let failed = outcomes.iter().filter_map(|(&i, o)| Some((i, o.as_ref().err()?)));
        failed.map(|(i, reason)| format!("{}: {reason}", self.items[i as usize])).collect()
    }

    /// Items from a file.
    fn read<T: Item>(&self, outcomes: BTreeMap<u32, Outcome>) -> Result<Finished<T>> {
        let read = |(index, outcome): (u32, Outcome)| {
            let value = match outcome {
                Ok(bytes) => Ok(T::from_bytes(&bytes).ok_or_else(|| {
                    let item = &self.items[index as usize];
                    let place = format!("result of item {index} ({item})");
                    Error::bad_input(place, "cannot be read", "run again without --resume")
                })?),
                Err(reason) => Err(reason),
            };
            Ok((index, value))
        };
        outcomes.into_iter().map(read).collect()
    }
}

/// What each item gave, or why it failed.
type Finished<T> = BTreeMap<u32, std::result::Result<T, String>>;

/// The outcomes of a whole run.
#[derive(Debug)]
#[must_use]
pub struct Done<T> {
    /// What each item gave; those that failed are missing.
    pub results: BTreeMap<u32, T>,
    /// Items that failed, with their parameters and reasons.
    pub failures: Vec<String>,
    journal: Option<Journal>,
    _lock: Lock,
}

impl<T> Done<T> {
    fn new(job: &Job, outcomes: Finished<T>, journal: Option<Journal>, lock: Lock) -> Self {
        let failures = job.failures(&outcomes);
        let results = outcomes.into_iter().filter_map(|(i, outcome)| Some((i, outcome.ok()?)));
        Self { results: results.collect(), failures, journal, _lock: lock }
    }

    /// A caveat for each failed item.
    #[must_use]
    pub fn warnings(&self) -> Vec<Warning> {
        let text = |failure: &String| format!("Left out, since it failed: {failure}.");
        self.failures.iter().map(|f| Warning { about: String::new(), text: text(f) }).collect()
    }

    /// Call once everything is published: the journal has served. Where items failed it stays, so that
    /// `--resume` tries those alone again.
    ///
    /// # Errors
    /// [`Error::Partial`] where items failed.
    pub fn close(self) -> Result<()> {
        partial(&self.failures)?;
        if let Some(journal) = self.journal {
            journal.discard();
        }
        Ok(())
    }
}

fn partial(failures: &[String]) -> Result<()> {
    match failures {
        [] => Ok(()),
        failed => Err(Error::Partial(format!(
            "{} items failed: {}; --resume tries them again",
            failed.len(),
            failed.join("; ")
        ))),
    }
}

impl Division {
    /// Does what the flags say. `None` where nothing is left to do: a plan was printed or a shard
    /// written.
    ///
    /// # Errors
    /// [`Error::ResumeRefused`] where a journal or shard belongs to other settings,
    /// [`Error::BadInput`] where shards are missing or another process holds the folder,
    /// [`Error::Partial`] where items of a shard failed, [`Error::Write`], [`Error::Read`].
    pub fn run<T: Item>(
        &self,
        common: &Common,
        job: &Job,
        compute: impl FnMut(u32) -> T,
    ) -> Result<Option<Done<T>>> {
        if self.plan {
            return print(&plan_text(job)).map(|()| None);
        }
        let folder = common.folder(job.name);
        if !self.merge.is_empty() {
            let merged = merge(&self.merge, job)?;
            return Ok(Some(Done::new(job, job.read(merged)?, None, common.hold(job.name)?)));
        }
        match self.shard {
            Some(shard) => self.part(&folder, job, shard, common.force, compute).map(|()| None),
            None => {
                let lock = common.hold(job.name)?;
                self.whole(&folder, job, lock, compute).map(Some)
            }
        }
    }

    fn whole<T: Item>(
        &self,
        folder: &Path,
        job: &Job,
        lock: Lock,
        compute: impl FnMut(u32) -> T,
    ) -> Result<Done<T>> {
        let path = folder.join(format!(".{}.journal.tmp", job.name));
        let (journal, outcomes) = self.work(&path, job, 0..job.items.len() as u32, compute)?;
        Ok(Done::new(job, outcomes, Some(journal), lock))
    }

    fn part<T: Item>(
        &self,
        folder: &Path,
        job: &Job,
        shard: Shard,
        force: bool,
        compute: impl FnMut(u32) -> T,
    ) -> Result<()> {
        let target = folder.join(shard.file());
        let said = |outcomes: &BTreeMap<u32, Outcome>| {
            print(&format!("{} items in {}\n", outcomes.len(), shown(&target)))?;
            partial(&job.failures(outcomes))
        };
        let _lock = Lock::hold_for(folder, &shard.file())?;
        if !force {
            check_ours(&target)?;
        }
        if self.resume && target.exists() {
            let outcomes = Contents::read_whole(&target, &job.header())?.items;
            if outcomes.values().all(|o| o.is_ok()) {
                return said(&outcomes);
            }
        }
        let path = folder.join(format!(".{}.journal.tmp", shard.file()));
        let range = shard.range(job.items.len() as u32);
        let (journal, outcomes) = self.work(&path, job, range, compute)?;
        let outcomes = outcomes.into_iter().map(|(i, o)| (i, o.map(|value| value.to_bytes())));
        let outcomes: BTreeMap<u32, Outcome> = outcomes.collect();
        signals::commit()?;
        put(&target, &encode(&job.header(), &outcomes))?;
        journal.discard();
        signals::published();
        said(&outcomes)
    }

    /// Computes the items of `range` that the journal does not hold, one after the other.
    fn work<T: Item>(
        &self,
        path: &Path,
        job: &Job,
        range: Range<u32>,
        mut compute: impl FnMut(u32) -> T,
    ) -> Result<(Journal, Finished<T>)> {
        let (mut journal, mut kept) = if self.resume {
            Journal::resume(path, &job.header())?
        } else {
            (Journal::start(path, &job.header())?, BTreeMap::new())
        };
        // What failed is tried again.
        kept.retain(|_, outcome| outcome.is_ok());
        let mut outcomes = job.read(kept)?;
        signals::advise(format!("finished items are kept; go on with: {}", resume_line()));
        let bar = Progress::new(range.len(), &format!("{} items", job.name));
        for index in range {
            if let Entry::Vacant(place) = outcomes.entry(index) {
                if interrupted() {
                    return Err(Error::Partial("interrupted".into()));
                }
                let outcome = guarded(|| compute(index));
                journal
                    .append(index, &outcome.as_ref().map(Item::to_bytes).map_err(Clone::clone))?;
                place.insert(outcome);
            }
            bar.step();
        }
        Ok((journal, outcomes))
    }
}

/// A panicking item is a failed item.
fn guarded<T>(compute: impl FnOnce() -> T) -> std::result::Result<T, String> {
    catch_unwind(AssertUnwindSafe(compute)).map_err(|panic| {
        let text = panic.downcast_ref::<String>().map(String::as_str);
        let text = text.or_else(|| panic.downcast_ref::<&str>().copied());
        format!("panicked: {}", text.unwrap_or("without a word").replace('\n', " "))
    })
}

/// This command, to be typed again with `--resume`.
fn resume_line() -> String {
    let mut words: Vec<String> = std::env::args_os().map(|word| quoted(&word)).collect();
    if !words.iter().any(|word| word == "--resume") {
        words.push("--resume".into());
    }
    words.join(" ")
}

fn plan_text(job: &Job) -> String {
    let lines = job.items.iter().enumerate().map(|(i, item)| format!("{i}\t{item}\n"));
    format!("# key {}\n# {} items\n", job.key, job.items.len()) + &lines.collect::<String>()
}

/// The files of all shards in the folders, in order of their names.
fn shard_files(folders: &[PathBuf]) -> Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    for folder in folders {
        let entries = fs::read_dir(folder).map_err(|e| Error::read(folder, e))?;
        for entry in entries {
            let path = entry.map_err(|e| Error::read(folder, e))?.path();
            if path.extension().is_some_and(|e| e == "items") {
                files.push(path);
            }
        }
    }
    files.sort();
    Ok(files)
}

/// All items from the shards' files. One that several shards hold must be the same in each; a result
/// stands above a failure.
fn merge(folders: &[PathBuf], job: &Job) -> Result<BTreeMap<u32, Outcome>> {
    let mut outcomes: BTreeMap<u32, Outcome> = BTreeMap::new();
    for path in shard_files(folders)? {
        for (index, outcome) in Contents::read_whole(&path, &job.header())?.items {
            match outcomes.get(&index) {
                Some(Ok(known)) if outcome.as_ref().is_ok_and(|new| new != known) => {
                    let item = &job.items[index as usize];
                    let reason = format!("item {index} ({item}) differs from another shard's");
                    let fix = "were the shards made by the same program?";
                    return Err(Error::bad_input(shown(&path), reason, fix));
                }
                Some(Ok(_)) => {}
                _ => drop(outcomes.insert(index, outcome)),
            }
        }
    }
    let missing = (0..job.items.len() as u32).filter(|i| !outcomes.contains_key(i));
    let (first, count) = (missing.clone().next(), missing.count());
    if let Some(first) = first {
        let names: Vec<_> = folders.iter().map(|f| shown(f)).collect();
        let item = &job.items[first as usize];
        let reason =
            format!("{count} of {} items are missing, first {first} ({item})", job.items.len());
        return Err(Error::bad_input(names.join(", "), reason, "run the shards that hold them"));
    }
    Ok(outcomes)
}

/// Checks a folder against its manifest and says how many files agree.
pub(super) fn verify(folder: &Path) -> Result<()> {
    let agreeing = output::verify(folder)?;
    print(&format!("{agreeing} files of {} are as they were written\n", shown(folder)))
}
