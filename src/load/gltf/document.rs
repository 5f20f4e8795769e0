//! A glTF document with its buffers, checked and unpacked before anything is read from it.

use super::super::files::Budget;
use super::nodes::Placed;
use super::{draco, meshopt};
use gltf::json;
use gltf::json::accessor::{ComponentType, IndexComponentType, sparse};
use gltf::json::validation::{Checked, USize64};
use gnomon_core::{Error, Result};
use std::borrow::Cow;

/// Bytes that an object of the JSON takes once it is parsed.
const OBJECT: u64 = 1024;

/// The buffers of a document; those of a GLB are borrowed from the file.
pub(super) struct Buffers<'a> {
    all: Vec<Cow<'a, [u8]>>,
    /// Bytes that values which are in no buffer may take.
    pub(super) most: u64,
}

impl<'a> Buffers<'a> {
    /// The bytes of a buffer; none where there is no such one.
    pub(super) fn of(&self, index: usize) -> &[u8] {
        self.all.get(index).map_or(&[], |bytes| bytes)
    }

    fn push(&mut self, bytes: Vec<u8>) {
        self.all.push(Cow::Owned(bytes));
    }

    /// The part of a buffer that a view shows, or that an extension of it names.
    pub(super) fn range(&self, buffer: usize, offset: u64, length: u64) -> Option<&[u8]> {
        let (start, end) = (usize::try_from(offset).ok()?, offset.checked_add(length)?);
        self.of(buffer).get(start..usize::try_from(end).ok()?)
    }
}

/// A checked document: nothing in it is compressed any more.
pub(super) struct File<'a> {
    pub(super) document: gltf::Document,
    pub(super) buffers: Buffers<'a>,
    /// Transforms of the nodes as the JSON has them, in f64.
    pub(super) nodes: Vec<Placed>,
}

/// Parses a `.gltf` or `.glb`, reads its buffers and unpacks what is compressed.
pub(super) fn parse<'a>(place: &str, bytes: &'a [u8], budget: &mut Budget<'_>) -> Result<File<'a>> {
    budget.memory(place, json_need(bytes))?;
    let unusable = |e: String| {
        Error::bad_input(place, format!("is no usable glTF 2.0 ({e})"), "export it again")
    };
    let (text, chunk) = chunks(bytes).map_err(unusable)?;
    let mut root = json::Root::from_slice(&text).map_err(|e| match is_first(&text) {
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
    Ok(File { document, buffers, nodes })
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
    const READ: [&str; 8] = [
        "KHR_mesh_quantization",
        "KHR_lights_punctual",
        "KHR_draco_mesh_compression",
        "EXT_meshopt_compression",
        "KHR_meshopt_compression",
        "EXT_mesh_gpu_instancing",
        "KHR_node_visibility",
        "KHR_animation_pointer",
    ];
    const HARMLESS: [&str; 15] = [
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

/// Adds bytes as a buffer of their own under a view of all of them.
pub(super) fn add_view(
    root: &mut json::Root,
    buffers: &mut Buffers<'_>,
    bytes: Vec<u8>,
) -> json::Index<json::buffer::View> {
    let byte_length = USize64(bytes.len() as u64);
    // The file's own buffers and these are numbered alike.
    let extras = json::Extras::default;
    buffers.push(bytes);
    let buffer =
        json::Buffer { byte_length, name: None, uri: None, extensions: None, extras: extras() };
    let view = json::buffer::View {
        buffer: json::Index::push(&mut root.buffers, buffer),
        byte_length,
        byte_offset: None,
        byte_stride: None,
        name: None,
        target: None,
        extensions: None,
        extras: extras(),
    };
    json::Index::push(&mut root.buffer_views, view)
}
