//! Exclusive use of an output folder: a lock file that goes away with its holder.
//!
//! The system's lock on the file is what counts; the file says who holds it. It is made complete under
//! another name and linked to its own, so nobody sees it half written, and removed before the lock is
//! let go. A holder that was killed leaves it behind; the next one finds it free and clears it away.

use std::collections::BTreeMap;
use std::fs::{self, File, TryLockError};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::sleep;
use std::time::{Duration, Instant};

use super::found;
use super::put::{temporary, token};
use gnomon_core::error::shown;
use gnomon_core::{Error, Result};

const LOCK: &str = ".lock.tmp";
/// How a lock file begins; the holder's process id and a line end follow.
const MARK: &str = "gnomon lock, pid ";
/// How a refusal begins whose reason goes away by itself.
const LOCKED: &str = "locked by pid ";
const POLL: Duration = Duration::from_millis(10);
/// How long somebody else's lock file may take to say whose it is.
const PATIENCE: Duration = Duration::from_millis(200);

/// A lock file of this process.
struct Held {
    file: Arc<File>,
    /// The folder, where this process may publish in it under this lock.
    folder: Option<PathBuf>,
}

static HELD: Mutex<BTreeMap<PathBuf, Held>> = Mutex::new(BTreeMap::new());

fn held() -> MutexGuard<'static, BTreeMap<PathBuf, Held>> {
    HELD.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Lets go of every lock of this process, whose end is near.
pub(super) fn release_all() {
    for (path, lock) in std::mem::take(&mut *held()) {
        release(&path, &lock.file);
    }
}

/// Removes the lock file, then unlocks it by word: a child that another thread is starting has a copy
/// of the handle for a moment, and merely closing ours would leave the lock with it.
fn release(path: &Path, file: &File) {
    if is_at(file, path) {
        let _ = fs::remove_file(path);
    }
    let _ = file.unlock();
}

/// Exclusive use of an output folder until dropped; a killed process frees it.
#[derive(Debug)]
pub struct Lock {
    path: PathBuf,
}

impl Drop for Lock {
    fn drop(&mut self) {
        let lock = held().remove(&self.path);
        if let Some(lock) = lock {
            release(&self.path, &lock.file);
        }
    }
}

impl Lock {
    /// Takes the folder's lock without waiting.
    ///
    /// # Errors
    /// [`Error::BadInput`] with the holder's process id when another process has it, or where the
    /// lock file is not ours, [`Error::Write`] when it cannot be made.
    pub fn acquire(folder: &Path) -> Result<Self> {
        Self::at(folder, LOCK, false)
    }

    /// Makes the folder and takes its lock for a whole run; [`publish`](super::publish) then works
    /// under it.
    ///
    /// # Errors
    /// As [`Self::acquire`].
    pub fn hold(folder: &Path) -> Result<Self> {
        fs::create_dir_all(folder).map_err(|e| Error::write(folder, e))?;
        Self::at(folder, LOCK, true)
    }

    /// Makes the folder and takes the lock of one file in it; other files may have other holders.
    ///
    /// # Errors
    /// As [`Self::acquire`].
    pub fn hold_for(folder: &Path, file: &str) -> Result<Self> {
        fs::create_dir_all(folder).map_err(|e| Error::write(folder, e))?;
        Self::at(folder, &format!(".{file}.lock.tmp"), false)
    }

    /// [`Self::acquire`], trying again for so long; for folders that several runs share for a moment.
    pub(super) fn wait(folder: &Path, patience: Duration) -> Result<Self> {
        let start = Instant::now();
        loop {
            match Self::acquire(folder) {
                Err(Error::BadInput { reason, .. })
                    if reason.starts_with(LOCKED) && start.elapsed() < patience =>
                {
                    sleep(POLL);
                }
                other => return other,
            }
        }
    }

    /// Whether this process holds the folder for a run.
    #[must_use]
    pub fn is_held(folder: &Path) -> bool {
        let real = fs::canonicalize(folder).ok();
        real.is_some() && held().values().any(|lock| lock.folder == real)
    }

    fn at(folder: &Path, name: &str, whole: bool) -> Result<Self> {
        let real = fs::canonicalize(folder).map_err(|e| Error::write(folder, e))?;
        let path = real.join(name);
        let file = Arc::new(take(folder, name)?);
        held().insert(path.clone(), Held { file, folder: whole.then_some(real) });
        Ok(Self { path })
    }
}

/// The locked file, which now stands at its name.
fn take(folder: &Path, name: &str) -> Result<File> {
    let path = folder.join(name);
    let start = Instant::now();
    loop {
        let Some(mut file) = open(&path)? else {
            match make(folder, &path) {
                Ok(Some(file)) => return Ok(file),
                Ok(None) => continue,
                Err(e) => return Err(Error::write(&path, e)),
            }
        };
        let holder = holder(&mut file).map_err(|e| Error::read(&path, e))?;
        match file.try_lock() {
            _ if holder.is_none() && !is_at(&file, &path) => {}
            _ if holder.is_none() && start.elapsed() < PATIENCE => sleep(POLL),
            _ if holder.is_none() => return Err(foreign(&path, "is no lock file of ours")),
            // Left behind by a killed process; where the holder has just removed it, it stays so.
            Ok(()) => release(&path, &file),
            Err(TryLockError::WouldBlock) => {
                return Err(locked(folder, &holder.unwrap_or_default()));
            }
            Err(TryLockError::Error(e)) => return Err(Error::write(&path, e)),
        }
    }
}

/// The lock file that stands there, open for writing, which some network file systems lock alone.
fn open(path: &Path) -> Result<Option<File>> {
    match found::open(path).map_err(|reason| foreign(path, &reason))? {
        None => Ok(None),
        Some(_) => match File::options().read(true).write(true).open(path) {
            Ok(file) => Ok(Some(file)),
            Err(e) if e.kind() == io::ErrorKind::NotFound => Ok(None),
            Err(e) => Err(Error::write(path, e)),
        },
    }
}

/// Makes the lock file, locked; `None` where another process was quicker.
fn make(folder: &Path, path: &Path) -> io::Result<Option<File>> {
    let staged = folder.join(temporary(&token(), "lock"));
    let mut file = File::options().read(true).write(true).create_new(true).open(&staged)?;
    let written = file.lock().and_then(|()| writeln!(file, "{MARK}{}", std::process::id()));
    let linked = written.and_then(|()| match fs::hard_link(&staged, path) {
        Err(e) if e.kind() == io::ErrorKind::AlreadyExists => Ok(false),
        Ok(()) => Ok(true),
        // No links on this file system: what is found at the name decides who was first.
        Err(_) if found::open(path).is_ok_and(|there| there.is_none()) => {
            fs::rename(&staged, path).map(|()| true)
        }
        Err(e) => Err(e),
    });
    let _ = fs::remove_file(&staged);
    Ok(linked?.then_some(file).filter(|file| is_at(file, path)))
}

/// The process id in a lock file; `None` where it is no lock file. A bare number is one of an
/// earlier version.
fn holder(file: &mut File) -> io::Result<Option<String>> {
    let mut text = Vec::new();
    file.take(64).read_to_end(&mut text)?;
    let text = String::from_utf8(text).unwrap_or_default();
    let pid = text.strip_prefix(MARK).and_then(|rest| rest.strip_suffix('\n')).unwrap_or(&text);
    let number = (1..=10).contains(&pid.len()) && pid.bytes().all(|b| b.is_ascii_digit());
    Ok(number.then(|| pid.to_string()))
}

#[cfg(unix)]
fn is_at(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let (Ok(own), Ok(there)) = (file.metadata(), fs::symlink_metadata(path)) else { return false };
    (own.dev(), own.ino()) == (there.dev(), there.ino())
}

#[cfg(not(unix))]
fn is_at(_file: &File, path: &Path) -> bool {
    path.exists()
}

fn foreign(path: &Path, reason: &str) -> Error {
    let fix = "look at it and remove it, or choose another --out";
    Error::bad_input(shown(path), reason, fix)
}

fn locked(folder: &Path, holder: &str) -> Error {
    let fix = "wait for it to end or choose another --out";
    Error::bad_input(shown(folder), format!("{LOCKED}{holder}"), fix)
}
