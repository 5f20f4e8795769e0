//! One error type for what a user can mend and for files that cannot be read or written.
//!
//! Bugs of the program itself panic with a sentence; they are never an [`Error`].

use std::borrow::Cow;
use std::fmt::Write as _;
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
    #[error("{}: cannot be read ({}); check that the path exists and is readable", shown(path), printable(&source.to_string()))]
    Read {
        /// The path as given.
        path: PathBuf,
        /// The operating system's answer.
        source: std::io::Error,
    },
    /// A file or folder that should be written cannot be.
    #[error("{}: cannot be written ({}); free space or choose another place, {}", shown(path), printable(&source.to_string()), printable(kept))]
    Write {
        /// The path that was to be published.
        path: PathBuf,
        /// The operating system's answer.
        source: std::io::Error,
        /// What has become of the other files.
        kept: String,
    },
    /// A check ran and failed (conformance, thresholds).
    #[error("check failed: {}", printable(.0))]
    CheckFailed(String),
    /// Some items of a run failed, the rest was written.
    #[error("partial result: {}", printable(.0))]
    Partial(String),
    /// A run cannot be resumed because its inputs have changed.
    #[error("cannot resume: {}", printable(.0))]
    ResumeRefused(String),
}

/// How the advice of an error begins that was met before anything was written.
const NOTHING: &str = "nothing was written; ";

/// The result of everything that can meet a user's mistake.
pub type Result<T> = std::result::Result<T, Error>;

impl Error {
    /// A mistake at `place`, with its reason and what to do.
    pub fn bad_input(
        place: impl Into<String>,
        reason: impl Into<String>,
        fix: impl Into<String>,
    ) -> Self {
        let printed = |text: String| printable(&text).into_owned();
        let [place, reason, fix] = [place.into(), reason.into(), fix.into()].map(printed);
        Self::BadInput { place, reason, fix }
    }

    /// A path that cannot be read.
    pub fn read(path: impl AsRef<Path>, source: std::io::Error) -> Self {
        Self::Read { path: path.as_ref().to_path_buf(), source }
    }

    /// A path that cannot be written; what was there before is untouched.
    pub fn write(path: impl AsRef<Path>, source: std::io::Error) -> Self {
        let kept = "earlier files are untouched".to_string();
        Self::Write { path: path.as_ref().to_path_buf(), source, kept }
    }

    /// A file of the user's that stands where one of ours should, with what to do about it.
    pub fn foreign(path: impl AsRef<Path>, reason: impl Into<String>) -> Self {
        Self::bad_input(
            shown(path.as_ref()),
            reason,
            format!("{NOTHING}choose another --out, or --force to replace it"),
        )
    }

    /// This error, met after `what` had already been written.
    #[must_use]
    pub fn having_written(self, what: &str) -> Self {
        let what = printable(what);
        let told = |text: String| format!("{text}; {what} had already been written");
        match self {
            Self::Write { path, source, .. } => {
                Self::Write { path, source, kept: format!("{what} had already been written") }
            }
            Self::BadInput { place, reason, fix } => {
                Self::BadInput { place, reason, fix: told(fix.replace(NOTHING, "")) }
            }
            Self::Read { path, source } => {
                let reason = format!("cannot be read ({source})");
                Self::bad_input(shown(&path), reason, told("check that it is readable".into()))
            }
            Self::CheckFailed(text) => Self::CheckFailed(told(text)),
            Self::Partial(text) => Self::Partial(told(text)),
            Self::ResumeRefused(text) => Self::ResumeRefused(told(text)),
        }
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

/// Text that quotes an input, as it may reach a terminal: on one line, every control character and every
/// one that turns the direction of writing spelled out (`\u{1b}`, `\n`, `\u{202e}`).
#[must_use]
pub fn printable(text: &str) -> Cow<'_, str> {
    spelled(text, is_control)
}

/// Several lines, as they may reach a terminal: [`printable`] but for line ends and tabs.
#[must_use]
pub fn printable_lines(text: &str) -> Cow<'_, str> {
    spelled(text, |c| is_control(c) && !matches!(c, '\n' | '\t'))
}

/// A path, as it may reach a terminal: [`printable`], and bytes that are no UTF-8 as `\xff`.
#[must_use]
pub fn shown(path: &Path) -> String {
    let mut text = String::new();
    for chunk in path.as_os_str().as_encoded_bytes().utf8_chunks() {
        text.push_str(&printable(chunk.valid()));
        for byte in chunk.invalid() {
            let _ = write!(text, "\\x{byte:02x}");
        }
    }
    text
}

/// Control characters (C0, DEL, C1), line and paragraph separators and bidirectional controls.
#[must_use]
pub fn is_control(c: char) -> bool {
    c.is_control()
        || matches!(c, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

fn spelled(text: &str, hidden: impl Fn(char) -> bool) -> Cow<'_, str> {
    if !text.contains(&hidden) {
        return Cow::Borrowed(text);
    }
    let mut told = String::with_capacity(text.len() + 16);
    for c in text.chars() {
        match hidden(c) {
            true => told.extend(c.escape_default()),
            false => told.push(c),
        }
    }
    Cow::Owned(told)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_that_steers_a_terminal_is_printed() {
        for code in 0..0x3000u32 {
            let Some(c) = char::from_u32(code) else { continue };
            let told = printable(c.encode_utf8(&mut [0; 4])).into_owned();
            assert_eq!(told.contains(c), !is_control(c), "U+{code:04x}");
            assert!(!told.contains(is_control), "U+{code:04x}");
        }
        assert_eq!(printable("a\u{1b}[31m\nb\u{202e}"), "a\\u{1b}[31m\\nb\\u{202e}");
        assert_eq!(printable_lines("a\tb\n\u{7}"), "a\tb\n\\u{7}");
        assert!(matches!(printable("ü 🙂"), Cow::Borrowed(_)));
    }

    #[test]
    fn every_error_is_one_printable_line() {
        let bad = "x\u{1b}[2J\ny".to_string();
        let io = || std::io::Error::other("z\u{7}");
        for error in [
            Error::bad_input(&bad, &bad, &bad),
            Error::read(&bad, io()),
            Error::write(&bad, io()),
            Error::CheckFailed(bad.clone()),
            Error::Partial(bad.clone()),
            Error::ResumeRefused(bad.clone()),
        ] {
            let code = error.exit_code();
            assert!(!error.to_string().contains(is_control), "{error}");
            let late = error.having_written(&bad);
            assert!(!late.to_string().contains(is_control), "{late}");
            assert!(late.to_string().contains("had already been written"), "{late}");
            assert_eq!(late.exit_code(), code);
        }
    }

    #[cfg(unix)]
    #[test]
    fn a_path_that_is_no_text_is_shown_by_its_bytes() {
        use std::os::unix::ffi::OsStrExt;
        let path = Path::new(std::ffi::OsStr::from_bytes(b"o/\xff\x1b.json"));
        assert_eq!(shown(path), "o/\\xff\\u{1b}.json");
    }
}
