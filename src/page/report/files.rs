//! What is written of a report, as data: the files of a block, and a report in its index.

use crate::output::OutFile;
use serde::{Deserialize, Serialize};

/// The files of one block, and what the page shows of them.
#[derive(Clone, Debug, Default)]
pub(super) struct Figure {
    /// SVG text of a plot.
    pub(super) svg: String,
    /// PNG bytes of a picture.
    pub(super) png: Vec<u8>,
    /// Description and arrays of an explorer or a panel.
    pub(super) pack: (String, String),
    /// Files beside the page.
    pub(super) files: Vec<OutFile>,
}

/// What an index shows of a report; read from its `report.json`.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Entry {
    /// Folder below the index, filled in when read.
    #[serde(default)]
    pub(super) folder: String,
    pub(super) title: String,
    pub(super) question: String,
    pub(super) lead: Vec<String>,
    pub(super) profile: String,
    pub(super) command: String,
}
