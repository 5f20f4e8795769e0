//! Conformance: the subject under a device profile against numbers that a real implementation wrote.

mod arith;
mod depth;
pub mod device_json;
mod dump;
mod encodings;
mod filter;
mod json;
mod outcome;
mod polyoffset;
mod raster;
pub mod scene_json;
mod scenes;
mod unorm;

use crate::device::Device;
use crate::{Error, Result};
pub use outcome::{Compared, Entry};
use std::path::Path;

type Section = fn(&Path, &Device) -> Result<Vec<Entry>>;

/// The sections in folders of their own.
const SECTIONS: [(&str, Section); 7] = [
    ("arith", arith::compare),
    ("unorm", unorm::compare),
    ("encodings", encodings::compare),
    ("depth", depth::compare),
    ("raster", raster::compare),
    ("filter", filter::compare),
    ("scenes", scenes::compare),
];

/// Compares every section of `folder` that the layout knows.
///
/// # Errors
/// [`Error::BadInput`] or [`Error::Read`] for a folder or file that cannot be used.
pub fn compare(folder: &Path, device: &Device) -> Result<Compared> {
    if !folder.is_dir() {
        return Err(Error::bad_input(
            folder.display().to_string(),
            "is no folder",
            "give the folder that holds scenes/, encodings/, …",
        ));
    }
    let mut outcome = Compared::default();
    for (name, section) in SECTIONS {
        let path = folder.join(name);
        if path.is_dir() {
            outcome.entries.extend(section(&path, device)?);
        } else {
            outcome.entries.push(outcome::Tally::missing(name, "(the whole folder)"));
        }
    }
    outcome.entries.extend(polyoffset::compare(folder, device)?);
    Ok(outcome)
}
