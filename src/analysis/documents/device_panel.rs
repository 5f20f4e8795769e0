//! The panel that measures the reader's GPU: packings as shaders, and what devices are predicted to do.

use crate::depth::arith::{Folded, Mediump, Shader};
use crate::depth::{DepthFormat, Packing, UnormLoad, UnormStore};
use crate::device::{self, Device, DeviceProfile};
use crate::raster::probe::OffsetProbe;
use crate::report::gpu::{GpuPanel, KnownDevice, Predicted, ShaderPair};
use crate::report::{Block, Section};
use serde_json::{Map, Value, json};

/// Devices whose numbers stand beside the measured ones.
const DEVICES: [DeviceProfile; 2] = [DeviceProfile::Ideal, DeviceProfile::WebglSwiftshader];
/// Depths between the byte edges.
const SPREAD: u32 = 4096;
/// Depth textures that the panel probes.
const FORMATS: [DepthFormat; 3] = [DepthFormat::Unorm16, DepthFormat::Unorm24, DepthFormat::F32];

/// The panel's section.
pub(super) fn section() -> Section {
    let mut section = Section::new(
        "this-gpu",
        "Measure this GPU",
        "The numbers above are of an emulated device. This runs the same packings and depth formats on \
         the one in front of you: a phone shows its true mediump.",
    );
    section.push(panel());
    section.push(
        "The copied JSON is a device profile: save it and give it to the command below, which names \
         what differs from the known devices.",
    );
    section.push(Block::Code {
        language: "shell".to_string(),
        text: "gnomon-conformance --device FILE.json".to_string(),
    });
    section
}

/// The panel with all packings that have shaders.
fn panel() -> GpuPanel {
    let depths = depths();
    let pairs = Packing::with_source().map(|(packing, source)| ShaderPair {
        name: packing.name().to_string(),
        glsl: source.glsl.to_string(),
        wgsl: source.wgsl.to_string(),
        predicted: predictions(packing, &depths),
    });
    GpuPanel {
        id: "gpu".to_string(),
        title: "Packings and depth formats on this device".to_string(),
        caption:
            "Runs here, sends nothing: measured errors beside those predicted for an ideal device, \
                  for the emulated WebGL and for half-precision mediump."
                .to_string(),
        pairs: pairs.collect(),
        depths,
        devices: DEVICES.iter().map(|profile| known(&profile.device())).collect(),
    }
}

/// On and beside every byte edge, and between them by the golden ratio: no digit is special.
fn depths() -> Vec<f32> {
    let edges = (0..255u32).flat_map(|k| {
        let edge = (f64::from(k) / 255.0) as f32;
        [edge, edge.next_up(), edge.next_down().max(0.0)]
    });
    let spread = (0..SPREAD).map(|i| {
        let turn = f64::from(i) * 0.618_033_988_749_894_9;
        (turn - turn.floor()) as f32
    });
    let mut depths: Vec<f32> = edges.chain(spread).filter(|z| *z < 1.0).collect();
    depths.sort_by(f32::total_cmp);
    depths.dedup();
    depths
}

fn predictions(packing: Packing, depths: &[f32]) -> Vec<Predicted> {
    // Chromium's shader compiler folds constant divisors; the ideal device divides.
    let on_device = |profile: &DeviceProfile| {
        let Device { store, load, .. } = profile.device();
        let run = match profile {
            DeviceProfile::WebglSwiftshader => predicted::<Folded>,
            DeviceProfile::Ideal | DeviceProfile::DesktopFma | DeviceProfile::Truncating => {
                predicted::<f32>
            }
        };
        run(packing, depths, profile.name(), "highp", (store, load))
    };
    let rules = (UnormStore::Exact, UnormLoad::Half);
    let half = predicted::<Mediump>(packing, depths, "half precision", "mediump", rules);
    DEVICES.iter().map(on_device).chain([half]).collect()
}

/// Packed, stored, sampled and unpacked in one arithmetic.
fn predicted<A: Shader<Raw = f32>>(
    packing: Packing,
    depths: &[f32],
    on: &str,
    precision: &'static str,
    (store, load): (UnormStore, UnormLoad),
) -> Predicted {
    let through = |z: f32| -> (f64, bool) {
        let packed = packing.pack_in(A::enter(z));
        let sampled = packed.map(|c| A::enter(load.value(store.code(c.leave(), 255), 255)));
        let z = packing.unpack_in(sampled);
        (f64::from(z.leave()), z.is_sound() && packed.iter().all(|c| c.is_sound()))
    };
    let mut overflows = false;
    let mut max_error: f64 = 0.0;
    for &depth in depths {
        let (back, sound) = through(depth);
        overflows |= !sound;
        let error = (back - f64::from(depth)).abs();
        max_error = f64::max(max_error, if error.is_nan() { f64::INFINITY } else { error });
    }
    Predicted { on: on.to_string(), precision, max_error, one: through(1.0).0, overflows }
}

/// A profile's fields, what its depth textures keep, and its polygon offset.
fn known(device: &Device) -> KnownDevice {
    let mut facts: Map<String, Value> =
        device::FIELDS.iter().map(|f| (f.name.to_string(), json!(f.get(device)))).collect();
    for format in FORMATS {
        let name = format.name();
        let probe = OffsetProbe::of(device, format);
        facts.insert(format!("{name}_keeps"), json!(device.depth_format(format).name()));
        facts.insert(format!("{name}_r"), json!(probe.r));
        facts.insert(format!("{name}_one_unit"), json!(probe.one_unit));
    }
    KnownDevice { name: device.profile.name().to_string(), facts }
}
