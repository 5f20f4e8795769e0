//! The node tree: transforms in f64, where each node stands in the world, which are drawn.

use glam::{DMat4, DQuat, DVec3};
use serde::Deserialize;

/// The transform of a node in its parent, as the file has it or an animation sets it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Placed {
    /// A matrix.
    Matrix(DMat4),
    /// Scale first, then rotation, then translation.
    Parts {
        /// Metres.
        translation: DVec3,
        /// Near unit length.
        rotation: DQuat,
        /// Along the node's own axes.
        scale: DVec3,
    },
}

impl Placed {
    /// Parent from node.
    pub(super) fn matrix(&self) -> DMat4 {
        match *self {
            Self::Matrix(matrix) => matrix,
            Self::Parts { translation, rotation, scale } => {
                DMat4::from_scale_rotation_translation(scale, rotation, translation)
            }
        }
    }

    /// Whether its rotation is no quaternion at all.
    pub(super) fn is_unturned(&self) -> bool {
        matches!(self, Self::Parts { rotation, .. } if rotation.length_squared() == 0.0)
    }
}

#[derive(Deserialize)]
struct Root {
    #[serde(default)]
    nodes: Vec<Raw>,
}

/// A node as the JSON has it; the rest of it is read by the library.
#[derive(Deserialize)]
struct Raw {
    matrix: Option<[f64; 16]>,
    translation: Option<[f64; 3]>,
    rotation: Option<[f64; 4]>,
    scale: Option<[f64; 3]>,
}

/// The transforms of all nodes of a JSON, with the digits that it has: three.js reads them in f64 too.
pub(super) fn placed(json: &[u8]) -> std::result::Result<Vec<Placed>, serde_json::Error> {
    let root: Root = serde_json::from_slice(json)?;
    let placed = |raw: Raw| match raw.matrix {
        Some(matrix) => Placed::Matrix(DMat4::from_cols_array(&matrix)),
        None => Placed::Parts {
            translation: raw.translation.map_or(DVec3::ZERO, DVec3::from_array),
            rotation: raw.rotation.map_or(DQuat::IDENTITY, DQuat::from_array),
            scale: raw.scale.map_or(DVec3::ONE, DVec3::from_array),
        },
    };
    Ok(root.nodes.into_iter().map(placed).collect())
}

/// World from node for all nodes, whatever scene they are in: joints may stand outside of the one that is
/// drawn. Parents that go in a circle begin anywhere on it; a walk refuses them where they matter.
pub(super) fn worlds(document: &gltf::Document, placed: &[Placed]) -> Vec<DMat4> {
    let mut parents = vec![None; placed.len()];
    for node in document.nodes() {
        for child in node.children() {
            if let Some(parent) = parents.get_mut(child.index()) {
                *parent = Some(node.index());
            }
        }
    }
    let mut worlds: Vec<Option<DMat4>> = vec![None; placed.len()];
    let (mut seen, mut path) = (vec![false; placed.len()], Vec::new());
    for start in 0..placed.len() {
        let mut at = Some(start);
        while let Some((i, seen)) = at.and_then(|i| Some((i, seen.get_mut(i)?))) {
            if std::mem::replace(seen, true) {
                break;
            }
            path.push(i);
            at = parents.get(i).copied().flatten();
        }
        let above = at.and_then(|i| worlds.get(i).copied().flatten());
        let mut world = above.unwrap_or(DMat4::IDENTITY);
        for i in path.drain(..).rev() {
            world *= placed.get(i).map_or(DMat4::IDENTITY, Placed::matrix);
            worlds.get_mut(i).into_iter().for_each(|w| *w = Some(world));
        }
    }
    worlds.into_iter().map(Option::unwrap_or_default).collect()
}

/// Whether a node is scaled to a line or a point, which is how exporters hide things.
pub(super) fn draws_nothing(world: DMat4) -> bool {
    let [x, y, z] = [world.x_axis, world.y_axis, world.z_axis].map(|axis| axis.truncate());
    let flat = [x.cross(y), y.cross(z), z.cross(x)];
    let scaled = [x, y, z].iter().filter(|axis| **axis == DVec3::ZERO).count() >= 2;
    scaled && world.is_finite() && flat.iter().all(|normal| *normal == DVec3::ZERO)
}

/// Whether a node says that it and what hangs on it is not shown (`KHR_node_visibility`).
pub(super) fn is_hidden(node: &gltf::Node<'_>) -> bool {
    let says = |extension: &serde_json::Value| extension.get("visible")?.as_bool();
    node.extension_value("KHR_node_visibility").and_then(says) == Some(false)
}
