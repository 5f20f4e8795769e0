//! Skins: vertices moved by joints, wherever the skinned node itself stands (glTF 2.0, 3.7.3.3).

use super::accessor::{AGAIN, Source};
use super::document::File;
use glam::{DMat4, DVec3};
use gnomon_core::{Error, Result};

/// World from bind pose for each joint of a skin, in f64.
pub(super) fn matrices(
    place: &str,
    skin: &gltf::Skin<'_>,
    file: &File<'_>,
    worlds: &[DMat4],
) -> Result<Vec<DMat4>> {
    let at = format!("{place}: skins[{}].inverseBindMatrices", skin.index());
    let joints = skin.joints().map(|joint| worlds.get(joint.index()).copied().unwrap_or_default());
    let Some(accessor) = skin.inverse_bind_matrices() else { return Ok(joints.collect()) };
    let binds = Source::all(&at, &file.buffers).vectors::<16>("matrices", &accessor)?;
    let joints: Vec<DMat4> = joints.collect();
    if binds.len() < joints.len() {
        let reason = format!("has {} matrices for {} joints", binds.len(), joints.len());
        return Err(Error::bad_input(at, reason, AGAIN));
    }
    let bind = |bind: [f32; 16]| DMat4::from_cols_array(&bind.map(f64::from));
    Ok(joints.into_iter().zip(binds).map(|(joint, b)| joint * bind(b)).collect())
}

/// Joints and weights of every vertex: four a set, as many sets as the primitive has.
struct Influences(Vec<Influence>);

/// Joints of all vertices and their weights: one set of four.
type Influence = (Vec<[u32; 4]>, Vec<[f32; 4]>);

fn influences(source: &Source<'_>, primitive: &gltf::Primitive<'_>) -> Result<Influences> {
    let mut sets = Vec::new();
    for set in 0.. {
        let joints = primitive.get(&gltf::Semantic::Joints(set));
        let weights = primitive.get(&gltf::Semantic::Weights(set));
        let Some((joints, weights)) = joints.zip(weights) else { break };
        sets.push((source.integers("joints", &joints)?, source.vectors("weights", &weights)?));
    }
    Ok(Influences(sets))
}

impl Influences {
    fn of(&self, vertex: usize) -> impl Iterator<Item = (u32, f64)> {
        let of_set = move |(joints, weights): &Influence| {
            let (joints, weights) = (joints.get(vertex).copied()?, weights.get(vertex).copied()?);
            Some(joints.into_iter().zip(weights.map(f64::from)))
        };
        self.0.iter().filter_map(of_set).flatten()
    }

    /// The mean of a vertex's joints by its weights, which need not add up to one; where all are zero,
    /// its first joint, as three.js has it. `Err` names a joint that is not there.
    fn matrix(&self, vertex: usize, joints: &[DMat4]) -> std::result::Result<DMat4, u32> {
        let joint = |j: u32| joints.get(j as usize).copied().ok_or(j);
        let (mut sum, mut total) = (DMat4::ZERO, 0.0);
        for (j, weight) in self.of(vertex).filter(|(_, weight)| *weight != 0.0) {
            sum += joint(j)? * weight;
            total += weight;
        }
        match total {
            0.0 => joint(self.of(vertex).next().map_or(0, |(j, _)| j)),
            _ => Ok(sum * (1.0 / total)),
        }
    }
}

/// Moves positions and normals into the world. A normal is turned by the same matrix, as engines do it,
/// not by its inverse transpose.
pub(super) fn deform(
    source: &Source<'_>,
    primitive: &gltf::Primitive<'_>,
    joints: &[DMat4],
    positions: &mut [DVec3],
    normals: &mut [DVec3],
) -> Result<()> {
    let influences = influences(source, primitive)?;
    if influences.0.is_empty() {
        return Err(Error::bad_input(source.place, "has a skin, but no joints and weights", AGAIN));
    }
    for (vertex, position) in positions.iter_mut().enumerate() {
        let matrix = influences.matrix(vertex, joints).map_err(|joint| {
            let reason = format!("vertex {vertex} names joint {joint} of {}", joints.len());
            Error::bad_input(source.place, reason, AGAIN)
        })?;
        *position = matrix.transform_point3(*position);
        if let Some(normal) = normals.get_mut(vertex) {
            *normal = matrix.transform_vector3(*normal);
        }
    }
    Ok(())
}
