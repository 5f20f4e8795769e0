//! Wavefront OBJ: positions and faces only; material files are never opened.

use super::files::Budget;
use super::{LoadedScene, repair};
use glam::{Mat4, Vec3};
use gnomon_core::{Error, Result};
use std::path::Path;

pub(super) fn read(path: &Path, bytes: &[u8], mut budget: Budget) -> Result<LoadedScene> {
    let place = path.display().to_string();
    let options = tobj::LoadOptions { triangulate: true, single_index: true, ..Default::default() };
    let (models, _) = tobj::load_obj_buf(&mut geometry(bytes).as_slice(), &options, |_| {
        Ok((Vec::new(), Default::default()))
    })
    .map_err(|e| Error::bad_input(&place, format!("is no usable OBJ ({e})"), "repair the file"))?;
    let mut scene = LoadedScene::default();
    for (i, model) in models.into_iter().enumerate() {
        let at = format!("{place}: object {i} '{}'", model.name);
        let mesh = model.mesh;
        budget.vertices(&at, mesh.positions.len() as u64 / 3)?;
        budget.indices(&at, mesh.indices.len() as u64)?;
        if mesh.indices.is_empty() {
            continue;
        }
        let positions = mesh.positions.chunks_exact(3).map(Vec3::from_slice).collect();
        let given = (positions, mesh.indices);
        let mesh = repair::mesh(&at, given, Vec3::splat(0.8), &budget, &mut scene.notes)?;
        scene.parts.push((format!("{}#{i}", model.name), mesh, Mat4::IDENTITY));
    }
    Ok(scene)
}

/// The file without texture coordinates and normals, which are not needed: tobj 4.0 computes with their
/// indices before it checks them (found by fuzzing).
fn geometry(bytes: &[u8]) -> Vec<u8> {
    let mut kept = Vec::with_capacity(bytes.len());
    for line in bytes.split(|&b| b == b'\n') {
        let mut words = line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
        match words.next() {
            Some(b"vt" | b"vn") => {}
            Some(element @ (b"f" | b"l" | b"p")) => {
                kept.extend(element);
                for word in words {
                    let vertex = word.split(|&b| b == b'/').next().filter(|v| !v.is_empty());
                    // Index 0 is none: an element without a vertex stays an error.
                    kept.extend([b" ", vertex.unwrap_or(b"0")].concat());
                }
            }
            _ => kept.extend(line),
        }
        kept.push(b'\n');
    }
    kept
}
