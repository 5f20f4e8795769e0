//! The shape of three.js' scene JSON (`Object3D.toJSON`, formats 4.3 to 4.7), as far as a shadow asks.

use serde::{Deserialize, Deserializer};
use serde_json::{Map, Value};
use std::collections::HashMap;

/// A whole file.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct File {
    pub(super) metadata: Metadata,
    pub(super) geometries: Vec<Geometry>,
    pub(super) materials: Vec<Material>,
    pub(super) object: Option<Node>,
}

/// What a file is.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Metadata {
    #[serde(rename = "type")]
    pub(super) kind: String,
}

/// A geometry: buffers, or the parameters that they are made from.
#[derive(Debug, Deserialize)]
pub(super) struct Geometry {
    pub(super) uuid: String,
    #[serde(rename = "type", default)]
    pub(super) kind: String,
    #[serde(default)]
    pub(super) data: Option<Buffers>,
    #[serde(flatten)]
    pub(super) parameters: Map<String, Value>,
}

/// The buffers of a geometry.
#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Buffers {
    pub(super) attributes: Attributes,
    pub(super) index: Option<Attribute>,
    pub(super) groups: Vec<Group>,
    pub(super) interleaved_buffers: HashMap<String, Interleaved>,
    pub(super) array_buffers: HashMap<String, Vec<u32>>,
    pub(super) morph_attributes: Option<serde::de::IgnoredAny>,
}

/// The attributes that a shadow asks for.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Attributes {
    pub(super) position: Option<Attribute>,
    pub(super) normal: Option<Attribute>,
    pub(super) uv: Option<Attribute>,
}

/// An attribute, or the instance matrices of a mesh.
#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Attribute {
    pub(super) item_size: usize,
    #[serde(rename = "type")]
    pub(super) kind: String,
    pub(super) array: Vec<Option<f64>>,
    pub(super) normalized: bool,
    pub(super) is_interleaved_buffer_attribute: bool,
    pub(super) data: String,
    pub(super) offset: usize,
}

/// A buffer that attributes share.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Interleaved {
    pub(super) buffer: String,
    #[serde(rename = "type")]
    pub(super) kind: String,
    pub(super) stride: usize,
}

/// Corners of a geometry that are drawn with one material.
#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Group {
    pub(super) start: usize,
    /// Infinite where it is null.
    pub(super) count: Option<f64>,
    pub(super) material_index: usize,
}

/// A material.
#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Material {
    pub(super) uuid: String,
    pub(super) name: String,
    #[serde(rename = "type")]
    pub(super) kind: String,
    pub(super) color: Option<u32>,
    pub(super) side: u8,
    pub(super) shadow_side: Option<u8>,
    pub(super) alpha_test: f64,
    pub(super) alpha_map: Option<String>,
    pub(super) map: Option<String>,
    pub(super) transparent: bool,
    pub(super) visible: Option<bool>,
    pub(super) wireframe: bool,
    pub(super) flat_shading: bool,
    pub(super) displacement_map: Option<String>,
    pub(super) clipping_planes: Option<serde::de::IgnoredAny>,
}

/// An object of the scene with its children.
#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Node {
    pub(super) uuid: String,
    #[serde(rename = "type")]
    pub(super) kind: String,
    pub(super) name: String,
    pub(super) cast_shadow: bool,
    pub(super) receive_shadow: bool,
    pub(super) visible: Option<bool>,
    pub(super) layers: Option<u32>,
    #[serde(deserialize_with = "matrix")]
    pub(super) matrix: Option<[f64; 16]>,
    #[serde(deserialize_with = "matrix")]
    pub(super) bind_matrix: Option<[f64; 16]>,
    pub(super) up: Option<[f64; 3]>,
    pub(super) geometry: Option<String>,
    pub(super) material: Option<Materials>,
    pub(super) children: Vec<Self>,
    pub(super) count: Option<usize>,
    pub(super) instance_matrix: Option<Attribute>,
    pub(super) morph_target_influences: Vec<Option<f64>>,
    // Lights.
    pub(super) distance: Option<f64>,
    pub(super) angle: Option<f64>,
    pub(super) target: Option<String>,
    pub(super) shadow: Option<Shadow>,
    // Cameras, of the scene and of lights.
    #[serde(flatten)]
    pub(super) lens: Lens,
}

/// One material, or one for each group.
#[derive(Debug, Deserialize)]
#[serde(untagged)]
pub(super) enum Materials {
    One(String),
    Each(Vec<String>),
}

/// A light's map.
#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Shadow {
    pub(super) intensity: Option<f64>,
    pub(super) bias: f64,
    pub(super) normal_bias: f64,
    pub(super) radius: Option<f64>,
    pub(super) map_size: Option<[f64; 2]>,
    pub(super) focus: Option<f64>,
    pub(super) aspect: Option<f64>,
    pub(super) camera: Lens,
}

/// A camera's own.
#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Lens {
    pub(super) fov: Option<f64>,
    pub(super) zoom: Option<f64>,
    pub(super) left: Option<f64>,
    pub(super) right: Option<f64>,
    pub(super) top: Option<f64>,
    pub(super) bottom: Option<f64>,
    pub(super) near: Option<f64>,
    pub(super) far: Option<f64>,
}

/// Sixteen numbers, column after column.
fn matrix<'de, D: Deserializer<'de>>(d: D) -> Result<Option<[f64; 16]>, D::Error> {
    let list = Vec::<f64>::deserialize(d)?;
    let count = list.len();
    let sixteen = list.try_into().map(Some);
    sixteen.map_err(|_| serde::de::Error::custom(format!("a matrix has {count} numbers, not 16")))
}
