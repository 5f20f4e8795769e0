//! What a guest of the crate brings: cases that are checked, bias rules that need not be monotone.

use glam::{DVec3, Mat4, Vec3};
use gnomon::analysis::sweep::chart::{Attachment, Chart};
use gnomon::analysis::sweep::{Field, Question, evaluate, guest};
use gnomon::camera::Camera;
use gnomon::light::Light;
use gnomon::scene::{Case, CaseBuilder, Filter, Mesh, cases, shapes};
use gnomon::shadow::bias::{BiasRule, Family, Recipe, Site, Strategy};
use gnomon::view::{Projection, View};

fn looking(position: DVec3) -> View {
    View { position, target: DVec3::ZERO, up: DVec3::Z }
}

const BOX: Projection =
    Projection::Orthographic { width: 12.0, height: 12.0, near: 1.0, far: 30.0 };

fn above() -> View {
    looking(DVec3::new(6.0, 12.0, 3.0))
}

fn light() -> Light {
    Light::new(above(), BOX, None)
}

fn camera() -> Camera {
    let projection =
        Projection::Perspective { fovy_degrees: 45.0, aspect: 1.0, near: 0.1, far: 100.0 };
    Camera { view: looking(DVec3::new(0.0, 8.0, 8.0)), projection }
}

fn builder() -> CaseBuilder {
    let raised = Mat4::from_translation(Vec3::Y);
    CaseBuilder::new("mine", light(), camera())
        .mesh("floor", shapes::floor(8.0, Vec3::ONE))
        .placed("box", shapes::cube(1.0, Vec3::ONE), raised)
        .canvas([48, 48])
}

#[test]
fn a_built_case_is_measured() {
    let case = builder().build().unwrap();
    let field = Field::checked(&case, 1).unwrap();
    assert!(field.populations.iter().all(|&n| n > 10), "{:?}", field.populations);
    assert!(Field::checked(&case, 0).is_err_and(|e| e.to_string().starts_with("step: ")));
}

fn with_mesh(change: impl FnOnce(&mut Mesh)) -> CaseBuilder {
    let mut mesh = shapes::floor(1.0, Vec3::ONE);
    change(&mut mesh);
    builder().mesh("bad", mesh)
}

#[test]
fn whatever_cannot_be_measured_is_one_sentence_with_its_place() {
    let dark = |light: Light| {
        CaseBuilder::new("mine", light, camera()).mesh("f", shapes::floor(1.0, Vec3::ONE))
    };
    let moved = |position| Light::new(View { position, ..above() }, BOX, None);
    let flat = Projection::Orthographic { width: 0.0, height: 1.0, near: 1.0, far: 2.0 };
    let nan = Mat4::from_translation(Vec3::splat(f32::NAN));
    let far = Mat4::from_scale(Vec3::splat(1e38));
    let cases: Vec<(CaseBuilder, &str)> = vec![
        (CaseBuilder::new("mine", light(), camera()), "mine: objects: hold no triangle"),
        (with_mesh(|m| m.positions[3].x = f32::NAN), "mine: object 'bad', vertex 3: "),
        (with_mesh(|m| m.positions[0].z = f32::INFINITY), "mine: object 'bad', vertex 0: "),
        (with_mesh(|m| m.triangles[1][2] = 4), "mine: object 'bad', triangle 1: "),
        (with_mesh(|m| m.triangles[0][0] = u32::MAX), "mine: object 'bad', triangle 0: "),
        (builder().placed("m", shapes::cube(1.0, Vec3::ONE), nan), "mine: object 'm', model: "),
        (builder().placed("m", shapes::cube(9.0, Vec3::ONE), far), "mine: object 'm', vertex 0: "),
        (dark(moved(DVec3::ZERO)), "mine: light"),
        (dark(moved(DVec3::Z)), "mine: light"),
        (dark(moved(DVec3::new(f64::NAN, 1.0, 2.0))), "mine: light"),
        (dark(Light::new(above(), flat, None)), "mine: light"),
        (dark(Light::new(above(), BOX, Some(2.0))), "mine: light.cone_cos: "),
        (builder().canvas([0, 8]), "mine: canvas: 0 is not from 1"),
        (builder().map(0, builder().build().unwrap().map.texel), "mine: map.size: 0 "),
        (builder().bias(f32::NAN), "mine: bias: "),
    ];
    for (builder, start) in cases {
        let error = builder.build().expect_err(start).to_string();
        assert!(error.starts_with(start), "{error}");
        assert_eq!(error.lines().count(), 1, "{error}");
    }
}

/// A catalogue's strategy as a guest would write it.
struct Constant;
impl BiasRule for Constant {
    fn bias(&self, _: &Site, [a, _]: [f32; 2]) -> f32 {
        a
    }
}

/// Grows to its amount of 0.01, then falls to nothing.
struct Hill;
impl BiasRule for Hill {
    fn bias(&self, _: &Site, [a, height]: [f32; 2]) -> f32 {
        height * (1.0 - ((a - 0.01) / 0.01).abs()).max(0.0)
    }
}

struct NoNumber;
impl BiasRule for NoNumber {
    fn bias(&self, site: &Site, [a, _]: [f32; 2]) -> f32 {
        (a - site.w as f32).sqrt()
    }
}

fn small() -> Case {
    let mut case = cases::named("fundamentals-spot").unwrap();
    (case.canvas, case.map.size) = ([64, 48], 128);
    case
}

const AMOUNTS: [f32; 6] = [0.0, 1e-4, 1e-3, 0.01, 0.02, 0.1];

#[test]
fn a_guests_rule_counts_what_the_catalogues_own_counts() {
    let case = small();
    let (field, format) = (Field::new(&case, 1), case.map.texel);
    let chart = Chart::new(&field, 128, Filter::Pcf3, Attachment::of(format));
    let question = Question { amounts: &AMOUNTS, max_acne: 0.001 };
    let own = guest::rule(&chart, format, &Constant, 0.0, &question).unwrap();
    let known = evaluate::sweep(&chart, format, Strategy::Constant, &question);
    assert_eq!(own.points, known.points);
    assert_eq!(own.falls, None);
    let (found, exact) = (own.acne_free.unwrap().amount, known.acne_free.unwrap().amount);
    assert!(found >= exact && found - exact <= 0.1 / 1024.0, "{found} for {exact}");
}

#[test]
fn a_rule_that_falls_is_said_and_followed_from_amount_to_amount() {
    let case = small();
    let (field, format) = (Field::new(&case, 1), case.map.texel);
    let chart = Chart::new(&field, 128, Filter::Nearest, Attachment::of(format));
    let question = Question { amounts: &AMOUNTS, max_acne: 0.001 };
    let hill = guest::rule(&chart, format, &Hill, 0.01, &question).unwrap();
    assert_eq!(hill.falls, Some((0, [0.01, 0.02])));
    assert_eq!(hill.points[0].tally, hill.points[4].tally, "nothing at both ends");
    assert!(hill.acne_free.is_none(), "acne is back at the last amount");
    assert!(hill.detachment.is_none_or(|a| AMOUNTS.contains(&a)));

    let error = guest::rule(&chart, format, &NoNumber, 0.0, &question).unwrap_err();
    assert!(error.to_string().contains("is no number"), "{error}");
    let unsorted = Question { amounts: &[1.0, 0.5], max_acne: 0.0 };
    assert!(guest::rule(&chart, format, &Hill, 0.01, &unsorted).is_err());
}

/// The tutorials' rules as they are written, by hand.
#[test]
fn the_tutorials_rules_are_those_of_their_pages() {
    let case = small();
    let field = Field::new(&case, 7);
    for sample in &field.samples {
        let site = field.site(sample, &case.light.layout(128));
        let bias = |strategy: Strategy, a: f32| strategy.with(a).bias(&Default::default(), || site);
        let cosine = site.normal.dot(site.to_light) as f32;
        let angle = libm::acos(f64::from(cosine));
        let floored = (0.05 * (1.0 - cosine)).max(0.005);
        assert_eq!(bias(Strategy::TutorialCosine, 0.05), floored);
        let tangent = (0.005 * libm::tan(angle)).clamp(0.0, 0.01);
        assert!((f64::from(bias(Strategy::TutorialTangent, 0.005)) - tangent).abs() < 1e-7);
        let map = case.light.only_map().expect("one map");
        let w = map.axial_distance(sample.receiver.position);
        assert!((f64::from(bias(Strategy::ClipSpace, 0.02)) - 0.02 / w).abs() < 1e-8);
    }
    assert!(!field.samples.is_empty());
    let rules = Strategy::ALL.iter().filter(|s| s.family() == Family::Rule);
    assert_eq!(rules.count(), 3);
    assert_eq!(Strategy::None.with(1.0), Recipe::NONE);
}
