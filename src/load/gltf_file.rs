//! glTF 2.0 and GLB: meshes under their node transforms, the first light and camera.

use super::files::Budget;
use super::{
    LightKind, LoadedCamera, LoadedLens, LoadedLight, LoadedScene, Part, accessor, repair, strips,
};
use glam::{DMat4, DVec3, Mat4, Vec3};
use gltf::buffer::Source;
use gltf::khr_lights_punctual::Kind;
use gltf::mesh::Mode;
use gltf::scene::Transform;
use gnomon_core::scene::Surface;
use gnomon_core::{Error, Result};
use std::collections::HashSet;

pub(super) fn read(place: &str, bytes: &[u8], budget: Budget<'_>) -> Result<LoadedScene> {
    let place = place.to_string();
    budget.memory(&place, json_need(bytes))?;
    let mut file = parsed(bytes).map_err(|e| {
        Error::bad_input(&place, format!("is no usable glTF 2.0 ({e})"), "export it again")
    })?;
    let mut reader = Reader { place, buffers: Vec::new(), budget, scene: LoadedScene::default() };
    let chunk = file.blob.take();
    reader.read_buffers(&file, chunk)?;
    reader.read_nodes(&file.document)?;
    Ok(reader.scene)
}

/// Bytes that an object of the JSON takes once it is parsed.
const OBJECT: u64 = 1024;

/// Bytes of memory that the objects of a JSON need, before they are made: `{}` is two bytes in the file
/// and a node in memory.
fn json_need(bytes: &[u8]) -> u64 {
    let length = bytes.strip_prefix(b"glTF").and_then(|rest| rest.get(8..12)?.try_into().ok());
    let json = match length.map(u32::from_le_bytes) {
        Some(length) => bytes.get(20..).unwrap_or_default().iter().take(length as usize),
        None => bytes.iter().take(usize::MAX),
    };
    let objects = json.filter(|&&b| b == b'{').count() as u64;
    (bytes.len() as u64 * 3).saturating_add(objects * OBJECT)
}

/// The validated document. Two things that gltf 1.4 does not check in time (found by fuzzing) are
/// checked first: a GLB shorter than its own header, and the index of a primitive's accessor.
fn parsed(bytes: &[u8]) -> std::result::Result<gltf::Gltf, String> {
    let declared = bytes.strip_prefix(b"glTF").and_then(|rest| rest.get(4..8));
    let declared = declared.and_then(|length| Some(u32::from_le_bytes(length.try_into().ok()?)));
    if let Some(length) = declared.filter(|&length| length < 12) {
        return Err(format!("the GLB says that it has {length} bytes, its header alone has 12"));
    }
    let unchecked = gltf::Gltf::from_slice_without_validation(bytes).map_err(|e| e.to_string())?;
    let (mut root, blob) = (unchecked.document.into_json(), unchecked.blob);
    root.extensions_required.retain(|name| !is_harmless(name));
    if !root.extensions_required.is_empty() {
        let names = root.extensions_required.join(", ");
        return Err(format!("it needs {names}, which is not read; `gltf-transform` can decode it"));
    }
    let primitives = root.meshes.iter().flat_map(|mesh| &mesh.primitives);
    let mut accessors = primitives.flat_map(|primitive| primitive.attributes.values());
    if let Some(beyond) = accessors.find(|index| index.value() >= root.accessors.len()) {
        let count = root.accessors.len();
        return Err(format!("a primitive names accessor {} of {count}", beyond.value()));
    }
    let document = gltf::Document::from_json(root).map_err(|e| e.to_string())?;
    Ok(gltf::Gltf { document, blob })
}

/// Extensions that a file may require: those that are read, and those that touch only materials and
/// textures, which are not.
fn is_harmless(extension: &str) -> bool {
    const READ: [&str; 2] = ["KHR_mesh_quantization", "KHR_lights_punctual"];
    const MATERIALS: [&str; 9] = [
        "KHR_materials_",
        "KHR_texture_",
        "KHR_xmp",
        "EXT_texture_",
        "EXT_materials_",
        "MSFT_texture_",
        "MSFT_packing_",
        "ADOBE_materials_",
        "AGI_articulations",
    ];
    READ.contains(&extension) || MATERIALS.iter().any(|prefix| extension.starts_with(prefix))
}

struct Reader<'b> {
    place: String,
    buffers: Vec<Vec<u8>>,
    budget: Budget<'b>,
    scene: LoadedScene,
}

impl Reader<'_> {
    fn bad(&self, at: &str, reason: impl Into<String>, fix: &str) -> Error {
        Error::bad_input(format!("{}: {at}", self.place), reason, fix)
    }

    /// The first buffer alone may be the GLB's binary chunk, which is moved here, never copied.
    fn read_buffers(&mut self, file: &gltf::Gltf, mut chunk: Option<Vec<u8>>) -> Result<()> {
        for buffer in file.buffers() {
            let at = format!("{}: buffers[{}]", self.place, buffer.index());
            let bytes = match buffer.source() {
                Source::Bin if buffer.index() > 0 => {
                    let reason = "has no URI, and only the first buffer may be the binary chunk";
                    return Err(Error::bad_input(at, reason, "export it again"));
                }
                Source::Bin => chunk.take().ok_or_else(|| {
                    Error::bad_input(&at, "the GLB has no binary chunk", "export it again")
                })?,
                Source::Uri(uri) => match uri.strip_prefix("data:") {
                    Some(data) => {
                        let base64 = data.split_once(";base64,").map(|(_, text)| text);
                        let base64 = base64.ok_or_else(|| {
                            Error::bad_input(&at, "is a data URI without base64", "export it again")
                        })?;
                        self.budget.data_uri(&at, base64)?
                    }
                    None => self.budget.read_beside(&at, uri)?,
                },
            };
            if (bytes.len() as u64) < buffer.length() as u64 {
                let reason =
                    format!("holds {} bytes, {} are declared", bytes.len(), buffer.length());
                return Err(Error::bad_input(at, reason, "export it again"));
            }
            self.buffers.push(bytes);
        }
        Ok(())
    }

    /// Walks the node tree with a stack of its own; a node met twice is a cycle or a shared child.
    fn read_nodes(&mut self, document: &gltf::Document) -> Result<()> {
        let scene = document.default_scene().or_else(|| document.scenes().next());
        let scene = scene.ok_or_else(|| self.bad("scenes", "there is none", "export a scene"))?;
        let mut seen = HashSet::new();
        let mut stack: Vec<_> = scene.nodes().map(|n| (n, DMat4::IDENTITY, 0)).collect();
        stack.reverse();
        while let Some((node, parent, depth)) = stack.pop() {
            let at = format!("nodes[{}]", node.index());
            if !seen.insert(node.index()) {
                return Err(self.bad(&at, "is reached twice", "give each node one parent"));
            }
            if depth > self.budget.depth() {
                let reason = format!("lies deeper than {} levels", self.budget.depth());
                return Err(self.bad(&at, reason, "flatten the scene"));
            }
            let transform = node.transform();
            if matches!(&transform, Transform::Decomposed { rotation: [x, y, z, w], .. }
                if x * x + y * y + z * z + w * w == 0.0)
            {
                let reason = "its rotation is zero, no quaternion";
                return Err(self.bad(&at, reason, "give a unit quaternion, or leave it out"));
            }
            let world = parent * Mat4::from_cols_array_2d(&transform.matrix()).as_dmat4();
            if draws_nothing(world) {
                let reason = "is scaled to nothing: left out with what hangs on it";
                self.scene.notes.push(format!("{at} {reason}"));
                continue;
            }
            if !world.is_finite() || world.determinant() == 0.0 {
                let reason = "its matrix is singular or not finite";
                if self.budget.is_lenient() {
                    self.scene
                        .notes
                        .push(format!("{at} and what hangs on it are left out: {reason}"));
                    continue;
                }
                return Err(self.bad(&at, reason, "repair the node, or take --lenient"));
            }
            self.read_node(&node, world)?;
            let children: Vec<_> = node.children().collect();
            stack.extend(children.into_iter().rev().map(|child| (child, world, depth + 1)));
        }
        Ok(())
    }

    fn read_node(&mut self, node: &gltf::Node<'_>, world: DMat4) -> Result<()> {
        if let Some(mesh) = node.mesh() {
            for primitive in mesh.primitives() {
                self.read_primitive(node, &mesh, &primitive, world)?;
            }
        }
        if let Some(light) = node.light() {
            self.read_light(node, &light, world);
        }
        if let Some(camera) = node.camera() {
            self.read_camera(node, &camera, world);
        }
        Ok(())
    }

    fn read_primitive(
        &mut self,
        node: &gltf::Node<'_>,
        mesh: &gltf::Mesh<'_>,
        primitive: &gltf::Primitive<'_>,
        world: DMat4,
    ) -> Result<()> {
        let at = format!("meshes[{}].primitives[{}]", mesh.index(), primitive.index());
        let place = format!("{}: {at}", self.place);
        let mode = primitive.mode();
        if !matches!(mode, Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan) {
            self.scene.notes.push(format!("{at} is drawn as {mode:?}, left out"));
            return Ok(());
        }
        let positions = primitive.get(&gltf::Semantic::Positions);
        let positions =
            positions.ok_or_else(|| self.bad(&at, "has no positions", "export it again"))?;
        self.budget.vertices(&place, accessor::count(&positions))?;
        self.budget.memory(&place, accessor::count(&positions).saturating_mul(12))?;
        let positions = accessor::positions(&place, &positions, &self.buffers)?;
        let indices = match primitive.indices() {
            Some(indices) => {
                self.budget.indices(&place, accessor::count(&indices))?;
                self.budget.memory(&place, accessor::count(&indices).saturating_mul(4))?;
                accessor::indices(&place, &indices, &self.buffers)?
            }
            None => (0..positions.len() as u32).collect(),
        };
        let indices = match mode {
            Mode::TriangleStrip => strips::strip(&indices),
            Mode::TriangleFan => strips::fan(&indices),
            Mode::Triangles | Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip => {
                indices
            }
        };
        let (given, colour) = ((positions, indices), base_colour(primitive));
        let mesh_out = repair::mesh(&place, given, colour, &self.budget, &mut self.scene.notes)?;
        let name = node.name().or(mesh.name()).unwrap_or("mesh");
        let part = format!("{name}#{}", self.scene.parts.len());
        self.scene.parts.push(Part {
            name: part,
            mesh: mesh_out.into(),
            model: world,
            surface: Surface::default(),
        });
        Ok(())
    }

    fn read_light(
        &mut self,
        node: &gltf::Node<'_>,
        light: &gltf::khr_lights_punctual::Light<'_>,
        world: DMat4,
    ) {
        let kind = match light.kind() {
            Kind::Directional => LightKind::Directional,
            Kind::Spot { outer_cone_angle, .. } => LightKind::Spot {
                cone_degrees: 2.0 * f64::from(outer_cone_angle) * 180.0 / std::f64::consts::PI,
            },
            Kind::Point => LightKind::Point,
        };
        let index = format!("lights[{}]", light.index());
        self.scene.lights.push(LoadedLight {
            name: light.name().or(node.name()).map_or(index, str::to_string),
            kind,
            position: position(world),
            direction: axis(world, DVec3::NEG_Z),
            range: light.range().map(f64::from),
            shadow: None,
        });
    }

    fn read_camera(&mut self, node: &gltf::Node<'_>, camera: &gltf::Camera<'_>, world: DMat4) {
        let lens = match camera.projection() {
            gltf::camera::Projection::Perspective(lens) => LoadedLens::Perspective {
                fovy_degrees: f64::from(lens.yfov()) * 180.0 / std::f64::consts::PI,
            },
            gltf::camera::Projection::Orthographic(lens) => {
                LoadedLens::Orthographic { height: 2.0 * f64::from(lens.ymag()) }
            }
        };
        let index = format!("cameras[{}]", camera.index());
        self.scene.cameras.push(LoadedCamera {
            name: camera.name().or(node.name()).map_or(index, str::to_string),
            position: position(world),
            direction: axis(world, DVec3::NEG_Z),
            up: axis(world, DVec3::Y),
            lens,
        });
    }
}

/// Whether a node is scaled to a line or a point, which is how exporters hide things.
fn draws_nothing(world: DMat4) -> bool {
    let [x, y, z] = [world.x_axis, world.y_axis, world.z_axis].map(|axis| axis.truncate());
    let flat = [x.cross(y), y.cross(z), z.cross(x)];
    let scaled = [x, y, z].iter().filter(|axis| **axis == DVec3::ZERO).count() >= 2;
    scaled && world.is_finite() && flat.iter().all(|normal| *normal == DVec3::ZERO)
}

fn base_colour(primitive: &gltf::Primitive<'_>) -> Vec3 {
    let [r, g, b, _] = primitive.material().pbr_metallic_roughness().base_color_factor();
    Vec3::new(r, g, b).clamp(Vec3::ZERO, Vec3::ONE)
}

fn position(world: DMat4) -> DVec3 {
    world.w_axis.truncate()
}

fn axis(world: DMat4, local: DVec3) -> DVec3 {
    let v = world.transform_vector3(local);
    v / gnomon_core::view::length(v)
}
