//! Depths at the ends of their range: denormals, 1 and its neighbours, through every format and packing.

use super::search::{ladder, onset};
use super::{Fate, Forecast, Row, Sampling, Stress};
use crate::depth::{DepthFormat, Packing};
use crate::device::{Device, DeviceProfile};
use crate::num::{exp2, from_ordinal, ordinal};
use crate::report::Scale;

/// The smallest depth that a format keeps, by theory: half of its smallest value, where ties go to 0.
fn smallest_kept(format: DepthFormat) -> f64 {
    match (format, format.unorm_max()) {
        (_, Some(max)) => 0.5 / f64::from(max),
        (DepthFormat::F16, None) => exp2(-25),
        (DepthFormat::Bf16, None) => exp2(-134),
        (_, None) => exp2(-150),
    }
}

fn vanishing_row(name: String, device: &Device, format: DepthFormat, kept_from: f64) -> Row {
    let depths = ladder(1e-46, 1.0, 24);
    let stored = |z: f64| f64::from(device.stored_depth(format, z as f32));
    let error = |z: f64| (stored(z) - z).abs() / z;
    let bound = |z: f64| match z < kept_from {
        true => 1.0,
        false => (format.quantum(z as f32) / 2.0 / z).min(1.0),
    };
    let event = "a depth is stored as more than 0";
    let formula = if device.flush_denormals {
        "the device flushes subnormals: 2⁻¹²⁶"
    } else {
        "half of the smallest value that the format has"
    };
    let forecast =
        Forecast::at(Fate::Degrades, kept_from, name, event, formula).curve(&depths, bound);
    let measured = onset(1e-46, 1.0, 500, |z| stored(z) > 0.0);
    forecast.met(measured, depths.iter().map(|&z| (z, error(z))).collect())
}

/// Depths down to the smallest subnormal.
pub(super) fn vanishing(_: &Sampling) -> Stress {
    let ideal = DeviceProfile::Ideal.device();
    let flushing = DeviceProfile::WebglSwiftshader.device();
    let row =
        |&f: &DepthFormat| vanishing_row(format!("smallest-{f}"), &ideal, f, smallest_kept(f));
    let mut rows: Vec<Row> = DepthFormat::ALL.iter().map(row).collect();
    let name = "smallest-f32-flushed".to_string();
    rows.push(vanishing_row(name, &flushing, DepthFormat::F32, exp2(-126)));
    Stress {
        id: "smallest-depth",
        title: "Depths next to 0",
        lead: "Window depths down to f32's subnormals (reversed depth far away) through every format: \
               from which depth on is more than 0 stored? The curve is the relative error, the theory \
               half a step of the format."
            .to_string(),
        parameter: "window depth",
        error: "relative error of the stored depth",
        scale: Scale::Log,
        rows,
    }
}

/// A depth is broken where it comes back wrong by more than this.
const BROKEN: f64 = 1.0 / 64.0;

/// Depths to look at: a grid, the neighbourhoods of k/255, the last floats below 1, and 1 itself.
fn depths_to_one() -> Vec<f32> {
    let grid = (1..1024).map(|i| i as f32 / 1024.0);
    let codes = (1..255).flat_map(|k| {
        let at = ordinal((f64::from(k) / 255.0) as f32);
        (-1..=1).map(move |step| from_ordinal(at + step))
    });
    let last = (0..=256).map(|i| from_ordinal(ordinal(1.0) - i));
    let mut all: Vec<f32> = grid.chain(codes).chain(last).collect();
    all.sort_by(f32::total_cmp);
    all
}

/// The round trip of a packing in real numbers, through correctly rounded bytes.
fn real_error(packing: Packing, z: f32) -> f64 {
    let bytes =
        packing.pack_in(f64::from(z)).map(|c| (c.clamp(0.0, 1.0) * 255.0).round_ties_even());
    (packing.unpack_in(bytes.map(|k| k / 255.0)) - f64::from(z)).abs()
}

/// The round-trip error in the subject's f32 on a device.
fn subject_error(device: &Device, packing: Packing, z: f32) -> f64 {
    let bytes = packing.pack(z).map(|c| device.store.code(device.flush(c), 255));
    let read = packing.unpack(bytes.map(|k| device.load.value(k, 255)));
    (f64::from(read) - f64::from(z)).abs()
}

fn first_broken(depths: &[f32], error: impl Fn(f32) -> f64) -> Option<f64> {
    depths.iter().find(|&&z| !(error(z) <= BROKEN)).map(|&z| f64::from(z))
}

/// The packings whose forecasts are alike, as one row: what their formulas mean in real numbers, against
/// what f32 does.
fn packings_row(name: &str, event: &str, depths: &[f32], group: &[(Packing, Option<f64>)]) -> Row {
    let device = DeviceProfile::Ideal.device();
    let formula = "the packing's formula in real numbers through exact bytes";
    let earliest = |firsts: &mut dyn Iterator<Item = Option<f64>>| {
        firsts.flatten().fold(None, |a: Option<f64>, b| Some(a.map_or(b, |a| a.min(b))))
    };
    let worst = |z: f32, error: &dyn Fn(Packing, f32) -> f64| {
        group.iter().map(|&(p, _)| error(p, z)).fold(0.0, f64::max)
    };
    let shown: Vec<f32> = depths.iter().copied().step_by(64).chain([1.0]).collect();
    let forecast = match earliest(&mut group.iter().map(|g| g.1)) {
        Some(onset) => Forecast::at(Fate::Breaks, onset, name, event, formula),
        None => Forecast::never(name, event, formula),
    };
    let theory = shown.iter().map(|&z| (f64::from(z), worst(z, &real_error))).collect();
    let seen = |p: Packing| first_broken(depths, |z| subject_error(&device, p, z));
    let measured = earliest(&mut group.iter().map(|g| seen(g.0)));
    let other = |g: &&(Packing, Option<f64>)| match (g.1, seen(g.0)) {
        (Some(a), Some(b)) => (a - b).abs() > 1e-6,
        (a, b) => a != b,
    };
    let unlike: Vec<_> = group.iter().filter(other).map(|g| g.0.name()).collect();
    let names: Vec<_> = group.iter().map(|g| g.0.name()).collect();
    let agreement = match unlike.is_empty() {
        true => "each as forecast".to_string(),
        false => format!("not as forecast: {}", unlike.join(", ")),
    };
    let subject = |p: Packing, z: f32| subject_error(&device, p, z);
    let curve = shown.iter().map(|&z| (f64::from(z), worst(z, &subject))).collect();
    let note = format!("{} packings, {agreement}: {}.", group.len(), names.join(", "));
    Forecast { theory, ..forecast }.met(measured, curve).noting(note)
}

/// Depth 1 and its neighbours through every packing and format.
pub(super) fn one(_: &Sampling) -> Stress {
    let depths = depths_to_one();
    let forecast = |&p: &Packing| (p, first_broken(&depths, |z| real_error(p, z)));
    let own = |p: &&Packing| p.original() == **p;
    let all: Vec<_> = Packing::ALL.iter().filter(own).map(forecast).collect();
    let group = |wanted: &dyn Fn(Option<f64>) -> bool| -> Vec<_> {
        all.iter().copied().filter(|g| wanted(g.1)).collect()
    };
    let event = "a depth comes back wrong by more than 1/64";
    let groups = [
        ("packings-that-wrap", group(&|at| at == Some(1.0))),
        ("packings-broken-before", group(&|at| at.is_some_and(|z| z < 1.0))),
        ("packings-that-hold", group(&|at| at.is_none())),
    ];
    let filled = groups.iter().filter(|g| !g.1.is_empty());
    let mut rows: Vec<Row> = filled.map(|(n, g)| packings_row(n, event, &depths, g)).collect();
    rows.push(formats_row(&depths, event));
    Stress {
        id: "depth-one",
        title: "Depth 1 and its neighbours",
        lead: "Window depths up to 1 − 2⁻²⁴ and 1 itself, and the neighbours of every k/255, through \
               every packing and format. A packing that returns 0 for 1 puts an occluder at the near \
               plane wherever nothing is."
            .to_string(),
        parameter: "window depth",
        error: "worst error of the depth read back",
        scale: Scale::Linear,
        rows,
    }
}

fn formats_row(depths: &[f32], event: &str) -> Row {
    let device = DeviceProfile::Ideal.device();
    let error = |z: f32| {
        let of = |&f: &DepthFormat| f64::from(device.stored_depth(f, z) - z).abs();
        DepthFormat::ALL.iter().map(of).fold(0.0, f64::max)
    };
    let shown: Vec<f64> = depths.iter().step_by(64).chain([&1.0]).map(|&z| f64::from(z)).collect();
    let coarsest = 0.5 / 255.0;
    let exact = DepthFormat::ALL.iter().filter(|&&f| device.stored_depth(f, 1.0) == 1.0).count();
    let note = format!("{exact} of {} formats return 1 for 1 exactly.", DepthFormat::ALL.len());
    Forecast::never("formats-at-one", event, "half a step of the coarsest format, 1/510")
        .curve(&shown, |_| coarsest)
        .met(first_broken(depths, error), shown.iter().map(|&z| (z, error(z as f32))).collect())
        .noting(note)
}
