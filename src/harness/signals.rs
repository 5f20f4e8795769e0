//! Interruption: Ctrl-C and SIGTERM end a program between two states of its output.

use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, Once, PoisonError};
use std::thread;
use std::time::Duration;

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;

use crate::output;

/// Signals and the exit codes that shells give them.
const SIGNALS: [(i32, usize); 2] = [(SIGINT, 130), (SIGTERM, 143)];
/// How long a body may take to end by itself after a signal.
const GRACE: Duration = Duration::from_millis(1500);
const POLL: Duration = Duration::from_millis(25);

/// Whether a signal has come; the second one then ends the program at once.
static ARMED: AtomicBool = AtomicBool::new(false);
/// The exit code of the signal that came; 0 before.
static CODE: AtomicUsize = AtomicUsize::new(0);
static ADVICE: Mutex<String> = Mutex::new(String::new());

/// Whether the user asked to stop. Long loops look and return early with what is done.
#[must_use]
pub fn interrupted() -> bool {
    ARMED.load(Ordering::SeqCst)
}

/// What an interrupted run says about going on; replaces what was set before.
pub(super) fn advise(text: String) {
    *ADVICE.lock().unwrap_or_else(PoisonError::into_inner) = text;
}

/// The exit code of an interrupted program, once it has said how to go on: 130 after Ctrl-C, 143
/// after SIGTERM.
pub(super) fn exit_code() -> ExitCode {
    announce();
    ExitCode::from(CODE.load(Ordering::SeqCst) as u8)
}

/// Handles signals from now on. Calling it again (tests) changes nothing.
pub(super) fn watch() {
    static ONCE: AtomicBool = AtomicBool::new(false);
    if ONCE.swap(true, Ordering::SeqCst) {
        return;
    }
    for (signal, code) in SIGNALS {
        // Actions run in this order, so the shutdown sees only the flag of an earlier signal.
        let registered = flag::register_conditional_shutdown(signal, code as i32, &ARMED)
            .and_then(|_| flag::register_usize(signal, &CODE, code))
            .and_then(|_| flag::register(signal, &ARMED));
        // Where the system has no such signal it cannot arrive either.
        drop(registered);
    }
    thread::spawn(|| {
        while !interrupted() {
            thread::sleep(POLL);
        }
        stop();
    });
}

/// Says once how to go on.
fn announce() {
    static SAID: Once = Once::new();
    SAID.call_once(|| {
        let advice = ADVICE.lock().unwrap_or_else(PoisonError::into_inner).clone();
        let plain = "earlier files are untouched; run the same command again".to_string();
        eprintln!("interrupted: {}", if advice.is_empty() { plain } else { advice });
    });
}

/// Lets the body end by itself, then ends the program between two publications.
fn stop() {
    announce();
    thread::sleep(GRACE);
    let _between_two_states = output::quiesce();
    std::process::exit(CODE.load(Ordering::SeqCst) as i32);
}
