//! Publishing is all or nothing: every step is made to fail, every crash is recovered from.

use std::cell::Cell;
use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::Path;

use gnomon::Error;
use gnomon::output::{
    Disk, FileLayer, Lock, MANIFEST_SCHEMA, Manifest, OutFile, digest, publish, publish_with,
    recover_with, verify,
};

/// Fails the `at`-th operation, or from then on every one (a crash).
struct Faulty {
    at: u32,
    crash: bool,
    done: Cell<u32>,
}

impl Faulty {
    fn new(at: u32, crash: bool) -> Self {
        Self { at, crash, done: Cell::new(0) }
    }

    fn step(&self, run: impl FnOnce() -> io::Result<()>) -> io::Result<()> {
        self.done.set(self.done.get() + 1);
        let fails = self.done.get() == self.at || self.crash && self.done.get() > self.at;
        if fails { Err(io::Error::other("injected fault")) } else { run() }
    }
}

impl FileLayer for Faulty {
    fn create_folder(&self, path: &Path) -> io::Result<()> {
        self.step(|| Disk.create_folder(path))
    }
    fn write(&self, path: &Path, bytes: &[u8]) -> io::Result<()> {
        // A failing write leaves half of the bytes, as a full disk does.
        let half = self.done.get() + 1 >= self.at && !self.crash;
        if half && self.done.get() + 1 == self.at {
            Disk.write(path, &bytes[..bytes.len() / 2])?;
        }
        self.step(|| Disk.write(path, bytes))
    }
    fn sync(&self, path: &Path) -> io::Result<()> {
        self.step(|| Disk.sync(path))
    }
    fn link(&self, from: &Path, to: &Path) -> io::Result<()> {
        self.step(|| Disk.link(from, to))
    }
    fn rename(&self, from: &Path, to: &Path) -> io::Result<()> {
        self.step(|| Disk.rename(from, to))
    }
    fn remove(&self, path: &Path) -> io::Result<()> {
        self.step(|| Disk.remove(path))
    }
    fn sync_folder(&self, path: &Path) -> io::Result<()> {
        self.step(|| Disk.sync_folder(path))
    }
}

fn state(names: &[(&str, &str)]) -> Vec<OutFile> {
    let mut files: Vec<_> = names.iter().map(|(n, text)| OutFile::new(*n, *text)).collect();
    let outputs = files.iter().map(|f| (f.name.clone(), digest(&f.bytes))).collect();
    files.push(
        Manifest { schema: MANIFEST_SCHEMA.into(), outputs, ..Manifest::default() }.to_file(),
    );
    files
}

fn old_state() -> Vec<OutFile> {
    state(&[("results.json", "old results"), ("plots/a.svg", "old a"), ("plots/gone.svg", "old")])
}

fn new_state() -> Vec<OutFile> {
    state(&[("results.json", "new"), ("plots/a.svg", "new a"), ("pictures/b.png", "new b")])
}

/// Every file below `folder` except the lock, by name.
fn content(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    let mut pending = vec![folder.to_path_buf()];
    while let Some(path) = pending.pop() {
        for entry in fs::read_dir(path).unwrap() {
            let path = entry.unwrap().path();
            let name = path.strip_prefix(folder).unwrap().to_str().unwrap().replace('\\', "/");
            if path.is_dir() {
                pending.push(path);
            } else if name != ".lock.tmp" {
                found.insert(name, fs::read(&path).unwrap());
            }
        }
    }
    found
}

fn as_content(files: &[OutFile]) -> BTreeMap<String, Vec<u8>> {
    files.iter().map(|file| (file.name.clone(), file.bytes.clone())).collect()
}

fn finished(name: &str) -> bool {
    !name.ends_with(".tmp")
}

#[test]
fn publishing_replaces_adds_and_removes_together() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("mine.txt"), "not of this program").unwrap();
    publish(folder.path(), &old_state()).unwrap();
    publish(folder.path(), &new_state()).unwrap();
    let mut expected = as_content(&new_state());
    expected.insert("mine.txt".into(), b"not of this program".to_vec());
    assert_eq!(content(folder.path()), expected);
    assert_eq!(verify(folder.path()).unwrap(), 3);
}

/// One fault at any operation: an error that names a path and the system's answer, and exactly
/// the old or the new files.
#[test]
fn any_single_fault_leaves_the_old_or_the_new_state() {
    let (old, new) = (as_content(&old_state()), as_content(&new_state()));
    let mut kept_old = 0;
    for at in 1.. {
        let folder = tempfile::tempdir().unwrap();
        publish(folder.path(), &old_state()).unwrap();
        let layer = Faulty::new(at, false);
        let outcome = publish_with(&layer, folder.path(), &new_state());
        let left = content(folder.path());
        if layer.done.get() < at {
            assert!(outcome.is_ok() && left == new, "no fault, and yet not published");
            assert!(at > 30, "only {at} operations were seen: the layer is bypassed");
            break;
        }
        let files: BTreeMap<_, _> = left.into_iter().filter(|(name, _)| finished(name)).collect();
        match outcome {
            Ok(_) => assert_eq!(files, new, "fault {at} was passed over but the state is not new"),
            Err(Error::Write { source, .. }) => {
                assert_eq!(source.to_string(), "injected fault");
                assert_eq!(files, old, "fault {at} left a mix");
                kept_old += 1;
            }
            Err(other) => panic!("fault {at} gave another error: {other}"),
        }
    }
    assert!(kept_old > 25, "only {kept_old} faults were reported");
}

/// A crash at any operation (nothing works from then on): the next process finds the old state
/// after recovery, or the new one, and can publish.
#[test]
fn any_crash_is_recovered_to_the_old_or_the_new_state() {
    let (old, new) = (as_content(&old_state()), as_content(&new_state()));
    let mut seen = [false; 2];
    for at in 1.. {
        let folder = tempfile::tempdir().unwrap();
        publish(folder.path(), &old_state()).unwrap();
        let layer = Faulty::new(at, true);
        let _ = publish_with(&layer, folder.path(), &new_state());
        if layer.done.get() < at {
            break;
        }
        recover_with(&Disk, folder.path()).unwrap();
        let files: BTreeMap<_, _> =
            content(folder.path()).into_iter().filter(|(name, _)| finished(name)).collect();
        assert!(files == old || files == new, "crash at {at} left a mix: {:?}", files.keys());
        seen[usize::from(files == new)] = true;
        publish(folder.path(), &new_state()).unwrap();
        assert_eq!(content(folder.path()), new, "temporary files stay after crash {at}");
    }
    assert_eq!(seen, [true, true], "crashes fell on one side of the commit only");
}

#[test]
fn a_first_publication_that_fails_leaves_nothing() {
    for at in 2..40 {
        let folder = tempfile::tempdir().unwrap();
        let layer = Faulty::new(at, false);
        if publish_with(&layer, folder.path(), &new_state()).is_err() {
            let left: Vec<_> = content(folder.path()).into_keys().filter(|n| finished(n)).collect();
            assert!(left.is_empty(), "fault {at} left {left:?}");
        }
    }
}

#[test]
fn a_held_folder_is_refused_with_the_holder() {
    let folder = tempfile::tempdir().unwrap();
    let lock = Lock::acquire(folder.path()).unwrap();
    let error = publish(folder.path(), &new_state()).unwrap_err();
    assert_eq!(error.exit_code(), 2);
    #[cfg(unix)]
    assert!(
        error.to_string().contains(&format!("locked by pid {}", std::process::id())),
        "{error}"
    );
    drop(lock);
    publish(folder.path(), &new_state()).unwrap();
}

#[test]
fn a_stale_lock_file_does_not_hold_the_folder() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join(".lock.tmp"), "4194305").unwrap();
    publish(folder.path(), &new_state()).unwrap();
}

#[test]
fn verification_finds_every_changed_file() {
    let folder = tempfile::tempdir().unwrap();
    publish(folder.path(), &new_state()).unwrap();
    for file in new_state().iter().filter(|file| file.name != "manifest.json") {
        let path = folder.path().join(&file.name);
        for bit in 0..file.bytes.len() * 8 {
            let mut bytes = file.bytes.clone();
            bytes[bit / 8] ^= 1 << (bit % 8);
            fs::write(&path, bytes).unwrap();
            let error = verify(folder.path()).unwrap_err();
            assert!(error.to_string().contains(&file.name), "{error}");
            assert_eq!(error.exit_code(), 1);
        }
        fs::write(&path, &file.bytes).unwrap();
    }
    fs::remove_file(folder.path().join("results.json")).unwrap();
    assert!(matches!(verify(folder.path()), Err(Error::Read { .. })));
}

/// R45: any bit of any file, the manifest's own too.
#[test]
fn a_thousand_flipped_bits_are_a_thousand_refusals() {
    let folder = tempfile::tempdir().unwrap();
    publish(folder.path(), &new_state()).unwrap();
    let files: Vec<_> = content(folder.path()).into_iter().collect();
    let mut seed = 45u64;
    for flip in 0..1000 {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        let (name, bytes) = &files[(seed >> 33) as usize % files.len()];
        let bit = (seed >> 40) as usize % (bytes.len() * 8);
        let mut flipped = bytes.clone();
        flipped[bit / 8] ^= 1 << (bit % 8);
        fs::write(folder.path().join(name), flipped).unwrap();
        let error = verify(folder.path()).expect_err(name);
        // A broken name in the manifest is a file that is not there.
        let named = error.to_string().contains(name.as_str()) || name == "manifest.json";
        assert!(named, "flip {flip}, bit {bit} of {name}: {error}");
        fs::write(folder.path().join(name), bytes).unwrap();
    }
    assert_eq!(verify(folder.path()).unwrap(), 3);
}

#[test]
#[cfg(target_os = "linux")]
fn an_unwritable_place_is_one_sentence_with_exit_code_4() {
    let error = publish(Path::new("/proc/gnomon"), &new_state()).unwrap_err();
    assert_eq!(error.exit_code(), 4);
    let text = error.to_string();
    assert!(text.starts_with("/proc/gnomon: cannot be written") && !text.contains('\n'), "{text}");
}
