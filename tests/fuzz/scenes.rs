//! Whole scenes from a seed: a sound file of each format with settings, and few faults in it.

use super::mutate::Random;
use serde_json::{Value, json};

/// A scene file's extension and bytes, and its settings.
pub struct Scene {
    pub extension: &'static str,
    pub bytes: Vec<u8>,
    pub toml: String,
}

/// Coordinates at which meshes and cameras go wrong.
const NUMBERS: [f32; 22] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    1e-3,
    0.1,
    3.5,
    1e3,
    -1e5,
    1e7,
    1e-10,
    1e-20,
    -1e-30,
    1e-42,
    1e12,
    4.6e18,
    -9.3e18,
    1e25,
    1e31,
    f32::MAX,
    f32::INFINITY,
    f32::NAN,
];

fn number(random: &mut Random) -> f32 {
    NUMBERS[random.below(NUMBERS.len())]
}

/// One in `n`.
fn one_in(random: &mut Random, n: usize) -> bool {
    random.below(n) == 0
}

fn uniform(random: &mut Random, low: f32, high: f32) -> f32 {
    low + (high - low) * random.below(1 << 16) as f32 / 65536.0
}

/// Positions and faces: a floor and a few triangles and polygons above it.
struct Mesh {
    positions: Vec<[f32; 3]>,
    faces: Vec<Vec<u32>>,
}

impl Mesh {
    fn new(random: &mut Random) -> Self {
        let half = uniform(random, 0.5, 4.0);
        let mut positions: Vec<[f32; 3]> = [[-1.0, 1.0], [1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]]
            .map(|[x, z]| [x * half, 0.0, z * half])
            .into();
        let mut faces = vec![vec![0, 1, 2, 3]];
        for _ in 0..1 + random.below(5) {
            let (first, count) = (positions.len() as u32, 3 + random.below(5) as u32);
            let (height, flat) = (uniform(random, 0.05, 2.0), one_in(random, 2));
            for _ in 0..count {
                let y = if flat { height } else { uniform(random, 0.0, 2.0) };
                positions.push([uniform(random, -half, half), y, uniform(random, -half, half)]);
            }
            faces.push((first..first + count).collect());
        }
        Self { positions, faces }
    }

    /// One fault of its numbers, its faces or their order.
    fn spoil(&mut self, random: &mut Random) {
        let (vertex, face) = (random.below(self.positions.len()), random.below(self.faces.len()));
        match random.below(9) {
            0 => self.positions[vertex][random.below(3)] = number(random),
            1 => self.positions[vertex] = self.positions[0],
            2 => self.positions.push([number(random), number(random), 0.0]),
            3 => self.faces.push(self.faces[face].clone()),
            4 => self.faces[face].reverse(),
            5 => {
                let at = random.below(self.faces[face].len());
                self.faces[face][at] = random.below(self.positions.len() + 1) as u32;
            }
            6 => {
                let scale = number(random);
                self.positions.iter_mut().flatten().for_each(|x| *x *= scale);
            }
            7 => {
                let offset = number(random);
                self.positions.iter_mut().for_each(|p| p[0] += offset);
            }
            _ => drop(self.faces[face].pop()),
        }
    }

    fn triangles(&self) -> Vec<u32> {
        let fan =
            |f: &Vec<u32>| (2..f.len()).flat_map(|i| [f[0], f[i - 1], f[i]]).collect::<Vec<_>>();
        self.faces.iter().flat_map(fan).collect()
    }

    fn obj(&self, random: &mut Random) -> Vec<u8> {
        let mut text = String::from("# scene\nmtllib absent.mtl\no first\n");
        for [x, y, z] in &self.positions {
            text += &format!("v {x} {y} {z}\nvt 0 0\n");
        }
        let back = one_in(random, 2);
        for (i, face) in self.faces.iter().enumerate() {
            if i == 1 {
                text += ["g second\n", "usemtl\n", "o \u{e9}\n", "s off\n"][random.below(4)];
            }
            let corner = |&v: &u32| match back {
                true => format!(" {}", i64::from(v) - self.positions.len() as i64),
                false => format!(" {}/1", v + 1),
            };
            text += &format!("f{} # face\n", face.iter().map(corner).collect::<String>());
        }
        text.into_bytes()
    }

    fn ply(&self, random: &mut Random) -> Vec<u8> {
        let format = ["ascii", "binary_little_endian", "binary_big_endian"][random.below(3)];
        let (vertices, faces) = (self.positions.len(), self.faces.len());
        let mut bytes = format!(
            "ply\nformat {format} 1.0\nelement vertex {vertices}\nproperty float x\nproperty float y\n\
             property float z\nelement face {faces}\nproperty list uchar int vertex_indices\nend_header\n"
        )
        .into_bytes();
        let mut put = |word: [u8; 4]| match format {
            "binary_big_endian" => bytes.extend(word.into_iter().rev()),
            _ => bytes.extend(word),
        };
        if format == "ascii" {
            for [x, y, z] in &self.positions {
                bytes.extend(format!("{x} {y} {z}\n").bytes());
            }
            for face in &self.faces {
                let corners = face.iter().map(|v| format!(" {v}")).collect::<String>();
                bytes.extend(format!("{}{corners}\n", face.len()).bytes());
            }
            return bytes;
        }
        self.positions.iter().flatten().for_each(|x| put(x.to_le_bytes()));
        for face in &self.faces {
            bytes.push(face.len() as u8);
            for v in face {
                let word = v.to_le_bytes();
                match format {
                    "binary_big_endian" => bytes.extend(word.into_iter().rev()),
                    _ => bytes.extend(word),
                }
            }
        }
        bytes
    }

    /// JSON and binary chunk of a glTF.
    fn gltf(&self, random: &mut Random) -> (Value, Vec<u8>) {
        let mut binary: Vec<u8> =
            self.positions.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
        let (points, indices) = (binary.len(), self.triangles());
        binary.extend(indices.iter().flat_map(|i| i.to_le_bytes()));
        let mut json = json!({
            "asset": { "version": "2.0" }, "scene": 0, "scenes": [{ "nodes": [0] }],
            "nodes": [{ "children": [1, 2] }, { "mesh": 0, "name": "mesh" },
                      { "translation": [0.0, 4.0, 5.0], "rotation": [-0.382_683_43, 0.0, 0.0, 0.923_879_5] }],
            "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1 }] }],
            "accessors": [
                { "bufferView": 0, "componentType": 5126, "count": self.positions.len(), "type": "VEC3",
                  "min": [-1, -1, -1], "max": [1, 1, 1] },
                { "bufferView": 1, "componentType": 5125, "count": indices.len(), "type": "SCALAR" }],
            "bufferViews": [{ "buffer": 0, "byteLength": points },
                { "buffer": 0, "byteOffset": points, "byteLength": binary.len() - points }],
            "buffers": [{ "byteLength": binary.len() }],
        });
        if one_in(random, 2) {
            json["cameras"] =
                json!([{ "type": "perspective", "perspective": { "yfov": 0.9, "znear": 0.1 } }]);
            json["nodes"][2]["camera"] = json!(0);
        }
        (json, binary)
    }
}

/// One fault of a glTF's JSON, most of which a reader can live with.
fn spoil_gltf(json: &mut Value, random: &mut Random) {
    let x = f64::from(number(random));
    match random.below(16) {
        0 => json["nodes"][1]["scale"] = json!([x, 1.0, 1.0]),
        1 => json["nodes"][1]["scale"] = json!([x, x, x]),
        2 => json["nodes"][1]["translation"] = json!([0.0, x, 0.0]),
        3 => json["nodes"][1]["rotation"] = json!([0.0, 0.0, 0.0, random.below(3)]),
        4 => json["meshes"][0]["primitives"][0]["mode"] = json!(random.below(8)),
        5 => json["extensionsRequired"] = json!(["KHR_texture_transform"]),
        6 => json["accessors"][1]["count"] = json!(random.below(12)),
        7 => json["bufferViews"][0]["byteStride"] = json!(random.below(20)),
        8 => json["accessors"][0]["componentType"] = json!(5120 + random.below(7)),
        9 => json["accessors"][0]["normalized"] = json!(true),
        10 => {
            json["accessors"][0]["sparse"] = json!({
                "count": 1 + random.below(3), "indices": { "bufferView": 1, "componentType": 5125 },
                "values": { "bufferView": 0 } });
        }
        11 => json["nodes"][2]["rotation"] = json!([x, 0.0, 0.0, 1.0]),
        12 => {
            json["cameras"] =
                json!([{ "type": "perspective", "perspective": { "yfov": x, "znear": 0.1 } }]);
        }
        13 => json["scenes"][0]["nodes"] = json!([random.below(4)]),
        14 => json["meshes"][0]["primitives"][0]["indices"] = Value::Null,
        _ => json["bufferViews"][1]["byteOffset"] = json!(random.below(64)),
    }
}

fn glb(json: &Value, binary: &[u8]) -> Vec<u8> {
    let mut chunk = json.to_string().into_bytes();
    chunk.resize(chunk.len().next_multiple_of(4), b' ');
    let total = (28 + chunk.len() + binary.len()) as u32;
    let words = [2, total, chunk.len() as u32, 0x4e4f_534a].map(u32::to_le_bytes);
    let (length, kind) = ((binary.len() as u32).to_le_bytes(), 0x004e_4942u32.to_le_bytes());
    [b"glTF", words.as_flattened(), &chunk, &length, &kind, binary].concat()
}

/// Settings: small pictures, and few of the keys with a value of any kind.
fn toml(random: &mut Random) -> String {
    let mut text = String::from("canvas = [12, 9]\nmap.size = 24\n");
    let x = number(random);
    let light = [
        "light.direction = [0.3, -1.0, 0.2]\n".to_string(),
        "light.position = [1.0, 6.0, 2.0]\n".to_string(),
        "light.position = [1.0, 6.0, 2.0]\nlight.fovy = 50.0\n".to_string(),
        format!("light.direction = [0.3, -1.0, {x:e}]\n"),
        format!("light.position = [1.0, {x:e}, 0.0]\n"),
        String::new(),
    ];
    text += &light[random.below(light.len())];
    let words = [
        "lookup.filter = \"pcf3x3\"\n".to_string(),
        "lookup.filter = \"bilinear\"\n".to_string(),
        "lookup.filter = \"linear\"\n".to_string(),
        "map.format = \"unorm16\"\n".to_string(),
        "map.format = \"digits-24\"\n".to_string(),
        "map.format = \"f16\"\n".to_string(),
        "map.cull = \"front\"\n".to_string(),
        "lookup.compare = \"D <= z + b\"\n".to_string(),
        "lookup.wrap = \"repeat\"\n".to_string(),
        "device = \"webgl-swiftshader\"\n".to_string(),
        format!("lookup.bias = {x:e}\n"),
        format!("light.near = {x:e}\n"),
        format!("camera.position = [0.0, {x:e}, 5.0]\n"),
        format!("camera.fovy = {x:e}\n"),
        "camera.position = [0.5, 3.0, 5.0]\ncamera.up = [0.3, 2.0, 0.1]\n".to_string(),
    ];
    for _ in 0..random.below(3) {
        let word = &words[random.below(words.len())];
        let key = word.split(' ').next().unwrap_or_default();
        if !text.contains(key) {
            text += &word.replace("inf", "9e37").replace("NaN", "1.0");
        }
    }
    text.replace("inf", "9e37").replace("NaN", "1.0")
}

/// A scene with none, one or two faults.
pub fn scene(random: &mut Random) -> Scene {
    let mut mesh = Mesh::new(random);
    for _ in 0..random.below(3) {
        mesh.spoil(random);
    }
    let (extension, bytes) = match random.below(4) {
        0 => ("obj", mesh.obj(random)),
        1 => ("ply", mesh.ply(random)),
        kind => {
            let (mut json, binary) = mesh.gltf(random);
            if one_in(random, 2) {
                spoil_gltf(&mut json, random);
            }
            if kind == 2 {
                ("glb", glb(&json, &binary))
            } else {
                use base64::Engine as _;
                let base64 = base64::engine::general_purpose::STANDARD.encode(&binary);
                json["buffers"][0]["uri"] = json!(format!("data:x/y;base64,{base64}"));
                ("gltf", json.to_string().into_bytes())
            }
        }
    };
    Scene { extension, bytes, toml: toml(random) }
}
