//! Scenes and cases: objects, light, camera and the pipeline that a case fixes.

pub mod alpha;
mod builder;
pub mod cases;
pub mod chain;
mod disk;
pub mod filter;
pub mod matrix;
mod normals;
pub mod pipeline;
pub mod shapes;
mod surface;
mod surfaces;
mod tent;
pub mod texel;

use crate::camera::Camera;
use crate::device::DeviceProfile;
use crate::light::{Layout, Light, Map};
pub use builder::{CaseBuilder, LARGEST_SIDE};
pub use chain::{Matrices, MatrixChain, Stages};
pub use disk::TurnedDisk;
pub use filter::{Filter, FilterKernel};
use glam::{DMat4, DVec3, Mat4};
pub use pipeline::{CompareRule, CoordForm, Cull, CullRule, LookupSpec, MapSpec, Wrap};
pub use shapes::Mesh;
use std::sync::Arc;
pub use surface::{Sides, Surface};
pub use surfaces::{Culls, Surfaces};
pub use tent::AxisWeights;
pub use texel::{DepthBuffer, TexelFormat};

/// World-space triangles in f64: what truth and analysis call *the scene*. A triangle's index is
/// its id everywhere (maps, EXR channels, verdicts).
#[derive(Clone, Debug, Default)]
pub struct Geometry {
    /// World positions of the vertices as they were given, before any rounding to f32; exact where the
    /// model matrix only translates, else rounded to f64.
    pub positions: Vec<DVec3>,
    /// Vertex indices, counter-clockwise seen from the front.
    pub triangles: Vec<[u32; 3]>,
    /// Index of the object that each triangle belongs to.
    pub object: Vec<u16>,
    /// How they are there.
    pub surfaces: Arc<Surfaces>,
}

/// The id of no triangle: nothing was drawn.
pub const NO_TRIANGLE: u32 = u32::MAX;

impl Geometry {
    /// The three corners of triangle `id`.
    #[must_use]
    pub fn corners(&self, id: u32) -> [DVec3; 3] {
        self.triangles[id as usize].map(|v| self.positions[v as usize])
    }

    /// Normal of triangle `id` by the right-hand rule, not normalised: twice its area in length.
    #[must_use]
    pub fn area_normal(&self, id: u32) -> DVec3 {
        let [a, b, c] = self.corners(id);
        (b - a).cross(c - a)
    }
}

/// One mesh with its place in the world.
#[derive(Clone, Debug, PartialEq)]
pub struct Object {
    /// What reports call it.
    pub name: String,
    /// Its shape; instances of one mesh share it.
    pub mesh: Arc<Mesh>,
    /// World from model, f32 as uploaded.
    pub model: Mat4,
    /// How it is drawn.
    pub surface: Surface,
    /// The model matrix before it was rounded to f32, where somebody knows it.
    exact: Option<Box<DMat4>>,
    uploaded: Option<Box<Uploaded>>,
}

/// Matrices that came from outside and what they stand for.
#[derive(Clone, Debug, PartialEq)]
struct Uploaded {
    matrices: Matrices,
    of: (Map, Camera, Mat4),
}

impl Object {
    /// A mesh in the world, drawn on both sides, casting and receiving; its matrices are formed where a
    /// case is drawn.
    #[must_use]
    pub fn new(name: impl Into<String>, mesh: impl Into<Arc<Mesh>>, model: Mat4) -> Self {
        let surface = Surface::default();
        Self { name: name.into(), mesh: mesh.into(), model, surface, exact: None, uploaded: None }
    }

    /// This object where an f64 matrix places it: truth sees that place, the subject the matrix rounded to
    /// f32.
    #[must_use]
    pub fn placed(mut self, model: DMat4) -> Self {
        self.model = model.as_mat4();
        self.exact = Some(Box::new(model));
        self
    }

    /// World from model in f64: as it was given, unless `model` was changed since.
    #[must_use]
    pub fn exact_model(&self) -> DMat4 {
        let given = self.exact.as_deref().copied();
        given.filter(|exact| exact.as_mat4() == self.model).unwrap_or_else(|| self.model.as_dmat4())
    }

    /// This object, drawn in another way.
    #[must_use]
    pub fn with_surface(mut self, surface: Surface) -> Self {
        self.surface = surface;
        self
    }

    /// This object with matrices from outside, as a program uploads them for this map and camera; they
    /// hold as long as these and the model matrix stay what they are.
    #[must_use]
    pub fn with_uploaded(mut self, matrices: Matrices, map: &Map, camera: &Camera) -> Self {
        let of = (*map, *camera, self.model);
        self.uploaded = Some(Box::new(Uploaded { matrices, of }));
        self
    }

    /// The f32 matrices of this object under a chain, a map and a camera: formed from them, unless those
    /// from outside still stand for them and have all that the chain asks for.
    #[must_use]
    pub fn matrices(&self, chain: MatrixChain, map: &Map, camera: &Camera) -> Matrices {
        let of = (*map, *camera, self.model);
        let outside = self.uploaded.as_deref().filter(|u| u.of == of).and_then(|uploaded| {
            let named = uploaded.matrices.named();
            let get =
                |name: &str| named.iter().find(|(n, _)| *n == name).map(|(_, m)| *m).ok_or(());
            chain.read(get).ok()
        });
        outside.unwrap_or_else(|| chain.matrices(map, camera, &self.model))
    }
}

crate::catalogue! {
    /// How the document turns visibility into a colour.
    pub enum Shading {
        /// colour × (1 lit, 0.7 shadowed) (documents 000, 004).
        Tint = "tint",
        /// ambient + (diffuse + specular) · visibility (document 001).
        AmbientDiffuseSpecular = "ambient-diffuse-specular",
        /// colour · N·L · visibility inside the spot's cone (document 002).
        Lambert = "lambert",
        /// ambient + visibility · N·L · colour (document 003).
        AmbientLambert = "ambient-lambert",
    }
}

/// A known number of a case, with where it comes from.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Fact {
    /// What is known, as a name in `results.json`.
    pub quantity: &'static str,
    /// Its value.
    pub value: f64,
    /// The formula or document.
    pub source: &'static str,
}

/// A named system to be measured: geometry, light, camera, pipeline and bias.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// Stable name on the command line and in files.
    pub name: String,
    /// The document or derivation it comes from.
    pub document: String,
    /// Everything that is drawn.
    pub objects: Vec<Object>,
    /// The light with its maps.
    pub light: Light,
    /// The camera whose pixels are the receivers.
    pub camera: Camera,
    /// Width and height of the camera's picture in pixels.
    pub canvas: [u32; 2],
    /// How matrices multiply.
    pub chain: MatrixChain,
    /// How the light's maps are drawn and kept.
    pub map: MapSpec,
    /// How they are looked up.
    pub lookup: LookupSpec,
    /// Faces that the camera pass leaves out.
    pub camera_cull: Cull,
    /// The document's constant bias; positive repairs acne.
    pub bias: f32,
    /// How the document colours.
    pub shading: Shading,
    /// The implementation the case is measured on unless another is asked for.
    pub device: DeviceProfile,
    /// What the document leaves open and is fixed here.
    pub assumptions: Vec<String>,
    /// What was left out of the scene, or taken otherwise than its engine would, and can change a shadow,
    /// each as a sentence; told in the first lines of every answer.
    pub skipped: Vec<String>,
    /// Closed-form or printed facts.
    pub facts: Vec<Fact>,
}

impl Case {
    /// Where the texels of the light's maps lie.
    #[must_use]
    pub fn layout(&self) -> Layout {
        self.light.layout(self.map.size)
    }

    /// World-space triangles of all objects, in drawing order.
    #[must_use]
    pub fn geometry(&self) -> Geometry {
        let surfaces = Arc::new(Surfaces::of(&self.objects));
        let mut geometry = Geometry { surfaces, ..Geometry::default() };
        for (index, object) in self.objects.iter().enumerate() {
            let first = geometry.positions.len() as u32;
            let model = object.exact_model();
            let world = |v: usize| model.transform_point3(object.mesh.at(v));
            geometry.positions.extend((0..object.mesh.positions.len()).map(world));
            geometry.triangles.extend(object.mesh.triangles.iter().map(|t| t.map(|v| v + first)));
            let triangles = object.mesh.triangles.len();
            geometry.object.extend(std::iter::repeat_n(index as u16, triangles));
        }
        geometry
    }
}
