//! Finished work items in one append-only file: a killed run loses only what it was computing.
//!
//! The file is a magic line and records. A record is `length: u32, crc: u32, body`, little-endian;
//! `length` counts the body and `crc` is its CRC-32. The first body is the [`Header`] as JSON, every
//! other is `index: u32, state: u8, payload`. Whatever follows the last sound record is the tail of an
//! interrupted write; it is cut off before the next record is appended.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{Read, Write};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::found;
use super::put::put;
use crate::input;
use gnomon_core::error::shown;
use gnomon_core::{Error, Result};

const MAGIC: &[u8] = b"gnomon-journal-1\n";
/// Bytes before a record's body: length and CRC.
const FRAME: usize = 8;
/// Bytes before an item's payload: index and state.
const HEAD: usize = 5;

/// Largest journal that is read, in bytes.
const LARGEST: u64 = 4 << 30;

/// What the items of a journal belong to.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Header {
    /// SHA-256 (hex) of everything the items depend on.
    pub key: String,
    /// What a reader may want to know of it, one line.
    pub about: String,
    /// Items of the whole run.
    pub items: u32,
}

/// A result that a journal can hold: as bytes, and back without losing a bit.
pub trait Item: Sized {
    /// The result as bytes, the same on every machine.
    fn to_bytes(&self) -> Vec<u8>;

    /// The result that gave these bytes; `None` where they are none of this version's.
    fn from_bytes(bytes: &[u8]) -> Option<Self>;
}

/// Bytes stand for themselves.
impl Item for Vec<u8> {
    fn to_bytes(&self) -> Vec<u8> {
        self.clone()
    }

    fn from_bytes(bytes: &[u8]) -> Option<Self> {
        Some(bytes.to_vec())
    }
}

/// A finished item: its result, or why it failed.
pub type Outcome = std::result::Result<Vec<u8>, String>;

/// What the bytes of a journal hold.
#[derive(Clone, Debug, PartialEq)]
pub struct Contents {
    /// The first record.
    pub header: Header,
    /// The last sound record of each index.
    pub items: BTreeMap<u32, Outcome>,
    /// Bytes of all sound records; the rest is an interrupted write.
    pub sound: usize,
}

impl Contents {
    /// Reads a journal's bytes. Nothing is allocated for a record that is not there.
    ///
    /// # Errors
    /// [`Error::BadInput`] where even the header is not sound.
    pub fn parse(place: &str, bytes: &[u8]) -> Result<Self> {
        let bad = || Error::bad_input(place, "is not a journal of this version", "remove it");
        let records = bytes.strip_prefix(MAGIC).ok_or_else(bad)?;
        let first = body(records).ok_or_else(bad)?;
        let header: Header = serde_json::from_slice(first).map_err(|_| bad())?;
        let mut sound = MAGIC.len() + FRAME + first.len();
        let mut items = BTreeMap::new();
        while let Some(body) = body(&bytes[sound..]) {
            let Some((index, outcome)) = item(body).filter(|item| item.0 < header.items) else {
                break;
            };
            items.insert(index, outcome);
            sound += FRAME + body.len();
        }
        Ok(Self { header, items, sound })
    }

    /// Reads a journal that was finished: whole, of the given run.
    ///
    /// # Errors
    /// [`Error::Read`], [`Error::BadInput`] where it is damaged, [`Error::ResumeRefused`] where it
    /// belongs to another run.
    pub fn read_whole(path: &Path, header: &Header) -> Result<Self> {
        let (contents, bytes) = Self::read(path, header)?;
        if contents.sound == bytes {
            return Ok(contents);
        }
        let reason = format!("is damaged from byte {} of {bytes} on", contents.sound);
        Err(Error::bad_input(shown(path), reason, "remove it and make it again"))
    }

    fn read(path: &Path, header: &Header) -> Result<(Self, usize)> {
        let bytes = input::read(path, LARGEST)?;
        let contents = Self::parse(&shown(path), &bytes)?;
        if contents.header == *header {
            return Ok((contents, bytes.len()));
        }
        Err(Error::ResumeRefused(format!(
            "{} belongs to another run ({}; now {}); give the same settings and scenes, or start again without it",
            shown(path),
            contents.header.about,
            header.about,
        )))
    }
}

/// The body of the first record, if it is sound.
fn body(bytes: &[u8]) -> Option<&[u8]> {
    let word = |at: usize| Some(u32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?));
    let (length, crc) = (word(0)? as usize, word(4)?);
    let body = bytes.get(FRAME..)?.get(..length)?;
    (crc32fast::hash(body) == crc).then_some(body)
}

fn item(body: &[u8]) -> Option<(u32, Outcome)> {
    let (head, payload) = body.split_at_checked(HEAD)?;
    let index = u32::from_le_bytes(head[..4].try_into().ok()?);
    match head[4] {
        0 => Some((index, Ok(payload.to_vec()))),
        1 => Some((index, Err(String::from_utf8(payload.to_vec()).ok()?))),
        _ => None,
    }
}

fn framed(body: &[u8]) -> Vec<u8> {
    let length = u32::try_from(body.len()).expect("a record is below 4 GiB");
    let crc = crc32fast::hash(body);
    [&length.to_le_bytes(), &crc.to_le_bytes(), body].concat()
}

fn record(index: u32, outcome: &Outcome) -> Vec<u8> {
    let (state, payload) = match outcome {
        Ok(payload) => (0, payload.as_slice()),
        Err(reason) => (1, reason.as_bytes()),
    };
    framed(&[&index.to_le_bytes(), &[state][..], payload].concat())
}

/// The bytes of a journal with these items, in order of their index: the same for the same items.
#[must_use]
pub fn encode(header: &Header, items: &BTreeMap<u32, Outcome>) -> Vec<u8> {
    let text = serde_json::to_vec(header).expect("a header is JSON");
    let mut bytes = [MAGIC, &framed(&text)].concat();
    for (&index, outcome) in items {
        bytes.extend(record(index, outcome));
    }
    bytes
}

/// Refuses to replace or go on with what is no journal: a file may be absent, or begin as one does.
///
/// # Errors
/// [`Error::BadInput`].
pub fn check_ours(path: &Path) -> Result<()> {
    let refused = |reason: &str| {
        let fix = "nothing was written; look at it and remove it, or choose another --out";
        Err(Error::bad_input(shown(path), reason, fix))
    };
    let mut head = Vec::new();
    match found::open(path) {
        Ok(None) => return Ok(()),
        Ok(Some(file)) => file
            .take(MAGIC.len() as u64)
            .read_to_end(&mut head)
            .map_err(|e| Error::read(path, e))?,
        Err(reason) => return refused(&reason),
    };
    if head == MAGIC { Ok(()) } else { refused("is no journal of ours") }
}

/// A journal that is being written.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    file: File,
}

impl Journal {
    /// Starts a journal, replacing an earlier one.
    ///
    /// # Errors
    /// [`Error::Write`], [`Error::BadInput`] where what stands there is no journal.
    pub fn start(path: &Path, header: &Header) -> Result<Self> {
        check_ours(path)?;
        put(path, &encode(header, &BTreeMap::new()))?;
        Self::open(path, None)
    }

    /// Goes on with a journal, or starts one where there is none; returns the items it holds.
    ///
    /// # Errors
    /// [`Error::ResumeRefused`] where it belongs to another run, [`Error::BadInput`] where it is no
    /// journal, [`Error::Write`].
    pub fn resume(path: &Path, header: &Header) -> Result<(Self, BTreeMap<u32, Outcome>)> {
        check_ours(path)?;
        if !path.exists() {
            return Ok((Self::start(path, header)?, BTreeMap::new()));
        }
        let (contents, _) = Contents::read(path, header)?;
        Ok((Self::open(path, Some(contents.sound))?, contents.items))
    }

    fn open(path: &Path, sound: Option<usize>) -> Result<Self> {
        let open = || {
            let file = File::options().append(true).open(path)?;
            sound.map_or(Ok(()), |length| file.set_len(length as u64))?;
            Ok(file)
        };
        let file = open().map_err(|e| Error::write(path, e))?;
        Ok(Self { path: path.to_path_buf(), file })
    }

    /// Appends a finished item and makes it durable.
    ///
    /// # Errors
    /// [`Error::Write`]; what was appended before is kept.
    pub fn append(&mut self, index: u32, outcome: &Outcome) -> Result<()> {
        let written = self.file.write_all(&record(index, outcome));
        written.and_then(|()| self.file.sync_data()).map_err(|e| Error::write(&self.path, e))
    }

    /// Removes the journal, whose items have been published. One that stays does no harm.
    pub fn discard(self) {
        drop(self.file);
        let _ = fs::remove_file(self.path);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn header() -> Header {
        Header { key: "k".into(), about: "a run".into(), items: 5 }
    }

    fn items() -> BTreeMap<u32, Outcome> {
        BTreeMap::from([(0, Ok(b"zero".to_vec())), (3, Err("fell over".into())), (4, Ok(vec![]))])
    }

    #[test]
    fn a_journal_cut_anywhere_keeps_its_whole_records() {
        let bytes = encode(&header(), &items());
        let first = encode(&header(), &BTreeMap::new()).len();
        let mut kept = Vec::new();
        for cut in first..=bytes.len() {
            let contents = Contents::parse("j", &bytes[..cut]).unwrap();
            assert!(contents.sound <= cut);
            assert!(contents.items.iter().all(|(i, o)| items()[i] == *o), "cut at {cut}");
            kept.push(contents.items.len());
        }
        assert!(kept.is_sorted() && kept.first() == Some(&0) && kept.last() == Some(&3));
        assert!((0..first).all(|cut| Contents::parse("j", &bytes[..cut]).is_err()));
    }

    #[test]
    fn no_flipped_bit_passes_for_a_result() {
        let bytes = encode(&header(), &items());
        for bit in 0..bytes.len() * 8 {
            let mut flipped = bytes.clone();
            flipped[bit / 8] ^= 1 << (bit % 8);
            let Ok(contents) = Contents::parse("j", &flipped) else { continue };
            assert!(contents.sound < bytes.len(), "bit {bit} went unseen");
            assert!(contents.items.iter().all(|(i, o)| items()[i] == *o), "bit {bit}");
        }
    }

    #[test]
    fn resuming_cuts_the_tail_and_refuses_another_run() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("j");
        let (mut journal, none) = Journal::resume(&path, &header()).unwrap();
        assert!(none.is_empty());
        journal.append(2, &Ok(b"two".to_vec())).unwrap();
        fs::write(
            &path,
            [fs::read(&path).unwrap(), record(1, &Ok(vec![7; 9]))[..12].to_vec()].concat(),
        )
        .unwrap();
        let (mut journal, items) = Journal::resume(&path, &header()).unwrap();
        assert_eq!(items, BTreeMap::from([(2, Ok(b"two".to_vec()))]));
        journal.append(1, &Ok(b"one".to_vec())).unwrap();
        let both = Contents::read_whole(&path, &header()).unwrap().items;
        assert_eq!(both.keys().copied().collect::<Vec<_>>(), [1, 2]);
        let other = Header { key: "other".into(), ..header() };
        assert_eq!(Journal::resume(&path, &other).unwrap_err().exit_code(), 5);
        journal.discard();
        assert!(!path.exists());
    }
}
