//! Headerless little-endian dumps, read whole and checked for length.

use crate::{Error, Result, input};
use std::io::ErrorKind;
use std::path::Path;

/// The bytes of a dump, `None` if the file is not there.
pub(super) fn bytes(path: &Path, expected: usize) -> Result<Option<Vec<u8>>> {
    let bytes = match input::read(path, input::DATA) {
        Ok(bytes) => bytes,
        Err(Error::Read { source, .. }) if source.kind() == ErrorKind::NotFound => return Ok(None),
        Err(e) => return Err(e),
    };
    if bytes.len() != expected {
        return Err(Error::bad_input(
            path.display().to_string(),
            format!("holds {} bytes, its layout says {expected}", bytes.len()),
            "copy the file again, or correct the layout",
        ));
    }
    Ok(Some(bytes))
}

/// `count` little-endian f32.
pub(super) fn floats(path: &Path, count: usize) -> Result<Option<Vec<f32>>> {
    let float = |b: &[u8]| f32::from_le_bytes([b[0], b[1], b[2], b[3]]);
    Ok(bytes(path, count * 4)?.map(|bytes| bytes.chunks_exact(4).map(float).collect()))
}
