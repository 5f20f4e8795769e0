//! Facts of a format: one home, held to the certificates and to what the sweeps draw with.

use gnomon::analysis::sweep::Field;
use gnomon::analysis::sweep::chart::{Attachment, Chart};
use gnomon::analysis::tune::{self, Request};
use gnomon::depth::{DepthFormat, Packing};
use gnomon::device::{DeviceProfile, OffsetUnit};
use gnomon::engines::Engine;
use gnomon::report::Profile;
use gnomon::scene::{Case, DepthBuffer, Filter, LookupSpec, TexelFormat, cases};
use gnomon::shadow::bias::{Strategy, Unit};
use serde_json::Value;

fn certificates() -> Value {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/reports/roundtrip/results.json");
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

#[test]
fn the_worst_errors_are_those_certified() {
    let table = concat!(env!("CARGO_MANIFEST_DIR"), "/reports/roundtrip/results.csv");
    let text = std::fs::read_to_string(table).unwrap();
    let mut seen = 0;
    for line in text.lines().skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        let packing: Packing = cells[0].parse().unwrap();
        assert_eq!(packing.worst_error(), cells[2].parse::<f64>().unwrap(), "{packing}");
        seen += 1;
    }
    assert_eq!(seen, Packing::ALL.len(), "a certificate for each packing");
}

#[test]
fn a_depth_format_errs_by_half_its_widest_step_as_certified() {
    let formats = certificates()["formats"].as_array().unwrap().clone();
    assert_eq!(formats.len(), DepthFormat::ALL.len());
    for (certificate, &format) in formats.iter().zip(DepthFormat::ALL) {
        let max = certificate["max"].as_f64().unwrap();
        // The store's product with 2³² − 1 rounds in f64.
        let close = (max - format.worst_error()).abs() <= 1e-6 * max;
        assert!(close, "{format}: {max:e} certified, {:e} said", format.worst_error());
    }
}

#[test]
fn a_step_is_what_a_format_keeps() {
    let step = |name: &str| {
        let all = TexelFormat::all().find(|f| f.name() == name).unwrap();
        all.step(0.7)
    };
    assert_eq!(step("unorm8"), 1.0 / 255.0);
    assert_eq!(step("unorm24"), 1.0 / 16_777_215.0);
    assert_eq!(step("f32"), gnomon::num::exp2(-24), "in [1/2, 1)");
    assert_eq!(step("playcanvas-bits"), step("f32"), "it loses nothing");
    assert_eq!(step("digits-32"), gnomon::num::exp2(-32));
    // 32 bits stored, 9 kept: the first byte is rounded, the others do not mend it.
    assert!((step("book") * 255.0 - 1.0).abs() < 0.005, "{}", step("book"));
    assert!((step("r8") * 255.0 - 1.0).abs() < 2e-5, "{}", step("r8"));
    assert_eq!(step("forge"), 1.0, "it tells nothing apart");
    for format in TexelFormat::all() {
        let step = format.step(0.5);
        assert!(step > 0.0 && step <= 1.0, "{}: {step}", format.name());
        assert!(step >= format.worst_error() || step == 1.0, "{}", format.name());
        assert!(format.bytes().is_power_of_two() && format.bytes() <= 4, "{}", format.name());
    }
}

#[test]
fn a_packing_counts_in_the_attachment_under_it() {
    let device = DeviceProfile::Ideal.device();
    assert_eq!(device.offset_unit, OffsetUnit::Specification);
    let r = |format: TexelFormat, under| format.resolvable(&device, under, 0.75);
    let book = TexelFormat::Packed(Packing::Book);
    assert_eq!(r(book, DepthBuffer::Unorm16), gnomon::num::exp2(-16) as f32);
    assert_eq!(r(book, DepthBuffer::Texture), gnomon::num::exp2(-24) as f32);
    let unorm32 = TexelFormat::Depth(DepthFormat::Unorm32);
    assert_eq!(r(unorm32, DepthBuffer::Texture), gnomon::num::exp2(-32) as f32);
}

/// How far the sweep has lifted the receiver's own surface under a strategy's amount: window depth.
fn lifted(chart: &Chart<'_, '_>, receiver: usize, format: TexelFormat, of: (Strategy, f32)) -> f64 {
    let looks = chart.looks(format, &of.0.with(of.1));
    let look = &looks[receiver];
    look.taps[look.centre].gained
}

/// An engine's value times what `place` says one unit lifts is what the sweep lifts, for every format,
/// every attachment under a packing, and every engine that counts in raster units.
#[test]
fn an_engines_value_is_worth_what_the_sweep_lifts() {
    let mut compared = 0;
    for (name, under, profile) in [
        ("t1-tilted-plane", DepthBuffer::Texture, DeviceProfile::Ideal),
        ("t1-tilted-plane", DepthBuffer::Unorm16, DeviceProfile::Ideal),
        ("fundamentals-spot", DepthBuffer::Texture, DeviceProfile::Ideal),
        ("fundamentals-spot", DepthBuffer::Unorm16, DeviceProfile::WebglSwiftshader),
    ] {
        let mut case = cases::named(name).unwrap();
        (case.map.depth_buffer, case.device) = (under, profile);
        let field = Field::new(&case, 16);
        let charts = [Attachment::Depth, Attachment::Colour]
            .map(|a| Chart::new(&field, 256, Filter::Nearest, a));
        for format in TexelFormat::all() {
            let chart = &charts[usize::from(format.is_packed())];
            let receiver = own_surface(chart, format);
            let place = tune::place_at(&field, &field.samples[receiver], chart.size, format);
            for &engine in Engine::ALL {
                for knob in engine.knobs().iter().filter(|k| is_raster(k.strategy)) {
                    // More than a step of 8 bits and of the depths' own rounding.
                    let amount = place.amount(knob.strategy, 0.01).unwrap();
                    let value = knob.value(amount);
                    let amount = (value / knob.scale) as f32;
                    let says = place.window(knob.strategy, amount.into()).unwrap();
                    let drawn = lifted(chart, receiver, format, (knob.strategy, amount));
                    // The rounding of an f32 depth.
                    let close = (drawn - says).abs() <= 2e-7;
                    assert!(
                        close,
                        "{name} {} {engine} {} = {value}: {says:e} said, {drawn:e} drawn",
                        format.name(),
                        knob.name
                    );
                    compared += 1;
                }
            }
        }
    }
    let formats = TexelFormat::all().count();
    assert!(compared >= 4 * formats * 9, "only {compared} were compared");
}

fn is_raster(strategy: Strategy) -> bool {
    matches!(strategy.unit(), Unit::UnitsR | Unit::TenthsOfASlope)
        || strategy == Strategy::SlopeRaster
}

/// A receiver whose texel holds its own triangle: there the lift is that of its own caster.
fn own_surface(chart: &Chart<'_, '_>, format: TexelFormat) -> usize {
    let size = f64::from(chart.size);
    let raster = &chart.field.observer.subject;
    let holds = |&i: &usize| {
        let sample = &chart.field.samples[i];
        let [u, v, _] = sample.coord.map(f64::from);
        let setup = raster.map_setup(sample.receiver.triangle, sample.map, &chart.layout);
        let [x, y] = [u, v].map(|c| (c * size) as u32);
        let mut inside = false;
        setup.cover(&raster.device, [chart.size; 2], gnomon::scene::Cull::None, |row, from, to| {
            inside |= row == y && (from..to).contains(&x);
        });
        inside && sample.lit
    };
    let all = 0..chart.field.samples.len();
    all.into_iter().find(holds).unwrap_or_else(|| panic!("no own surface under {}", format.name()))
}

fn tuned(case: Case, engine: Engine) -> Value {
    let request = Request {
        case,
        engine,
        max_acne: 0.001,
        profile: Profile::Quick,
        seed: 1,
        command: String::new(),
    };
    tune::report(&request).results
}

/// A float map under Vulkan once printed a bias of twice the whole depth range.
#[test]
fn a_float_map_is_tuned_in_its_own_unit() {
    let f16 = TexelFormat::Depth(DepthFormat::F16);
    let case = cases::named("runnable-rgba8").unwrap();
    let filter = f16.usable(case.lookup.filter);
    let lookup = LookupSpec { filter, ..case.lookup };
    let case = Case { map: case.map.with(case.map.size, f16), lookup, ..case };
    let results = tuned(case, Engine::Vulkan);
    let units = results["values"]["depthBiasConstantFactor"].as_f64().unwrap();
    assert!((units - 4086.68).abs() < 0.01, "{units}");
    let window = results["window_depth"].as_f64().unwrap();
    assert!((window - 2.4e-4).abs() < 1e-5, "{window}");
}

/// The unit of 32 bits is so small that factors were capped before any of them was enough: 3×3 texels of
/// this plane need 1.5 s·|g| = 0.0088 window depth, 3.8e7 units of 2⁻³².
#[test]
fn the_finest_format_finds_its_factor() {
    let units = |format| {
        let format = TexelFormat::Depth(format);
        let mut case = cases::named("t1-tilted-plane").unwrap();
        (case.device, case.lookup.filter) = (DeviceProfile::Ideal, Filter::Pcf3);
        let results = tuned(Case { map: case.map.with(64, format), ..case }, Engine::Vulkan);
        results["values"]["depthBiasConstantFactor"].as_f64().expect("a factor")
    };
    let (fine, coarse) = (units(DepthFormat::Unorm32), units(DepthFormat::Unorm24));
    assert!(fine > gnomon::num::exp2(24), "{fine}");
    let ratio = fine / coarse / 256.0;
    assert!((ratio - 1.0).abs() < 0.01, "{fine} of r = 2⁻³², {coarse} of 2⁻²⁴");
}
