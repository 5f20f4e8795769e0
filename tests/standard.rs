//! Standard scenes are sound, and the benchmark over them counts as its formulas say.

use glam::Vec3;
use gnomon::analysis::pareto::cost::{Cost, unpack_operations};
use gnomon::analysis::pareto::{Combination, LeftWrong, algorithms, mark_front};
use gnomon::depth::{DepthFormat, Packing};
use gnomon::scene::cases::standard::{NAMES, named};
use gnomon::scene::{Case, Filter, TexelFormat};
use gnomon::shadow::Few;
use gnomon::shadow::bias::Strategy;

const F32: TexelFormat = TexelFormat::Depth(DepthFormat::F32);

fn triangles(case: &Case) -> usize {
    case.objects.iter().map(|o| o.mesh.triangles.len()).sum()
}

#[test]
fn every_name_is_a_sound_scene() {
    for name in NAMES {
        let case = named(name).expect(name);
        assert_eq!(case.name, name);
        let view = case.light.eye().checked("light").and(case.camera.view.checked("camera"));
        assert!(view.is_ok(), "{name}: {view:?}");
        for object in &case.objects {
            let mesh = &object.mesh;
            assert!(mesh.positions.iter().all(|p| p.is_finite()), "{name} {}", object.name);
            let largest = mesh.triangles.iter().flatten().max();
            assert!(largest.is_some_and(|&i| (i as usize) < mesh.positions.len()), "{name}");
        }
    }
    assert!(named("terrain-1").is_none() && named("meadow").is_none());
}

#[test]
fn a_terrain_has_about_as_many_triangles_as_asked() {
    for asked in [2, 1000, 100_000] {
        let count = triangles(&named(&format!("terrain-{asked}")).expect("a terrain"));
        assert!(count >= asked && count <= asked + asked / 4 + 64, "{asked}: {count}");
    }
}

#[test]
fn the_teapot_has_its_known_size_and_looks_outwards() {
    let case = named("teapot").expect("a teapot");
    let mesh = &case.objects[1].mesh;
    assert_eq!(mesh.triangles.len(), 32 * 8 * 8 * 2);
    let high = mesh.positions.iter().fold(Vec3::NEG_INFINITY, |h, p| h.max(*p));
    let low = mesh.positions.iter().fold(Vec3::INFINITY, |l, p| l.min(*p));
    assert!((high - Vec3::new(3.434, 3.15, 2.0)).abs().max_element() < 0.1, "{high}");
    assert!((low - Vec3::new(-3.0, 0.0, -2.0)).abs().max_element() < 0.1, "{low}");
    // The volume by the divergence theorem: outward faces make it positive.
    let cone = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| mesh.positions[v as usize]);
        a.dot(b.cross(c)) / 6.0
    };
    let volume: f32 = mesh.triangles.iter().map(cone).sum();
    assert!(volume > 15.0 && volume < 35.0, "{volume}");
}

#[test]
fn few_keeps_any_number_in_order() {
    for n in 0..5 {
        let few: Few<i32> = (0..n).collect();
        assert_eq!(few.to_vec(), (0..n).collect::<Vec<_>>());
        assert_eq!(matches!(few, Few::One(_)), n == 1, "one lies in place");
    }
}

#[test]
fn costs_are_those_of_the_formulas() {
    assert_eq!(unpack_operations(Packing::R8), 0, "the channel is the depth");
    assert_eq!(unpack_operations(Packing::Book), 7, "a dot product of four");
    let of = |filter, strategy| Cost::of(F32, 512, filter, strategy);
    let nearest = of(Filter::Nearest, Strategy::Constant);
    assert_eq!(nearest, Cost { map_bytes: 1 << 20, passes: 1, fetches: 1, operations: 2 });
    let pcf = of(Filter::Pcf3, Strategy::Constant);
    assert_eq!((pcf.fetches, pcf.operations), (9, 9 * 2 + 9 * 2 + 9));
    assert_eq!(of(Filter::Pcf3, Strategy::Midpoint).passes, 2);
    let plane = of(Filter::Pcf3, Strategy::ReceiverPlane).operations;
    assert_eq!(plane, pcf.operations + 17 + 9 * 14);
    assert_eq!(TexelFormat::Packed(Packing::Book).bytes(), 4);
}

fn entry(case: &str, size: u32, false_shadow: f64) -> Combination {
    Combination {
        case: case.into(),
        format: F32,
        size,
        filter: Filter::Nearest,
        strategy: Strategy::Constant,
        amount: 0.0,
        unit: Strategy::Constant.unit(),
        acne_free: Some(true),
        cost: Cost::of(F32, size, Filter::Nearest, Strategy::Constant),
        errors: LeftWrong {
            false_shadow: Some(false_shadow),
            false_light: Some(0.0),
            peter_panning: 0.0,
        },
        front: false,
    }
}

#[test]
fn the_front_is_what_nothing_beats() {
    let sizes = [(256, 0.5), (512, 0.1), (1024, 0.1), (2048, 0.0), (512, 0.1)];
    let mut entries: Vec<Combination> =
        sizes.iter().map(|&(size, e)| entry("a", size, e)).collect();
    entries.push(entry("b", 4096, 1.0));
    mark_front(&mut entries);
    let front: Vec<bool> = entries.iter().map(|e| e.front).collect();
    assert_eq!(front, [true, true, false, true, true, true], "equals stay, cases are apart");
}

/// All 2³⁰ floats of a packing are proved as well.
#[test]
#[ignore = "15 processor seconds; run by hand"]
fn exact_ways_agree_and_plain_f32_nearly() {
    let case = named("fence").expect("a scene");
    let ways = algorithms::ways(&case, 16);
    for way in &ways {
        let is_f32 = way.way.contains("f32");
        let may_differ = is_f32 || way.way == "sampled";
        assert!(may_differ || way.different == 0, "{way:?}");
        assert!(!is_f32 || way.different * 5 < way.answered, "{way:?}");
        assert!(way.answered > 0 && way.evaluated <= way.answered, "{way:?}");
    }
    assert!(ways.len() >= 9, "{ways:?}");
}
