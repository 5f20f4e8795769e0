//! Files that appear together or not at all: staging, publishing, rollback, lock and manifest.
//!
//! [`publish`] writes every file under a temporary name, syncs it, keeps the old files under
//! another temporary name, notes both in a rollback journal and only then renames. A failure at
//! any step restores the old state; a killed process is rolled back by the next one, which finds
//! the journal. All temporary names end in `.tmp`.

pub mod journal;
mod layer;
mod manifest;

use std::collections::BTreeSet;
use std::fs::{self, File, TryLockError};
use std::io::{Read, Seek, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use serde::{Deserialize, Serialize};

pub use layer::{Disk, FileLayer};
pub use manifest::{MANIFEST, Manifest, digest, verify};

use gnomon_core::{Error, Result};

const JOURNAL: &str = ".publish.tmp";
const LOCK: &str = ".lock.tmp";

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

static PUBLISHING: Mutex<()> = Mutex::new(());

/// Waits until no publication of this process is under way and holds off new ones, so that an
/// interrupt handler may end the process between two states.
pub fn quiesce() -> MutexGuard<'static, ()> {
    PUBLISHING.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Publishes `files` in `folder` as one step. Files that an earlier manifest of the folder lists
/// and that are not in `files` any more go away in the same step; other files are left alone.
///
/// # Errors
/// [`Error::Write`] names the path and the system's answer; the old files are then untouched.
/// [`Error::BadInput`] when another process holds the folder.
pub fn publish(folder: &Path, files: &[OutFile]) -> Result<Vec<PathBuf>> {
    publish_with(&Disk, folder, files)
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
    let _running = quiesce();
    layer.create_folder(folder).map_err(|e| Error::write(folder, e))?;
    let _lock = if Lock::is_held(folder) { None } else { Some(Lock::acquire(folder)?) };
    recover_with(layer, folder)?;
    let plan = Plan::new(folder, files);
    plan.clear(layer, folder);
    let staged = plan.stage(layer, folder, files).and_then(|()| plan.keep_old(layer, folder));
    if let Err(error) = staged {
        plan.clear(layer, folder);
        return Err(error);
    }
    if let Err(error) = plan.commit(layer, folder) {
        plan.roll_back(layer, folder)?;
        return Err(error);
    }
    plan.clear(layer, folder);
    Ok(plan.targets(folder))
}

/// Restores the old state of a folder whose publication was cut short. Does nothing elsewhere.
///
/// # Errors
/// [`Error::Write`] when a file cannot be put back; the journal then stays for the next attempt.
pub fn recover_with(layer: &dyn FileLayer, folder: &Path) -> Result<()> {
    let Ok(text) = fs::read(folder.join(JOURNAL)) else { return Ok(()) };
    match serde_json::from_slice::<Plan>(&text) {
        Ok(plan) => plan.roll_back(layer, folder),
        // Written, synced and renamed as a whole: an unreadable journal is not ours.
        Err(error) => Err(Error::bad_input(
            folder.join(JOURNAL).display().to_string(),
            format!("is not a publication journal ({error})"),
            "remove it or choose another --out",
        )),
    }
}

/// The rollback journal: names below the folder.
#[derive(Debug, Default, Serialize, Deserialize)]
struct Plan {
    /// Files that exist and are replaced.
    replaced: Vec<String>,
    /// Files that do not exist yet.
    created: Vec<String>,
    /// Files of the earlier manifest that go away.
    removed: Vec<String>,
}

impl Plan {
    fn new(folder: &Path, files: &[OutFile]) -> Self {
        let names: BTreeSet<&str> = files.iter().map(|file| file.name.as_str()).collect();
        assert_eq!(names.len(), files.len(), "two output files share a name");
        assert!(names.iter().all(|name| is_relative(name)), "an output name leaves its folder");
        let (replaced, created) =
            names.iter().map(ToString::to_string).partition(|name| folder.join(name).exists());
        let removed = Manifest::read(folder)
            .map(|old| old.outputs.into_keys().collect::<Vec<_>>())
            .unwrap_or_default()
            .into_iter()
            .filter(|name| is_relative(name) && !names.contains(name.as_str()))
            .filter(|name| name != MANIFEST && folder.join(name).exists())
            .collect();
        Self { replaced, created, removed }
    }

    fn written(&self) -> impl Iterator<Item = &String> {
        self.replaced.iter().chain(&self.created)
    }

    fn displaced(&self) -> impl Iterator<Item = &String> {
        self.replaced.iter().chain(&self.removed)
    }

    fn targets(&self, folder: &Path) -> Vec<PathBuf> {
        let mut targets: Vec<_> = self.written().map(|name| folder.join(name)).collect();
        targets.sort();
        targets
    }

    fn folders(&self, folder: &Path) -> BTreeSet<PathBuf> {
        self.written()
            .chain(&self.removed)
            .filter_map(|name| folder.join(name).parent().map(Path::to_path_buf))
            .chain([folder.to_path_buf()])
            .collect()
    }

    fn stage(&self, layer: &dyn FileLayer, folder: &Path, files: &[OutFile]) -> Result<()> {
        for parent in self.folders(folder) {
            layer.create_folder(&parent).map_err(|e| Error::write(&parent, e))?;
        }
        for file in files {
            let (target, staged) = (folder.join(&file.name), beside(folder, &file.name, "new"));
            layer
                .write(&staged, &file.bytes)
                .and_then(|()| layer.sync(&staged))
                .map_err(|e| Error::write(target, e))?;
        }
        Ok(())
    }

    fn keep_old(&self, layer: &dyn FileLayer, folder: &Path) -> Result<()> {
        for name in self.displaced() {
            let (target, kept) = (folder.join(name), beside(folder, name, "old"));
            if kept.exists() {
                layer.remove(&kept).map_err(|e| Error::write(&kept, e))?;
            }
            layer.link(&target, &kept).map_err(|e| Error::write(&kept, e))?;
        }
        let (journal, staged) = (folder.join(JOURNAL), beside(folder, JOURNAL, "new"));
        let text = serde_json::to_vec(self).expect("a list of names is JSON");
        layer
            .write(&staged, &text)
            .and_then(|()| layer.sync(&staged))
            .and_then(|()| layer.rename(&staged, &journal))
            .map_err(|e| Error::write(journal, e))
    }

    /// Removing the journal is the moment at which the new state holds.
    fn commit(&self, layer: &dyn FileLayer, folder: &Path) -> Result<()> {
        self.sync_folders(layer, folder)?;
        for name in self.written() {
            let target = folder.join(name);
            layer
                .rename(&beside(folder, name, "new"), &target)
                .map_err(|e| Error::write(target, e))?;
        }
        for name in &self.removed {
            let target = folder.join(name);
            layer.remove(&target).map_err(|e| Error::write(target, e))?;
        }
        self.sync_folders(layer, folder)?;
        let journal = folder.join(JOURNAL);
        layer.remove(&journal).map_err(|e| Error::write(journal, e))
    }

    fn sync_folders(&self, layer: &dyn FileLayer, folder: &Path) -> Result<()> {
        for path in self.folders(folder) {
            layer.sync_folder(&path).map_err(|e| Error::write(&path, e))?;
        }
        Ok(())
    }

    fn roll_back(&self, layer: &dyn FileLayer, folder: &Path) -> Result<()> {
        for name in self.displaced() {
            let (target, kept) = (folder.join(name), beside(folder, name, "old"));
            if kept.exists() {
                layer.rename(&kept, &target).map_err(|e| Error::write(target, e))?;
            }
        }
        for target in self.created.iter().map(|name| folder.join(name)).filter(|t| t.exists()) {
            layer.remove(&target).map_err(|e| Error::write(target, e))?;
        }
        self.sync_folders(layer, folder)?;
        let journal = folder.join(JOURNAL);
        if journal.exists() {
            layer.remove(&journal).map_err(|e| Error::write(journal, e))?;
        }
        self.clear(layer, folder);
        Ok(())
    }

    /// Removes temporary files, those of a killed process too; one that stays is harmless.
    fn clear(&self, layer: &dyn FileLayer, folder: &Path) {
        let entries = self.folders(folder).into_iter().filter_map(|path| fs::read_dir(path).ok());
        for path in entries.flatten().flatten().map(|entry| entry.path()) {
            let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            if name.starts_with('.')
                && [".new.tmp", ".old.tmp"].iter().any(|end| name.ends_with(end))
            {
                let _ = layer.remove(&path);
            }
        }
    }
}

/// The temporary name of `name`, in the same folder so that a rename never crosses devices.
fn beside(folder: &Path, name: &str, kind: &str) -> PathBuf {
    let target = folder.join(name);
    let file = target.file_name().unwrap_or_default().to_string_lossy().into_owned();
    target.with_file_name(format!(".{file}.{kind}.tmp"))
}

fn is_relative(name: &str) -> bool {
    !name.is_empty()
        && name
            .split('/')
            .all(|part| !matches!(part, "" | "." | "..") && !part.contains(['\\', ':']))
}

/// Folders that this process holds for the length of a run.
static HELD: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

fn held() -> MutexGuard<'static, BTreeSet<PathBuf>> {
    HELD.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Exclusive use of an output folder until dropped; a killed process frees it.
#[derive(Debug)]
pub struct Lock {
    _file: File,
    /// The folder, where this process may publish in it under this lock.
    holds: Option<PathBuf>,
}

impl Drop for Lock {
    fn drop(&mut self) {
        if let Some(folder) = &self.holds {
            held().remove(folder);
        }
    }
}

impl Lock {
    /// Takes the folder's lock without waiting.
    ///
    /// # Errors
    /// [`Error::BadInput`] with the holder's process id when another process has it,
    /// [`Error::Write`] when the lock file cannot be made.
    pub fn acquire(folder: &Path) -> Result<Self> {
        Self::at(folder, LOCK)
    }

    /// Makes the folder and takes its lock for a whole run; [`publish`] then works under it.
    ///
    /// # Errors
    /// As [`Self::acquire`].
    pub fn hold(folder: &Path) -> Result<Self> {
        fs::create_dir_all(folder).map_err(|e| Error::write(folder, e))?;
        let mut lock = Self::at(folder, LOCK)?;
        let real = fs::canonicalize(folder).map_err(|e| Error::write(folder, e))?;
        held().insert(real.clone());
        lock.holds = Some(real);
        Ok(lock)
    }

    /// Makes the folder and takes the lock of one file in it; other files may have other holders.
    ///
    /// # Errors
    /// As [`Self::acquire`].
    pub fn hold_for(folder: &Path, file: &str) -> Result<Self> {
        fs::create_dir_all(folder).map_err(|e| Error::write(folder, e))?;
        Self::at(folder, &format!(".{file}.lock.tmp"))
    }

    /// Whether this process holds the folder for a run.
    #[must_use]
    pub fn is_held(folder: &Path) -> bool {
        fs::canonicalize(folder).is_ok_and(|real| held().contains(&real))
    }

    fn at(folder: &Path, name: &str) -> Result<Self> {
        let path = folder.join(name);
        let open = File::options().read(true).write(true).create(true).truncate(false).open(&path);
        let mut file = open.map_err(|e| Error::write(&path, e))?;
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => return Err(locked(folder, &mut file)),
            Err(TryLockError::Error(e)) => return Err(Error::write(&path, e)),
        }
        file.set_len(0)
            .and_then(|()| write!(file, "{}", std::process::id()))
            .map_err(|e| Error::write(&path, e))?;
        Ok(Self { _file: file, holds: None })
    }
}

/// The refusal, with the holder's process id; it may be about to write it.
fn locked(folder: &Path, file: &mut File) -> Error {
    let mut holder = String::new();
    for _ in 0..20 {
        let read = file.rewind().and_then(|()| file.read_to_string(&mut holder));
        if read.is_ok() && !holder.is_empty() {
            break;
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    let known = !holder.is_empty();
    let holder = if known { format!("pid {holder}") } else { "another process".to_string() };
    Error::bad_input(
        folder.display().to_string(),
        format!("locked by {holder}"),
        "wait for it to end or choose another --out",
    )
}
