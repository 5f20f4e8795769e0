//! Buffers of a BufferGeometry: typed arrays, plain or interleaved, with their index and groups.

use super::file::{Attribute, Buffers};
use super::shape::{Group, Shape};
use crate::files::Budget;
use glam::{DVec2, DVec3};
use gnomon_core::{Error, Result};

/// A typed array's element: its bytes, how a word's bytes are read, and what a normalized one is divided by.
#[derive(Clone, Copy)]
struct Element {
    bytes: usize,
    read: fn(u32) -> f64,
    most: f64,
}

/// The element of a typed array by its constructor's name; `None` for one that is not known.
fn element(kind: &str) -> Option<Element> {
    let element = |bytes, read, most| Some(Element { bytes, read, most });
    match kind {
        "Int8Array" => element(1, |bits| f64::from(bits as u8 as i8), 127.0),
        "Uint8Array" | "Uint8ClampedArray" => element(1, |bits| f64::from(bits as u8), 255.0),
        "Int16Array" => element(2, |bits| f64::from(bits as u16 as i16), 32767.0),
        "Uint16Array" => element(2, |bits| f64::from(bits as u16), 65535.0),
        "Int32Array" => element(4, |bits| f64::from(bits as i32), 2_147_483_647.0),
        "Uint32Array" => element(4, f64::from, 4_294_967_295.0),
        "Float32Array" => element(4, |bits| f64::from(f32::from_bits(bits)), 1.0),
        _ => None,
    }
}

/// Reads the attributes of one geometry.
pub(super) struct Reader<'a> {
    pub(super) place: &'a str,
    pub(super) buffers: &'a Buffers,
}

impl Reader<'_> {
    fn bad(&self, what: &str, reason: impl Into<String>) -> Error {
        Error::bad_input(format!("{}: {what}", self.place), reason, "export the scene again")
    }

    /// Vertices, triangles and groups.
    pub(super) fn shape(&self, budget: &mut Budget<'_>) -> Result<Shape> {
        let position = self.buffers.attributes.position.as_ref();
        let Some(position) = position else { return Ok(Shape::default()) };
        let positions = self.triples("position", position)?;
        budget.vertices(self.place, positions.len() as u64)?;
        let of = |what, given: &Option<Attribute>| {
            given.as_ref().map_or(Ok(Vec::new()), |attribute| self.triples(what, attribute))
        };
        let normals = of("normal", &self.buffers.attributes.normal)?;
        let uvs = of("uv", &self.buffers.attributes.uv)?;
        let corners = match &self.buffers.index {
            Some(index) => self.index(index, positions.len())?,
            None => (0..positions.len() as u32).collect(),
        };
        budget.indices(self.place, corners.len() as u64)?;
        let triangles = corners.as_chunks::<3>().0.to_vec();
        let groups = self.groups(triangles.len());
        let uvs = uvs.into_iter().map(|uv| DVec2::new(uv.x, uv.y)).collect();
        let count = positions.len();
        let whole = |list: Vec<DVec3>| if list.len() == count { list } else { Vec::new() };
        Ok(Shape { normals: whole(normals), positions, uvs, triangles, groups })
    }

    fn index(&self, index: &Attribute, vertices: usize) -> Result<Vec<u32>> {
        let corner = |(at, i): (usize, &Option<f64>)| {
            let i = i.filter(|i| i.fract() == 0.0 && (0.0..vertices as f64).contains(i));
            i.map(|i| i as u32).ok_or_else(|| {
                self.bad("index", format!("number {at} names no vertex of {vertices}"))
            })
        };
        index.array.iter().enumerate().map(corner).collect()
    }

    /// The groups within the triangles; three.js counts corners.
    fn groups(&self, triangles: usize) -> Vec<Group> {
        let group = |group: &super::file::Group| {
            let first = (group.start / 3).min(triangles);
            let rest = triangles - first;
            let count = group.count.map_or(rest, |count| ((count / 3.0) as usize).min(rest));
            Group { first, count, material: group.material_index }
        };
        self.buffers.groups.iter().map(group).collect()
    }

    /// The first three numbers of every item, missing ones 0.
    fn triples(&self, what: &str, attribute: &Attribute) -> Result<Vec<DVec3>> {
        let (numbers, kind, items) = if attribute.is_interleaved_buffer_attribute {
            self.interleaved(what, attribute)?
        } else {
            let numbers = attribute.array.iter().map(|x| x.unwrap_or(f64::NAN)).collect();
            (numbers, attribute.kind.as_str(), attribute.item_size)
        };
        let most = match (attribute.normalized, element(kind)) {
            (false, _) => 1.0,
            (true, Some(element)) => element.most,
            (true, None) => return Err(self.bad(what, format!("'{kind}' is no known array"))),
        };
        if items == 0 || numbers.len() % items != 0 {
            let reason = format!("has {} numbers, no multiple of {items}", numbers.len());
            return Err(self.bad(what, reason));
        }
        let triple = |item: &[f64]| {
            let mut triple = [0.0; 3];
            let scaled = item.iter().map(|x| (x / most).max(if most > 1.0 { -1.0 } else { *x }));
            triple.iter_mut().zip(scaled).for_each(|(to, x)| *to = x);
            DVec3::from_array(triple)
        };
        let list: Vec<DVec3> = numbers.chunks_exact(items).map(triple).collect();
        match list.iter().position(|p| !(p.abs().max_element() <= 1e30)) {
            Some(i) => Err(self.bad(what, format!("of vertex {i} is not a number within 1e30"))),
            None => Ok(list),
        }
    }

    /// The numbers of an attribute of a shared buffer, three or fewer an item.
    fn interleaved(&self, what: &str, attribute: &Attribute) -> Result<(Vec<f64>, &str, usize)> {
        let shared = self.buffers.interleaved_buffers.get(&attribute.data);
        let shared = shared.ok_or_else(|| self.bad(what, "names a buffer that is not there"))?;
        let words = self.buffers.array_buffers.get(&shared.buffer);
        let words = words.ok_or_else(|| self.bad(what, "names an array that is not there"))?;
        let element = element(&shared.kind)
            .ok_or_else(|| self.bad(what, format!("'{}' is no known array", shared.kind)))?;
        let in_word = 4 / element.bytes;
        let read = |i: usize| {
            let word = words.get(i / in_word)?;
            Some((element.read)(word >> (8 * element.bytes * (i % in_word))))
        };
        let (stride, items) = (shared.stride, attribute.item_size.min(3));
        if stride == 0 || items == 0 || attribute.offset + items > stride {
            return Err(self.bad(what, format!("does not fit its buffer's stride of {stride}")));
        }
        let count = words.len() * in_word / stride;
        let numbers = (0..count)
            .flat_map(|vertex| (0..items).map(move |k| vertex * stride + attribute.offset + k))
            .map(|i| read(i).unwrap_or(f64::NAN))
            .collect();
        Ok((numbers, &shared.kind, items))
    }
}
