//! A GPU panel with every packing that has shaders, and what the emulated device predicts for them.

use gnomon::depth::arith::{Folded, Shader};
use gnomon::depth::{Packing, UnormLoad, UnormStore};
use gnomon::report::GpuPanel;
use gnomon::report::gpu::{Predicted, ShaderPair};

use crate::explored::Random;

/// Values on and beside byte boundaries, and random ones.
fn depths() -> Vec<f32> {
    let mut random = Random::new(11);
    let edges = (0..255).flat_map(|k| {
        let edge = k as f32 / 255.0;
        [edge, edge.next_up(), edge.next_down().max(0.0)]
    });
    let inner = (0..20_000).map(|_| (random.next() >> 40) as f32 / (1_u64 << 24) as f32);
    edges.chain(inner).collect()
}

fn predicted(packing: Packing, depths: &[f32]) -> Predicted {
    let through = |z: f32| {
        let stored =
            packing.pack_in(Folded::enter(z)).map(|c| UnormStore::HalfEven.code(c.leave(), 255));
        let sampled = stored.map(|k| Folded::enter(UnormLoad::Reciprocal.value(k, 255)));
        f64::from(packing.unpack_in(sampled).leave())
    };
    let error = |z: &f32| (through(*z) - f64::from(*z)).abs();
    Predicted {
        on: "webgl-swiftshader".into(),
        precision: "highp",
        max_error: depths.iter().map(error).fold(0.0, f64::max),
        one: through(1.0),
        overflows: false,
    }
}

/// The panel.
pub(crate) fn panel() -> GpuPanel {
    let depths = depths();
    let pairs = Packing::with_source().map(|(packing, source)| ShaderPair {
        name: packing.name().into(),
        glsl: source.glsl.into(),
        wgsl: source.wgsl.into(),
        predicted: vec![predicted(packing, &depths)],
    });
    GpuPanel {
        id: "gpu".into(),
        title: "Measure this GPU".into(),
        caption: "Runs the packings on your own device.".into(),
        pairs: pairs.collect(),
        depths,
        devices: vec![],
    }
}
