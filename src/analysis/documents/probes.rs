//! Numbers behind the findings that no case measures: packings, clear colours, mediump, filtering.

use crate::depth::Packing;
use crate::depth::arith::{Mediump, Shader};
use crate::device::Device;
use crate::scene::Wrap;
use crate::shadow::sampler;
use serde_json::{Map, Value, json};

/// Depths per packing: evenly spaced over [0,1), each in the middle of its step.
const DEPTHS: u32 = 1 << 20;

/// Packings that the findings compare.
const PACKINGS: [Packing; 5] =
    [Packing::R8, Packing::Book, Packing::Upc, Packing::Aras2009, Packing::ThreeRgba];

/// All probes on one device, as they stand under `probes` in `results.json`.
pub(super) fn probes(device: &Device) -> Value {
    let named = |f: &dyn Fn(Packing) -> Value| -> Map<String, Value> {
        PACKINGS.iter().map(|&p| (p.name().replace('-', "_"), f(p))).collect()
    };
    json!({
        "packing_max_error": named(&|p| json!(max_error(device, p))),
        "packing_of_one": named(&|p| json!(f64::from(round_trip(device, p, 1.0)))),
        "clear": {
            "book_opaque_black": clear(device, Packing::Book, [0, 0, 0, 255]),
            "upc_transparent_black": clear(device, Packing::Upc, [0; 4]),
            "upc_opaque_black": clear(device, Packing::Upc, [0, 0, 0, 255]),
        },
        "mediump": mediump(),
        "linear": linear(device),
        "byte": { "steps": 255, "printed_step": 0.039_062_5, "step_256": 1.0 / 256.0,
                  "step_255": 1.0 / 255.0 },
    })
}

fn store(device: &Device, c: [f32; 4]) -> [u8; 4] {
    c.map(|x| device.store.code(x, 255) as u8)
}

fn load(device: &Device, packing: Packing, bytes: [u8; 4]) -> f32 {
    packing.unpack(bytes.map(|b| device.load.value(u32::from(b), 255)))
}

fn round_trip(device: &Device, packing: Packing, z: f32) -> f32 {
    load(device, packing, store(device, packing.pack(z)))
}

fn clear(device: &Device, packing: Packing, bytes: [u8; 4]) -> f64 {
    f64::from(load(device, packing, bytes))
}

/// Largest |decoded − depth| over the evenly spaced depths.
fn max_error(device: &Device, packing: Packing) -> f64 {
    let error = |i: u32| {
        let z = (f64::from(i) + 0.5) / f64::from(DEPTHS);
        (f64::from(round_trip(device, packing, z as f32)) - f64::from(z as f32)).abs()
    };
    (0..DEPTHS).map(error).fold(0.0, f64::max)
}

/// The book's packing when every operation rounds to half precision.
fn mediump() -> Value {
    let overflowing = (0..4096u32).filter(|i| {
        let z = Mediump::enter((*i as f32 + 0.5) / 4096.0);
        !Packing::Book.pack_in(z).iter().all(|c| c.is_sound())
    });
    let half = |x: f32| half::f16::from_f32(x);
    let step = f64::from(f32::from(half::f16::from_bits(half(0.75).to_bits() + 1))) - 0.75;
    json!({
        "largest_finite": 65_504.0,
        "factor": 16_777_216.0,
        "book_overflow_share": overflowing.count() as f64 / 4096.0,
        "step_at_three_quarters": step,
    })
}

/// LINEAR on the book's bytes: decode(filter) against filter(decode), with full and 8-bit weights.
fn linear(device: &Device) -> Value {
    let depths: Vec<f32> = (0..512).map(|i| 0.5 + i as f32 / 1024.0).collect();
    let texels: Vec<[u8; 4]> =
        depths.iter().map(|&z| store(device, Packing::Book.pack(z))).collect();
    let decoded: Vec<f32> = texels.iter().map(|&b| load(device, Packing::Book, b)).collect();
    let scale = device.load.value(1, 255);
    let (mut full, mut requantized): (f64, f64) = (0.0, 0.0);
    for i in 0..511u32 {
        for step in 0..32u32 {
            let uv = [(i as f32 + 0.5 + step as f32 / 32.0) / 512.0, 0.5];
            let mixed: [f32; 4] = std::array::from_fn(|c| {
                let fetch = |x: u32, _: u32| f32::from(texels[x as usize][c]);
                sampler::linear(fetch, [512, 1], Wrap::Clamp, uv) * scale
            });
            let ideal = sampler::linear(|x, _| decoded[x as usize], [512, 1], Wrap::Clamp, uv);
            let error = |c: [f32; 4]| (f64::from(Packing::Book.unpack(c)) - f64::from(ideal)).abs();
            full = full.max(error(mixed));
            let bytes = store(device, mixed).map(|b| device.load.value(u32::from(b), 255));
            requantized = requantized.max(error(bytes));
        }
    }
    json!({ "full_weights": full, "requantized": requantized })
}
