//! What the project is built from: licences, banned crates, the size of the core's tree.

use serde_json::Value;
use std::collections::BTreeSet;
use std::process::Command;

fn rules() -> toml::Table {
    include_str!("fixtures/supply.toml").parse().expect("the committed list is TOML")
}

fn cargo() -> String {
    std::env::var("CARGO").unwrap_or_else(|_| "cargo".to_string())
}

/// `cargo metadata` of the locked workspace for the platform that runs the test.
fn metadata() -> Value {
    let host = Command::new("rustc").arg("-vV").output().expect("rustc runs");
    let host = String::from_utf8(host.stdout).unwrap();
    let host = host.lines().find_map(|l| l.strip_prefix("host: ")).expect("rustc names its host");
    let out = Command::new(cargo())
        .args(["metadata", "--format-version", "1", "--locked", "--offline", "--filter-platform"])
        .arg(host)
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .expect("cargo runs");
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    serde_json::from_slice(&out.stdout).expect("cargo writes JSON")
}

fn packages(metadata: &Value) -> Vec<(&str, &str)> {
    let all = metadata["packages"].as_array().unwrap();
    all.iter()
        .map(|p| (p["name"].as_str().unwrap(), p["license"].as_str().unwrap_or("no licence")))
        .collect()
}

/// Whether an SPDX expression (or the older `A/B`) can be met by allowed terms alone.
fn allowed(expression: &str, terms: &BTreeSet<&str>) -> bool {
    let expression = expression.replace('/', " OR ");
    let all_of = |part: &str| {
        part.trim_matches(['(', ')', ' ']).split(" AND ").all(|t| terms.contains(t.trim()))
    };
    // Parentheses stand round an OR under an AND: each side of the AND is met on its own.
    if expression.contains('(') {
        return expression.split(" AND ").all(|side| allowed(side.trim_matches(['(', ')']), terms));
    }
    expression.split(" OR ").any(all_of)
}

#[test]
fn every_licence_is_one_that_was_agreed_to() {
    let (rules, metadata) = (rules(), metadata());
    let terms: BTreeSet<&str> =
        rules["licences"].as_array().unwrap().iter().map(|l| l.as_str().unwrap()).collect();
    let packages = packages(&metadata);
    assert!(packages.len() > 50, "only {} packages were seen", packages.len());
    for (name, licence) in packages {
        assert!(allowed(licence, &terms), "{name} is under '{licence}'");
    }
    assert!(!allowed("GPL-3.0-only", &terms) && !allowed("MIT AND GPL-2.0", &terms));
    assert!(allowed("(MIT OR GPL-2.0) AND Unicode-3.0", &terms));
}

#[test]
fn no_banned_crate_comes_in_and_no_exception_is_stale() {
    let (rules, metadata) = (rules(), metadata());
    let names: BTreeSet<&str> = packages(&metadata).into_iter().map(|(name, _)| name).collect();
    for (name, reason) in rules["banned"].as_table().unwrap() {
        assert!(!names.contains(name.as_str()), "{name} is banned: {reason}");
    }
    for name in rules["unmaintained"].as_table().unwrap().keys() {
        assert!(names.contains(name.as_str()), "{name} is gone: take it off the list");
    }
}

#[test]
fn the_core_stays_small_to_depend_on() {
    let most = rules()["core_crates"].as_integer().unwrap() as usize;
    // Resolved alone, so that no other package's features count.
    let arguments = ["tree", "-p", "gnomon-core", "-e", "normal", "--prefix", "none"];
    let out = Command::new(cargo())
        .args(arguments)
        .args(["--locked", "--offline", "--format", "{p}"])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .expect("cargo runs");
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    let text = String::from_utf8(out.stdout).unwrap();
    let tree: BTreeSet<&str> = text.lines().filter_map(|l| l.split(' ').next()).collect();
    assert!(tree.len() > 10, "only {} crates were seen", tree.len());
    assert!(tree.len() <= most, "{} crates, at most {most}: {tree:#?}", tree.len());
}

#[test]
fn packages_say_what_a_registry_shows() {
    let metadata = metadata();
    let members = metadata["workspace_members"].as_array().unwrap();
    assert!(members.len() >= 4, "{members:?}");
    let all = metadata["packages"].as_array().unwrap();
    for package in all.iter().filter(|p| members.contains(&p["id"])) {
        let name = package["name"].as_str().unwrap();
        for field in ["description", "license", "rust_version"] {
            assert!(package[field].is_string(), "{name} has no {field}");
        }
        for field in ["keywords", "categories"] {
            assert!(!package[field].as_array().unwrap().is_empty(), "{name} has no {field}");
        }
    }
}
