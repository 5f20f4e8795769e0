//! One bias in every engine's unit: worked numbers, and going to and fro.

use gnomon::engines::{Engine, Place};
use gnomon::shadow::bias::Strategy;
use proptest::prelude::*;

/// A spot, near 1, far 100, receiver at distance 41.73 (the book's plane), θ with cos 0.8.
fn book() -> Place {
    Place {
        near: 1.0,
        far: 100.0,
        distance: Some(41.73),
        texel_world: 0.057,
        cosine: 0.8,
        slope: 1e-5,
        caster_slope: 1e-5,
        unit: 1.0 / 16_777_216.0,
        step: 1.0 / 65_536.0,
    }
}

/// A directional light whose depth range is 16 world units.
fn sun() -> Place {
    Place { near: 2.0, far: 18.0, distance: None, texel_world: 0.125, ..book() }
}

fn value(engine: Engine, name: &str, place: &Place, bias: f64) -> f64 {
    let knobs = engine.knobs();
    let knob = knobs.iter().find(|k| k.name == name).expect("the engine has it");
    knob.value(place.amount(knob.strategy, bias).expect("it has a size"))
}

#[test]
fn the_books_bias_is_seven_world_units_at_its_plane() {
    let world = book().world_from_window(0.005);
    assert!((world - 7.144).abs() < 0.001, "{world}");
}

/// A bias of 1/64 window depth under the sun lifts ¼ world unit = 2 texels.
#[test]
fn worked_numbers_of_every_engine() {
    let bias = 1.0 / 64.0;
    let root2 = f64::sqrt(2.0);
    let rows = [
        (Engine::Threejs, "shadow.bias", -bias),
        // d/cos θ = 0.25.
        (Engine::Threejs, "shadow.normalBias", 0.2),
        (Engine::Babylon, "bias", 2.0 * bias),
        // d·sin θ/cos θ = 0.25 with sin θ = 0.6.
        (Engine::Babylon, "normalBias", 0.25 * 0.8 / 0.6),
        (Engine::Bevy, "shadow_depth_bias", 0.25),
        (Engine::Bevy, "shadow_normal_bias", 0.2 / (root2 * 0.125)),
        (Engine::Filament, "constantBias", 0.25),
        (Engine::Filament, "normalBias", 0.2 / (0.5 * 0.6 * 0.125)),
        (Engine::Godot, "shadow_bias", 25.0),
        // a·s·(1 − cos θ)·sin²θ/cos θ = 0.25.
        (Engine::Godot, "shadow_normal_bias", 0.25 * 0.8 / (0.125 * 0.2 * 0.36)),
        (Engine::Unity, "shadowNormalBias", 0.2 / (0.6 * 0.125)),
        (Engine::Urp, "shadowDepthBias", 2.0),
        (Engine::Urp, "shadowNormalBias", 0.2 / (0.2 * 0.125)),
        (Engine::Hdrp, "normalBias", 1.6),
        // One unit r comes with every slope.
        (Engine::Hdrp, "slopeBias", (bias - 1.0 / 16_777_216.0) / 1e-5),
        // a·(s/4)·(1 + 1.5 tan θ) = 0.25 with tan θ = 0.75.
        (Engine::Unreal, "r.Shadow.CSMDepthBias", 0.25 / (0.125 / 4.0 * 2.125)),
        (Engine::Playcanvas, "shadowBias", bias / (10.0 * (1e-5 + 1.0 / 16_777_216.0))),
        (Engine::Cesium, "depthBias", bias),
        // d·(1 − cos θ)/cos θ = 0.25.
        (Engine::Cesium, "normalOffsetScale", 0.25 * 0.8 / 0.2),
        (Engine::Gl, "units", 262_144.0),
        (Engine::Vulkan, "depthBiasConstantFactor", 262_144.0),
        (Engine::D3d12, "DepthBias", 262_144.0),
        (Engine::Webgpu, "depthBiasSlopeScale", (bias - 1.0 / 16_777_216.0) / 1e-5),
    ];
    for (engine, name, expected) in rows {
        let found = value(engine, name, &sun(), bias);
        let close = (found - expected).abs() <= 1e-12 * expected.abs();
        assert!(close, "{engine} {name}: {found} instead of {expected}");
    }
    for &engine in Engine::ALL {
        assert!(rows.iter().any(|r| r.0 == engine), "{engine} has no worked number");
    }
}

#[test]
fn whole_numbers_are_rounded_up() {
    assert_eq!(value(Engine::Webgpu, "depthBias", &sun(), 2.5 / 16_777_216.0), 3.0);
}

#[test]
fn every_line_names_the_value() {
    for &engine in Engine::ALL {
        for knob in engine.knobs() {
            let line = engine.line(&knob, 2.0);
            assert!(line.contains('2') && line.lines().count() == 1, "{engine}: {line}");
        }
    }
}

fn ulps(a: f64, b: f64) -> u64 {
    a.to_bits().abs_diff(b.to_bits())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4096))]

    /// Window depth to any strategy's amount and back stays within 2 ulp, for biases worth at most a
    /// third of the distance (beyond, the perspective itself swallows digits).
    #[test]
    fn to_and_fro(
        exponent in -24.0f64..-5.0, z in 1.5f64..90.0, cosine in 0.05f64..0.999,
        texel in 1e-3f64..1.0, directional in any::<bool>(),
    ) {
        let bias = libm::exp2(exponent);
        prop_assume!(directional || bias * 0.99 * z <= 0.5);
        let distance = (!directional).then_some(z);
        let place = Place { distance, cosine, texel_world: texel, ..book() };
        for &strategy in Strategy::ALL {
            let Some(amount) = place.amount(strategy, bias) else { continue };
            let back = place.window(strategy, amount).expect("it had an amount");
            prop_assert!(ulps(bias, back) <= 2, "{strategy}: {bias:e} became {back:e}");
        }
    }
}
