//! The command line: read with every name a system allows, told again as it may be typed and printed.

use std::ffi::OsStr;

use clap::Parser;

use super::complain;
use crate::error::{is_control, printable};

/// Reads the program's arguments; ends it with what clap has to say where they are wrong.
#[must_use]
pub fn arguments<A: Parser>() -> A {
    A::try_parse().unwrap_or_else(|error| {
        let words = || std::env::args_os().map(|word| word.to_string_lossy().into_owned());
        if !error.use_stderr() || !words().any(|word| word.contains(is_control)) {
            error.exit();
        }
        // The same complaint, about words that are printable.
        if let Err(error) = A::try_parse_from(words().map(|word| printable(&word).into_owned())) {
            error.exit();
        }
        complain("error: an argument is no text (UTF-8), and only paths may be so; change it");
        std::process::exit(error.exit_code());
    })
}

/// A word as a shell reads it: plain, in quotes, or with its odd bytes spelled out (`$'a\xff'`).
pub(super) fn quoted(word: &OsStr) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./:,=%+".contains(c);
    match word.to_str() {
        Some(text) if !text.is_empty() && text.chars().all(plain) => text.to_string(),
        Some(text) if !text.contains(is_control) => format!("'{}'", text.replace('\'', r"'\''")),
        _ => format!("$'{}'", spelled(word.as_encoded_bytes())),
    }
}

fn spelled(bytes: &[u8]) -> String {
    let byte = |byte: &u8| format!("\\x{byte:02x}");
    let told = |c: char| match c {
        '\'' | '\\' => format!("\\{c}"),
        c if is_control(c) => c.encode_utf8(&mut [0; 4]).as_bytes().iter().map(byte).collect(),
        c => c.to_string(),
    };
    let chunks = bytes.utf8_chunks();
    chunks
        .map(|chunk| {
            let valid: String = chunk.valid().chars().map(told).collect();
            valid + &chunk.invalid().iter().map(byte).collect::<String>()
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_quoted_as_a_shell_reads_them() {
        for (word, told) in [
            ("--case=upc", "--case=upc"),
            ("", "''"),
            ("my model.glb", "'my model.glb'"),
            ("it's", r"'it'\''s'"),
            ("ü", "'ü'"),
            ("a\u{1b}[m'\\\n", r"$'a\x1b[m\'\\\x0a'"),
            ("\u{202e}x", r"$'\xe2\x80\xaex'"),
        ] {
            assert_eq!(quoted(OsStr::new(word)), told);
        }
    }

    #[cfg(unix)]
    #[test]
    fn bytes_that_are_no_text_are_spelled_out_and_read_back() {
        use std::os::unix::ffi::OsStrExt;
        let word = OsStr::from_bytes(b"o/\xff\xc3\xbc '\n");
        assert_eq!(quoted(word), "$'o/\\xff\u{fc} \\'\\x0a'");
        let script = format!("printf %s {}", quoted(word));
        let Ok(output) = std::process::Command::new("bash").args(["-c", &script]).output() else {
            return println!("SKIPPED: no bash");
        };
        assert_eq!(output.stdout, word.as_bytes());
    }
}
