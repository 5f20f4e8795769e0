//! The subject's rasteriser: clip-space triangles → for each texel the winning triangle and its depth.
//!
//! Coverage is exact integer arithmetic on snapped vertices. The depth test keeps the first fragment
//! with the smallest depth key (LESS); encoding comes after it, so that one raster serves every
//! format whose encode is monotone.
//!
//! [`draw_each`] draws triangle by triangle as this reads. [`draw`] gives the same bits by tiles, on
//! all threads, several triangles and pixels at a time.

mod batch;
mod bins;
mod clip;
mod cut;
mod fragments;
mod literal;
pub mod passes;
mod plane;
pub mod probe;
mod slots;
mod test;
mod texels;
mod tile;
mod tiles;
mod triangle;

use crate::depth::DepthFormat;
use crate::device::{Device, OffsetUnit, SlopeNorm};
pub use crate::scene::NO_TRIANGLE;
use crate::scene::{Cull, Culls, Surfaces};
use crate::shadow::Drawn;
pub use crate::shadow::bias::PolygonOffset;
use crate::view::ClipSpace;
pub use fragments::{Fragments, Layer, Resolve};
use glam::{DVec3, Vec4};
pub use literal::{draw_each, draw_each_of};
pub use plane::{Interpolator, Plane, Row, Varyings};
pub use slots::Slots;
pub use texels::TexelSet;
pub use tiles::{draw, draw_at, draw_into, draw_of, quickest};
pub use triangle::Projected;

/// What a pass draws into.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pass {
    /// Width and height in texels.
    pub size: [u32; 2],
    /// Faces left out, of every triangle for which nothing else is said ([`Triangles::culls`]).
    pub cull: Cull,
    /// Format of the depth attachment whose codes are compared.
    pub depth_buffer: DepthFormat,
    /// Caster-side offset; positive moves away from the light in any clip space.
    pub offset: PolygonOffset,
    /// The conventions of the vertices' clip space.
    pub clip: ClipSpace,
}

impl Pass {
    /// Faces to be left out, by their turn on the screen, which is another where y looks down.
    #[must_use]
    pub const fn on_screen(&self, cull: Cull) -> Cull {
        if self.clip.y_down { cull.turned() } else { cull }
    }
}

/// What a pass draws.
#[derive(Clone, Copy, Debug)]
pub struct Triangles<'a> {
    /// Vertices in clip space.
    pub clip: &'a [Vec4],
    /// The vertices of each triangle, in drawing order.
    pub corners: &'a [[u32; 3]],
    /// Faces left out of each triangle, or all of it, where they do not agree; else those of the pass.
    pub culls: Option<&'a [Option<Cull>]>,
    /// Where they have holes; `None` where none has any.
    pub holes: Option<&'a Surfaces>,
}

impl<'a> Triangles<'a> {
    /// Triangles that are all drawn alike.
    #[must_use]
    pub const fn alike(clip: &'a [Vec4], corners: &'a [[u32; 3]]) -> Self {
        Self { clip, corners, culls: None, holes: None }
    }

    /// These triangles with the holes of their surfaces.
    #[must_use]
    pub fn with_holes(self, surfaces: &'a Surfaces) -> Self {
        Self { holes: surfaces.have_holes().then_some(surfaces), ..self }
    }

    /// These triangles drawn as `culls` says, and the pass that goes with them.
    #[must_use]
    pub fn under(self, pass: Pass, culls: &'a Culls) -> (Pass, Self) {
        match culls {
            Culls::Alike(cull) => (Pass { cull: *cull, ..pass }, self),
            Culls::Each(each) => (pass, Self { culls: Some(each), ..self }),
        }
    }

    /// The faces of a triangle that a pass leaves out, by their turn on the screen; `None` where it is not
    /// drawn at all.
    #[inline(always)]
    fn screen_cull(&self, pass: &Pass, id: u32) -> Option<Cull> {
        match self.culls {
            None => Some(pass.on_screen(pass.cull)),
            Some(culls) => culls[id as usize].map(|cull| pass.on_screen(cull)),
        }
    }
}

/// What a pass wrote, row by row from the bottom.
#[derive(Clone, Debug, PartialEq)]
pub struct Raster {
    /// Width and height.
    pub size: [u32; 2],
    /// `gl_FragCoord.z` of the winning fragment; where there is none 1, or 0 under reversed depth.
    pub depth: Vec<f32>,
    /// Its triangle, or [`NO_TRIANGLE`].
    pub triangle: Vec<u32>,
    /// Triangles that covered nothing (culled, without area, between pixel centres, clipped away).
    pub empty_triangles: u64,
}

impl Raster {
    const fn of_nothing(size: [u32; 2]) -> Self {
        Self { size, depth: Vec::new(), triangle: Vec::new(), empty_triangles: 0 }
    }

    /// What a map is stored from.
    #[must_use]
    pub fn drawn(&self) -> Drawn<'_> {
        Drawn { depth: &self.depth, triangle: &self.triangle }
    }
}

/// A triangle ready to be drawn.
#[derive(Clone, Copy, Debug)]
pub struct Setup {
    projected: Projected,
    depth: Plane,
    clip: ClipSpace,
}

impl Setup {
    /// Projects, snaps and sets up one triangle in OpenGL's clip space.
    #[must_use]
    pub fn new(device: &Device, size: [u32; 2], corners: [Vec4; 3]) -> Self {
        Self::in_space(device, size, ClipSpace::OPENGL, corners)
    }

    /// This raster in any clip space.
    #[must_use]
    pub fn in_space(device: &Device, size: [u32; 2], clip: ClipSpace, corners: [Vec4; 3]) -> Self {
        let projected = Projected::new(device, size, clip.range, corners);
        Self { projected, depth: plane::depth_plane(device, &projected), clip }
    }

    /// The window depth plane, without offset.
    #[must_use]
    pub const fn depth(&self) -> &Plane {
        &self.depth
    }

    /// The largest depth slope m per texel, in the device's norm.
    #[must_use]
    pub fn max_slope(&self, device: &Device) -> f32 {
        let [dx, dy] = self.depth.gradient();
        match device.slope_norm {
            SlopeNorm::Max => dx.abs().max(dy.abs()),
            SlopeNorm::Euclid => (dx * dx + dy * dy).sqrt(),
        }
    }

    /// The depth whose exponent makes the unit r of a float depth buffer: the largest |z| of the corners,
    /// or what the measured implementation takes for it.
    #[must_use]
    pub fn reference_depth(&self, device: &Device) -> f32 {
        if device.offset_unit == OffsetUnit::Measured {
            return plane::measured_reference(&self.projected);
        }
        let scale = self.clip.range.scale();
        let depths = self.projected.clip.map(|v| (v.z / v.w * scale + (1.0 - scale)).abs());
        depths.into_iter().fold(0.0, f32::max)
    }

    /// The unit r of a constant offset in a depth buffer of `format`: [`Device::resolvable`] of this
    /// triangle.
    #[must_use]
    pub fn resolvable(&self, device: &Device, format: DepthFormat) -> f32 {
        device.resolvable(format, self.reference_depth(device))
    }

    /// The offset of this triangle in a depth buffer of `format`, f32; positive away from the light.
    #[must_use]
    pub fn offset(&self, device: &Device, format: DepthFormat, offset: PolygonOffset) -> f32 {
        if offset.factor == 0.0 && offset.units == 0.0 {
            return 0.0;
        }
        offset.value(self.max_slope(device), self.resolvable(device, format))
    }

    /// The window depth plane under an offset, which lowers reversed depths.
    #[must_use]
    #[inline(always)]
    pub fn offset_depth(
        &self,
        device: &Device,
        format: DepthFormat,
        offset: PolygonOffset,
    ) -> Plane {
        self.depth.moved(self.clip.compared(self.offset(device, format, offset)))
    }

    /// Whether the triangle's front is seen: counter-clockwise on a screen whose y looks up.
    #[must_use]
    pub fn is_front(&self) -> bool {
        let area = self.projected.area();
        if self.clip.y_down { area < 0 } else { area > 0 }
    }

    /// The plane of a quantity over w, given at the three vertices, evaluated in f64.
    #[must_use]
    pub fn exact_plane(&self, at_vertices: [f32; 3]) -> Plane {
        let values = DVec3::from_array(at_vertices.map(f64::from));
        Plane::Exact { coefficients: self.projected.homogeneous() * values }
    }

    /// Interpolation of per-vertex values.
    #[must_use]
    pub fn varyings(&self, device: &Device) -> Varyings {
        Varyings::new(device, &self.projected)
    }

    /// Barycentric coordinates of a pixel centre on the triangle in space, f64, in [0, 1].
    #[must_use]
    pub fn barycentrics(&self, px: u32, py: u32) -> DVec3 {
        self.projected.barycentrics(f64::from(px), f64::from(py))
    }

    /// Calls `span(y, first, end)` for each row of covered pixels; false if there is none.
    pub fn cover(
        &self,
        device: &Device,
        size: [u32; 2],
        cull: Cull,
        mut span: impl FnMut(u32, u32, u32),
    ) -> bool {
        let mut any = false;
        if !self.depth.is_finite() {
            return false;
        }
        if let Some(outline) = self.projected.outline(device, cull) {
            outline.spans(&[[0, size[0]], [0, size[1]]], |y, first, end| {
                any = true;
                span(y, first, end);
            });
        }
        any
    }
}

/// The value that the depth test compares, the least wins: the stored code of a fragment's depth
/// (monotone in it), or all bits of that turned under reversed depth.
fn depth_key(device: &Device, format: DepthFormat, reversed: bool) -> impl Fn(f32) -> u32 {
    let format = device.depth_format(format);
    let device = *device;
    let turned = if reversed { u32::MAX } else { 0 };
    move |z| format.encode_with(device.store, device.flush(z)) ^ turned
}
