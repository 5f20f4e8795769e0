//! A glTF document with its buffers, checked and unpacked before anything is read from it.

use super::super::files::Budget;
use super::buffers::{Buffers, add_view};
use super::nodes::Placed;
use super::{draco, meshopt};
use gltf::json;
use gltf::json::accessor::{ComponentType, IndexComponentType, sparse};
use gltf::json::validation::{Checked, USize64};
use gnomon_core::{Error, Result};
use std::borrow::Cow;

/// Bytes that an object of the JSON takes once it is parsed.
const OBJECT: u64 = 1024;

/// A checked document: nothing in it is compressed any more.
pub(super) struct File<'a> {
    pub(super) document: gltf::Document,
    pub(super) buffers: Buffers<'a>,
    /// Transforms of the nodes as the JSON has them, in f64.
    pub(super) nodes: Vec<Placed>,
    /// Channels of animations that move no node.
    pub(super) unread: usize,
}

/// Parses a `.gltf` or `.glb`, reads its buffers and unpacks what is compressed.
pub(super) fn parse<'a>(place: &str, bytes: &'a [u8], budget: &mut Budget<'_>) -> Result<File<'a>> {
    budget.memory(place, json_need(bytes))?;
    let unusable = |e: String| {
        Error::bad_input(place, format!("is no usable glTF 2.0 ({e})"), "export it again")
    };
    let (text, chunk) = chunks(bytes).map_err(unusable)?;
    let (mut root, unread) = root(&text).map_err(|e| match is_first(&text) {
        true => super::super::format::first_gltf(place),
        false => unusable(e.to_string()),
    })?;
    check(&mut root).map_err(unusable)?;
    let nodes = super::nodes::placed(&text).map_err(|e| unusable(e.to_string()))?;
    drop(text);
    let mut buffers = read_buffers(place, &root, chunk, budget)?;
    meshopt::unpack(place, &mut root, &mut buffers, budget)?;
    draco::unpack(place, &mut root, &mut buffers, budget)?;
    zeros(&mut root, &mut buffers);
    let document = gltf::Document::from_json(root).map_err(|e| unusable(e.to_string()))?;
    Ok(File { document, buffers, nodes, unread })
}

/// The parsed JSON, and how many channels of animations it does not have any more: gltf 1.4 refuses those
/// that move no node (`KHR_animation_pointer`), and scenes that draw none.
fn root(text: &[u8]) -> std::result::Result<(json::Root, usize), serde_json::Error> {
    let first = json::Root::from_slice(text);
    let is_pointed = || text.windows(POINTER.len()).any(|word| word == POINTER);
    if first.is_ok() && !is_pointed() {
        return first.map(|root| (root, 0));
    }
    let mut json: serde_json::Value = serde_json::from_slice(text)?;
    let list = |json: &mut serde_json::Value, key: &str| {
        json.get_mut(key).and_then(|list| list.as_array_mut().map(std::mem::take))
    };
    let mut unread = 0;
    let mut animations = list(&mut json, "animations").unwrap_or_default();
    for animation in &mut animations {
        let mut channels = list(animation, "channels").unwrap_or_default();
        let all = channels.len();
        channels.retain(|channel| moves_a_node(channel) == Some(true));
        unread += all - channels.len();
        put(animation, "channels", channels);
    }
    let channels = |animation: &serde_json::Value| animation.get("channels")?.as_array().cloned();
    animations.retain(|animation| channels(animation).is_some_and(|all| !all.is_empty()));
    let mut scenes = list(&mut json, "scenes").unwrap_or_default();
    for scene in scenes.iter_mut().filter(|scene| scene.get("nodes").is_none()) {
        put(scene, "nodes", Vec::new());
    }
    put(&mut json, "animations", animations);
    put(&mut json, "scenes", scenes);
    json::Root::from_slice(&serde_json::to_vec(&json)?).map(|root| (root, unread))
}

/// Sets a list of an object; what is none is left to the parser.
fn put(json: &mut serde_json::Value, key: &str, list: Vec<serde_json::Value>) {
    if let Some(map) = json.as_object_mut() {
        map.insert(key.into(), list.into());
    }
}

const POINTER: &[u8] = b"KHR_animation_pointer";

fn moves_a_node(channel: &serde_json::Value) -> Option<bool> {
    const PATHS: [&str; 4] = ["translation", "rotation", "scale", "weights"];
    let target = channel.get("target")?;
    Some(target.get("node")?.is_u64() && PATHS.contains(&target.get("path")?.as_str()?))
}

/// Bytes of memory that the objects of a JSON need, before they are made: `{}` is two bytes in the file
/// and a node in memory.
fn json_need(bytes: &[u8]) -> u64 {
    let length = bytes.strip_prefix(b"glTF").and_then(|rest| rest.get(8..12)?.try_into().ok());
    let (json, rest) = match length.map(u32::from_le_bytes) {
        Some(length) => {
            let json = bytes.get(20..).unwrap_or_default();
            json.split_at(json.len().min(length as usize))
        }
        None => (bytes, &[][..]),
    };
    let objects = json.iter().filter(|&&b| b == b'{').count() as u64;
    (json.len() as u64 * 3 + rest.len() as u64).saturating_add(objects * OBJECT)
}

type Chunks<'a> = (Cow<'a, [u8]>, Option<Cow<'a, [u8]>>);

/// The JSON and the binary chunk. A GLB shorter than its own header is refused here, since gltf 1.4 does
/// not in time (found by fuzzing).
fn chunks(bytes: &[u8]) -> std::result::Result<Chunks<'_>, String> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    if !bytes.starts_with(b"glTF") {
        return Ok((Cow::Borrowed(bytes), None));
    }
    let declared = bytes.get(8..12).and_then(|length| length.try_into().ok());
    if let Some(length) = declared.map(u32::from_le_bytes).filter(|&length| length < 12) {
        return Err(format!("the GLB says that it has {length} bytes, its header alone has 12"));
    }
    let glb = gltf::Glb::from_slice(bytes).map_err(|e| e.to_string())?;
    Ok((glb.json, glb.bin))
}

/// Whether a JSON is glTF 1.0, which has maps where 2.0 has lists.
fn is_first(json: &[u8]) -> bool {
    let json: serde_json::Value = serde_json::from_slice(json).unwrap_or_default();
    let version = json.get("asset").and_then(|asset| asset.get("version")?.as_str());
    version.is_some_and(|version| version.starts_with("1."))
        || json.get("accessors").is_some_and(serde_json::Value::is_object)
}

/// What gltf 1.4 would refuse although it is read here, or would not check in time.
fn check(root: &mut json::Root) -> std::result::Result<(), String> {
    root.extensions_required.retain(|name| !is_read(name));
    if !root.extensions_required.is_empty() {
        let names = root.extensions_required.join(", ");
        return Err(format!("it needs {names}, which is not read; `gltf-transform` can decode it"));
    }
    for primitive in root.meshes.iter_mut().flat_map(|mesh| &mut mesh.primitives) {
        primitive.attributes.retain(|semantic, _| matches!(semantic, Checked::Valid(_)));
    }
    // Bounds, which writers forget and nothing here needs, and a scene that is not there.
    for accessor in &mut root.accessors {
        let none = || Some(serde_json::json!([0, 0, 0]));
        (accessor.min, accessor.max) = (none(), none());
    }
    root.scene = root.scene.filter(|scene| scene.value() < root.scenes.len());
    let primitives = root.meshes.iter().flat_map(|mesh| &mesh.primitives);
    let targets = primitives.clone().flat_map(|p| p.targets.iter().flatten());
    let of_targets = targets.flat_map(|t| [t.positions, t.normals, t.tangents]).flatten();
    let mut accessors = primitives.flat_map(|p| p.attributes.values()).copied().chain(of_targets);
    if let Some(beyond) = accessors.find(|index| index.value() >= root.accessors.len()) {
        let count = root.accessors.len();
        return Err(format!("a primitive names accessor {} of {count}", beyond.value()));
    }
    Ok(())
}

/// Extensions that a file may require: those that are read, and those that touch only materials,
/// textures and data about the scene, which change no shadow.
fn is_read(extension: &str) -> bool {
    const READ: [&str; 7] = [
        "KHR_mesh_quantization",
        "KHR_lights_punctual",
        "KHR_draco_mesh_compression",
        "EXT_meshopt_compression",
        "KHR_meshopt_compression",
        "EXT_mesh_gpu_instancing",
        "KHR_animation_pointer",
    ];
    const HARMLESS: [&str; 23] = [
        "KHR_interactivity",
        "KHR_node_",
        "EXT_instance_features",
        "EXT_mesh_features",
        "EXT_mesh_manifold",
        "EXT_structural_metadata",
        "CESIUM_primitive_outline",
        "OMI_",
        "KHR_technique",
        "KHR_materials_",
        "KHR_texture_",
        "KHR_xmp",
        "KHR_audio",
        "KHR_physics",
        "KHR_collision",
        "EXT_texture_",
        "EXT_materials_",
        "EXT_lights_",
        "MSFT_texture_",
        "MSFT_packing_",
        "ADOBE_materials_",
        "AGI_articulations",
        "VRMC_",
    ];
    READ.contains(&extension) || HARMLESS.iter().any(|prefix| extension.starts_with(prefix))
}

/// Whether a buffer only stands for what meshopt's decoder gives, and holds nothing: it says so, or all
/// that is seen of it is compressed.
fn is_fallback(root: &json::Root, index: usize, buffer: &json::Buffer) -> bool {
    let others = buffer.extensions.as_ref().map(|extensions| &extensions.others);
    let says = |name: &str| others?.get(name)?.get("fallback")?.as_bool();
    let mut views = root.buffer_views.iter().filter(|v| v.buffer.value() == index).peekable();
    meshopt::NAMES.iter().any(|name| says(name) == Some(true))
        || views.peek().is_some() && views.all(|view| meshopt::extension(view).is_some())
}

/// Gives accessors without data a sparse part without elements: they are zeros (glTF 2.0, 3.6.2.1), and
/// gltf 1.4 refuses them even where nothing names them.
fn zeros(root: &mut json::Root, buffers: &mut Buffers<'_>) {
    let is_bare = |a: &json::Accessor| a.buffer_view.is_none() && a.sparse.is_none();
    if !root.accessors.iter().any(is_bare) {
        return;
    }
    let buffer_view = add_view(root, buffers, Vec::new());
    let (byte_offset, component) = (USize64(0), IndexComponentType(ComponentType::U8));
    let indices = sparse::Indices {
        buffer_view,
        byte_offset,
        component_type: Checked::Valid(component),
        extensions: None,
        extras: json::Extras::default(),
    };
    let extras = json::Extras::default();
    let values = sparse::Values { buffer_view, byte_offset, extensions: None, extras };
    let (count, extras) = (USize64(0), json::Extras::default());
    let empty = sparse::Sparse { count, indices, values, extensions: None, extras };
    for accessor in root.accessors.iter_mut().filter(|a| is_bare(a)) {
        accessor.sparse = Some(empty.clone());
    }
}

/// The first buffer alone may be the GLB's binary chunk, which is borrowed, never copied.
fn read_buffers<'a>(
    place: &str,
    root: &json::Root,
    mut chunk: Option<Cow<'a, [u8]>>,
    budget: &mut Budget<'_>,
) -> Result<Buffers<'a>> {
    let mut buffers = Vec::with_capacity(root.buffers.len());
    for (i, buffer) in root.buffers.iter().enumerate() {
        let at = format!("{place}: buffers[{i}]");
        let bad = |reason: String| Error::bad_input(&at, reason, "export it again");
        let bytes = match buffer.uri.as_deref() {
            Some(uri) => Cow::Owned(budget.resource(&at, uri)?),
            None if is_fallback(root, i, buffer) => {
                buffers.push(Cow::Borrowed(&[][..]));
                continue;
            }
            None if i > 0 => {
                let reason = "has no URI, and only the first buffer may be the binary chunk";
                return Err(bad(reason.into()));
            }
            None => chunk.take().ok_or_else(|| bad("the GLB has no binary chunk".into()))?,
        };
        if (bytes.len() as u64) < buffer.byte_length.0 {
            let (held, said) = (bytes.len(), buffer.byte_length.0);
            return Err(bad(format!("holds {held} bytes, {said} are declared")));
        }
        buffers.push(bytes);
    }
    Ok(Buffers { all: buffers, most: budget.most_memory() / 16 })
}
