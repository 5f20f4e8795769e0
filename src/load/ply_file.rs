//! PLY, the Stanford format: positions and faces, as text or binary; all else in it is passed over.

use super::files::Budget;
use super::{LoadedScene, repair};
use glam::{Mat4, Vec3};
use gnomon_core::{Error, Result};
use ply_rs_bw::parser::{Parser, Reader};
use ply_rs_bw::ply::{ElementDef, Header, Property, PropertyAccess, PropertyAccessResult};
use std::path::Path;

pub(super) fn read(path: &Path, bytes: &[u8], mut budget: Budget) -> Result<LoadedScene> {
    let place = path.display().to_string();
    let mut file = File { place: &place, size: bytes.len(), reader: Reader::new(bytes) };
    let header = Parser::<Nothing>::new().read_header(&mut file.reader);
    let header = header.map_err(|e| unusable(&place, &e))?;
    let (mut positions, mut faces) = (Vec::new(), Vec::new());
    for (name, element) in &header.elements {
        file.check(element)?;
        match name.as_str() {
            "vertex" => {
                budget.vertices(&place, element.count as u64)?;
                positions = file.elements::<Vertex>(element, &header)?;
            }
            "face" => {
                budget.indices(&place, 3 * element.count as u64)?;
                faces = file.elements::<Face>(element, &header)?;
            }
            _ => drop(file.elements::<Nothing>(element, &header)?),
        }
    }
    let corners: usize = faces.iter().map(|face| 3 * face.0.len().saturating_sub(2)).sum();
    budget.indices(&place, corners.saturating_sub(3 * faces.len()) as u64)?;
    let positions = positions.into_iter().map(|vertex| vertex.0).collect();
    let mut scene = LoadedScene::default();
    let given = (positions, fans(&place, &faces, &budget, &mut scene.notes)?);
    let mesh = repair::mesh(&place, given, Vec3::splat(0.8), &budget, &mut scene.notes)?;
    scene.parts.push(("mesh".to_string(), mesh, Mat4::IDENTITY));
    Ok(scene)
}

fn unusable(place: &str, error: &impl std::fmt::Display) -> Error {
    let reason = error.to_string().split_whitespace().collect::<Vec<_>>().join(" ");
    let reason: String = reason.chars().filter(|c| !c.is_control()).take(200).collect();
    Error::bad_input(place, format!("is no usable PLY ({reason})"), "repair the file")
}

/// Every face as triangles around its first corner.
fn fans(place: &str, faces: &[Face], budget: &Budget, notes: &mut Vec<String>) -> Result<Vec<u32>> {
    let small = |face: &&Face| face.0.len() < 3;
    match faces.iter().enumerate().find(|(_, face)| small(face)) {
        Some((k, face)) if !budget.is_lenient() => {
            let reason = format!("face {k} has {} corners", face.0.len());
            return Err(Error::bad_input(place, reason, "repair the mesh, or take --lenient"));
        }
        Some(_) => {
            let lost = faces.iter().filter(small).count();
            notes.push(format!("{place}: {lost} faces have fewer than 3 corners and are left out"));
        }
        None => {}
    }
    let fan = |face: &Face| {
        let first = face.0.first().copied().unwrap_or_default();
        let edges = face.0.get(1..).unwrap_or_default().array_windows::<2>();
        edges.flat_map(|&[a, b]| [first, a, b]).collect::<Vec<_>>()
    };
    Ok(faces.iter().flat_map(fan).collect())
}

/// A file being read, element after element.
struct File<'a> {
    place: &'a str,
    size: usize,
    reader: Reader<&'a [u8]>,
}

impl File<'_> {
    /// A header can claim anything, but an element takes a byte at least.
    fn check(&self, element: &ElementDef) -> Result<()> {
        if element.count > 0 && (element.properties.is_empty() || element.count > self.size) {
            let (name, count) = (&element.name, element.count);
            let reason = format!("cannot hold {count} of '{name}'");
            return Err(unusable(self.place, &reason));
        }
        Ok(())
    }

    fn elements<E: PropertyAccess>(
        &mut self,
        element: &ElementDef,
        header: &Header,
    ) -> Result<Vec<E>> {
        let read = Parser::new().read_payload_for_element(&mut self.reader, element, header);
        read.map_err(|e| unusable(self.place, &e))
    }
}

/// An element that nobody needs; takes no memory.
struct Nothing;

impl PropertyAccess for Nothing {
    fn new() -> Self {
        Self
    }
}

struct Vertex(Vec3);

impl PropertyAccess for Vertex {
    fn new() -> Self {
        Self(Vec3::ZERO)
    }

    fn set_property(&mut self, name: &str, value: Property) -> PropertyAccessResult {
        let axis = match name {
            "x" => &mut self.0.x,
            "y" => &mut self.0.y,
            "z" => &mut self.0.z,
            _ => return PropertyAccessResult::Ignored,
        };
        match value.to_f32_lossy() {
            Some(value) => *axis = value,
            None => return PropertyAccessResult::UnsupportedType,
        }
        PropertyAccessResult::Set
    }
}

/// Indices of its corners.
struct Face(Vec<u32>);

impl PropertyAccess for Face {
    fn new() -> Self {
        Self(Vec::new())
    }

    fn set_property(&mut self, name: &str, value: Property) -> PropertyAccessResult {
        if !matches!(name, "vertex_indices" | "vertex_index") {
            return PropertyAccessResult::Ignored;
        }
        match value.to_u32_list() {
            Some(indices) => self.0 = indices,
            None => return PropertyAccessResult::UnsupportedType,
        }
        PropertyAccessResult::Set
    }
}
