//! One file, whole or not at all: under a temporary name, synced, then renamed.

use std::hash::{BuildHasher, Hasher, RandomState};
use std::path::{Path, PathBuf};

use super::layer::{Disk, FileLayer};
use gnomon_core::{Error, Result};

/// 16 hexadecimal digits that no other process and no other call has.
pub(super) fn token() -> String {
    let mut hasher = RandomState::new().build_hasher();
    hasher.write_u32(std::process::id());
    format!("{:016x}", hasher.finish())
}

/// The name of a temporary file, whose length does not depend on the target's.
pub(super) fn temporary(token: &str, what: &str) -> String {
    format!(".gnomon-{token}-{what}.tmp")
}

/// Writes a file whole or not at all.
///
/// # Errors
/// [`Error::Write`]; the earlier file is then untouched.
pub fn put(path: &Path, bytes: &[u8]) -> Result<()> {
    put_with(&Disk, path, bytes)
}

/// [`put`] on a given file layer.
///
/// # Errors
/// As [`put`].
pub fn put_with(layer: &dyn FileLayer, path: &Path, bytes: &[u8]) -> Result<()> {
    Staged::new(layer, path, bytes)?.publish()
}

/// A file that is written and durable, but not yet under its name; dropped, it goes away.
pub struct Staged<'a> {
    layer: &'a dyn FileLayer,
    staged: PathBuf,
    target: PathBuf,
}

impl std::fmt::Debug for Staged<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Staged").field("target", &self.target).finish_non_exhaustive()
    }
}

impl<'a> Staged<'a> {
    /// Writes the bytes beside `target`, with the permissions of a file that stands there.
    ///
    /// # Errors
    /// [`Error::Write`].
    pub fn new(layer: &'a dyn FileLayer, target: &Path, bytes: &[u8]) -> Result<Self> {
        let staged = target.with_file_name(temporary(&token(), "put"));
        let this = Self { layer, staged, target: target.to_path_buf() };
        let written = layer.write(&this.staged, bytes).and_then(|()| layer.sync(&this.staged));
        written.map_err(|e| Error::write(target, e))?;
        if let Ok(earlier) = std::fs::symlink_metadata(target)
            && earlier.is_file()
        {
            let _ = std::fs::set_permissions(&this.staged, earlier.permissions());
        }
        Ok(this)
    }

    /// Gives the file its name.
    ///
    /// # Errors
    /// [`Error::Write`]; the earlier file is then untouched.
    pub fn publish(self) -> Result<()> {
        let folder = self.target.parent().filter(|p| !p.as_os_str().is_empty());
        let folder = folder.unwrap_or(Path::new("."));
        let renamed = self.layer.rename(&self.staged, &self.target);
        let synced = renamed.and_then(|()| self.layer.sync_folder(folder));
        synced.map_err(|e| Error::write(&self.target, e))
    }
}

impl Drop for Staged<'_> {
    /// The name is this value's alone, so what stands there is its own file.
    fn drop(&mut self) {
        let _ = self.layer.remove(&self.staged);
    }
}
