//! Camera samples commensurate with the acne's stripes: an aligned grid counts wrong, jitter does not.

use super::search::plastic;
use super::{Fate, Forecast, Sampling, Sheet, Stress};
use crate::device::DeviceProfile;
use crate::report::Scale;
use crate::scene::{CompareRule, Wrap};
use crate::shadow::sampler::nearest_texel;

/// Texels per side of the map.
const SIZE: u32 = 64;
/// An error of the measured acne fraction that is still good enough.
const TOLERANCE: f64 = 0.01;

/// Share of dark samples among points of the map, given by u and v, without any bias.
fn dark_fraction(sheet: &Sheet, points: impl Iterator<Item = [f64; 2]>) -> f64 {
    let (mut dark, mut count) = (0u32, 0u32);
    for [u, v] in points {
        let texel = |c: f64| nearest_texel(c as f32, SIZE, Wrap::Clamp, false);
        let place = |c: f64| (c - 0.5) * f64::from(SIZE) * sheet.texel_world;
        let z = (sheet.distance(place(u), place(v)) / sheet.range) as f32;
        let stored = sheet.stored(texel(u), texel(v));
        dark += u32::from(!CompareRule::ReceiverBeyond.is_lit(z, stored, 0.0));
        count += 1;
    }
    f64::from(dark) / f64::from(count)
}

/// k samples per texel along the slope, one across it, all at the same places of every texel.
fn aligned(k: u32) -> impl Iterator<Item = [f64; 2]> {
    let along = f64::from(SIZE * k);
    let columns = move |j: u32| {
        (0..SIZE * k)
            .map(move |i| [(f64::from(i) + 0.5) / along, (f64::from(j) + 0.5) / f64::from(SIZE)])
    };
    (0..SIZE).flat_map(columns)
}

/// Samples per stripe period from 1 to 101, odd: an even number splits the period in halves by luck.
pub(super) fn commensurate(_: &Sampling) -> Stress {
    let sheet = Sheet::draw(&DeviceProfile::Ideal.device(), SIZE, 0.125, [0.5, 0.0]);
    let odd: Vec<f64> = (0..=50).map(|i| f64::from(2 * i + 1)).collect();
    let grid_error = |k: f64| (dark_fraction(&sheet, aligned(k as u32)) - 0.5).abs();
    let points = |k: f64| SIZE * SIZE * k as u32;
    let jitter_error = |k: f64| (dark_fraction(&sheet, plastic(points(k))) - 0.5).abs();
    let curve = |error: &dyn Fn(f64) -> f64| -> Vec<(f64, f64)> {
        odd.iter().map(|&k| (k, error(k))).collect()
    };
    let (grid, jitter) = (curve(&grid_error), curve(&jitter_error));
    let good = |points: &[(f64, f64)]| points.iter().find(|p| p.1 <= TOLERANCE).map(|p| p.0);
    let bad = |points: &[(f64, f64)]| points.iter().find(|p| p.1 > TOLERANCE).map(|p| p.0);
    let worst = jitter.iter().map(|p| p.1).fold(0.0, f64::max);
    let note = format!(
        "The worst jittered error is {}, with as many samples.",
        crate::report::number::pretty(worst, 2)
    );
    let aligned = Forecast::at(
        Fate::Degrades,
        51.0,
        "aligned-grid",
        "an aligned grid is within 1 % of the true acne fraction ½",
        "the smallest odd k with 1/(2k) ≤ 0.01",
    );
    let jittered = Forecast::never(
        "plastic-jitter",
        "the plastic-number sequence is off by more than 1 %",
        "at most N^(−1/2) for N points",
    );
    let measured = (good(&grid), bad(&jitter));
    Stress {
        id: "commensurate-sampling",
        title: "Camera samples commensurate with the stripes",
        lead: "A plane without bias is dark on exactly half of its area. k camera samples per stripe, at \
               the same places of every stripe, count (k ± 1)/(2k) of it; points of the plastic-number \
               sequence do not know the stripes."
            .to_string(),
        parameter: "samples per stripe period",
        error: "error of the acne fraction",
        scale: Scale::Log,
        rows: vec![
            aligned.curve(&odd, |k| 0.5 / k).met(measured.0, grid),
            jittered
                .curve(&odd, |k| 1.0 / f64::sqrt(f64::from(points(k))))
                .met(measured.1, jitter)
                .noting(note),
        ],
    }
}
