//! Input files: regular and bounded, read whole, or refused in one sentence before a byte is taken.

use crate::memory;
use gnomon_core::{Error, Result};
use std::fs::{self, File};
use std::io::{self, Read};
use std::path::Path;

/// Bytes of the largest settings file (TOML): 1 MiB.
pub const SETTINGS: u64 = 1 << 20;
/// Bytes of the largest data file (JSON, journal, map, dump): 512 MiB.
pub const DATA: u64 = 512 << 20;

/// The content of a regular file of at most `most` bytes. Pipes, devices, sockets and folders are
/// refused without being opened, so that none of them can hold the program up.
///
/// # Errors
/// [`Error::Read`] where there is no such file, [`Error::BadInput`] where it is none to read or larger.
pub fn read(path: &Path, most: u64) -> Result<Vec<u8>> {
    let place = || path.display().to_string();
    let regular = |meta: &fs::Metadata| match meta.is_file() {
        true => Ok(meta.len()),
        false => {
            let reason = format!("is {}, no regular file", kind(meta));
            Err(Error::bad_input(place(), reason, "give a file"))
        }
    };
    let meta = fs::metadata(path).map_err(|e| Error::read(path, e))?;
    bounded(&place(), regular(&meta)?, most)?;
    let file = File::open(path).map_err(|e| Error::read(path, e))?;
    // What was opened counts: the name may lead elsewhere by now.
    let size = regular(&file.metadata().map_err(|e| Error::read(path, e))?)?;
    bounded(&place(), size, most)?;
    memory::check(&place(), size, "give a smaller file")?;
    let bytes = taken(file, size, size).map_err(|e| Error::read(path, e))?;
    bytes.ok_or_else(|| Error::bad_input(place(), "grew while it was read", "try again"))
}

/// As [`read`], where the path may also be `-`: standard input up to its end.
///
/// # Errors
/// As [`read`].
pub fn read_or_stdin(path: &Path, most: u64) -> Result<Vec<u8>> {
    if path != Path::new("-") {
        return read(path, most);
    }
    let bytes = taken(io::stdin().lock(), 0, most).map_err(|e| Error::read("standard input", e))?;
    let larger = || too_large("standard input", format!("has more than {most} bytes"), most);
    bytes.ok_or_else(larger)
}

/// The text of [`read_or_stdin`].
///
/// # Errors
/// As [`read`], and [`Error::BadInput`] naming the first byte that is no UTF-8.
pub fn text(path: &Path, most: u64) -> Result<String> {
    String::from_utf8(read_or_stdin(path, most)?).map_err(|e| {
        let error = e.utf8_error();
        let line = e.as_bytes().iter().take(error.valid_up_to()).filter(|&&b| b == b'\n').count();
        let place = format!("{}: line {}", path.display(), line + 1);
        Error::bad_input(place, "is no UTF-8 text", "save the file as UTF-8")
    })
}

fn bounded(place: &str, size: u64, most: u64) -> Result<()> {
    match size > most {
        true => Err(too_large(place, format!("has {size} bytes"), most)),
        false => Ok(()),
    }
}

fn too_large(place: &str, reason: String, most: u64) -> Error {
    Error::bad_input(place, reason, format!("give a file of at most {most} bytes"))
}

/// All that a source gives; `None` where that is more than `most` bytes.
fn taken(source: impl Read, expected: u64, most: u64) -> io::Result<Option<Vec<u8>>> {
    let mut bytes = Vec::with_capacity(usize::try_from(expected).unwrap_or(0).saturating_add(1));
    source.take(most.saturating_add(1)).read_to_end(&mut bytes)?;
    Ok((bytes.len() as u64 <= most).then_some(bytes))
}

/// What stands at a path that is no regular file.
fn kind(meta: &fs::Metadata) -> &'static str {
    #[cfg(unix)]
    {
        use std::os::unix::fs::FileTypeExt;
        let kind = meta.file_type();
        if kind.is_fifo() {
            return "a pipe";
        }
        if kind.is_socket() {
            return "a socket";
        }
        if kind.is_char_device() || kind.is_block_device() {
            return "a device";
        }
    }
    if meta.is_dir() { "a folder" } else { "a special file" }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_regular_files_within_the_bound_are_read() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.bin");
        fs::write(&path, [7; 100]).expect("a file");
        assert_eq!(read(&path, 100).expect("as large as allowed"), [7; 100]);
        let message = read(&path, 99).expect_err("a byte too many").to_string();
        assert!(message.contains("100 bytes") && message.contains("at most 99"), "{message}");
        let message = read(folder.path(), 100).expect_err("a folder").to_string();
        assert!(message.contains("is a folder"), "{message}");
        let absent = read(&folder.path().join("absent"), 100).expect_err("absent");
        assert!(matches!(absent, Error::Read { .. }) && absent.exit_code() == 2, "{absent}");
    }

    #[cfg(unix)]
    #[test]
    fn devices_and_sockets_are_named_at_once() {
        let folder = tempfile::tempdir().expect("a folder");
        let socket = folder.path().join("socket");
        let _listening = std::os::unix::net::UnixListener::bind(&socket).expect("a socket");
        for (path, word) in [(Path::new("/dev/zero"), "a device"), (&socket, "a socket")] {
            let error = read(path, DATA).expect_err(word);
            assert!(error.to_string().contains(word) && error.exit_code() == 2, "{error}");
        }
    }

    #[test]
    fn text_names_the_line_that_is_no_utf8() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.toml");
        fs::write(&path, b"a = 1\nb = '\xff'\n").expect("a file");
        let message = text(&path, SETTINGS).expect_err("no UTF-8").to_string();
        assert!(message.contains("line 2") && message.contains("UTF-8"), "{message}");
    }
}
