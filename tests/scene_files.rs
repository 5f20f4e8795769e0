//! Scene files: what is read, what is fitted, and every known trap refused in one sentence.

use glam::{DVec3, Vec3};
use gnomon::Error;
use gnomon::analysis::measure::measure;
use gnomon::load::config::Settings;
use gnomon::load::fit;
use gnomon::load::{Limits, LoadedScene, Part};
use gnomon::scene_file::load;
use serde_json::{Value, json};
use std::fs;
use std::path::PathBuf;
use std::process::Command;

struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().expect("a folder"))
    }

    fn write(&self, name: &str, content: impl AsRef<[u8]>) -> PathBuf {
        let path = self.0.path().join(name);
        fs::write(&path, content).expect("a file");
        path
    }

    fn load(&self, name: &str, content: impl AsRef<[u8]>) -> Result<LoadedScene, Error> {
        load(&self.write(name, content), &Limits::default())
    }
}

/// A ground quad and a small square above it, as little-endian bytes: 8 positions, 12 indices.
fn geometry() -> Vec<u8> {
    let quad = |h: f32, y: f32| [[-h, y, h], [h, y, h], [h, y, -h], [-h, y, -h]];
    let positions = [quad(4.0, 0.0), quad(1.0, 1.0)].concat();
    let mut bytes: Vec<u8> =
        positions.iter().flatten().flat_map(|x: &f32| x.to_le_bytes()).collect();
    for index in [0u16, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7] {
        bytes.extend(index.to_le_bytes());
    }
    bytes
}

fn gltf() -> Value {
    use base64::Engine as _;
    let bytes = geometry();
    let uri = base64::engine::general_purpose::STANDARD.encode(&bytes);
    json!({
        "asset": { "version": "2.0" },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [
            { "name": "root", "children": [1, 2] },
            { "mesh": 0, "name": "table" },
            { "translation": [0.0, 5.0, 5.0], "rotation": [-0.382_683_43, 0.0, 0.0, 0.923_879_5], "camera": 0 }
        ],
        "cameras": [{ "type": "perspective", "perspective": { "yfov": 0.9, "znear": 0.1 } }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1 }] }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3",
              "min": [-4.0, 0.0, -4.0], "max": [4.0, 1.0, 4.0] },
            { "bufferView": 1, "componentType": 5123, "count": 12, "type": "SCALAR" }
        ],
        "bufferViews": [
            { "buffer": 0, "byteOffset": 0, "byteLength": 96 },
            { "buffer": 0, "byteOffset": 96, "byteLength": 24 }
        ],
        "buffers": [{ "byteLength": bytes.len(),
                      "uri": format!("data:application/octet-stream;base64,{uri}") }]
    })
}

#[test]
fn a_gltf_scene_is_read_and_measured() {
    let folder = Folder::new();
    let scene = folder.load("table.gltf", gltf().to_string()).expect("a sound scene");
    assert_eq!(scene.parts.len(), 1);
    let Part { name, mesh, .. } = &scene.parts[0];
    assert!(name.starts_with("table"), "{name}");
    assert_eq!((mesh.positions.len(), mesh.triangles.len()), (8, 4));
    assert_eq!(mesh.positions[4], Vec3::new(-1.0, 1.0, 1.0));
    let camera = scene.cameras.first().expect("the file's camera");
    assert!((camera.position - DVec3::new(0.0, 5.0, 5.0)).length() < 1e-6);
    let toml = "canvas = [96, 96]\n[light]\ndirection = [0.0, -1.0, 0.0]\n[map]\nsize = 256\n[lookup]\nbias = 0.01\n";
    let settings = Settings::parse("table.toml", toml).expect("sound settings");
    let case = fit::case("table", scene, &settings).expect("a case");
    let m = measure(&case, 1).measurement;
    assert!(m.shadowed > 100 && m.lit > 1000, "{} lit, {} shadowed", m.lit, m.shadowed);
    assert!(m.samples.outside_map == 0, "the fitted box holds every receiver");
    assert!(
        m.false_shadow.rate.unwrap() < 0.02 && m.false_light.rate.unwrap() < 0.2,
        "{}",
        m.verdict
    );
    assert_eq!(m.samples.ambiguous, 0);
}

#[test]
fn a_glb_is_the_same_scene() {
    let folder = Folder::new();
    let mut value = gltf();
    value["buffers"][0].as_object_mut().expect("a buffer").remove("uri");
    let mut chunk = value.to_string().into_bytes();
    chunk.resize(chunk.len().div_ceil(4) * 4, b' ');
    let binary = geometry();
    let total = 12 + 8 + chunk.len() + 8 + binary.len();
    let mut glb = b"glTF".to_vec();
    for word in [2u32, total as u32, chunk.len() as u32, 0x4e4f_534a] {
        glb.extend(word.to_le_bytes());
    }
    glb.extend(chunk);
    glb.extend((binary.len() as u32).to_le_bytes());
    glb.extend(0x004e_4942u32.to_le_bytes());
    glb.extend(&binary);
    let from_glb = folder.load("table.glb", glb).expect("a sound GLB");
    let from_gltf = folder.load("table.gltf", gltf().to_string()).expect("a sound glTF");
    assert_eq!(from_glb.parts, from_gltf.parts);
}

#[test]
fn an_obj_scene_is_read_without_its_materials() {
    let folder = Folder::new();
    folder.write("m.mtl", "newmtl a\nKd 1 0\n");
    let obj =
        "mtllib m.mtl\no plane\nv -1 0 1\nv 1 0 1\nv 1 0 -1\nv -1 0 -1\nusemtl a\nf 1 2 3 4\n";
    let scene =
        folder.load("plane.obj", obj).expect("a sound OBJ; the broken material is not opened");
    assert_eq!(scene.parts[0].mesh.triangles.len(), 2);
}

/// A square of one face, with an element and properties that nobody needs.
const PLY: &str = "ply\nformat ascii 1.0\ncomment a plane\nelement vertex 4\nproperty float x\n\
    property float y\nproperty double z\nproperty uchar red\nelement edge 1\n\
    property int vertex1\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n\
    -1 0 1 255\n1 0 1 255\n1 0 -1 255\n-1 0 -1 255\n7\n4 0 1 2 3\n";

#[test]
fn a_ply_scene_is_read_as_text_and_binary() {
    let folder = Folder::new();
    let text = folder.load("plane.ply", PLY).expect("a sound PLY");
    let obj = "v -1 0 1\nv 1 0 1\nv 1 0 -1\nv -1 0 -1\nf 1 2 3 4\n";
    let expected = folder.load("plane.obj", obj).expect("a sound OBJ");
    let mesh = |scene: &LoadedScene| scene.parts[0].mesh.clone();
    assert_eq!(mesh(&text).positions, mesh(&expected).positions);
    assert_eq!(mesh(&text).triangles, mesh(&expected).triangles);
    for (format, little) in [("binary_little_endian", true), ("binary_big_endian", false)] {
        let (header, _) = PLY.split_once("end_header\n").expect("a header");
        let mut bytes = header.replace("ascii", format).into_bytes();
        bytes.extend(b"end_header\n");
        let mut put = |b: &[u8]| match little {
            true => bytes.extend(b),
            false => bytes.extend(b.iter().rev()),
        };
        for [x, z] in [[-1.0f32, 1.0], [1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]] {
            put(&x.to_le_bytes());
            put(&0.0f32.to_le_bytes());
            put(&f64::from(z).to_le_bytes());
            put(&[255]);
        }
        put(&7i32.to_le_bytes());
        put(&[4]);
        (0..4i32).for_each(|i| put(&i.to_le_bytes()));
        let binary = folder.load(&format!("{format}.ply"), bytes).expect(format);
        assert_eq!(mesh(&binary), mesh(&text), "{format}");
    }
}

#[test]
fn ply_traps_are_named() {
    let folder = Folder::new();
    let edited = |from: &str, to: &str| PLY.replacen(from, to, 1);
    for (text, word) in [
        (edited("-1 0 1 255", "nan 0 1 255"), "PLY"),
        (edited("-1 0 1 255", "-1 0 1e999 255"), "vertex 0"),
        (edited("4 0 1 2 3", "4 0 1 2 4"), "4 vertices"),
        (edited("4 0 1 2 3", "4 0 1 2 -3"), "PLY"),
        (edited("4 0 1 2 3", "2 0 1"), "face 0 has 2 corners"),
        (edited("4 0 1 2 3\n", ""), "PLY"),
        (edited("vertex 4", "vertex 4000000000"), "cannot hold 4000000000"),
        (edited("vertex 4", "vertex 99999999999999999999999"), "PLY"),
        (edited("edge 1\nproperty int vertex1", "edge 1"), "cannot hold 1 of 'edge'"),
        (edited("element face 1", "element faces 1"), "no triangle"),
        ("ply\n".to_string(), "PLY"),
        (String::new(), "PLY"),
    ] {
        let error = folder.load("trap.ply", &text).expect_err(&text).to_string();
        assert!(error.contains(word) && error.contains("trap.ply"), "{text:?}: {error}");
        assert!(!error.contains('\n') && error.len() < 500, "{error}");
    }
    let path = folder.write("lenient.ply", edited("4 0 1 2 3", "2 0 1"));
    let lenient = Limits { lenient: true, ..Limits::default() };
    let error = load(&path, &lenient).expect_err("nothing is left").to_string();
    assert!(error.contains("no triangle"), "{error}");
}

/// The complaint about a glTF with one thing changed.
fn complaint(edit: impl FnOnce(&mut Value)) -> String {
    let mut value = gltf();
    edit(&mut value);
    let error = Folder::new().load("trap.gltf", value.to_string()).expect_err("a trap");
    assert_eq!(error.exit_code(), 2, "{error}");
    let text = error.to_string();
    assert!(text.contains("trap.gltf") || text.contains(".bin"), "no file in: {text}");
    assert!(!text.contains('\n') && text.len() < 500, "{text}");
    text
}

#[test]
fn accessor_arithmetic_cannot_wrap() {
    let huge = 1u64 << 60;
    for edit in [
        (|v: &mut Value| v["accessors"][0]["count"] = json!(0)) as fn(&mut Value),
        |v| v["accessors"][0]["count"] = json!(9),
        |v| v["accessors"][0]["count"] = json!(1u64 << 62),
        |v| {
            v["accessors"][0]["count"] = json!((1u64 << 60) + 1);
            v["bufferViews"][0]["byteStride"] = json!(16);
        },
        |v| v["bufferViews"][0]["byteOffset"] = json!(u64::MAX - 7),
        |v| v["accessors"][0]["byteOffset"] = json!(u64::MAX - 3),
        |v| v["bufferViews"][1]["byteLength"] = json!(4),
        |v| v["buffers"][0]["byteLength"] = json!(1u64 << 40),
    ] {
        let text = complaint(edit);
        assert!(!text.is_empty(), "{huge}");
    }
}

#[test]
fn geometry_traps_are_named() {
    assert!(complaint(|v| v["nodes"][0]["children"] = json!([1, 2, 0])).contains("nodes[0]"));
    assert!(complaint(|v| v["nodes"][1]["children"] = json!([1])).contains("nodes[1]"));
    assert!(complaint(|v| v["scenes"][0]["nodes"] = json!([0, 1])).contains("reached twice"));
    assert!(complaint(|v| v["nodes"][1]["scale"] = json!([0.0, 1.0, 1.0])).contains("singular"));
    assert!(complaint(|v| v["accessors"][1]["count"] = json!(11)).contains("multiple of 3"));
    assert!(complaint(|v| v["accessors"][0]["count"] = json!(4)).contains("4 vertices"));
    assert!(complaint(|v| v["buffers"][0]["uri"] = json!("../secret.bin")).contains("outside"));
    assert!(complaint(|v| v["buffers"][0]["uri"] = json!("file:///dev/zero")).contains("outside"));
    assert!(complaint(|v| v["buffers"][0]["uri"] = json!("%FF%FE.bin")).contains("UTF-8"));
    assert!(complaint(|v| v["buffers"][0]["uri"] = json!("data:x;base64,@@@")).contains("base64"));
    assert!(complaint(|v| v["extensionsRequired"] = json!(["ACME_geometry"])).contains("glTF"));
}

#[test]
fn deep_chains_are_refused_without_recursion() {
    let mut value = gltf();
    let depth = 5000;
    let nodes: Vec<Value> = (0..depth)
        .map(|i| if i + 1 < depth { json!({ "children": [i + 1] }) } else { json!({ "mesh": 0 }) })
        .collect();
    value["nodes"] = json!(nodes);
    let text = value.to_string();
    let worker = std::thread::Builder::new()
        .stack_size(256 << 10)
        .spawn(move || Folder::new().load("deep.gltf", text).expect_err("too deep").to_string());
    let message = worker.expect("a thread").join().expect("no overflow");
    assert!(message.contains("deeper than 1024"), "{message}");
}

#[test]
fn obj_traps_are_named() {
    let folder = Folder::new();
    for (text, word) in [
        ("v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "vertex 0"),
        ("v 0 0 0\nv 1e999 0 0\nv 0 1 0\nf 1 2 3\n", "vertex 1"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", "OBJ"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 0\n", "OBJ"),
        ("v 0 0 0\n", "no triangle"),
        ("", "no triangle"),
    ] {
        let error = folder.load("trap.obj", text).expect_err(text).to_string();
        assert!(error.contains(word) && error.contains("trap.obj"), "{text:?}: {error}");
    }
}

/// However long the line of sight is, only its direction decides which way is up.
#[test]
fn a_camera_that_looks_down_is_not_rolled() {
    let obj = "v -2 0 -2\nv 2 0 -2\nv 2 0 2\nv -2 0 2\nv 0 1 0\nf 1 2 3\nf 1 3 4\nf 1 2 5\n";
    let scene = Folder::new().load("scene.obj", obj).unwrap();
    for length in [1e-3, 0.5, 1.0, 4.0, 1e3] {
        for (sight, up) in [
            ([3.0, -4.0, -5.0], DVec3::Y),
            ([1.0, -6.9, 0.0], DVec3::Y),
            ([1.0, 6.9, 0.0], DVec3::Y),
            ([0.0, -1.0, 0.0], DVec3::NEG_Z),
            ([0.1, -1.0, 0.0], DVec3::NEG_Z),
            ([0.0, 1.0, 0.05], DVec3::NEG_Z),
        ] {
            let position = DVec3::new(1.0, 2.0, 3.0);
            let mut settings = Settings::default();
            settings.camera.position = Some(position.to_array());
            let sight = DVec3::from_array(sight) * length;
            settings.camera.target = Some((position + sight).to_array());
            let view = fit::case("scene", scene.clone(), &settings).unwrap().camera.view;
            assert_eq!(view.up, up, "looking along {sight}");
            settings.camera.up = Some([1.0, 0.5, 0.25]);
            let view = fit::case("scene", scene.clone(), &settings).unwrap().camera.view;
            assert_eq!(view.up, DVec3::new(1.0, 0.5, 0.25), "a given up stays");
        }
    }
}

#[test]
fn limits_hold_before_allocation() {
    let folder = Folder::new();
    let path = folder.write("table.gltf", gltf().to_string());
    for (limits, word) in [
        (Limits { vertices: 7, ..Limits::default() }, "7 vertices"),
        (Limits { indices: 11, ..Limits::default() }, "11 indices"),
        (Limits { bytes: 100, ..Limits::default() }, "100 bytes"),
    ] {
        let error = load(&path, &limits).expect_err(word).to_string();
        assert!(error.contains(word), "{error}");
    }
}

#[test]
fn the_command_line_measures_a_scene_and_names_mistakes() {
    let folder = Folder::new();
    let scene = folder.write("table.gltf", gltf().to_string());
    let out = folder.0.path().join("out");
    let run = |more: &[&str]| {
        let output = Command::new(env!("CARGO_BIN_EXE_gnomon-report"))
            .args(["--quick", "--scene", scene.to_str().unwrap(), "--out", out.to_str().unwrap()])
            .args(more)
            .output()
            .expect("the binary runs");
        (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
    };
    for (arguments, word) in [
        (&["--format", "d17"][..], "unorm16"),
        (&["--map", "0"], "map.size"),
        (&["--light-dir", "0,0,0"], "light.direction"),
        (&["--config", "nowhere.toml"], "nowhere.toml"),
    ] {
        let (code, message) = run(arguments);
        assert_eq!(code, Some(2), "{message}");
        assert!(message.contains(word), "{message} lacks {word}");
        assert!(!out.exists(), "nothing is written");
    }
    folder.write("table.toml", "[light]\nnear = 5.0\nfar = 1.0\n");
    let (code, message) = run(&[]);
    assert_eq!(code, Some(2), "{message}");
    assert!(message.contains("near"), "{message}");
    folder.write("table.toml", "canvas = [64, 64]\n");
    let (code, message) = run(&["--light-pos", "1,6,2", "--bias", "0.001", "--map", "128"]);
    assert_eq!(code, Some(0), "{message}");
    assert!(out.join("index.html").is_file() && out.join("results.json").is_file());
}
