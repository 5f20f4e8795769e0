//! What scene formats allow: concave faces, OBJ dialects, strips, sparse and quantized positions.

use glam::Vec3;
use gnomon::load::{Limits, LoadedScene, Part};
use gnomon::scene_file::parse;
use serde_json::{Value, json};
use std::path::Path;

fn load(name: &str, bytes: &[u8]) -> gnomon::Result<LoadedScene> {
    parse(Path::new(name), bytes, &Limits::default())
}

fn sound(name: &str, bytes: &[u8]) -> LoadedScene {
    load(name, bytes).unwrap_or_else(|e| panic!("{name}: {e}"))
}

/// Area of all triangles in the world.
fn area(scene: &LoadedScene) -> f32 {
    let part = |Part { mesh, model, .. }: &Part| {
        let corner = |i: u32| model.as_mat4().transform_point3(mesh.positions[i as usize]);
        let triangle = |t: &[u32; 3]| {
            let [a, b, c] = t.map(corner);
            (b - a).cross(c - a).length() / 2.0
        };
        mesh.triangles.iter().map(triangle).sum::<f32>()
    };
    scene.parts.iter().map(part).sum()
}

const REFLEX: &str = "v -1 1 1\nv 0 1 -0.5\nv 1 1 1\nv 1 1 -1\nv -1 1 -1\n";

#[test]
fn concave_faces_keep_their_area_in_obj_and_ply() {
    let expected = 4.0 - 0.5 * 2.0 * 1.5;
    for first in 0..5 {
        let corners: Vec<usize> = (0..5).map(|i| (first + i) % 5).collect();
        let obj = format!(
            "{REFLEX}f {}\n",
            corners.iter().map(|c| (c + 1).to_string()).collect::<Vec<_>>().join(" ")
        );
        let scene = sound("a.obj", obj.as_bytes());
        assert!((area(&scene) - expected).abs() < 1e-5, "from corner {first}: {}", area(&scene));
        let header = "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\n\
            property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
        let list = corners.iter().map(ToString::to_string).collect::<Vec<_>>().join(" ");
        let ply = format!("{header}{}5 {list}\n", REFLEX.replace("v ", ""));
        let scene = sound("a.ply", ply.as_bytes());
        assert!(
            (area(&scene) - expected).abs() < 1e-5,
            "PLY from corner {first}: {}",
            area(&scene)
        );
    }
    // A ring as one polygon with a seam, as exporters write holes.
    let corner = |r: f32, k: usize| {
        let a = k as f32 * std::f32::consts::TAU / 32.0;
        format!("v {} 0 {}\n", r * a.cos(), r * a.sin())
    };
    let ring: String =
        (0..=32).map(|k| corner(1.0, k)).chain((0..=32).rev().map(|k| corner(0.9, k))).collect();
    let face: String = (1..=66).map(|i| format!(" {i}")).collect();
    let scene = sound("ring.obj", format!("{ring}f{face}\n").as_bytes());
    let disc = 16.0 * (std::f32::consts::TAU / 32.0).sin();
    assert!((area(&scene) - disc * (1.0 - 0.81)).abs() < 1e-3, "{}", area(&scene));
}

#[test]
fn windings_of_cut_faces_stay() {
    // The first order runs counter-clockwise as seen from above.
    for (order, up) in [("1 2 3 4 5", 1.0), ("5 4 3 2 1", -1.0)] {
        let scene = sound("a.obj", format!("{REFLEX}f {order}\n").as_bytes());
        let mesh = &scene.parts[0].mesh;
        for t in &mesh.triangles {
            let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
            assert_eq!((b - a).cross(c - a).y.signum(), up, "{order}: {t:?}");
        }
    }
}

#[test]
fn obj_dialects_are_read() {
    let plain = sound("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 0 -1\nf 1 2 3\n");
    for (what, bytes) in [
        ("a comment after a face", &b"v 0 0 0 # a\nv 1 0 0\nv 0 0 -1\nf 1 2 3 # caf\xe9\n"[..]),
        (
            "Latin-1 names",
            b"mtllib \xe9.mtl\no caf\xe9\nv 0 0 0\nv 1 0 0\nv 0 0 -1\nusemtl \xfc\nf 1 2 3\n",
        ),
        ("usemtl without a name", b"usemtl\nv 0 0 0\nv 1 0 0\nv 0 0 -1\nf 1 2 3\n"),
        ("a continued line", b"v 0 \\\n0 0\nv 1 0 0\nv 0 0 -1\nf 1 \\\r\n2 \\\n3\n"),
        (
            "CRLF, tabs and a BOM",
            b"\xef\xbb\xbfv\t0 0 0\r\nv 1 0 0\r\nv 0 0 -1\r\nf\t1/1 2//2 3/3/3\r\n",
        ),
        ("negative indices", b"v 0 0 0\nv 1 0 0\nv 0 0 -1\nf -3 -2 -1\n"),
        ("a face before its vertices", b"f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 0 -1\n"),
        ("no end of line", b"v 0 0 0\nv 1 0 0\nv 0 0 -1\nf 1 2 3"),
    ] {
        let scene = sound("a.obj", bytes);
        assert_eq!(scene.parts[0].mesh, plain.parts[0].mesh, "{what}");
        assert!(scene.notes.is_empty(), "{what}: {:?}", scene.notes);
    }
    let lines = sound("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 0 -1\nl 1 2\nf 1 2 3\np 1\n");
    assert!(lines.notes[0].contains("2 lines, points"), "{:?}", lines.notes);
    let parts = sound("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 0 -1\no a\nf 1 2 3\ng b\nf 3 2 1\n");
    assert_eq!(parts.parts.iter().map(|p| p.mesh.positions.len()).collect::<Vec<_>>(), [3, 3]);
}

#[test]
fn every_complaint_about_an_obj_has_its_line() {
    for (text, place, word) in [
        (&b"v 0 0 0\nv 1 x 0\n"[..], "line 2", "vertex 1 has no three numbers"),
        (b"# a\nv 0 0 nan\n", "line 2", "vertex 0"),
        (b"v 0 0 0\n\nf 1 1\n", "line 3", "2 corners"),
        (b"v 0 0 0\nf 1 2 3\n", "line 2", "vertex 2 of 1"),
        (b"v 0 0 0\nv \\\n0 0 0\nf 1 2 0\n", "line 4", "'0' names no vertex"),
        (b"v 0 0 0\nf 1 2 -9\n", "line 2", "'-9' names no vertex"),
        (b"v 0 0 0\nf 1 a b\n", "line 2", "'a' names no vertex"),
        (b"\xff\xfev\0 \0", "a.obj", "UTF-16"),
    ] {
        let error = load("a.obj", text).expect_err(word).to_string();
        assert!(error.contains(place) && error.contains(word), "{error}");
    }
    let lenient = Limits { lenient: true, ..Limits::default() };
    let text = b"v 0 0 0\nv 1 0 0\nv 0 0 -1\nf 1 2 3\nf 1 2 9\nf 1 2\nf 1 2 x\n";
    let scene = parse(Path::new("a.obj"), text, &lenient).expect("one triangle is left");
    assert_eq!(scene.parts[0].mesh.triangles, [[0, 1, 2]]);
    assert!(scene.notes.join(" ").contains("2 of 3 triangles are damaged"), "{:?}", scene.notes);
}

#[test]
fn ply_strips_are_read_with_their_restarts() {
    let ply = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
        element tristrips 1\nproperty list int int vertex_indices\nend_header\n\
        0 0 0\n1 0 0\n0 0 -1\n1 0 -1\n8 0 1 2 3 -1 2 1 0\n";
    let scene = sound("a.ply", ply.as_bytes());
    assert_eq!(scene.parts[0].mesh.triangles, [[0, 1, 2], [2, 1, 3], [2, 1, 0]]);
}

/// A unit square at y = 1 whose accessor, bytes and nodes are edited.
fn gltf(binary: &[u8], edit: impl FnOnce(&mut Value)) -> Vec<u8> {
    use base64::Engine as _;
    let uri = base64::engine::general_purpose::STANDARD.encode(binary);
    let mut value = json!({
        "asset": { "version": "2.0" }, "scenes": [{ "nodes": [0] }], "nodes": [{ "mesh": 0 }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "mode": 5 }] }],
        "accessors": [{ "bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3",
            "min": [0, 1, 0], "max": [1, 1, 1] }],
        "bufferViews": [{ "buffer": 0, "byteLength": binary.len() }],
        "buffers": [{ "byteLength": binary.len(), "uri": format!("data:x/y;base64,{uri}") }],
    });
    edit(&mut value);
    value.to_string().into_bytes()
}

const SQUARE: [[f32; 3]; 4] = [[0.0, 1.0, 1.0], [1.0, 1.0, 1.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]];

fn floats() -> Vec<u8> {
    SQUARE.iter().flatten().flat_map(|x| x.to_le_bytes()).collect()
}

#[test]
fn strips_and_fans_of_a_gltf_are_drawn() {
    let strip = sound("a.gltf", &gltf(&floats(), |_| {}));
    assert_eq!(strip.parts[0].mesh.triangles, [[0, 1, 2], [2, 1, 3]]);
    assert!(strip.notes.is_empty(), "{:?}", strip.notes);
    let fan = gltf(&floats(), |v| v["meshes"][0]["primitives"][0]["mode"] = json!(6));
    assert_eq!(sound("a.gltf", &fan).parts[0].mesh.triangles, [[0, 1, 2], [0, 2, 3]]);
}

#[test]
fn sparse_accessors_replace_elements() {
    let indices = [0u16, 3].map(u16::to_le_bytes).concat();
    let moved: Vec<u8> = [[5.0f32, 1.0, 1.0], [6.0, 1.0, 0.0]]
        .iter()
        .flatten()
        .flat_map(|x| x.to_le_bytes())
        .collect();
    let binary = [floats(), indices, moved].concat();
    let sparse = |v: &mut Value, base: bool| {
        v["bufferViews"] = json!([{ "buffer": 0, "byteLength": 48 },
            { "buffer": 0, "byteOffset": 48, "byteLength": 4 },
            { "buffer": 0, "byteOffset": 52, "byteLength": 24 }]);
        v["accessors"][0]["sparse"] = json!({ "count": 2,
            "indices": { "bufferView": 1, "componentType": 5123 }, "values": { "bufferView": 2 } });
        if !base {
            v["accessors"][0].as_object_mut().expect("an accessor").remove("bufferView");
        }
    };
    let positions = |bytes: &[u8]| sound("a.gltf", bytes).parts[0].mesh.positions.clone();
    let [_, b, c, _] = SQUARE.map(Vec3::from_array);
    let (first, last) = (Vec3::new(5.0, 1.0, 1.0), Vec3::new(6.0, 1.0, 0.0));
    assert_eq!(positions(&gltf(&binary, |v| sparse(v, true))), [first, b, c, last]);
    assert_eq!(
        positions(&gltf(&binary, |v| sparse(v, false))),
        [first, Vec3::ZERO, Vec3::ZERO, last]
    );
    let beyond = gltf(&binary, |v| {
        sparse(v, true);
        v["accessors"][0]["count"] = json!(3);
    });
    let error = load("a.gltf", &beyond).expect_err("element 3 of 3").to_string();
    assert!(error.contains("replaces element 3 of 3"), "{error}");
}

#[test]
fn quantized_positions_are_read_and_materials_required_are_passed_over() {
    let shorts: Vec<u8> = SQUARE
        .iter()
        .flat_map(|p| p.map(|x| (x * 32767.0) as i16).into_iter().chain([0]))
        .flat_map(i16::to_le_bytes)
        .collect();
    let scene = sound(
        "a.gltf",
        &gltf(&shorts, |v| {
            v["accessors"][0]["componentType"] = json!(5122);
            v["accessors"][0]["normalized"] = json!(true);
            v["bufferViews"][0]["byteStride"] = json!(8);
            v["extensionsUsed"] = json!(["KHR_mesh_quantization", "KHR_texture_transform"]);
            v["extensionsRequired"] = json!(["KHR_mesh_quantization", "KHR_texture_transform"]);
        }),
    );
    assert_eq!(scene.parts[0].mesh.positions, SQUARE.map(Vec3::from_array));
    let bytes: Vec<u8> =
        SQUARE.iter().flat_map(|p| p.map(|x| (x * 100.0) as u8).into_iter().chain([0])).collect();
    let scene = sound(
        "a.gltf",
        &gltf(&bytes, |v| {
            v["accessors"][0]["componentType"] = json!(5121);
            v["bufferViews"][0]["byteStride"] = json!(4);
        }),
    );
    assert_eq!(scene.parts[0].mesh.positions[1], Vec3::new(100.0, 100.0, 100.0));
    let unknown = gltf(&floats(), |v| v["extensionsRequired"] = json!(["ACME_geometry"]));
    let error = load("a.gltf", &unknown).expect_err("not read").to_string();
    assert!(error.contains("ACME_geometry") && error.contains("gltf-transform"), "{error}");
}

#[test]
fn nodes_scaled_to_nothing_are_left_out_and_zero_quaternions_refused() {
    let two = |scale: Value| {
        gltf(&floats(), |v| {
            v["nodes"] = json!([{ "mesh": 0 }, { "mesh": 0, "scale": scale }]);
            v["scenes"][0]["nodes"] = json!([0, 1]);
        })
    };
    for scale in [json!([0, 0, 0]), json!([0, 1, 0])] {
        let scene = sound("a.gltf", &two(scale));
        assert_eq!(scene.parts.len(), 1);
        assert!(
            scene.notes[0].contains("1 node (nodes[1]) scaled to nothing"),
            "{:?}",
            scene.notes
        );
    }
    let turned = gltf(&floats(), |v| v["nodes"][0]["rotation"] = json!([0, 0, 0, 0]));
    let error = load("a.gltf", &turned).expect_err("no rotation").to_string();
    assert!(error.contains("nodes[0]") && error.contains("rotation is zero"), "{error}");
}
