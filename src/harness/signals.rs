//! Interruption: Ctrl-C and SIGTERM end a program between two states of its output, never in a mixture.
//!
//! One atomic value decides. It goes from *running* either to *stopped* (a signal came first: nothing is
//! published, the exit code is the signal's) or to *committed* (the files came first: they are carried
//! through, and the program says so and ends as if no signal had come).

use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, AtomicU8, AtomicUsize, Ordering};
use std::sync::{Mutex, Once, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use signal_hook::consts::{SIGABRT, SIGINT, SIGTERM};
use signal_hook::flag;

use super::complain;
use crate::output::{self, Consent};
use crate::{Error, Result};

/// Signals and the exit codes that shells give them.
const SIGNALS: [(i32, usize); 2] = [(SIGINT, 130), (SIGTERM, 143)];
/// How long a body may take to end by itself after a signal.
const GRACE: Duration = Duration::from_millis(1000);
/// How long a step of the output is waited for after that.
const PATIENCE: Duration = Duration::from_millis(300);
const POLL: Duration = Duration::from_millis(10);
/// The exit code where the system takes the program's memory away: the input is too large for it.
const NO_MEMORY: i32 = 2;

const RUNNING: u8 = 0;
const STOPPED: u8 = 1;
const COMMITTED: u8 = 2;
const PUBLISHED: u8 = 3;

static PHASE: AtomicU8 = AtomicU8::new(RUNNING);
/// Whether a signal has come.
static CAME: AtomicBool = AtomicBool::new(false);
/// Whether the next signal ends the program at once.
static AT_ONCE: AtomicBool = AtomicBool::new(false);
/// The exit code of the signal that came; 0 before.
static CODE: AtomicUsize = AtomicUsize::new(0);
/// Whether the exit code depends on a check that has not been made yet.
static UNJUDGED: AtomicBool = AtomicBool::new(false);
static ADVICE: Mutex<String> = Mutex::new(String::new());

/// Whether the user asked to stop. Long loops look and return early with what is done.
#[must_use]
pub fn interrupted() -> bool {
    CAME.load(Ordering::SeqCst)
}

/// Call before anything is published: whether the exit code depends on a check that follows. A program
/// that a signal ends in between then says 1, not 0.
pub fn check_follows(follows: bool) {
    UNJUDGED.store(follows, Ordering::SeqCst);
}

/// What an interrupted run says about going on; replaces what was set before.
pub(super) fn advise(text: String) {
    *ADVICE.lock().unwrap_or_else(PoisonError::into_inner) = text;
}

/// Moves on from `RUNNING`, once; says where the program is now.
fn leave_running(next: u8) -> u8 {
    match PHASE.compare_exchange(RUNNING, next, Ordering::SeqCst, Ordering::SeqCst) {
        Ok(_) => next,
        Err(phase) => phase,
    }
}

fn phase() -> u8 {
    PHASE.load(Ordering::SeqCst)
}

/// Decides between the files and a signal, whichever came first. Later calls change nothing.
///
/// # Errors
/// [`Error::Partial`] where a signal came first.
pub(super) fn commit() -> Result<()> {
    let next = if interrupted() { STOPPED } else { COMMITTED };
    if leave_running(next) == STOPPED { Err(Error::Partial("interrupted".into())) } else { Ok(()) }
}

/// Everything that was committed has been written.
pub(super) fn published() {
    let _ = PHASE.compare_exchange(COMMITTED, PUBLISHED, Ordering::SeqCst, Ordering::SeqCst);
}

/// Lets a signal stop a publication until the moment at which it is decided.
pub(super) struct Stoppable;

impl Consent for Stoppable {
    fn go_on(&self) -> Result<()> {
        if interrupted() { commit() } else { Ok(()) }
    }
    fn commit(&self) -> Result<()> {
        commit()
    }
}

/// Ends the run; gives the exit code where a signal came before anything was published, and has said
/// how to go on: 130 after Ctrl-C, 143 after SIGTERM.
pub(super) fn end() -> Option<ExitCode> {
    let next = if interrupted() { STOPPED } else { COMMITTED };
    if leave_running(next) == STOPPED {
        announce();
        return Some(ExitCode::from(CODE.load(Ordering::SeqCst) as u8));
    }
    if interrupted() && phase() == PUBLISHED {
        announce_late();
    }
    None
}

/// Handles signals from now on. Calling it again (tests) changes nothing.
pub(super) fn watch() {
    static ONCE: AtomicBool = AtomicBool::new(false);
    if ONCE.swap(true, Ordering::SeqCst) {
        return;
    }
    // Where the system has no such signal it cannot arrive either, so failures are dropped.
    for (signal, code) in SIGNALS {
        // Actions run in this order, so the code is there once the signal is seen.
        let registered = flag::register_conditional_shutdown(signal, code as i32, &AT_ONCE)
            .and_then(|_| flag::register_usize(signal, &CODE, code))
            .and_then(|_| flag::register(signal, &CAME));
        drop(registered);
    }
    static ALWAYS: AtomicBool = AtomicBool::new(true);
    drop(flag::register_conditional_shutdown(SIGABRT, NO_MEMORY, &ALWAYS));
    // A file that grows beyond the limit is an error of its write, not the end.
    #[cfg(unix)]
    {
        static TOO_LARGE: AtomicBool = AtomicBool::new(false);
        drop(flag::register(signal_hook::consts::SIGXFSZ, &TOO_LARGE));
    }
    let watching = thread::Builder::new().spawn(|| {
        while !interrupted() {
            thread::sleep(POLL);
        }
        stop();
    });
    if watching.is_err() {
        AT_ONCE.store(true, Ordering::SeqCst);
    }
}

/// Says once how to go on.
fn announce() {
    static SAID: Once = Once::new();
    SAID.call_once(|| {
        let advice = ADVICE.lock().unwrap_or_else(PoisonError::into_inner).clone();
        let plain = "earlier files are untouched; run the same command again".to_string();
        complain(&format!("interrupted: {}", if advice.is_empty() { plain } else { advice }));
    });
}

/// Says once that the signal came too late.
fn announce_late() {
    static SAID: Once = Once::new();
    SAID.call_once(|| {
        complain("interrupted, but the run had already ended: its files are written");
    });
}

/// Lets the body end by itself, then ends the program: between two publications where it was stopped,
/// after the last one where the files came first.
fn stop() {
    let start = Instant::now();
    if leave_running(STOPPED) == STOPPED {
        AT_ONCE.store(true, Ordering::SeqCst);
        announce();
        thread::sleep(GRACE);
        let _between_two_states = output::abandon(PATIENCE);
        std::process::exit(CODE.load(Ordering::SeqCst) as i32);
    }
    while start.elapsed() < GRACE || phase() != PUBLISHED {
        thread::sleep(POLL);
        AT_ONCE.store(start.elapsed() >= GRACE, Ordering::SeqCst);
    }
    announce_late();
    drop(output::abandon(PATIENCE));
    std::process::exit(i32::from(UNJUDGED.load(Ordering::SeqCst)));
}
