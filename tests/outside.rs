//! What lies outside a light's volume is told first: how many, why, and the value that includes them.

use glam::{DVec3, Vec3};
use gnomon::analysis::measure::{measure, unmeasured};
use gnomon::analysis::outside::{Outside, Reach};
use gnomon::analysis::sweep::Field;
use gnomon::camera::Camera;
use gnomon::light::Light;
use gnomon::scene::{Case, CaseBuilder, shapes};
use gnomon::view::{Projection, View};

const BOX: Projection = Projection::Orthographic { width: 8.0, height: 8.0, near: 1.0, far: 20.0 };

/// A floor of 8 x 8 with a block of 2 over its middle, seen from above, lit from 10 above.
fn case(light: Projection, height: f64, target: DVec3) -> Case {
    let looking = |position, target| View { position, target, up: DVec3::Z };
    let eye = Projection::Perspective { fovy_degrees: 60.0, aspect: 1.0, near: 0.1, far: 100.0 };
    let cone = match light {
        Projection::Orthographic { .. } => None,
        Projection::Perspective { fovy_degrees, .. } => {
            Some((fovy_degrees.to_radians() / 2.0).cos())
        }
    };
    let light = Light::new(looking(DVec3::new(0.0, height, 0.0), target), light, cone);
    let camera = Camera { view: looking(DVec3::new(0.0, 9.0, 4.0), DVec3::ZERO), projection: eye };
    let block = shapes::cuboid(Vec3::new(-1.0, 2.0, -1.0), Vec3::new(1.0, 3.0, 1.0), Vec3::ONE);
    CaseBuilder::new("outside", light, camera)
        .mesh("floor", shapes::floor(8.0, Vec3::ONE))
        .mesh("block", block)
        .canvas([96, 96])
        .map(64, gnomon::scene::TexelFormat::Depth(gnomon::depth::DepthFormat::F32))
        .build()
        .unwrap()
}

fn ortho(width: f64, near: f64, far: f64) -> Projection {
    Projection::Orthographic { width, height: width, near, far }
}

/// The case with every value that its answer asks for.
fn repaired(case: &Case) -> Case {
    let found = measure(case, 1).measurement;
    let mut light = case.light.clone();
    for include in found.left_out.iter().flat_map(|left| &left.include) {
        let set = include.set;
        light = light.remade(
            |view| view,
            |projection| match (projection, include.reach) {
                (Projection::Orthographic { width, height, near, far }, reach) => match reach {
                    Reach::Near => ortho(width, near.min(set), far),
                    Reach::Far => ortho(width, near, far.max(set)),
                    Reach::Width => ortho(width.max(set), near, far),
                    Reach::Height | Reach::Fovy => panic!("{reach} of a square box {height}"),
                },
                (Projection::Perspective { fovy_degrees, aspect, near, far }, reach) => {
                    let [mut fovy_degrees, mut near, mut far] = [fovy_degrees, near, far];
                    match reach {
                        Reach::Near => near = near.min(set),
                        Reach::Far => far = far.max(set),
                        Reach::Fovy => fovy_degrees = fovy_degrees.max(set),
                        Reach::Width | Reach::Height => panic!("{reach} of a spot"),
                    }
                    Projection::Perspective { fovy_degrees, aspect, near, far }
                }
            },
        );
    }
    let cone = light.cone_cos().map(|_| match light.maps()[0].projection {
        Projection::Perspective { fovy_degrees, .. } => (fovy_degrees.to_radians() / 2.0).cos(),
        Projection::Orthographic { .. } => -1.0,
    });
    let light = Light::new(*light.eye(), light.maps()[0].projection, cone);
    Case { light, ..case.clone() }
}

#[test]
fn each_reason_is_told_and_its_value_includes_them() {
    let down = DVec3::ZERO;
    let spot =
        |fovy_degrees, near, far| Projection::Perspective { fovy_degrees, aspect: 1.0, near, far };
    let aside = DVec3::new(3.0, 0.0, 0.0);
    let cases: [(Case, &[Outside]); 7] = [
        (case(ortho(8.2, 1.0, 9.5), 10.0, down), &[Outside::BeyondFar]),
        (case(ortho(8.2, 9.0, 20.0), 10.0, down), &[Outside::BeforeNear]),
        (
            case(ortho(5.0, 1.0, 20.0), 10.0, down),
            &[Outside::Left, Outside::Right, Outside::Below, Outside::Above],
        ),
        (case(spot(50.0, 1.0, 20.0), 10.0, aside), &[Outside::BeyondCone]),
        (case(spot(100.0, 1.0, 9.0), 10.0, down), &[Outside::BeyondFar]),
        (case(spot(100.0, 7.5, 20.0), 10.0, down), &[Outside::BeforeNear]),
        (case(spot(100.0, 1.0, 20.0), 2.5, DVec3::new(9.0, 2.5, 0.0)), &[Outside::BehindLight]),
    ];
    for (case, reasons) in cases {
        let found = measure(&case, 1).measurement;
        let told: Vec<Outside> = found.left_out.iter().map(|left| left.why).collect();
        assert!(reasons.iter().all(|why| told.contains(why)), "{reasons:?}: {told:?}");
        let outside = found.samples.outside_map + found.samples.outside_cone;
        let sum: u64 = found.left_out.iter().map(|left| left.receivers).sum();
        assert_eq!(sum, outside, "every one has a reason");
        let field = Field::new(&case, 1);
        if found.lit + found.shadowed > 0 {
            let line = &found.first_lines[0];
            assert!(line.contains(&outside.to_string()), "{line}");
            assert!(found.verdict.starts_with(line.as_str()));
            assert_eq!(field.first_lines()[0], *line, "sweeps say the same");
        } else {
            assert!(unmeasured(&case, 1).contains(&outside.to_string()));
        }
        let after = measure(&repaired(&case), 1).measurement;
        let left: Vec<Outside> = after.left_out.iter().map(|left| left.why).collect();
        let beyond_help =
            |why: &Outside| told.contains(&Outside::BehindLight) || *why == Outside::BehindLight;
        assert!(left.iter().all(beyond_help), "{told:?} became {left:?}");
    }
}

#[test]
fn values_hold_a_margin_of_a_thousandth() {
    let found = measure(&case(ortho(8.2, 1.0, 9.5), 10.0, DVec3::ZERO), 1).measurement;
    let [left] = &*found.left_out else { panic!("{:?}", found.left_out) };
    let [far] = &*left.include else { panic!("{left:?}") };
    assert_eq!((far.reach, far.is, far.set), (Reach::Far, 9.5, 10.01), "the floor is at 10");
    assert!((far.takes - 10.0).abs() < 1e-9);
}

#[test]
fn a_caster_that_near_or_far_cuts_off_is_named() {
    let lost = |case: &Case| {
        let found = measure(case, 1).measurement;
        let [lost] = &*found.lost_casters else { panic!("{:?}", found.lost_casters) };
        assert!(found.first_lines.iter().any(|line| line.contains("block")), "{found:?}");
        (lost.object.clone(), lost.why, lost.whole)
    };
    // The block's top is 7 below the light, its bottom 8, the floor 10.
    let near = lost(&case(ortho(8.2, 9.0, 20.0), 10.0, DVec3::ZERO));
    assert_eq!(near, ("block".to_string(), Outside::BeforeNear, true));
    let part = lost(&case(ortho(8.2, 7.5, 20.0), 10.0, DVec3::ZERO));
    assert_eq!(part, ("block".to_string(), Outside::BeforeNear, false));
    let far = lost(&case(ortho(8.2, 1.0, 6.5), 10.0, DVec3::ZERO));
    assert_eq!(far, ("block".to_string(), Outside::BeyondFar, true));
    let none = measure(&case(BOX, 10.0, DVec3::ZERO), 1).measurement;
    assert!(none.lost_casters.is_empty() && none.first_lines.is_empty(), "{none:?}");
}

#[test]
fn what_was_left_out_of_the_scene_is_said_first_and_once() {
    let mut case = case(BOX, 10.0, DVec3::ZERO);
    case.skipped = vec!["the skin of node 'rig' is drawn in its bind pose".to_string()];
    let found = measure(&case, 1).measurement;
    let line = "Left out: the skin of node 'rig' is drawn in its bind pose.";
    assert_eq!(found.first_lines, [line]);
    assert!(found.verdict.starts_with(line) && found.verdict.matches("Left out").count() == 1);
    assert!(!found.after_first_lines().contains("Left out"));
    assert_eq!(Field::new(&case, 1).first_lines(), [line]);
}

#[test]
fn surfaces_that_receive_no_shadow_are_told() {
    let mut case = case(BOX, 10.0, DVec3::ZERO);
    case.objects[1].surface.receives = false;
    let found = measure(&case, 1);
    let block = found.observations.iter().filter(|o| o.object == 1).count();
    let line = format!("{block} of {} receivers", found.observations.len());
    let [told] = &*found.measurement.first_lines else { panic!("{:?}", found.measurement) };
    assert!(block > 0 && told.starts_with(&line) && told.contains("receive no shadow"), "{told}");
}
