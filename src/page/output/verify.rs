//! Whether a published folder still holds what its manifest lists.

use super::found::{Found, found, is_relative};
use super::manifest::{MANIFEST, MANIFEST_SCHEMA, Manifest, Sound};
use super::plan::Journal;
use gnomon_core::error::shown;
use gnomon_core::{Error, Result};
use std::io;
use std::path::Path;

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
