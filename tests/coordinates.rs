//! Where things stand: f64 places reach truth, stated lights are an engine's own, fits see what is drawn.

use glam::{DMat4, DVec3, Mat4};
use gnomon::scene::{Case, MatrixChain};
use gnomon::scene_file::SceneFile;
use gnomon::view::Projection;
use std::path::{Path, PathBuf};

const FLOOR: &str = "o floor\nv -2 0 -2\nv 2 0 -2\nv 2 0 2\nv -2 0 2\nf 1 3 2\nf 1 4 3\n";
const PLATE: &str = "o plate\nv -0.5 1 -0.5\nv 0.5 1 -0.5\nv 0 1 0.5\nf 5 7 6\n";

/// The case of a scene with settings beside it, and flags.
fn case(scene: &str, settings: &str, flags: impl FnOnce(&mut SceneFile)) -> gnomon::Result<Case> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("scene.obj");
    std::fs::write(&path, scene).expect("a file");
    std::fs::write(path.with_extension("toml"), settings).expect("a file");
    let mut file = SceneFile { scene: Some(path), ..SceneFile::default() };
    flags(&mut file);
    file.case().map(|case| case.expect("a scene"))
}

fn yard() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures/three/yard.json")
}

#[test]
fn truth_sees_the_place_that_f64_gives_and_the_subject_its_rounding() {
    let mut case = case(FLOOR, "", |_| {}).expect("a case");
    let model = DMat4::from_translation(DVec3::new(6e6 + 0.3, 0.1, 0.0));
    let floor = case.objects.remove(0).placed(model);
    let mut moved = floor.clone();
    moved.model = Mat4::IDENTITY;
    case.objects = vec![floor, moved];
    let geometry = case.geometry();
    assert_eq!(geometry.positions[0], DVec3::new(6e6 + 0.3 - 2.0, 0.1, -2.0));
    assert_eq!(case.objects[0].model.w_axis.x, 6_000_000.5, "f32 has a step of a half there");
    assert_eq!(geometry.positions[4], DVec3::new(-2.0, 0.0, -2.0), "a matrix set later stands");
}

#[test]
fn the_chain_is_stated_or_chosen() {
    let of = |settings: &str, flag: Option<&str>| {
        case(FLOOR, settings, |file| file.chain = flag.map(str::to_string)).map(|case| case.chain)
    };
    let text = "pipeline.chain = \"model-view\"\n";
    assert_eq!(of("", None).expect("fitted"), MatrixChain::World);
    assert_eq!(of(text, None).expect("stated"), MatrixChain::ModelView);
    assert_eq!(of(text, Some("combined")).expect("chosen"), MatrixChain::Combined);
    let refused = of("", Some("backwards")).expect_err("no chain").to_string();
    assert!(refused.contains("--chain") && refused.contains("bias-matrix"), "{refused}");
}

/// What an engine says of a sun is the same light in TOML as in three.js' own file.
#[test]
fn a_stated_sun_is_threes_sun() {
    let folder = tempfile::tempdir().expect("a folder");
    let sun = |text: &str| {
        let config = folder.path().join("sun.toml");
        std::fs::write(&config, text).expect("a file");
        let file = SceneFile { scene: Some(yard()), config: Some(config), ..SceneFile::default() };
        file.case().expect("a case").expect("a scene").light
    };
    let head = "map.size = [1024, 512]\n[light]\ntype = \"directional\"\n\
                position = [15, 25, 10]\ndirection = [-14, -25, -11]\nnear = 0.5\nfar = 80\n";
    let own = sun("");
    assert_eq!(sun(&format!("{head}left = -30\nright = 30\nbottom = -30\ntop = 30\n")), own);
    assert_eq!(sun(&format!("{head}width = 60\n")), own, "a square unless height says otherwise");
    let aside = sun(&format!("{head}left = -30\nright = 50\nbottom = -30\ntop = 30\n"));
    let map = aside.only_map().expect("one map");
    let step = map.view.position - DVec3::new(15.0, 25.0, 10.0);
    assert!((step.length() - 10.0).abs() < 1e-12 && step.y.abs() < 1e-12, "{step}");
}

#[test]
fn fits_see_what_is_drawn_and_what_is_in_focus() {
    let box_of = |case: &Case| match case.light.only_map().expect("one map").projection {
        Projection::Orthographic { width, .. } => width,
        Projection::Perspective { .. } => panic!("a spot"),
    };
    let sun = "light.direction = [0, -1, 0]\n";
    let plain = case(&format!("{FLOOR}{PLATE}"), sun, |_| {}).expect("a case");
    let stray = format!("{FLOOR}{PLATE}v 1e6 0 0\n");
    let stray = case(&stray, sun, |_| {}).expect("a case");
    assert_eq!((stray.light.clone(), stray.camera), (plain.light.clone(), plain.camera));
    let told = |case: &Case, word: &str| case.assumptions.iter().any(|note| note.contains(word));

    let focus = |file: &mut SceneFile| file.focus = Some("plate".into());
    let plate = case(&format!("{FLOOR}{PLATE}"), sun, focus).expect("a case");
    assert!(box_of(&plate) < 1.1 && box_of(&plain) > 4.0, "the plate is 1 wide, the floor 4");
    assert_eq!(plate.objects.len(), 2, "everything still casts");

    let lone = PLATE.replace("f 5 7 6", "f 1 3 2");
    let lone = case(&lone, sun, |file| file.ground = true).expect("a case");
    let ground = lone.objects.last().expect("a plane");
    assert_eq!((ground.name.as_str(), ground.model.w_axis.y), ("ground", 1.0));
    assert!(told(&lone, "ground plane 4 wide"), "{:?}", lone.assumptions);
}
