//! The empty and degenerate set (T16): whatever is drawn, the map stays sound and the rest stays lit.

use super::search::{ladder, onset};
use super::{Fate, Forecast, Sampling, Stress};
use crate::depth::DepthFormat;
use crate::device::{Device, DeviceProfile};
use crate::raster::{NO_TRIANGLE, Pass, PolygonOffset, Raster, draw};
use crate::report::Scale;
use crate::scene::{CompareRule, Cull};
use glam::Vec4;

/// A scene, and how many of its triangles may not draw anything.
struct Set {
    name: &'static str,
    size: u32,
    corners: Vec<Vec4>,
    empty: u64,
}

fn set(name: &'static str, size: u32, corners: &[[f32; 4]], empty: u64) -> Set {
    Set { name, size, corners: corners.iter().map(|&c| Vec4::from_array(c)).collect(), empty }
}

/// A triangle over the whole map, cut by three of its sides.
const OVER_THE_MAP: [[f32; 4]; 3] =
    [[-3.0, -1.0, 0.0, 1.0], [3.0, -1.0, 0.0, 1.0], [0.0, 5.0, 0.0, 1.0]];

fn sets() -> Vec<Set> {
    let nan = f32::NAN;
    let inf = f32::INFINITY;
    let all = OVER_THE_MAP;
    let inner = [[-0.5, -0.5, 0.0, 1.0], [0.5, -0.5, 0.0, 1.0], [0.0, 0.5, 0.0, 1.0]];
    let scaled = |s: f32| inner.map(|v: [f32; 4]| v.map(|c| c * s));
    let with = |bad: [f32; 4]| [all[0], all[1], bad];
    vec![
        set("empty scene", 16, &[], 0),
        set("map of one texel", 1, &all, 0),
        set("one triangle", 16, &all, 0),
        set("one point three times", 16, &[[0.1, 0.2, 0.3, 1.0]; 3], 1),
        set(
            "collinear",
            16,
            &[[-1.0, -1.0, 0.0, 1.0], [0.0, 0.0, 0.0, 1.0], [1.0, 1.0, 0.0, 1.0]],
            1,
        ),
        set("all behind the light", 16, &all.map(|v| [v[0], v[1], v[2], -1.0]), 1),
        set("beyond the far plane", 16, &all.map(|v| [v[0], v[1], 1.5, 1.0]), 1),
        set("w of 0 everywhere", 16, &all.map(|v| [v[0], v[1], v[2], 0.0]), 1),
        set("a NaN", 16, &with([nan, 0.0, 0.0, 1.0]), 1),
        set("a NaN in w", 16, &with([0.0, 0.0, 0.0, nan]), 1),
        set("an infinity", 16, &with([0.0, inf, 0.0, 1.0]), 1),
        set("10³⁰ homogeneous", 16, &scaled(1e30), 0),
        set("10⁻³⁰ homogeneous", 16, &scaled(1e-30), 0),
        set("smaller than a sub-pixel", 16, &all.map(|v| [v[0] * 1e-6, v[1] * 1e-6, 0.0, 1.0]), 1),
        set("depth −0", 16, &all.map(|v| [v[0], v[1], -1.0, 1.0]), 0),
        set("depth 1", 16, &all.map(|v| [v[0], v[1], 1.0, 1.0]), 0),
    ]
}

fn drawn(device: &Device, set: &Set) -> Raster {
    let pass = Pass {
        size: [set.size; 2],
        cull: Cull::None,
        depth_buffer: DepthFormat::F32,
        offset: PolygonOffset { factor: 1.0, units: 1.0, clamp: 0.0 },
        clip: Default::default(),
    };
    let triangles: Vec<[u32; 3]> =
        (0..set.corners.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    draw(device, &pass, &set.corners, &triangles)
}

/// What is wrong with the map of a set: NaN or depths outside [0, 1], a count of empty triangles other
/// than expected, texels drawn by a triangle that should be empty, receivers before it not lit.
fn faults(device: &Device, set: &Set) -> usize {
    let raster = drawn(device, set);
    let unsound = raster.depth.iter().filter(|z| !(0.0..=1.0).contains(*z)).count();
    let any = raster.triangle.iter().any(|&t| t != NO_TRIANGLE);
    let drawn_though_empty = set.empty > 0 && any;
    let lit = |&d: &f32| CompareRule::ReceiverBeyond.is_lit(0.0, d, 0.0);
    let dark = raster.depth.iter().filter(|d| !lit(d)).count();
    unsound
        + usize::from(drawn_though_empty)
        + usize::from(raster.empty_triangles != set.empty)
        + dark
}

/// T16 on every device profile.
pub(super) fn sets_on_devices(_: &Sampling) -> Stress {
    let sets = sets();
    let of = |s: &Set| DeviceProfile::ALL.iter().map(|p| faults(&p.device(), s)).sum::<usize>();
    let counts: Vec<usize> = sets.iter().map(of).collect();
    let numbers: Vec<f64> = (1..=sets.len()).map(|i| i as f64).collect();
    let first = counts.iter().position(|&n| n > 0);
    let faulty = sets.iter().zip(&counts).filter(|(_, n)| **n > 0).map(|(s, _)| s.name);
    let names: Vec<_> = sets.iter().map(|s| s.name).collect();
    let note = match faulty.collect::<Vec<_>>().as_slice() {
        [] => format!(
            "{} sets on {} devices: {}.",
            sets.len(),
            DeviceProfile::ALL.len(),
            names.join(", ")
        ),
        bad => format!("Faults: {}.", bad.join(", ")),
    };
    let event = "a degenerate set leaves a NaN, a depth outside [0, 1], or a miscount";
    let row =
        Forecast::never("t16-degenerate", event, "nothing without area or with a NaN is drawn")
            .curve(&numbers, |_| 0.0)
            .met(
                first.map(|i| numbers[i]),
                numbers.iter().zip(&counts).map(|(&x, &n)| (x, n as f64)).collect(),
            )
            .noting(note);
    Stress {
        id: "t16-degenerate",
        title: "Empty and degenerate (T16)",
        lead: "Scenes with nothing to draw, or nothing that can be drawn, on every device profile."
            .to_string(),
        parameter: "number of the set",
        error: "faults",
        scale: Scale::Linear,
        rows: vec![row],
    }
}

/// Share of the map that a triangle over all of it misses, its homogeneous coordinates times `scale`.
fn missed(scale: f64) -> f64 {
    let corners = OVER_THE_MAP.map(|v| v.map(|c| c * scale as f32));
    let raster = drawn(&DeviceProfile::Ideal.device(), &set("scaled", 16, &corners, 0));
    let free = raster.triangle.iter().filter(|&&t| t == NO_TRIANGLE).count();
    free as f64 / raster.triangle.len() as f64
}

/// Homogeneous coordinates so large that clipping overflows.
pub(super) fn clip_scale(_: &Sampling) -> Stress {
    let scales = ladder(1.0, 1e30, 16);
    // Cutting the bottom edge at x = −w, the largest product is 4s · 3s.
    let predicted = f64::sqrt(f64::from(f32::MAX) / 12.0);
    let event = "a triangle over the whole map, cut by its sides, loses texels";
    let formula = "12·s² exceeds the largest f32: the clipper forms d·x of two coordinates";
    let row = Forecast::at(Fate::Breaks, predicted, "clip-scale", event, formula)
        .curve(&scales, |s| f64::from(u8::from(s > predicted)))
        .met(
            onset(1.0, 1e30, 400, |s| missed(s) > 0.0),
            scales.iter().map(|&s| (s, missed(s))).collect(),
        )
        .noting("Triangles that need no clipping are drawn up to 10³⁰ and beyond.");
    Stress {
        id: "clip-scale",
        title: "Homogeneous coordinates without measure",
        lead: "Clip-space coordinates times s mean the same triangle. In f32 a clipped one is lost once \
               products of two of them overflow. The curve is the share of the map that it misses."
            .to_string(),
        parameter: "scale s of the homogeneous coordinates",
        error: "share of the map missed",
        scale: Scale::Log,
        rows: vec![row],
    }
}
