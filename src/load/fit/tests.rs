//! Lights as engines state them, and fits to what is drawn.

use crate::config::Settings;
use crate::{LoadedScene, Part, fit};
use glam::{DVec3, Vec3};
use gnomon_core::scene::shapes::quad;
use gnomon_core::scene::{Case, Mesh};
use gnomon_core::view::Projection;

/// A floor of 80 × 80 and a small square above it.
fn yard() -> LoadedScene {
    let square = |half: f32, y: f32| {
        let at = |x: f32, z: f32| Vec3::new(x * half, y, z * half);
        quad([at(-1.0, 1.0), at(1.0, 1.0), at(1.0, -1.0), at(-1.0, -1.0)], Vec3::ONE)
    };
    let parts = [("floor#0", square(40.0, 0.0)), ("box#1", square(3.0, 6.0))];
    let parts = parts.map(|(name, mesh)| Part::drawn(name.to_string(), mesh)).to_vec();
    LoadedScene { parts, ..LoadedScene::default() }
}

fn fitted(scene: LoadedScene, toml: &str) -> Case {
    let settings = Settings::parse("s.toml", toml).expect(toml);
    fit::case("yard", scene, &settings).expect(toml)
}

fn eye(case: &Case) -> (DVec3, DVec3, Projection) {
    let map = case.light.only_map().expect("one map");
    (map.view.position, map.view.target, map.projection)
}

#[test]
fn a_standing_directional_light_is_three_js_shadow_camera() {
    let stated = "[light]\nposition = [15, 25, 10]\ntarget = [0, 0, 0]\nnear = 0.5\nfar = 80\n";
    let (position, target) = (DVec3::new(15.0, 25.0, 10.0), DVec3::ZERO);
    let projection = Projection::Orthographic { width: 60.0, height: 60.0, near: 0.5, far: 80.0 };
    for sides in ["width = 60", "left = -30\nright = 30\ntop = 30\nbottom = -30", "height = 60"] {
        let case = fitted(yard(), &format!("{stated}{sides}"));
        assert_eq!(eye(&case), (position, target, projection), "{sides}");
        assert!(case.light.is_directional());
    }
    // The same light by its direction, and a box that is not centred: the eye steps aside.
    let by_direction = stated.replace("target = [0, 0, 0]", "direction = [-15, -25, -10]");
    assert_eq!(eye(&fitted(yard(), &format!("{by_direction}width = 60"))).2, projection);
    let aside = fitted(yard(), &format!("{stated}left = -20\nright = 40\nbottom = -30\ntop = 30"));
    let (moved, _, same) = eye(&aside);
    assert!(((moved - position).length() - 10.0).abs() < 1e-12 && same == projection);
    // A spot stays what it was.
    let spot = fitted(yard(), "light.position = [15, 25, 10]");
    assert!(matches!(eye(&spot).2, Projection::Perspective { .. }) && !spot.light.is_directional());
}

#[test]
fn near_and_far_of_a_light_without_a_place_begin_at_the_scene() {
    let case =
        fitted(yard(), "[light]\ndirection = [-15, -25, -10]\nnear = 0.5\nfar = 80\nwidth = 60");
    let map = case.light.only_map().expect("one map");
    let corners =
        [-40.0, 40.0].into_iter().flat_map(|x| [-40.0, 40.0].map(|z| DVec3::new(x, 0.0, z)));
    for corner in corners {
        let depth = map.axial_distance(corner);
        assert!((0.5..80.0).contains(&depth), "{corner} lies at {depth}");
    }
}

#[test]
fn strays_are_not_fitted_to() {
    let mut scene = yard();
    let mut mesh = Mesh::clone(&scene.parts[1].mesh);
    mesh.positions.push(Vec3::splat(1e6));
    scene.parts[1].mesh = mesh.into();
    let (plain, stray) = (fitted(yard(), ""), fitted(scene, ""));
    assert_eq!(eye(&plain), eye(&stray));
    assert_eq!(plain.camera, stray.camera);
    let said = |case: &Case| {
        case.assumptions.iter().any(|a| a.ends_with("no triangle names are ignored: 1"))
    };
    assert!(said(&stray) && !said(&plain));
}

#[test]
fn a_focus_narrows_the_box_and_keeps_every_caster_in_its_depth() {
    let whole = fitted(yard(), "light.direction = [0.2, -1, 0.1]");
    let focused = fitted(yard(), "focus = \"box\"\nlight.direction = [0.2, -1, 0.1]");
    let width = |case: &Case| eye(case).2.half_width();
    assert!(width(&focused) < width(&whole) / 5.0);
    assert_eq!(focused.objects.len(), 2, "everything is drawn");
    let map = focused.light.only_map().expect("one map");
    let (near, far) = map.projection.near_far();
    let depth = map.axial_distance(DVec3::new(0.0, 0.0, 0.0));
    assert!(near < depth && depth < far, "the floor below is in the volume");
}

#[test]
fn a_ground_is_an_object_that_fits_leave_out() {
    let mut scene = yard();
    scene.parts.remove(0);
    let (alone, grounded) = (fitted(scene.clone(), ""), fitted(scene, "ground = true"));
    let ground = grounded.objects.last().expect("an object");
    assert_eq!((ground.name.as_str(), grounded.objects.len()), (fit::GROUND, 2));
    let widths = [&alone, &grounded].map(|case| eye(case).2.half_width());
    assert_eq!(widths[0], widths[1]);
    assert!(grounded.assumptions.iter().any(|a| a.contains("24 wide is added at y = 6")));
}

#[test]
fn an_orthographic_camera_sees_in_parallel() {
    let toml =
        "canvas = [40, 20]\n[camera]\ntype = \"orthographic\"\nheight = 10\nposition = [0, 9, 9]\n";
    let camera = fitted(yard(), toml).camera;
    let is_box = |p| matches!(p, Projection::Orthographic { width, height, .. } if (width, height) == (20.0, 10.0));
    assert!(is_box(camera.projection));
    assert_eq!(camera.towards(DVec3::X), camera.towards(DVec3::ZERO));
}

#[test]
fn a_rectangular_map_keeps_square_texels() {
    let case = fitted(yard(), "map.size = [512, 128]\nlight.direction = [0, -1, 0]");
    assert_eq!(case.layout().rect(0).size, [512, 128]);
    let (_, _, projection) = eye(&case);
    assert!(
        matches!(projection, Projection::Orthographic { width, height, .. } if width == 4.0 * height)
    );
}
