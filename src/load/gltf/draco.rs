//! `KHR_draco_mesh_compression`: primitives decoded into buffers of their own, before the document is read.

use super::super::files::Budget;
use super::buffers::{Buffers, add_view};
use draco_core::{
    DataType, DecodeLimits, DecoderBuffer, Mesh, MeshDecoder, PointAttribute, PointIndex,
};
use gltf::json::accessor::{ComponentType, GenericComponentType, Type};
use gltf::json::validation::{Checked, USize64};
use gltf::json::{self, Index};
use gnomon_core::{Error, Result};
use serde_json::Value;
use std::collections::HashMap;

const NAME: &str = "KHR_draco_mesh_compression";

/// Decodes every compressed primitive and points it to what came out. One that the file also holds
/// uncompressed is left as it is.
pub(super) fn unpack(
    place: &str,
    root: &mut json::Root,
    buffers: &mut Buffers<'_>,
    budget: &Budget<'_>,
) -> Result<()> {
    // Primitives may share one stream, and parts of it.
    let mut decoded: HashMap<u64, Mesh> = HashMap::new();
    for m in 0..root.meshes.len() {
        let count = root.meshes.get(m).map_or(0, |mesh| mesh.primitives.len());
        for p in 0..count {
            let at = format!("{place}: meshes[{m}].primitives[{p}].{NAME}");
            let Some(primitive) = root.meshes.get(m).and_then(|mesh| mesh.primitives.get(p)) else {
                continue;
            };
            let Some(extension) = extension(primitive).cloned() else { continue };
            if has_own_data(root, primitive) {
                continue;
            }
            let mut primitive = primitive.clone();
            let view = extension.get("bufferView").and_then(Value::as_u64).unwrap_or(u64::MAX);
            let mesh = match decoded.entry(view) {
                std::collections::hash_map::Entry::Occupied(known) => known.into_mut(),
                std::collections::hash_map::Entry::Vacant(new) => {
                    new.insert(decode(&at, stream(root, buffers, view), budget)?)
                }
            };
            let attributes = extension.get("attributes").and_then(Value::as_object);
            let mut out = Unpacked { at: &at, root, buffers };
            out.point(&mut primitive, mesh, attributes)?;
            let place = root.meshes.get_mut(m).and_then(|mesh| mesh.primitives.get_mut(p));
            place.into_iter().for_each(|to| *to = primitive.clone());
        }
    }
    Ok(())
}

fn extension(primitive: &json::mesh::Primitive) -> Option<&Value> {
    primitive.extensions.as_ref()?.others.get(NAME)
}

/// Whether all accessors of a primitive have data without the extension.
fn has_own_data(root: &json::Root, primitive: &json::mesh::Primitive) -> bool {
    let accessors = primitive.attributes.values().copied().chain(primitive.indices);
    let mut data = accessors.map(|a| {
        root.accessors.get(a.value()).is_some_and(|a| a.buffer_view.is_some() || a.sparse.is_some())
    });
    data.all(|has| has)
}

/// The bytes of a buffer view.
fn stream<'b>(root: &json::Root, buffers: &'b Buffers<'_>, view: u64) -> Option<&'b [u8]> {
    let view = root.buffer_views.get(usize::try_from(view).ok()?)?;
    let offset = view.byte_offset.map_or(0, |offset| offset.0);
    buffers.range(view.buffer.value(), offset, view.byte_length.0)
}

fn decode(at: &str, stream: Option<&[u8]>, budget: &Budget<'_>) -> Result<Mesh> {
    let fix = "decode it with `gltf-transform copy`, or export it again";
    let bad = |reason: String| Error::bad_input(at, reason, fix);
    let stream = stream.ok_or_else(|| bad("its buffer view is not there".into()))?;
    let most = budget.most_memory();
    let limits = DecodeLimits::default()
        .with_max_points(most / 64)
        .with_max_faces(most / 64)
        .with_max_decoded_bytes(most / 2);
    let (mut mesh, mut buffer) = (Mesh::new(), DecoderBuffer::new(stream).with_limits(limits));
    let decoded = MeshDecoder::new().decode(&mut buffer, &mut mesh);
    decoded.map_err(|e| bad(format!("is no usable Draco stream ({e})")))?;
    Ok(mesh)
}

/// The document and buffers that decoded data is added to.
struct Unpacked<'u, 'b> {
    at: &'u str,
    root: &'u mut json::Root,
    buffers: &'u mut Buffers<'b>,
}

impl Unpacked<'_, '_> {
    /// Gives a primitive the indices and attributes of a decoded mesh.
    fn point(
        &mut self,
        primitive: &mut json::mesh::Primitive,
        mesh: &Mesh,
        attributes: Option<&serde_json::Map<String, Value>>,
    ) -> Result<()> {
        let bad = |reason: String| Error::bad_input(self.at, reason, super::accessor::AGAIN);
        let corners = mesh.faces().iter().flatten();
        let indices: Vec<u8> = corners.flat_map(|point| point.0.to_le_bytes()).collect();
        let mut columns = Vec::new();
        for (semantic, old) in &primitive.attributes {
            let Checked::Valid(name) = semantic else { continue };
            let Some(id) = attributes.and_then(|a| a.get(&name.to_string())) else { continue };
            let id = id.as_u64().and_then(|id| u32::try_from(id).ok());
            let attribute = id.and_then(|id| mesh.attribute_by_unique_id(id));
            let attribute = attribute
                .ok_or_else(|| bad(format!("its {} is not in the stream", name.to_string())))?;
            let (bytes, component) = column(attribute, mesh.num_points())
                .ok_or_else(|| bad(format!("its {} is not as glTF has it", name.to_string())))?;
            columns.push((semantic.clone(), *old, bytes, component));
        }
        for (semantic, old, bytes, component) in columns {
            let Some(old) = self.root.accessors.get(old.value()) else { continue };
            let new = json::Accessor {
                component_type: Checked::Valid(GenericComponentType(component)),
                ..old.clone()
            };
            let accessor = self.accessor(bytes, mesh.num_points(), new);
            primitive.attributes.insert(semantic, accessor);
        }
        let template = json::Accessor {
            buffer_view: None,
            byte_offset: None,
            count: USize64(0),
            component_type: Checked::Valid(GenericComponentType(ComponentType::U32)),
            extensions: None,
            extras: json::Extras::default(),
            type_: Checked::Valid(Type::Scalar),
            min: None,
            max: None,
            name: None,
            normalized: false,
            sparse: None,
        };
        primitive.indices = Some(self.accessor(indices, mesh.num_faces() * 3, template));
        primitive.mode = Checked::Valid(json::mesh::Mode::Triangles);
        Ok(())
    }

    /// An accessor like `template` over bytes of its own.
    fn accessor(
        &mut self,
        bytes: Vec<u8>,
        count: usize,
        template: json::Accessor,
    ) -> Index<json::Accessor> {
        let view = add_view(self.root, self.buffers, bytes);
        let count = USize64(count as u64);
        let accessor = json::Accessor {
            buffer_view: Some(view),
            byte_offset: None,
            sparse: None,
            count,
            ..template
        };
        Index::push(&mut self.root.accessors, accessor)
    }
}

/// The values of an attribute, one for each point, with what glTF calls their numbers; `None` where a
/// value is not there, or of a kind that glTF does not have.
fn column(attribute: &PointAttribute, points: usize) -> Option<(Vec<u8>, ComponentType)> {
    let component = match attribute.data_type() {
        DataType::Int8 => ComponentType::I8,
        DataType::Uint8 => ComponentType::U8,
        DataType::Int16 => ComponentType::I16,
        DataType::Uint16 => ComponentType::U16,
        DataType::Uint32 => ComponentType::U32,
        DataType::Float32 => ComponentType::F32,
        DataType::Invalid
        | DataType::Int32
        | DataType::Int64
        | DataType::Uint64
        | DataType::Float64
        | DataType::Bool => return None,
    };
    let size = usize::from(attribute.num_components()) * attribute.data_type().byte_length();
    let (stride, data) =
        (usize::try_from(attribute.byte_stride()).ok()?, attribute.buffer().data());
    let mut bytes = Vec::with_capacity(points.checked_mul(size)?);
    for point in 0..u32::try_from(points).ok()? {
        let value = attribute.mapped_index(PointIndex(point)).0 as usize;
        let start = value.checked_mul(stride)?;
        bytes.extend_from_slice(data.get(start..start.checked_add(size)?)?);
    }
    Some((bytes, component))
}
