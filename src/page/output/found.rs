//! What stands under a name of an output folder: nothing, a file with its digest, or something odd.
//!
//! Nothing here follows a link below the folder, opens what is no regular file, or reads without bound.

use std::fs::{self, File};
use std::io::{self, Read};
use std::path::Path;

use sha2::{Digest, Sha256};

/// Largest file that is read to know whether it is ours, in bytes; no report comes near it.
const LARGEST: u64 = 4 << 30;

/// What stands under a name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Found {
    /// Nothing.
    Absent,
    /// A regular file with this SHA-256.
    File(String),
    /// Something that is never ours, with the reason: `is a link`.
    Odd(String),
}

/// SHA-256 of `bytes` as 64 hexadecimal digits.
#[must_use]
pub fn digest(bytes: &[u8]) -> String {
    hex(Sha256::new_with_prefix(bytes))
}

fn hex(hasher: Sha256) -> String {
    hasher.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Whether a name stays below its folder: `/`-separated, not absolute, no `..`, no drive.
pub(super) fn is_relative(name: &str) -> bool {
    !name.is_empty()
        && name
            .split('/')
            .all(|part| !matches!(part, "" | "." | "..") && !part.contains(['\\', ':', '\0']))
}

/// Looks at `name` below `folder`, through no link.
pub(super) fn found(folder: &Path, name: &str) -> Found {
    let mut path = folder.to_path_buf();
    let (parents, _) = name.rsplit_once('/').unwrap_or(("", name));
    for part in parents.split('/').filter(|part| !part.is_empty()) {
        path.push(part);
        match fs::symlink_metadata(&path) {
            Ok(meta) if meta.is_dir() => {}
            Ok(meta) if meta.is_symlink() => return Found::Odd("lies behind a link".into()),
            Ok(_) => return Found::Odd("lies below what is no folder".into()),
            Err(e) if e.kind() == io::ErrorKind::NotFound => return Found::Absent,
            Err(e) => return Found::Odd(format!("cannot be looked at ({e})")),
        }
    }
    at(&folder.join(name))
}

/// Looks at one path, whose last part may not be a link.
pub(super) fn at(path: &Path) -> Found {
    match open(path) {
        Ok(None) => Found::Absent,
        Ok(Some(file)) => match digest_of(file) {
            Ok(Some(digest)) => Found::File(digest),
            Ok(None) => Found::Odd("is too large".into()),
            Err(e) => Found::Odd(format!("cannot be read ({e})")),
        },
        Err(reason) => Found::Odd(reason),
    }
}

/// A regular file, opened; `None` where there is nothing.
pub(super) fn open(path: &Path) -> std::result::Result<Option<File>, String> {
    match fs::symlink_metadata(path) {
        Ok(meta) if meta.is_symlink() => Err("is a link".into()),
        Ok(meta) if meta.is_dir() => Err("is a folder".into()),
        Ok(meta) if !meta.is_file() => Err("is no regular file".into()),
        Ok(_) => File::open(path).map(Some).map_err(|e| format!("cannot be read ({e})")),
        Err(e) if e.kind() == io::ErrorKind::NotFound => Ok(None),
        Err(e) => Err(format!("cannot be looked at ({e})")),
    }
}

/// The bytes of a regular file of at most `limit` bytes; `None` where there is nothing.
pub(super) fn read(path: &Path, limit: u64) -> std::result::Result<Option<Vec<u8>>, String> {
    let Some(file) = open(path)? else { return Ok(None) };
    let mut bytes = Vec::new();
    let read = file.take(limit + 1).read_to_end(&mut bytes);
    read.map_err(|e| format!("cannot be read ({e})"))?;
    match bytes.len() as u64 > limit {
        true => Err("is too large".into()),
        false => Ok(Some(bytes)),
    }
}

/// The file's digest; `None` where it is larger than [`LARGEST`].
fn digest_of(mut file: File) -> io::Result<Option<String>> {
    let (mut hasher, mut buffer, mut total) = (Sha256::new(), vec![0; 1 << 16], 0);
    loop {
        let count = match file.read(&mut buffer) {
            Ok(0) => return Ok(Some(hex(hasher))),
            Ok(count) => count,
            Err(e) if e.kind() == io::ErrorKind::Interrupted => continue,
            Err(e) => return Err(e),
        };
        total += count as u64;
        if total > LARGEST {
            return Ok(None);
        }
        hasher.update(&buffer[..count]);
    }
}
