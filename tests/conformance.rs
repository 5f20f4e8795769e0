//! The subject against what a real WebGL wrote: nothing differs, and nothing can hide.

#[path = "support/dumps_folder.rs"]
mod dumps_folder;

use dumps_folder::{Subset, whole_dumps};
use gnomon::conformance::{compare, scene_json};
use gnomon::device::{Device, DeviceProfile};
use gnomon::scene::cases;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

fn webgl() -> Device {
    DeviceProfile::WebglSwiftshader.device()
}

fn run(arguments: &[&str]) -> (i32, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_gnomon-conformance"))
        .args(arguments)
        .output()
        .expect("the binary runs");
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    (output.status.code().unwrap_or(-1), text)
}

#[test]
fn nothing_differs_from_the_committed_dumps() {
    let subset = Subset::unpack();
    let outcome = compare(subset.path(), &webgl()).expect("a sound folder");
    let differing: Vec<_> = outcome.entries.iter().filter(|e| e.differing > 0).collect();
    assert!(differing.is_empty(), "{differing:#?}");
    assert!(outcome.compared("") > 20_000_000, "only {} compared", outcome.compared(""));
    for section in [
        "scenes/000_shadow_y7",
        "scenes/001_upc",
        "scenes/002_spot",
        "scenes/003_pcf",
        "raster",
        "polyoffset",
    ] {
        assert!(outcome.compared(section) > 0, "{section} compared nothing");
    }
}

#[test]
fn nothing_differs_from_the_whole_dumps() {
    let Some(folder) = whole_dumps("nothing_differs_from_the_whole_dumps") else { return };
    let outcome = compare(&folder, &webgl()).expect("a sound folder");
    let differing: Vec<_> = outcome.entries.iter().filter(|e| e.differing > 0).collect();
    assert!(differing.is_empty(), "{differing:#?}");
    for section in ["arith", "unorm", "encodings", "depth", "raster", "filter", "polyoffset"] {
        assert!(outcome.compared(section) > 0, "{section} compared nothing");
    }
    let (code, message) = run(&[folder.to_str().expect("a UTF-8 path"), "--allow-missing"]);
    assert_eq!(code, 0, "{message}");
}

/// Every file of the whole dumps, or of the subset, whose bytes are compared.
fn binary_files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("a folder").flatten() {
        let path = entry.path();
        if path.is_dir() {
            binary_files(&path, found);
        } else if path.extension().is_some_and(|e| e == "bin") {
            found.push(path);
        }
    }
}

#[test]
fn one_flipped_bit_of_each_file_is_seen() {
    let subset = Subset::unpack();
    let mut files = Vec::new();
    binary_files(subset.path(), &mut files);
    files.sort();
    // Of several scenes, one file of each kind suffices: the loop redraws the scene each time.
    files.retain(|f| !f.to_string_lossy().contains("001_upc"));
    // Vertices are inputs: a flipped bit of one may rightly change no pixel.
    files.retain(|f| !f.to_string_lossy().ends_with("_verts.bin"));
    assert!(files.len() >= 12, "{} files", files.len());
    let single = tempfile::tempdir().expect("a temporary folder");
    for file in files {
        let folder = file.parent().expect("a parent");
        let relative = folder.strip_prefix(subset.path()).expect("inside");
        let copy = single.path().join("dumps");
        let target = copy.join(relative);
        fs::create_dir_all(&target).expect("a folder");
        for entry in fs::read_dir(folder).expect("a folder").flatten() {
            fs::copy(entry.path(), target.join(entry.file_name())).expect("a copy");
        }
        let victim = target.join(file.file_name().expect("a name"));
        let mut bytes = fs::read(&victim).expect("the copy");
        let at = bytes.len() / 2 / 4 * 4;
        bytes[at] ^= 1;
        fs::write(&victim, bytes).expect("the copy changed");
        let outcome = compare(&copy, &webgl()).expect("a sound folder");
        assert!(outcome.differing("") > 0, "a flip in {} went unseen", file.display());
        fs::remove_dir_all(&copy).expect("the copy goes");
    }
}

#[test]
fn exit_codes_tell_difference_from_absence() {
    let subset = Subset::unpack();
    let folder = subset.path().to_str().expect("a UTF-8 path");
    assert_eq!(run(&[folder]).0, 2, "listed files are missing");
    assert_eq!(run(&[folder, "--allow-missing"]).0, 0, "and may be");
    let victim = subset.path().join("scenes/000_shadow_y7/vis_nearest_b0.bin");
    let mut bytes = fs::read(&victim).expect("the dump");
    bytes[80_200] ^= 0xff;
    fs::write(&victim, &bytes).expect("the dump changed");
    let (code, message) = run(&[folder, "--allow-missing"]);
    assert_eq!(code, 1, "{message}");
    assert!(message.contains("vis_nearest_b0.bin") && message.contains("expected"), "{message}");
    fs::write(&victim, &bytes[..100]).expect("the dump cut");
    let (code, message) = run(&[folder, "--allow-missing"]);
    assert_eq!(code, 2, "{message}");
    assert!(message.contains("vis_nearest_b0.bin") && message.contains("100 bytes"), "{message}");
}

#[test]
fn a_malformed_scene_is_one_sentence() {
    let subset = Subset::unpack();
    let scene = subset.path().join("scenes/002_spot/scene.json");
    let text = fs::read_to_string(&scene).expect("the scene");
    let cases = [
        (text.replacen("\"near\": 0.5", "\"near\": 50", 1), "light.near"),
        (text.replacen("\"mapSize\": 512", "\"mapSize\": -1", 1), "mapSize"),
        (text[..text.len() / 2].to_string(), "scene.json"),
        (text.replacen("\"far\": 10", "\"far\": \"NaN\"", 1), "light.far"),
    ];
    for (broken, word) in cases {
        assert_ne!(broken, text, "the edit for {word} changed nothing");
        fs::write(&scene, broken).expect("the scene changed");
        let folder = subset.path().to_str().expect("a UTF-8 path");
        let (code, message) = run(&[folder, "--allow-missing"]);
        assert_eq!(code, 2, "{message}");
        assert_eq!(message.trim_end().lines().count(), 1, "{message}");
        assert!(message.contains("scene.json") && message.contains(word), "{message} lacks {word}");
    }
}

/// The case built in code for a scene of the dumps.
const BUILT: [(&str, &str); 13] = [
    ("000_shadow_y7", "book-r8-y7"),
    ("000_shadow_y7_slant", "book-r8-y7-slant"),
    ("000_shadow_y40", "book-r8-y40"),
    ("000_shadow_y40_slant", "book-r8-y40-slant"),
    ("000_highp_y7", "book-rgba8-y7"),
    ("000_highp_y7_slant", "book-rgba8-y7-slant"),
    ("000_highp_y40", "book-rgba8-y40"),
    ("000_highp_y40_slant", "book-rgba8-y40-slant"),
    ("004", "runnable-rgba8"),
    ("001_upc", "upc"),
    ("002_spot", "fundamentals-spot"),
    ("002_directional", "fundamentals-directional"),
    ("003_pcf", "exam-pcf"),
];

#[test]
fn cases_built_in_code_equal_the_dumped_scenes_bit_for_bit() {
    let subset = Subset::unpack();
    for (scene, name) in BUILT {
        let path = subset.path().join("scenes").join(scene).join("scene.json");
        let dumped = scene_json::read(&path).expect("a sound scene").case;
        let built = cases::named(name).expect("a named case");
        assert_eq!(built.objects.len(), dumped.objects.len(), "{name}");
        for (b, d) in built.objects.iter().zip(&dumped.objects) {
            let bits = |v: &[glam::Vec3]| {
                v.iter().flat_map(|p| p.to_array()).map(|x| (x + 0.0).to_bits()).collect::<Vec<_>>()
            };
            assert_eq!(bits(&b.mesh.positions), bits(&d.mesh.positions), "{name} {}", b.name);
            assert_eq!(b.mesh.triangles, d.mesh.triangles, "{name} {}", b.name);
            let matrix = |m: &glam::Mat4| m.to_cols_array().map(|x| (x + 0.0).to_bits());
            assert_eq!(matrix(&b.model), matrix(&d.model), "{name} {} model", b.name);
            // The light of each is one map; the dump's matrices are those that the file gives.
            let named = |case: &gnomon::scene::Case, object: &gnomon::scene::Object| {
                let maps = case.light.maps().iter();
                maps.flat_map(|map| object.matrices(case.chain, map, &case.camera).named())
                    .collect::<Vec<_>>()
            };
            let (built_matrices, dumped_matrices) = (named(&built, b), named(&dumped, d));
            assert_eq!(built_matrices.len(), dumped_matrices.len(), "{name} {}", b.name);
            for ((key, m), (dumped_key, n)) in built_matrices.iter().zip(&dumped_matrices) {
                assert_eq!((key, matrix(m)), (dumped_key, matrix(n)), "{name} {}", b.name);
            }
        }
        assert_eq!(built.map, dumped.map, "{name}");
        assert_eq!(built.lookup, dumped.lookup, "{name}");
        assert_eq!(built.chain, dumped.chain, "{name}");
        assert_eq!(built.canvas, dumped.canvas, "{name}");
        assert_eq!(built.bias.to_bits(), dumped.bias.to_bits(), "{name}");
        assert_eq!(built.camera_cull, dumped.camera_cull, "{name}");
        assert_eq!(built.light.maps(), dumped.light.maps(), "{name}");
    }
}
