//! Conformance: the subject under a device profile against numbers that a real implementation wrote.

mod dump;
mod json;
mod outcome;
pub mod scene_json;
mod scenes;

use crate::device::Device;
use crate::{Error, Result};
pub use outcome::{Entry, Outcome};
use std::path::Path;

/// Compares every section of `folder` that the layout knows.
///
/// # Errors
/// [`Error::BadInput`] or [`Error::Read`] for a folder or file that cannot be used.
pub fn compare(folder: &Path, device: &Device) -> Result<Outcome> {
    if !folder.is_dir() {
        return Err(Error::bad_input(
            folder.display().to_string(),
            "is no folder",
            "give the folder that holds scenes/, encodings/, …",
        ));
    }
    let mut outcome = Outcome::default();
    let scenes = folder.join("scenes");
    if scenes.is_dir() {
        outcome.entries.extend(scenes::compare(&scenes, device)?);
    }
    Ok(outcome)
}
