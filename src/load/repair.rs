//! Meshes as files give them: refused where they are damaged, or leniently rid of what is.

use super::files::Budget;
use glam::{DVec3, Vec3};
use gnomon_core::scene::Mesh;
use gnomon_core::{Error, Result};

/// Whether a position can be worked with: a number within 10³⁰.
pub(super) fn is_sound(p: Vec3) -> bool {
    p.is_finite() && p.abs().max_element() <= 1e30
}

/// The mesh of a file's positions and indices. What is damaged is refused, the first by its number; a
/// lenient budget leaves damaged triangles out and notes how many.
pub(super) fn mesh(
    place: &str,
    (mut positions, indices): (Vec<Vec3>, Vec<u32>),
    colour: Vec3,
    budget: &Budget<'_>,
    notes: &mut Vec<String>,
) -> Result<Mesh> {
    if !budget.is_lenient() {
        check(place, &positions, &indices)?;
    }
    let position = |i: &u32| positions.get(*i as usize).copied().filter(|&p| is_sound(p));
    let (triples, rest) = indices.as_chunks::<3>();
    let triangles: Vec<[u32; 3]> =
        triples.iter().copied().filter(|t| t.iter().all(|i| position(i).is_some())).collect();
    let (lost, all) = (triples.len() - triangles.len(), triples.len());
    if lost > 0 || !rest.is_empty() {
        let over = match rest.len() {
            0 => String::new(),
            rest => format!(", {rest} indices over"),
        };
        notes.push(format!("{place}: {lost} of {all} triangles are damaged and left out{over}"));
    }
    // No triangle names the damaged ones any more; bounds are taken over all.
    let anchor = triangles.iter().flatten().find_map(position).unwrap_or_default();
    positions.iter_mut().filter(|p| !is_sound(**p)).for_each(|p| *p = anchor);
    Ok(Mesh::new(positions, triangles, colour))
}

/// Gives a mesh the numbers that its positions are rounded from, where they say more, and its normals,
/// where it has one for each vertex.
pub(super) fn complete(mesh: &mut Mesh, exact: Vec<DVec3>, normals: Vec<Vec3>) {
    if mesh.positions.iter().zip(&exact).any(|(p, exact)| p.as_dvec3() != *exact) {
        let mended = |(exact, p): (DVec3, &Vec3)| match exact.as_vec3() == *p {
            true => exact,
            false => p.as_dvec3(),
        };
        mesh.exact = exact.into_iter().zip(&mesh.positions).map(mended).collect();
    }
    mesh.smooth = !normals.is_empty();
    mesh.normals = normals.into_iter().map(sound_normal).collect();
}

/// A normal that can be worked with: none where it is not finite.
fn sound_normal(normal: Vec3) -> Vec3 {
    if normal.is_finite() { normal } else { Vec3::ZERO }
}

fn check(place: &str, positions: &[Vec3], indices: &[u32]) -> Result<()> {
    let bad =
        |reason: String| Err(Error::bad_input(place, reason, "repair the mesh, or take --lenient"));
    if !indices.len().is_multiple_of(3) {
        return bad(format!("has {} indices, no multiple of 3", indices.len()));
    }
    if let Some((i, p)) = positions.iter().enumerate().find(|(_, p)| !is_sound(**p)) {
        return bad(format!("vertex {i} is {p}, not a number within 1e30"));
    }
    check_indices(place, indices, positions.len())
}

/// Refuses an index that names no vertex of `count`.
pub(super) fn check_indices(place: &str, indices: &[u32], count: usize) -> Result<()> {
    match indices.iter().enumerate().find(|(_, i)| **i as usize >= count) {
        Some((at, index)) => {
            let reason = format!("index {at} is {index}, but there are {count} vertices");
            Err(Error::bad_input(place, reason, "repair the mesh, or take --lenient"))
        }
        None => Ok(()),
    }
}
