//! What the page's scripts read of explorers and panels: a JSON description and a blob of arrays.

use serde::Serialize;

use crate::report::blob::{Blob, Slice};
use crate::report::explorer::{Detail, Explorer, Values, View};
use crate::report::gpu::{GpuPanel, Predicted};
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
    rungs: Vec<Slice>,
    fields: Vec<FieldView<'a>>,
}

#[derive(Serialize)]
struct FieldView<'a> {
    name: &'a str,
    unit: &'a str,
    names: &'a [String],
    values: Slice,
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
        views: explorer.views.iter().map(|view| pack_view(view, &mut blob)).collect(),
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
}

#[derive(Serialize)]
struct PairView<'a> {
    name: &'a str,
    glsl: &'a str,
    highp: Option<Predicted>,
    mediump: Option<Predicted>,
}

/// A panel's description and its depths.
pub(in crate::report) fn pack_panel(panel: &GpuPanel) -> (String, String) {
    let mut blob = Blob::default();
    let depths = blob.floats(panel.depths.iter().copied());
    let pairs = panel.pairs.iter().map(|pair| PairView {
        name: &pair.name,
        glsl: &pair.glsl,
        highp: pair.highp,
        mediump: pair.mediump,
    });
    let pairs = pairs.collect();
    (in_script(&PanelDescription { depths, pairs }), blob.to_text())
}

fn pack_view<'a>(view: &'a View, blob: &mut Blob) -> ViewView<'a> {
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
        rungs: view
            .detail
            .rungs
            .iter()
            .map(|r| blob.floats(r.breakpoints.iter().copied()))
            .collect(),
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

fn fields<'a>(detail: &'a Detail, blob: &mut Blob) -> Vec<FieldView<'a>> {
    let pack = |field: &'a crate::report::explorer::Field| {
        let (values, names): (Slice, &[String]) = match &field.values {
            Values::Numbers(values) => (blob.floats(values.iter().copied()), &[]),
            Values::Integers(values) => (blob.integers(values), &[]),
            Values::Names(codes, names) => (blob.bytes(codes.iter().copied()), names),
        };
        FieldView { name: &field.name, unit: &field.unit, names, values }
    };
    detail.fields.iter().map(pack).collect()
}
