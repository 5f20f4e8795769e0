//! What publishing asks of a file system, and the machine's own one.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::Path;

/// What publishing asks of a file system; tests replace it by one that fails on purpose.
pub trait FileLayer {
    /// Makes the folder and its parents.
    fn create_folder(&self, path: &Path) -> io::Result<()>;
    /// Creates the file, which must not exist yet, and writes all bytes.
    fn write(&self, path: &Path, bytes: &[u8]) -> io::Result<()>;
    /// Makes the file's content durable.
    fn sync(&self, path: &Path) -> io::Result<()>;
    /// Gives the file a second name, which must not exist yet (a copy where links are not possible).
    fn link(&self, from: &Path, to: &Path) -> io::Result<()>;
    /// Renames atomically, replacing the target.
    fn rename(&self, from: &Path, to: &Path) -> io::Result<()>;
    /// Removes the file.
    fn remove(&self, path: &Path) -> io::Result<()>;
    /// Makes the folder's names durable.
    fn sync_folder(&self, path: &Path) -> io::Result<()>;
}

/// The machine's own file system.
#[derive(Clone, Copy, Debug, Default)]
pub struct Disk;

impl FileLayer for Disk {
    fn create_folder(&self, path: &Path) -> io::Result<()> {
        fs::create_dir_all(path)
    }
    fn write(&self, path: &Path, bytes: &[u8]) -> io::Result<()> {
        File::create_new(path)?.write_all(bytes)
    }
    fn sync(&self, path: &Path) -> io::Result<()> {
        // Windows refuses to sync a handle that cannot write.
        File::options().write(true).open(path)?.sync_all()
    }
    fn link(&self, from: &Path, to: &Path) -> io::Result<()> {
        match fs::hard_link(from, to) {
            Err(e) if e.kind() != io::ErrorKind::AlreadyExists => {
                let mut copy = File::create_new(to)?;
                io::copy(&mut File::open(from)?, &mut copy)?;
                copy.sync_all()
            }
            linked => linked,
        }
    }
    fn rename(&self, from: &Path, to: &Path) -> io::Result<()> {
        fs::rename(from, to)
    }
    fn remove(&self, path: &Path) -> io::Result<()> {
        fs::remove_file(path)
    }
    #[cfg(unix)]
    fn sync_folder(&self, path: &Path) -> io::Result<()> {
        File::open(path)?.sync_all()
    }
    #[cfg(not(unix))]
    fn sync_folder(&self, _path: &Path) -> io::Result<()> {
        Ok(()) // folders cannot be opened for syncing there; renames are journalled by the system
    }
}
