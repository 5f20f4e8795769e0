//! Instances of one node's mesh (`EXT_mesh_gpu_instancing`): places of it, never copies.

use super::accessor::Source;
use super::document::File;
use glam::{DMat4, DQuat, DVec3};
use gnomon_core::{Error, Result};

/// Node from instance, for all instances of a node; `None` where it has no such extension.
pub(super) fn places(
    place: &str,
    node: &gltf::Node<'_>,
    file: &File<'_>,
) -> Result<Option<Vec<DMat4>>> {
    let Some(extension) = node.extension_value("EXT_mesh_gpu_instancing") else { return Ok(None) };
    let at = format!("{place}: nodes[{}].EXT_mesh_gpu_instancing", node.index());
    let accessor = |name: &str| {
        let index = extension.get("attributes")?.get(name)?.as_u64()?;
        file.document.accessors().nth(usize::try_from(index).ok()?)
    };
    let [moved, turned, scaled] = ["TRANSLATION", "ROTATION", "SCALE"].map(accessor);
    let count = [&moved, &turned, &scaled].into_iter().flatten().map(|a| a.count()).max();
    super::super::check_parts(&at, count.unwrap_or(0))?;
    let source = Source::all(&at, &file.buffers);
    let three = |accessor: Option<gltf::Accessor<'_>>, none: DVec3| match accessor {
        Some(accessor) => {
            let read = source.vectors::<3>("translations and scales", &accessor)?;
            Ok(read.into_iter().map(|v| DVec3::from_array(v.map(f64::from))).collect())
        }
        None => Ok(vec![none; count.unwrap_or(0)]),
    };
    let rotation = |v: [f32; 4]| DQuat::from_array(v.map(f64::from)).normalize();
    let rotations: Vec<DQuat> = match turned {
        Some(accessor) => {
            source.vectors("rotations", &accessor)?.into_iter().map(rotation).collect()
        }
        None => vec![DQuat::IDENTITY; count.unwrap_or(0)],
    };
    let (translations, scales): (Vec<DVec3>, Vec<DVec3>) =
        (three(moved, DVec3::ZERO)?, three(scaled, DVec3::ONE)?);
    let lengths = [translations.len(), rotations.len(), scales.len()];
    if lengths.iter().any(|&n| Some(n) != count) {
        let reason = format!("has {lengths:?} translations, rotations and scales");
        return Err(Error::bad_input(at, reason, super::accessor::AGAIN));
    }
    let parts = translations.into_iter().zip(rotations).zip(scales);
    let place = |((t, r), s)| DMat4::from_scale_rotation_translation(s, r, t);
    Ok(Some(parts.map(place).collect()))
}
