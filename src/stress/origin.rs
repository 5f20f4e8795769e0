//! Distance from the origin: what f32 positions and f32 matrices lose (T13).

use super::search::{Random, ladder, onset};
use super::{Fate, Forecast, Sampling, Stress};
use crate::camera::Camera;
use crate::depth::DepthFormat;
use crate::device::{Device, DeviceProfile};
use crate::light::Map;
use crate::num::exp2;
use crate::raster::passes::{Transformed, draw_map, map_depth_buffer};
use crate::report::Scale;
use crate::scene::{Case, CompareRule, MatrixChain, cases::analytic};
use crate::shadow::{ShadowMap, breakpoint};
use crate::view::{Projection, View};
use glam::{DVec3, Mat4, Vec3, Vec4};
use std::sync::Arc;

/// The smallest power of two with an ulp above `size`: f32 numbers x ∈ [2ᵉ, 2ᵉ⁺¹) are 2^(e−23) apart.
fn first_ulp_above(size: f64) -> f64 {
    (-100..100).map(exp2).find(|&x| x * exp2(-23) > size).expect("sizes are moderate")
}

/// Spacing of f32 at `x` > 0.
fn ulp(x: f64) -> f64 {
    crate::num::ulp(x as f32)
}

/// Spacing of the vertices, world units.
const SPACING: f64 = 0.01;

/// Vertices 1 cm apart, moved out.
pub(super) fn spacing(_: &Sampling) -> Stress {
    let distances = ladder(1.0, 1e7, 22);
    let vertex = |d: f64, i: u32| d + f64::from(i) * SPACING;
    let kept = |d: f64, i: u32| vertex(d, i) as f32;
    let worst =
        |d: f64| (0..256).map(|i| (f64::from(kept(d, i)) - vertex(d, i)).abs()).fold(0.0, f64::max);
    let merged = |d: f64| (0..255).any(|i| kept(d, i) == kept(d, i + 1));
    let event = "vertices 1 cm apart fall together";
    let formula = "2^(e−23) > h";
    let predicted = first_ulp_above(SPACING);
    let forecast = Forecast::at(Fate::Breaks, predicted, "vertex-spacing", event, formula)
        .curve(&distances, |d| ulp(d) / 2.0);
    let measured = onset(1.0, 1e7, 4000, merged);
    let row = forecast.met(measured, distances.iter().map(|&d| (d, worst(d))).collect());
    Stress {
        id: "vertex-spacing",
        title: "Vertices far from the origin",
        lead: "A row of vertices 1 cm apart is stored as f32 positions in the world: from which \
               distance on has the mesh collapsed? The curve is the largest error of a position."
            .to_string(),
        parameter: "distance from the origin [world units]",
        error: "error of a position [world units]",
        scale: Scale::Log,
        rows: vec![row],
    }
}

/// Depth range of the light, world units: its scale 2/10 is not dyadic.
const RANGE: f64 = 10.0;
/// A bias that hides the transform's error until its onset, window depth.
const BIAS: f64 = 1.5e-3;

/// A light at distance `d` along z with its one combined f32 matrix.
struct FarLight {
    device: Device,
    eye: f64,
    clip_from_world: Mat4,
}

impl FarLight {
    fn new(d: f64) -> Self {
        let eye = f64::from((d + RANGE / 2.0) as f32);
        let view = View {
            position: DVec3::new(0.0, 0.0, eye),
            target: DVec3::new(0.0, 0.0, eye - RANGE),
            up: DVec3::Y,
        };
        let projection =
            Projection::Orthographic { width: RANGE, height: RANGE, near: 0.0, far: RANGE };
        let (map, camera) = (Map::new(view, projection), Camera { view, projection });
        let matrices = MatrixChain::Combined.matrices(&map, &camera, &Mat4::IDENTITY);
        let device = DeviceProfile::Ideal.device();
        let stages = matrices.stages(&device, &Mat4::IDENTITY);
        Self { device, eye, clip_from_world: stages.light_clip[0] }
    }

    /// |subject − exact| window depth at an f32 position z.
    fn error(&self, z: f32) -> f64 {
        let p = Vec4::new(0.0, 0.0, z, 1.0);
        let clip = self.device.mat_vec(&self.clip_from_world, p);
        let window = f64::from(clip.z) / f64::from(clip.w) * 0.5 + 0.5;
        (window - (self.eye - f64::from(z)) / RANGE).abs()
    }

    /// γ₄Σ|m||p| over the depth row, window depth: no rounding of the f32 product may exceed it.
    fn bound(&self, z: f32) -> f64 {
        let unit = exp2(-24);
        let gamma = 4.0 * unit / (1.0 - 4.0 * unit);
        let row = self.clip_from_world.row(2);
        gamma * (f64::from(row.z.abs()) * f64::from(z.abs()) + f64::from(row.w.abs())) / 2.0
    }
}

/// Largest error, and largest share of the a priori bound, around distance `d`.
fn transform_error(d: f64, effort: &Sampling) -> (f64, f64) {
    let mut random = Random(effort.seed);
    let mut worst = (0.0f64, 0.0f64);
    for light in 0..64 {
        let light = FarLight::new(d + 0.37 * f64::from(light));
        for _ in 0..effort.samples / 4 {
            let z = (light.eye - RANGE * random.unit()) as f32;
            let error = light.error(z);
            worst = (worst.0.max(error), worst.1.max(error / light.bound(z)));
        }
    }
    worst
}

/// One f32 matrix from world to light, moved out.
pub(super) fn transform(effort: &Sampling) -> Stress {
    let distances = ladder(1e3, 1e7, 25);
    let event = "the transform's error exceeds a bias of 0.0015";
    let formula =
        "ulp(2D/R)/2 > b: half an ulp from the product, half from the matrix entry, in NDC";
    let predicted = first_ulp_above(2.0 * BIAS) * RANGE / 2.0;
    let forecast = Forecast::at(Fate::Degrades, predicted, "f32-transform", event, formula)
        .curve(&distances, |d| ulp(2.0 * d / RANGE) / 2.0);
    let measured = onset(1e3, 1e7, 200, |d| transform_error(d, effort).0 > BIAS);
    let worst: Vec<_> = distances.iter().map(|&d| (d, transform_error(d, effort))).collect();
    let share = worst.iter().map(|w| w.1.1).fold(0.0, f64::max);
    let bounded = if share <= 1.0 { "never exceeds" } else { "exceeds" };
    let note = format!(
        "The error {bounded} γ₄Σ|m||p|; the largest share of that bound is {}.",
        crate::report::number::pretty(share, 2)
    );
    let row = forecast.met(measured, worst.iter().map(|&(d, w)| (d, w.0)).collect()).noting(note);
    Stress {
        id: "f32-transform",
        title: "World to light in one f32 matrix",
        lead: "Light and scene move out together along the light's axis; the depth range stays 10. The \
               curve is the largest difference between the subject's depth and the exact one."
            .to_string(),
        parameter: "distance from the origin [world units]",
        error: "error [window depth]",
        scale: Scale::Log,
        rows: vec![row],
    }
}

/// Depth gradient of the moved plane.
const GRADIENT: [f64; 2] = [0.5, 0.25];

/// T1's dyadic plane with light and camera, moved by `d` along (1,1,1).
fn moved(d: f64) -> Case {
    let mut case = analytic::tilted_plane(GRADIENT[0] as f32, GRADIENT[1] as f32);
    let shift = DVec3::splat(d);
    case.light = case.light.moved(shift);
    case.camera.view.position += shift;
    case.camera.view.target += shift;
    for object in &mut case.objects {
        let out = |p: &Vec3| (p.as_dvec3() + shift).as_vec3();
        let moved = object.mesh.positions.iter().map(out).collect();
        Arc::make_mut(&mut object.mesh).positions = moved;
    }
    case
}

/// The critical bias of the moved plane at the closed corners of every covered texel; +∞ if none is.
fn critical(d: f64) -> f64 {
    let case = moved(d);
    let device = case.device.device();
    let vertices = Transformed::new(&case, case.chain, &device);
    let raster = draw_map(&case, &device, &vertices, map_depth_buffer(&case));
    let map = ShadowMap::store(&device, &case.map, &raster.layout, raster.drawn());
    let size = case.map.size as usize;
    // Texels whose corners lie on the plane where nothing has moved.
    let inside = |t: &usize| [t % size, t / size].iter().all(|c| (4..60).contains(c));
    let mut worst = f64::NEG_INFINITY;
    for t in (0..size * size).filter(inside) {
        for (dx, dy) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)] {
            let x = ((t % size) as f64 + dx) / 8.0 - 4.0;
            let z = 4.0 - ((t / size) as f64 + dy) / 8.0;
            let depth = (8.0 - (GRADIENT[0] * x + GRADIENT[1] * z)) / 16.0;
            let stored = map.depth(&device, t);
            let bias = breakpoint(CompareRule::ReceiverBeyond, depth as f32, stored);
            worst = worst.max(f64::from(bias));
        }
    }
    worst
}

/// T13: a copy of T1 far from the origin.
pub(super) fn moved_plane(_: &Sampling) -> Stress {
    let distances = ladder(1.0, 1e7, 29);
    let at_home = critical(0.0);
    let error = |d: f64| (critical(d.round()) / at_home - 1.0).abs();
    // The plane's corners are multiples of 1/8, its light's matrix is dyadic.
    let granularity = 0.125;
    let predicted = exp2(24) * granularity;
    let event = "the plane's critical bias is another one than at home";
    let formula = "2^(e−23) > 1/8, the finest binary digit of its vertices";
    let forecast = Forecast::at(Fate::Breaks, predicted, "t13-plane", event, formula)
        .curve(&distances, |d| if d < predicted { 0.0 } else { ulp(d) / (0.5 * 0.125 * 0.75) });
    let measured = onset(1.0, 1e7, 400, |d| error(d) > 1e-3);
    let curve: Vec<_> = distances.iter().map(|&d| (d, error(d))).collect();
    let before = curve.iter().filter(|p| p.0 < predicted).map(|p| p.1).fold(0.0, f64::max);
    let exact = if before == 0.0 { "bit-identical" } else { "not identical" };
    let format = DepthFormat::F32;
    let note =
        format!("Before that the critical bias in {format} is {exact} to the plane at home.");
    Stress {
        id: "t13-plane",
        title: "A dyadic plane far from the origin (T13)",
        lead: "T1, its light and its camera move out along (1,1,1). All its numbers are short binary \
               fractions, so that nothing is lost until the positions themselves cannot be kept. The \
               theory's curve is one spacing of positions over the plane's own critical bias."
            .to_string(),
        parameter: "distance from the origin along each axis [world units]",
        error: "relative error of the critical bias",
        scale: Scale::Log,
        rows: vec![forecast.met(measured, curve).noting(note)],
    }
}
