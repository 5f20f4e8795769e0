//! The length of peter-panning is that of the strip which a viewer can see.

use glam::{DVec3, Mat4, Vec3};
use gnomon::analysis::measure::measure;
use gnomon::analysis::sweep::chart::{Attachment, Chart};
use gnomon::analysis::sweep::evaluate::{Question, sweep};
use gnomon::analysis::sweep::{Field, tally::Kind};
use gnomon::camera::Camera;
use gnomon::depth::DepthFormat;
use gnomon::light::Light;
use gnomon::scene::{Case, CaseBuilder, Mesh, TexelFormat, shapes};
use gnomon::shadow::bias::Strategy;
use gnomon::truth::{Receiver, Truth};
use gnomon::view::{Projection, View};

const F32: TexelFormat = TexelFormat::Depth(DepthFormat::F32);

/// A caster on a floor of 8 x 8 under a sun at 45 degrees that shines towards -z, seen from the shadow's
/// side; 10 of depth range.
fn under_sun(name: &str, caster: Mesh, size: u32, bias: f32) -> Case {
    let from = DVec3::new(0.0, 3.0, 3.0) * f64::sqrt(0.5);
    let light = View { position: from * 2.0, target: DVec3::ZERO, up: DVec3::Y };
    let sun = Projection::Orthographic { width: 10.0, height: 10.0, near: 0.0, far: 10.0 };
    let eye = Projection::Perspective { fovy_degrees: 45.0, aspect: 1.0, near: 0.1, far: 50.0 };
    let view = View {
        position: DVec3::new(0.0, 2.5, -2.0),
        target: DVec3::new(0.0, 0.0, -0.3),
        up: DVec3::Y,
    };
    CaseBuilder::new(name, Light::new(light, sun, None), Camera { view, projection: eye })
        .mesh("floor", shapes::floor(8.0, Vec3::ONE))
        .placed("caster", caster, Mat4::IDENTITY)
        .canvas([256, 256])
        .map(size, F32)
        .bias(bias)
        .build()
        .unwrap()
}

/// A wall from z = -width to 0 that begins at height `foot`.
fn wall(width: f32, foot: f32) -> Mesh {
    shapes::cuboid(Vec3::new(-1.0, foot, -width), Vec3::new(1.0, 1.0, 0.0), Vec3::ONE)
}

/// A sheet at z = 0.
fn sheet() -> Mesh {
    let corner = |x: f32, y: f32| Vec3::new(x, y, 0.0);
    shapes::quad(
        [corner(-1.0, 0.0), corner(1.0, 0.0), corner(1.0, 1.0), corner(-1.0, 1.0)],
        Vec3::ONE,
    )
}

#[test]
fn the_strip_ends_where_something_stands() {
    // A bias of 0.30 along the ray lights 0.30 cos 45° of floor, measured from the stored front face.
    let lit = 0.3 * f64::sqrt(0.5);
    let cases = [
        ("thin", wall(0.01, 0.0), lit - 0.01),
        ("thick", wall(0.2, 0.0), lit - 0.2),
        ("sunk", wall(0.2, -0.3), lit - 0.2),
        ("sheet", sheet(), lit),
    ];
    for (name, caster, expected) in cases {
        let case = under_sun(name, caster, 4096, 0.03);
        let texel = 10.0 / 4096.0 * f64::sqrt(2.0);
        let gap = measure(&case, 1).measurement.peter_panning.expect(name).world;
        assert!((gap - expected).abs() < 1.5 * texel, "{name}: {gap}, by hand {expected}");
        let field = Field::new(&case, 1);
        let chart = Chart::new(&field, 4096, case.lookup.filter, Attachment::Depth);
        let question = Question { amounts: &[0.03], max_acne: 0.0 };
        let swept = sweep(&chart, F32, Strategy::Constant, &question).points[0];
        let pixel = 2.0 * 3.2 * f64::tan(22.5_f64.to_radians()) / 256.0 * 2.0;
        assert!(swept.gap <= expected + 1.5 * texel, "{name}: {} in the sweep", swept.gap);
        assert!(swept.gap >= expected - pixel - 2.0 * texel, "{name}: {} in the sweep", swept.gap);
    }
}

#[test]
fn below_a_floating_box_the_strip_goes_on() {
    // 0.05 above the floor: light reaches 0.05 under it from the front, the rest of 0.2 is in shadow.
    let case = under_sun("floating", wall(0.2, 0.05), 4096, 0.03);
    let gap = measure(&case, 1).measurement.peter_panning.expect("floating").world;
    let expected = 0.3 * f64::sqrt(0.5) - 0.05;
    assert!(gap > 0.2 - 0.05 && (gap - expected).abs() < 0.06, "{gap}, by hand {expected}");
}

/// How deep receivers on the floor lie inside the shadow that back faces alone fail to throw on them, in
/// texels, ascending: the way to the nearest point that is truly lit or covered, over 64 directions in steps
/// of a 32nd of a texel.
fn brute_force(case: &Case, covered: impl Fn(DVec3) -> bool + Sync) -> Vec<f64> {
    let mut culled = case.clone();
    (culled.map.cull, culled.bias) = (gnomon::scene::CullRule::Front, 0.0);
    let measured = measure(&culled, 1);
    let wrong = measured.observations.iter().filter(|o| {
        o.truly_lit() == Some(false) && o.visibility() > 0.0 && o.receiver.position.y.abs() < 1e-6
    });
    let observer = &measured.observer;
    let step = 10.0 / f64::from(case.map.size) / 32.0;
    let depth = |receiver: &Receiver| {
        let ends = |radius: u32, turn: u32| {
            let angle = f64::from(turn) / 64.0 * std::f64::consts::TAU;
            let offset = DVec3::new(angle.cos(), 0.0, angle.sin()) * (step * f64::from(radius));
            let there = Receiver { position: receiver.position + offset, ..*receiver };
            let lit = || observer.witness(&there, 0).1.truth == Truth::Lit;
            covered(there.position) || lit()
        };
        let radius = (1..=320).find(|&radius| (0..64).any(|turn| ends(radius, turn)));
        f64::from(radius.expect("an edge within 10 texels")) / 32.0
    };
    let mut depths: Vec<f64> = wrong.map(|o| depth(&o.receiver)).collect();
    depths.sort_by(f64::total_cmp);
    depths
}

#[test]
fn the_gap_of_front_culling_is_as_by_brute_force() {
    for size in [512, 1024] {
        let case = under_sun("culled", wall(0.6, 0.0), size, 0.0);
        let within = |p: DVec3| (-1.0..=1.0).contains(&p.x) && (-0.6..=0.0).contains(&p.z);
        let lengths = brute_force(&case, within);
        let p99 = lengths.get(lengths.len() * 99 / 100).copied().unwrap_or(0.0);
        let field = Field::new(&case, 1);
        let chart = Chart::new(&field, size, case.lookup.filter, Attachment::Depth);
        let question = Question { amounts: &[0.0], max_acne: 1.0 };
        let swept = sweep(&chart, F32, Strategy::FrontCulling, &question).points[0];
        let gap = swept.gap / (10.0 / f64::from(size));
        println!("{size}: {} strips, p99 {p99}, swept {gap}, {:?}", lengths.len(), swept.tally);
        assert!(lengths.len() > 20, "some texels' centres miss the box");
        assert!((gap - p99).abs() <= 0.5, "{size}: {gap} texels, by brute force {p99}");
        assert_eq!(swept.tally.of(Kind::PETER_PANNING), 0, "back faces hide no occluder here");
    }
}
