//! Untrusted input at the command line: bombs under a memory limit, places outside the folder, damaged
//! meshes, deep nesting.
#![cfg(unix)]

use serde_json::{Value, json};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::time::{Duration, Instant};

/// A sound scene: one triangle and a small one above it, each a node of its own.
fn gltf() -> Value {
    json!({
        "asset": { "version": "2.0" },
        "scene": 0,
        "scenes": [{ "nodes": [0, 1] }],
        "nodes": [{ "mesh": 0 }, { "mesh": 0, "translation": [0, 1, 0], "scale": [0.25, 1, 0.25] }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1 }] }],
        "buffers": [{ "uri": "points.bin", "byteLength": 60 }],
        "bufferViews": [
            { "buffer": 0, "byteLength": 48 },
            { "buffer": 0, "byteOffset": 48, "byteLength": 12 },
        ],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3",
              "min": [-1, 0, -1], "max": [1, 0, 1] },
            { "bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR" },
        ],
    })
}

/// Four corners of a square and its two triangles.
fn points(corners: [[f32; 3]; 4], indices: [u16; 6]) -> Vec<u8> {
    let corners = corners.into_iter().flatten().flat_map(f32::to_le_bytes);
    corners.chain(indices.into_iter().flat_map(u16::to_le_bytes)).collect()
}

const SQUARE: [[f32; 3]; 4] =
    [[-1.0, 0.0, -1.0], [1.0, 0.0, -1.0], [1.0, 0.0, 1.0], [-1.0, 0.0, 1.0]];
const TWO: [u16; 6] = [0, 2, 1, 0, 3, 2];

struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        let folder = Self(tempfile::tempdir().unwrap());
        folder.write("points.bin", points(SQUARE, TWO));
        folder.write("scene.gltf", gltf().to_string());
        for settings in ["scene.toml", "edited.toml", "good.toml"] {
            folder.write(settings, "canvas = [64, 64]");
        }
        folder
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn write(&self, name: &str, content: impl AsRef<[u8]>) -> PathBuf {
        fs::write(self.path(name), content).unwrap();
        self.path(name)
    }

    fn edited(&self, edit: impl FnOnce(&mut Value)) -> PathBuf {
        let mut value = gltf();
        edit(&mut value);
        self.write("edited.gltf", value.to_string())
    }

    /// Measures a scene with at most `kib` KiB of address space.
    fn measure(&self, scene: &Path, kib: u32, more: &[&str]) -> Output {
        let script = format!("ulimit -v {kib}; exec \"$@\"");
        let mut command = Command::new("sh");
        command.args(["-c", &script, "sh", env!("CARGO_BIN_EXE_gnomon-report")]);
        command.args(["--quick", "--threads", "1", "--map", "64", "--scene"]).arg(scene);
        command.arg("--out").arg(self.path("out")).args(more).output().unwrap()
    }
}

/// Ample for a run on a small scene.
const ROOM: u32 = 512 << 10;

#[track_caller]
fn refused(output: &Output, about: &str) -> String {
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{about}: {text}");
    assert!(text.lines().count() == 1 && text.len() < 1000, "{about}: {text}");
    text
}

/// R33: files of a few KB (and settings) that ask for gigabytes are refused without being given any.
#[test]
fn bombs_are_refused_in_half_a_gigabyte() {
    let folder = Folder::new();
    let sound = folder.measure(&folder.path("scene.gltf"), ROOM, &[]);
    assert_eq!(sound.status.code(), Some(0), "{}", String::from_utf8_lossy(&sound.stderr));
    let edits: [fn(&mut Value); 10] = [
        |v| v["accessors"][0]["count"] = json!(1u64 << 62),
        |v| v["accessors"][0]["count"] = json!(2_000_000_000u64),
        |v| v["accessors"][1]["count"] = json!(4_000_000_002u64),
        |v| v["buffers"][0]["byteLength"] = json!(1u64 << 40),
        |v| v["accessors"][0]["byteOffset"] = json!(u64::MAX - 3),
        |v| v["bufferViews"][0]["byteOffset"] = json!(u64::MAX - 7),
        |v| {
            v["accessors"][0]["bufferView"] = Value::Null;
            v["accessors"][0]["count"] = json!(90_000_000);
        },
        |v| {
            v["accessors"][0]["sparse"] = json!({
                "count": 1u64 << 33,
                "indices": { "bufferView": 1, "componentType": 5125 },
                "values": { "bufferView": 0 },
            });
        },
        |v| v["nodes"][0]["children"] = json!(vec![1; 2000]),
        |v| v["meshes"][0]["primitives"][0]["indices"] = json!(4_000_000_000u64),
    ];
    for (i, edit) in edits.into_iter().enumerate() {
        refused(&folder.measure(&folder.edited(edit), ROOM, &[]), &format!("edit {i}"));
    }
    let glb = |total: u32, chunk: u32| {
        let words = [0x4654_6c67, 2, total, chunk, 0x4e4f_534a];
        words.into_iter().flat_map(u32::to_le_bytes).collect::<Vec<u8>>()
    };
    let nested = "[".repeat(60_000);
    for (name, bytes) in [
        ("total.glb", glb(u32::MAX, 12)),
        ("chunk.glb", glb(20, u32::MAX)),
        ("nested.gltf", nested.clone().into_bytes()),
        ("face.obj", b"v 0 0 0\nf 1 2 99999999999999999999\n".to_vec()),
        (
            "count.ply",
            b"ply\nformat ascii 1.0\nelement vertex 4294967295\nproperty float x\nend_header\n"
                .to_vec(),
        ),
        ("negative.obj", b"v 0 0 0\nf -1 -2 -9223372036854775808\n".to_vec()),
    ] {
        refused(&folder.measure(&folder.write(name, bytes), ROOM, &[]), name);
    }
    let scene = folder.path("scene.gltf");
    for (name, toml) in [
        ("canvas", "canvas = [4294967295, 4294967295]".to_string()),
        ("nested", format!("canvas = {nested}")),
        ("size", "[map]\nsize = 4294967295".to_string()),
        ("keys", "canvas = [8, 8]\ncanvas = [8, 8]".to_string()),
        ("unknown", "canvass = [8, 8]".to_string()),
    ] {
        let config = folder.write("bomb.toml", toml).display().to_string();
        let start = Instant::now();
        // --map stands above the file, so the size is given by the file alone.
        let mut command = Command::new(env!("CARGO_BIN_EXE_gnomon-report"));
        command.args(["--quick", "--config", &config, "--scene"]).arg(&scene);
        refused(&command.arg("--out").arg(folder.path("never")).output().unwrap(), name);
        assert!(start.elapsed() < Duration::from_secs(1), "{name}: R37");
        assert!(!folder.path("never").exists(), "{name}: nothing is written");
    }
}

/// R34: buffers that are links, pipes, devices or elsewhere are refused without being read.
#[test]
fn buffers_come_from_regular_files_of_the_folder_alone() {
    let outer = tempfile::tempdir().unwrap();
    fs::write(outer.path().join("secret.bin"), points(SQUARE, TWO)).unwrap();
    let folder = Folder::new();
    std::os::unix::fs::symlink(outer.path().join("secret.bin"), folder.path("link.bin")).unwrap();
    std::os::unix::fs::symlink("/dev/zero", folder.path("zero.bin")).unwrap();
    let pipe = Command::new("mkfifo").arg(folder.path("pipe.bin")).status().unwrap();
    assert!(pipe.success());
    fs::create_dir(folder.path("folder.bin")).unwrap();
    let absolute = outer.path().join("secret.bin").display().to_string();
    for (uri, word) in [
        ("link.bin", "outside"),
        ("zero.bin", "outside"),
        ("pipe.bin", "regular"),
        ("folder.bin", "regular"),
        ("%2e%2e/secret.bin", "outside"),
        ("a/../../secret.bin", "outside"),
        ("file:///dev/zero", "outside"),
        (absolute.as_str(), "outside"),
    ] {
        let scene = folder.edited(|v| v["buffers"][0]["uri"] = json!(uri));
        let start = Instant::now();
        let text = refused(&folder.measure(&scene, ROOM, &[]), uri);
        assert!(text.contains(word), "{uri}: {text}");
        assert!(start.elapsed() < Duration::from_secs(1), "{uri}: {:?}", start.elapsed());
    }
}

/// R32: the rows that made other loaders panic or lie, at the command line.
#[test]
fn what_broke_other_loaders_is_harmless() {
    let folder = Folder::new();
    folder.write("bad.mtl", "newmtl a\nKd 1 0\nKd\n");
    let obj = "mtllib bad.mtl\nv 0 0 0\nv 1 0 0\nv 0 0 -1\nusemtl a\nf 1 2 3\n";
    let output = folder.measure(&folder.write("good.obj", obj), ROOM, &["--light-dir", "0,-1,0"]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    // Images are never read, however they lie.
    let image = folder.edited(|v| {
        v["images"] = json!([{ "bufferView": 2, "mimeType": "image/png" }]);
        let view = json!({ "buffer": 0, "byteOffset": 0, "byteLength": 1u64 << 40 });
        v["bufferViews"].as_array_mut().unwrap().push(view);
    });
    assert_eq!(folder.measure(&image, ROOM, &[]).status.code(), Some(0));
    let cycle = folder.edited(|v| {
        v["nodes"][0]["children"] = json!([1]);
        v["nodes"][1]["children"] = json!([0]);
        v["scenes"][0]["nodes"] = json!([0]);
    });
    assert!(refused(&folder.measure(&cycle, ROOM, &[]), "cycle").contains("reached twice"));
    for (bytes, word) in [
        (points([[f32::NAN; 3], SQUARE[1], SQUARE[2], SQUARE[3]], TWO), "vertex 0"),
        (points([SQUARE[0], SQUARE[1], [0.0, f32::INFINITY, 0.0], SQUARE[3]], TWO), "vertex 2"),
        (points([SQUARE[0], SQUARE[1], SQUARE[2], [2e30, 0.0, 0.0]], TWO), "vertex 3"),
        (points(SQUARE, [0, 2, 1, 0, 3, 4]), "index 5 is 4"),
    ] {
        folder.write("points.bin", bytes);
        let text = refused(&folder.measure(&folder.path("scene.gltf"), ROOM, &[]), word);
        assert!(text.contains(word) && text.contains("meshes[0].primitives[0]"), "{text}");
    }
}

/// R36: `--lenient` leaves out what is damaged, counts it in the report and measures the rest.
#[test]
fn damaged_parts_can_be_left_out() {
    let folder = Folder::new();
    let report = |scene: &Path, words: &[&str]| {
        let output = folder.measure(scene, ROOM, &["--lenient", "--light-dir", "0,-1,0"]);
        assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
        let page = fs::read_to_string(folder.path("out/index.html")).unwrap();
        words.iter().for_each(|word| assert!(page.contains(word), "the page lacks '{word}'"));
    };
    folder.write("points.bin", points([SQUARE[0], [f32::NAN; 3], SQUARE[2], SQUARE[3]], TWO));
    report(&folder.path("scene.gltf"), &["1 of 2 triangles are damaged and left out"]);
    folder.write("points.bin", points(SQUARE, [0, 2, 9, 0, 3, 2]));
    report(&folder.path("scene.gltf"), &["1 of 2 triangles are damaged and left out"]);
    folder.write("points.bin", points(SQUARE, TWO));
    let over = folder.edited(|v| v["accessors"][1]["count"] = json!(5));
    report(&over, &["0 of 1 triangles are damaged and left out, 2 indices over"]);
    let flat = folder.edited(|v| v["nodes"][1]["scale"] = json!([0.0, 1.0, 1.0]));
    report(&flat, &["nodes[1] and what hangs on it are left out"]);
    let nothing = points([[f32::NAN; 3]; 4], TWO);
    folder.write("points.bin", nothing);
    let output = folder.measure(&folder.path("scene.gltf"), ROOM, &["--lenient"]);
    assert!(refused(&output, "nothing is left").contains("no triangle"));
}

/// R35: a chain of 10⁶ nodes on a stack of 256 KiB.
#[test]
#[ignore = "soak: a file of 20 MB"]
fn a_chain_of_a_million_nodes_is_refused_on_a_small_stack() {
    let folder = Folder::new();
    let depth = 1_000_000;
    let scene = folder.edited(|v| {
        let below =
            |i: u32| if i < depth { json!({ "children": [i] }) } else { json!({ "mesh": 0 }) };
        v["nodes"] = (1..=depth).map(below).collect();
        v["scenes"][0]["nodes"] = json!([0]);
    });
    let start = Instant::now();
    let script = "ulimit -s 256; exec \"$@\"";
    let mut command = Command::new("sh");
    command.args(["-c", script, "sh", env!("CARGO_BIN_EXE_gnomon-report"), "--threads", "1"]);
    let output = command.arg("--scene").arg(scene).arg("--out").arg(folder.path("out")).output();
    let text = refused(&output.unwrap(), "the chain");
    assert!(text.contains("deeper than 1024"), "{text}");
    println!("10^6 nodes refused in {:?}", start.elapsed());
}
