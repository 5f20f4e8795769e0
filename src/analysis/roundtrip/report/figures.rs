//! The report's figures: heat map, error against depth, filters, world-space resolution.

use super::{Measured, SETTINGS};
use crate::analysis::roundtrip::conditions::Conditions;
use crate::analysis::roundtrip::curve::error_curve;
use crate::analysis::roundtrip::filter::{FilterResult, FilterSweep, Slope, max_at};
use crate::analysis::roundtrip::world::WorldResolution;
use crate::depth::{ByteStore, DepthFormat, DepthMapping, MappingKind, Packing};
use crate::report::{
    Axis, Block, Cell, Colour, ExrImage, HeatMap, Plot, Scale, Section, Series, Style, Table,
};
use serde_json::json;

/// Slices of depth in an error plot.
const SLICES: usize = 64;
/// The planes of the resolution figures.
const NEAR: f64 = 0.1;
const FAR: f64 = 1000.0;
/// Distances in a resolution figure.
const RESOLUTION_POINTS: usize = 120;
/// Depth × fraction of the filter image. Depths (i + ½)/240 and a step of 1/1000 have all their digits
/// in use; on dyadic depths the low bytes would be 0 and filtering look harmless.
const SWEEP: (usize, usize) = (240, 33);
const STEP: f32 = 1.0 / 1000.0;

/// Packing × store, sampler, arithmetic.
pub(super) fn heat(measured: &Measured) -> Section {
    let mut section = Section::new(
        "heat",
        "Every packing on every hardware",
        "The largest error below the far plane; rows that stay dark are safe everywhere.",
    );
    let errors = measured.dossiers.iter().flat_map(|d| &d.certificates);
    section.push(HeatMap {
        id: "heat-map".into(),
        title: "Largest error".into(),
        caption: "Stores, samplers and arithmetics across; hardware of each kind exists.".into(),
        row_name: "packing".into(),
        column_name: "store, sampler or arithmetic".into(),
        rows: measured.dossiers.iter().map(|d| d.name.clone()).collect(),
        columns: SETTINGS.iter().map(|s| s.name.to_string()).collect(),
        values: errors.map(|c| Some(c.max.error)).collect(),
        scale: Scale::Log,
        unit: String::new(),
        digits: 2,
    });
    section
}

/// Error against depth, one figure per pair of operations.
pub(super) fn curves(measured: &Measured) -> Section {
    let mut section = Section::new(
        "curves",
        "Error against depth",
        "Largest error in 64 slices of depth, f32, a store that rounds and one that truncates; \
         dashed, the proved bound. Packings with the same operations share a figure.",
    );
    let plots: Vec<Plot> = measured.distinct().filter_map(|d| d.packing).map(curve).collect();
    push_in_pairs(&mut section, plots);
    section.folded()
}

fn push_in_pairs(section: &mut Section, plots: Vec<Plot>) {
    for pair in plots.chunks(2) {
        section.push(Block::Row(pair.iter().cloned().map(Block::Plot).collect()));
    }
}

fn curve(packing: Packing) -> Plot {
    let mut series = Vec::new();
    let stores = [(ByteStore::Truncate, Colour::Orange), (ByteStore::HalfEven, Colour::Blue)];
    for (store, colour) in stores {
        let slices = error_curve(packing, Conditions::plain(store), SLICES);
        let line = |name: String, style, points| Series { name, style, colour, points };
        let measured = slices.iter().map(|s| (s.depth, s.measured)).collect();
        let theory: Vec<(f64, f64)> =
            slices.iter().filter_map(|s| Some((s.depth, s.theory?))).collect();
        series.push(line(format!("{store}, measured"), Style::Steps, measured));
        if !theory.is_empty() {
            series.push(line(format!("{store}, bound"), Style::Theory, theory));
        }
    }
    Plot {
        id: format!("curve-{packing}"),
        title: format!("{packing}: error against depth"),
        caption: packing.about(),
        x: Axis { range: Some((0.0, 1.0)), ..Axis::linear("window depth") },
        // One scale for all, so that figures compare.
        y: Axis { range: Some((1e-11, 1.0)), ..Axis::log("largest error [window depth]") },
        series,
        markers: Vec::new(),
    }
}

/// LINEAR filtering: a table of every packing, and an image of some.
pub(super) fn filters(fraction: f32) -> Section {
    let slope = Slope { step: STEP };
    let mut section = Section::new(
        "filter",
        "LINEAR filtering of packed bytes",
        "Two neighbouring texels 1/1000 apart in depth, every fraction between them: what the blend \
         of their bytes decodes to, less the blend of their depths. A sum of weighed bytes is linear \
         and survives a precise filter; an unpack that rounds digits does not, so read it with \
         NEAREST. Even where the blend is exact, an average of depths is no average of verdicts.",
    );
    let mut table =
        Table::new("filter-table", "Largest error over depths below 1 and all fractions.")
            .column("packing", "", "")
            .column("full precision", "window depth", "f32 weights and result, as measured")
            .column("fp16 result", "window depth", "16-bit samplers of phones")
            .column("8-bit result", "window depth", "mip maps, blurred byte targets")
            .column("worst fraction", "", "of the filter, full precision")
            .column(&format!("at {fraction}"), "window depth", "largest at this fraction alone");
    let mut images: Vec<(String, Vec<f32>)> = Vec::new();
    for &packing in Packing::ALL.iter().filter(|p| p.original() == **p) {
        let sweep = |result| FilterSweep::new(packing, result, slope, SWEEP.0, SWEEP.1);
        let full = sweep(FilterResult::Full);
        let other = [FilterResult::Half, FilterResult::Byte].map(|result| sweep(result).max());
        let numbers = [full.max(), other[0], other[1]].map(|error| Cell::Number(error, 3));
        let worst = Cell::Number(full.worst_fraction(), 3);
        let given = max_at(packing, FilterResult::Full, slope, SWEEP.0, fraction);
        let name = vec![packing.name().into()];
        table.push([name, numbers.to_vec(), vec![worst, Cell::Number(given, 3)]].concat());
        if [Packing::Book, Packing::Aras2009, Packing::ThreeRgba, Packing::Digits24]
            .contains(&packing)
        {
            images.push((format!("error.signed.{packing}"), full.errors));
        }
    }
    section.push(table);
    section.push(ExrImage {
        id: "filter-error".into(),
        width: SWEEP.0,
        height: SWEEP.1,
        channels: images,
        metadata: json!({
            "x": "window depth (i + 0.5)/width of the first texel",
            "y": "filter fraction, 0 at the bottom, 1 at the top",
            "values": "decoded(blend of bytes) - blend of depths, f32 weights",
            "step": slope.step,
        }),
    });
    section
}

/// World-space resolution against distance, one figure per mapping.
pub(super) fn resolution() -> Section {
    let mut section = Section::new(
        "resolution",
        "What one step is worth in the world",
        "Length from a stored depth to its neighbour, near 0.1, far 1000; dashed, the format's \
         quantum times dZ/dd. A bias below this length cannot work. In [1/2, 1) f32 steps like unorm24 \
         and bf16 like unorm8: their lines coincide.",
    );
    let formats = [
        DepthFormat::Unorm8,
        DepthFormat::Unorm16,
        DepthFormat::Unorm24,
        DepthFormat::F16,
        DepthFormat::Bf16,
        DepthFormat::F32,
    ];
    // Linear depth has the orthographic curve.
    let kinds = MappingKind::ALL.iter().filter(|&&kind| kind != MappingKind::Linear);
    let mapping = |&kind| DepthMapping::new(kind, NEAR, FAR).expect("valid planes");
    let plots = kinds.map(|kind| resolution_plot(mapping(kind), &formats)).collect();
    push_in_pairs(&mut section, plots);
    section.push(resolution_table(&formats));
    section
}

fn resolution_plot(mapping: DepthMapping, formats: &[DepthFormat]) -> Plot {
    let kind = mapping.kind();
    let mut series = Vec::new();
    for (i, &format) in formats.iter().enumerate() {
        let curve = WorldResolution { format, mapping }.curve(RESOLUTION_POINTS);
        let colour = Colour::series(i);
        let measured = curve.iter().map(|&(z, step, _)| (z, step.unwrap_or(f64::NAN))).collect();
        let theory = curve.iter().map(|&(z, _, theory)| (z, theory)).collect();
        let name = format.to_string();
        series.push(Series { name, style: Style::Line, colour, points: measured });
        if format == DepthFormat::Unorm16 {
            let name = "unorm16, theory".to_string();
            series.push(Series { name, style: Style::Theory, colour: Colour::Ink, points: theory });
        }
    }
    Plot {
        id: format!("resolution-{kind}"),
        title: format!("Resolution, {kind}"),
        caption: kind.about(),
        x: Axis::log("distance from the light [world]"),
        y: Axis::log("one step [world]"),
        series,
        markers: Vec::new(),
    }
}

fn resolution_table(formats: &[DepthFormat]) -> Table {
    const DISTANCES: [f64; 5] = [0.2, 1.0, 10.0, 100.0, 900.0];
    let mut table = Table::new("resolution-table", "One step in world units at five distances.")
        .column("mapping", "", "")
        .column("format", "", "");
    for z in DISTANCES {
        table = table.column(&format!("at {z}"), "world", "");
    }
    for &kind in MappingKind::ALL {
        let mapping = DepthMapping::new(kind, NEAR, FAR).expect("valid planes");
        for &format in formats {
            let world = WorldResolution { format, mapping };
            let steps = DISTANCES.iter().map(|&z| Cell::number(world.step_at(z)));
            let names = [kind.name().into(), format.name().into()];
            table.push(names.into_iter().chain(steps).collect());
        }
    }
    table
}
