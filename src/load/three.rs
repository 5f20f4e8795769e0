//! three.js' own scene JSON (`Object3D.toJSON`), read whole: geometries, materials' sides, who casts and
//! receives, lights with their shadow cameras, cameras.
//!
//! A running page gives it by `scene.toJSON()`, once matrices are up to date; a camera and the targets of
//! lights that are no part of the scene are added to it (README, *From a three.js page*).

mod buffers;
mod file;
mod flat;
mod lamps;
mod materials;
mod polyhedra;
mod shape;
mod turned;

use crate::files::Budget;
use crate::{LoadedScene, Part};
use buffers::Reader;
use file::{File, Geometry, Node};
use glam::{DMat4, Vec3};
use gnomon_core::scene::{Mesh, Surface};
use gnomon_core::{Error, Result};
use lamps::Targets;
use materials::Library;
use shape::{Parameters, Shape};
use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

/// Bytes of memory that a byte of the JSON takes at most: a number of two characters is sixteen bytes.
const GROWTH: u64 = 10;

pub(super) fn read(place: &str, bytes: &[u8], mut budget: Budget<'_>) -> Result<LoadedScene> {
    budget.memory(place, (bytes.len() as u64).saturating_mul(GROWTH))?;
    let file: File = serde_json::from_slice(bytes).map_err(|e| {
        let reason = format!("is no scene of three.js: line {}: {e}", e.line());
        Error::bad_input(place, reason, "export it again with scene.toJSON()")
    })?;
    let Some(root) = file.object.as_ref().filter(|_| file.metadata.kind == "Object") else {
        let kind = match file.metadata.kind.as_str() {
            "" => "a JSON without three.js' metadata".to_string(),
            kind => format!("three.js' {kind}"),
        };
        let fix = "give what scene.toJSON() of three.js returns, a .gltf or a .glb";
        return Err(Error::bad_input(place, format!("is {kind}, no scene"), fix));
    };
    let mut reader = SceneReader {
        place,
        geometries: file.geometries.iter().map(|g| (g.uuid.as_str(), g)).collect(),
        library: Library::new(&file.materials),
        shapes: HashMap::new(),
        budget: &mut budget,
        scene: LoadedScene::default(),
        told: BTreeMap::new(),
        flags: Flags::default(),
    };
    let nodes = reader.visible(root)?;
    let targets: Targets<'_> = nodes.iter().map(|(n, world)| (n.uuid.as_str(), *world)).collect();
    for (node, world) in &nodes {
        reader.node(node, *world, &targets)?;
    }
    Ok(reader.finished())
}

/// How many meshes cast and receive, and whether a light casts.
#[derive(Default)]
struct Flags {
    meshes: usize,
    casts: usize,
    receives: usize,
    idle_lights: Vec<crate::LoadedLight>,
}

struct SceneReader<'a, 'b, 'c> {
    place: &'a str,
    geometries: HashMap<&'a str, &'a Geometry>,
    library: Library<'a>,
    shapes: HashMap<&'a str, Arc<Shape>>,
    budget: &'b mut Budget<'c>,
    scene: LoadedScene,
    /// Reasons for leaving things out, each with their names.
    told: BTreeMap<String, Vec<String>>,
    flags: Flags,
}

impl<'a> SceneReader<'a, '_, '_> {
    /// All nodes that are visible with their parents, and their world matrices, parents first.
    fn visible(&self, root: &'a Node) -> Result<Vec<(&'a Node, DMat4)>> {
        let mut nodes = Vec::new();
        let mut stack = vec![(root, DMat4::IDENTITY)];
        while let Some((node, parent)) = stack.pop() {
            if node.visible == Some(false) {
                continue;
            }
            let own = node.matrix.map_or(DMat4::IDENTITY, |m| DMat4::from_cols_array(&m));
            let world = gnomon_core::view::product(&parent, &own);
            if !world.is_finite() {
                let at = format!("{}: object '{}'", self.place, node.name);
                return Err(Error::bad_input(at, "has a matrix without end", "export it again"));
            }
            nodes.push((node, world));
            stack.extend(node.children.iter().rev().map(|child| (child, world)));
        }
        Ok(nodes)
    }

    fn tell(&mut self, reason: &str, name: &str) {
        self.told.entry(reason.to_string()).or_default().push(name.to_string());
    }

    fn node(&mut self, node: &'a Node, world: DMat4, targets: &Targets<'_>) -> Result<()> {
        match node.kind.as_str() {
            "Mesh" | "InstancedMesh" => self.mesh(node, world),
            "SkinnedMesh" => {
                self.tell("skins are drawn in the pose that they were bound in", &node.name);
                self.mesh(node, world)
            }
            "BatchedMesh" | "Sprite" => {
                self.tell("batched meshes and sprites are left out", &node.name);
                Ok(())
            }
            "DirectionalLight" | "SpotLight" | "PointLight" => {
                let (light, notes) = lamps::light(node, world, targets);
                self.scene.notes.extend(notes);
                let lights = match node.cast_shadow {
                    true => &mut self.scene.lights,
                    false => &mut self.flags.idle_lights,
                };
                lights.push(light);
                Ok(())
            }
            "PerspectiveCamera" | "OrthographicCamera" => {
                self.scene.cameras.push(lamps::camera(node, world));
                Ok(())
            }
            _ => Ok(()),
        }
    }

    fn mesh(&mut self, node: &'a Node, world: DMat4) -> Result<()> {
        let Some(geometry) = node.geometry.as_deref() else { return Ok(()) };
        let at = format!("{}: object '{}'", self.place, node.name);
        let given = self.geometries.get(geometry).copied().ok_or_else(|| {
            Error::bad_input(&at, "names a geometry that is not there", "export it again")
        })?;
        if node.morph_target_influences.iter().flatten().any(|&weight| weight != 0.0) {
            self.tell("morph targets are left out", &node.name);
        }
        if node.layers.is_some_and(|layers| layers != 1) {
            self.tell("layers are not looked at: objects on other layers are drawn", &node.name);
        }
        let shape = self.shape(given)?;
        self.flags.meshes += 1;
        self.flags.casts += usize::from(node.cast_shadow);
        self.flags.receives += usize::from(node.receive_shadow);
        let places = match node.kind.as_str() {
            "InstancedMesh" => instances(node, world, &at)?,
            _ => vec![world],
        };
        for (material, triangles) in self.library.drawn(node.material.as_ref(), &shape) {
            let material = self.library.of(material);
            for reason in material.untold() {
                self.tell(&reason, material.name());
            }
            if !material.is_drawn() || triangles.is_empty() {
                continue;
            }
            let mesh: Arc<Mesh> = mesh(&shape, triangles, material.colour()).into();
            let surface = Surface {
                sides: material.sides(),
                casts: node.cast_shadow,
                receives: node.receive_shadow && material.is_lit(),
                ..Surface::default()
            };
            if surface.casts {
                self.library.cast_by(material);
            }
            let name = if node.name.is_empty() { &node.kind } else { &node.name };
            for model in &places {
                let name = format!("{name}#{}", self.scene.parts.len());
                let (mesh, surface) = (mesh.clone(), surface.clone());
                self.scene.parts.push(Part { name, mesh, model: *model, surface });
            }
        }
        Ok(())
    }

    /// The vertices of a geometry, made once.
    fn shape(&mut self, given: &'a Geometry) -> Result<Arc<Shape>> {
        if let Some(shape) = self.shapes.get(given.uuid.as_str()) {
            return Ok(shape.clone());
        }
        let place = format!("{}: geometry '{}'", self.place, given.uuid);
        let shape = match &given.data {
            Some(buffers) => Some(Reader { place: &place, buffers }.shape(self.budget)?),
            None => made(&place, given, self.budget)?,
        };
        let shape = shape.unwrap_or_else(|| {
            let reason = format!("geometries of type {} are left out", given.kind);
            self.tell(&reason, &given.uuid);
            Shape::default()
        });
        let shape = Arc::new(shape);
        self.shapes.insert(&given.uuid, shape.clone());
        Ok(shape)
    }

    /// The scene with what there is to say of it.
    fn finished(mut self) -> LoadedScene {
        let Flags { meshes, casts, receives, idle_lights } = self.flags;
        for (count, word) in [(casts, "cast"), (receives, "receive")] {
            if count == 0 && meshes > 0 {
                self.scene.skipped.push(format!(
                    "no mesh {word}s a shadow: {word}Shadow is false on all {meshes}, three.js' default"
                ));
            }
        }
        let told = std::mem::take(&mut self.told);
        self.scene.skipped.extend(told.into_iter().map(|(reason, names)| match names.as_slice() {
            [name] => format!("{reason}: '{name}'"),
            names => format!("{reason}: {} of them", names.len()),
        }));
        if self.scene.lights.is_empty() && !idle_lights.is_empty() {
            self.scene.skipped.push(
                "no light of the scene has castShadow: it is measured as if it had".to_string(),
            );
            self.scene.lights = idle_lights;
        }
        let (cull, word) = self.library.cull();
        self.scene.cull = Some(cull);
        self.scene.filter = Some("vogel5-bilinear-ign");
        self.scene.skipped.extend(word);
        self.scene
    }
}

/// World matrices of the instances of a mesh.
fn instances(node: &Node, world: DMat4, at: &str) -> Result<Vec<DMat4>> {
    let numbers = node.instance_matrix.as_ref().map_or(&[][..], |given| &given.array);
    let numbers: Option<Vec<f64>> = numbers.iter().copied().collect();
    let numbers = numbers.filter(|list| list.iter().all(|x| x.is_finite())).ok_or_else(|| {
        Error::bad_input(at, "has an instance matrix that is not finite", "export it again")
    })?;
    let matrices = numbers.as_chunks::<16>().0.iter().take(node.count.unwrap_or(usize::MAX));
    let of = |m| gnomon_core::view::product(&world, &DMat4::from_cols_array(m));
    Ok(matrices.map(of).collect())
}

/// A parametric geometry; `None` for a type that is not known.
fn made(place: &str, given: &Geometry, budget: &mut Budget<'_>) -> Result<Option<Shape>> {
    let p = &mut Parameters { place, given: &given.parameters, budget };
    // Names of releases before r125 end in BufferGeometry.
    let kind = given.kind.replace("BufferGeometry", "Geometry");
    Ok(Some(match kind.as_str() {
        "BoxGeometry" => flat::cuboid(p)?,
        "PlaneGeometry" => flat::plane(p)?,
        "CircleGeometry" => flat::circle(p)?,
        "RingGeometry" => flat::ring(p)?,
        "TorusGeometry" => flat::torus(p)?,
        "TorusKnotGeometry" => flat::torus_knot(p)?,
        "SphereGeometry" => turned::sphere(p)?,
        "CylinderGeometry" => turned::cylinder(p, false)?,
        "ConeGeometry" => turned::cylinder(p, true)?,
        "CapsuleGeometry" => turned::capsule(p)?,
        "LatheGeometry" => turned::lathe(p)?,
        kind => return polyhedra::polyhedron(kind, p),
    }))
}

/// The mesh of some triangles of a shape, rounded to f32 as three.js uploads it.
fn mesh(shape: &Shape, triangles: Vec<[u32; 3]>, colour: Vec3) -> Mesh {
    Mesh {
        normals: shape.normals.iter().map(|n| n.as_vec3()).collect(),
        uvs: shape.uvs.iter().map(|uv| uv.as_vec2()).collect(),
        ..Mesh::new(shape.positions.iter().map(|p| p.as_vec3()).collect(), triangles, colour)
    }
}

#[cfg(test)]
mod tests;
