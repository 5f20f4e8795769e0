//! A plane drawn into the map of an orthographic light: the bench of the slope's stresses.

use crate::depth::DepthFormat;
use crate::device::Device;
use crate::raster::{NO_TRIANGLE, Pass, PolygonOffset, Raster, draw};
use crate::scene::{CompareRule, Cull};
use crate::shadow::breakpoint;
use crate::view::Projection;
use glam::{DVec3, Vec4};

/// The plane at distance Z = R/2 + gx·x + gy·y from a light that looks down −z, over the whole map.
///
/// The depth range R is the power of two that holds the plane twice, so that window depths keep their
/// share of f32 whatever the slope.
#[derive(Clone, Debug)]
pub struct Sheet {
    /// Texels per side.
    pub size: u32,
    /// Edge of a texel, world units.
    pub texel_world: f64,
    /// Depth gradient (gx, gy), world per world.
    pub gradient: [f64; 2],
    /// Depth range R, world units.
    pub range: f64,
    stored: Vec<f32>,
    /// Texels that the plane covers.
    pub covered: usize,
}

impl Sheet {
    /// Draws the plane on `device` into a float map.
    #[must_use]
    pub fn draw(device: &Device, size: u32, texel_world: f64, gradient: [f64; 2]) -> Self {
        let width = texel_world * f64::from(size);
        let reach = 1.5 * width * (gradient[0].abs() + gradient[1].abs());
        let mut range = 1.0;
        while range < 2.0 * reach.max(width) {
            range *= 2.0;
        }
        let mut sheet = Self { size, texel_world, gradient, range, stored: Vec::new(), covered: 0 };
        let raster = sheet.raster(device);
        sheet.covered = raster.triangle.iter().filter(|&&t| t != NO_TRIANGLE).count();
        sheet.stored =
            raster.depth.iter().map(|&z| device.stored_depth(DepthFormat::F32, z)).collect();
        sheet
    }

    fn raster(&self, device: &Device) -> Raster {
        let width = self.texel_world * f64::from(self.size);
        let projection =
            Projection::Orthographic { width, height: width, near: 0.0, far: self.range };
        let matrix = projection.clip_from_view().as_mat4();
        // Corners beyond the map on whole texels: snapping moves nothing, clipping is exercised.
        let h = 0.75 * width;
        let corner = |(x, y): (f64, f64)| {
            let p = DVec3::new(x, y, -self.distance(x, y)).as_vec3();
            device.mat_vec(&matrix, p.extend(1.0))
        };
        let clip: Vec<Vec4> = [(-h, -h), (h, -h), (h, h), (-h, h)].map(corner).to_vec();
        let pass = Pass {
            size: [self.size; 2],
            cull: Cull::None,
            depth_buffer: DepthFormat::F32,
            offset: PolygonOffset::default(),
            clip: Default::default(),
        };
        draw(device, &pass, &clip, &[[0, 1, 2], [0, 2, 3]])
    }

    /// Distance from the light at (x, y), world units, f64.
    #[must_use]
    pub fn distance(&self, x: f64, y: f64) -> f64 {
        self.range / 2.0 + self.gradient[0] * x + self.gradient[1] * y
    }

    /// The stored window depth of texel (i, j).
    #[must_use]
    pub fn stored(&self, i: u32, j: u32) -> f32 {
        self.stored[(j * self.size + i) as usize]
    }

    /// World x of texel column `i` + `offset` texels; the same for y and rows.
    #[must_use]
    pub fn place(&self, i: u32, offset: f64) -> f64 {
        (f64::from(i) + offset - f64::from(self.size) / 2.0) * self.texel_world
    }

    /// Calls `at(i, j, x, y)` for each closed corner (x, y) of each texel (i, j).
    pub fn corners(&self, mut at: impl FnMut(u32, u32, f64, f64)) {
        for (i, j) in (0..self.size).flat_map(|j| (0..self.size).map(move |i| (i, j))) {
            for (dx, dy) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)] {
                at(i, j, self.place(i, dx), self.place(j, dy));
            }
        }
    }

    /// The critical bias over all texels, each taken at its four closed corners; world units.
    /// `lift` moves every receiver that far towards the light before it is compared.
    #[must_use]
    pub fn critical(&self, lift: f64) -> f64 {
        let mut critical = f64::NEG_INFINITY;
        self.corners(|i, j, x, y| {
            let z = ((self.distance(x, y) - lift) / self.range) as f32;
            let bias = breakpoint(CompareRule::ReceiverBeyond, z, self.stored(i, j));
            critical = critical.max(f64::from(bias));
        });
        critical * self.range
    }

    /// ‖g‖₁ = |gx| + |gy|.
    #[must_use]
    pub fn slope(&self) -> f64 {
        self.gradient[0].abs() + self.gradient[1].abs()
    }
}
