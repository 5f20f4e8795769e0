//! What a glTF says of a surface and of its pose: sides, masks, normals, skins, morphs, times, instances.

#[path = "support/gltf.rs"]
mod build;

use build::Gltf;
use glam::{DVec3, Vec3};
use gnomon::load::{Blend, Limits, LoadedScene, Wanted};
use gnomon::scene::Sides;
use gnomon::scene_file::parse;
use serde_json::{Value, json};
use std::path::Path;
use std::sync::Arc;

fn load(gltf: &Gltf, wanted: Wanted) -> gnomon::Result<LoadedScene> {
    let limits = Limits { wanted, ..Limits::default() };
    parse(Path::new("a.gltf"), &gltf.bytes(), &limits)
}

fn sound(gltf: &Gltf) -> LoadedScene {
    load(gltf, Wanted::default()).unwrap_or_else(|e| panic!("{e}"))
}

/// Bounds of all parts in the world.
fn bounds(scene: &LoadedScene) -> [DVec3; 2] {
    let world = scene.parts.iter().flat_map(|part| {
        let world = |p: &Vec3| part.model.transform_point3(p.as_dvec3());
        part.mesh.positions.iter().map(world)
    });
    world.fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[low, high], p| [low.min(p), high.max(p)])
}

fn png(alpha: &[u8], width: u32) -> String {
    use base64::Engine as _;
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, alpha.len() as u32 / width);
    encoder.set_color(png::ColorType::GrayscaleAlpha);
    let pixels: Vec<u8> = alpha.iter().flat_map(|&a| [200, a]).collect();
    encoder.write_header().unwrap().write_image_data(&pixels).unwrap();
    let text = base64::engine::general_purpose::STANDARD.encode(bytes);
    format!("data:image/png;base64,{text}")
}

/// A square with texture coordinates under a masked material with this picture.
fn masked(uri: &str) -> Gltf {
    let mut gltf = Gltf::square();
    let uv = gltf.floats("VEC2", &[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]]);
    gltf.primitive()["attributes"]["TEXCOORD_0"] = json!(uv);
    gltf.primitive()["material"] = json!(0);
    gltf.json["images"] = json!([{ "uri": uri, "name": "leaf" }]);
    gltf.json["samplers"] = json!([{ "magFilter": 9728, "wrapS": 33071 }]);
    gltf.json["textures"] = json!([{ "source": 0, "sampler": 0 }]);
    gltf.json["materials"] = json!([{ "alphaMode": "MASK", "alphaCutoff": 0.25, "doubleSided": true,
        "pbrMetallicRoughness": { "baseColorFactor": [1, 1, 1, 0.75], "baseColorTexture": { "index": 0 } } }]);
    gltf
}

#[test]
fn sides_masks_and_samplers_are_the_materials() {
    let scene = sound(&masked(&png(&[0, 64, 128, 255], 2)));
    let surface = &scene.parts[0].surface;
    assert_eq!(surface.sides, Sides::Both);
    let mask = surface.mask.as_ref().expect("a mask");
    assert_eq!((mask.factor, mask.cutoff), (0.75, 0.25));
    let image = mask.image.as_ref().expect("a picture");
    assert_eq!((image.size, &image.alpha[..]), ([2, 2], &[0, 64, 128, 255][..]));
    assert!(!image.linear);
    assert_eq!(image.tiling.map(|t| t.to_string()), ["clamp-to-edge", "repeat"]);
    assert_eq!(scene.parts[0].mesh.uvs.len(), 4);
    assert!(scene.skipped.is_empty(), "{:?}", scene.skipped);
    assert_eq!(sound(&Gltf::square()).parts[0].surface.sides, Sides::Front);
    // Alpha that is 1 throughout cuts nothing out, however the picture is kept.
    for uri in [png(&[255; 4], 2), "data:image/jpeg;base64,/9j/4AAQ".to_string()] {
        let scene = sound(&masked(&uri));
        assert_eq!(scene.parts[0].surface.mask, None);
        assert!(scene.skipped.is_empty(), "{:?}", scene.skipped);
    }
}

#[test]
fn a_texture_transform_moves_the_mask_and_names_its_own_coordinates() {
    let mut gltf = masked(&png(&[0, 64, 128, 255], 2));
    let other = gltf.floats("VEC2", &[[0.5, 0.5]; 4]);
    gltf.primitive()["attributes"]["TEXCOORD_1"] = json!(other);
    gltf.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["extensions"] = json!({ "KHR_texture_transform": { "offset": [0.25, 0.5], "scale": [2, 4],
            "rotation": std::f64::consts::FRAC_PI_2, "texCoord": 1 } });
    let scene = sound(&gltf);
    assert_eq!(scene.parts[0].mesh.uvs[3].to_array(), [0.5, 0.5]);
    let mask = scene.parts[0].surface.mask.clone().expect("a mask");
    // A quarter turn takes (u, v) to (v, -u), after the scale.
    for (uv, expected) in
        [([0.0, 0.0], [0.25, 0.5]), ([1.0, 0.0], [0.25, -1.5]), ([0.0, 1.0], [4.25, 0.5])]
    {
        let moved = mask.moved(glam::DVec2::from_array(uv)).to_array();
        assert!(moved.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-6), "{moved:?}");
    }
}

#[test]
fn what_cannot_be_decoded_is_opaque_and_named_once() {
    let mut gltf = masked("data:image/ktx2;base64,q0tUWCAyMLsNChoK");
    gltf.json["nodes"] = json!([{ "mesh": 0, "name": "fern" }, { "mesh": 0, "name": "oak" }]);
    gltf.json["scenes"][0]["nodes"] = json!([0, 1]);
    let scene = sound(&gltf);
    assert!(scene.parts.iter().all(|part| part.surface.mask.is_none()));
    let [told] = &scene.skipped[..] else { panic!("{:?}", scene.skipped) };
    for word in ["2 parts", "fern, oak", "'leaf'", "KTX2", "opaque"] {
        assert!(told.contains(word), "{told}");
    }
    let scene = sound(&masked("nowhere.png"));
    assert!(scene.skipped[0].contains("not beside the scene"), "{:?}", scene.skipped);
}

#[test]
fn blended_surfaces_are_as_wanted_and_said_once() {
    let mut gltf = masked(&png(&[0, 64, 128, 255], 2));
    gltf.json["materials"][0]["alphaMode"] = json!("BLEND");
    gltf.json["materials"][0].as_object_mut().unwrap().remove("alphaCutoff");
    for blend in Blend::ALL.iter().copied() {
        let scene = load(&gltf, Wanted { blend, ..Wanted::default() }).unwrap();
        let surface = &scene.parts[0].surface;
        let cutoff = surface.mask.as_ref().map(|mask| mask.cutoff);
        assert_eq!(surface.casts, blend != Blend::None);
        assert_eq!(cutoff, (blend == Blend::Cutout).then_some(0.5));
        assert_eq!(scene.skipped.len(), 1, "{:?}", scene.skipped);
        assert!(scene.skipped[0].starts_with("1 part") && scene.skipped[0].contains("--blend"));
    }
}

#[test]
fn the_alpha_of_vertex_colours_multiplies_the_mask() {
    for (last, factor) in [(0.5f32, 0.375), (0.25, 0.75)] {
        let mut gltf = masked(&png(&[0, 64, 128, 255], 2));
        let colours = [
            [1.0, 1.0, 1.0, 0.5],
            [1.0, 1.0, 1.0, 0.5],
            [0.0, 0.0, 0.0, 0.5],
            [1.0, 0.0, 0.0, last],
        ];
        let colours = gltf.floats("VEC4", &colours);
        gltf.primitive()["attributes"]["COLOR_0"] = json!(colours);
        let scene = sound(&gltf);
        assert_eq!(scene.parts[0].surface.mask.as_ref().unwrap().factor, factor);
        assert_eq!(scene.skipped.len(), usize::from(last != 0.5), "{:?}", scene.skipped);
    }
}

#[test]
fn normals_are_the_files_or_there_are_none() {
    let mesh = |gltf: &Gltf| Arc::clone(&sound(gltf).parts[0].mesh);
    assert!(mesh(&Gltf::square()).normals.is_empty() && !mesh(&Gltf::square()).smooth);
    let mut gltf = Gltf::square();
    let normals =
        gltf.floats("VEC3", &[[0.0, 1.0, 0.0], [0.6, 0.8, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
    gltf.primitive()["attributes"]["NORMAL"] = json!(normals);
    assert_eq!(mesh(&gltf).normals[1], Vec3::new(0.6, 0.8, 0.0));
    assert!(mesh(&gltf).smooth);
    let mut gltf = Gltf::square();
    let bytes: Vec<u8> =
        [[0u8, 127, 0, 0], [129, 0, 0, 0], [0, 0, 127, 0], [128, 0, 0, 0]].concat();
    let normals = gltf.accessor(&bytes, 4, "VEC3", 5120, json!({ "normalized": true }), Some(4));
    gltf.primitive()["attributes"]["NORMAL"] = json!(normals);
    let expected = [Vec3::Y, Vec3::NEG_X, Vec3::Z, Vec3::NEG_X];
    assert_eq!(mesh(&gltf).normals, expected, "−128 is −1 too");
}

/// A square that one joint at height 6 carries; the skinned node's own transform is of no effect.
fn skinned() -> Gltf {
    let mut gltf = Gltf::square();
    let joints = gltf.accessor(&[0; 16], 4, "VEC4", 5121, json!({}), None);
    let weights = gltf.floats("VEC4", &[[0.5, 0.0, 0.0, 0.0]; 4]);
    gltf.primitive()["attributes"]["JOINTS_0"] = json!(joints);
    gltf.primitive()["attributes"]["WEIGHTS_0"] = json!(weights);
    gltf.json["nodes"] = json!([
        { "mesh": 0, "skin": 0, "translation": [0, 100, 0], "scale": [0, 0, 0] },
        { "translation": [0, 2, 0], "children": [2] },
        { "translation": [0, 4, 0] }
    ]);
    gltf.json["scenes"][0]["nodes"] = json!([0, 1]);
    gltf.json["skins"] = json!([{ "joints": [2] }]);
    gltf
}

#[test]
fn a_skin_moves_vertices_by_its_joints_alone() {
    let scene = sound(&skinned());
    assert_eq!(bounds(&scene).map(|b| b.y), [7.0, 7.0], "weights need not add up to one");
    let mut bound = skinned();
    let mut inverse = glam::Mat4::from_translation(Vec3::new(0.0, -1.0, 0.0)).to_cols_array();
    inverse[0] = 2.0;
    let matrices = bound.floats("MAT4", &[inverse]);
    bound.json["skins"][0]["inverseBindMatrices"] = json!(matrices);
    let scene = sound(&bound);
    assert_eq!(bounds(&scene), [DVec3::new(0.0, 6.0, 0.0), DVec3::new(2.0, 6.0, 1.0)]);
    let mut beyond = skinned();
    let joints = beyond.accessor(&[7; 16], 4, "VEC4", 5121, json!({}), None);
    beyond.primitive()["attributes"]["JOINTS_0"] = json!(joints);
    let error = load(&beyond, Wanted::default()).expect_err("joint 7").to_string();
    assert!(error.contains("joint 7 of 1"), "{error}");
}

#[test]
fn morph_targets_are_added_by_the_nodes_or_the_meshes_weights() {
    let mut gltf = Gltf::square();
    let up = gltf.floats("VEC3", &[[0.0, 2.0, 0.0]; 4]);
    let aside = gltf.floats("VEC3", &[[10.0, 0.0, 0.0]; 4]);
    gltf.primitive()["targets"] = json!([{ "POSITION": up }, { "POSITION": aside }]);
    assert_eq!(bounds(&sound(&gltf))[1], DVec3::new(1.0, 1.0, 1.0), "no weights");
    gltf.json["meshes"][0]["weights"] = json!([0.5, 0.0]);
    assert_eq!(bounds(&sound(&gltf))[1], DVec3::new(1.0, 2.0, 1.0));
    gltf.json["nodes"][0]["weights"] = json!([0.0, 1.0]);
    assert_eq!(bounds(&sound(&gltf))[1], DVec3::new(11.0, 1.0, 1.0));
}

/// The place of a square at a time under an animation of one property.
fn played(path: &str, interpolation: &str, kind: &str, values: &[Vec<f32>], time: f64) -> DVec3 {
    let mut gltf = Gltf::square();
    let times = gltf.floats("SCALAR", &[[1.0f32], [3.0]]);
    let output = gltf.rows(kind, values);
    gltf.json["nodes"] = json!([{ "children": [1] }, { "mesh": 0, "translation": [0, 0, 0] }]);
    gltf.json["animations"] = json!([{ "name": "walk",
        "samplers": [{ "input": times, "output": output, "interpolation": interpolation }],
        "channels": [{ "sampler": 0, "target": { "node": 0, "path": path } }] }]);
    let wanted = Wanted { time: Some(time), ..Wanted::default() };
    let scene = load(&gltf, wanted).unwrap_or_else(|e| panic!("{e}"));
    assert!(scene.skipped.is_empty(), "{:?}", scene.skipped);
    scene.parts[0].model.transform_point3(DVec3::X)
}

#[test]
fn a_time_poses_nodes_by_every_interpolation() {
    let near = |a: DVec3, b: [f64; 3]| {
        assert!((a - DVec3::from_array(b)).abs().max_element() < 1e-7, "{a} is not {b:?}");
    };
    let moves = [vec![0.0, 0.0, 0.0], vec![8.0, 0.0, 0.0]];
    for (interpolation, time, x) in [
        ("STEP", 0.0, 0.0),
        ("STEP", 2.9, 0.0),
        ("STEP", 3.0, 8.0),
        ("STEP", 99.0, 8.0),
        ("LINEAR", -5.0, 0.0),
        ("LINEAR", 1.5, 2.0),
        ("LINEAR", 3.0, 8.0),
        ("LINEAR", 9.0, 8.0),
    ] {
        near(played("translation", interpolation, "VEC3", &moves, time), [1.0 + x, 0.0, 0.0]);
    }
    // Tangents in, value, tangents out; a cubic with slope 4 at both ends is the line.
    let line: Vec<Vec<f32>> =
        [9.0, 0.0, 4.0, 4.0, 8.0, 9.0].iter().map(|x| vec![*x, 0.0, 0.0]).collect();
    near(played("translation", "CUBICSPLINE", "VEC3", &line, 1.5), [3.0, 0.0, 0.0]);
    let flat: Vec<Vec<f32>> =
        [0.0, 0.0, 0.0, 0.0, 8.0, 0.0].iter().map(|x| vec![*x, 0.0, 0.0]).collect();
    near(played("translation", "CUBICSPLINE", "VEC3", &flat, 1.5), [1.0 + 8.0 * 0.15625, 0.0, 0.0]);
    // A quarter turn about y the short way, though the second quaternion is written negated.
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let turn = [vec![0.0, 0.0, 0.0, 1.0], vec![0.0, -half, 0.0, -half]];
    let eighth = std::f64::consts::FRAC_PI_4 / 2.0;
    near(played("rotation", "LINEAR", "VEC4", &turn, 1.5), [eighth.cos(), 0.0, -eighth.sin()]);
    near(played("scale", "LINEAR", "VEC3", &[vec![1.0; 3], vec![3.0; 3]], 2.0), [2.0, 0.0, 0.0]);
}

#[test]
fn animations_are_chosen_by_name_or_told() {
    let mut gltf = Gltf::square();
    let times = gltf.floats("SCALAR", &[[0.0f32]]);
    let (low, high) =
        (gltf.floats("VEC3", &[[0.0, 5.0, 0.0]]), gltf.floats("VEC3", &[[0.0, 9.0, 0.0]]));
    let animation = |name: &str, output: usize| {
        json!({ "name": name,
        "samplers": [{ "input": times, "output": output }],
        "channels": [{ "sampler": 0, "target": { "node": 0, "path": "translation" } }] })
    };
    gltf.json["animations"] = json!([animation("low", low), animation("high", high)]);
    let at = |time, name: Option<&str>| {
        let wanted = Wanted { time, animation: name.map(str::to_string), ..Wanted::default() };
        load(&gltf, wanted).map(|scene| bounds(&scene)[1].y)
    };
    assert_eq!(at(None, None).unwrap(), 1.0);
    assert_eq!(at(Some(0.0), None).unwrap(), 6.0);
    assert_eq!(at(Some(0.0), Some("high")).unwrap(), 10.0);
    assert_eq!(at(Some(0.0), Some("1")).unwrap(), 10.0);
    assert!(at(Some(0.0), Some("run")).expect_err("no such").to_string().contains("none of 2"));
    assert!(sound(&gltf).skipped[0].contains("2 animations"), "{:?}", sound(&gltf).skipped);
    let pointer = json!({ "sampler": 0, "target": { "path": "pointer", "extensions":
        { "KHR_animation_pointer": { "pointer": "/materials/0/alphaCutoff" } } } });
    let mut pointed = gltf.clone();
    pointed.json["animations"][0]["channels"].as_array_mut().unwrap().push(pointer);
    let scene = load(&pointed, Wanted { time: Some(0.0), ..Wanted::default() }).unwrap();
    assert_eq!(bounds(&scene)[1].y, 6.0);
    assert!(
        scene.skipped[0].contains("1 animation channel of other things"),
        "{:?}",
        scene.skipped
    );
    let still = load(&Gltf::square(), Wanted { time: Some(1.0), ..Wanted::default() });
    assert!(still.expect_err("nothing to play").to_string().contains("there is none"));
}

#[test]
fn instances_and_nodes_share_one_mesh() {
    let mut gltf = Gltf::square();
    let places: Vec<[f32; 3]> = (0..9).map(|i| [i as f32, 0.0, 0.0]).collect();
    let places = gltf.floats("VEC3", &places);
    let turns = gltf.accessor(
        &[0u16, 0, 0, 32767].map(u16::to_le_bytes).concat().repeat(9),
        9,
        "VEC4",
        5122,
        json!({ "normalized": true }),
        None,
    );
    gltf.json["nodes"] = json!([{ "mesh": 0, "scale": [2, 2, 2], "extensions": { "EXT_mesh_gpu_instancing":
        { "attributes": { "TRANSLATION": places, "ROTATION": turns } } } }, { "mesh": 0 }]);
    gltf.json["scenes"][0]["nodes"] = json!([0, 1]);
    gltf.json["extensionsRequired"] = json!(["EXT_mesh_gpu_instancing"]);
    gltf.json["extensionsUsed"] = json!(["EXT_mesh_gpu_instancing"]);
    let scene = sound(&gltf);
    assert_eq!(scene.parts.len(), 10);
    assert!(scene.parts.iter().all(|part| Arc::ptr_eq(&part.mesh, &scene.parts[0].mesh)));
    assert_eq!(bounds(&scene)[1].x, 2.0 * 9.0);
    assert_eq!(scene.parts[8].model.w_axis.x, 16.0);
}

#[test]
fn scenes_are_chosen_and_hidden_nodes_left_out() {
    let mut gltf = Gltf::square();
    gltf.json["nodes"] = json!([{ "mesh": 0 }, { "mesh": 0, "translation": [0, 7, 0] },
        { "mesh": 0, "translation": [0, 9, 0], "extensions": { "KHR_node_visibility": { "visible": false } } }]);
    gltf.json["scenes"] = json!([{ "nodes": [0] }, { "nodes": [1, 2], "name": "upstairs" }]);
    let top = |scene: Option<&str>| {
        let wanted = Wanted { scene: scene.map(str::to_string), ..Wanted::default() };
        load(&gltf, wanted).map(|scene| bounds(&scene)[1].y)
    };
    assert_eq!(top(None).unwrap(), 1.0);
    assert_eq!(top(Some("upstairs")).unwrap(), 8.0);
    assert_eq!(top(Some("1")).unwrap(), 8.0);
    assert!(top(Some("cellar")).expect_err("none").to_string().contains("none of 2 is 'cellar'"));
}

#[test]
fn primitives_of_one_large_accessor_keep_their_own_vertices() {
    let mut gltf = Gltf::square();
    let first = gltf.accessor(&[0u8, 1, 2], 3, "SCALAR", 5121, json!({}), None);
    let last = gltf.accessor(&[3u8, 2, 1], 3, "SCALAR", 5121, json!({}), None);
    let primitive = |indices: usize| json!({ "attributes": { "POSITION": 0 }, "indices": indices });
    gltf.json["meshes"][0]["primitives"] = json!([primitive(first), primitive(last)]);
    let scene = sound(&gltf);
    let mesh =
        |i: usize| (scene.parts[i].mesh.positions.len(), scene.parts[i].mesh.triangles.clone());
    assert_eq!(mesh(0), (3, vec![[0, 1, 2]]));
    assert_eq!(mesh(1), (3, vec![[2, 1, 0]]));
}

#[test]
fn a_node_stands_where_its_digits_say() {
    let mut gltf = Gltf::square();
    let far = [431_234.567_89, 0.1, 5_412_345.678_9];
    gltf.json["nodes"][0]["translation"] = json!(far);
    let Value::Array(_) = gltf.json["nodes"][0]["translation"] else { panic!("three numbers") };
    assert_eq!(sound(&gltf).parts[0].model.w_axis.truncate().to_array(), far);
}

#[test]
fn a_summary_counts_instances_once_and_tells_the_rest() {
    let mut gltf = skinned();
    gltf.json["nodes"].as_array_mut().unwrap().extend([
        json!({ "mesh": 1 }),
        json!({ "mesh": 1,
        "translation": [4, 0, 0] }),
    ]);
    gltf.json["meshes"].as_array_mut().unwrap().push(json!({ "primitives":
        [{ "attributes": { "POSITION": 0 }, "mode": 5 }] }));
    gltf.json["scenes"][0]["nodes"] = json!([0, 1, 3, 4]);
    let summary = sound(&gltf).summary();
    assert_eq!((summary.objects, summary.meshes), (3, 2));
    assert_eq!((summary.triangles, summary.distinct_triangles, summary.vertices), (6, 4, 8));
    assert_eq!(summary.bounds, [[0.0, 1.0, 0.0], [5.0, 7.0, 1.0]]);
    assert_eq!((summary.file.skinned, summary.sides, summary.masked), (1, [3, 0, 0], 0));
    let line = summary.line("a.gltf");
    assert_eq!(line, "a.gltf: 3 objects, 6 triangles, 5 x 6 x 1 metres, 0 lights and 0 cameras");
    let lines = summary.lines().join("\n");
    for word in ["3 objects of 2 meshes", "(0, 1, 0) to (5, 7, 1)", "1 skinned", "3 front"] {
        assert!(lines.contains(word), "{lines}");
    }
    assert!(serde_json::to_string(&summary).unwrap().contains("\"triangles\":6"));
}
