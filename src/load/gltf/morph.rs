//! Morph targets: what is added to a primitive's positions and normals, by weights.

use super::accessor::Source;
use glam::DVec3;
use gnomon_core::Result;

/// Adds weight · target to positions and normals (where there are some), for every target with a weight.
pub(super) fn add(
    source: &Source<'_>,
    primitive: &gltf::Primitive<'_>,
    weights: &[f64],
    positions: &mut [DVec3],
    normals: &mut [DVec3],
) -> Result<()> {
    for (target, &weight) in primitive.morph_targets().zip(weights).filter(|(_, w)| **w != 0.0) {
        let given = [target.positions(), target.normals()];
        let mut deltas = [Vec::new(), Vec::new()];
        for (deltas, accessor) in deltas.iter_mut().zip(given) {
            if let Some(accessor) = accessor {
                *deltas = source.vectors::<3>("the numbers of a morph target", &accessor)?;
            }
        }
        let [moves, turns] = deltas;
        for (to, deltas) in [(&mut *positions, moves), (&mut *normals, turns)] {
            for (to, delta) in to.iter_mut().zip(deltas) {
                *to += weight * DVec3::from_array(delta.map(f64::from));
            }
        }
    }
    Ok(())
}
