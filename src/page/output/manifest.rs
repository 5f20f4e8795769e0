//! The manifest of an output folder: digests of inputs and outputs, and their check.

use std::collections::BTreeMap;
use std::io;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::OutFile;
use super::found::{self, Found, digest, found, is_relative};
use super::plan::Journal;
use super::seal::{seal, unseal};
use gnomon_core::error::shown;
use gnomon_core::{Error, Result};

/// Name of the manifest in its folder.
pub const MANIFEST: &str = "manifest.json";

/// The schema that this program writes and reads.
pub const MANIFEST_SCHEMA: &str = "gnomon-manifest-1";

/// Largest manifest that is read, in bytes.
const LARGEST: u64 = 64 << 20;

/// What a folder's files are and what they were made from.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Manifest {
    /// `gnomon-manifest-1`.
    pub schema: String,
    /// Program and version.
    pub tool: String,
    /// Seed of every random choice.
    pub seed: u64,
    /// Parameters as given or defaulted.
    pub parameters: BTreeMap<String, String>,
    /// SHA-256 (hex) of each input file by its name.
    pub inputs: BTreeMap<String, String>,
    /// SHA-256 (hex) of each output file by its name below the folder; the manifest is not in it.
    pub outputs: BTreeMap<String, String>,
}

impl Manifest {
    /// Reads the folder's manifest.
    ///
    /// # Errors
    /// [`Error::Read`] when there is none, [`Error::BadInput`] when it is not a manifest.
    pub fn read(folder: &Path) -> Result<Self> {
        let path = folder.join(MANIFEST);
        match found::read(&path, LARGEST) {
            Ok(Some(bytes)) => Self::parse(&shown(&path), &bytes),
            Ok(None) => Err(Error::read(&path, io::ErrorKind::NotFound.into())),
            Err(reason) => Err(Error::bad_input(shown(&path), reason, "run the experiment again")),
        }
    }

    /// Parses a manifest's bytes; `place` names it in complaints.
    ///
    /// # Errors
    /// [`Error::BadInput`] when it is not a manifest.
    pub fn parse(place: &str, bytes: &[u8]) -> Result<Self> {
        serde_json::from_slice(bytes).map_err(|e| {
            let reason = format!("is not a manifest ({e})");
            Error::bad_input(place, reason, "run the experiment again")
        })
    }

    /// The manifest as a file to publish beside the others. Its last member is the digest of the text
    /// before it, so that [`verify`] finds a change of the manifest too.
    #[must_use]
    pub fn to_file(&self) -> OutFile {
        OutFile::new(MANIFEST, seal(self))
    }
}

/// A manifest of this program that is exactly as it was written.
pub(super) struct Sound {
    pub(super) manifest: Manifest,
    own: String,
}

impl Sound {
    /// The folder's manifest, where its schema and its own digest are right and every name stays in
    /// the folder.
    pub(super) fn read(folder: &Path) -> Option<Self> {
        let bytes = found::read(&folder.join(MANIFEST), LARGEST).ok()??;
        let manifest: Manifest = unseal(&bytes)?;
        let names = manifest.outputs.keys().all(|name| is_relative(name));
        let sound = names && manifest.schema == MANIFEST_SCHEMA;
        sound.then(|| Self { manifest, own: digest(&bytes) })
    }

    /// Whether a file called `name` with this digest is ours.
    pub(super) fn lists(&self, name: &str, digest: &str) -> bool {
        match name {
            MANIFEST => self.own == digest,
            name => self.manifest.outputs.get(name).is_some_and(|listed| listed == digest),
        }
    }
}

/// Compares every file of the folder's manifest with its digest, the manifest with its own, and returns
/// how many files agree.
///
/// # Errors
/// [`Error::CheckFailed`] names each file that differs, or says that a publication was cut short;
/// [`Error::Read`] names a file that is missing; [`Error::BadInput`] where there is no manifest of ours
/// or it names a file outside of the folder.
pub fn verify(folder: &Path) -> Result<usize> {
    if let Journal::Ours(plan) = Journal::read(folder)
        && !plan.done
    {
        let what = "a publication was cut short or is under way";
        return Err(Error::CheckFailed(format!("{}: {what}; run again", shown(folder))));
    }
    let manifest = Manifest::read(folder)?;
    let place = || shown(&folder.join(MANIFEST));
    if manifest.schema != MANIFEST_SCHEMA {
        let reason = format!("has the schema '{}', not {MANIFEST_SCHEMA}", manifest.schema);
        return Err(Error::bad_input(place(), reason, "run the experiment again"));
    }
    if let Some(name) = manifest.outputs.keys().find(|name| !is_relative(name)) {
        let reason = format!("names '{name}', which is not in the folder");
        return Err(Error::bad_input(place(), reason, "it is not ours: run the experiment again"));
    }
    let mut changed = Vec::new();
    if Sound::read(folder).is_none() {
        changed.push(MANIFEST.to_string());
    }
    for (name, expected) in &manifest.outputs {
        match found(folder, name) {
            Found::File(there) if there == *expected => {}
            Found::File(_) => changed.push(name.clone()),
            Found::Odd(reason) => changed.push(format!("{name} ({reason})")),
            Found::Absent => {
                return Err(Error::read(folder.join(name), io::ErrorKind::NotFound.into()));
            }
        }
    }
    if changed.is_empty() {
        return Ok(manifest.outputs.len());
    }
    Err(Error::CheckFailed(format!("{} changed: {}", shown(folder), changed.join(", "))))
}
