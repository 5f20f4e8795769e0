//! Vertex normals as engines use them: along which a bias moves, by which a wrong verdict is seen.

use glam::{DVec3, Mat4, Vec3};
use gnomon::analysis::measure::measure;
use gnomon::analysis::sweep::chart::{Attachment, Chart};
use gnomon::analysis::sweep::evaluate::{Question, sweep};
use gnomon::analysis::sweep::tally::{Kind, Tally};
use gnomon::analysis::sweep::{Field, looks};
use gnomon::analysis::tune::{self, Found};
use gnomon::camera::Camera;
use gnomon::depth::DepthFormat;
use gnomon::engines::Engine;
use gnomon::light::Light;
use gnomon::scene::{Case, CaseBuilder, Mesh, Sides, TexelFormat, shapes};
use gnomon::shadow::bias::{Family, MoveNormal, Strategy};
use gnomon::view::{Projection, View};
use proptest::prelude::{ProptestConfig, Strategy as _, prop_assert, prop_assert_eq, proptest};
use std::sync::Arc;

const F32: TexelFormat = TexelFormat::Depth(DepthFormat::F32);

/// A floor of 8 x 8 with a small box above it, under a slanted sun.
fn case(floor: Mesh, block: Mesh, model: Mat4) -> Case {
    let looking = |position| View { position, target: DVec3::ZERO, up: DVec3::Z };
    let sun = Projection::Orthographic { width: 14.0, height: 14.0, near: 1.0, far: 30.0 };
    let eye = Projection::Perspective { fovy_degrees: 45.0, aspect: 1.0, near: 0.1, far: 100.0 };
    let light = Light::new(looking(DVec3::new(6.0, 12.0, 3.0)), sun, None);
    let camera = Camera { view: looking(DVec3::new(0.0, 8.0, 8.0)), projection: eye };
    CaseBuilder::new("normals", light, camera)
        .placed("floor", floor, model)
        .mesh("block", block)
        .canvas([48, 48])
        .map(128, F32)
        .build()
        .unwrap()
}

fn block() -> Mesh {
    shapes::cuboid(Vec3::new(-0.5, 0.5, -0.5), Vec3::new(0.5, 1.5, 0.5), Vec3::ONE)
}

/// The floor with the same normal at each of its four corners.
fn floor(normal: Option<Vec3>) -> Mesh {
    let floor = shapes::floor(8.0, Vec3::ONE);
    Mesh { normals: normal.map_or_else(Vec::new, |n| vec![n; 4]), ..floor }
}

fn plain(normal: Option<Vec3>) -> Case {
    case(floor(normal), block(), Mat4::IDENTITY)
}

/// What a strategy leaves at an amount.
fn tally(case: &Case, strategy: Strategy, amount: f32) -> (Tally, [u64; 2]) {
    let field = Field::new(case, 1);
    let chart = Chart::new(&field, case.map.size, case.lookup.filter, Attachment::Depth);
    let question = Question { amounts: &[amount], max_acne: 0.0 };
    let swept = sweep(&chart, F32, strategy, &question);
    (swept.points[0].tally, swept.populations)
}

/// The lit floor is dark under a normal offset whose normals point down, as in a real three.js, whatever
/// the sides of its material; with the normals up it is as with its faces' own.
#[test]
fn a_normal_offset_goes_along_the_vertices_normals_unturned() {
    let offset = |case: &Case| tally(case, Strategy::NormalOffset, 0.2);
    let (flat, [lit, _]) = offset(&plain(None));
    assert_eq!(flat.of(Kind::ACNE), 0, "0.2 is enough where it goes up");
    assert_eq!(offset(&plain(Some(Vec3::Y))).0, flat, "the same bits as the face's own");
    let (down, _) = offset(&plain(Some(Vec3::NEG_Y)));
    assert!(down.of(Kind::ACNE) as f64 > 0.95 * lit as f64, "{down:?} of {lit}");
    let mut one_sided = plain(Some(Vec3::NEG_Y));
    one_sided.objects[0].surface.sides = Sides::Front;
    assert_eq!(offset(&one_sided).0, down);
    // A material that draws the back alone, here the upper side, reverses its normals (three.js FLIP_SIDED).
    let mut back = plain(Some(Vec3::NEG_Y));
    back.objects[0].surface.sides = Sides::Back;
    let mesh = Arc::make_mut(&mut back.objects[0].mesh);
    mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    assert_eq!(offset(&back).0, flat);
    // Bevy turns them to the side seen; the floor's winding is up, so that its back is not seen.
    let bevy = |case: &Case| tally(case, Strategy::NormalBevy, 1.5).0;
    assert!(bevy(&plain(Some(Vec3::NEG_Y))).of(Kind::ACNE) > 0);
}

/// The floor under a model matrix that mirrors it.
fn case_mirrored() -> Case {
    case(floor(Some(Vec3::Y)), block(), Mat4::from_scale(Vec3::new(-1.0, 1.0, 1.0)))
}

/// A two-sided floor wound downwards, its normals with its winding: the shader turns them up, the vertex
/// shader of three.js does not.
#[test]
fn a_two_sided_material_turns_what_shades_alone() {
    let mut mesh = floor(Some(Vec3::NEG_Y));
    mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    let case = case(mesh, block(), Mat4::IDENTITY);
    let (three, [lit, _]) = tally(&case, Strategy::NormalOffset, 0.2);
    assert!(three.of(Kind::ACNE) as f64 > 0.95 * lit as f64, "{three:?}");
    let bevy = tally(&case, Strategy::NormalBevy, 1.5).0;
    assert_eq!(bevy, tally(&plain(None), Strategy::NormalBevy, 1.5).0, "turned to the side seen");
    let godot = tally(&case, Strategy::NormalGodot, 4.0).0;
    assert_ne!(godot, tally(&plain(None), Strategy::NormalGodot, 4.0).0, "normal_interp is not");
    let up = measure(&plain(None), 1).measurement;
    assert_eq!(measure(&case_mirrored(), 1).measurement.seen, up.seen, "a mirrored front");
    assert_eq!(measure(&case, 1).measurement.seen, up.seen, "shaded by the side seen");
}

#[test]
fn tune_does_not_promise_what_a_real_engine_breaks() {
    let knob = |case: &Case, name: &str| {
        let field = Field::new(case, 1);
        let tuning = tune::tune(&field, Engine::Threejs, 0.001);
        let found = tuning.tuned.iter().find(|t| t.knob.name.contains(name)).unwrap().found;
        (found, tuning.best().map(|t| t.knob.name))
    };
    let down = plain(Some(Vec3::NEG_Y));
    let (found, best) = knob(&down, "normalBias");
    assert!(matches!(found, Found::Infeasible), "{found:?}");
    assert_eq!(best, Some("shadow.bias"));
    assert!(matches!(knob(&plain(Some(Vec3::Y)), "normalBias").0, Found::Set(_)));
    let line = Field::new(&down, 1).first_lines().join(" ");
    assert!(line.contains("point away from the light"), "{line}");
    assert_eq!(measure(&down, 1).measurement.first_lines.join(" "), line);
    assert!(Field::new(&plain(Some(Vec3::Y)), 1).first_lines().is_empty());
}

/// The sum max(N·L, 0)·|v − t| over the sum of weights, by hand from interpolated normals.
#[test]
fn seen_weighs_by_the_interpolated_normal() {
    let mut mesh = floor(None);
    mesh.normals = vec![
        Vec3::new(-0.3, 1.0, 0.2),
        Vec3::new(0.9, 0.2, 0.0),
        Vec3::new(0.0, 2.0, 0.0),
        Vec3::new(-1.0, -0.1, 0.0),
    ];
    let model = Mat4::from_scale(Vec3::new(0.5, 3.0, 1.0));
    let case = case(mesh.clone(), block(), model);
    let found = measure(&case, 1);
    let to_light = DVec3::new(6.0, 12.0, 3.0).normalize();
    let world = |v: usize| {
        let n = mesh.normals[v].as_dvec3();
        DVec3::new(n.x / 0.5, n.y / 3.0, n.z).normalize()
    };
    let (mut wrong, mut all) = (0.0, 0.0);
    for o in found.observations.iter().filter(|o| o.truly_lit().is_some()) {
        let cosine = if o.object == 0 {
            let corners = mesh.triangles[o.receiver.triangle as usize].map(|v| v as usize);
            let place = |v: usize| mesh.positions[v].as_dvec3() * DVec3::new(0.5, 3.0, 1.0);
            let [a, b, c] = corners.map(place);
            let p = o.receiver.position;
            let area = |p: DVec3, q: DVec3, r: DVec3| (q - p).cross(r - p).y;
            let shares = [area(p, b, c), area(a, p, c), area(a, b, p)].map(|s| s / area(a, b, c));
            let normal: DVec3 = (0..3).map(|k| world(corners[k]) * shares[k]).sum();
            normal.normalize().dot(to_light)
        } else {
            found.observer.cosine(&o.receiver)
        };
        let truth = if o.truly_lit() == Some(true) { 1.0 } else { 0.0 };
        wrong += cosine.max(0.0) * (o.visibility() - truth).abs();
        all += cosine.max(0.0);
    }
    let seen = found.measurement.seen.unwrap();
    assert!(wrong > 0.0 && (seen - wrong / all).abs() < 1e-9, "{seen}, by hand {}", wrong / all);
    let flat = measure(&Case { objects: plain(None).objects, ..case.clone() }, 1).measurement;
    assert_ne!(flat.seen, found.measurement.seen);
}

#[test]
fn each_rule_says_its_normal() {
    let of = |strategy: Strategy| {
        let recipe = strategy.with(1.0);
        let moves = [recipe.normal, recipe.caster_normal];
        moves.into_iter().find(|m| m.amount != 0.0).map(|m| m.along)
    };
    assert_eq!(of(Strategy::NormalOffset), Some(MoveNormal::Vertices));
    assert_eq!(of(Strategy::NormalBlender), Some(MoveNormal::Face));
    assert_eq!(of(Strategy::NormalGodot), Some(MoveNormal::Interpolated));
    assert_eq!(of(Strategy::NormalBevy), Some(MoveNormal::Shading));
    let casters = [Strategy::CasterUnity, Strategy::CasterUrp, Strategy::CasterBabylon];
    assert!(casters.into_iter().all(|s| of(s) == Some(MoveNormal::Vertices)));
    assert_eq!(of(Strategy::LightOffset), None);
}

#[test]
fn casters_move_along_their_own_normals() {
    // Normals that all point up lift no side of the box away from the sun: its outline only sinks.
    let up = Mesh { normals: vec![Vec3::Y; 24], ..block() };
    let lit = |block: Mesh| {
        let case = case(floor(None), block, Mat4::IDENTITY);
        tally(&case, Strategy::CasterBabylon, 0.3).0.false_light()
    };
    assert_ne!(lit(up), lit(block()));
}

#[test]
fn broken_normals_are_refused() {
    let complaint = |normals: Vec<Vec3>| {
        let mesh = Mesh { normals, ..floor(None) };
        let light = plain(None);
        let built = CaseBuilder::new("n", light.light, light.camera).mesh("floor", mesh).build();
        built.unwrap_err().to_string()
    };
    assert!(complaint(vec![Vec3::Y; 3]).contains("3 for 4 vertices"));
    let nan = complaint(vec![Vec3::Y, Vec3::NAN, Vec3::Y, Vec3::Y]);
    assert!(nan.contains("normal 1"), "{nan}");
}

/// A direction for each of `count` vertices, some without length.
fn normals(count: usize) -> impl proptest::strategy::Strategy<Value = Vec<Vec3>> {
    let one = [-1i8..=1, -1i8..=1, -1i8..=1].prop_map(|n| Vec3::from_array(n.map(f32::from)));
    proptest::collection::vec(one, count)
}

/// The offset of a receiver by hand: barycentrics by areas in the plane, one normal a vertex.
fn offset_by_hand(
    case: &Case,
    field: &Field<'_>,
    i: usize,
    strategy: Strategy,
    amount: f64,
) -> DVec3 {
    let sample = &field.samples[i];
    let geometry = &field.observer.geometry;
    let t = sample.receiver.triangle;
    let first = if geometry.object[t as usize] == 0 { 0 } else { 4 };
    let mesh = &case.objects[usize::from(geometry.object[t as usize])].mesh;
    let [a, b, c] = geometry.corners(t);
    let face = (b - a).cross(c - a);
    let share = |p: DVec3, q: DVec3| {
        let x = (p - sample.receiver.position).cross(q - sample.receiver.position);
        x.dot(face) / face.length_squared()
    };
    let corner =
        geometry.triangles[t as usize].map(|v| mesh.normals[v as usize - first].as_dvec3());
    let to_light = DVec3::new(6.0, 12.0, 3.0).normalize();
    let lit_side = face.normalize() * face.dot(to_light).signum();
    let (each, unit) = match corner.iter().all(|n| n.length() > 0.0) {
        true => {
            let shares = [share(b, c), share(c, a), share(a, b)];
            let each: DVec3 = corner.iter().zip(shares).map(|(n, s)| n.normalize() * s).sum();
            let eye = case.camera.view.position - sample.receiver.position;
            (
                each,
                each.normalize()
                    * if strategy == Strategy::NormalBevy { face.dot(eye).signum() } else { 1.0 },
            )
        }
        false => (lit_side, lit_side),
    };
    let texel = 14.0 / f64::from(case.map.size);
    let sine = |n: DVec3| (1.0 - n.dot(to_light).clamp(0.0, 1.0).powi(2)).sqrt();
    #[expect(clippy::wildcard_enum_match_arm, reason = "the strategies of this test")]
    match strategy {
        Strategy::NormalOffset => each * amount,
        Strategy::NormalBevy => unit * (amount * 2.0_f64.sqrt() * texel),
        Strategy::NormalGodot => {
            let moved = unit * (amount * texel * (1.0 - unit.dot(to_light).clamp(0.0, 1.0)));
            moved - to_light * moved.dot(to_light)
        }
        Strategy::NormalBlender => {
            let weight = sine(lit_side) / 0.534_f64.cos() + 0.195;
            lit_side * (amount * 2.0_f64.sqrt() * texel * weight)
        }
        other => panic!("{other}"),
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// The sweep and the literal arbiter agree under any normals, and receivers move as by hand.
    #[test]
    fn sweeps_agree_with_the_literal_verdicts(
        below in normals(4), around in normals(24), amount in 0.0f32..0.6,
    ) {
        let boxed = Mesh { normals: around, ..block() };
        let case = case(Mesh { normals: below, ..floor(None) }, boxed, Mat4::IDENTITY);
        let field = Field::new(&case, 2);
        let chart = Chart::new(&field, 128, case.lookup.filter, Attachment::Depth);
        for &strategy in Strategy::ALL {
            if !matches!(strategy.family(), Family::Receiver | Family::Vertex | Family::Rule) {
                continue;
            }
            let question = Question { amounts: &[amount], max_acne: 0.0 };
            let swept = sweep(&chart, F32, strategy, &question).points[0].tally;
            let recipe = strategy.with(amount);
            let all = chart.looks(F32, &recipe);
            let bias = |i: usize| chart.bias(&recipe, F32, i);
            prop_assert_eq!(swept, looks::literal(&all, case.lookup.compare, bias), "{}", strategy);
        }
        for strategy in [
            Strategy::NormalOffset, Strategy::NormalBevy, Strategy::NormalGodot, Strategy::NormalBlender,
        ] {
            for i in 0..field.samples.len() {
                let found = strategy.with(amount).receiver_offset(&chart.site(i));
                let by_hand = offset_by_hand(&case, &field, i, strategy, f64::from(amount));
                prop_assert!((found - by_hand).length() < 1e-9, "{strategy} {i}: {found} {by_hand}");
            }
        }
    }
}
