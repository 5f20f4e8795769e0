//! A primitive of a mesh, in the pose that its node has, read once for all nodes that draw it so.

use super::super::{repair, strips};
use super::accessor::Source;
use super::material::{self, Look};
use super::{Reader, morph, skin};
use glam::{DVec3, Vec2, Vec3};
use gltf::Semantic;
use gltf::mesh::Mode;
use gnomon_core::Result;
use gnomon_core::scene::{Mesh, Surface};
use std::sync::Arc;

/// What makes two nodes draw the same shape: mesh, primitive, skin and the weights of its targets.
#[derive(PartialEq, Eq, Hash)]
pub(super) struct Key {
    mesh: usize,
    primitive: usize,
    skin: Option<usize>,
    weights: Vec<u64>,
}

/// Indices, where there are some, and the vertices that they name, where these are not all.
type Corners = (Option<Vec<u32>>, Option<Vec<u32>>);

/// Bytes that a vertex takes at most while it is read, and where it is posed, which is done in f64.
const VERTEX: u64 = 48;
const POSED: u64 = 160;

impl<'f> Reader<'f, '_> {
    /// The shape and surface of a primitive under a node; `None` where there is nothing to draw.
    pub(super) fn shape(
        &mut self,
        node: &gltf::Node<'f>,
        mesh: &gltf::Mesh<'f>,
        primitive: &gltf::Primitive<'f>,
        name: &str,
    ) -> Result<Option<(Arc<Mesh>, Surface)>> {
        let mode = primitive.mode();
        if !matches!(mode, Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan) {
            self.told.add("part", "of points or lines: left out", name);
            return Ok(None);
        }
        let mut look = self.look(primitive);
        let weights = self.weights_of(node, mesh, primitive);
        let key = Key {
            mesh: mesh.index(),
            primitive: primitive.index(),
            skin: node.skin().map(|skin| skin.index()),
            weights: weights.iter().map(|w| w.to_bits()).collect(),
        };
        let shape = match self.meshes.get(&key) {
            Some(known) => known.clone(),
            None => {
                let at = format!("meshes[{}].primitives[{}]", mesh.index(), primitive.index());
                let place = format!("{}: {at}", self.place);
                let read = self.read(&place, primitive, node.skin(), &weights, &look, name)?;
                let read = read.map(Arc::new);
                self.meshes.insert(key, read.clone());
                read
            }
        };
        if shape.is_some() {
            self.colour_alpha(primitive, &mut look);
            look.says.iter().for_each(|what| self.told.add("part", what.as_str(), name));
        }
        Ok(shape.map(|shape| (shape, look.surface)))
    }

    fn look(&mut self, primitive: &gltf::Primitive<'f>) -> Look {
        let material = primitive.material();
        if let Some(known) = self.materials.get(&material.index()) {
            return known.clone();
        }
        let look = material::look(&self.place, &material, self.file, &mut self.budget);
        self.materials.insert(material.index(), look.clone());
        look
    }

    /// Weights of the morph targets: an animation's, else the node's, else the mesh's, else none.
    pub(super) fn weights_of(
        &self,
        node: &gltf::Node<'f>,
        mesh: &gltf::Mesh<'f>,
        primitive: &gltf::Primitive<'f>,
    ) -> Vec<f64> {
        if primitive.morph_targets().next().is_none() {
            return Vec::new();
        }
        let of_file = node.weights().or(mesh.weights()).unwrap_or_default();
        let at_rest = || of_file.iter().copied().map(f64::from).collect();
        self.weights.get(&node.index()).cloned().unwrap_or_else(at_rest)
    }

    /// The alpha of vertex colours multiplies a mask's: exactly where it is one number for all.
    fn colour_alpha(&mut self, primitive: &gltf::Primitive<'f>, look: &mut Look) {
        let colours = primitive.get(&Semantic::Colors(0)).filter(|_| look.surface.mask.is_some());
        let colours = colours.filter(|c| c.dimensions().multiplicity() == 4);
        let read = |c| Source::all("", &self.file.buffers).vectors::<4>("colours", &c).ok();
        let Some(colours) = colours.and_then(read) else { return };
        match colours.split_first() {
            Some(([.., first], rest)) if rest.iter().all(|[.., a]| a == first) => {
                if *first != 1.0 {
                    look.with_alpha(*first);
                }
            }
            _ => {
                let what = "whose vertex colours vary in alpha: the mask is taken without them";
                look.says.push(what.into());
            }
        }
    }

    fn read(
        &mut self,
        place: &str,
        primitive: &gltf::Primitive<'f>,
        skin: Option<gltf::Skin<'f>>,
        weights: &[f64],
        look: &Look,
        name: &str,
    ) -> Result<Option<Mesh>> {
        let Some(accessor) = primitive.get(&Semantic::Positions) else {
            self.told.add("part", "without positions: left out", name);
            return Ok(None);
        };
        let (indices, keep) = self.corners(place, primitive, &accessor)?;
        let kept = keep.as_ref().map_or(accessor.count(), Vec::len) as u64;
        self.budget.vertices(place, kept)?;
        let moves = skin.is_some() || weights.iter().any(|w| *w != 0.0);
        let each = if moves { POSED } else { VERTEX };
        self.budget.memory(place, kept.saturating_mul(each))?;
        let file = self.file;
        let source = Source { place, buffers: &file.buffers, keep: keep.as_deref() };
        let positions = source.vectors::<3>("positions", &accessor)?;
        let indices = indices.unwrap_or_else(|| (0..positions.len() as u32).collect());
        let mut normals = self.optional::<3>(&source, primitive, &Semantic::Normals, &positions);
        let uvs = match look.uv_set {
            Some(set) => {
                let uvs = Semantic::TexCoords(set);
                let uvs = self.optional::<2>(&source, primitive, &uvs, &positions);
                // Engines give a missing attribute as zeros.
                if uvs.is_empty() { vec![[0.0; 2]; positions.len()] } else { uvs }
            }
            None => Vec::new(),
        };
        let positions = match moves {
            true => {
                let wide = |v: Vec<[f32; 3]>| -> Vec<DVec3> {
                    v.into_iter().map(|v| DVec3::from_array(v.map(f64::from))).collect()
                };
                let (mut p, mut n) = (wide(positions), wide(normals));
                morph::add(&source, primitive, weights, &mut p, &mut n)?;
                if let Some(skin) = skin {
                    let joints = skin::matrices(&self.place, &skin, file, &self.worlds)?;
                    skin::deform(&source, primitive, &joints, &mut p, &mut n)?;
                }
                normals = n.into_iter().map(|n| n.as_vec3().to_array()).collect();
                p.into_iter().map(|p| p.as_vec3()).collect()
            }
            false => positions.into_iter().map(Vec3::from_array).collect(),
        };
        let indices = match primitive.mode() {
            Mode::TriangleStrip => strips::strip(&indices),
            Mode::TriangleFan => strips::fan(&indices),
            Mode::Triangles | Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip => {
                indices
            }
        };
        let (given, colour) = ((positions, indices), base_colour(primitive));
        let mut mesh = repair::mesh(place, given, colour, &self.budget, &mut self.scene.notes)?;
        let normals = normals.into_iter().map(Vec3::from_array).collect();
        repair::complete(&mut mesh, Vec::new(), normals);
        mesh.uvs = uvs.into_iter().map(Vec2::from_array).collect();
        Ok(Some(mesh))
    }

    /// The indices of a primitive (none: its vertices in their order) and which of its vertices they
    /// name, where they do not name all: many primitives may share one large accessor.
    fn corners(
        &mut self,
        place: &str,
        primitive: &gltf::Primitive<'f>,
        positions: &gltf::Accessor<'f>,
    ) -> Result<Corners> {
        let Some(accessor) = primitive.indices() else { return Ok((None, None)) };
        let count = accessor.count() as u64;
        self.budget.indices(place, count)?;
        self.budget.memory(place, count.saturating_mul(12))?;
        let mut indices = Source::all(place, &self.file.buffers).indices(&accessor)?;
        if !self.budget.is_lenient() {
            repair::check_indices(place, &indices, positions.count())?;
        }
        let keep = compact(&mut indices, positions.count());
        Ok((Some(indices), keep))
    }

    /// An attribute that a vertex may have; none where it is not sound, which is counted.
    fn optional<const N: usize>(
        &mut self,
        source: &Source<'_>,
        primitive: &gltf::Primitive<'f>,
        semantic: &Semantic,
        positions: &[[f32; 3]],
    ) -> Vec<[f32; N]> {
        let Some(accessor) = primitive.get(semantic) else { return Vec::new() };
        let what = semantic.to_string();
        let many = source.keep.map_or(positions.len(), |_| accessor.count());
        if accessor.count() != many {
            let what = format!("whose {what} are not as many as its positions: taken as without");
            self.told.add("mesh primitive", what, "");
            return Vec::new();
        }
        match source.vectors::<N>(&what, &accessor) {
            Ok(values) if values.len() == positions.len() => values,
            _ => {
                let what = format!("whose {what} cannot be read: taken as without");
                self.told.add("mesh primitive", what, "");
                Vec::new()
            }
        }
    }
}

/// Numbers `indices` anew by the vertices of `count` that they name, in the order of these, and gives
/// their numbers; `None` where they name all. One that is not there is beyond all others.
fn compact(indices: &mut [u32], count: usize) -> Option<Vec<u32>> {
    let inside = |i: &u32| (*i as usize) < count;
    let end = indices.iter().filter(|i| inside(i)).max().map_or(0, |i| *i as usize + 1);
    if end <= indices.len().saturating_mul(8) {
        let mut number = vec![u32::MAX; end];
        for &i in indices.iter() {
            number.get_mut(i as usize).into_iter().for_each(|n| *n = 0);
        }
        if number.iter().all(|n| *n == 0) && end == count {
            return None;
        }
        let keep: Vec<u32> = (0..).zip(&number).filter(|(_, n)| **n == 0).map(|(i, _)| i).collect();
        for (new, &old) in (0..).zip(&keep) {
            number.get_mut(old as usize).into_iter().for_each(|n| *n = new);
        }
        for i in indices {
            *i = number.get(*i as usize).copied().unwrap_or(u32::MAX);
        }
        return Some(keep);
    }
    // Few corners of a wide range: no table as long as it.
    let mut keep: Vec<u32> = indices.iter().copied().filter(|i| inside(i)).collect();
    keep.sort_unstable();
    keep.dedup();
    for i in indices {
        *i = keep.binary_search(i).map_or(u32::MAX, |new| new as u32);
    }
    Some(keep)
}

fn base_colour(primitive: &gltf::Primitive<'_>) -> Vec3 {
    let [r, g, b, _] = primitive.material().pbr_metallic_roughness().base_color_factor();
    Vec3::new(r, g, b).clamp(Vec3::ZERO, Vec3::ONE)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vertices_that_nothing_names_are_not_read() {
        let mut all = [2, 0, 1];
        assert_eq!((compact(&mut all, 3), all), (None, [2, 0, 1]));
        let mut some = [7, 3, 7, 5];
        assert_eq!((compact(&mut some, 9), some), (Some(vec![3, 5, 7]), [2, 0, 2, 1]));
        let mut wide = [4_000_000_000, 9, 9];
        let far = compact(&mut wide, usize::MAX);
        assert_eq!((far, wide), (Some(vec![9, 4_000_000_000]), [1, 0, 0]));
        let mut beyond = [1, 0, 8];
        assert_eq!((compact(&mut beyond, 3), beyond), (Some(vec![0, 1]), [1, 0, u32::MAX]));
    }
}
