//! Casters before the near plane: clipped, flattened vertex by vertex ("pancaking"), or depth-clamped.

use super::search::{ladder, onset};
use super::{Fate, Forecast, Row, Sampling, Stress};
use crate::depth::DepthFormat;
use crate::device::DeviceProfile;
use crate::num::exp2;
use crate::raster::{NO_TRIANGLE, Pass, PolygonOffset, Raster, draw};
use crate::report::Scale;
use crate::scene::Cull;
use glam::Vec4;

/// Texels along the caster.
const SIZE: u32 = 1024;
/// Window depth of the caster's far end.
const END: f64 = 0.5;
/// Error of a stored depth that counts.
const TOLERANCE: f64 = 0.05;

/// A caster over the whole map whose window depth goes from `first` to `last`, x from left to right.
fn ramp(first: f64, last: f64) -> Raster {
    let corner = |x: f32, y: f32, depth: f64| Vec4::new(x, y, (2.0 * depth - 1.0) as f32, 1.0);
    let corners = [
        corner(-1.0, -1.0, first),
        corner(1.0, -1.0, last),
        corner(1.0, 1.0, last),
        corner(-1.0, 1.0, first),
    ];
    let pass = Pass {
        size: [SIZE, 4],
        cull: Cull::None,
        depth_buffer: DepthFormat::F32,
        offset: PolygonOffset::default(),
        clip: Default::default(),
    };
    draw(&DeviceProfile::Ideal.device(), &pass, &corners, &[[0, 1, 2], [0, 2, 3]])
}

/// What a depth clamp stores: the caster's own depth, or 0 before the near plane.
fn clamped(before: f64, texel: u32) -> f64 {
    let share = (f64::from(texel) + 0.5) / f64::from(SIZE);
    ((before + END) * share - before).max(0.0)
}

/// Largest difference of a map from [`clamped`].
fn error(raster: &Raster, before: f64, stored: impl Fn(f32) -> f64) -> f64 {
    let texels = (0..SIZE).map(|i| (stored(raster.depth[i as usize]) - clamped(before, i)).abs());
    texels.fold(0.0, f64::max)
}

/// Share of the texels that clipping at the near plane leaves empty.
fn lost(before: f64) -> f64 {
    let raster = ramp(-before, END);
    let empty = raster.triangle.iter().filter(|&&t| t == NO_TRIANGLE).count();
    empty as f64 / raster.triangle.len() as f64
}

/// Vertices before the near plane are moved onto it, as vertex shaders do.
fn flattened(before: f64) -> f64 {
    error(&ramp(0.0, END), before, f64::from)
}

/// The near plane is pushed back by the whole depth range and each fragment's depth clamped: what a
/// depth clamp does to an orthographic light.
fn depth_clamped(before: f64) -> f64 {
    let pushed_back = |depth: f64| (depth + 1.0) / 2.0;
    let raster = ramp(pushed_back(-before), pushed_back(END));
    error(&raster, before, |z| (2.0 * f64::from(z) - 1.0).max(0.0))
}

fn row(forecast: Forecast, theory: impl Fn(f64) -> f64, error: fn(f64) -> f64, limit: f64) -> Row {
    let distances = ladder(1e-5, 1.0, 16);
    let measured = onset(1e-5, 1.0, 60, |before| error(before) > limit);
    let curve = distances.iter().map(|&before| (before, error(before))).collect();
    forecast.curve(&distances, theory).met(measured, curve)
}

/// A caster whose front end stands ever farther before the near plane.
pub(super) fn casters_before_near(_: &Sampling) -> Stress {
    let clipped = Forecast::at(
        Fate::Breaks,
        END * 0.5 / (f64::from(SIZE) - 0.5),
        "near-clipped",
        "texels of a caster before the near plane are empty",
        "h/(h + d) of N texels: more than half of the first one",
    );
    let pancaked = Forecast::at(
        Fate::Degrades,
        TOLERANCE * END / (END - TOLERANCE),
        "near-flattened",
        "vertices moved onto the near plane deepen the stored depth by more than 1/20",
        "d·h/(h + d), where the caster crosses the plane: behind it what is lit by mistake",
    );
    let clamp = Forecast::never(
        "near-clamped",
        "a clamped fragment's depth is off by more than 2⁻²²",
        "the clamp comes after interpolation and moves nothing behind the plane",
    );
    Stress {
        id: "depth-clamp",
        title: "Casters before the near plane: clipping, pancaking, depth clamp",
        lead: "One caster runs from before the near plane to depth d = 1/2. Clipped, its front is lost and \
               casts no shadow; flattened vertex by vertex it is kept, but its depth is bent; clamped \
               fragment by fragment it is right. The curve is the share of lost texels, or the largest \
               error of a stored depth."
            .to_string(),
        parameter: "distance h of the front end before the near plane [depth range]",
        error: "lost texels, or error of the depth",
        scale: Scale::Log,
        rows: vec![
            row(clipped, |h| h / (h + END), lost, 0.0),
            row(pancaked, |h| END * h / (h + END), flattened, TOLERANCE),
            row(clamp, |_| exp2(-24), depth_clamped, exp2(-22)),
        ],
    }
}
