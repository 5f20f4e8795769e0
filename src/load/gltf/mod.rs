//! glTF 2.0 and GLB: every mesh under its node transforms, posed as the file or a time of it says.

mod accessor;
mod animation;
mod buffers;
mod document;
mod draco;
mod instancing;
mod lights;
mod material;
mod meshopt;
mod morph;
mod nodes;
mod primitive;
mod skin;

use super::files::Budget;
use super::told::Told;
use super::{LoadedScene, Part};
use document::File;
use glam::DMat4;
use gnomon_core::scene::Mesh;
use gnomon_core::{Error, Result};
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

pub(super) fn read(place: &str, bytes: &[u8], mut budget: Budget<'_>) -> Result<LoadedScene> {
    let mut file = document::parse(place, bytes, &mut budget)?;
    let mut told = Told::default();
    let weights = animation::play(place, &mut file, budget.wanted(), &mut told)?;
    let worlds = nodes::worlds(&file.document, &file.nodes);
    let scene = LoadedScene::default();
    let (place, materials) = (place.to_string(), HashMap::new());
    let (meshes, noted) = (HashMap::new(), Told::default());
    let mut reader = Reader {
        place,
        file: &file,
        worlds,
        weights,
        budget,
        scene,
        told,
        noted,
        materials,
        meshes,
    };
    reader.read_nodes()?;
    reader.tell();
    Ok(reader.scene)
}

struct Reader<'f, 'b> {
    place: String,
    file: &'f File<'f>,
    /// World from node.
    worlds: Vec<DMat4>,
    /// Weights of morph targets that an animation sets, by node.
    weights: HashMap<usize, Vec<f64>>,
    budget: Budget<'b>,
    scene: LoadedScene,
    /// What can change a shadow, and what cannot.
    told: Told,
    noted: Told,
    /// Materials that have been read, by their numbers; that of none too.
    materials: HashMap<Option<usize>, material::Look>,
    /// Meshes that have been read: nodes that draw one in one pose share it.
    meshes: HashMap<primitive::Key, Option<Arc<Mesh>>>,
}

impl<'f> Reader<'f, '_> {
    fn bad(&self, at: &str, reason: impl Into<String>, fix: &str) -> Error {
        Error::bad_input(format!("{}: {at}", self.place), reason, fix)
    }

    /// The scene that is asked for by name or number, else the file's default, else its first.
    fn roots(&mut self) -> Result<Vec<gltf::Node<'f>>> {
        let document = &self.file.document;
        let scenes = document.scenes();
        let chosen = match self.budget.wanted().scene.clone() {
            Some(name) => {
                let number = name.parse().ok();
                let named = document.scenes().find(|s| s.name() == Some(name.as_str()));
                let chosen = named.or_else(|| document.scenes().nth(number?));
                let reason = || format!("none of {} is '{name}'", scenes.len());
                Some(chosen.ok_or_else(|| {
                    self.bad("scenes", reason(), "give the name or number of one of its scenes")
                })?)
            }
            None => document.default_scene().or_else(|| document.scenes().next()),
        };
        if scenes.len() > 1 {
            self.scene.notes.push(format!("the file has {} scenes; one is drawn", scenes.len()));
        }
        match chosen {
            Some(scene) => Ok(scene.nodes().collect()),
            // A library of meshes: what has no parent is drawn.
            None => {
                let nodes = || document.nodes();
                let children: HashSet<usize> =
                    nodes().flat_map(|n| n.children().map(|c| c.index())).collect();
                self.scene.notes.push("the file has no scene; all of its nodes are drawn".into());
                Ok(nodes().filter(|n| !children.contains(&n.index())).collect())
            }
        }
    }

    /// Walks the node tree with a stack of its own; a node met twice is a cycle or a shared child.
    fn read_nodes(&mut self) -> Result<()> {
        let mut seen = HashSet::new();
        let mut stack: Vec<_> = self.roots()?.into_iter().map(|node| (node, 0)).collect();
        stack.reverse();
        while let Some((node, depth)) = stack.pop() {
            let at = format!("nodes[{}]", node.index());
            if !seen.insert(node.index()) {
                return Err(self.bad(&at, "is reached twice", "give each node one parent"));
            }
            if depth > self.budget.depth() {
                let reason = format!("lies deeper than {} levels", self.budget.depth());
                return Err(self.bad(&at, reason, "flatten the scene"));
            }
            if self.file.nodes.get(node.index()).is_some_and(nodes::Placed::is_unturned) {
                let reason = "its rotation is zero, no quaternion";
                return Err(self.bad(&at, reason, "give a unit quaternion, or leave it out"));
            }
            if nodes::is_hidden(&node) {
                self.noted.add("node", "not visible: left out with what hangs on it", &at);
                continue;
            }
            let world = self.worlds.get(node.index()).copied().unwrap_or_default();
            let draws = self.is_drawable(&at, world)?;
            // What a skin moves does not stand where its node does.
            if draws || node.skin().is_some() {
                self.read_node(&node, world)?;
            }
            if draws {
                let children: Vec<_> = node.children().collect();
                stack.extend(children.into_iter().rev().map(|child| (child, depth + 1)));
            }
        }
        Ok(())
    }

    fn is_drawable(&mut self, at: &str, world: DMat4) -> Result<bool> {
        if nodes::draws_nothing(world) {
            self.noted.add("node", "scaled to nothing: left out with what hangs on it", at);
            return Ok(false);
        }
        if world.is_finite() && world.determinant() != 0.0 {
            return Ok(true);
        }
        let reason = "its matrix is singular or not finite";
        if !self.budget.is_lenient() {
            return Err(self.bad(at, reason, "repair the node, or take --lenient"));
        }
        self.scene.notes.push(format!("{at} and what hangs on it are left out: {reason}"));
        Ok(false)
    }

    fn read_node(&mut self, node: &gltf::Node<'f>, world: DMat4) -> Result<()> {
        if let Some(mesh) = node.mesh() {
            let stands = match node.skin() {
                Some(_) => vec![DMat4::IDENTITY],
                None => instancing::places(&self.place, node, self.file)?
                    .map_or(vec![world], |places| places.iter().map(|at| world * *at).collect()),
            };
            for primitive in mesh.primitives() {
                self.draw(node, &mesh, &primitive, &stands)?;
            }
        }
        if let Some(light) = node.light() {
            self.scene.lights.push(lights::light(node, &light, world));
        }
        if let Some(camera) = node.camera() {
            self.scene.cameras.push(lights::camera(node, &camera, world));
        }
        Ok(())
    }

    /// Draws a primitive of a node's mesh wherever it stands.
    fn draw(
        &mut self,
        node: &gltf::Node<'f>,
        mesh: &gltf::Mesh<'f>,
        primitive: &gltf::Primitive<'f>,
        stands: &[DMat4],
    ) -> Result<()> {
        let name = node.name().or(mesh.name()).unwrap_or("mesh");
        let Some((shape, surface)) = self.shape(node, mesh, primitive, name)? else {
            return Ok(());
        };
        self.scene.file.skinned += usize::from(node.skin().is_some());
        let weights = self.weights_of(node, mesh, primitive);
        self.scene.file.morphed += usize::from(weights.iter().any(|weight| *weight != 0.0));
        let all = self.scene.parts.len() + stands.len();
        super::check_parts(&self.place, all)?;
        for &model in stands {
            if nodes::draws_nothing(model) || !model.is_finite() || model.determinant() == 0.0 {
                self.noted.add("instance", "scaled to nothing or not finite: left out", name);
                continue;
            }
            let name = format!("{name}#{}", self.scene.parts.len());
            let (mesh, surface) = (Arc::clone(&shape), surface.clone());
            self.scene.parts.push(Part { name, mesh, model, surface });
        }
        Ok(())
    }

    /// What was counted, as sentences.
    fn tell(&mut self) {
        self.scene.skipped.extend(self.told.sentences());
        self.scene.notes.extend(self.noted.sentences());
        let animations = self.file.document.animations().len();
        self.scene.file.animations = animations;
        self.scene.file.time = self.budget.wanted().time.map(|time| time.to_string());
        if animations > 0 && self.budget.wanted().time.is_none() {
            let plural = if animations == 1 { "" } else { "s" };
            self.scene.skipped.push(format!(
                "{animations} animation{plural} not played: all stands as at rest (--time T poses it)"
            ));
        }
    }
}
