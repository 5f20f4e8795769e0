//! The index over the reports of a folder.

use std::fs;
use std::path::{Path, PathBuf};

use super::files::Entry;
use super::page;
use crate::output::{OutFile, publish};
use gnomon_core::{Error, Result};

/// Writes `folder/index.html` with the verdict of every report in a subfolder, by name.
///
/// # Errors
/// [`Error::Read`] and [`Error::BadInput`] where the folder or a `report.json` cannot be used,
/// [`Error::Write`] where the index cannot be written.
pub fn write_index(folder: &Path) -> Result<PathBuf> {
    let mut folders = Vec::new();
    for entry in fs::read_dir(folder).map_err(|e| Error::read(folder, e))? {
        let path = entry.map_err(|e| Error::read(folder, e))?.path();
        if path.join("report.json").is_file() {
            folders.push(path);
        }
    }
    folders.sort();
    let entries = folders.iter().map(|path| read(path)).collect::<Result<Vec<_>>>()?;
    publish(folder, &[OutFile::new("index.html", page::render_index(&entries))])?;
    Ok(folder.join("index.html"))
}

fn read(folder: &Path) -> Result<Entry> {
    let path = folder.join("report.json");
    let text = fs::read(&path).map_err(|e| Error::read(&path, e))?;
    let mut entry: Entry = serde_json::from_slice(&text).map_err(|e| {
        let reason = format!("is not a report summary ({e})");
        Error::bad_input(path.display().to_string(), reason, "run the experiment again")
    })?;
    entry.folder = folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
    Ok(entry)
}
