//! A case on a device: its map pass and its camera pass, ready to be looked up pixel by pixel.

use super::{
    Interpolator, NO_TRIANGLE, Pass, PolygonOffset, Projected, Raster, Setup, Triangles, draw_of,
};
use crate::depth::DepthFormat;
use crate::device::Device;
use crate::light::{Layout, Lens, Light, Lookup, PlaceInMaps};
use crate::scene::{Case, Cull, CullRule, MatrixChain, Stages, Surfaces};
use crate::shadow::{Drawn, Few, ShadowMap};
use crate::view::{ClipRange, ClipSpace};
use glam::{DVec3, Vec4};

/// Vertices of all objects after the subject's f32 transforms, and the triangles over them.
#[derive(Clone, Debug)]
pub struct Transformed {
    /// Camera clip space.
    pub camera_clip: Vec<Vec4>,
    /// What each map of the light makes of them.
    pub maps: Vec<MapVertices>,
    /// Triangles of all objects in drawing order; the index is the triangle id.
    pub triangles: Vec<[u32; 3]>,
    /// How they are there.
    pub surfaces: Surfaces,
}

/// Vertices of all objects under one map.
#[derive(Clone, Debug, Default)]
pub struct MapVertices {
    /// Map clip space.
    pub clip: Vec<Vec4>,
    /// The varying from which look-ups start.
    pub coord: Vec<Vec4>,
}

impl Transformed {
    /// Sends every vertex of the case through `chain`.
    #[must_use]
    pub fn new(case: &Case, chain: MatrixChain, device: &Device) -> Self {
        let maps = case.light.maps();
        let mut out = Self {
            camera_clip: Vec::new(),
            maps: vec![MapVertices::default(); maps.len()],
            triangles: Vec::new(),
            surfaces: Surfaces::of(&case.objects),
        };
        for object in &case.objects {
            let first = out.camera_clip.len() as u32;
            let through = |stages: &[_]| {
                let send = |p: &glam::Vec3| Stages::apply(device, stages, p.extend(1.0));
                object.mesh.positions.iter().map(send).collect::<Vec<Vec4>>()
            };
            let matrices = |map| object.matrices(chain, map, &case.camera);
            for (map, vertices) in maps.iter().zip(&mut out.maps) {
                let stages = matrices(map).stages(device, &object.model);
                vertices.clip.extend(through(&stages.light_clip));
                vertices.coord.extend(through(&stages.light_coord));
                if out.camera_clip.len() == first as usize {
                    // The camera's matrices are the same beside every map.
                    out.camera_clip.extend(through(&stages.camera_clip));
                }
            }
            out.triangles.extend(object.mesh.triangles.iter().map(|t| t.map(|v| v + first)));
        }
        out
    }
}

/// How the casters are drawn into all maps of a light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MapPass {
    /// Faces left out.
    pub cull: CullRule,
    /// Format of the depth attachment whose codes are compared.
    pub depth_buffer: DepthFormat,
    /// Caster-side offset.
    pub offset: PolygonOffset,
}

/// What the passes of all maps of a light wrote, their texels in one row ([`Layout`]).
#[derive(Clone, Debug, PartialEq)]
pub struct MapRaster {
    /// Where each map's texels lie.
    pub layout: Layout,
    /// Window depth of the winning fragment; the cleared one where there is none.
    pub depth: Vec<f32>,
    /// Its triangle, or [`NO_TRIANGLE`].
    pub triangle: Vec<u32>,
}

impl MapRaster {
    /// What a map is stored from.
    #[must_use]
    pub fn drawn(&self) -> Drawn<'_> {
        Drawn { depth: &self.depth, triangle: &self.triangle }
    }

    /// Draws the casters into every map of a light.
    #[must_use]
    pub fn draw(
        light: &Light,
        layout: Layout,
        device: &Device,
        vertices: &Transformed,
        MapPass { cull, depth_buffer, offset }: MapPass,
    ) -> Self {
        let maps = light.maps().iter().zip(layout.rects()).zip(&vertices.maps);
        let culls = vertices.surfaces.culls(cull);
        let mut drawn = maps.map(|((map, rect), vertices_of)| {
            let none = Cull::None;
            let pass = Pass { size: rect.size, cull: none, depth_buffer, offset, clip: map.clip };
            let triangles = Triangles::alike(&vertices_of.clip, &vertices.triangles)
                .with_holes(&vertices.surfaces);
            let (pass, triangles) = triangles.under(pass, &culls);
            (rect, draw_of(device, &pass, &triangles))
        });
        if layout.only().is_some() {
            let rasters = drawn.next().map(|(_, raster)| (raster.depth, raster.triangle));
            let (depth, triangle) = rasters.unwrap_or_default();
            return Self { depth, triangle, layout };
        }
        let mut depth = vec![layout.cleared(); layout.texels()];
        let mut triangle = vec![NO_TRIANGLE; layout.texels()];
        for (rect, raster) in drawn {
            let width = rect.size[0] as usize;
            let rows = raster.depth.chunks(width).zip(raster.triangle.chunks(width));
            for (y, (depths, triangles)) in rows.enumerate() {
                let first = rect.texel(0, y as u32) as usize;
                depth[first..first + width].copy_from_slice(depths);
                triangle[first..first + width].copy_from_slice(triangles);
            }
        }
        Self { depth, triangle, layout }
    }
}

/// The format whose codes the map pass' depth test compares.
#[must_use]
pub fn map_depth_buffer(case: &Case) -> DepthFormat {
    case.map.attachment()
}

/// Draws the case's casters into its maps under a given depth attachment.
#[must_use]
pub fn draw_map(
    case: &Case,
    device: &Device,
    vertices: &Transformed,
    depth_buffer: DepthFormat,
) -> MapRaster {
    let pass = MapPass { cull: case.map.cull, depth_buffer, offset: PolygonOffset::default() };
    MapRaster::draw(&case.light, case.layout(), device, vertices, pass)
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
    /// The map passes as rasterised, under the case's own depth attachment.
    pub map_raster: MapRaster,
    /// The maps as stored.
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
        let map = ShadowMap::store(device, &case.map, &map_raster.layout, map_raster.drawn());
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

    /// The set-up of a triangle as a map of a layout sees it.
    #[must_use]
    pub fn map_setup(&self, triangle: u32, map: usize, layout: &Layout) -> Setup {
        let corners = self.vertices.triangles[triangle as usize];
        let clip = corners.map(|v| self.vertices.maps[map].clip[v as usize]);
        let space = self.case.light.maps()[map].clip;
        Setup::in_space(&self.device, layout.rect(map).size, space, clip)
    }

    /// What the camera pass interpolates over a triangle: for each map the varying from which look-ups
    /// start.
    #[must_use]
    pub fn interpolator(&self, triangle: u32) -> Interpolator {
        let corners = self.vertices.triangles[triangle as usize];
        let clip = corners.map(|v| self.vertices.camera_clip[v as usize]);
        let range = ClipRange::MinusOneToOne;
        let projected = Projected::new(&self.device, self.canvas.size, range, clip);
        let varying = |map: &MapVertices| corners.map(|v| map.coord[v as usize]);
        Interpolator::new(&self.device, &projected, self.vertices.maps.iter().map(varying))
    }

    /// Map coordinates u, v and compared depth z that the fragment of a triangle at a pixel computes in
    /// each map.
    #[must_use]
    pub fn coordinates(&self, interpolator: &Interpolator, px: u32, py: u32) -> Few<[f32; 3]> {
        let maps = self.case.light.maps().iter().enumerate();
        let form = self.case.lookup.coord;
        maps.map(|(k, map)| form.apply(interpolator.vector(k, px as f32, py as f32), map.clip))
            .collect()
    }

    /// The exact matrices of each map.
    #[must_use]
    pub fn lenses(&self) -> Vec<Lens> {
        let maps = self.case.light.maps().iter().zip(self.map_raster.layout.rects());
        maps.map(|(map, rect)| Lens::new(map, rect.size)).collect()
    }

    /// The look-ups of a receiver whose map coordinates are given: what its choice takes.
    #[must_use]
    pub fn lookups(&self, position: DVec3, coords: &[[f32; 3]]) -> Few<Lookup> {
        let view = &self.case.camera.view;
        let view_depth = || (view.position - position).dot(view.backward()) as f32;
        self.case.light.lookups(&PlaceInMaps { coords, view_depth: &view_depth })
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
        cull: Cull::None,
        depth_buffer,
        offset: PolygonOffset::default(),
        clip: ClipSpace::OPENGL,
    };
    let culls = vertices.surfaces.picture_culls(case.camera_cull);
    let triangles =
        Triangles::alike(&vertices.camera_clip, &vertices.triangles).with_holes(&vertices.surfaces);
    let (pass, triangles) = triangles.under(pass, &culls);
    draw_of(device, &pass, &triangles)
}
