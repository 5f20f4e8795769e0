//! The index over the reports of a folder.

use std::fs;
use std::path::{Path, PathBuf};

use super::files::Entry;
use super::page;
use crate::input;
use crate::output::{MANIFEST_SCHEMA, Manifest, OutFile, Publication, digest};
use gnomon_core::{Error, Result};

/// Writes `folder/index.html` with the verdict of every report in a subfolder, by name, and a manifest
/// that says it is ours; `force` replaces the user's own file of that name.
///
/// # Errors
/// [`Error::Read`] and [`Error::BadInput`] where the folder or a `report.json` cannot be used or the
/// index would replace a file that is not ours, [`Error::Write`] where it cannot be written.
pub fn write_index(folder: &Path, force: bool) -> Result<PathBuf> {
    let mut folders = Vec::new();
    for entry in fs::read_dir(folder).map_err(|e| Error::read(folder, e))? {
        let path = entry.map_err(|e| Error::read(folder, e))?.path();
        if path.join("report.json").is_file() {
            folders.push(path);
        }
    }
    folders.sort();
    let entries = folders.iter().map(|path| read(path)).collect::<Result<Vec<_>>>()?;
    let index = OutFile::new("index.html", page::render_index(&entries));
    let manifest = Manifest {
        schema: MANIFEST_SCHEMA.to_string(),
        tool: concat!("gnomon ", env!("CARGO_PKG_VERSION")).to_string(),
        outputs: [(index.name.clone(), digest(&index.bytes))].into(),
        ..Manifest::default()
    };
    let files = [index, manifest.to_file()];
    Publication { force, ..Publication::default() }.publish(folder, &files)?;
    Ok(folder.join("index.html"))
}

fn read(folder: &Path) -> Result<Entry> {
    let path = folder.join("report.json");
    let text = input::read(&path, input::DATA)?;
    let mut entry: Entry = serde_json::from_slice(&text).map_err(|e| {
        let reason = format!("is not a report summary ({e})");
        Error::bad_input(path.display().to_string(), reason, "run the experiment again")
    })?;
    entry.folder = folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
    Ok(entry)
}
