//! One error type for what a user can mend and for files that cannot be read or written.
//!
//! Bugs of the program itself panic with a sentence; they are never an [`Error`].

use std::path::{Path, PathBuf};

/// A user's mistake, a failed check or a file problem. `Display` is one clear sentence:
/// file, place, reason, what to do.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// Something the user gave cannot be used.
    #[error("{place}: {reason}; {fix}")]
    BadInput {
        /// File and place in it (`scene.json: light.near`), or the flag (`--bias`).
        place: String,
        /// What is wrong with it.
        reason: String,
        /// What to do about it.
        fix: String,
    },
    /// A file or folder that should be read cannot be.
    #[error("{}: cannot be read ({source}); check that the path exists and is readable", path.display())]
    Read {
        /// The path as given.
        path: PathBuf,
        /// The operating system's answer.
        source: std::io::Error,
    },
    /// A file or folder that should be written cannot be; what was there before is untouched.
    #[error("{}: cannot be written ({source}); free space or choose another --out, earlier files are untouched", path.display())]
    Write {
        /// The path that was to be published.
        path: PathBuf,
        /// The operating system's answer.
        source: std::io::Error,
    },
    /// A check ran and failed (conformance, thresholds).
    #[error("check failed: {0}")]
    CheckFailed(String),
    /// Some items of a run failed, the rest was written.
    #[error("partial result: {0}")]
    Partial(String),
    /// A run cannot be resumed because its inputs have changed.
    #[error("cannot resume: {0}")]
    ResumeRefused(String),
}

/// The result of everything that can meet a user's mistake.
pub type Result<T> = std::result::Result<T, Error>;

impl Error {
    /// A mistake at `place`, with its reason and what to do.
    pub fn bad_input(
        place: impl Into<String>,
        reason: impl Into<String>,
        fix: impl Into<String>,
    ) -> Self {
        let [place, reason, fix] = [place.into(), reason.into(), fix.into()].map(printable);
        Self::BadInput { place, reason, fix }
    }

    /// A path that cannot be read.
    pub fn read(path: impl AsRef<Path>, source: std::io::Error) -> Self {
        Self::Read { path: path.as_ref().to_path_buf(), source }
    }

    /// A path that cannot be written.
    pub fn write(path: impl AsRef<Path>, source: std::io::Error) -> Self {
        Self::Write { path: path.as_ref().to_path_buf(), source }
    }

    /// The exit code that the binaries promise: 1 a check failed, 2 bad input, 3 partial,
    /// 4 cannot write, 5 resume refused.
    #[must_use]
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::CheckFailed(_) => 1,
            Self::BadInput { .. } | Self::Read { .. } => 2,
            Self::Partial(_) => 3,
            Self::Write { .. } => 4,
            Self::ResumeRefused(_) => 5,
        }
    }
}

/// Text that quotes an input, on one line and without control codes for the terminal.
fn printable(text: String) -> String {
    match text.contains(char::is_control) {
        true => text.replace(char::is_control, "\u{fffd}"),
        false => text,
    }
}
