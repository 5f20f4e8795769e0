//! A GPU panel with packings in GLSL, and what the emulated device predicts for them.

use gnomon::depth::{Packing, UnormLoad, UnormStore};
use gnomon::report::GpuPanel;
use gnomon::report::gpu::{Predicted, ShaderPair};

use crate::explored::Random;

const R8: &str = "vec4 pack(float z) { return vec4(z, 0.0, 0.0, 0.0); }
float unpack(vec4 c) { return c.r; }";
const BOOK: &str = "vec4 pack(float z) {
  vec4 c = fract(z * vec4(1.0, 256.0, 256.0 * 256.0, 256.0 * 256.0 * 256.0));
  return c - c.gbaa * vec4(1.0 / 256.0, 1.0 / 256.0, 1.0 / 256.0, 0.0);
}
float unpack(vec4 c) {
  return dot(c, vec4(1.0, 1.0 / 256.0, 1.0 / (256.0 * 256.0), 1.0 / (256.0 * 256.0 * 256.0)));
}";
const ARAS: &str = "vec4 pack(float z) {
  vec4 c = fract(vec4(1.0, 255.0, 65025.0, 16581375.0) * z);
  return c - c.yzww * vec4(1.0 / 255.0, 1.0 / 255.0, 1.0 / 255.0, 0.0);
}
float unpack(vec4 c) {
  return dot(c, vec4(1.0, 1.0 / 255.0, 1.0 / 65025.0, 1.0 / 16581375.0));
}";

/// Values on and beside byte boundaries, and random ones.
fn depths() -> Vec<f32> {
    let mut random = Random(11);
    let edges = (0..255).flat_map(|k| {
        let edge = k as f32 / 255.0;
        [edge, edge.next_up(), edge.next_down().max(0.0)]
    });
    let inner = (0..20_000).map(|_| (random.next() >> 40) as f32 / (1_u64 << 24) as f32);
    edges.chain(inner).collect()
}

fn predicted(packing: Packing, depths: &[f32]) -> Predicted {
    let through = |z: f32| {
        let stored = packing.pack(z).map(|x| UnormStore::HalfEven.code(x, 255));
        f64::from(packing.unpack(stored.map(|k| UnormLoad::Reciprocal.value(k, 255))))
    };
    let error = |z: &f32| (through(*z) - f64::from(*z)).abs();
    Predicted { max_error: depths.iter().map(error).fold(0.0, f64::max), one: through(1.0) }
}

/// The panel of three pairs.
pub(crate) fn panel() -> GpuPanel {
    let depths = depths();
    let pair = |(packing, glsl): (Packing, &str)| ShaderPair {
        name: packing.name().into(),
        glsl: glsl.into(),
        highp: Some(predicted(packing, &depths)),
        mediump: None,
    };
    let pairs = [(Packing::R8, R8), (Packing::Book, BOOK), (Packing::Aras2009, ARAS)];
    GpuPanel {
        id: "gpu".into(),
        title: "Measure this GPU".into(),
        caption: "Runs the packings on your own device.".into(),
        pairs: pairs.map(pair).to_vec(),
        depths,
    }
}
