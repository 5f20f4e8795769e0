//! Every reader of untrusted bytes as one function each: for the fuzz targets and for the replay.

use gnomon::conformance::{device_json, scene_json};
use gnomon::depth::packing::TextPair;
use gnomon::load::Limits;
use gnomon::load::config::Settings;
use gnomon::load::fit;
use gnomon::output::Manifest;
use gnomon::output::journal::Contents;
use gnomon::scene_file::parse;
use std::path::Path;

/// Name of the corpus folder and of the fuzz target, and the reader.
pub type Reader = (&'static str, fn(&[u8]));

pub const READERS: [Reader; 10] = [
    ("gltf_json", gltf_json),
    ("glb", glb),
    ("obj", obj),
    ("ply", ply),
    ("scene_toml", scene_toml),
    ("packing_toml", packing_toml),
    ("manifest", manifest),
    ("journal", journal),
    ("device_json", device_json_file),
    ("scene_json", scene_json_file),
];

/// A refusal is one sentence for the user's eyes.
fn refused(error: &gnomon::Error) {
    let text = error.to_string();
    assert!(error.exit_code() == 2 && !text.contains('\n'), "not one sentence: {text}");
}

fn scene(name: &str, bytes: &[u8]) {
    for lenient in [false, true] {
        match parse(Path::new(name), bytes, &Limits { lenient, ..Limits::default() }) {
            Ok(scene) => {
                // What was read can be fitted, or refused in a sentence too.
                let fitted = fit::case("fuzz", scene, &Settings::default());
                let _ = fitted.map_err(|e| refused(&e));
                return;
            }
            Err(error) => refused(&error),
        }
    }
}

pub fn gltf_json(bytes: &[u8]) {
    scene("absent/fuzz.gltf", bytes);
}

pub fn glb(bytes: &[u8]) {
    scene("absent/fuzz.glb", bytes);
}

pub fn obj(bytes: &[u8]) {
    scene("absent/fuzz.obj", bytes);
}

pub fn ply(bytes: &[u8]) {
    scene("absent/fuzz.ply", bytes);
}

pub fn scene_toml(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    match Settings::parse("fuzz.toml", text) {
        Ok(settings) => {
            let _ = settings.map.size;
            let _ = settings.texel().map_err(|e| refused(&e));
            let _ = settings.choices().map_err(|e| refused(&e));
        }
        Err(error) => refused(&error),
    }
}

pub fn packing_toml(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    let _ = TextPair::from_toml("fuzz.toml", text).map_err(|e| refused(&e));
}

pub fn manifest(bytes: &[u8]) {
    match Manifest::parse("manifest.json", bytes) {
        Ok(manifest) => {
            let again = Manifest::parse("again", &manifest.to_file().bytes);
            assert_eq!(again.expect("what was written is read"), manifest);
        }
        Err(error) => refused(&error),
    }
}

pub fn journal(bytes: &[u8]) {
    match Contents::parse("journal", bytes) {
        Ok(contents) => {
            let again = Contents::parse("journal", &bytes[..contents.sound]);
            assert_eq!(again.expect("sound records are read again"), contents);
        }
        Err(error) => refused(&error),
    }
}

pub fn device_json_file(bytes: &[u8]) {
    match device_json::parse(Path::new("gpu.json"), bytes) {
        Ok(device) => {
            let _ = (device.nearest(), device.notes(), device.to_json());
        }
        Err(error) => refused(&error),
    }
}

pub fn scene_json_file(bytes: &[u8]) {
    let _ = scene_json::parse(Path::new("scene.json"), bytes).map_err(|e| refused(&e));
}
