//! The structure that lib.rs promises: layers, file sizes, one responsibility a file, catalogues.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// Layer of each module, in whichever package it stands; modules of one layer do not meet but in
/// [`PAIRED`].
const LAYERS: &[(&str, u8)] = &[
    ("error", 0),
    ("catalogue", 0),
    ("num", 0),
    ("size", 0),
    ("memory", 0),
    ("input", 0),
    ("simd", 0),
    ("depth", 1),
    ("view", 1),
    ("device", 2),
    ("light", 2),
    ("camera", 2),
    ("scene", 3),
    ("shadow", 4),
    ("truth", 4),
    ("raster", 5),
    ("engines", 5),
    ("load", 6),
    ("report", 6),
    ("output", 6),
    ("analysis", 7),
    ("conformance", 7),
    ("stress", 7),
    ("scene_file", 7),
    ("harness", 8),
];

/// Modules of one layer that may import each other: the report's writers publish through `output`.
const PAIRED: &[(&str, &str)] =
    &[("report", "output"), ("depth", "view"), ("analysis", "scene_file")];

/// Packages below the root; one is a module of the root by its own name where it has no rooms.
const PACKAGES: &[&str] = &["core", "load", "page"];

const LONGEST_FILE: usize = 400;
const LONGEST_FUNCTION: usize = 80;

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

fn rust_files(folder: &str) -> Vec<PathBuf> {
    fn walk(folder: &Path, found: &mut Vec<PathBuf>) {
        for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
            let path = entry.path();
            if path.is_dir() {
                walk(&path, found);
            } else if path.extension().is_some_and(|e| e == "rs") {
                found.push(path);
            }
        }
    }
    let mut found = Vec::new();
    walk(&root().join(folder), &mut found);
    found.sort();
    assert!(!found.is_empty(), "{folder} holds no Rust file");
    found
}

fn name(path: &Path) -> String {
    path.strip_prefix(root()).unwrap_or(path).display().to_string()
}

/// The module that a file under src belongs to; a package without rooms is one module.
fn module(path: &Path) -> String {
    let relative = path.strip_prefix(root().join("src")).unwrap();
    let mut parts = relative.components().map(|c| c.as_os_str().to_string_lossy());
    let first = parts.next().unwrap();
    let room = match first.as_ref() {
        "core" | "page" => parts.next().unwrap(),
        _ => first,
    };
    room.trim_end_matches(".rs").to_string()
}

/// Modules named by `crate::module`, `gnomon_core::module` and so on in code (comments left out).
fn imports(text: &str) -> Vec<String> {
    let code = text.lines().filter(|l| !l.trim_start().starts_with("//"));
    let mut found = Vec::new();
    for line in code {
        for root in ["crate::", "gnomon_core::", "gnomon_page::"] {
            for (at, _) in line.match_indices(root) {
                let rest = &line[at + root.len()..];
                let word = |c: char| !c.is_alphanumeric() && c != '_';
                found.push(rest[..rest.find(word).unwrap_or(rest.len())].to_string());
            }
        }
        if line.contains("gnomon_load::") {
            found.push("load".to_string());
        }
    }
    found
}

#[test]
fn no_module_imports_a_higher_layer_or_a_sibling() {
    let layers: BTreeMap<&str, u8> = LAYERS.iter().copied().collect();
    let mut checked = 0;
    for path in rust_files("src") {
        let own = module(&path);
        if own == "lib" {
            continue;
        }
        let layer = *layers.get(own.as_str()).unwrap_or_else(|| panic!("{own} has no layer"));
        for import in imports(&fs::read_to_string(&path).unwrap()) {
            let Some(&other) = layers.get(import.as_str()) else { continue };
            let pair = |a: &str, b: &str| PAIRED.contains(&(a, b)) || PAIRED.contains(&(b, a));
            let fine = import == own || layer == 0 || other < layer || pair(&own, &import);
            assert!(fine, "{} (layer {layer}) imports {import} (layer {other})", name(&path));
            checked += 1;
        }
    }
    assert!(checked > 50, "only {checked} imports were seen: the scan is broken");
}

#[test]
fn files_are_short_and_say_what_they_are_for() {
    for folder in ["src", "experiments", "tests"] {
        for path in rust_files(folder) {
            let text = fs::read_to_string(&path).unwrap();
            let lines = text.lines().count();
            assert!(lines <= LONGEST_FILE, "{} has {lines} lines", name(&path));
            assert!(text.starts_with("//!"), "{} does not begin with //!", name(&path));
        }
    }
    for path in fs::read_dir(root().join("experiments")).unwrap().flatten() {
        let path = path.path();
        if path.extension().is_some_and(|e| e == "rs") {
            let lines = fs::read_to_string(&path).unwrap().lines().count();
            assert!(lines <= 120, "{} has {lines} lines", name(&path));
        }
    }
}

#[test]
fn functions_are_short() {
    let mut lengths = Vec::new();
    for path in rust_files("src") {
        let text = fs::read_to_string(&path).unwrap();
        let lines: Vec<&str> = text.lines().collect();
        for (i, line) in lines.iter().enumerate() {
            let indent = line.len() - line.trim_start().len();
            let head =
                line.trim_start().trim_start_matches("pub(super) ").trim_start_matches("pub ");
            let head = head.trim_start_matches("const ").trim_start_matches("unsafe ");
            // A declaration has no body.
            if !head.starts_with("fn ") || head.ends_with(';') {
                continue;
            }
            let closing = format!("{}}}", " ".repeat(indent));
            let end = lines[i..].iter().position(|l| *l == closing).unwrap_or(0);
            assert!(end < LONGEST_FUNCTION, "{}:{} has {end} lines", name(&path), i + 1);
            lengths.push(end + 1);
        }
    }
    lengths.sort_unstable();
    let median = lengths[lengths.len() / 2];
    assert!(lengths.len() > 200 && median <= 10, "median of {} is {median}", lengths.len());
}

#[test]
fn packages_depend_downwards() {
    let allowed = |package: &str| match package {
        "core" => vec![],
        "load" | "page" => vec!["gnomon-core"],
        other => panic!("{other} is no package"),
    };
    for package in PACKAGES {
        let manifest =
            fs::read_to_string(root().join("src").join(package).join("Cargo.toml")).unwrap();
        let needs: toml::Table = manifest.parse().unwrap();
        let own = needs["dependencies"].as_table().unwrap().keys();
        let own: Vec<&str> = own.map(String::as_str).filter(|d| d.starts_with("gnomon")).collect();
        assert_eq!(own, allowed(package), "dependencies of {package}");
    }
}

#[test]
fn unsafe_stays_in_its_one_file() {
    for path in rust_files("src") {
        let text = fs::read_to_string(&path).unwrap();
        let word = ["unsafe", " {"].concat();
        assert!(!text.contains(&word) || module(&path) == "simd", "{} is unsafe", name(&path));
    }
}

#[test]
fn result_paths_use_no_float_function_of_unspecified_precision() {
    const FORBIDDEN: &[&str] = &[
        "sin", "cos", "tan", "asin", "acos", "atan", "atan2", "sinh", "cosh", "tanh", "exp",
        "exp2", "exp_m1", "ln", "ln_1p", "log", "log2", "log10", "powf", "powi", "cbrt", "hypot",
        "sin_cos",
    ];
    for path in rust_files("src") {
        let text = fs::read_to_string(&path).unwrap();
        for word in FORBIDDEN {
            let call = format!(".{word}(");
            let hit = text.lines().find(|l| l.contains(&call) && !l.contains("libm::"));
            assert!(hit.is_none(), "{}: {}", name(&path), hit.unwrap_or_default().trim());
        }
    }
}

#[test]
fn every_experiment_is_a_binary() {
    let manifest = fs::read_to_string(root().join("Cargo.toml")).unwrap();
    for entry in fs::read_dir(root().join("experiments")).unwrap().flatten() {
        let path = entry.path();
        if path.extension().is_some_and(|e| e == "rs") {
            let line = format!("path = \"{}\"", name(&path));
            assert!(manifest.contains(&line), "Cargo.toml lacks {line}");
        }
    }
}

#[test]
fn no_committed_text_names_a_machine() {
    let mut texts: Vec<PathBuf> = ["src", "experiments", "tests"].map(rust_files).concat();
    texts.extend(["README.md", "Cargo.toml"].map(|f| root().join(f)));
    let forbidden = [["../", "shared"].concat(), ["/", "work/"].concat(), ["/", "root/"].concat()];
    for path in texts {
        let text = fs::read_to_string(&path).unwrap();
        for word in &forbidden {
            assert!(!text.contains(word.as_str()), "{} names {word}", name(&path));
        }
    }
}

/// Names of the sets that `catalogue!` (or a macro over it) declares, in whichever package.
fn catalogues() -> Vec<String> {
    let mut names = Vec::new();
    for path in rust_files("src") {
        let text = fs::read_to_string(&path).unwrap();
        for (at, _) in text.match_indices("catalogue! {").chain(text.match_indices("packings! {")) {
            let Some(head) = text[at..].split("pub enum ").nth(1) else { continue };
            let end = head.find(|c: char| !c.is_alphanumeric()).unwrap_or(0);
            names.push(head[..end].to_string());
        }
    }
    names.retain(|name| !name.is_empty());
    assert!(names.len() > 20, "only {names:?}: the scan is broken");
    names
}

/// Patterns of the match that an arm of `lines[at]` ends, and the type that `Self` stands for.
fn arms<'t>(lines: &[&'t str], at: usize) -> (Vec<&'t str>, &'t str) {
    let indent = |line: &str| line.len() - line.trim_start().len();
    let own = indent(lines[at]);
    let inside = lines[..at].iter().rev().take_while(|l| l.trim().is_empty() || indent(l) >= own);
    let same = inside.filter(|l| indent(l) == own).map(|l| l.split("=>").next().unwrap_or(l));
    let same = same.map(|l| l.split(" if ").next().unwrap_or(l)); // Guards are no patterns.
    let head = lines[..at].iter().rev().find(|l| l.starts_with("impl"));
    (
        same.collect(),
        head.and_then(|l| l.trim_end_matches(" {").split(' ').next_back()).unwrap_or(""),
    )
}

/// A new member of a catalogue is led to every place that tells its members apart: clippy sees to plain
/// matches, this to those over pairs.
#[test]
fn no_wildcard_stands_for_members_of_a_catalogue() {
    let catalogues = catalogues();
    let (mut wildcards, mut hits) = (0, Vec::new());
    for path in rust_files("src") {
        let text = fs::read_to_string(&path).unwrap();
        let lines: Vec<&str> = text.split("#[cfg(test)]").next().unwrap().lines().collect();
        for (at, line) in lines.iter().enumerate() {
            let arm = line.trim_start();
            if !(arm.starts_with("_ =>") || arm.starts_with("_ if")) {
                continue;
            }
            wildcards += 1;
            let (patterns, own) = arms(&lines, at);
            let names = |pattern: &&str| {
                catalogues.iter().any(|name| {
                    pattern.contains(&format!("{name}::"))
                        || (name == own && pattern.contains("Self::"))
                })
            };
            let hit = patterns.iter().find(|p| names(p));
            hits.extend(hit.map(|p| format!("{}:{}: _ beside {}", name(&path), at + 1, p.trim())));
        }
    }
    assert_eq!(hits, Vec::<String>::new());
    assert!(wildcards > 10, "only {wildcards} wildcards were seen: the scan is broken");
}
