//! What a file is, by its content before its name; what is not read is named, with how to convert it.

use gnomon_core::{Error, Result};
use std::path::Path;

/// A format that is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Format {
    Gltf,
    Obj,
    Ply,
    Stl,
    Three,
}

impl Format {
    /// What people call it.
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Gltf => "glTF",
            Self::Obj => "OBJ",
            Self::Ply => "PLY",
            Self::Stl => "STL",
            Self::Three => "three.js JSON",
        }
    }
}

/// Blender's own way out, which reads most of what is not read here.
const BLENDER: &str = "import it in Blender and export glTF (File > Export > glTF 2.0)";

/// Begin of a file, what it is, and how it is converted.
const FOREIGN: [(&[u8], &str, &str); 18] = [
    (
        b"Kaydara FBX Binary",
        "is an FBX file",
        "convert it with `FBX2glTF`, or import it in Blender and export glTF",
    ),
    (
        b"; FBX",
        "is an FBX file in ASCII",
        "save it as binary FBX, then convert it with `FBX2glTF`, or with Autodesk's FBX converter",
    ),
    (
        b"BLENDER",
        "is a Blender file",
        "open it in Blender and export glTF (File > Export > glTF 2.0)",
    ),
    (
        b"PXR-USDC",
        "is a USD file",
        "convert it with `usd2gltf`, or import it in Blender and export glTF",
    ),
    (
        b"#usda",
        "is a USD file",
        "convert it with `usd2gltf`, or import it in Blender and export glTF",
    ),
    (
        b"version https://git-lfs",
        "is a Git LFS pointer, not the file itself",
        "fetch the file with `git lfs pull`",
    ),
    (b"\x1f\x8b", "is compressed by gzip", "unpack it with `gunzip`"),
    (
        b"\x28\xb5\x2f\xfd",
        "is compressed by zstd, as new Blender files are",
        "unpack it with `unzstd`; a .blend is exported as glTF by Blender",
    ),
    (b"7z\xbc\xaf\x27\x1c", "is a 7z archive", "unpack it"),
    (b"Rar!", "is a RAR archive", "unpack it"),
    (b"\xff\xfe", "is UTF-16 text", "save it as UTF-8"),
    (b"\xfe\xff", "is UTF-16 text", "save it as UTF-8"),
    (b"DRACO", "is a bare Draco mesh", "decode it with `draco_decoder -i FILE -o mesh.obj`"),
    (b"ISO-10303-21", "is a STEP file of a CAD program", "export STL or glTF from the CAD program"),
    (b"#VRML", "is a VRML file", BLENDER),
    (b"\x89PNG", "is a PNG picture", "give the scene's file"),
    (b"\xff\xd8\xff", "is a JPEG picture", "give the scene's file"),
    (b"%PDF", "is a PDF document", "give the scene's file"),
];

/// Text near the begin of a file of markup, what it is, and how it is converted.
const MARKUP: [(&str, &str, &str); 4] = [
    (
        "<collada",
        "is a COLLADA file",
        "convert it with `COLLADA2GLTF`, or import it in Blender and export glTF",
    ),
    ("<x3d", "is an X3D file", BLENDER),
    ("<html", "is an HTML page, not a scene: a download went wrong", "download the raw file"),
    (
        "<!doctype html",
        "is an HTML page, not a scene: a download went wrong",
        "download the raw file",
    ),
];

const FIRST: &str = "is glTF 1.0";
const NEWER: &str = "convert it with `gltf-pipeline -i FILE -o scene.glb`";

/// The complaint about a JSON that is glTF 1.0.
pub(super) fn first_gltf(place: &str) -> Error {
    Error::bad_input(place, FIRST, NEWER)
}

/// What the bytes are not read as.
fn foreign(bytes: &[u8], extension: &str) -> Option<(&'static str, &'static str)> {
    let begin = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    if let Some((_, what, fix)) = FOREIGN.iter().find(|(magic, ..)| begin.starts_with(magic)) {
        return Some((what, fix));
    }
    let head = begin.get(..begin.len().min(2048)).unwrap_or_default().trim_ascii_start();
    let text = String::from_utf8_lossy(head).to_ascii_lowercase();
    if head.starts_with(b"PK\x03\x04") {
        let usd = extension == "usdz" || text.contains(".usd");
        return Some(match usd {
            true => (
                "is a USDZ package",
                "convert it with `usd2gltf`, or import it in Blender and export glTF",
            ),
            false => ("is a ZIP archive", "unpack it and give the scene inside"),
        });
    }
    if head.starts_with(b"<") {
        let known = MARKUP.iter().find(|(tag, ..)| text.contains(tag));
        return Some(
            known.map_or(("is XML of no known scene format", BLENDER), |(_, w, f)| (w, f)),
        );
    }
    match begin.first_chunk::<12>() {
        Some([b'g', b'l', b'T', b'F', 1, 0, 0, 0, ..]) => Some((FIRST, NEWER)),
        Some([0x4d, 0x4d, a, b, c, d, ..])
            if u32::from_le_bytes([*a, *b, *c, *d]) as usize == bytes.len() =>
        {
            Some(("is a 3DS file", BLENDER))
        }
        // Text of which every second byte is zero, without its mark.
        Some([a, 0, b, 0, c, 0, d, 0, ..]) | Some([0, a, 0, b, 0, c, 0, d, ..])
            if [a, b, c, d].iter().all(|b| b.is_ascii_graphic() || b.is_ascii_whitespace()) =>
        {
            Some(("is UTF-16 text", "save it as UTF-8"))
        }
        _ => None,
    }
}

/// Whether a JSON is what three.js' `toJSON` writes, whose `metadata` come first, and no glTF.
fn is_three(begin: &[u8], extension: &str) -> bool {
    let head = String::from_utf8_lossy(begin.get(..begin.len().min(2048)).unwrap_or_default());
    let names = |key: &str| head.contains(key);
    names("\"metadata\"") && !names("\"asset\"") || extension == "json" && !names("\"asset\"")
}

/// The format of a file.
///
/// # Errors
/// [`Error::BadInput`] that says what it is where it is not read, and how to convert it.
pub(super) fn of(path: &Path, bytes: &[u8]) -> Result<Format> {
    let place = path.display().to_string();
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or("").to_ascii_lowercase();
    if let Some((what, fix)) = foreign(bytes, &extension) {
        return Err(Error::bad_input(place, what, fix));
    }
    let begin = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start();
    match begin {
        [b'{', ..] if is_three(begin, &extension) => return Ok(Format::Three),
        [b'g', b'l', b'T', b'F', ..] | [b'{', ..] => return Ok(Format::Gltf),
        [b'p', b'l', b'y', b'\n' | b'\r', ..] => return Ok(Format::Ply),
        _ => {}
    }
    match extension.as_str() {
        "gltf" | "glb" => Ok(Format::Gltf),
        "obj" => Ok(Format::Obj),
        "ply" => Ok(Format::Ply),
        "stl" => Ok(Format::Stl),
        "json" => Ok(Format::Three),
        _ if super::stl_file::is_stl(bytes) => Ok(Format::Stl),
        _ => Err(Error::bad_input(
            place,
            format!("'.{extension}' is no scene format known here"),
            "give a .gltf, .glb, .obj, .ply or .stl file, or three.js' scene.toJSON() as .json",
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn content_stands_above_the_name() {
        let read = |name: &str, bytes: &[u8]| of(Path::new(name), bytes);
        assert_eq!(read("a.obj", b"ply\nformat").ok(), Some(Format::Ply));
        assert_eq!(read("a.txt", b" {\"asset\":{}}").ok(), Some(Format::Gltf));
        assert_eq!(read("a.obj", b"glTF\x02\0\0\0\0\0\0\0").ok(), Some(Format::Gltf));
        let three = br#"{"metadata":{"version":4.7,"type":"Object"},"object":{}}"#;
        assert_eq!(read("a.txt", three).ok(), Some(Format::Three));
        assert_eq!(read("a.json", b"{}").ok(), Some(Format::Three));
        assert_eq!(read("a.OBJ", b"v 0 0 0").ok(), Some(Format::Obj));
        assert_eq!(read("a", b"solid x\n facet normal 0 0 1\n").ok(), Some(Format::Stl));
        let mut three_ds = b"MM\x10\0\0\0".to_vec();
        three_ds.resize(16, 7);
        let mut zip = b"PK\x03\x04".to_vec();
        zip.extend(b"............scene.usdc");
        for (name, bytes, what, fix) in [
            ("a.fbx", &b"Kaydara FBX Binary  \0"[..], "FBX", "FBX2glTF"),
            ("a.glb", b"; FBX 7.3.0 project file\n", "ASCII", "FBX2glTF"),
            ("a.blend", b"BLENDER-v293", "Blender", "export glTF"),
            ("a.usd", b"#usda 1.0\n", "USD", "usd2gltf"),
            ("a.usdc", b"PXR-USDC\0", "USD", "usd2gltf"),
            ("a.bin", &zip, "USDZ", "usd2gltf"),
            ("a.zip", b"PK\x03\x04........x.glb", "ZIP", "unpack"),
            ("a.gltf", b"<!DOCTYPE html>\n<html>", "HTML", "raw file"),
            ("a.glb", b"\n <html lang=en>", "HTML", "raw file"),
            ("a.glb", b"version https://git-lfs.github.com/spec/v1\n", "LFS", "git lfs pull"),
            ("a.dae", b"<?xml version=\"1.0\"?><COLLADA xmlns=", "COLLADA", "COLLADA2GLTF"),
            ("a.xml", b"<?xml version=\"1.0\"?><svg>", "XML", "Blender"),
            ("a.3ds", &three_ds, "3DS", "Blender"),
            ("a.obj", b"v\0 \x000\0 \x000\0 \x000\0", "UTF-16", "UTF-8"),
            ("a.gltf", b"\xff\xfe{\0", "UTF-16", "UTF-8"),
            ("a.obj.gz", b"\x1f\x8b\x08\0", "gzip", "gunzip"),
            ("a.glb", b"glTF\x01\0\0\0\0\0\0\0", "glTF 1.0", "gltf-pipeline"),
            ("a.max", b"whatever", "'.max'", ".glb"),
        ] {
            let error = read(name, bytes).expect_err(what).to_string();
            let said = error.contains(name) && error.contains(what) && error.contains(fix);
            assert!(said, "{what}: {error}");
        }
    }
}
