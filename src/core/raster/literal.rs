//! Drawing triangle by triangle, pixel by pixel: the arbiter of the fast path.

use super::cut::Cut;
use super::{NO_TRIANGLE, Pass, Raster, Setup, Triangles, depth_key};
use crate::device::Device;
use glam::Vec4;

/// Draws triangles in order with depth test LESS into a buffer cleared to 1; GREATER and 0 under reversed
/// depth.
#[must_use]
pub fn draw_each(device: &Device, pass: &Pass, clip: &[Vec4], triangles: &[[u32; 3]]) -> Raster {
    draw_each_of(device, pass, &Triangles::alike(clip, triangles))
}

/// [`draw_each`] of triangles that need not be drawn alike.
#[must_use]
pub fn draw_each_of(device: &Device, pass: &Pass, triangles: &Triangles<'_>) -> Raster {
    let [width, height] = pass.size;
    let texels = width as usize * height as usize;
    let mut raster = Raster {
        size: pass.size,
        depth: vec![pass.clip.cleared(); texels],
        triangle: vec![NO_TRIANGLE; texels],
        empty_triangles: 0,
    };
    let key_of = depth_key(device, pass.depth_buffer, pass.clip.reversed);
    let mut keys = vec![key_of(pass.clip.cleared()); texels];
    for (id, t) in triangles.corners.iter().enumerate() {
        let Some(cull) = triangles.screen_cull(pass, id as u32) else {
            raster.empty_triangles += 1;
            continue;
        };
        let corners = t.map(|v| triangles.clip[v as usize]);
        let setup = Setup::in_space(device, pass.size, pass.clip, corners);
        let depth = setup.offset_depth(device, pass.depth_buffer, pass.offset);
        let cut = triangles.holes.and_then(|holes| Cut::of(device, &setup, holes, (id as u32, *t)));
        let drawn = setup.cover(device, pass.size, cull, |y, first, end| {
            let row = depth.row(y as f32);
            let start = y as usize * width as usize;
            for x in first..end {
                if cut.as_ref().is_some_and(|cut| !cut.is_there(x as f32, y as f32)) {
                    continue;
                }
                let z = row.at(x as f32);
                let z = if device.clamp_frag_z { z.clamp(0.0, 1.0) } else { z };
                let (key, at) = (key_of(z), start + x as usize);
                if key < keys[at] {
                    keys[at] = key;
                    raster.depth[at] = z;
                    raster.triangle[at] = id as u32;
                }
            }
        });
        raster.empty_triangles += u64::from(!drawn);
    }
    raster
}
