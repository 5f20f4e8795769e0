//! Wavefront OBJ: positions, normals and faces, line by line. Without normals faces are flat, whatever
//! their smoothing groups say, as three.js' loader has it; of material files only transparency is read.

use super::files::Budget;
use super::polygons::Cutter;
use super::{LoadedScene, mtl, repair};
use glam::{DVec3, Vec3};
use gnomon_core::{Error, Result};
use std::collections::{BTreeSet, HashMap};

/// Bytes in memory for each byte of the file: the shortest face line gives the most.
const GROWTH: u64 = 16;

pub(super) fn read(place: &str, bytes: &[u8], budget: Budget<'_>) -> Result<LoadedScene> {
    let place = place.to_string();
    budget.memory(&place, bytes.len() as u64 * GROWTH)?;
    if bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]) {
        return Err(Error::bad_input(place, "is UTF-16 text", "save it as UTF-8"));
    }
    let mut reader = Reader::new(place, budget);
    let mut lines = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).split(|&b| b == b'\n');
    let mut joined = Vec::new();
    while let Some(line) = lines.next() {
        reader.line += 1;
        let (mut line, mut follow) = (line, 0);
        joined.clear();
        // A backslash at the end joins the next line.
        while let Some(begun) = line.trim_ascii_end().strip_suffix(b"\\") {
            joined.extend_from_slice(begun);
            joined.push(b' ');
            line = lines.next().unwrap_or_default();
            follow += 1;
        }
        match follow {
            0 => reader.read_line(line)?,
            _ => {
                joined.extend_from_slice(line);
                reader.read_line(&joined)?;
            }
        }
        reader.line += follow;
    }
    reader.finish()
}

/// Words of a line up to a comment.
fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    let text = line.split(|&b| b == b'#').next().unwrap_or_default();
    text.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty())
}

/// An object whose faces are being read.
#[derive(Default)]
struct Part {
    name: String,
    /// Corners of all faces as numbers of the file's vertices.
    corners: Vec<u32>,
    /// Normals of the corners as numbers of the file's normals; empty until the first that has one.
    normals: Vec<u32>,
    /// Number of corners of each face.
    faces: Vec<u32>,
    /// Line of each face.
    lines: Vec<u32>,
}

struct Reader<'b> {
    place: String,
    line: usize,
    budget: Budget<'b>,
    positions: Vec<DVec3>,
    normals: Vec<Vec3>,
    parts: Vec<Part>,
    /// Material files and the materials that are used.
    libraries: BTreeSet<String>,
    used: BTreeSet<String>,
    /// Lines, points, curves and surfaces: they are not drawn.
    undrawn: usize,
    small: usize,
}

impl<'b> Reader<'b> {
    fn new(place: String, budget: Budget<'b>) -> Self {
        let first = Part { name: "unnamed_object".into(), ..Part::default() };
        Self {
            place,
            line: 0,
            budget,
            positions: Vec::new(),
            normals: Vec::new(),
            parts: vec![first],
            libraries: BTreeSet::new(),
            used: BTreeSet::new(),
            undrawn: 0,
            small: 0,
        }
    }

    fn at(&self, line: usize) -> String {
        format!("{}: line {line}", self.place)
    }

    fn bad(&self, reason: String) -> Error {
        Error::bad_input(self.at(self.line), reason, "repair the OBJ, or take --lenient")
    }

    fn read_line(&mut self, line: &[u8]) -> Result<()> {
        let mut words = words(line);
        match words.next() {
            Some(b"v") => self.read_vertex(words),
            Some(b"f" | b"fo") => self.read_face(words),
            Some(b"vn") => {
                let normal = numbers(words).map_or(Vec3::ZERO, |n| n.as_vec3());
                self.normals.push(normal);
                Ok(())
            }
            Some(word @ (b"o" | b"g" | b"mtllib" | b"usemtl")) => {
                let name = String::from_utf8_lossy(line.trim_ascii()).into_owned();
                let name = name.split_once(char::is_whitespace).map_or("", |(_, name)| name.trim());
                match word {
                    b"mtllib" => drop(self.libraries.insert(name.to_string())),
                    b"usemtl" => drop(self.used.insert(name.to_string())),
                    _ => self.begin(if name.is_empty() { "unnamed_object" } else { name }),
                }
                Ok(())
            }
            Some(b"l" | b"p" | b"curv" | b"curv2" | b"surf") => {
                self.undrawn += 1;
                Ok(())
            }
            _ => Ok(()),
        }
    }

    /// Faces belong to a new part from here on; a part without faces is only renamed.
    fn begin(&mut self, name: &str) {
        match self.parts.last_mut() {
            Some(part) if part.faces.is_empty() => part.name = name.to_string(),
            _ => self.parts.push(Part { name: name.to_string(), ..Part::default() }),
        }
    }

    fn read_vertex<'w>(&mut self, words: impl Iterator<Item = &'w [u8]>) -> Result<()> {
        self.budget.vertices(&self.place, 1)?;
        let (number, p) = (self.positions.len(), numbers(words));
        if !self.budget.is_lenient() {
            let p = p.ok_or_else(|| self.bad(format!("vertex {number} has no three numbers")))?;
            if !repair::is_sound(p.as_vec3()) {
                let reason = format!("vertex {number} is {p}, not a number within 1e30");
                return Err(self.bad(reason));
            }
        }
        self.positions.push(p.unwrap_or(DVec3::NAN));
        Ok(())
    }

    fn read_face<'w>(&mut self, words: impl Iterator<Item = &'w [u8]>) -> Result<()> {
        let Some(part) = self.parts.last_mut() else { return Ok(()) };
        let begin = part.corners.len();
        let mut wrong = None;
        for word in words {
            let normal = normal(word, self.normals.len());
            if normal.is_some() || !part.normals.is_empty() {
                part.normals.resize(part.corners.len(), u32::MAX);
                part.normals.push(normal.unwrap_or(u32::MAX));
            }
            match vertex(word, self.positions.len()) {
                Some(corner) => part.corners.push(corner),
                None => {
                    part.corners.push(u32::MAX);
                    wrong = wrong.or(Some(String::from_utf8_lossy(word).into_owned()));
                }
            }
        }
        let count = part.corners.len() - begin;
        if count < 3 {
            part.corners.truncate(begin);
            part.normals.truncate(begin);
            self.small += 1;
        } else {
            part.faces.push(count as u32);
            part.lines.push(u32::try_from(self.line).unwrap_or(u32::MAX));
        }
        match wrong {
            _ if self.budget.is_lenient() => Ok(()),
            Some(word) => Err(self.bad(format!("'{word}' names no vertex of the OBJ"))),
            None if count < 3 => Err(self.bad(format!("a face has {count} corners"))),
            None => Ok(()),
        }
    }

    fn finish(mut self) -> Result<LoadedScene> {
        let mut scene = LoadedScene::default();
        let (mut cutter, mut flat) = (Cutter::new(), 0);
        let mut own = vec![(u32::MAX, 0); self.positions.len()];
        let parts = std::mem::take(&mut self.parts);
        for (i, part) in parts.into_iter().enumerate().filter(|(_, part)| !part.faces.is_empty()) {
            let at = format!("{}: object {i} '{}'", self.place, part.name);
            let corners = self.triangles(&part, &mut cutter)?;
            let (exact, normals, indices) = match self.all_turned(&part, &corners) {
                true => self.split(&part, corners),
                false => {
                    flat += usize::from(!part.normals.is_empty() && !self.normals.is_empty());
                    let (exact, indices) = self.compact(i as u32, &part, corners, &mut own);
                    (exact, Vec::new(), indices)
                }
            };
            let given = (exact.iter().map(|p| p.as_vec3()).collect(), indices);
            let colour = Vec3::splat(0.8);
            let mut mesh = repair::mesh(&at, given, colour, &self.budget, &mut scene.notes)?;
            repair::complete(&mut mesh, exact, normals);
            let name = format!("{}#{i}", part.name);
            scene.parts.push(super::Part::drawn(name, mesh));
        }
        cutter.note(&self.place, &mut scene.notes);
        for (count, what) in [
            (self.undrawn, "lines, points, curves and surfaces are left out"),
            (self.small, "faces have fewer than 3 corners and are left out"),
            (flat, "parts have normals at some corners only and are taken as flat"),
        ] {
            if count > 0 {
                scene.notes.push(format!("{}: {count} {what}", self.place));
            }
        }
        mtl::tell(&mut self.budget, &self.libraries, &self.used, &mut scene.skipped);
        Ok(scene)
    }

    /// The part's faces as triangles of its corners.
    fn triangles(&mut self, part: &Part, cutter: &mut Cutter) -> Result<Vec<u32>> {
        let mut triangles = Vec::with_capacity(part.corners.len());
        let mut begin = 0u32;
        for (&count, &line) in part.faces.iter().zip(&part.lines) {
            let face: Vec<u32> = (begin..begin + count).collect();
            begin += count;
            let place = || format!("{}: line {line}", self.place);
            let vertex = |corner: u32| part.corners.get(corner as usize).copied();
            let missing = face
                .iter()
                .find_map(|&c| vertex(c).filter(|&v| v as usize >= self.positions.len()));
            if let (Some(vertex), false) = (missing, self.budget.is_lenient()) {
                let reason =
                    format!("names vertex {} of {}", u64::from(vertex) + 1, self.positions.len());
                return Err(Error::bad_input(place(), reason, "repair the OBJ, or take --lenient"));
            }
            self.budget.indices(&self.place, 3 * face.len().saturating_sub(2) as u64)?;
            let at = |corner: u32| self.positions.get(vertex(corner)? as usize).copied();
            cutter.face(place, &face, at, &mut triangles)?;
        }
        Ok(triangles)
    }

    /// Whether every corner has a normal that is there.
    fn all_turned(&self, part: &Part, corners: &[u32]) -> bool {
        let normal =
            |c: &u32| part.normals.get(*c as usize).and_then(|n| self.normals.get(*n as usize));
        !part.normals.is_empty() && corners.iter().all(|c| normal(c).is_some())
    }

    /// The vertices that a part's corners name, in the order of their first use, and the triangles
    /// by them. `own` remembers, for each vertex of the file, the last part and its number there.
    fn compact(
        &self,
        number: u32,
        part: &Part,
        mut corners: Vec<u32>,
        own: &mut [(u32, u32)],
    ) -> (Vec<DVec3>, Vec<u32>) {
        let mut positions = Vec::new();
        for corner in &mut corners {
            let vertex = part.corners.get(*corner as usize).map_or(usize::MAX, |v| *v as usize);
            let Some((known, index)) = own.get_mut(vertex) else {
                *corner = u32::MAX;
                continue;
            };
            if *known != number {
                (*known, *index) = (number, positions.len() as u32);
                positions.push(self.positions.get(vertex).copied().unwrap_or(DVec3::NAN));
            }
            *corner = *index;
        }
        (positions, corners)
    }

    /// As [`Reader::compact`], with a vertex for every pair of position and normal.
    fn split(&self, part: &Part, mut corners: Vec<u32>) -> (Vec<DVec3>, Vec<Vec3>, Vec<u32>) {
        let (mut positions, mut normals) = (Vec::new(), Vec::new());
        let mut known: HashMap<(u32, u32), u32> = HashMap::with_capacity(corners.len() / 4);
        for corner in &mut corners {
            let of = |numbers: &[u32]| numbers.get(*corner as usize).copied().unwrap_or(u32::MAX);
            let (vertex, normal) = (of(&part.corners), of(&part.normals));
            let next = positions.len() as u32;
            *corner = *known.entry((vertex, normal)).or_insert(next);
            if *corner == next {
                positions.push(self.positions.get(vertex as usize).copied().unwrap_or(DVec3::NAN));
                normals.push(self.normals.get(normal as usize).copied().unwrap_or_default());
            }
        }
        (positions, normals, corners)
    }
}

/// Three numbers at the begin of words.
fn numbers<'w>(mut words: impl Iterator<Item = &'w [u8]>) -> Option<DVec3> {
    let mut axis = || std::str::from_utf8(words.next()?).ok()?.parse::<f64>().ok();
    Some(DVec3::new(axis()?, axis()?, axis()?))
}

/// The vertex that a corner `v`, `v/t`, `v//n` or `v/t/n` names, from 0; negative numbers count back
/// from the last of `count`. A number beyond `count` may still follow in the file.
fn vertex(word: &[u8], count: usize) -> Option<u32> {
    index(word.split(|&b| b == b'/').next()?, count)
}

/// The normal that a corner `v//n` or `v/t/n` names, from 0.
fn normal(word: &[u8], count: usize) -> Option<u32> {
    index(word.split(|&b| b == b'/').nth(2)?, count)
}

fn index(word: &[u8], count: usize) -> Option<u32> {
    let number: i64 = std::str::from_utf8(word).ok()?.parse().ok()?;
    let from_zero = match number {
        0 => return None,
        1.. => number - 1,
        _ => number.checked_add(count as i64)?,
    };
    u32::try_from(from_zero).ok().filter(|&v| v < u32::MAX)
}
