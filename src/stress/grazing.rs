//! Grazing light: the constant bias grows as tan θ, the normal offset stays, and at 90° nothing is drawn.

use super::search::{ladder, onset};
use super::{Fate, Forecast, Row, Sampling, Sheet, Stress};
use crate::depth::DepthFormat;
use crate::device::{Device, DeviceProfile};
use crate::raster::{NO_TRIANGLE, Pass, PolygonOffset, draw};
use crate::report::Scale;
use crate::scene::Cull;
use crate::shadow::bias::{NormalMove, NormalWeight, Site};
use crate::view::Projection;
use glam::{DVec2, DVec3};

/// Edge of a texel, world units.
const TEXEL: f64 = 0.125;
/// Texels per side of the map.
const SIZE: u32 = 16;
/// Azimuths of the gradient in the texel grid: name, cos φ, sin φ.
const AZIMUTHS: [(&str, f64, f64); 3] =
    [("axis", 1.0, 0.0), ("oblique", 0.8, 0.6), ("diagonal", HALF_ROOT, HALF_ROOT)];
const HALF_ROOT: f64 = std::f64::consts::FRAC_1_SQRT_2;

fn device() -> Device {
    DeviceProfile::Ideal.device()
}

fn radians(degrees: f64) -> f64 {
    degrees * std::f64::consts::PI / 180.0
}

/// The plane at θ degrees to the light.
fn tilted(degrees: f64, cos: f64, sin: f64) -> Sheet {
    let tan = libm::tan(radians(degrees));
    Sheet::draw(&device(), SIZE, TEXEL, [tan * cos, tan * sin])
}

/// Angles up to 90°, ever denser: 90° minus a ladder from 89° to 0.01°.
fn angles(count: u32) -> Vec<f64> {
    ladder(0.01, 89.0, count).into_iter().rev().map(|rest| 90.0 - rest).collect()
}

/// The budget of a constant bias, in texel edges.
const BUDGET: f64 = 10.0;

fn constant_row(&(name, cos, sin): &(&str, f64, f64)) -> Row {
    let norm = cos + sin;
    let theory = |degrees: f64| 0.5 * libm::tan(radians(degrees)) * norm;
    let predicted = libm::atan(2.0 * BUDGET / norm) * 180.0 / std::f64::consts::PI;
    let name = format!("constant-bias-{name}");
    let event = "the critical bias exceeds ten texel edges";
    let formula = "b* = (s/2)·tan θ·(|cos φ| + |sin φ|)";
    let forecast =
        Forecast::at(Fate::Degrades, predicted, name, event, formula).curve(&angles(21), theory);
    let critical = |degrees: f64| tilted(degrees, cos, sin).critical(0.0) / TEXEL;
    let measured = onset(1.0, 89.99, 60, |degrees| critical(degrees) > BUDGET);
    let curve: Vec<_> =
        angles(21).into_iter().map(|degrees| (degrees, critical(degrees))).collect();
    let steepest = curve[curve.len() - 1];
    let note = format!(
        "At {}° it is {} texel edges, {} of theory.",
        text(steepest.0),
        text(steepest.1),
        text(steepest.1 / theory(steepest.0))
    );
    forecast.met(measured, curve).noting(note)
}

/// θ up to 90° against a constant bias.
pub(super) fn constant(_: &Sampling) -> Stress {
    Stress {
        id: "grazing-constant",
        title: "Grazing light and a constant bias",
        lead: "A plane tilts away from the light at three azimuths. The curve is the bias at which its \
               last corner of a texel is lit, measured at the texels' closed corners."
            .to_string(),
        parameter: "angle between normal and light [degrees]",
        error: "critical bias [texel edges]",
        scale: Scale::Linear,
        rows: AZIMUTHS.iter().map(constant_row).collect(),
    }
}

/// Smallest normal offset that leaves no acne, in texel edges: receivers that land on a closed corner of
/// some texel after the move.
fn smallest_offset(degrees: f64, cos: f64, sin: f64) -> f64 {
    let sheet = tilted(degrees, cos, sin);
    let [gx, gy] = sheet.gradient;
    let normal = DVec3::new(gx, gy, 1.0);
    let normal = normal / crate::view::length(normal);
    let offset = |amount: f64| {
        let site = Site {
            position: DVec3::ZERO,
            normal,
            normals: None,
            to_light: DVec3::Z,
            texel_world: TEXEL,
            window_per_world: 1.0 / sheet.range,
            gradient: DVec2::ZERO,
            map_size: [SIZE; 2],
            w: 1.0,
        };
        let weight = NormalWeight::One;
        NormalMove { amount, weight, ..NormalMove::default() }.offset(&site)
    };
    // A receiver p = (x', y') − (dx, dy) that lands on corner (x', y') has come dz nearer from the plane
    // at p, and so lies g·(dx, dy) + dz before the plane at the corner.
    let clean = |amount: f64| {
        let d = offset(amount);
        sheet.critical(gx * d.x + gy * d.y + d.z) <= 0.0
    };
    let (mut low, mut high) = (0.0, 2.0 * TEXEL);
    for _ in 0..30 {
        let middle = (low + high) / 2.0;
        if clean(middle) { high = middle } else { low = middle }
    }
    high / TEXEL
}

/// Offset at which the row's onset is read, texel edges: half of the axis-aligned limit.
const HALF_OFFSET: f64 = 0.25;

fn offset_row(&(name, cos, sin): &(&str, f64, f64)) -> Row {
    let norm = cos + sin;
    let theory = |degrees: f64| 0.5 * libm::sin(radians(degrees)) * norm;
    let predicted = libm::asin(2.0 * HALF_OFFSET / norm) * 180.0 / std::f64::consts::PI;
    let name = format!("normal-offset-{name}");
    let event = "the smallest sufficient normal offset exceeds a quarter of a texel edge";
    let formula = "d* = (s/2)·sin θ·(|cos φ| + |sin φ|) ≤ s/√2";
    let forecast =
        Forecast::at(Fate::Degrades, predicted, name, event, formula).curve(&angles(21), theory);
    let needed = |degrees: f64| smallest_offset(degrees, cos, sin);
    let measured = onset(1.0, 89.99, 30, |degrees| needed(degrees) > HALF_OFFSET);
    let curve: Vec<_> = angles(21).into_iter().map(|degrees| (degrees, needed(degrees))).collect();
    let largest = curve.iter().map(|p| p.1).fold(0.0, f64::max);
    let note =
        format!("The largest up to 89.99° is {} texel edges: it stays bounded.", text(largest));
    forecast.met(measured, curve).noting(note)
}

/// θ up to 90° against an offset along the normal.
pub(super) fn normal_offset(_: &Sampling) -> Stress {
    Stress {
        id: "grazing-normal-offset",
        title: "Grazing light and a normal offset",
        lead: "The same planes; receivers move along their normal before the look-up. The curve is the \
               smallest move that lights every corner of every texel."
            .to_string(),
        parameter: "angle between normal and light [degrees]",
        error: "smallest sufficient offset [texel edges]",
        scale: Scale::Linear,
        rows: AZIMUTHS.iter().map(offset_row).collect(),
    }
}

/// Whether a wall of height 4 along the light, whose foot and top are `width` texels apart, is in the map.
fn wall_survives(width: f64, offset: PolygonOffset) -> bool {
    let projection = Projection::Orthographic { width: 8.0, height: 8.0, near: 0.0, far: 16.0 };
    let matrix = projection.clip_from_view().as_mat4();
    let reach = width * TEXEL;
    // Columns of texel centres lie at odd multiples of 1/16: the wall's foot stands on one.
    let foot = 0.0625;
    let corner =
        |[x, y, z]: [f64; 3]| device().mat_vec(&matrix, DVec3::new(x, y, z).as_vec3().extend(1.0));
    let top = foot + reach;
    let corners = [[foot, -2.0, -4.0], [top, -2.0, -8.0], [top, 2.0, -8.0], [foot, 2.0, -4.0]];
    let pass = Pass {
        size: [64; 2],
        cull: Cull::None,
        depth_buffer: DepthFormat::F32,
        offset,
        clip: Default::default(),
    };
    let raster = draw(&device(), &pass, &corners.map(corner), &[[0, 1, 2], [0, 2, 3]]);
    assert!(raster.depth.iter().all(|z| !z.is_nan()), "a slope of 0·∞ never reaches the map");
    raster.triangle.iter().any(|&t| t != NO_TRIANGLE)
}

fn wall_row(name: &str, predicted: f64, formula: &str, offset: PolygonOffset) -> Row {
    let widths = ladder(1e-4, 10.0, 16);
    let there = |w: f64| f64::from(u8::from(w > predicted));
    let event = "the wall is in the map";
    let forecast =
        Forecast::at(Fate::Breaks, predicted, name, event, formula).curve(&widths, there);
    let seen = |w: f64| wall_survives(w, offset);
    let measured = onset(1e-4, 10.0, 400, seen);
    forecast.met(measured, widths.iter().map(|&w| (w, f64::from(u8::from(seen(w))))).collect())
}

/// The last step to 90°: a wall seen ever more edge-on.
pub(super) fn edge_on(_: &Sampling) -> Stress {
    let snapped = "a width of half a sub-pixel, 2⁻⁹ texel, rounds to none (ties to even)";
    // From 1/4 at its foot the wall's depth grows by 1/4 over its width: m = 1/(4 w).
    let pushed =
        "z + m ≥ 1 with z = 1/4 and m = 1/(4w): the offset carries the foot beyond depth 1";
    let slope = PolygonOffset { factor: 1.0, units: 1.0, clamp: 0.0 };
    let clamped = PolygonOffset { clamp: 0.25, ..slope };
    let half_step = crate::num::exp2(-9);
    let note = "Thinner than that its slope is not evaluated and what stands behind it is lit: \
                edge-on faces are undefined in a shadow map, not acne.";
    Stress {
        id: "edge-on",
        title: "Edge-on: the last step to 90°",
        lead:
            "A wall along the light whose foot and top are less and less of a texel apart, drawn \
               without offset, with slope-scaled offset, and with its clamp. 1 = it is in the map."
                .to_string(),
        parameter: "width of the wall as the light sees it [texels]",
        error: "wall in the map",
        scale: Scale::Log,
        rows: vec![
            wall_row("edge-on", half_step, snapped, PolygonOffset::default()).noting(note),
            wall_row("edge-on-slope-offset", 1.0 / 3.0, pushed, slope)
                .noting("An unclamped slope offset loses whole casters at grazing light."),
            wall_row("edge-on-clamped-offset", half_step, snapped, clamped),
        ],
    }
}

fn text(value: f64) -> String {
    crate::report::number::pretty(value, 4)
}
