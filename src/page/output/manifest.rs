//! The manifest of an output folder: digests of inputs and outputs, and their check.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::OutFile;
use gnomon_core::{Error, Result};

/// Name of the manifest in its folder.
pub const MANIFEST: &str = "manifest.json";

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
        let bytes = fs::read(&path).map_err(|e| Error::read(&path, e))?;
        Self::parse(&path.display().to_string(), &bytes)
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
        let text = serde_json::to_string_pretty(self).expect("a manifest is JSON");
        let body = text.strip_suffix("\n}").expect("a manifest is an object of members");
        let own = digest(body.as_bytes());
        OutFile::new(MANIFEST, format!("{body},\n  \"digest\": \"{own}\"\n}}\n"))
    }
}

/// SHA-256 of `bytes` as 64 hexadecimal digits.
#[must_use]
pub fn digest(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Compares every file of the folder's manifest with its digest, the manifest with its own, and returns
/// how many files agree.
///
/// # Errors
/// [`Error::CheckFailed`] names each file that differs; [`Error::Read`] one that is missing.
pub fn verify(folder: &Path) -> Result<usize> {
    let manifest = Manifest::read(folder)?;
    let mut changed = Vec::new();
    let path = folder.join(MANIFEST);
    if fs::read(&path).map_err(|e| Error::read(&path, e))? != manifest.to_file().bytes {
        changed.push(MANIFEST);
    }
    for (name, expected) in &manifest.outputs {
        let path = folder.join(name);
        let bytes = fs::read(&path).map_err(|e| Error::read(&path, e))?;
        if digest(&bytes) != *expected {
            changed.push(name.as_str());
        }
    }
    if changed.is_empty() {
        return Ok(manifest.outputs.len());
    }
    Err(Error::CheckFailed(format!("{} changed: {}", folder.display(), changed.join(", "))))
}
