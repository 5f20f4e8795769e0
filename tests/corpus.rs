//! Every scene file of a folder, read: no panic, what is refused and skipped, triangles and bounds as JSON.

use glam::{DVec3, Vec3};
use gnomon::load::{Limits, LoadedScene};
use gnomon::scene_file::load;
use serde_json::json;
use std::path::{Path, PathBuf};

fn scenes(folder: &Path, found: &mut Vec<PathBuf>) {
    let Ok(entries) = std::fs::read_dir(folder) else { return };
    for path in entries.flatten().map(|entry| entry.path()) {
        let extension = path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase);
        match extension.as_deref() {
            _ if path.is_dir() => scenes(&path, found),
            Some("gltf" | "glb" | "obj" | "ply" | "stl") => found.push(path),
            _ => {}
        }
    }
}

/// Bounds in the world over the vertices that triangles name.
fn bounds(scene: &LoadedScene) -> [[f64; 3]; 2] {
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for part in &scene.parts {
        let world = |p: &Vec3| part.model.transform_point3(p.as_dvec3());
        for p in
            part.mesh.triangles.iter().flatten().map(|&i| world(&part.mesh.positions[i as usize]))
        {
            (low, high) = (low.min(p), high.max(p));
        }
    }
    [low.to_array(), high.to_array()]
}

#[test]
#[ignore = "soak: needs a folder of scenes in GNOMON_CORPUS"]
fn every_scene_of_a_folder_is_read_or_refused() {
    let Some(folder) = std::env::var_os("GNOMON_CORPUS").map(PathBuf::from) else {
        println!("SKIPPED: GNOMON_CORPUS names no folder");
        return;
    };
    let mut paths = Vec::new();
    scenes(&folder, &mut paths);
    paths.sort();
    let mut refused = 0;
    for path in &paths {
        let name = path.strip_prefix(&folder).unwrap().display().to_string();
        let start = std::time::Instant::now();
        let line = match load(path, &Limits::default()) {
            Ok(scene) => {
                let triangles: usize = scene.parts.iter().map(|p| p.mesh.triangles.len()).sum();
                json!({ "file": name, "parts": scene.parts.len(), "triangles": triangles,
                    "bounds": bounds(&scene), "skipped": scene.skipped, "notes": scene.notes,
                    "seconds": start.elapsed().as_secs_f64() })
            }
            Err(error) => {
                refused += 1;
                json!({ "file": name, "refused": error.to_string() })
            }
        };
        println!("{line}");
    }
    println!("{} files, {refused} refused", paths.len());
    assert!(!paths.is_empty(), "the folder holds no scene");
}
