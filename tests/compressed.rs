//! Compressed glTF against the same files as independent decoders have them: Draco's own and meshoptimizer's.

use gnomon::load::{Limits, LoadedScene};
use gnomon::scene_file::{load, parse};
use serde_json::Value;
use std::path::{Path, PathBuf};

fn fixture(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures/compressed").join(name)
}

fn sound(name: &str) -> LoadedScene {
    load(&fixture(name), &Limits::default()).unwrap_or_else(|e| panic!("{e}"))
}

#[test]
fn draco_gives_what_its_own_decoder_gives() {
    for method in ["edgebreaker", "sequential", "valence"] {
        let (ours, theirs) =
            (sound(&format!("draco-{method}.glb")), sound(&format!("draco-{method}-plain.glb")));
        let mesh = &ours.parts[0].mesh;
        assert_eq!((mesh.triangles.len(), mesh.positions.len()), (98, 64), "{method}");
        assert_eq!(mesh.normals.len(), 64, "{method}");
        assert_eq!(ours.parts, theirs.parts, "{method}");
    }
}

#[test]
fn meshopt_gives_what_its_own_decoder_gives() {
    let (ours, theirs) = (sound("meshopt.gltf"), sound("meshopt-plain.gltf"));
    // Six primitives (every codec in both versions) on two nodes of sixteen instances each.
    assert_eq!(ours.parts.len(), 6 * 32);
    for (a, b) in ours.parts.iter().zip(&theirs.parts) {
        assert_eq!(a.mesh, b.mesh, "{}", a.name);
        assert_eq!(a.model, b.model, "{}", a.name);
    }
    assert_eq!(ours.parts.len(), theirs.parts.len());
}

/// Every byte of every compressed stream, changed: refused or read, never a panic.
#[test]
fn damaged_streams_are_refused_in_one_sentence() {
    let refused = |name: &str, bytes: &[u8]| match parse(Path::new(name), bytes, &Limits::default())
    {
        Ok(_) => 0,
        Err(error) => {
            let text = error.to_string();
            assert!(!text.contains('\n') && text.len() < 500, "{text}");
            1
        }
    };
    let draco = std::fs::read(fixture("draco-edgebreaker.glb")).unwrap();
    let end = draco.len();
    let count: usize = (end - 500..end)
        .map(|at| {
            let mut broken = draco.clone();
            broken[at] ^= 0x55;
            refused("a.glb", &broken)
        })
        .sum();
    assert!(count > 50, "{count} of 500 changes are refused");
    let text = std::fs::read_to_string(fixture("meshopt.gltf")).unwrap();
    let json: Value = serde_json::from_str(&text).unwrap();
    let uri = json["buffers"][0]["uri"].as_str().unwrap();
    let start = uri.find(',').unwrap() + 1;
    let count: usize = (start..uri.len())
        .step_by(7)
        .map(|at| {
            let mut broken = uri.as_bytes().to_vec();
            broken[at] = if broken[at] == b'A' { b'w' } else { b'A' };
            let mut json = json.clone();
            json["buffers"][0]["uri"] = Value::from(String::from_utf8(broken).unwrap());
            refused("a.gltf", json.to_string().as_bytes())
        })
        .sum();
    assert!(count > 50, "{count} changes are refused");
    let mut short = json.clone();
    short["bufferViews"][0]["extensions"]["EXT_meshopt_compression"]["byteLength"] = 40.into();
    let error = parse(Path::new("a.gltf"), short.to_string().as_bytes(), &Limits::default());
    let error = error.expect_err("cut short").to_string();
    assert!(error.contains("bufferViews[0]") && error.contains("gltf-transform"), "{error}");
}
