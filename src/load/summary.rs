//! What a scene file holds, as numbers and as the few lines that people read first.

use super::{LightKind, LoadedScene, Part};
use glam::DVec3;
use gnomon_core::scene::{Mesh, Sides};
use serde::Serialize;
use std::collections::HashMap;
use std::sync::Arc;

/// What a file says of itself beside its parts.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct FileFacts {
    /// Its format, as people call it.
    pub format: &'static str,
    /// Animations in it.
    pub animations: usize,
    /// Seconds at which it is posed, if it is, as written.
    pub time: Option<String>,
    /// Parts that a skin moves.
    pub skinned: usize,
    /// Parts that morph targets move.
    pub morphed: usize,
}

/// A name with what it is.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Named {
    /// The file's name for it.
    pub name: String,
    /// Directional, spot, point, perspective or orthographic.
    pub kind: &'static str,
}

/// The input of a measurement, in numbers.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Summary {
    /// What the file says of itself.
    pub file: FileFacts,
    /// Parts that are drawn, instances counted.
    pub objects: usize,
    /// Meshes that they draw; instances share one.
    pub meshes: usize,
    /// Triangles that are drawn, instances counted.
    pub triangles: u64,
    /// Triangles of all meshes, instances not counted.
    pub distinct_triangles: u64,
    /// Vertices of all meshes.
    pub vertices: u64,
    /// Lowest and highest world coordinates of what triangles name, in the file's units.
    pub bounds: [[f64; 3]; 2],
    /// What a unit is: the format's, or a guess by the extent that says so.
    pub unit: String,
    /// Lights in the file's order.
    pub lights: Vec<Named>,
    /// Cameras in the file's order.
    pub cameras: Vec<Named>,
    /// Parts that draw their front, their back, both sides.
    pub sides: [usize; 3],
    /// Parts with an alpha mask.
    pub masked: usize,
    /// Parts that throw no shadow, and that receive none.
    pub shadowless: [usize; 2],
    /// Parts with normals for each vertex; the others are flat.
    pub with_normals: usize,
    /// What was left out, or taken otherwise, and can change a shadow.
    pub skipped: Vec<String>,
}

/// A mesh as part of a sum: its triangles and the vertices that they name.
struct Shape {
    triangles: u64,
    named: Vec<u32>,
}

impl Shape {
    fn of(mesh: &Mesh) -> Self {
        let mut is_named = vec![false; mesh.positions.len()];
        for &v in mesh.triangles.iter().flatten() {
            is_named.get_mut(v as usize).into_iter().for_each(|named| *named = true);
        }
        let named = (0..).zip(&is_named).filter(|(_, named)| **named).map(|(v, _)| v).collect();
        Self { triangles: mesh.triangles.len() as u64, named }
    }

    /// World positions of a part with this shape.
    fn points<'p>(&'p self, part: &'p Part) -> impl Iterator<Item = DVec3> + 'p {
        let exact = |v: &u32| part.mesh.exact.get(*v as usize).copied();
        let position = |v: &u32| part.mesh.positions.get(*v as usize).map(|p| p.as_dvec3());
        let point = move |v: &u32| exact(v).or_else(|| position(v));
        self.named.iter().filter_map(point).map(|p| part.model.transform_point3(p))
    }
}

impl LoadedScene {
    /// This scene in numbers.
    #[must_use]
    pub fn summary(&self) -> Summary {
        let mut shapes: HashMap<*const Mesh, Shape> = HashMap::new();
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let mut triangles = 0;
        for part in &self.parts {
            let shape =
                shapes.entry(Arc::as_ptr(&part.mesh)).or_insert_with(|| Shape::of(&part.mesh));
            triangles += shape.triangles;
            for p in shape.points(part) {
                (low, high) = (low.min(p), high.max(p));
            }
        }
        let count = |of: &dyn Fn(&Part) -> bool| self.parts.iter().filter(|part| of(part)).count();
        let sides = [Sides::Front, Sides::Back, Sides::Both];
        Summary {
            file: self.file.clone(),
            objects: self.parts.len(),
            meshes: shapes.len(),
            triangles,
            distinct_triangles: shapes.values().map(|shape| shape.triangles).sum(),
            vertices: shapes.values().map(|shape| shape.named.len() as u64).sum(),
            bounds: [low.to_array(), high.to_array()],
            unit: unit(self.file.format, (high - low).max_element()),
            lights: self.lights.iter().map(|l| named(&l.name, light_kind(l.kind))).collect(),
            cameras: self.cameras.iter().map(|c| named(&c.name, c.lens.name())).collect(),
            sides: sides.map(|sides| count(&|part| part.surface.sides == sides)),
            masked: count(&|part| part.surface.mask.is_some()),
            shadowless: [count(&|part| !part.surface.casts), count(&|part| !part.surface.receives)],
            with_normals: count(&|part| !part.mesh.normals.is_empty()),
            skipped: self.skipped.clone(),
        }
    }
}

fn named(name: &str, kind: &'static str) -> Named {
    Named { name: name.replace(char::is_control, "\u{fffd}"), kind }
}

fn light_kind(kind: LightKind) -> &'static str {
    match kind {
        LightKind::Directional => "directional",
        LightKind::Spot { .. } => "spot",
        LightKind::Point => "point",
    }
}

/// Metres where the format says so; else what would make the scene as large as scenes are.
fn unit(format: &str, extent: f64) -> String {
    match (format, extent) {
        ("glTF", _) => "metres".into(),
        (_, 0.5..=500.0) => "units, by their extent metres".into(),
        (_, 500.0..=50_000.0) => "units, by their extent centimetres or millimetres".into(),
        _ => "units".into(),
    }
}

/// 1234567 → `1,234,567`.
fn grouped(n: u64) -> String {
    let digits = n.to_string();
    let first = digits.len() % 3;
    let (head, tail) = digits.split_at(first);
    let groups = tail.as_bytes().chunks(3).map(String::from_utf8_lossy);
    let all: Vec<_> = (!head.is_empty()).then(|| head.into()).into_iter().chain(groups).collect();
    all.join(",")
}

/// `1 part`, `2 parts`.
fn counted(n: u64, noun: &str) -> String {
    let plural = match (n, noun.ends_with("sh")) {
        (1, _) => "",
        (_, true) => "es",
        (_, false) => "s",
    };
    format!("{} {noun}{plural}", grouped(n))
}

/// A length with four digits, as people write it.
fn short(x: f64) -> String {
    match x.abs() {
        0.0 => "0".into(),
        1000.0.. => format!("{x:.0}"),
        0.01.. => format!("{x:.4}").trim_end_matches('0').trim_end_matches('.').into(),
        _ => format!("{x:.3e}"),
    }
}

fn list(all: &[Named]) -> String {
    const MOST: usize = 5;
    let names: Vec<String> =
        all.iter().take(MOST).map(|n| format!("{} ({})", n.name, n.kind)).collect();
    let more = all.len().saturating_sub(MOST);
    let more = if more > 0 { format!(" and {more} more") } else { String::new() };
    format!("{}{more}", names.join(", "))
}

impl Summary {
    /// Width, height and depth of the bounds.
    fn extent(&self) -> String {
        let [low, high] = self.bounds;
        let axes: Vec<String> = low.iter().zip(high).map(|(a, b)| short(b - a)).collect();
        axes.join(" x ")
    }

    /// All of it in one sentence, for the first note of a report.
    #[must_use]
    pub fn line(&self, name: &str) -> String {
        let mut parts = vec![
            counted(self.objects as u64, "object"),
            counted(self.triangles, "triangle"),
            format!("{} {}", self.extent(), self.unit),
        ];
        let lights = (self.lights.len(), self.cameras.len());
        parts.push(format!(
            "{} and {}",
            counted(lights.0 as u64, "light"),
            counted(lights.1 as u64, "camera")
        ));
        parts.extend((self.masked > 0).then(|| format!("{} alpha-masked", self.masked)));
        format!("{name}: {}", parts.join(", "))
    }

    /// A few lines for people.
    #[must_use]
    pub fn lines(&self) -> Vec<String> {
        let [low, high] = self.bounds.map(|p| p.map(short).join(", "));
        let [front, back, both] = self.sides;
        let none_or = |all: &[Named]| if all.is_empty() { "none".into() } else { list(all) };
        let mut lines = vec![
            format!("format      {}", self.file.format),
            format!(
                "geometry    {} of {}, {} ({} in the meshes), {}",
                counted(self.objects as u64, "object"),
                counted(self.meshes as u64, "mesh"),
                counted(self.triangles, "triangle"),
                grouped(self.distinct_triangles),
                counted(self.vertices, "vertex").replace("vertexs", "vertices"),
            ),
            format!("extent      {} {}", self.extent(), self.unit),
            format!("bounds      ({low}) to ({high})"),
            format!(
                "normals     {} of {} objects; the others are flat",
                self.with_normals, self.objects
            ),
            format!(
                "sides       {front} front, {back} back, {both} both; {} alpha-masked",
                self.masked
            ),
            format!("lights      {}", none_or(&self.lights)),
            format!("cameras     {}", none_or(&self.cameras)),
        ];
        let [dark, unshadowed] = self.shadowless;
        if dark + unshadowed > 0 {
            lines.push(format!("shadows     {dark} throw none, {unshadowed} receive none"));
        }
        let FileFacts { animations, skinned, morphed, time, .. } = &self.file;
        if animations + skinned + morphed > 0 {
            let at = time.as_ref().map_or("at rest".to_string(), |t| format!("at {t} s"));
            lines.push(format!(
                "pose        {at}: {skinned} skinned, {morphed} morphed, {}",
                counted(*animations as u64, "animation")
            ));
        }
        lines.extend(self.skipped.iter().map(|what| format!("left out    {what}")));
        lines
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_as_people_write_them() {
        assert_eq!([0, 7, 1000, 1_234_567].map(grouped), ["0", "7", "1,000", "1,234,567"]);
        assert_eq!([counted(1, "mesh"), counted(2, "mesh")], ["1 mesh", "2 meshes"]);
        assert_eq!(
            [20.0, 5.1, 0.0, 12345.6, 1e-5].map(short),
            ["20", "5.1", "0", "12346", "1.000e-5"]
        );
    }
}
