//! Nobody's files are touched: hostile and merely crowded output folders, at random and by kind.
#![cfg(unix)]

use std::collections::BTreeMap;
use std::fs;
use std::os::unix::fs::{FileTypeExt, symlink};
use std::path::Path;
use std::process::Command;

use gnomon::output::{MANIFEST_SCHEMA, Manifest, OutFile, Publication, digest, publish, verify};

fn state(text: &str, names: &[&str]) -> Vec<OutFile> {
    let mut files: Vec<_> = names.iter().map(|n| OutFile::new(*n, format!("{text} {n}"))).collect();
    files.push(manifest(files.iter().map(|f| (f.name.clone(), digest(&f.bytes))).collect()));
    files
}

fn manifest(outputs: BTreeMap<String, String>) -> OutFile {
    Manifest { schema: MANIFEST_SCHEMA.into(), outputs, ..Manifest::default() }.to_file()
}

const OLD: [&str; 4] = ["index.html", "results.json", "tables/a.csv", "plots/gone.svg"];
const NEW: [&str; 4] = ["index.html", "results.json", "tables/a.csv", "pictures/b.png"];

/// A journal as the program writes it, with a right digest of its own.
fn journal(files: &str) -> String {
    let body = format!(
        "{{\n  \"schema\": \"gnomon-publication-1\",\n  \"token\": \"0123456789abcdef\",\n  \
         \"done\": false,\n  \"files\": {{\n{files}\n  }}"
    );
    format!("{body},\n  \"digest\": \"{}\"\n}}\n", digest(body.as_bytes()))
}

fn entry(name: &str, old: Option<&str>, new: Option<&str>) -> String {
    let told =
        |d: Option<&str>| d.map_or("null".into(), |d| format!("\"{}\"", digest(d.as_bytes())));
    format!(
        "    \"{name}\": {{\n      \"old\": {},\n      \"new\": {}\n    }}",
        told(old),
        told(new)
    )
}

/// Everything below `root`: bytes of files, targets of links, the kind of the rest.
fn everything(root: &Path) -> BTreeMap<String, Vec<u8>> {
    let (mut found, mut pending) = (BTreeMap::new(), vec![root.to_path_buf()]);
    while let Some(folder) = pending.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let kind = fs::symlink_metadata(&path).unwrap().file_type();
            let name = path.strip_prefix(root).unwrap().display().to_string();
            if kind.is_dir() {
                pending.push(path);
            } else if kind.is_symlink() {
                found.insert(name, fs::read_link(&path).unwrap().display().to_string().into());
            } else if kind.is_fifo() {
                found.insert(name, b"a FIFO".to_vec());
            } else {
                found.insert(name, fs::read(&path).unwrap());
            }
        }
    }
    found
}

struct Random(fastrand::Rng);

impl Random {
    fn below(&mut self, limit: usize) -> usize {
        self.0.usize(..limit)
    }

    fn of<'a>(&mut self, choices: &[&'a str]) -> &'a str {
        choices[self.below(choices.len())]
    }
}

const NAMES: [&str; 14] = [
    "index.html",
    "results.json",
    "manifest.json",
    "tables/a.csv",
    "plots/gone.svg",
    "pictures/b.png",
    "notes.txt",
    ".lock.tmp",
    ".publish.tmp",
    ".publish.new.tmp",
    ".index.html.old.tmp",
    ".index.html.new.tmp",
    ".gnomon-0123456789abcdef-0-new.tmp",
    "tables/.a.csv.old.tmp",
];

/// Puts one hostile thing into `o`; what stood there goes.
fn spoil(root: &Path, random: &mut Random) {
    let out = root.join("o");
    let name = random.of(&NAMES);
    let path = out.join(name);
    let outside = random.of(&["../v/a", "tables/../../v/a", "ln/a"]).to_string();
    let outside =
        if random.below(4) == 0 { root.join("v/a").display().to_string() } else { outside };
    let clear = |path: &Path| {
        let _ = fs::remove_file(path);
        let _ = fs::create_dir_all(path.parent().unwrap());
    };
    match random.below(9) {
        0..=2 => {
            clear(&path);
            let _ = fs::write(&path, random.of(&["mine", "", "{}", "\u{1b}]0;x\u{7}", "<html>"]));
        }
        3 => {
            clear(&path);
            let _ = symlink(random.of(&["../v/a", "../v", "absent", "/dev/null"]), &path);
        }
        4 => {
            let _ = fs::remove_dir_all(out.join("tables"));
            let _ = symlink("../v", out.join("tables"));
        }
        5 => {
            let list =
                format!(r#"{{"replaced":[],"created":["{outside}"],"removed":["{outside}"]}}"#);
            clear(&out.join(".publish.tmp"));
            fs::write(out.join(".publish.tmp"), list).unwrap();
        }
        6 => {
            let _ = symlink("../v", out.join("ln"));
            let inside = entry("notes.txt", None, Some("other bytes"));
            let entries = [entry(&outside, None, Some("precious")), inside].join(",\n");
            clear(&out.join(".publish.tmp"));
            fs::write(out.join(".publish.tmp"), journal(&entries)).unwrap();
        }
        7 => {
            let _ = symlink("../v", out.join("ln"));
            let wrong = [(outside, digest(b"precious")), ("notes.txt".into(), digest(b"else"))];
            let file = manifest(wrong.into());
            let text = String::from_utf8(file.bytes).unwrap();
            let text =
                if random.below(2) == 0 { text } else { text.replace("seed\": 0", "seed\": 9") };
            clear(&out.join("manifest.json"));
            fs::write(out.join("manifest.json"), text).unwrap();
        }
        _ => {
            clear(&path);
            let made = match random.below(2) {
                0 => Command::new("mkfifo").arg(&path).status().is_ok(),
                _ => fs::create_dir(&path).is_ok(),
            };
            assert!(made || path.exists(), "{name}");
        }
    }
}

/// Publishes into `folders` random folders; nothing but what a real earlier publication wrote changes.
fn hostile(folders: u64, force: bool) -> [u32; 2] {
    let mut outcomes = [0; 2];
    for seed in 0..folders {
        let mut random = Random(fastrand::Rng::with_seed(seed));
        let scratch = tempfile::tempdir().unwrap();
        let root = scratch.path();
        let out = root.join("o");
        fs::create_dir_all(out.join("sub")).unwrap();
        fs::create_dir(root.join("v")).unwrap();
        for name in ["v/a", "v/a.csv", "v/b.png", "o/sub/x"] {
            fs::write(root.join(name), "precious").unwrap();
        }
        let earlier = random.below(2) == 0;
        if earlier {
            publish(&out, &state("old", &OLD)).unwrap();
        }
        let ours = everything(&out);
        for _ in 0..=random.below(3) {
            spoil(root, &mut random);
        }
        let before = everything(root);
        let done =
            Publication { force, ..Publication::default() }.publish(&out, &state("new", &NEW));
        let after = everything(root);
        // A journal with a right digest of its own may go: it is cleared away once it is undone.
        let written = |name: &str, bytes: &Vec<u8>| {
            let below = name.strip_prefix("o/").unwrap_or_default();
            let replaced = force && (below == "manifest.json" || NEW.contains(&below));
            // A manifest that nothing tells from one of ours may be replaced; what it lists may not.
            let text = String::from_utf8_lossy(bytes);
            let sound = text.contains("\"ln/a\"") && text.contains("\"seed\": 0");
            ours.get(below) == Some(bytes)
                || below == ".publish.tmp" && bytes.ends_with(b"\"\n}\n")
                || below == "manifest.json" && sound
                || replaced
        };
        for (name, bytes) in before.iter().filter(|(name, bytes)| !written(name, bytes)) {
            assert_eq!(after.get(name), Some(bytes), "seed {seed}: {name} was touched ({done:?})");
        }
        match done {
            Ok(_) => assert_eq!(verify(&out).unwrap(), 4, "seed {seed}"),
            Err(error) => {
                let said = error.to_string();
                assert!(error.exit_code() == 2 && said.contains("o/"), "seed {seed}: {said}");
                assert!(
                    said.contains("choose another --out") && !said.contains(char::is_control),
                    "{said}"
                );
                let kept = before.iter().filter(|(name, _)| !name.ends_with(".publish.tmp"));
                for (name, bytes) in kept {
                    assert_eq!(
                        after.get(name),
                        Some(bytes),
                        "seed {seed}: refused, and yet {name}"
                    );
                }
            }
        }
        outcomes[usize::from(
            everything(&out).get("index.html") == Some(&b"new index.html".to_vec()),
        )] += 1;
    }
    outcomes
}

#[test]
fn hostile_folders_keep_their_bytes() {
    let [refused, published] = hostile(120, false);
    assert!(refused > 10 && published > 3, "{refused} refused, {published} published");
    hostile(30, true);
}

#[test]
#[ignore = "soak: 1,000 folders, and 1,000 with --force"]
fn a_thousand_hostile_folders_keep_their_bytes() {
    println!(
        "refused, published: {:?}; with --force: {:?}",
        hostile(1000, false),
        hostile(1000, true)
    );
}

#[test]
fn notes_beside_a_report_are_no_reason_to_refuse() {
    let scratch = tempfile::tempdir().unwrap();
    let out = scratch.path();
    publish(out, &state("old", &OLD)).unwrap();
    for name in ["notes.txt", ".x.new.tmp", "tables/mine.csv", ".publish.new.tmp"] {
        fs::write(out.join(name), "mine").unwrap();
    }
    fs::write(out.join("plots/gone.svg"), "improved by hand").unwrap();
    publish(out, &state("new", &NEW)).unwrap();
    let after = everything(out);
    for name in ["notes.txt", ".x.new.tmp", "tables/mine.csv", ".publish.new.tmp"] {
        assert_eq!(after[name], b"mine", "{name}");
    }
    assert_eq!(after["plots/gone.svg"], b"improved by hand", "a changed file is the user's");
    let temporary = after.keys().filter(|name| name.ends_with(".tmp")).count();
    assert_eq!(temporary, 2, "no lock file and nothing of ours stays: {:?}", after.keys());
}

#[test]
fn a_changed_file_is_named_and_replaced_by_force_alone() {
    let scratch = tempfile::tempdir().unwrap();
    let out = scratch.path();
    publish(out, &state("old", &OLD)).unwrap();
    fs::write(out.join("results.json"), "edited").unwrap();
    let before = everything(out);
    let said = publish(out, &state("new", &NEW)).unwrap_err().to_string();
    assert!(said.contains("results.json") && said.contains("--force"), "{said}");
    assert_eq!(everything(out), before);
    Publication { force: true, ..Publication::default() }
        .publish(out, &state("new", &NEW))
        .unwrap();
    assert_eq!(verify(out).unwrap(), 4);
}

/// A file changed between a killed publication and the next run is not rolled back over.
#[test]
fn a_roll_back_meets_a_changed_file() {
    let scratch = tempfile::tempdir().unwrap();
    let out = scratch.path();
    fs::write(out.join("index.html"), "changed since").unwrap();
    let entries = entry("index.html", Some("old"), Some("new"));
    fs::write(out.join(".publish.tmp"), journal(&entries)).unwrap();
    let said = verify(out).unwrap_err().to_string();
    assert!(said.contains("cut short") && said.contains("run again"), "{said}");
    let before = everything(out);
    let error = publish(out, &state("new", &NEW)).unwrap_err();
    assert!(error.exit_code() == 2 && error.to_string().contains("index.html"), "{error}");
    assert_eq!(everything(out), before);
    Publication { force: true, ..Publication::default() }
        .publish(out, &state("new", &NEW))
        .unwrap();
    assert_eq!(verify(out).unwrap(), 4);
}

#[test]
fn verification_stays_in_the_folder() {
    let scratch = tempfile::tempdir().unwrap();
    let out = scratch.path().join("o");
    fs::create_dir(&out).unwrap();
    fs::write(scratch.path().join("a"), "precious").unwrap();
    let outside = scratch.path().join("a").display().to_string();
    for name in ["../a", outside.as_str(), "sub/../../a"] {
        let listed = manifest([(name.to_string(), digest(b"precious"))].into());
        fs::write(out.join("manifest.json"), listed.bytes).unwrap();
        let error = verify(&out).unwrap_err();
        assert!(
            error.exit_code() == 2 && error.to_string().contains("not in the folder"),
            "{error}"
        );
    }
    symlink("..", out.join("ln")).unwrap();
    symlink("../a", out.join("link")).unwrap();
    symlink("/dev/zero", out.join("zero")).unwrap();
    assert!(Command::new("mkfifo").arg(out.join("fifo")).status().unwrap().success());
    for name in ["ln/a", "link", "zero", "fifo"] {
        let listed = manifest([(name.to_string(), digest(b"precious"))].into());
        fs::write(out.join("manifest.json"), listed.bytes).unwrap();
        let error = verify(&out).unwrap_err();
        assert!(error.exit_code() == 1 && error.to_string().contains(name), "{error}");
    }
}
