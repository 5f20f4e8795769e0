//! A glTF under construction: JSON to be edited, and a buffer that accessors are added to.

use serde_json::{Value, json};

/// A document of one buffer.
#[derive(Clone)]
pub(crate) struct Gltf {
    /// All of it but the buffer.
    pub(crate) json: Value,
    binary: Vec<u8>,
}

impl Gltf {
    /// A unit square at y = 1, seen from above: one node, one mesh, one primitive, accessor 0.
    pub(crate) fn square() -> Self {
        let json = json!({
            "asset": { "version": "2.0" }, "scenes": [{ "nodes": [0] }], "nodes": [{ "mesh": 0 }],
            "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "mode": 5 }] }],
            "accessors": [], "bufferViews": [],
        });
        let mut gltf = Self { json, binary: Vec::new() };
        let corners = [[0.0, 1.0, 1.0], [1.0, 1.0, 1.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]];
        let positions = gltf.floats("VEC3", &corners);
        gltf.json["accessors"][positions]["min"] = json!([0, 1, 0]);
        gltf.json["accessors"][positions]["max"] = json!([1, 1, 1]);
        gltf
    }

    /// The first primitive of the first mesh.
    pub(crate) fn primitive(&mut self) -> &mut Value {
        &mut self.json["meshes"][0]["primitives"][0]
    }

    /// One accessor more over bytes of its own, with more members; gives its number.
    pub(crate) fn accessor(
        &mut self,
        bytes: &[u8],
        count: usize,
        kind: &str,
        component: u32,
        more: Value,
        stride: Option<u32>,
    ) -> usize {
        let offset = self.binary.len().next_multiple_of(4);
        self.binary.resize(offset, 0);
        self.binary.extend_from_slice(bytes);
        let views = self.json["bufferViews"].as_array_mut().unwrap();
        let mut view = json!({ "buffer": 0, "byteOffset": offset, "byteLength": bytes.len() });
        if let Some(stride) = stride {
            view["byteStride"] = json!(stride);
        }
        views.push(view);
        let mut accessor = json!({ "bufferView": views.len() - 1, "componentType": component,
            "count": count, "type": kind });
        accessor.as_object_mut().unwrap().extend(more.as_object().unwrap().clone());
        let accessors = self.json["accessors"].as_array_mut().unwrap();
        accessors.push(accessor);
        accessors.len() - 1
    }

    /// One accessor of floats more; gives its number.
    pub(crate) fn floats<const N: usize>(&mut self, kind: &str, rows: &[[f32; N]]) -> usize {
        self.rows(kind, &rows.iter().map(|row| row.to_vec()).collect::<Vec<_>>())
    }

    /// [`Gltf::floats`] of rows of any length.
    pub(crate) fn rows(&mut self, kind: &str, rows: &[Vec<f32>]) -> usize {
        let bytes: Vec<u8> = rows.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
        self.accessor(&bytes, rows.len(), kind, 5126, json!({}), None)
    }

    /// The file, its buffer as a data URI.
    pub(crate) fn bytes(&self) -> Vec<u8> {
        use base64::Engine as _;
        let uri = base64::engine::general_purpose::STANDARD.encode(&self.binary);
        let uri = format!("data:application/octet-stream;base64,{uri}");
        let mut json = self.json.clone();
        json["buffers"] = json!([{ "byteLength": self.binary.len(), "uri": uri }]);
        json.to_string().into_bytes()
    }
}
