//! What every binary shares: arguments, threads, progress, interruption, stdout and exit codes.

mod division;
mod shell;
mod signals;
mod sink;

use std::ffi::OsString;
use std::io::{self, IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

pub use division::{Division, Done, Job, Shard};
pub use shell::arguments;
pub use signals::{check_follows, interrupted};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::error::{is_control, printable, printable_lines, shown};
use crate::num;
use crate::output::{Disk, Lock, MANIFEST, Publication};
use crate::report::{Profile, Report, Table, Written, write_index};
use crate::{Error, Result, memory};
use shell::quoted;
use sink::Sink;

/// Where reports go that nobody gave a folder: runs of one's own, beside the committed ones in `reports`.
pub const LOCAL: &str = "reports/local";

/// Arguments that every experiment takes; flatten them into the binary's own.
#[derive(Clone, Debug, clap::Args)]
pub struct Common {
    /// Folder for the report [default: reports/local/NAME]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Also write the results as JSON here; `-` prints them instead of the table
    #[arg(long, value_name = "PATH")]
    pub json: Option<PathBuf>,
    /// Every 4th pixel of the canvas in x and y: the profile of the committed reports
    #[arg(long, conflicts_with = "full")]
    pub quick: bool,
    /// Every pixel (the default)
    #[arg(long)]
    pub full: bool,
    /// Worker threads; results do not depend on them [default: one per core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// Memory that the run may need [default: 8 GiB, or half of what the system allows if less]
    #[arg(long, value_name = "SIZE")]
    pub max_memory: Option<memory::Size>,
    /// Seed of every random choice
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// Replace files in the output folder that this program has not written (links and folders never)
    #[arg(long)]
    pub force: bool,
    /// Check the files of this folder against its manifest, and do nothing else
    #[arg(long, value_name = "DIR")]
    pub verify: Option<PathBuf>,
}

impl Common {
    /// Quick or full.
    #[must_use]
    pub fn profile(&self) -> Profile {
        if self.quick { Profile::Quick } else { Profile::Full }
    }

    /// The report's folder: `--out`, else [`LOCAL`]`/name`.
    #[must_use]
    pub fn folder(&self, name: &str) -> PathBuf {
        self.out.clone().unwrap_or_else(|| Path::new(LOCAL).join(name))
    }

    /// The command that makes the same report again: the program's arguments but for those that only
    /// say where to write, with how many threads and from which parts.
    #[must_use]
    pub fn command(name: &str) -> String {
        const ELSEWHERE: [&str; 5] = ["--out", "--json", "--threads", "--merge", "--max-memory"];
        let mut arguments = std::env::args_os().skip(1).peekable();
        let mut kept = vec![name.to_string()];
        while let Some(argument) = arguments.next() {
            let text = argument.to_string_lossy();
            match ELSEWHERE.iter().find_map(|flag| text.strip_prefix(flag)) {
                Some("") => {
                    drop(arguments.next());
                    let is_value = |value: &OsString| !value.to_string_lossy().starts_with('-');
                    while text == "--merge" && arguments.next_if(is_value).is_some() {}
                }
                Some(value) if value.starts_with('=') => {}
                _ if text == "--resume" || text == "--force" => {}
                _ => kept.push(quoted(&argument)),
            }
        }
        kept.join(" ")
    }

    /// Sets up the worker threads and checks the floating-point mode of each; call once, before any
    /// parallel work. With `--verify` it checks that folder and ends the program.
    ///
    /// # Errors
    /// [`Error::BadInput`] where the system does not give so many threads, [`Error::CheckFailed`]
    /// where a thread does not compute in the default mode or a verified file has changed.
    pub fn start(&self) -> Result<()> {
        if let Some(folder) = &self.verify {
            division::verify(folder)?;
            std::process::exit(0);
        }
        if let Some(budget) = self.max_memory {
            memory::set(budget);
        }
        let threads = self.threads.map_or(0, usize::from);
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build_global();
        pool.map_err(|e| Error::bad_input("--threads", e.to_string(), "ask for fewer threads"))?;
        num::check_float_mode()?;
        rayon::broadcast(|_| num::check_float_mode()).into_iter().collect()
    }

    /// Makes a report and [`Self::finish`]es it. Its folder is held from before the work until the
    /// files are there, so that a second process on it is refused at once, not after its work. Call it
    /// once the user's input is known to be good: it makes the folder.
    ///
    /// # Errors
    /// [`Error::BadInput`] where another process holds the folder, what `make` refuses, and as
    /// [`Self::finish`].
    pub fn publish(
        &self,
        name: &str,
        make: impl FnOnce() -> Result<Report>,
    ) -> Result<(Report, Written)> {
        let _held = self.hold(name)?;
        let report = make()?;
        let written = self.finish(&report)?;
        Ok((report, written))
    }

    /// Holds the report's folder for the run, and refuses one that holds the user's files under the
    /// names that every report writes.
    ///
    /// # Errors
    /// [`Error::BadInput`], [`Error::Write`].
    fn hold(&self, name: &str) -> Result<Lock> {
        let folder = self.folder(name);
        self.json.as_ref().map(|path| Sink::new(path, String::new())).transpose()?;
        let lock = Lock::hold(&folder)?;
        let publication = self.publication();
        publication.prepare(&folder)?;
        if self.out.is_none() {
            publication.check(Path::new(LOCAL), &["index.html", MANIFEST])?;
        }
        Ok(lock)
    }

    fn publication(&self) -> Publication<'static> {
        Publication { layer: &Disk, force: self.force, consent: &signals::Stoppable }
    }

    /// Writes the report (and `--json`), prints its summary table and where the page is. The index
    /// over all reports follows where the report's folder is the usual one. What `--json` names is
    /// written to, or ready beside its target, before any file of the folder is replaced.
    ///
    /// # Panics
    /// Where the folder was not held during the work, by [`Self::publish`] or by a [`Division`].
    ///
    /// # Errors
    /// As [`Report::write`], [`Error::Write`] for `--json`, and [`Error::Partial`] where a signal came
    /// before the files.
    pub fn finish(&self, report: &Report) -> Result<Written> {
        let folder = self.folder(&report.name);
        assert!(Lock::is_held(&folder), "the folder of a report is held while it is made");
        let files = report.files();
        let sink = |path: &PathBuf| Sink::new(path, json_text(&report.results));
        let sink = self.json.as_ref().map(sink).transpose()?;
        sink.as_ref().map_or(Ok(()), Sink::deliver)?;
        let files = self.publication().publish(&folder, &files)?;
        let written = Written { folder, files };
        let told = || format!("the report in {}", shown(&written.folder));
        sink.as_ref().map_or(Ok(()), Sink::publish).map_err(|e| e.having_written(&told()))?;
        if self.out.is_none() {
            let index = write_index(Path::new(LOCAL), self.force);
            index.map_err(|e| e.having_written(&told()))?;
        }
        signals::published();
        if self.json.as_deref() != Some(Path::new("-")) {
            print(&summary(report, &written)).map_err(|e| e.having_written(&told()))?;
        }
        Ok(written)
    }
}

/// The lead sentences, the table and the page's path.
fn summary(report: &Report, written: &Written) -> String {
    let table = report.results_csv.as_ref().map(Table::to_text).unwrap_or_default();
    let lead = report.lead.join("\n");
    format!("{table}\n{lead}\n\n{} files; open {}\n", written.files.len(), shown(&written.page()))
}

/// JSON in which characters that steer a terminal are escaped, as JSON itself allows.
fn json_text(value: &impl serde::Serialize) -> String {
    let text = serde_json::to_string_pretty(value).expect("results are JSON");
    let mut told = String::with_capacity(text.len() + 1);
    for c in text.chars() {
        match c {
            '\n' => told.push(c),
            // All of them lie in the first plane, so one escape is enough.
            c if is_control(c) => told.push_str(&format!("\\u{:04x}", u32::from(c))),
            c => told.push(c),
        }
    }
    told.push('\n');
    told
}

/// Writes one JSON file, whole or not at all; a device or a pipe is written to.
///
/// # Errors
/// [`Error::Write`] where the path cannot be written, [`Error::Partial`] where a signal came first.
pub fn write_json(path: &Path, value: &impl serde::Serialize) -> Result<()> {
    let sink = Sink::new(path, json_text(value))?;
    sink.deliver()?;
    signals::commit()?;
    sink.publish()?;
    signals::published();
    Ok(())
}

/// Prints to stdout what may steer no terminal. A reader that has gone away (`| head`) has had enough:
/// that is no error.
///
/// # Errors
/// [`Error::Write`] where stdout cannot be written for another reason.
pub fn print(text: &str) -> Result<()> {
    let mut stdout = io::stdout().lock();
    match stdout.write_all(printable_lines(text).as_bytes()).and_then(|()| stdout.flush()) {
        Err(e) if e.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        result => result.map_err(|e| Error::write("stdout", e)),
    }
}

/// Says one sentence on stderr, the only way there; where that is full or closed, nobody hears it.
fn complain(sentence: &str) {
    let _ = writeln!(io::stderr().lock(), "{}", printable(sentence));
}

/// Prints a table as aligned text, which is a Markdown table too.
///
/// # Errors
/// Those of [`print()`].
pub fn print_table(table: &Table) -> Result<()> {
    print(&table.to_text())
}

/// Runs a binary's body: prints an error once, as `error: …`, and turns it into its exit code.
/// Ctrl-C ends the program with 130 and SIGTERM with 143, between two states of the output and within
/// two seconds; where the files came first, they stay and the program ends as if no signal had come.
#[must_use]
pub fn run(body: impl FnOnce() -> Result<()>) -> ExitCode {
    signals::watch();
    let outcome = body();
    if let Some(interrupted) = signals::end() {
        return interrupted;
    }
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            complain(&format!("error: {error}"));
            ExitCode::from(error.exit_code())
        }
    }
}

/// A progress bar on stderr; nothing at all where stderr is no terminal.
#[derive(Clone, Debug)]
pub struct Progress(ProgressBar);

impl Progress {
    /// A bar of `total` steps.
    ///
    /// # Panics
    /// Never: the bar's template is fixed.
    #[must_use]
    pub fn new(total: usize, doing: &str) -> Self {
        let target = if io::stderr().is_terminal() {
            ProgressDrawTarget::stderr()
        } else {
            ProgressDrawTarget::hidden()
        };
        let bar = ProgressBar::with_draw_target(Some(total as u64), target);
        let style = ProgressStyle::with_template("{msg} [{bar:32}] {pos}/{len} {eta}");
        bar.set_style(style.expect("a well-formed template").progress_chars("=> "));
        bar.set_message(doing.to_string());
        Self(bar)
    }

    /// One step is done; may be called from any thread.
    pub fn step(&self) {
        self.0.inc(1);
    }

    /// Removes the bar.
    pub fn finish(&self) {
        self.0.finish_and_clear();
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.finish();
    }
}
