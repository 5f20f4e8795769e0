//! Windings that flip: a thin front face whose snapped vertices go round the other way.

use super::grid::{IDEAL, SIZE};
use super::search::{Random, ladder, onset};
use super::{Fate, Forecast, Row, Sampling};
use crate::raster::Setup;
use glam::Vec4;

/// An edge from one grid point to another, in sub-pixels: two Fibonacci numbers, so that places along it
/// fall evenly between grid points.
const OBLIQUE: [f64; 2] = [10_946.0, 6_765.0];
/// An edge along the grid.
const AXIS: [f64; 2] = [12_288.0, 0.0];
/// Sub-pixels per pixel.
const FINE: f64 = 256.0;

/// The unit normal to the left of an edge.
fn normal([x, y]: [f64; 2]) -> [f64; 2] {
    let length = f64::sqrt(x * x + y * y);
    [-y / length, x / length]
}

/// Share of front faces that show their back once they are snapped: triangles on `edge` whose third
/// vertex stands `width` pixels to its left.
fn turned(edge: [f64; 2], width: f64, effort: &Sampling) -> f64 {
    let (count, mut random) = (16 * effort.samples, Random(effort.seed));
    let (start, [nx, ny]) = ([8.0 * FINE; 2], normal(edge));
    let corner = |p: [f64; 2]| -> Vec4 { IDEAL.clip_at(p, 0.5) };
    let end = [start[0] + edge[0], start[1] + edge[1]];
    let device = IDEAL.device();
    let mut is_turned = || {
        let along = 0.2 + 0.6 * random.unit();
        let apex = [
            start[0] + along * edge[0] + width * FINE * nx,
            start[1] + along * edge[1] + width * FINE * ny,
        ];
        // The other way round it is a front.
        Setup::new(&device, [SIZE; 2], [start, apex, end].map(corner)).is_front()
    };
    (0..count).filter(|_| is_turned()).count() as f64 / f64::from(count)
}

/// The apex moves by e, uniform in a sub-pixel's square, so n·e = aU + bV with U and V uniform in ±½:
/// P(n·e < −w), the tail of a trapezoid.
fn tail(edge: [f64; 2], width: f64) -> f64 {
    let [nx, ny] = normal(edge).map(f64::abs);
    let (a, b, w) = (nx.max(ny), nx.min(ny), width * FINE);
    let (outer, inner) = ((a + b) / 2.0, (a - b) / 2.0);
    if w >= outer {
        0.0
    } else if w >= inner {
        (outer - w) * (outer - w) / (2.0 * a * b)
    } else {
        0.5 - w / a
    }
}

/// Faces on an edge across the grid.
pub(super) fn across_the_grid(effort: &Sampling) -> Row {
    let widths = ladder(1e-4, 1e-2, 13);
    let [nx, ny] = normal(OBLIQUE).map(f64::abs);
    let predicted = (nx + ny) / 2.0 / FINE;
    let event = "every front face is still a front face";
    let formula = "half a sub-pixel times |cos φ| + |sin φ| is the farthest that snapping moves a \
                   vertex towards an edge of direction φ";
    let forecast = Forecast::at(Fate::Breaks, predicted, "winding-oblique", event, formula)
        .curve(&widths, |w| tail(OBLIQUE, w));
    let share = |w: f64| turned(OBLIQUE, w, effort);
    let measured = onset(1e-4, 1e-2, 60, |w| share(w) == 0.0);
    forecast.met(measured, widths.iter().map(|&w| (w, share(w))).collect()).noting(
        "Faces are culled after snapping (the order of D3D): a flipped one is culled as a back face, or \
         drawn where back faces alone are.",
    )
}

/// Faces on an edge along the grid.
pub(super) fn along_the_grid(effort: &Sampling) -> Row {
    let widths = ladder(1e-4, 1e-2, 13);
    let curve: Vec<_> = widths.iter().map(|&w| (w, turned(AXIS, w, effort))).collect();
    let first = curve.iter().find(|p| p.1 > 0.0).map(|p| p.0);
    let formula = "rounding is monotone: across a grid line nothing changes sides";
    Forecast::never("winding-axis", "a front face along the grid shows its back", formula)
        .curve(&widths, |_| 0.0)
        .met(first, curve)
}
