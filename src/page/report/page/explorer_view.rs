//! What the page's scripts read of explorers and panels: a JSON description and a blob of arrays.

use serde::Serialize;

use crate::report::blob::{Blob, Slice};
use crate::report::explorer::{Detail, Explorer, Field, Values, View};
use crate::report::gpu::{GpuPanel, KnownDevice, Predicted};
use crate::report::palette::Colour;

#[derive(Serialize)]
struct Description<'a> {
    width: u32,
    height: u32,
    step: u32,
    bottom_up: bool,
    slider: SliderView<'a>,
    classes: Vec<(&'a str, [u8; 3])>,
    views: Vec<ViewView<'a>>,
}

#[derive(Serialize)]
struct SliderView<'a> {
    label: &'a str,
    low: f32,
    high: f32,
    value: f32,
    marks: &'a [(f32, String)],
}

#[derive(Serialize)]
struct ViewView<'a> {
    name: &'a str,
    command: &'a str,
    taps: usize,
    breakpoints: Slice,
    truth: Slice,
    shadowed: Slice,
    lit: Slice,
    lit_late: Slice,
    late: Slice,
    every: u32,
    causes: Vec<(&'a str, [u8; 3])>,
    rungs: Vec<RungView>,
    fields: Vec<FieldView<'a>>,
}

/// Distinct breakpoints in ascending order, and each grid sample's place among them.
#[derive(Serialize)]
struct RungView {
    sorted: Slice,
    ranks: Slice,
}

#[derive(Serialize)]
struct FieldView<'a> {
    name: &'a str,
    unit: &'a str,
    names: &'a [String],
    /// Lowest value and step of values that are rounded to steps of their range.
    steps: Option<[f64; 2]>,
    /// The two fields whose difference this one is.
    difference: Option<[usize; 2]>,
    values: Option<Slice>,
}

/// The description as JSON and the arrays as text, both safe inside a `script` element.
pub(in crate::report) fn pack(explorer: &Explorer) -> (String, String) {
    let mut blob = Blob::default();
    let slider = &explorer.slider;
    let description = Description {
        width: explorer.width,
        height: explorer.height,
        step: explorer.step.max(1),
        bottom_up: explorer.bottom_up,
        slider: SliderView {
            label: &slider.label,
            low: slider.low,
            high: slider.high,
            value: slider.value,
            marks: &slider.marks,
        },
        classes: explorer.classes.iter().map(|c| (c.name.as_str(), c.colour.rgb())).collect(),
        views: explorer
            .views
            .iter()
            .map(|view| pack_view(view, explorer.grid(view), &mut blob))
            .collect(),
    };
    (in_script(&description), blob.to_text())
}

/// JSON that cannot end the `script` element it stands in.
fn in_script(value: &impl Serialize) -> String {
    serde_json::to_string(value).expect("a description is JSON").replace('<', "\\u003c")
}

#[derive(Serialize)]
struct PanelDescription<'a> {
    depths: Slice,
    pairs: Vec<PairView<'a>>,
    devices: &'a [KnownDevice],
}

#[derive(Serialize)]
struct PairView<'a> {
    name: &'a str,
    glsl: &'a str,
    wgsl: &'a str,
    predicted: &'a [Predicted],
}

/// A panel's description and its depths.
pub(in crate::report) fn pack_panel(panel: &GpuPanel) -> (String, String) {
    let mut blob = Blob::default();
    let depths = blob.floats(panel.depths.iter().copied());
    let pairs = panel.pairs.iter().map(|pair| PairView {
        name: &pair.name,
        glsl: &pair.glsl,
        wgsl: &pair.wgsl,
        predicted: &pair.predicted,
    });
    let pairs = pairs.collect();
    (in_script(&PanelDescription { depths, pairs, devices: &panel.devices }), blob.to_text())
}

fn pack_view<'a>(
    view: &'a View,
    grid: impl Iterator<Item = (usize, usize)>,
    blob: &mut Blob,
) -> ViewView<'a> {
    let codes = &view.codes;
    ViewView {
        name: &view.name,
        command: &view.command,
        taps: view.taps,
        breakpoints: blob.floats(view.breakpoints.iter().copied()),
        truth: blob.bytes(view.truth.iter().map(|truth| *truth as u8)),
        shadowed: blob.bytes(codes.iter().map(|c| c.shadowed)),
        lit: blob.bytes(codes.iter().map(|c| c.lit)),
        lit_late: blob.bytes(codes.iter().map(|c| c.lit_late)),
        late: blob.floats(codes.iter().map(|c| c.late)),
        every: view.detail.every.max(1),
        causes: causes(&view.detail),
        rungs: view.rung_limits(grid).iter().map(|limits| ranked(limits, blob)).collect(),
        fields: fields(&view.detail, blob),
    }
}

fn causes(detail: &Detail) -> Vec<(&str, [u8; 3])> {
    if detail.rungs.is_empty() {
        return vec![];
    }
    let last = (detail.last_rung.0.as_str(), Colour::rgb(detail.last_rung.1));
    detail.rungs.iter().map(|r| (r.name.as_str(), r.colour.rgb())).chain([last]).collect()
}

/// A rung of at most 2¹⁶ samples (200 a side, as a rule) by ranks: the page compares integers.
fn ranked(limits: &[f32], blob: &mut Blob) -> RungView {
    let mut sorted = limits.to_vec();
    sorted.sort_by(f32::total_cmp);
    sorted.dedup();
    let rank = |limit: &f32| {
        let place = sorted.partition_point(|s| s < limit);
        u16::try_from(place).expect("a detail grid has at most 65536 samples")
    };
    let ranks = blob.ranks(limits.iter().map(rank));
    RungView { sorted: blob.floats(sorted.into_iter()), ranks }
}

fn fields<'a>(detail: &'a Detail, blob: &mut Blob) -> Vec<FieldView<'a>> {
    let pack = |field: &'a Field| {
        let mut view = FieldView {
            name: &field.name,
            unit: &field.unit,
            names: &[],
            steps: None,
            difference: None,
            values: None,
        };
        view.values = match &field.values {
            Values::Numbers(values) => Some(blob.floats(values.iter().copied())),
            Values::Integers(values) => Some(blob.integers(values)),
            Values::Names(codes, names) => {
                view.names = names;
                Some(blob.bytes(codes.iter().copied()))
            }
            Values::Rounded(values) => {
                let (low, step) = range(values);
                view.steps = Some([low, step]);
                Some(blob.ranks(values.iter().map(|v| steps_above(*v, low, step))))
            }
            Values::Difference(a, b) => {
                view.difference = Some([*a, *b]);
                None
            }
        };
        view
    };
    detail.fields.iter().map(pack).collect()
}

/// How many steps a range is rounded to; one more code means a missing value.
const STEPS: u16 = u16::MAX - 1;

/// The lowest value, and a step of which [`STEPS`] reach the highest.
fn range(values: &[f32]) -> (f64, f64) {
    let finite = || values.iter().filter(|v| v.is_finite()).map(|v| f64::from(*v));
    let low = finite().fold(f64::INFINITY, f64::min);
    let high = finite().fold(f64::NEG_INFINITY, f64::max);
    if high > low { (low, (high - low) / f64::from(STEPS)) } else { (low.min(f64::MAX), 0.0) }
}

fn steps_above(value: f32, low: f64, step: f64) -> u16 {
    let steps = (f64::from(value) - low) / step;
    match (value.is_finite(), steps.is_finite()) {
        (false, _) => u16::MAX,
        (true, false) => 0,
        (true, true) => (steps.round_ties_even() as u16).min(STEPS),
    }
}
