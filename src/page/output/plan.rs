//! One publication: what it replaces, adds and removes, each by its digest; commit and roll-back.
//!
//! A plan touches a file only while its bytes have the digest that the plan gives it, old or new.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::found::{self, Found, digest, found, is_relative};
use super::layer::FileLayer;
use super::manifest::{MANIFEST, Sound};
use super::put::{temporary, token};
use super::seal::{seal, unseal};
use super::{Consent, OutFile};
use gnomon_core::error::shown;
use gnomon_core::{Error, Result};

/// The rollback journal of a folder.
pub(super) const JOURNAL: &str = ".publish.tmp";
/// The journal before it has its name.
const JOURNAL_NEW: &str = ".publish.new.tmp";
const SCHEMA: &str = "gnomon-publication-1";
/// Largest journal that is read, in bytes.
const LARGEST: u64 = 64 << 20;

/// A file of a plan by the digests of its content; `None` where it does not exist.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Entry {
    old: Option<String>,
    new: Option<String>,
}

/// What the rollback journal holds.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Plan {
    schema: String,
    /// In the names of all temporary files.
    token: String,
    /// Whether the new state holds, so that only temporary files are left to clear away.
    pub(super) done: bool,
    files: BTreeMap<String, Entry>,
}

/// What a folder holds under the journal's name.
pub(super) enum Journal {
    Absent,
    Ours(Plan),
    Foreign(String),
}

/// A step that puts one file back.
enum Undo {
    Restore,
    Remove,
}

impl Journal {
    pub(super) fn read(folder: &Path) -> Self {
        match found::read(&folder.join(JOURNAL), LARGEST) {
            Ok(None) => Self::Absent,
            Ok(Some(bytes)) => match unseal(&bytes).filter(Plan::is_sound) {
                Some(plan) => Self::Ours(plan),
                None => Self::Foreign("is no publication journal of ours".into()),
            },
            Err(reason) => Self::Foreign(reason),
        }
    }
}

impl Plan {
    fn is_sound(&self) -> bool {
        let token = self.token.len() == 16 && self.token.bytes().all(|b| b.is_ascii_hexdigit());
        self.schema == SCHEMA && token && self.files.keys().all(|name| is_relative(name))
    }

    /// What publishing `files` in the folder comes to.
    pub(super) fn new(folder: &Path, files: &[OutFile], force: bool) -> Result<Self> {
        let names: BTreeSet<&str> = files.iter().map(|file| file.name.as_str()).collect();
        assert_eq!(names.len(), files.len(), "two output files share a name");
        assert!(names.iter().all(|name| is_relative(name)), "an output name leaves its folder");
        let manifest = Sound::read(folder);
        let mut planned = BTreeMap::new();
        for file in files {
            let new = digest(&file.bytes);
            let old = replaceable(folder, manifest.as_ref(), &file.name, Some(&new), force)?;
            planned.insert(file.name.clone(), Entry { old, new: Some(new) });
        }
        let listed = manifest.map(|sound| sound.manifest.outputs).unwrap_or_default();
        for (name, digest) in listed {
            let gone = name != MANIFEST && !planned.contains_key(&name);
            if gone && found(folder, &name) == Found::File(digest.clone()) {
                planned.insert(name, Entry { old: Some(digest), new: None });
            }
        }
        Ok(Self { schema: SCHEMA.into(), token: token(), done: false, files: planned })
    }

    fn targets(&self) -> impl Iterator<Item = &String> {
        self.files.iter().filter(|(_, entry)| entry.new.is_some()).map(|(name, _)| name)
    }

    /// Every written file, sorted.
    pub(super) fn written(&self, folder: &Path) -> Vec<PathBuf> {
        let mut targets: Vec<_> = self.targets().map(|name| folder.join(name)).collect();
        targets.sort();
        targets
    }

    fn folders(&self, folder: &Path) -> BTreeSet<PathBuf> {
        let parents = self.files.keys().filter_map(|name| Some(folder.join(name).parent()?.into()));
        parents.chain([folder.to_path_buf()]).collect()
    }

    /// The temporary file of the `n`-th file, in the same folder, so that a rename never crosses devices.
    fn beside(&self, n: usize, name: &str, kind: &str) -> String {
        let own = temporary(&self.token, &format!("{n}-{kind}"));
        name.rsplit_once('/').map_or(own.clone(), |(parent, _)| format!("{parent}/{own}"))
    }

    fn entries(&self) -> impl Iterator<Item = (&String, &Entry, String, String)> {
        self.files.iter().enumerate().map(|(n, (name, entry))| {
            (name, entry, self.beside(n, name, "new"), self.beside(n, name, "old"))
        })
    }

    /// Writes the new files beside the old ones and gives the old ones a second name.
    pub(super) fn stage(
        &self,
        layer: &dyn FileLayer,
        folder: &Path,
        files: &[OutFile],
        consent: &dyn Consent,
    ) -> Result<()> {
        for parent in self.folders(folder) {
            layer.create_folder(&parent).map_err(|e| Error::write(&parent, e))?;
        }
        let bytes: BTreeMap<&str, &[u8]> =
            files.iter().map(|file| (file.name.as_str(), file.bytes.as_slice())).collect();
        for (name, _, staged, _) in self.entries() {
            let Some(bytes) = bytes.get(name.as_str()) else { continue };
            consent.go_on()?;
            let staged = folder.join(staged);
            let written = layer.write(&staged, bytes).and_then(|()| layer.sync(&staged));
            written.map_err(|e| Error::write(folder.join(name), e))?;
        }
        for (name, entry, _, kept) in self.entries().filter(|(_, entry, ..)| entry.old.is_some()) {
            let (target, kept) = (folder.join(name), folder.join(kept));
            layer.link(&target, &kept).map_err(|e| Error::write(&target, e))?;
            self.expect(&found::at(&kept), entry.old.as_ref(), &target)?;
        }
        Ok(())
    }

    /// Puts the journal into the folder, whole.
    pub(super) fn note(&self, layer: &dyn FileLayer, folder: &Path) -> Result<()> {
        let free = found::at(&folder.join(JOURNAL_NEW)) == Found::Absent;
        let own = temporary(&self.token, "journal");
        let staged = folder.join(if free { JOURNAL_NEW } else { &own });
        let journal = folder.join(JOURNAL);
        let written = layer
            .write(&staged, &seal(self))
            .and_then(|()| layer.sync(&staged))
            .and_then(|()| layer.rename(&staged, &journal));
        written.map_err(|e| {
            let _ = layer.remove(&staged);
            Error::write(journal, e)
        })
    }

    /// Renames and removes; replacing the journal by one that says so is the moment at which the new
    /// state holds.
    pub(super) fn commit(&mut self, layer: &dyn FileLayer, folder: &Path) -> Result<()> {
        self.sync_folders(layer, folder)?;
        for (name, entry, staged, _) in self.entries() {
            let target = folder.join(name);
            self.expect(&found(folder, name), entry.old.as_ref(), &target)?;
            let moved = match entry.new {
                Some(_) => layer.rename(&folder.join(staged), &target),
                None => layer.remove(&target),
            };
            moved.map_err(|e| Error::write(target, e))?;
        }
        self.sync_folders(layer, folder)?;
        self.done = true;
        self.note(layer, folder).inspect_err(|_| self.done = false)
    }

    fn expect(&self, there: &Found, digest: Option<&String>, target: &Path) -> Result<()> {
        match (there, digest) {
            (Found::Absent, None) => Ok(()),
            (Found::File(there), Some(digest)) if there == digest => Ok(()),
            (Found::Odd(reason), _) => Err(Error::foreign(target, reason.clone())),
            _ => Err(Error::foreign(target, "was changed by somebody else meanwhile")),
        }
    }

    fn sync_folders(&self, layer: &dyn FileLayer, folder: &Path) -> Result<()> {
        for path in self.folders(folder).into_iter().filter(|path| path.is_dir()) {
            layer.sync_folder(&path).map_err(|e| Error::write(&path, e))?;
        }
        Ok(())
    }

    /// What puts the file back; `None` where it is as it was, or where `force` gives it up.
    fn undo(
        &self,
        folder: &Path,
        (name, entry, _, kept): (&String, &Entry, String, String),
        force: bool,
    ) -> Result<Option<Undo>> {
        let there = found(folder, name);
        let is = |digest: &Option<String>| match (&there, digest) {
            (Found::Absent, None) => true,
            (Found::File(there), Some(digest)) => there == digest,
            _ => false,
        };
        let reason = match &entry.old {
            _ if is(&entry.old) => return Ok(None),
            None if is(&entry.new) => return Ok(Some(Undo::Remove)),
            Some(old) if is(&entry.new) || there == Found::Absent => {
                if found(folder, &kept) == Found::File(old.clone()) {
                    return Ok(Some(Undo::Restore));
                }
                "cannot be put back after a publication that was cut short: its copy is gone"
            }
            _ => "was changed after a publication that was cut short",
        };
        if force { Ok(None) } else { Err(Error::foreign(folder.join(name), reason)) }
    }

    /// Restores the old state: all of it, or nothing where a file is no longer ours.
    pub(super) fn roll_back(
        &self,
        layer: &dyn FileLayer,
        folder: &Path,
        files: &[OutFile],
        force: bool,
    ) -> Result<()> {
        self.entries().try_for_each(|entry| self.undo(folder, entry, force).map(drop))?;
        for (name, entry, staged, kept) in self.entries() {
            let target = folder.join(name);
            let undone = match self.undo(folder, (name, entry, staged, kept.clone()), force)? {
                Some(Undo::Restore) => layer.rename(&folder.join(kept), &target),
                Some(Undo::Remove) => layer.remove(&target),
                None => Ok(()),
            };
            undone.map_err(|e| Error::write(target, e))?;
        }
        self.sync_folders(layer, folder)?;
        self.clear(layer, folder, files)
    }

    /// Removes this plan's temporary files that hold what it lists, or the beginning of a file that is
    /// about to be written again, and then the journal.
    pub(super) fn clear(
        &self,
        layer: &dyn FileLayer,
        folder: &Path,
        files: &[OutFile],
    ) -> Result<()> {
        for (name, entry, staged, kept) in self.entries() {
            for (path, digest) in [(staged, &entry.new), (kept, &entry.old)] {
                let ours = match (found(folder, &path), digest) {
                    (Found::File(there), Some(digest)) => {
                        there == *digest || begins(files, name, &folder.join(&path))
                    }
                    _ => false,
                };
                if ours {
                    let _ = layer.remove(&folder.join(path));
                }
            }
        }
        let _ = clear_staged_journal(layer, folder);
        let journal = folder.join(JOURNAL);
        match Journal::read(folder) {
            Journal::Ours(there) if there.token == self.token => {
                layer.remove(&journal).map_err(|e| Error::write(journal, e))
            }
            Journal::Absent | Journal::Ours(_) | Journal::Foreign(_) => Ok(()),
        }
    }
}

/// A sound journal that never got its name is of a killed process.
pub(super) fn clear_staged_journal(layer: &dyn FileLayer, folder: &Path) -> std::io::Result<()> {
    let path = folder.join(JOURNAL_NEW);
    match found::read(&path, LARGEST) {
        Ok(Some(bytes)) if unseal(&bytes).is_some_and(|plan: Plan| plan.is_sound()) => {
            layer.remove(&path)
        }
        _ => Ok(()),
    }
}

/// Whether the file at `path` is the beginning of the one called `name`: an interrupted write of it.
fn begins(files: &[OutFile], name: &str, path: &Path) -> bool {
    let Some(file) = files.iter().find(|file| file.name == name) else { return false };
    let there = found::read(path, file.bytes.len() as u64);
    there.is_ok_and(|there| there.is_some_and(|there| file.bytes.starts_with(&there)))
}

/// The digest of what a file called `name` would replace; `None` where there is nothing.
///
/// # Errors
/// [`Error::BadInput`] where it is not ours: no regular file, or without `force` one whose bytes are
/// neither listed by the folder's manifest nor those that it would get.
pub(super) fn replaceable(
    folder: &Path,
    manifest: Option<&Sound>,
    name: &str,
    new: Option<&str>,
    force: bool,
) -> Result<Option<String>> {
    let path = folder.join(name);
    match found(folder, name) {
        Found::Absent => Ok(None),
        Found::Odd(reason) => {
            let fix = "nothing was written; remove it or choose another --out";
            Err(Error::bad_input(shown(&path), reason, fix))
        }
        Found::File(there) => {
            let listed = manifest.is_some_and(|sound| sound.lists(name, &there));
            if force || listed || new == Some(there.as_str()) {
                return Ok(Some(there));
            }
            let reason = match manifest {
                Some(_) => "is not as the folder's manifest lists it",
                None => "is not ours: the folder has no sound manifest that lists it",
            };
            Err(Error::foreign(path, reason))
        }
    }
}
