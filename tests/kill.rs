//! What a machine does to a running sweep: killed at any moment, disk full, folder read-only.
#![cfg(unix)]

#[path = "support/sweeping.rs"]
mod sweeping;

use gnomon::output::verify;
use std::fs;
use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};
use sweeping::{content, expect, run_in, said};

/// A random number below `limit`, from a seed that it advances.
fn random(seed: &mut u64, limit: u64) -> u64 {
    *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*seed >> 33) % limit
}

/// Kills `kills` runs at random moments, the next one going on where the last was killed. After each,
/// whatever is published is whole, and every run that ends has written the undisturbed run's bytes.
fn kill_at_random_moments(kills: u32, mut seed: u64) -> u32 {
    let out = tempfile::tempdir().unwrap();
    let (single, folder) = (out.path().join("single"), out.path().join("killed"));
    let start = Instant::now();
    expect(&run_in(&single, &[]), 0);
    let length = start.elapsed().as_micros() as u64;
    let expected = content(&single);
    let (mut done, mut finished) = (0, 0);
    while done < kills {
        let mut child = sweeping::spawn(&folder, &["--resume"]);
        std::thread::sleep(Duration::from_micros(random(&mut seed, length)));
        let ended = child.try_wait().unwrap().is_some();
        if !ended {
            child.kill().unwrap();
            child.wait().unwrap();
            done += 1;
        }
        // A publication that was cut short is undone by the next process; look at what it leaves.
        if folder.exists() {
            gnomon::output::recover_with(&gnomon::output::Disk, &folder).unwrap();
        }
        let published = folder.join("manifest.json").exists();
        if published {
            verify(&folder).unwrap();
            assert_eq!(content(&folder), expected, "a mix after kill {done}");
            finished += 1;
            // From the start again, over the published files or without them.
            if random(&mut seed, 2) == 0 {
                fs::remove_dir_all(&folder).unwrap();
            }
        } else if folder.exists() {
            assert!(
                content(&folder).is_empty(),
                "published in part: {:?}",
                content(&folder).keys()
            );
        }
    }
    expect(&run_in(&folder, &["--resume"]), 0);
    assert_eq!(content(&folder), expected, "resumed");
    finished
}

#[test]
fn killed_at_ten_random_moments() {
    kill_at_random_moments(10, 1);
}

/// R38.
#[test]
#[ignore = "soak: 100 kills, about a minute"]
fn killed_at_a_hundred_random_moments() {
    let finished = kill_at_random_moments(100, 38);
    println!("100 kills, {finished} published states seen, each whole");
}

/// Mounts a small file system; `None` where this user may not.
fn small_disk(at: &Path, size: &str) -> Option<Mounted> {
    fs::create_dir(at).unwrap();
    let options = format!("size={size}");
    let mut mount = Command::new("mount");
    let mount = mount.args(["-t", "tmpfs", "-o", &options, "tmpfs"]).arg(at).output().ok()?;
    mount.status.success().then(|| Mounted(at.display().to_string()))
}

struct Mounted(String);

impl Drop for Mounted {
    fn drop(&mut self) {
        let _ = Command::new("umount").arg(&self.0).status();
    }
}

/// R40.
#[test]
fn a_full_disk_leaves_published_files_and_can_be_gone_on_from() {
    let out = tempfile::tempdir().unwrap();
    let single = out.path().join("single");
    expect(&run_in(&single, &[]), 0);
    let disk = out.path().join("disk");
    let Some(_mounted) = small_disk(&disk, "4m") else {
        return println!("SKIPPED: no right to mount a small disk");
    };
    let folder = disk.join("r");
    expect(&run_in(&folder, &[]), 0);
    let published = content(&folder);
    // Fill the disk but for so many KiB: the journal, staging or neither finds room.
    for room in [0, 64] {
        let ballast = disk.join("ballast");
        fs::write(&ballast, vec![0; 4 << 20]).unwrap_err();
        let filled = fs::metadata(&ballast).unwrap().len();
        fs::File::options()
            .write(true)
            .open(&ballast)
            .unwrap()
            .set_len(filled - (room << 10))
            .unwrap();
        let full = run_in(&folder, &["--resume"]);
        let words = said(&full.stderr);
        assert_eq!(full.status.code(), Some(4), "{room} KiB of room: {words}");
        assert!(words.contains("cannot be written") && words.lines().count() == 1, "{words}");
        assert_eq!(content(&folder), published, "{room} KiB of room");
        fs::remove_file(&ballast).unwrap();
        expect(&run_in(&folder, &["--resume"]), 0);
        assert_eq!(content(&folder), content(&single));
    }
}

/// R40: root may write anywhere, so the folder is on a file system mounted read-only.
#[test]
fn a_read_only_folder_is_one_sentence() {
    let out = tempfile::tempdir().unwrap();
    let disk = out.path().join("disk");
    let Some(_mounted) = small_disk(&disk, "4m") else {
        return println!("SKIPPED: no right to mount a small disk");
    };
    let folder = disk.join("r");
    expect(&run_in(&folder, &[]), 0);
    let published = content(&folder);
    let remounted = Command::new("mount").args(["-o", "remount,ro"]).arg(&disk).status().unwrap();
    assert!(remounted.success());
    let refused = run_in(&folder, &[]);
    expect(&refused, 4);
    assert!(said(&refused.stderr).contains("cannot be written"), "{}", said(&refused.stderr));
    assert_eq!(content(&folder), published);
}

/// R47: pairs of processes on one folder: one works, the other is refused, nothing is mixed.
fn race(pairs: u32) {
    let out = tempfile::tempdir().unwrap();
    expect(&run_in(&out.path().join("single"), &[]), 0);
    let expected = content(&out.path().join("single"));
    for pair in 0..pairs {
        let folder = out.path().join("raced");
        let children = [sweeping::spawn(&folder, &[]), sweeping::spawn(&folder, &[])];
        let mut codes = children.map(|mut child| child.wait().unwrap().code().unwrap());
        codes.sort_unstable();
        // Both may work if the second started when the first was over.
        assert!(codes == [0, 2] || codes == [0, 0], "pair {pair}: {codes:?}");
        assert_eq!(content(&folder), expected, "pair {pair}");
    }
}

#[test]
fn two_races_for_one_folder() {
    race(2);
}

#[test]
#[ignore = "soak: 100 races, about a minute"]
fn a_hundred_races_for_one_folder() {
    race(100);
}
