//! PLY, the Stanford format: positions, normals and faces, as text or binary; all else in it is passed
//! over.

use super::files::Budget;
use super::polygons::Cutter;
use super::{LoadedScene, repair, strips};
use glam::{DVec3, Vec3};
use gnomon_core::{Error, Result};
use ply_rs_bw::parser::{Parser, Reader};
use ply_rs_bw::ply::{ElementDef, Header, Property, PropertyAccess, PropertyAccessResult};

pub(super) fn read(place: &str, bytes: &[u8], mut budget: Budget<'_>) -> Result<LoadedScene> {
    let place = place.to_string();
    let mut file = File { place: &place, size: bytes.len(), reader: Reader::new(bytes) };
    let header = Parser::<Nothing>::new().read_header(&mut file.reader);
    let header = header.map_err(|e| unusable(&place, &e))?;
    let (mut vertices, mut faces, mut strips) = (Vec::new(), Vec::new(), Vec::new());
    let mut turned = false;
    for (name, element) in &header.elements {
        file.check(element)?;
        match name.as_str() {
            "vertex" => {
                budget.vertices(&place, element.count as u64)?;
                vertices = file.elements::<Vertex>(element, &header)?;
                turned = ["nx", "ny", "nz"].iter().all(|n| element.properties.contains_key(*n));
            }
            "face" => {
                budget.indices(&place, 3 * element.count as u64)?;
                faces = file.elements::<Face>(element, &header)?;
            }
            "tristrips" => strips = file.elements::<Strip>(element, &header)?,
            _ => drop(file.elements::<Nothing>(element, &header)?),
        }
    }
    let corners: usize = faces.iter().map(|face| 3 * face.0.len().saturating_sub(2)).sum();
    budget.indices(&place, corners.saturating_sub(3 * faces.len()) as u64)?;
    let exact: Vec<DVec3> = vertices.iter().map(|vertex: &Vertex| vertex.position).collect();
    let positions: Vec<Vec3> = exact.iter().map(|p| p.as_vec3()).collect();
    let normals = match turned {
        true => vertices.iter().map(|vertex| vertex.normal).collect(),
        false => Vec::new(),
    };
    drop(vertices);
    let mut scene = LoadedScene::default();
    let mut triangles = triangles(&place, &faces, &exact, &budget, &mut scene.notes)?;
    let corners: usize = strips.iter().map(|strip| strip.0.len()).sum();
    budget.indices(&place, 3 * corners as u64)?;
    triangles.extend(strips.iter().flat_map(Strip::triangles));
    let given = (positions, triangles);
    let mut mesh = repair::mesh(&place, given, Vec3::splat(0.8), &budget, &mut scene.notes)?;
    repair::complete(&mut mesh, exact, normals);
    scene.parts.push(super::Part::drawn("mesh".to_string(), mesh));
    Ok(scene)
}

fn unusable(place: &str, error: &impl std::fmt::Display) -> Error {
    let reason = error.to_string().split_whitespace().collect::<Vec<_>>().join(" ");
    // The library quotes its grammar, which tells a user nothing.
    let (reason, _) = reason.split_once("ParseError {").unwrap_or((&reason, ""));
    let reason = reason.trim_end_matches([' ', ':', ',', '(']);
    let reason: String = reason.chars().filter(|c| !c.is_control()).take(200).collect();
    Error::bad_input(place, format!("is no usable PLY ({reason})"), "repair the file")
}

/// Every face as triangles.
fn triangles(
    place: &str,
    faces: &[Face],
    positions: &[DVec3],
    budget: &Budget<'_>,
    notes: &mut Vec<String>,
) -> Result<Vec<u32>> {
    let small = |face: &Face| face.0.len() < 3;
    match faces.iter().enumerate().find(|(_, face)| small(face)) {
        Some((k, face)) if !budget.is_lenient() => {
            let reason = format!("face {k} has {} corners", face.0.len());
            return Err(Error::bad_input(place, reason, "repair the mesh, or take --lenient"));
        }
        Some(_) => {
            let lost = faces.iter().filter(|face| small(face)).count();
            notes.push(format!("{place}: {lost} faces have fewer than 3 corners and are left out"));
        }
        None => {}
    }
    let (mut cutter, mut triangles) = (Cutter::new(), Vec::new());
    for (k, face) in faces.iter().enumerate().filter(|(_, face)| !small(face)) {
        let at = |i: u32| positions.get(i as usize).copied();
        cutter.face(|| format!("{place}: face {k}"), &face.0, at, &mut triangles)?;
    }
    cutter.note(place, notes);
    Ok(triangles)
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

struct Vertex {
    position: DVec3,
    normal: Vec3,
}

/// A number with the digits that it has: f32 holds neither doubles nor large integers.
fn number(value: &Property) -> Option<f64> {
    #[expect(clippy::wildcard_enum_match_arm, reason = "the library's own enum of all types")]
    match *value {
        Property::Double(value) => Some(value),
        Property::Int(value) => Some(f64::from(value)),
        Property::UInt(value) => Some(f64::from(value)),
        ref other => other.to_f32_lossy().map(f64::from),
    }
}

impl PropertyAccess for Vertex {
    fn new() -> Self {
        Self { position: DVec3::ZERO, normal: Vec3::ZERO }
    }

    fn set_property(&mut self, name: &str, value: Property) -> PropertyAccessResult {
        let axis = match name {
            "x" => &mut self.position.x,
            "y" => &mut self.position.y,
            "z" => &mut self.position.z,
            "nx" | "ny" | "nz" => {
                let Some(value) = value.to_f32_lossy() else {
                    return PropertyAccessResult::UnsupportedType;
                };
                let axis = match name {
                    "nx" => &mut self.normal.x,
                    "ny" => &mut self.normal.y,
                    _ => &mut self.normal.z,
                };
                *axis = value;
                return PropertyAccessResult::Set;
            }
            _ => return PropertyAccessResult::Ignored,
        };
        match number(&value) {
            Some(value) => *axis = value,
            None => return PropertyAccessResult::UnsupportedType,
        }
        PropertyAccessResult::Set
    }
}

/// Triangle strips, one after the other: a negative index ends one.
struct Strip(Vec<i64>);

impl Strip {
    fn triangles(&self) -> Vec<u32> {
        let parts = self.0.split(|&index| index < 0);
        let corner = |&index: &i64| u32::try_from(index).unwrap_or(u32::MAX);
        parts.flat_map(|part| strips::strip(&part.iter().map(corner).collect::<Vec<_>>())).collect()
    }
}

impl PropertyAccess for Strip {
    fn new() -> Self {
        Self(Vec::new())
    }

    fn set_property(&mut self, name: &str, value: Property) -> PropertyAccessResult {
        if !matches!(name, "vertex_indices" | "vertex_index") {
            return PropertyAccessResult::Ignored;
        }
        #[expect(clippy::wildcard_enum_match_arm, reason = "the library's own enum of all types")]
        let strip = match value {
            Property::ListChar(list) => list.into_iter().map(i64::from).collect(),
            Property::ListShort(list) => list.into_iter().map(i64::from).collect(),
            Property::ListInt(list) => list.into_iter().map(i64::from).collect(),
            other => match other.to_u32_list() {
                Some(list) => list.into_iter().map(i64::from).collect(),
                None => return PropertyAccessResult::UnsupportedType,
            },
        };
        self.0 = strip;
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
