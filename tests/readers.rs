//! Readers of OBJ, PLY and STL: normals, doubles, materials with transparency, text and binary.

use glam::{DVec3, Vec3};
use gnomon::load::{self, Limits, LoadedScene};
use gnomon::scene::{Mesh, Sides};
use std::path::Path;

/// Reads a file; `beside` is all that lies beside it.
fn try_read(name: &str, bytes: &[u8], beside: &[(&str, &str)]) -> gnomon::Result<LoadedScene> {
    let find = |path: &Path, _: u64| {
        let found = beside.iter().find(|(name, _)| Path::new(name) == path);
        let missing = || gnomon::Error::bad_input(path.display().to_string(), "is not there", "");
        found.map(|(_, text)| text.as_bytes().to_vec()).ok_or_else(missing)
    };
    load::read(Path::new(name), bytes, &Limits::default(), &find)
}

fn mesh(name: &str, bytes: &[u8]) -> Mesh {
    let scene = try_read(name, bytes, &[]).unwrap_or_else(|e| panic!("{e}"));
    Mesh::clone(&scene.parts[0].mesh)
}

#[test]
fn an_obj_has_a_vertex_for_each_position_and_normal() {
    let head = "v 0 0 0\nv 1 0 0\nv 0 0 -1\nv 1 0 -1\nvn 0 1 0\nvn 0 0 1\nvt 0 0\n";
    let both = mesh("a.obj", format!("{head}f 1//1 2//1 3//1\nf 3/1/-1 2/1/2 4//2\n").as_bytes());
    assert_eq!((both.positions.len(), both.smooth), (6, true), "the edge has two normals");
    assert_eq!(both.normals, [Vec3::Y, Vec3::Y, Vec3::Y, Vec3::Z, Vec3::Z, Vec3::Z]);
    assert_eq!(both.triangles, [[0, 1, 2], [3, 4, 5]]);
    let one = mesh("a.obj", format!("{head}f 1//1 2//1 3//1\nf 3//1 2//1 4//1\n").as_bytes());
    assert_eq!((one.positions.len(), one.normals.len()), (4, 4));
    let none = mesh("a.obj", format!("{head}s 1\nf 1 2 3\n").as_bytes());
    assert!(none.normals.is_empty() && !none.smooth, "flat, whatever the smoothing group says");
    for face in ["f 1//1 2//1 3", "f 1 2//1 3//1", "f 1//9 2//9 3//9"] {
        let some = try_read("a.obj", format!("{head}{face}\n").as_bytes(), &[]).unwrap();
        assert!(some.parts[0].mesh.normals.is_empty(), "{face}");
        assert!(some.notes[0].contains("some corners only"), "{face}: {:?}", some.notes);
    }
}

#[test]
fn a_concave_face_keeps_the_normals_of_its_corners() {
    let text = "v -1 1 1\nv 0 1 -0.5\nv 1 1 1\nv 1 1 -1\nv -1 1 -1\nvn 0 1 0\nvn 1 0 0\nvn 0 0 1\n\
        f 1//1 2//2 3//1 4//3 5//1\n";
    let mesh = mesh("a.obj", text.as_bytes());
    assert_eq!((mesh.triangles.len(), mesh.positions.len()), (3, 5));
    let normal = |p: [f32; 3]| {
        let at = mesh.positions.iter().position(|q| q.to_array() == p).expect("a corner");
        mesh.normals[at]
    };
    assert_eq!(normal([0.0, 1.0, -0.5]), Vec3::X);
    assert_eq!(normal([1.0, 1.0, -1.0]), Vec3::Z);
}

#[test]
fn a_transparent_material_is_told_where_it_is_used() {
    let obj = |used: &str| {
        let text = format!("mtllib a b.mtl\nv 0 0 0\nv 1 0 0\nv 0 0 -1\nusemtl {used}\nf 1 2 3\n");
        let mtl = "newmtl leaf\nmap_d leaf.png\nnewmtl stone\nd 1.0\n";
        try_read("a.obj", text.as_bytes(), &[("a b.mtl", mtl)]).unwrap().skipped
    };
    assert!(obj("leaf")[0].contains("'leaf'"), "{:?}", obj("leaf"));
    assert!(obj("stone").is_empty());
}

#[test]
fn positions_of_doubles_are_kept_beside_their_rounding() {
    let text = "v 431234.56789 0.5 5412345.6789\nv 1 0 0\nv 0 0 -1\nf 1 2 3\n";
    let far = DVec3::new(431_234.567_89, 0.5, 5_412_345.678_9);
    let obj = mesh("a.obj", text.as_bytes());
    assert_eq!((obj.positions[0], obj.exact[0]), (far.as_vec3(), far));
    assert!(mesh("a.obj", b"v 0.5 0 0\nv 1 0 0\nv 0 0 -1\nf 1 2 3\n").exact.is_empty());
    let ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\n\
        property double z\nproperty float nx\nproperty float ny\nproperty float nz\nelement face 1\n\
        property list uchar int vertex_index\nend_header\n431234.56789 0.5 5412345.6789 0 1 0\n\
        1 0 0 0 0 1\n0 0 -1 1 0 0\n3 0 1 2\n";
    let mesh = mesh("a.ply", ply.as_bytes());
    assert_eq!((mesh.positions[0], mesh.exact[0]), (far.as_vec3(), far));
    assert_eq!((mesh.normals, mesh.smooth), (vec![Vec3::Y, Vec3::Z, Vec3::X], true));
}

/// A binary STL of these triangles.
fn stl(triangles: &[[[f32; 3]; 3]]) -> Vec<u8> {
    let mut bytes = b"solid but binary".to_vec();
    bytes.resize(80, b' ');
    bytes.extend((triangles.len() as u32).to_le_bytes());
    for triangle in triangles {
        bytes.extend([0; 12]);
        triangle.iter().flatten().for_each(|x| bytes.extend(x.to_le_bytes()));
        bytes.extend([0; 2]);
    }
    bytes
}

#[test]
fn stl_is_read_as_text_and_binary() {
    let corners = [[[0.0, 1.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, -1.0]], [[2.0, 0.0, 0.0]; 3]];
    let facet = |t: &[[f32; 3]; 3]| {
        let corner = |[x, y, z]: &[f32; 3]| format!("vertex {x} {y:e} {z}\r\n");
        let corners: String = t.iter().map(corner).collect();
        format!("  facet normal 9 9 9\n outer loop\n{corners} endloop\n endfacet\n")
    };
    let facets: String = corners.iter().map(facet).collect();
    let text = format!("solid one two\n{facets}endsolid one\nsolid\n{facets}endsolid\n");
    let scene = try_read("a.stl", text.as_bytes(), &[]).unwrap();
    assert_eq!(scene.parts.iter().map(|p| &p.name[..]).collect::<Vec<_>>(), ["one#0", "solid#1"]);
    let (binary, text) = (mesh("a.stl", &stl(&corners)), mesh("a.stl", text.as_bytes()));
    assert_eq!(binary, text);
    assert_eq!(binary.positions[2], Vec3::new(0.0, 1.0, -1.0));
    assert!(binary.normals.is_empty() && scene.parts[0].surface.sides == Sides::Both);
    assert_eq!(mesh("no-name", &stl(&corners)), binary, "known by its content");
    for (bytes, word) in [
        (stl(&corners)[..100].to_vec(), "says 2 triangles and holds 0"),
        (b"solid x\nfacet\nvertex 0 0\n".to_vec(), "line 3"),
        (b"solid x\nvertex 0 0 0\nendloop\n".to_vec(), "line 3"),
        (b"short".to_vec(), "neither"),
        (stl(&[[[f32::NAN; 3]; 3]]), "vertex 0"),
        (stl(&[]), "no triangle"),
    ] {
        let error = try_read("a.stl", &bytes, &[]).expect_err(word).to_string();
        assert!(error.contains(word) && error.contains("a.stl"), "{error}");
    }
}

#[test]
fn time_grows_with_the_file_not_with_its_square() {
    let text = |parts: usize| -> String {
        let part = |i: usize| {
            let (a, b) = (3 * i + 1, 3 * i + 3);
            format!(
                "o p{i}\nv {i} 0 0\nv {i} 1 0\nv {i} 0 1\nvn 1 0 0\nf {a}//1 {}//1 {b}//1\n",
                a + 1
            )
        };
        (0..parts).map(part).collect()
    };
    let time = |parts: usize| {
        let text = text(parts);
        let start = std::time::Instant::now();
        assert_eq!(try_read("a.obj", text.as_bytes(), &[]).unwrap().parts.len(), parts);
        start.elapsed().as_secs_f64()
    };
    time(1000);
    let (few, many) = (time(3_000), time(48_000));
    assert!(many < 16.0 * 6.0 * few.max(1e-3), "{few} s for 3,000 parts, {many} s for 48,000");
}
