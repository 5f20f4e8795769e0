//! The manifest of an output folder: digests of inputs and outputs, and their check.

use std::collections::BTreeMap;
use std::io;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::OutFile;
use super::found::{self, digest, is_relative};
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
    /// before it, so that [`verify`](super::verify()) finds a change of the manifest too.
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
