//! The code reads: docs stand alone, names are not shared, and the map in lib.rs is complete.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

fn rust_files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() {
            rust_files(&path, found);
        } else if path.extension().is_some_and(|e| e == "rs") {
            found.push(path);
        }
    }
}

/// Every file of the packages with its package: `core`, `load`, `page` or `gnomon`, the root.
fn sources() -> Vec<(String, PathBuf, String)> {
    let mut paths = Vec::new();
    rust_files(&root().join("src"), &mut paths);
    paths.sort();
    assert!(paths.len() > 100, "only {} files were found", paths.len());
    let source = |path: PathBuf| {
        let inside = path.strip_prefix(root().join("src")).unwrap();
        let first = inside.iter().next().unwrap().to_string_lossy().into_owned();
        let package = match first.as_str() {
            "core" | "load" | "page" => first,
            _ => "gnomon".to_string(),
        };
        let text = fs::read_to_string(&path).unwrap();
        (package, path, text)
    };
    paths.into_iter().map(source).collect()
}

/// First words of a doc that leans on its neighbour: it has no subject of its own.
const LEANING: [&str; 10] =
    ["Of ", "Those ", "The same", "Whose ", "It ", "They ", "These are", "Both,", "And ", "Ditto"];

#[test]
fn the_first_sentence_of_a_doc_has_a_subject_and_stands_alone() {
    let (mut docs, mut leaning) = (0, Vec::new());
    for (_, path, text) in sources() {
        let mut before = "";
        for (i, line) in text.lines().enumerate() {
            let doc = |line: &str| line.trim_start().starts_with("///");
            if doc(line) && !doc(before) {
                docs += 1;
                let says = line.trim_start().trim_start_matches('/').trim_start();
                if LEANING.iter().any(|first| says.starts_with(first)) {
                    leaning.push(format!("{}:{}: {says}", path.display(), i + 1));
                }
            }
            before = line;
        }
    }
    assert!(docs > 2000, "only {docs} docs were seen: the scan is broken");
    assert!(leaning.is_empty(), "these docs lean on their neighbours:\n{}", leaning.join("\n"));
}

/// The name of the public type that a line declares.
fn public_type(line: &str) -> Option<&str> {
    let rest = line.trim_start().strip_prefix("pub ")?;
    let kinds = ["struct ", "enum ", "trait ", "type ", "union "];
    let name = kinds.iter().find_map(|kind| rest.strip_prefix(kind))?;
    name.split(|c: char| !c.is_alphanumeric() && c != '_').next()
}

#[test]
fn no_two_public_types_of_a_package_share_a_name() {
    let mut homes: BTreeMap<(String, String), BTreeSet<String>> = BTreeMap::new();
    for (package, path, text) in sources() {
        for line in text.lines() {
            // An associated type stands in its trait and has no home of its own.
            // A macro's own `pub enum $Set` has no name here.
            let Some(name) = public_type(line).filter(|name| !name.is_empty()) else { continue };
            let home = homes.entry((package.clone(), name.to_string())).or_default();
            // A file holds one type of a name: a macro in it may repeat the declaration.
            home.insert(path.display().to_string());
        }
    }
    assert!(homes.len() > 200, "only {} types were seen: the scan is broken", homes.len());
    for ((package, name), homes) in homes {
        assert!(homes.len() == 1, "{package} has {} types {name}: {homes:?}", homes.len());
    }
}

/// The modules that a crate's root declares.
fn modules(package: &str) -> Vec<String> {
    let file = match package {
        "gnomon" => root().join("src/lib.rs"),
        other => root().join("src").join(other).join("lib.rs"),
    };
    let text = fs::read_to_string(file).unwrap();
    let module =
        |line: &str| Some(line.strip_prefix("pub mod ")?.trim_end_matches(';').to_string());
    text.lines().filter_map(module).collect()
}

#[test]
fn the_map_in_lib_rs_names_every_module_with_its_package_and_layer() {
    let text = fs::read_to_string(root().join("src/lib.rs")).unwrap();
    let rows: Vec<Vec<&str>> = text
        .lines()
        .filter(|line| line.starts_with("//! | L"))
        .map(|line| line.trim_start_matches("//! |").split('|').map(str::trim).collect())
        .collect();
    let mut named = 0;
    for package in ["core", "page", "gnomon"] {
        for module in modules(package) {
            let link = [format!("[`{module}`]"), format!("[`{module}`](")];
            let says = |row: &&Vec<&str>| {
                row[1] == package && link.iter().any(|link| row[2].contains(link.as_str()))
            };
            let found = rows.iter().filter(says).count();
            assert!(found == 1, "the map names {module} of {package} in {found} rows, not in one");
            named += 1;
        }
    }
    assert!(named >= 20, "only {named} modules were seen: the scan is broken");
    assert!(rows.iter().any(|row| row[1] == "load" && row[2].contains("[`load`]")));
}
