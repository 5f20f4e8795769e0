//! What three.js r187 itself wrote (tests/fixtures/three/make.mjs) is read as it draws it.

use crate::config::Settings;
use crate::{LightKind, Limits, LoadedScene, Part, fit};
use glam::{DVec3, Vec3};
use gnomon_core::scene::Sides;
use gnomon_core::view::Projection;
use std::path::Path;

const SHAPES: &str = include_str!("../../../tests/fixtures/three/shapes.json");
const YARD: &str = include_str!("../../../tests/fixtures/three/yard.json");

fn read(text: &str) -> Result<LoadedScene, String> {
    let nothing = |path: &Path, _: u64| panic!("{} is asked for", path.display());
    crate::read(Path::new("scene.json"), text.as_bytes(), &Limits::default(), &nothing)
        .map_err(|e| e.to_string())
}

fn part<'a>(scene: &'a LoadedScene, name: &str) -> &'a Part {
    scene.parts.iter().find(|part| part.name.split('#').next() == Some(name)).expect(name)
}

fn ulps(a: Vec3, b: Vec3) -> u32 {
    let steps = |a: f32, b: f32| {
        if a == b { 0 } else { (a.to_bits() as i32).abs_diff(b.to_bits() as i32) }
    };
    a.to_array().into_iter().zip(b.to_array()).map(|(a, b)| steps(a, b)).max().unwrap_or(0)
}

/// Vertices and normals differ from three.js' by nothing, but where a sine of V8 and of libm round apart.
#[test]
fn parametric_geometries_are_made_as_three_makes_them() {
    let scene = read(SHAPES).expect("a sound scene");
    assert_eq!(scene.parts.len(), 36, "18 geometries, each with its buffers");
    assert!(scene.skipped.is_empty(), "{:?}", scene.skipped);
    for [made, given] in scene.parts.as_chunks().0 {
        let (made_of, given_of) = (&made.mesh, &given.mesh);
        assert_eq!(made_of.triangles, given_of.triangles, "{}", made.name);
        assert_eq!(made_of.positions.len(), given_of.positions.len(), "{}", made.name);
        for (what, a, b) in [
            ("position", &made_of.positions, &given_of.positions),
            ("normal", &made_of.normals, &given_of.normals),
        ] {
            for (v, (a, b)) in a.iter().zip(b).enumerate() {
                let near_zero = (*a - *b).abs().max_element() < 1e-15;
                assert!(ulps(*a, *b) == 0 || near_zero, "{} {v} {what}: {a} {b}", made.name);
            }
        }
        for (a, b) in made_of.uvs.iter().zip(&given_of.uvs) {
            assert!((*a - *b).abs().max_element() < 1e-6, "{}: uv {a} {b}", made.name);
        }
    }
}

#[test]
fn lights_cameras_and_sides_are_those_of_the_page() {
    let scene = read(YARD).expect("a sound scene");
    let names: Vec<&str> = scene.lights.iter().map(|light| light.name.as_str()).collect();
    assert_eq!(names, ["sun", "lamp", "bulb"], "a light that casts nothing has no map");
    assert_eq!(scene.lights[2].kind, LightKind::Point);
    let shadow = scene.lights[0].shadow.as_ref().expect("a shadow camera");
    assert_eq!(shadow.sides, Some([-30.0, 30.0, -30.0, 30.0]));
    assert_eq!((shadow.near, shadow.far, shadow.size), (0.5, 80.0, Some([1024, 512])));
    assert_eq!((shadow.bias, shadow.normal_bias), (Some(0.0005), 0.02));
    let shadow = scene.lights[1].shadow.as_ref().expect("a shadow camera");
    assert_eq!((shadow.near, shadow.far), (0.5, 60.0), "a spot's map ends where it does");
    assert_eq!((shadow.bias, shadow.size), (Some(0.0), Some([512; 2])));
    assert_eq!(scene.cameras.len(), 2);
    assert!((scene.cameras[0].position - DVec3::new(40.0, 40.0, 60.0)).length() < 1e-12);
    assert_eq!(scene.cull, Some("material-opposite"));
    assert!(scene.notes.iter().any(|note| note.contains("'lamp' looks at the origin")));
    let floor = part(&scene, "floor");
    assert!(!floor.surface.casts && floor.surface.receives);
    assert_eq!(floor.surface.sides, Sides::Front);
    assert!(part(&scene, "box").surface.casts);
    let posts: Vec<&Part> = scene.parts.iter().filter(|p| p.name.starts_with("posts")).collect();
    assert_eq!(posts.len(), 2);
    assert!(std::sync::Arc::ptr_eq(&posts[0].mesh, &posts[1].mesh), "instances share a mesh");
    assert_eq!(posts[1].model.w_axis.truncate(), DVec3::new(10.0, 2.0, 5.0));
    let flag = part(&scene, "flag");
    assert_eq!(flag.surface.sides, Sides::Both, "the group's own material");
    assert_eq!(flag.mesh.positions, [Vec3::ZERO, Vec3::X, Vec3::Y], "normalized, interleaved");
    assert_eq!(flag.mesh.normals, [Vec3::Z; 3]);
    assert!(!scene.parts.iter().any(|part| part.name.starts_with("hidden")));
}

#[test]
fn the_first_light_of_a_page_is_its_shadow_camera() {
    let settings = Settings::parse("s.toml", "camera.name = \"plan\"").expect("sound settings");
    let case = fit::case("yard", read(YARD).expect("a sound scene"), &settings).expect("a case");
    let map = case.light.only_map().expect("one map");
    assert_eq!(map.view.position, DVec3::new(15.0, 25.0, 10.0));
    let orthographic =
        |width, height, near, far| Projection::Orthographic { width, height, near, far };
    assert_eq!(map.projection, orthographic(60.0, 60.0, 0.5, 80.0));
    let rects = case.layout();
    assert_eq!(rects.rect(0).size, [1024, 512]);
    assert_eq!(case.bias, 0.0005);
    assert!(
        matches!(case.camera.projection, Projection::Orthographic { height, .. } if height == 60.0)
    );
    let all = Settings::parse("s.toml", "light.name = \"all\"").expect("sound settings");
    let cases = fit::cases("yard", read(YARD).expect("a sound scene"), &all).expect("cases");
    let names: Vec<&str> = cases.iter().map(|case| case.name.as_str()).collect();
    assert_eq!(names, ["yard by sun", "yard by lamp"]);
    let spot = cases[1].light.only_map().expect("one map").projection;
    let fov = 2.0 * 0.5 * (180.0 / std::f64::consts::PI);
    let expected = Projection::Perspective { fovy_degrees: fov, aspect: 1.0, near: 0.5, far: 60.0 };
    assert_eq!(spot, expected);
}

#[test]
fn what_three_does_by_default_is_told() {
    let told = |text: &str| read(text).expect("a sound scene").skipped.join("\n");
    let quiet = YARD.replace("\"castShadow\":true", "\"castShadow\":false");
    let text = told(&quiet);
    assert!(text.contains("no mesh casts a shadow"), "{text}");
    assert!(text.contains("no light of the scene has castShadow"), "{text}");
    let text = told(&YARD.replace("\"alphaTest\":0", "\"alphaTest\":0.5,\"map\":\"id-9\""));
    assert!(text.contains("alphaTest"), "{text}");
    let text = told(&YARD.replacen("BoxGeometry", "TubeGeometry", 1));
    assert!(text.contains("TubeGeometry are left out"), "{text}");
    let text = told(&YARD.replacen("\"shadowSide\":null", "\"shadowSide\":0", 1));
    assert!(text.is_empty(), "all casters by one rule: {text}");
    assert_eq!(
        read(&YARD.replacen("\"shadowSide\":null", "\"shadowSide\":0", 1)).map(|s| s.cull),
        Ok(Some("material"))
    );
}

#[test]
fn what_is_no_scene_is_refused_in_a_sentence() {
    for (text, word) in [
        ("{}", "without three.js' metadata"),
        ("[", "line 1"),
        ("{\"metadata\":{\"type\":\"BufferGeometry\"}}", "BufferGeometry"),
        (&YARD.replace("\"widthSegments\":1", "\"widthSegments\":1e9"), "vertices allowed"),
        (&YARD.replace("\"width\":80", "\"width\":\"wide\""), "width is"),
        (&YARD.replace("\"geometry\":\"id-3\"", "\"geometry\":\"id-x\""), "not there"),
        (&YARD.replace("\"stride\":6", "\"stride\":2"), "stride"),
    ] {
        let message = read(text).expect_err(word);
        assert!(message.contains(word) && message.contains("scene.json"), "{message}");
        assert!(!message.contains('\n'), "{message}");
    }
}
