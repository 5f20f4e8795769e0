//! The rim of the program: inputs that are no files, that need too much, or whose numbers say nothing.
#![cfg(unix)]

use serde_json::Value;
use std::fs;
use std::os::unix::net::UnixListener;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A floor and a triangle above it.
const SCENE: &str = "o floor\nv -2 0 -2\nv 2 0 -2\nv 2 0 2\nv -2 0 2\nf 1 3 2\nf 1 4 3\n\
    o plate\nv -0.5 1 -0.5\nv 0.5 1 -0.5\nv 0 1 0.5\nf 5 7 6\n";

struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        let folder = Self(tempfile::tempdir().expect("a folder"));
        folder.write("scene.obj", SCENE);
        folder.write("scene.toml", "canvas = [32, 32]\nmap.size = 64\n");
        folder
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn write(&self, name: &str, content: impl AsRef<[u8]>) -> PathBuf {
        fs::write(self.path(name), content).expect("a file");
        self.path(name)
    }

    fn run(&self, binary: &str, arguments: &[&str]) -> Output {
        let command = &mut Command::new(binary);
        let arguments =
            arguments.iter().map(|a| a.replace("DIR", &self.0.path().to_string_lossy()));
        command.args(arguments).output().expect("the binary runs")
    }

    /// A refusal: exit code 2, one sentence, nothing written.
    #[track_caller]
    fn refused(&self, binary: &str, arguments: &[&str]) -> String {
        let output = self.run(binary, arguments);
        let text = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {text}");
        assert!(text.lines().count() == 1 && text.len() < 600, "{arguments:?}: {text}");
        assert!(!self.path("out").exists(), "{arguments:?} has written");
        text
    }
}

const REPORT: &str = env!("CARGO_BIN_EXE_gnomon-report");
const SWEEP: &str = env!("CARGO_BIN_EXE_gnomon-sweep");
const TUNE: &str = env!("CARGO_BIN_EXE_gnomon-tune");
const ROUNDTRIP: &str = env!("CARGO_BIN_EXE_gnomon-roundtrip");
const CONFORMANCE: &str = env!("CARGO_BIN_EXE_gnomon-conformance");

/// A pipe that nobody writes into would hold a reader up for ever, and this test with it.
#[test]
fn pipes_devices_sockets_and_folders_are_refused_for_every_input() {
    let folder = Folder::new();
    let _socket = UnixListener::bind(folder.path("socket.x")).expect("a socket");
    assert!(Command::new("mkfifo").arg(folder.path("pipe.x")).status().expect("mkfifo").success());
    fs::create_dir(folder.path("folder.x")).expect("a folder");
    std::os::unix::fs::symlink("/dev/zero", folder.path("device.x")).expect("a link");
    let scene = "--scene DIR/scene.obj --out DIR/out";
    for (kind, word) in
        [("pipe", "a pipe"), ("device", "a device"), ("socket", "a socket"), ("folder", "a folder")]
    {
        for (i, (binary, extension, arguments)) in [
            (
                REPORT,
                "png",
                format!("{scene} --light-matrix {} --map-file FILE", "1,".repeat(15) + "1"),
            ),
            (REPORT, "toml", format!("{scene} --config FILE")),
            (REPORT, "glb", "--out DIR/out --scene FILE".to_string()),
            (SWEEP, "json", format!("{scene} --baseline FILE")),
            (TUNE, "obj", "--out DIR/out --scene FILE".to_string()),
            (ROUNDTRIP, "toml", "--out DIR/out --pair FILE".to_string()),
            (CONFORMANCE, "json", "--device FILE".to_string()),
        ]
        .into_iter()
        .enumerate()
        {
            // Of their own names, or one would be the settings beside the other.
            let name = format!("{kind}-{i}.{extension}");
            let _ = std::os::unix::fs::symlink(format!("{kind}.x"), folder.path(&name));
            let arguments = arguments.replace("FILE", &format!("DIR/{name}"));
            let text = folder.refused(binary, &arguments.split(' ').collect::<Vec<_>>());
            assert!(text.contains(&name) && text.contains(word), "{text}");
        }
        let shards = folder.path("shards");
        fs::create_dir_all(&shards).expect("a folder");
        let shard = shards.join("shard-1-of-1.items");
        let _ = fs::remove_file(&shard);
        std::os::unix::fs::symlink(folder.path(&format!("{kind}.x")), shard).expect("a link");
        let arguments =
            format!("--scene DIR/scene.obj --out DIR/merged --merge {}", shards.display());
        let output = folder.run(SWEEP, &arguments.split(' ').collect::<Vec<_>>());
        let text = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.code() == Some(2) && text.contains(word), "{text}");
    }
    // A settings file beside the scene is an input too.
    fs::remove_file(folder.path("scene.toml")).expect("removed");
    std::os::unix::fs::symlink("pipe.x", folder.path("scene.toml")).expect("a link");
    let text = folder.refused(REPORT, &["--scene", "DIR/scene.obj", "--out", "DIR/out"]);
    assert!(text.contains("scene.toml") && text.contains("a pipe"), "{text}");
}

fn glb(json: &Value, binary: &[u8]) -> Vec<u8> {
    let mut chunk = json.to_string().into_bytes();
    chunk.resize(chunk.len().next_multiple_of(4), b' ');
    let total = 12 + 8 + chunk.len() + 8 + binary.len();
    let words = [2, total as u32, chunk.len() as u32, 0x4e4f_534a].map(u32::to_le_bytes);
    let length = (binary.len() as u32).to_le_bytes();
    let parts: [&[u8]; 6] =
        [b"glTF", words.as_flattened(), &chunk, &length, &0x004e_4942u32.to_le_bytes(), binary];
    parts.concat()
}

/// Only the first buffer may be the binary chunk: a hundred of them are no hundred copies.
#[test]
fn a_binary_chunk_serves_one_buffer() {
    let folder = Folder::new();
    let binary = vec![0; 36];
    let buffers: Vec<Value> = (0..100).map(|_| serde_json::json!({ "byteLength": 36 })).collect();
    let json = serde_json::json!({ "asset": { "version": "2.0" }, "buffers": buffers,
        "scenes": [{ "nodes": [] }] });
    folder.write("many.glb", glb(&json, &binary));
    let text = folder.refused(REPORT, &["--scene", "DIR/many.glb", "--out", "DIR/out"]);
    assert!(text.contains("buffers[1]") && text.contains("no URI"), "{text}");
}

/// What a run needs is estimated before it starts, and told with the knob.
#[test]
fn needs_beyond_the_budget_are_told_with_the_knob() {
    let folder = Folder::new();
    let scene = ["--scene", "DIR/scene.obj", "--out", "DIR/out"];
    let told = |binary: &str, more: &[&str], words: &[&str]| {
        let text = folder.refused(binary, &[&scene[..], more].concat());
        words.iter().for_each(|word| assert!(text.contains(word), "{word} is not in {text}"));
    };
    let budget = "the budget is 512.0 MiB";
    let few = ["--max-memory", "512MiB"];
    for binary in [REPORT, TUNE, SWEEP] {
        told(
            binary,
            &[&few[..], &["--map", "8192"]].concat(),
            &["needs", budget, "lower --map", "--max-memory"],
        );
    }
    folder.write("scene.toml", "canvas = [8192, 8192]\nmap.size = 64\n");
    for binary in [REPORT, TUNE] {
        told(binary, &[], &["needs", "GiB", "lower the canvas", "--max-memory"]);
    }
    folder.write("scene.toml", "canvas = [32, 32]\n");
    told(REPORT, &["--max-memory", "100KiB", "--map", "16"], &["needs", "the budget is 100.0 KiB"]);
    told(REPORT, &["--max-memory", "1KiB"], &["scene.obj", "needs", "the budget is 1.0 KiB"]);
    let output = folder.run(REPORT, &["--max-memory", "lots"]);
    assert_eq!(output.status.code(), Some(2), "no amount");
}

/// A picture's size, texts and colour profiles are no reason to take memory.
#[test]
fn pictures_are_counted_before_they_are_decoded() {
    let folder = Folder::new();
    let bomb = |name: &str, side: u32, text: usize| {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, side, side);
        encoder.set_color(png::ColorType::Grayscale);
        encoder.set_depth(png::BitDepth::Sixteen);
        if text > 0 {
            encoder.add_ztxt_chunk("Comment".into(), "0".repeat(text)).expect("a text");
        }
        let mut writer = encoder.write_header().expect("a header");
        writer.write_image_data(&vec![0x80; 2 * (side * side) as usize]).expect("samples");
        writer.finish().expect("an end");
        folder.write(name, bytes)
    };
    let matrix = "0.25,0,0,0, 0,0,-0.25,0, 0,-0.1,0,0, 0,0,0,1".replace(' ', "");
    let arguments = |file: &'static str, budget: &'static str| {
        let words = ["--scene", "DIR/scene.obj", "--out", "DIR/out", "--packing", "unorm16"];
        let more = ["--map-file", file, "--max-memory", budget, "--light-matrix"];
        [&words[..], &more[..]].concat()
    };
    bomb("large.png", 4096, 0);
    let refused = arguments("DIR/large.png", "128MiB");
    let text = folder.refused(REPORT, &[&refused[..], &[&matrix]].concat());
    assert!(
        text.contains("large.png") && text.contains("needs") && text.contains("128.0 MiB"),
        "{text}"
    );
    bomb("texts.png", 16, 200 << 20);
    let script = "ulimit -v 400000; exec \"$@\"";
    let mut command = Command::new("sh");
    command.args(["-c", script, "sh", REPORT, "--quick", "--threads", "1"]);
    let words = arguments("DIR/texts.png", "1GiB");
    command.args(words.iter().map(|a| a.replace("DIR", &folder.0.path().to_string_lossy())));
    let output = command.arg(&matrix).output().expect("the binary runs");
    let code = output.status.code();
    let text = String::from_utf8_lossy(&output.stderr);
    assert!(matches!(code, Some(0 | 2 | 3)) && !text.contains("alloc"), "{code:?}: {text}");
}

/// Every number of the settings that is too many, not finite or without effect is named with its line.
#[test]
fn settings_that_say_nothing_are_errors_with_their_line() {
    let folder = Folder::new();
    for (toml, place, word) in [
        ("canvas = [16, 16, 99]", "line 1: ", "exactly 2"),
        ("[light]\ndirection = [0, -1, 0, 5, 6]", "line 2: ", "exactly 3"),
        ("[light]\ndirection = [0, -1, 0]\nfovy = 40", "line 3: light.fovy", "directional"),
        (
            "[light]\ndirection = [0, -1, 0]\n\ntarget = [0, 0, 0]",
            "line 4: light.target",
            "directional",
        ),
        ("light.fovy = 40", "line 1: light.fovy", "directional"),
        (
            "[light]\ntype = \"spot\"\nposition = [0, 5, 0]\nwidth = 4",
            "line 4: light.width",
            "spot",
        ),
        ("[light]\ndirection = [0, -1, 0]\nleft = -4", "line 3: light.left", "light.position"),
        (
            "[light]\nposition = [0, 5, 0]\nleft = -4\ntop = 3",
            "line 3: light.left",
            "width and height",
        ),
        (
            "[light]\nposition = [0, 5, 0]\ndirection = [0, -1, 0]",
            "line 3: light.direction",
            "type",
        ),
        ("[light]\ntype = \"point\"\nposition = [0, 5, 0]", "line 2: light.type", "fovy = 90"),
        ("[light]\ntype = \"spot\"", "line 2: light.type", "light.position"),
        ("[light]\nname = \"sun\"", "line 2: light.name", "no light"),
        ("[light]\nposition = [0, 5, 1]\nname = \"sun\"", "line 3: light.name", "no effect"),
        ("[light]\nposition = [0, 5, 1]\nfar = 9\nrange = 9", "line 4: light.range", "light.far"),
        ("[light]\ndirection = [0, -1, 0]\nrange = 9", "line 3: light.range", "directional"),
        ("camera.name = \"eye\"", "line 1: camera.name", "no camera"),
        ("camera.height = 3", "line 1: camera.height", "perspective"),
        ("camera.type = \"orthographic\"\ncamera.fovy = 3", "line 2: camera.fovy", "orthographic"),
        ("camera.type = \"fisheye\"", "line 1: camera.type", "orthographic"),
        ("focus = \"nobody\"", "line 1: focus", "no object"),
        ("map.size = [0, 4]", "line 1: map.size", "8192"),
        ("[camera]\ntarget = [0, 0, 0]", "line 2: camera.target", "without camera.position"),
        ("\n[camera]\nup = [0, 1, 0]", "line 3: camera.up", "without camera.position"),
        ("[camera]\nfovy = 0", "line 2: camera.fovy", "0 is not in (0, 180)"),
        ("[camera]\nposition = [0, 3, 3]\nfovy = 180.0", "line 3: camera.fovy", "(0, 180)"),
        ("[light]\nposition = [0, 5, 1]\nfovy = 0", "line 3: light.fovy", "0 is not in (0, 180)"),
        ("[light]\ndirection = [0, 0, 0]", "line 2: light.direction", "zero"),
        ("[light]\ndirection = [0, -1, 0]\nwidth = 0", "line 3: light.width", "positive"),
        ("[light]\nnear = 5\nfar = 1", "line 2: light.near", "far"),
        ("[light]\nposition = [0, 1e30, 1]", "line 2: light.position", "1e30"),
        ("[camera]\nposition = [0, 1e25, 1]", "line 2: camera.position", "1e25"),
        ("map.size = 0", "line 1: map.size", "8192"),
        ("map.format = \"d17\"", "line 1: map.format", "unorm16"),
        ("lookup.filter = \"soft\"", "line 1: lookup.filter", "pcf3x3"),
        ("lookup.bias = nan", "line 1: ", "finite"),
    ] {
        folder.write("scene.toml", toml);
        let text = folder.refused(REPORT, &["--scene", "DIR/scene.obj", "--out", "DIR/out"]);
        let place = format!("scene.toml: {place}");
        assert!(text.contains(&place) && text.contains(word), "{toml:?}: {text}");
    }
    // A flag stands above the file's light and takes the keys of the other kind with it.
    folder.write("scene.toml", "canvas = [16, 16]\n[light]\nposition = [0, 5, 1]\nfovy = 40\n");
    let scene = ["--scene", "DIR/scene.obj", "--out", "DIR/out", "--map", "16"];
    let text = folder.refused(REPORT, &[&scene[..], &["--light-pos", "1e30,0,0"]].concat());
    assert!(text.contains("--light-pos"), "{text}");
    let output = folder.run(REPORT, &[&scene[..], &["--light-dir", "0,-1,0.1"]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
}

/// The counts of a case's `results.json` but for lengths in world units.
fn counts(path: &Path) -> Vec<u64> {
    fn walk(value: &Value, found: &mut Vec<u64>) {
        match value {
            Value::Number(n) => found.extend(n.as_u64()),
            Value::Array(items) => items.iter().for_each(|v| walk(v, found)),
            Value::Object(members) => members.values().for_each(|v| walk(v, found)),
            Value::Null | Value::Bool(_) | Value::String(_) => {}
        }
    }
    let value: Value = serde_json::from_slice(&fs::read(path).expect("results")).expect("JSON");
    let mut found = Vec::new();
    walk(&value["cases"], &mut found);
    found
}

/// A scene scaled by 2^k keeps its counts over the whole range; beyond it the file is refused.
#[test]
fn scenes_of_any_size_keep_their_counts() {
    let folder = Folder::new();
    folder.write("scene.toml", "canvas = [64, 48]\nmap.size = 64\n");
    let scaled = |k: i32| {
        let scale = 2f64.powi(k);
        let line = |line: &str| match line.strip_prefix("v ") {
            Some(p) => {
                let p: Vec<String> = p
                    .split(' ')
                    .map(|x| format!("{:e}", x.parse::<f64>().expect("a number") * scale))
                    .collect();
                format!("v {}\n", p.join(" "))
            }
            None => format!("{line}\n"),
        };
        folder.write("scene.obj", SCENE.lines().map(line).collect::<String>());
        let out = folder.path(&format!("out{k}"));
        let output =
            folder.run(REPORT, &["--scene", "DIR/scene.obj", "--out", &out.to_string_lossy()]);
        (
            output.status.code(),
            out.join("results.json"),
            String::from_utf8_lossy(&output.stderr).into_owned(),
        )
    };
    let (code, path, text) = scaled(0);
    assert_eq!(code, Some(0), "{text}");
    let home = counts(&path);
    assert!(home.iter().filter(|&&n| n > 10).count() > 5, "counts were read: {home:?}");
    for k in [-70, -64, -1, 1, 57] {
        let (code, path, text) = scaled(k);
        assert_eq!(code, Some(0), "2^{k}: {text}");
        assert_eq!(counts(&path), home, "2^{k}");
    }
    for k in [-80, -100, 62, 79, 90] {
        let (code, _, text) = scaled(k);
        assert!(
            code == Some(2) && text.contains("scene.obj") && text.contains("scale the scene"),
            "2^{k}: {text}"
        );
    }
}
