//! One map of a light: its eye, projection and clip space, its place in a texture, and its exact matrices.

use crate::view::{self, ClipSpace, Projection, View};
use crate::{Error, Result};
use glam::{DMat4, DVec2, DVec3, DVec4, Mat4};

/// A part of a texture: corners in parts of its longest side, so that a case can be drawn at any size.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Viewport {
    /// The texture: maps of one atlas share it, maps of an array have one each.
    pub layer: u16,
    /// Lowest corner (u, v).
    pub low: [u32; 2],
    /// Highest corner.
    pub high: [u32; 2],
    /// Parts of the longest side of a texture that the corners count.
    pub parts: u32,
}

impl Viewport {
    /// A square texture of its own.
    #[must_use]
    pub const fn whole(layer: u16) -> Self {
        Self { layer, low: [0; 2], high: [1; 2], parts: 1 }
    }

    /// A texture of its own of so many texels wide and high, in its shortest terms; at least one each.
    #[must_use]
    pub const fn rectangle(size: [u32; 2]) -> Self {
        let (mut a, mut b) = (size[0], size[1]);
        while b > 0 {
            (a, b) = (b, a % b);
        }
        let common = if a == 0 { 1 } else { a };
        let high = [size[0] / common, size[1] / common];
        let parts = if high[0] > high[1] { high[0] } else { high[1] };
        Self { layer: 0, low: [0; 2], high, parts }
    }
}

/// A map of a light. What its matrices are made of can be changed at will: they are formed where they are
/// asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Map {
    /// Where its eye is and looks.
    pub view: View,
    /// How it projects.
    pub projection: Projection,
    /// The conventions of its clip space.
    pub clip: ClipSpace,
    /// Where it is drawn.
    pub viewport: Viewport,
    /// A matrix that came from outside.
    uploaded: Option<Uploaded>,
}

/// A clip-from-world matrix from outside and what it stands for: it holds as long as these are the map's.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Uploaded {
    matrix: Mat4,
    of: (View, Projection, ClipSpace),
}

impl Map {
    /// A map in OpenGL's clip space on a square texture of its own.
    #[must_use]
    pub const fn new(view: View, projection: Projection) -> Self {
        let viewport = Viewport::whole(0);
        Self { view, projection, clip: ClipSpace::OPENGL, viewport, uploaded: None }
    }

    /// This map drawn into another part of a texture.
    #[must_use]
    pub fn on(self, viewport: Viewport) -> Self {
        Self { viewport, ..self }
    }

    /// This map whose program uploads `matrix`, clip from world, instead of the product of projection
    /// and view; dropped by itself where either changes.
    #[must_use]
    pub fn with_uploaded(mut self, matrix: Mat4) -> Self {
        self.uploaded = Some(Uploaded { matrix, of: (self.view, self.projection, self.clip) });
        self
    }

    /// The matrix from outside that still stands for this map.
    #[must_use]
    pub fn uploaded(&self) -> Option<Mat4> {
        let holds = |u: &Uploaded| u.of == (self.view, self.projection, self.clip);
        self.uploaded.filter(holds).map(|u| u.matrix)
    }

    /// The f32 projection and view that a program uploads; a matrix from outside is a projection after no
    /// view.
    #[must_use]
    pub fn matrices(&self) -> [Mat4; 2] {
        match self.uploaded() {
            Some(matrix) => [matrix, Mat4::IDENTITY],
            None => [
                self.projection.clip_from_view_in(self.clip).as_mat4(),
                self.view.view_from_world().as_mat4(),
            ],
        }
    }

    /// Checks view, projection, clip space and viewport.
    ///
    /// # Errors
    /// [`Error::BadInput`] naming `place` and the field.
    pub fn checked(self, place: &str) -> Result<Self> {
        self.view.checked(place)?;
        self.projection.checked(place)?;
        let Viewport { low, high, parts, .. } = self.viewport;
        let sound = |axis: usize| low[axis] < high[axis] && high[axis] <= parts;
        if !(sound(0) && sound(1)) {
            return Err(Error::bad_input(
                format!("{place}.viewport"),
                format!("{low:?} to {high:?} of {parts} is not a rectangle within the texture"),
                "give low < high <= parts",
            ));
        }
        Ok(self)
    }

    /// Exact-input clip matrix: f64 products of f64 matrices.
    #[must_use]
    pub fn clip_from_world(&self) -> DMat4 {
        view::product(&self.projection.clip_from_view_in(self.clip), &self.view.view_from_world())
    }

    /// Whether its rays are parallel.
    #[must_use]
    pub const fn is_orthographic(&self) -> bool {
        matches!(self.projection, Projection::Orthographic { .. })
    }

    /// Depth along the map's axis (distance from the eye's plane), world units.
    #[must_use]
    pub fn axial_distance(&self, p_world: DVec3) -> f64 {
        (self.view.position - p_world).dot(self.view.backward())
    }

    /// Edge length of one texel in world units at axial distance `distance`, for a map of `width` texels.
    #[must_use]
    pub fn texel_world(&self, width: u32, distance: f64) -> f64 {
        let scale = if self.is_orthographic() { 1.0 } else { distance };
        2.0 * self.projection.half_width() * scale / f64::from(width)
    }

    /// World distance along the axis at a compared depth ([`ClipSpace::compared`]).
    #[must_use]
    pub fn world_from_depth(&self, depth: f64) -> f64 {
        let (near, far) = self.projection.near_far();
        let depth = if self.clip.reversed { 1.0 + depth } else { depth };
        if self.is_orthographic() {
            near + depth * (far - near)
        } else if far.is_infinite() {
            near / (1.0 - depth)
        } else {
            near * far / (far - depth * (far - near))
        }
    }

    /// Compared depth per world unit along the axis at axial distance `z`.
    #[must_use]
    pub fn depth_per_world(&self, z: f64) -> f64 {
        let (near, far) = self.projection.near_far();
        if self.is_orthographic() {
            1.0 / (far - near)
        } else if far.is_infinite() {
            near / (z * z)
        } else {
            near * far / ((far - near) * z * z)
        }
    }
}

/// The exact matrices of a map, formed once for many points.
#[derive(Clone, Debug)]
pub struct Lens {
    /// The map.
    pub map: Map,
    /// Its clip matrix in f64.
    pub clip_from_world: DMat4,
    /// The inverse of that.
    pub world_from_clip: DMat4,
    /// Its width and height in texels.
    pub size: [u32; 2],
}

impl Lens {
    /// The matrices of a map of so many texels.
    #[must_use]
    pub fn new(map: &Map, size: [u32; 2]) -> Self {
        let clip_from_world = map.clip_from_world();
        Self { map: *map, clip_from_world, world_from_clip: clip_from_world.inverse(), size }
    }

    /// This map under other conventions.
    #[must_use]
    pub fn in_clip_space(&self, clip: ClipSpace) -> Self {
        let mut map = self.map;
        map.clip = clip;
        Self::new(&map, self.size)
    }

    /// Map coordinates u, v in [0, 1] and compared depth of a world point. f64; `None` behind the eye
    /// (w ≤ 0).
    #[must_use]
    pub fn look(&self, p_world: DVec3) -> Option<DVec3> {
        let clip: DVec4 = self.clip_from_world * p_world.extend(1.0);
        (clip.w > 0.0).then(|| self.map.clip.look(clip.truncate() / clip.w))
    }

    /// Whether map coordinates and compared depth lie within the map's volume.
    #[must_use]
    pub fn holds(&self, look: DVec3) -> bool {
        let [low, high] = self.map.clip.depths();
        let inside = |x: f64| (0.0..=1.0).contains(&x);
        inside(look.x) && inside(look.y) && (low..=high).contains(&look.z)
    }

    /// Map coordinates in texels.
    #[must_use]
    pub fn texels(&self, uv: DVec2) -> DVec2 {
        uv * DVec2::new(f64::from(self.size[0]), f64::from(self.size[1]))
    }

    /// Where the light's ray through map coordinates crosses the near plane, and a point far beyond: on the
    /// far plane where there is one, else at 2²⁰ near distances.
    #[must_use]
    pub fn ray(&self, uv: DVec2) -> [DVec3; 2] {
        let ndc = uv * 2.0 - 1.0;
        let [near, far] = self.map.clip.ends(&self.map.projection);
        [near, far].map(|z| self.world_from_clip.project_point3(ndc.extend(z)))
    }

    /// Compared depth of the plane through `p` with this normal per unit of u and v: the plane in clip
    /// space is the transposed inverse of the matrix times the plane. Infinite where it is seen edge-on.
    #[must_use]
    pub fn gradient(&self, normal: DVec3, p: DVec3) -> DVec2 {
        let plane = normal.extend(-normal.dot(p));
        let clip = self.world_from_clip.transpose() * plane;
        DVec2::new(-clip.x / clip.z, -clip.y / clip.z) * self.map.clip.steepness()
    }

    /// What a bias may know of the map at a point: texel edge and compared depth per world unit.
    #[must_use]
    pub fn scales(&self, p_world: DVec3) -> [f64; 2] {
        let z = self.map.axial_distance(p_world);
        [self.map.texel_world(self.size[0], z), self.map.depth_per_world(z)]
    }
}
