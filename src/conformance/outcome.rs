//! What a comparison found, file by file.

use crate::report::{Cell, Column, Table};
use crate::{Error, Result};
use serde::Serialize;

/// One compared file (or one of its parts).
#[derive(Clone, Debug, Serialize)]
pub struct Entry {
    /// Folder that the file belongs to.
    pub section: String,
    /// File name, with the part compared where it has several.
    pub file: String,
    /// Values compared.
    pub compared: u64,
    /// Values that differ in any bit.
    pub differing: u64,
    /// Whether the file is listed but not there.
    pub missing: bool,
    /// The first difference: place, expected and found in decimal and hex.
    pub first: Option<String>,
}

/// All entries of a folder.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Compared {
    /// In reading order.
    pub entries: Vec<Entry>,
}

impl Compared {
    /// Sum of a count over all entries of a section (all sections for an empty name).
    fn sum(&self, section: &str, count: impl Fn(&Entry) -> u64) -> u64 {
        let of_section = |e: &&Entry| section.is_empty() || e.section == section;
        self.entries.iter().filter(of_section).map(count).sum()
    }

    /// Values compared in a section.
    #[must_use]
    pub fn compared(&self, section: &str) -> u64 {
        self.sum(section, |e| e.compared)
    }

    /// Values that differ in a section.
    #[must_use]
    pub fn differing(&self, section: &str) -> u64 {
        self.sum(section, |e| e.differing)
    }

    /// Listed files that are not there.
    #[must_use]
    pub fn missing(&self) -> u64 {
        self.sum("", |e| u64::from(e.missing))
    }

    /// Section names in order.
    #[must_use]
    pub fn sections(&self) -> Vec<&str> {
        let mut names: Vec<&str> = Vec::new();
        for entry in &self.entries {
            if !names.contains(&entry.section.as_str()) {
                names.push(&entry.section);
            }
        }
        names
    }
}

impl Compared {
    /// One row a file.
    #[must_use]
    pub fn table(&self) -> Table {
        let column = |name: &str| Column { name: name.to_string(), ..Column::default() };
        let row = |e: &Entry| {
            let state = if e.missing { "missing" } else { e.first.as_deref().unwrap_or("equal") };
            vec![
                e.section.as_str().into(),
                e.file.as_str().into(),
                Cell::count(e.compared),
                Cell::count(e.differing),
                state.into(),
            ]
        };
        let names = ["section", "file", "compared", "differing", "first difference"];
        Table {
            id: "conformance".to_string(),
            caption: String::new(),
            columns: names.map(column).into(),
            rows: self.entries.iter().map(row).collect(),
        }
    }

    /// Whether the folder at `place` passes.
    ///
    /// # Errors
    /// [`Error::CheckFailed`] where a value differs; [`Error::BadInput`] where a section compared
    /// nothing or, unless `allow_missing`, a listed file is not there.
    pub fn verdict(&self, place: &str, allow_missing: bool) -> Result<()> {
        if let Some(e) = self.entries.iter().find(|e| e.differing > 0) {
            let first = e.first.as_deref().unwrap_or_default();
            let (count, file) = (self.differing(""), format!("{}/{}", e.section, e.file));
            return Err(Error::CheckFailed(format!("{count} values differ, first {file} {first}")));
        }
        if self.missing() > 0 && !allow_missing {
            let reason = format!("{} listed files are missing", self.missing());
            return Err(Error::bad_input(place, reason, "add them, or pass --allow-missing"));
        }
        if self.compared("") == 0 {
            return Err(Error::bad_input(place, "nothing was compared", "give a folder of dumps"));
        }
        let empty = self.sections().into_iter().find(|s| self.compared(s) == 0);
        match empty.filter(|_| !allow_missing) {
            Some(section) => Err(Error::bad_input(
                format!("{place}: {section}"),
                "nothing was compared",
                "add its files, or pass --allow-missing",
            )),
            None => Ok(()),
        }
    }
}

/// Counts differences of one file.
#[derive(Debug)]
pub(super) struct Tally {
    entry: Entry,
}

impl Tally {
    pub(super) fn new(section: &str, file: impl Into<String>) -> Self {
        let entry = Entry {
            section: section.to_string(),
            file: file.into(),
            compared: 0,
            differing: 0,
            missing: false,
            first: None,
        };
        Self { entry }
    }

    /// A file that is listed but not there.
    pub(super) fn missing(section: &str, file: impl Into<String>) -> Entry {
        Entry { missing: true, ..Self::new(section, file).finish() }
    }

    /// Compares two floats bit by bit (any NaN equals any NaN).
    pub(super) fn float(&mut self, place: impl FnOnce() -> String, expected: f32, found: f32) {
        let same = expected.to_bits() == found.to_bits() || expected.is_nan() && found.is_nan();
        self.record(same, place, || {
            let hex = |x: f32| format!("{x:e} ({:#010x})", x.to_bits());
            format!("expected {}, found {}", hex(expected), hex(found))
        });
    }

    /// Compares two f64 bit by bit (zeros of either sign are equal).
    pub(super) fn double(&mut self, place: impl FnOnce() -> String, expected: f64, found: f64) {
        self.record(expected == found, place, || {
            let hex = |x: f64| format!("{x:e} ({:#018x})", x.to_bits());
            format!("expected {}, found {}", hex(expected), hex(found))
        });
    }

    /// Compares two whole numbers.
    pub(super) fn integer(
        &mut self,
        place: impl FnOnce() -> String,
        expected: impl Into<u64>,
        found: impl Into<u64>,
    ) {
        let (expected, found) = (expected.into(), found.into());
        self.record(expected == found, place, || {
            format!("expected {expected} ({expected:#x}), found {found} ({found:#x})")
        });
    }

    fn record(
        &mut self,
        same: bool,
        place: impl FnOnce() -> String,
        what: impl FnOnce() -> String,
    ) {
        self.entry.compared += 1;
        if !same {
            self.entry.differing += 1;
            if self.entry.first.is_none() {
                self.entry.first = Some(format!("{}: {}", place(), what()));
            }
        }
    }

    pub(super) fn finish(self) -> Entry {
        self.entry
    }
}
