//! Files that appear together or not at all, and nobody else's files are touched.
//!
//! [`publish`] notes in a rollback journal which files it will replace, add and remove, by the digest of
//! their bytes before and after; writes every file under a temporary name, syncs it, keeps the old files
//! under another temporary name, and only then renames. A failure at any step restores the old state; a
//! killed process is rolled back by the next one, which finds the journal. All temporary names end in
//! `.tmp`.
//!
//! A file is ours where the folder's manifest or the journal lists the digest of its bytes. No other file
//! is replaced or removed, and nothing is reached through a link below the folder; other files that are
//! in nobody's way are left alone.

mod found;
pub mod journal;
mod layer;
mod lock;
mod manifest;
mod plan;
mod put;
mod seal;
mod verify;

use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError, TryLockError};
use std::thread::sleep;
use std::time::{Duration, Instant};

pub use found::digest;
pub use layer::{Disk, FileLayer};
pub use lock::Lock;
pub use manifest::{MANIFEST, MANIFEST_SCHEMA, Manifest};
pub use put::{Staged, put, put_with};
pub use verify::verify;

use plan::{JOURNAL, Journal, Plan, clear_staged_journal, replaceable};

use gnomon_core::error::shown;
use gnomon_core::{Error, Result};

/// One file to publish: a relative path with `/` between folders, and its bytes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OutFile {
    /// Path below the output folder, `/`-separated, never absolute and without `..`.
    pub name: String,
    /// Whole content.
    pub bytes: Vec<u8>,
}

impl OutFile {
    /// A file called `name` (below the output folder) that holds `bytes`.
    pub fn new(name: impl Into<String>, bytes: impl Into<Vec<u8>>) -> Self {
        Self { name: name.into(), bytes: bytes.into() }
    }
}

/// Who may still stop a publication.
pub trait Consent {
    /// Asked before each file is written under its temporary name.
    ///
    /// # Errors
    /// Whatever stops the publication; nothing has been replaced.
    fn go_on(&self) -> Result<()>;

    /// Asked once, when everything is ready and nothing has been replaced; after it the publication is
    /// carried through.
    ///
    /// # Errors
    /// Whatever stops the publication; nothing has been replaced.
    fn commit(&self) -> Result<()>;
}

/// Nobody stops it.
impl Consent for () {
    fn go_on(&self) -> Result<()> {
        Ok(())
    }
    fn commit(&self) -> Result<()> {
        Ok(())
    }
}

static PUBLISHING: Mutex<()> = Mutex::new(());
/// How long a folder that is held by another process for a moment is waited for.
const PATIENCE: Duration = Duration::from_secs(1);
/// What every report writes; they are looked at before the work.
const ALWAYS: [&str; 4] = ["index.html", MANIFEST, "report.json", "results.json"];

/// Waits at most so long until no publication of this process is under way, holds off new ones, and
/// gives up all locks, so that an interrupt handler may end the process between two states.
pub fn abandon(patience: Duration) -> Option<MutexGuard<'static, ()>> {
    let start = Instant::now();
    let guard = loop {
        match PUBLISHING.try_lock() {
            Ok(guard) => break Some(guard),
            Err(TryLockError::Poisoned(guard)) => break Some(guard.into_inner()),
            Err(TryLockError::WouldBlock) if start.elapsed() < patience => {
                sleep(Duration::from_millis(5));
            }
            Err(TryLockError::WouldBlock) => break None,
        }
    };
    lock::release_all();
    guard
}

/// Publishes `files` in `folder` as one step. Files that an earlier manifest of the folder lists
/// and that are not in `files` any more go away in the same step; other files are left alone.
///
/// # Errors
/// [`Error::Write`] names the path and the system's answer; the old files are then untouched.
/// [`Error::BadInput`] when another process holds the folder or a file of the user's is in the way.
pub fn publish(folder: &Path, files: &[OutFile]) -> Result<Vec<PathBuf>> {
    Publication::default().publish(folder, files)
}

/// [`publish`] on a given file layer.
///
/// # Errors
/// As [`publish`].
pub fn publish_with(
    layer: &dyn FileLayer,
    folder: &Path,
    files: &[OutFile],
) -> Result<Vec<PathBuf>> {
    Publication { layer, ..Publication::default() }.publish(folder, files)
}

/// Restores the old state of a folder whose publication was cut short. Does nothing elsewhere.
///
/// # Errors
/// [`Error::Write`] when a file cannot be put back; the journal then stays for the next attempt.
/// [`Error::BadInput`] where the journal is not ours or a file has been changed since.
pub fn recover_with(layer: &dyn FileLayer, folder: &Path) -> Result<()> {
    Publication { layer, ..Publication::default() }.recover(folder, &[])
}

/// How to publish.
#[derive(Clone, Copy)]
pub struct Publication<'a> {
    /// The file system.
    pub layer: &'a dyn FileLayer,
    /// Replaces the user's regular files too.
    pub force: bool,
    /// Who may stop it.
    pub consent: &'a dyn Consent,
}

impl Default for Publication<'_> {
    fn default() -> Self {
        Self { layer: &Disk, force: false, consent: &() }
    }
}

impl std::fmt::Debug for Publication<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Publication").field("force", &self.force).finish_non_exhaustive()
    }
}

impl Publication<'_> {
    /// Publishes, as the function [`publish`] does.
    ///
    /// # Errors
    /// As [`publish`], and what the consent refuses.
    pub fn publish(&self, folder: &Path, files: &[OutFile]) -> Result<Vec<PathBuf>> {
        let _running = PUBLISHING.lock().unwrap_or_else(PoisonError::into_inner);
        self.layer.create_folder(folder).map_err(|e| Error::write(folder, e))?;
        let _lock = if Lock::is_held(folder) { None } else { Some(Lock::wait(folder, PATIENCE)?) };
        self.recover(folder, files)?;
        let mut plan = Plan::new(folder, files, self.force)?;
        plan.note(self.layer, folder)?;
        let ready = plan.stage(self.layer, folder, files, self.consent);
        let done = ready
            .and_then(|()| self.consent.commit())
            .and_then(|()| plan.commit(self.layer, folder));
        if let Err(error) = done {
            // A file that somebody else has changed meanwhile is given up to them.
            plan.roll_back(self.layer, folder, files, true)?;
            return Err(error);
        }
        // The new state holds; a temporary file that stays is harmless.
        let _ = plan.clear(self.layer, folder, files);
        Ok(plan.written(folder))
    }

    /// Refuses, before any work, a folder into which a report could not be published: a journal or a
    /// file that every report writes is not ours.
    ///
    /// # Errors
    /// [`Error::BadInput`] with the file's name and what to do.
    pub fn prepare(&self, folder: &Path) -> Result<()> {
        match Journal::read(folder) {
            // Which files are ours shows once a publication that was cut short is undone.
            Journal::Ours(plan) if !plan.done => Ok(()),
            Journal::Foreign(reason) => Err(foreign_journal(folder, reason)),
            Journal::Ours(_) | Journal::Absent => self.check(folder, &ALWAYS),
        }
    }

    /// Refuses a folder in which a file of these names is not ours.
    ///
    /// # Errors
    /// [`Error::BadInput`] with the file's name and what to do.
    pub fn check(&self, folder: &Path, names: &[&str]) -> Result<()> {
        let manifest = manifest::Sound::read(folder);
        names.iter().try_for_each(|name| {
            replaceable(folder, manifest.as_ref(), name, None, self.force).map(drop)
        })
    }

    fn recover(&self, folder: &Path, files: &[OutFile]) -> Result<()> {
        let path = folder.join(JOURNAL);
        match Journal::read(folder) {
            Journal::Absent => {
                let cleared = clear_staged_journal(self.layer, folder);
                cleared.map_err(|e| Error::write(path, e))
            }
            Journal::Ours(plan) if plan.done => plan.clear(self.layer, folder, files),
            Journal::Ours(plan) => plan.roll_back(self.layer, folder, files, self.force),
            Journal::Foreign(reason) => Err(foreign_journal(folder, reason)),
        }
    }
}

fn foreign_journal(folder: &Path, reason: String) -> Error {
    let fix = "nothing was written; look at it and remove it, or choose another --out";
    Error::bad_input(shown(&folder.join(JOURNAL)), reason, fix)
}
