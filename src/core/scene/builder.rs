//! A case of a guest's own: meshes, light and camera, checked; all else has a default.

use super::{
    Case, CompareRule, CoordForm, Cull, CullRule, DepthBuffer, Filter, LookupSpec, MapSpec,
    MatrixChain, Mesh, Object, Shading, Surface, TexelFormat, Wrap,
};
use crate::camera::Camera;
use crate::depth::DepthFormat;
use crate::device::DeviceProfile;
use crate::light::Light;
use crate::{Error, Result};
use glam::Mat4;
use std::sync::Arc;

/// Largest map side and canvas side: 2²⁶ texels.
pub const LARGEST_SIDE: u32 = 8192;

/// Builds a [`Case`] from meshes, a light and a camera, and checks it.
///
/// Unless it is told otherwise: a picture of 512×512 pixels, a map of 2048² 32-bit floats, nothing
/// culled, NEAREST look-ups compared by z > D + b, no bias, the ideal device.
///
/// ```
/// use glam::{DVec3, Mat4, Vec3};
/// use gnomon_core::camera::Camera;
/// use gnomon_core::light::Light;
/// use gnomon_core::scene::{CaseBuilder, shapes};
/// use gnomon_core::view::{Projection, View};
///
/// let looking = |position| View { position, target: DVec3::ZERO, up: DVec3::Z };
/// let sun = Projection::Orthographic { width: 12.0, height: 12.0, near: 1.0, far: 30.0 };
/// let eye = Projection::Perspective { fovy_degrees: 45.0, aspect: 1.0, near: 0.1, far: 100.0 };
/// let light = Light::new(looking(DVec3::new(6.0, 12.0, 3.0)), sun, None);
/// let camera = Camera { view: looking(DVec3::new(0.0, 8.0, 8.0)), projection: eye };
///
/// let floor = shapes::floor(8.0, Vec3::ONE);
/// let case = CaseBuilder::new("mine", light.clone(), camera).mesh("floor", floor.clone()).build().unwrap();
/// assert_eq!(case.geometry().triangles.len(), 2);
///
/// let mut broken = floor;
/// broken.positions[2].y = f32::NAN;
/// let error = CaseBuilder::new("mine", light, camera).mesh("floor", broken).build().unwrap_err();
/// assert!(error.to_string().starts_with("mine: object 'floor', vertex 2: "));
/// ```
#[derive(Clone, Debug)]
pub struct CaseBuilder {
    case: Case,
}

impl CaseBuilder {
    /// A case without objects.
    #[must_use]
    pub fn new(name: impl Into<String>, light: Light, camera: Camera) -> Self {
        let map = MapSpec {
            size: 2048,
            texel: TexelFormat::Depth(DepthFormat::F32),
            clear: [1.0; 4],
            depth_buffer: DepthBuffer::Texture,
            cull: CullRule::None,
        };
        let lookup = LookupSpec {
            coord: CoordForm::Divide,
            compare: CompareRule::ReceiverBeyond,
            range_test: true,
            filter: Filter::Nearest,
            wrap: Wrap::Clamp,
        };
        let case = Case {
            name: name.into(),
            document: "a guest's case".to_string(),
            objects: Vec::new(),
            light,
            camera,
            canvas: [512, 512],
            chain: MatrixChain::World,
            map,
            lookup,
            camera_cull: Cull::None,
            bias: 0.0,
            shading: Shading::AmbientLambert,
            device: DeviceProfile::Ideal,
            assumptions: Vec::new(),
            skipped: Vec::new(),
            facts: Vec::new(),
        };
        Self { case }
    }

    /// One mesh more, where it stands.
    #[must_use]
    pub fn mesh(self, name: impl Into<String>, mesh: impl Into<Arc<Mesh>>) -> Self {
        self.placed(name, mesh, Mat4::IDENTITY)
    }

    /// One mesh more, moved by world from model.
    #[must_use]
    pub fn placed(
        mut self,
        name: impl Into<String>,
        mesh: impl Into<Arc<Mesh>>,
        model: Mat4,
    ) -> Self {
        self.case.objects.push(Object::new(name, mesh, model));
        self
    }

    /// How the last mesh is drawn: its sides and holes, whether it casts and receives. Without a mesh
    /// nothing changes.
    #[must_use]
    pub fn surface(mut self, surface: Surface) -> Self {
        if let Some(last) = self.case.objects.last_mut() {
            last.surface = surface;
        }
        self
    }

    /// Width and height of the camera's picture, pixels.
    #[must_use]
    pub const fn canvas(mut self, canvas: [u32; 2]) -> Self {
        self.case.canvas = canvas;
        self
    }

    /// The map's side and what a texel of it holds.
    #[must_use]
    pub fn map(mut self, size: u32, texel: TexelFormat) -> Self {
        self.case.map = self.case.map.with(size, texel);
        self
    }

    /// Which faces are left out of the map: of every object alike, or by its material.
    #[must_use]
    pub fn cull(mut self, cull: impl Into<CullRule>) -> Self {
        self.case.map.cull = cull.into();
        self
    }

    /// How the map is looked up.
    #[must_use]
    pub const fn lookup(mut self, lookup: LookupSpec) -> Self {
        self.case.lookup = lookup;
        self
    }

    /// The constant bias, window depth; positive repairs acne.
    #[must_use]
    pub const fn bias(mut self, bias: f32) -> Self {
        self.case.bias = bias;
        self
    }

    /// The device that it is measured on.
    #[must_use]
    pub const fn device(mut self, device: DeviceProfile) -> Self {
        self.case.device = device;
        self
    }

    /// The case, checked.
    ///
    /// # Errors
    /// [`Error::BadInput`] with the place: see [`Case::check`].
    pub fn build(self) -> Result<Case> {
        self.case.check()?;
        Ok(self.case)
    }
}

impl Case {
    /// Checks all that a case is measured by.
    ///
    /// # Errors
    /// [`Error::BadInput`] with the place: no triangle, too many objects, a vertex or model that is not
    /// finite, an index beyond the vertices, an eye that looks nowhere, an impossible projection, size or
    /// bias.
    pub fn check(&self) -> Result<()> {
        let bad = |place: String, reason: String, fix: &str| {
            Err(Error::bad_input(format!("{}: {place}", self.name), reason, fix))
        };
        if self.objects.len() > usize::from(u16::MAX) {
            let reason = format!("{} are more than {}", self.objects.len(), u16::MAX);
            return bad("objects".into(), reason, "join some of them");
        }
        if self.objects.iter().all(|object| object.mesh.triangles.is_empty()) {
            return bad("objects".into(), "hold no triangle".into(), "add a mesh");
        }
        for object in &self.objects {
            if let Some((part, reason, fix)) = fault(object) {
                return bad(format!("object '{}', {part}", object.name), reason, fix);
            }
        }
        let place = format!("{}: light", self.name);
        self.light.eye().checked(&place)?;
        for map in self.light.maps() {
            map.checked(&place)?;
        }
        self.camera.view.checked(&format!("{}: camera", self.name))?;
        self.camera.projection.checked(&format!("{}: camera", self.name))?;
        let sides =
            [("map.size", self.map.size), ("canvas", self.canvas[0]), ("canvas", self.canvas[1])];
        for (place, side) in sides {
            if !(1..=LARGEST_SIDE).contains(&side) {
                let reason = format!("{side} is not from 1 to {LARGEST_SIDE}");
                return bad(place.into(), reason, "give another size");
            }
        }
        if !self.bias.is_finite() {
            return bad("bias".into(), format!("{} is not finite", self.bias), "give a number");
        }
        match self.light.cone_cos() {
            Some(c) if !(-1.0..=1.0).contains(&c) => {
                bad("light.cone_cos".into(), format!("{c} is no cosine"), "give -1 to 1")
            }
            Some(_) | None => Ok(()),
        }
    }
}

/// What is wrong about an object: the part, the reason, what to do.
fn fault(object: &Object) -> Option<(String, String, &'static str)> {
    let mesh = &object.mesh;
    if !object.model.is_finite() {
        return Some(("model".into(), "has a number that is not finite".into(), "give numbers"));
    }
    let lost = |p: &glam::Vec3| !object.model.transform_point3(*p).is_finite();
    if let Some(v) = mesh.positions.iter().position(lost) {
        let reason = format!("{} is not finite in the world", mesh.positions[v]);
        return Some((format!("vertex {v}"), reason, "give finite positions"));
    }
    let normals = mesh.normals.len();
    if normals > 0 && normals != mesh.positions.len() {
        let reason = format!("{normals} for {} vertices", mesh.positions.len());
        return Some(("normals".into(), reason, "give one for each vertex, or none"));
    }
    if let Some(v) = mesh.normals.iter().position(|n| !n.is_finite()) {
        let reason = format!("{} is not finite", mesh.normals[v]);
        return Some((format!("normal {v}"), reason, "give finite normals"));
    }
    let count = mesh.positions.len() as u64;
    let beyond = |t: &[u32; 3]| t.iter().any(|&v| u64::from(v) >= count);
    let t = mesh.triangles.iter().position(beyond)?;
    let reason = format!("{:?} names a vertex beyond the {count}", mesh.triangles[t]);
    Some((format!("triangle {t}"), reason, "give indices below the number of vertices"))
}
