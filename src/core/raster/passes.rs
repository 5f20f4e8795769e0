//! A case on a device: its map pass and its camera pass, ready to be looked up pixel by pixel.

use super::{Interpolator, Pass, PolygonOffset, Projected, Raster, Setup, draw};
use crate::depth::DepthFormat;
use crate::device::Device;
use crate::scene::{Case, MatrixChain, Stages};
use crate::shadow::ShadowMap;
use glam::{DVec3, Vec4};

/// Vertices of all objects after the subject's f32 transforms, and the triangles over them.
#[derive(Clone, Debug)]
pub struct Transformed {
    /// Camera clip space.
    pub camera_clip: Vec<Vec4>,
    /// Map clip space.
    pub light_clip: Vec<Vec4>,
    /// The varying from which look-ups start.
    pub light_coord: Vec<Vec4>,
    /// Triangles of all objects in drawing order; the index is the triangle id.
    pub triangles: Vec<[u32; 3]>,
}

impl Transformed {
    /// Sends every vertex of the case through `chain`.
    #[must_use]
    pub fn new(case: &Case, chain: MatrixChain, device: &Device) -> Self {
        let mut out = Self {
            camera_clip: Vec::new(),
            light_clip: Vec::new(),
            light_coord: Vec::new(),
            triangles: Vec::new(),
        };
        for object in &case.objects {
            let first = out.camera_clip.len() as u32;
            let stages = chain.stages(device, &object.matrices, &object.model);
            for p in &object.mesh.positions {
                let p_model = p.extend(1.0);
                out.camera_clip.push(Stages::apply(device, &stages.camera_clip, p_model));
                out.light_clip.push(Stages::apply(device, &stages.light_clip, p_model));
                out.light_coord.push(Stages::apply(device, &stages.light_coord, p_model));
            }
            out.triangles.extend(object.mesh.triangles.iter().map(|t| t.map(|v| v + first)));
        }
        out
    }
}

/// The format whose codes the map pass' depth test compares.
#[must_use]
pub fn map_depth_buffer(case: &Case) -> DepthFormat {
    case.map.attachment()
}

/// Draws the case's casters into its map under a given depth attachment.
#[must_use]
pub fn draw_map(
    case: &Case,
    device: &Device,
    vertices: &Transformed,
    depth_buffer: DepthFormat,
) -> Raster {
    let pass = Pass {
        size: [case.map.size; 2],
        cull: case.map.cull,
        depth_buffer,
        offset: PolygonOffset::default(),
    };
    draw(device, &pass, &vertices.light_clip, &vertices.triangles)
}

/// A case drawn on a device.
#[derive(Clone, Debug)]
pub struct Subject<'a> {
    /// The case.
    pub case: &'a Case,
    /// The device.
    pub device: Device,
    /// Transformed vertices.
    pub vertices: Transformed,
    /// The map pass as rasterised, under the case's own depth attachment.
    pub map_raster: Raster,
    /// The map as stored.
    pub map: ShadowMap,
    /// The camera pass.
    pub canvas: Raster,
}

impl<'a> Subject<'a> {
    /// Runs both passes.
    #[must_use]
    pub fn draw(case: &'a Case, device: &Device) -> Self {
        let vertices = Transformed::new(case, case.chain, device);
        let map_raster = draw_map(case, device, &vertices, map_depth_buffer(case));
        let map = ShadowMap::store(device, &case.map, map_raster.drawn());
        let canvas = draw_canvas(case, device, &vertices, DepthFormat::Unorm24);
        Self { case, device: *device, vertices, map_raster, map, canvas }
    }

    /// The camera pass again under another depth attachment.
    #[must_use]
    pub fn canvas_with(&self, depth_buffer: DepthFormat) -> Raster {
        draw_canvas(self.case, &self.device, &self.vertices, depth_buffer)
    }

    /// The set-up of a triangle as the camera sees it.
    #[must_use]
    pub fn camera_setup(&self, triangle: u32) -> Setup {
        let corners = self.vertices.triangles[triangle as usize];
        let clip = corners.map(|v| self.vertices.camera_clip[v as usize]);
        Setup::new(&self.device, self.canvas.size, clip)
    }

    /// The set-up of a triangle as the light sees it in a map of `size`² texels.
    #[must_use]
    pub fn map_setup(&self, triangle: u32, size: u32) -> Setup {
        let corners = self.vertices.triangles[triangle as usize];
        let clip = corners.map(|v| self.vertices.light_clip[v as usize]);
        Setup::new(&self.device, [size; 2], clip)
    }

    /// What the camera pass interpolates over a triangle: the varying from which look-ups start.
    #[must_use]
    pub fn interpolator(&self, triangle: u32) -> Interpolator {
        let corners = self.vertices.triangles[triangle as usize];
        let clip = corners.map(|v| self.vertices.camera_clip[v as usize]);
        let projected = Projected::new(&self.device, self.canvas.size, clip);
        let varying = corners.map(|v| self.vertices.light_coord[v as usize]);
        Interpolator::new(&self.device, &projected, varying)
    }

    /// Map coordinates u, v and depth z that the fragment of `triangle` at a pixel computes.
    #[must_use]
    pub fn coordinate(&self, triangle: u32, px: u32, py: u32) -> [f32; 3] {
        let varying = self.interpolator(triangle).vector(px as f32, py as f32);
        self.case.lookup.coord.apply(varying)
    }

    /// Barycentric coordinates of a pixel centre on `triangle`, f64.
    #[must_use]
    pub fn barycentrics(&self, triangle: u32, px: u32, py: u32) -> DVec3 {
        self.camera_setup(triangle).barycentrics(px, py)
    }
}

fn draw_canvas(
    case: &Case,
    device: &Device,
    vertices: &Transformed,
    depth_buffer: DepthFormat,
) -> Raster {
    let pass = Pass {
        size: case.canvas,
        cull: case.camera_cull,
        depth_buffer,
        offset: PolygonOffset::default(),
    };
    draw(device, &pass, &vertices.camera_clip, &vertices.triangles)
}
