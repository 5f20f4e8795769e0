//! One bias in every engine's unit: worked numbers, and going to and fro.

use gnomon::analysis::tune::{self, Request};
use gnomon::depth::DepthFormat;
use gnomon::engines::{Engine, Place, Setting};
use gnomon::report::{Block, Profile};
use gnomon::scene::{CullRule, Filter, TexelFormat, cases};
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
            let line = knob.line(2.0);
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

/// Every combination of what decides over a line.
fn settings() -> Vec<Setting> {
    let mut list = Vec::new();
    for spot in [false, true] {
        for &filter in Filter::ALL {
            list.extend(CullRule::ALL.iter().map(|&cull| Setting { spot, filter, cull }));
        }
    }
    list
}

/// Whether a parameter's line is known to be wrong: said once more, engine by engine.
fn is_wrong(engine: Engine, name: &str, s: &Setting) -> bool {
    match (engine, name) {
        (Engine::Hdrp | Engine::Cesium, _) => true,
        (Engine::Godot | Engine::Filament | Engine::Bevy | Engine::Unreal | Engine::Urp, _) => {
            s.spot
        }
        (Engine::Babylon, "bias") => s.filter == Filter::Nearest,
        _ => false,
    }
}

#[test]
fn known_wrong_lines_are_withdrawn_and_no_others() {
    for setting in settings() {
        for &engine in Engine::ALL {
            for knob in engine.knobs() {
                let withdrawn = knob.withdrawn(&setting);
                let wrong = is_wrong(engine, knob.name, &setting);
                assert_eq!(withdrawn.is_some(), wrong, "{engine} {} {setting:?}", knob.name);
                let full = withdrawn.is_none_or(|w| w.why.len() > 20 && w.instead.len() > 10);
                assert!(full, "{engine} {}: {withdrawn:?}", knob.name);
            }
        }
    }
}

/// Whether a map holds the back faces of what draws its front.
const fn back_faces(cull: CullRule) -> bool {
    matches!(cull, CullRule::Front | CullRule::MaterialOpposite)
}

#[test]
fn what_defaults_leave_is_not_said_where_they_are_other_ones() {
    for setting in settings() {
        let said = |engine: Engine| engine.default_withdrawn(&setting).is_none();
        assert_eq!(said(Engine::Threejs), back_faces(setting.cull), "back faces are drawn");
        for engine in [Engine::Babylon, Engine::Godot, Engine::Unity, Engine::Hdrp, Engine::Cesium]
        {
            assert!(!said(engine), "{engine}");
        }
        for engine in [Engine::Filament, Engine::Urp, Engine::Unreal] {
            assert_eq!(said(engine), !setting.spot, "{engine}");
        }
        assert!(said(Engine::Bevy) && said(Engine::Vulkan));
    }
}

#[test]
fn values_that_an_engine_does_not_keep_are_known() {
    let knob =
        |engine: Engine, name: &str| engine.knobs().into_iter().find(|k| k.name == name).unwrap();
    let depth = knob(Engine::Urp, "shadowDepthBias");
    assert!(depth.accepts(0.0) && depth.accepts(10.0) && !depth.accepts(14.1));
    let play = knob(Engine::Playcanvas, "shadowBias");
    assert!(play.accepts(1.0) && !play.accepts(1.01) && !play.accepts(-0.1));
    assert!(!knob(Engine::Hdrp, "slopeBias").accepts(2.55));
    assert!(!knob(Engine::D3d12, "DepthBias").accepts(3e9));
    for &engine in Engine::ALL {
        assert!(engine.knobs().iter().all(|k| k.accepts(k.default)), "{engine} keeps its defaults");
        for knob in engine.knobs() {
            assert!(knob.value(0.0).is_sign_positive(), "{engine} {}: no -0", knob.name);
        }
    }
}

fn line(block: &Block) -> Option<String> {
    if let Block::Code { text, .. } = block { Some(text.clone()) } else { None }
}

/// A tuned case shows lines for nothing that is withdrawn, and no value beyond what an engine keeps.
#[test]
fn no_withdrawn_line_reaches_a_report() {
    for name in ["fundamentals-spot", "fundamentals-directional"] {
        for format in [DepthFormat::Unorm16, DepthFormat::F16] {
            for &engine in Engine::ALL {
                let mut case = cases::named(name).unwrap();
                (case.map.size, case.map.texel) = (64, TexelFormat::Depth(format));
                case.canvas = [48, 36];
                let setting = Setting::of(&case, case.lookup.filter);
                let (max_acne, seed, command) = (0.05, 1, String::new());
                let request =
                    Request { case, engine, max_acne, profile: Profile::Full, seed, command };
                let report = tune::report(&request);
                let lines: Vec<String> = report.blocks().filter_map(line).collect();
                let values = &report.results["values"];
                for knob in engine.knobs() {
                    let value = values[knob.name].as_f64();
                    let wrong = knob.withdrawn(&setting);
                    assert!(
                        wrong.is_none() || value.is_none_or(|v| v == 0.0),
                        "{engine}: {value:?}"
                    );
                    assert!(value.is_none_or(|v| knob.accepts(v)), "{engine}: {value:?}");
                    if let Some(w) = wrong.filter(|_| value.is_none()) {
                        let said = report.lead.iter().any(|s| s.contains(w.why));
                        assert!(said, "{engine} {}: {:?}", knob.name, report.lead);
                    }
                }
                let set = values.as_object().unwrap().values().filter_map(|v| v.as_f64());
                assert_eq!(lines.len(), set.filter(|v| *v != 0.0).count(), "{engine}: {lines:?}");
                assert!(report.results["window_depth"].as_f64().is_none_or(|w| w.abs() <= 1.0));
            }
        }
    }
}
