//! Captured maps: our own map, written and read back, gives the same verdicts; mistakes are a sentence.

use glam::{DMat4, DVec3};
use gnomon::analysis::captured::{CapturedArguments, write};
use gnomon::analysis::classify::Artifact;
use gnomon::analysis::effort::Effort;
use gnomon::analysis::measure::{measure, measure_captured};
use gnomon::depth::{DepthFormat, Packing};
use gnomon::light::Map;
use gnomon::raster::passes::Subject;
use gnomon::scene::{Case, TexelFormat, cases, matrix};
use std::path::Path;
use std::process::Command;

fn only_map(case: &Case) -> &Map {
    case.light.only_map().expect("one map")
}

fn case(format: TexelFormat) -> Case {
    let mut case = cases::named("staircase").expect("a standard scene");
    (case.map.size, case.map.texel) = (256, format);
    case
}

fn saved(case: &Case, path: &Path) {
    let device = case.device.device();
    write(&Subject::draw(case, &device).map, &device, path).expect("a map file");
}

fn numbers(m: &gnomon::analysis::measurement::Measurement) -> String {
    serde_json::to_string(m).expect("numbers")
}

#[test]
fn our_own_map_read_back_gives_the_same_verdicts() {
    let folder = tempfile::tempdir().expect("a folder");
    let depth = TexelFormat::Depth;
    for (file, format) in [
        ("a.png", TexelFormat::Packed(Packing::Digits32)),
        ("b.png", depth(DepthFormat::Unorm16)),
        ("c.png", depth(DepthFormat::Unorm8)),
        ("d.exr", depth(DepthFormat::F32)),
        ("e.exr", depth(DepthFormat::F16)),
        ("f.raw", depth(DepthFormat::Unorm24)),
        ("g.raw", depth(DepthFormat::F32)),
        ("h.raw", TexelFormat::Packed(Packing::Book)),
    ] {
        let own = case(format);
        let path = folder.path().join(file);
        saved(&own, &path);
        let expected = numbers(&measure(&own, 8).measurement);
        let arguments = CapturedArguments {
            map_file: Some(path),
            packing: Some(format.name().to_string()),
            map_width: Some(256),
            map_height: Some(256),
            ..CapturedArguments::default()
        };
        let mut other = case(depth(DepthFormat::Unorm8));
        other.map.size = 64;
        let captured = arguments.apply(&mut other, false).expect(file).expect("a map");
        let found = measure_captured(&other, 8, Effort::default(), &captured);
        assert_eq!(numbers(&found.measurement), expected, "{file}");
    }
}

/// The engine's own matrix instead of the case's: the same light to within the rounding of f32.
#[test]
fn a_light_matrix_places_the_map() {
    let folder = tempfile::tempdir().expect("a folder");
    let own = case(TexelFormat::Depth(DepthFormat::F32));
    let path = folder.path().join("map.exr");
    saved(&own, &path);
    let rows = only_map(&own).clip_from_world().as_mat4().transpose().to_cols_array();
    let arguments = CapturedArguments {
        map_file: Some(path),
        light_matrix: rows.iter().map(|x| f64::from(*x)).collect(),
        ..CapturedArguments::default()
    };
    let mut other = own.clone();
    let captured = arguments.apply(&mut other, true).expect("a matrix").expect("a map");
    let [ours, theirs] = [
        measure(&own, 4).measurement,
        measure_captured(&other, 4, Effort::default(), &captured).measurement,
    ];
    assert!(ours.lit.abs_diff(theirs.lit) * 1000 < ours.lit, "{} {}", ours.lit, theirs.lit);
    let near = |a: f64, b: f64| (a - b).abs() < 0.005;
    assert!(
        near(ours.false_shadow.rate.unwrap(), theirs.false_shadow.rate.unwrap()),
        "{}",
        theirs.verdict
    );
    assert!(
        near(ours.false_light.rate.unwrap(), theirs.false_light.rate.unwrap()),
        "{}",
        theirs.verdict
    );
}

/// A map that is upside down is told apart from a sound one.
#[test]
fn a_flipped_map_is_wrong_almost_everywhere() {
    let folder = tempfile::tempdir().expect("a folder");
    let own = case(TexelFormat::Depth(DepthFormat::F32));
    let path = folder.path().join("map.raw");
    saved(&own, &path);
    let bytes = std::fs::read(&path).expect("a file");
    let rows: Vec<u8> = bytes.chunks_exact(4 * 256).rev().flatten().copied().collect();
    std::fs::write(&path, rows).expect("a file");
    let arguments = CapturedArguments {
        map_file: Some(path),
        packing: Some("f32".to_string()),
        map_width: Some(256),
        map_height: Some(256),
        ..CapturedArguments::default()
    };
    let mut other = own.clone();
    let captured = arguments.apply(&mut other, false).expect("texels").expect("a map");
    let flipped = measure_captured(&other, 4, Effort::default(), &captured).measurement;
    let sound = measure(&own, 4).measurement;
    let wrong = |m: &gnomon::analysis::measurement::Measurement| {
        m.false_shadow.rate.unwrap() + m.false_light.rate.unwrap()
    };
    assert!(wrong(&flipped) > 4.0 * wrong(&sound), "{} {}", flipped.verdict, sound.verdict);
    assert!(
        flipped.false_shadow.by_artifact[&Artifact::EncodingFault] > 0,
        "{:?}",
        flipped.false_shadow
    );
}

#[test]
fn mistakes_are_one_sentence() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = |name: &str, bytes: &[u8]| {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).expect("a file");
        path.display().to_string()
    };
    let nan: Vec<u8> = [0.5, 0.25, f32::NAN, 1.0].iter().flat_map(|x| x.to_le_bytes()).collect();
    let (short, nan) = (file("short.raw", &[0; 15]), file("nan.raw", &nan));
    let (png, exr) = (file("broken.png", b"no picture"), file("broken.exr", b"no picture"));
    let other = file("map.tga", b"");
    let out = folder.path().join("out").display().to_string();
    let two = ["--packing", "f32", "--map-width", "2", "--map-height", "2"];
    let run = |arguments: &[&str]| {
        let output = Command::new(env!("CARGO_BIN_EXE_gnomon-report"))
            .args(["--quick", "--out", &out])
            .args(arguments)
            .output()
            .expect("the binary runs");
        (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
    };
    let on = |file: &str, more: &[&str], word: &str| {
        let arguments = [&["--case", "upc", "--map-file", file], more].concat();
        let (code, message) = run(&arguments);
        assert_eq!(code, Some(2), "{message}");
        assert!(message.contains(word) && message.trim_end().lines().count() == 1, "{message}");
    };
    on(&short, &two, "holds 15 bytes, not 2 x 2 texels of 4 bytes");
    on(&nan, &two, "texel (0, 1)");
    on(&short, &two[2..], "--packing");
    on(&short, &two[..2], "--map-width");
    on(&short, &["--packing", "f32", "--map-width", "2", "--map-height", "3"], "2 x 3");
    let matrix = |numbers: &'static str| [&two[..], &["--light-matrix", numbers]].concat();
    let whole = file("whole.raw", &[0; 16]);
    on(&whole, &matrix("1,0,-1"), "has 3 numbers");
    on(&whole, &matrix("1,0,0,0,0,1,0,0,0,0,0,0,0,0,0,1"), "singular");
    on(&png, &["--packing", "unorm8"], "PNG");
    on(&exr, &[], "EXR");
    on(&other, &[], ".tga");
    let (code, message) = run(&["--map-file", &short]);
    assert!(code == Some(2) && message.contains("belong to one case"), "{message}");
    let scene = file("quad.obj", b"v -1 0 1\nv 1 0 1\nv 1 0 -1\nv -1 0 -1\nf 1 2 3 4\n");
    let (code, message) = run(&["--scene", &scene, "--map-file", &nan, "--packing", "f32"]);
    assert!(code == Some(2) && message.contains("--light-matrix"), "{message}");
    assert!(!Path::new(&out).exists(), "nothing is written");
}

#[test]
fn the_lights_of_all_cases_are_found_again_from_their_matrices() {
    for case in cases::all() {
        let own = only_map(&case).clip_from_world();
        let found = matrix::light(own).unwrap_or_else(|e| panic!("{}: {e}", case.name));
        assert_eq!(found.is_directional(), case.light.is_directional(), "{}", case.name);
        for p in [DVec3::ZERO, DVec3::new(1.0, 0.5, -0.25)] {
            let [a, b] = [own, found.only_map().expect("one map").clip_from_world()]
                .map(|m| m.project_point3(p));
            let scale = a.abs().max_element().max(1.0);
            assert!((a - b).abs().max_element() < 1e-9 * scale, "{}: {a} {b}", case.name);
        }
    }
}

#[test]
fn what_no_light_uploads_is_refused() {
    let sound = only_map(&cases::named("upc").expect("a case")).clip_from_world();
    let mirrored = DMat4::from_scale(DVec3::new(-1.0, 1.0, 1.0)) * sound;
    let mut skew = DMat4::IDENTITY;
    skew.x_axis.y = 0.5;
    for (matrix, word) in [
        (DMat4::ZERO, "singular"),
        (mirrored, "mirrored"),
        (sound * skew, "skewed"),
        (sound.transpose(), "--light-matrix"),
    ] {
        let message = matrix::light(matrix).expect_err(word).to_string();
        assert!(message.contains(word) && message.contains("--light-matrix"), "{message}");
    }
}
