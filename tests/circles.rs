//! No circle between the files of one room: what a file names of its neighbours never leads back to it.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// A module's path from the crate's root.
type Module = Vec<String>;

/// Every module under src with its code: no comments, no unit tests.
fn modules() -> BTreeMap<Module, String> {
    fn walk(folder: &Path, found: &mut Vec<PathBuf>) {
        for entry in fs::read_dir(folder).unwrap().flatten() {
            let path = entry.path();
            if path.is_dir() { walk(&path, found) } else { found.push(path) }
        }
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    walk(&root, &mut files);
    let rust = files.into_iter().filter(|f| f.extension().is_some_and(|e| e == "rs"));
    let module = |file: PathBuf| {
        let relative = file.strip_prefix(&root).unwrap().with_extension("");
        let parts = relative.components().map(|c| c.as_os_str().to_string_lossy().into_owned());
        let parts: Module = parts.filter(|part| part != "mod" && part != "lib").collect();
        (parts, code(&fs::read_to_string(&file).unwrap()))
    };
    rust.map(module).filter(|(module, _)| !module.is_empty()).collect()
}

fn code(text: &str) -> String {
    let text = text.split("#[cfg(test)]").next().unwrap();
    let bare = |line: &str| line.split("//").next().unwrap().to_string();
    text.lines().map(bare).collect::<Vec<_>>().join("\n")
}

/// The paths of a use tree: `a::{b, c::d}` names a::b and a::c::d.
fn paths(tree: &str) -> Vec<Vec<String>> {
    let parts = |text: &str| -> Vec<String> {
        let name = text.split(" as ").next().unwrap();
        name.split("::").map(|part| part.trim().to_string()).filter(|p| !p.is_empty()).collect()
    };
    let Some((head, rest)) = tree.split_once('{') else { return vec![parts(tree)] };
    let inner = rest.rsplit_once('}').map_or(rest, |(inner, _)| inner);
    let (mut depth, mut branches) = (0, vec![String::new()]);
    for c in inner.chars() {
        match c {
            '{' => depth += 1,
            '}' => depth -= 1,
            _ => {}
        }
        match (c, depth) {
            (',', 0) => branches.push(String::new()),
            _ => branches.last_mut().unwrap().push(c),
        }
    }
    let branches = branches.iter().filter(|branch| !branch.trim().is_empty());
    let under = |path: Vec<String>| [parts(head), path].concat();
    branches.flat_map(|branch| paths(branch).into_iter().map(under)).collect()
}

/// Every path that code names, from `use` items and in passing.
fn named(code: &str) -> Vec<Vec<String>> {
    let mut found = Vec::new();
    let mut rest = String::new();
    for statement in code.split_inclusive(';') {
        match statement.split_once("use ") {
            Some((before, tree))
                if !before.chars().next_back().is_some_and(char::is_alphanumeric) =>
            {
                found.extend(paths(tree.trim_end_matches(';')));
                rest += before;
            }
            _ => rest += statement,
        }
    }
    for start in ["super::", "crate::", "self::"] {
        for (at, _) in rest.match_indices(start) {
            let is_path = |c: char| c.is_alphanumeric() || c == '_' || c == ':';
            if rest[..at].chars().next_back().is_some_and(is_path) {
                continue;
            }
            let end = rest[at..].find(|c| !is_path(c)).map_or(rest.len(), |length| at + length);
            found.extend(paths(&rest[at..end]));
        }
    }
    found
}

/// The file that a path named in `module` leads to.
fn target(module: &Module, path: &[String], all: &BTreeMap<Module, String>) -> Option<Module> {
    let ups = path.iter().take_while(|p| *p == "super").count();
    let mut place: Module = match path.first()?.as_str() {
        "crate" => path[1..].to_vec(),
        "self" => [module.as_slice(), &path[1..]].concat(),
        "super" => [&module[..module.len().checked_sub(ups)?], &path[ups..]].concat(),
        _ => [module.as_slice(), path].concat(),
    };
    while !all.contains_key(&place) {
        place.pop()?;
    }
    (place != *module).then_some(place)
}

type Arrows = BTreeMap<Module, BTreeSet<Module>>;

/// Arrows between the files of each room, folders being one file of the room above them.
fn rooms(all: &BTreeMap<Module, String>) -> BTreeMap<Module, Arrows> {
    let mut rooms: BTreeMap<Module, Arrows> = BTreeMap::new();
    for (module, code) in all {
        let targets = named(code).into_iter().filter_map(|path| target(module, &path, all));
        for other in targets.collect::<BTreeSet<_>>() {
            let shared = module.iter().zip(&other).take_while(|(a, b)| a == b).count();
            if shared > 0 && shared < module.len() && shared < other.len() {
                let arrows = rooms.entry(module[..shared].to_vec()).or_default();
                let [from, to] = [module, &other].map(|m| m[..=shared].to_vec());
                arrows.entry(from).or_default().insert(to);
            }
        }
    }
    rooms
}

/// The files that lie on a circle: those that lead back to themselves.
fn circling(arrows: &Arrows) -> Vec<String> {
    let reaches_itself = |start: &&Module| {
        let (mut seen, mut next) = (BTreeSet::new(), vec![*start]);
        while let Some(at) = next.pop() {
            for to in arrows.get(at).into_iter().flatten() {
                if to == *start {
                    return true;
                }
                if seen.insert(to) {
                    next.push(to);
                }
            }
        }
        false
    };
    arrows.keys().filter(reaches_itself).map(|module| module.join("::")).collect()
}

#[test]
fn no_file_leads_back_to_itself_through_its_room() {
    let all = modules();
    let rooms = rooms(&all);
    let arrows: usize = rooms.values().flat_map(BTreeMap::values).map(BTreeSet::len).sum();
    assert!(all.len() > 200 && arrows > 200, "only {arrows} arrows were seen: the scan is broken");
    let circles: Vec<String> = rooms.values().flat_map(circling).collect();
    assert!(circles.is_empty(), "files on a circle: {}", circles.join(", "));
}

#[test]
fn the_scan_sees_a_circle() {
    let module = |name: &str, code: &str| (vec!["room".to_string(), name.to_string()], code.into());
    let mut all: BTreeMap<Module, String> = BTreeMap::from([
        (vec!["room".to_string()], "mod a; mod b; pub use a::A;".to_string()),
        module("a", "use super::{b::{B, other}, c};\nstruct A;"),
        module("b", "fn f() -> u32 { super::c::g() }"),
        module("c", "pub use crate::room::b::B as Bee;"),
        module("d", "use super::a::A;"),
    ]);
    assert_eq!(rooms(&all).values().flat_map(circling).collect::<Vec<_>>(), ["room::b", "room::c"]);
    all.insert(vec!["room".into(), "c".into()], "use crate::other::X;".into());
    assert!(rooms(&all).values().all(|arrows| circling(arrows).is_empty()));
}
