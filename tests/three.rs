//! three.js' scene JSON: shapes as a real three.js makes them, lights and cameras as it would draw with them.

use glam::DVec3;
use gnomon::load::{Limits, LoadedScene, Part};
use gnomon::scene::{Case, Sides};
use gnomon::scene_file::{SceneFile, load};
use gnomon::view::Projection;
use std::path::{Path, PathBuf};

/// A file that `make.mjs` beside it wrote with three.js r187.
fn fixture(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures/three").join(name)
}

fn read(name: &str) -> LoadedScene {
    load(&fixture(name), &Limits::default()).expect(name)
}

fn called<'a>(scene: &'a LoadedScene, name: &str) -> Vec<&'a Part> {
    scene.parts.iter().filter(|part| part.name.split('#').next() == Some(name)).collect()
}

/// Changes a fixture's text and reads what comes out.
fn changed(change: impl Fn(&mut serde_json::Value)) -> LoadedScene {
    let text = std::fs::read(fixture("yard.json")).expect("a fixture");
    let mut file = serde_json::from_slice(&text).expect("JSON");
    change(&mut file);
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("yard.json");
    std::fs::write(&path, file.to_string()).expect("a file");
    load(&path, &Limits::default()).expect("a scene")
}

fn case(change: impl FnOnce(&mut SceneFile)) -> Case {
    let mut file = SceneFile { scene: Some(fixture("yard.json")), ..SceneFile::default() };
    change(&mut file);
    file.case().expect("a case").expect("a scene")
}

#[test]
fn parametric_geometries_are_those_of_three_to_the_bit() {
    let scene = read("shapes.json");
    assert_eq!(scene.skipped, Vec::<String>::new());
    assert_eq!(scene.parts.len(), 36, "18 geometries, each beside its buffers");
    for pair in scene.parts.as_chunks::<2>().0 {
        let [made, given] = [&pair[0].mesh, &pair[1].mesh];
        let name = &pair[0].name;
        assert_eq!(made.triangles, given.triangles, "{name}");
        assert_eq!(made.positions, given.positions, "{name}: f32 for f32; JSON has no -0");
        assert_eq!(made.normals, given.normals, "{name}");
        assert_eq!(made.uvs, given.uvs, "{name}");
    }
}

#[test]
fn meshes_stand_where_three_draws_them() {
    let scene = read("yard.json");
    let posts = called(&scene, "posts");
    let places: Vec<DVec3> = posts.iter().map(|post| post.model.w_axis.truncate()).collect();
    assert_eq!(places, [DVec3::new(-10.0, 2.0, 5.0), DVec3::new(10.0, 2.0, 5.0)]);
    assert!(std::sync::Arc::ptr_eq(&posts[0].mesh, &posts[1].mesh), "instances share a mesh");
    assert!(called(&scene, "hidden").is_empty());
    let flag = called(&scene, "flag");
    assert_eq!(flag.len(), 1, "one group");
    assert_eq!(flag[0].surface.sides, Sides::Both, "its group's material is the second");
    let corner = flag[0].model.transform_point3(flag[0].mesh.at(1));
    assert_eq!(corner, DVec3::new(-8.0, 6.0, 0.0), "32767 stands for 1");
    let floor = called(&scene, "floor");
    assert!(!floor[0].surface.casts && floor[0].surface.receives, "false where absent");
    assert_eq!(scene.cull, Some("material-opposite"));
}

#[test]
fn the_sun_is_threes_own_shadow_camera() {
    let sun = case(|_| {});
    let map = sun.light.only_map().expect("one map");
    let Projection::Orthographic { width, height, near, far } = map.projection else {
        panic!("{:?}", map.projection);
    };
    assert_eq!([width, height, near, far], [60.0, 60.0, 0.5, 80.0]);
    assert_eq!(map.view.position, DVec3::new(15.0, 25.0, 10.0));
    let sight = (map.view.target - map.view.position).normalize();
    assert!(
        (sight - DVec3::new(-14.0, -25.0, -11.0).normalize()).length() < 1e-14,
        "a unit vector added to 25"
    );
    let rect = sun.layout().rects()[0];
    assert_eq!((rect.size, sun.bias), ([1024, 512], 0.0005), "three's sign is turned");
    assert_eq!(sun.camera.view.position, DVec3::new(40.0, 40.0, 60.0));
    // Where maps cannot follow their materials yet, the first lines say so.
    let told = sun.skipped.iter().any(|word| word.contains("material-opposite"));
    assert!(told || sun.map.cull.name() == "material-opposite", "{:?}", sun.skipped);
}

#[test]
fn lights_and_cameras_are_chosen_by_name_or_number() {
    let lamp = case(|file| file.light = Some("lamp".into()));
    let map = lamp.light.only_map().expect("one map");
    let Projection::Perspective { fovy_degrees, near, far, .. } = map.projection else {
        panic!("{:?}", map.projection);
    };
    let degrees = 1.0 / std::f64::consts::PI * 180.0;
    assert!((fovy_degrees - degrees).abs() < 1e-12, "2 · 0.5 rad: {fovy_degrees}");
    assert_eq!([near, far], [0.5, 60.0], "as far as the light reaches");
    let plan = case(|file| file.camera = Some("plan".into()));
    assert!(matches!(
        plan.camera.projection,
        Projection::Orthographic { height: 60.0, near, far, .. } if near < far
    ));
    let all = SceneFile {
        scene: Some(fixture("yard.json")),
        light: Some("all".into()),
        ..SceneFile::default()
    };
    let names: Vec<String> = all.cases().expect("cases").into_iter().map(|c| c.name).collect();
    assert_eq!(names, ["yard by sun", "yard by lamp"], "a point light has no one map");
    let point = SceneFile { light: Some("bulb".into()), ..all.clone() };
    assert!(point.case().unwrap_err().to_string().contains("cube of maps"));
    let nobody = SceneFile { light: Some("moon".into()), ..all };
    assert!(nobody.case().unwrap_err().to_string().contains("0 'sun', 1 'lamp'"));
}

#[test]
fn a_scene_where_nothing_casts_says_so_first() {
    let scene = changed(|file| {
        for child in file["object"]["children"].as_array_mut().expect("children") {
            if child["type"].as_str().is_some_and(|kind| kind.ends_with("Mesh")) {
                child.as_object_mut().expect("an object").remove("castShadow");
            }
        }
        file["geometries"][0]["type"] = "TubeGeometry".into();
    });
    assert!(scene.skipped[0].contains("no mesh casts a shadow"), "{:?}", scene.skipped);
    assert!(scene.skipped.iter().any(|word| word.contains("TubeGeometry")), "{:?}", scene.skipped);
}
