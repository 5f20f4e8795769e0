//! A geometry in the making: vertices in f64 as three.js pushes them, rounded to f32 at the end.

use crate::files::Budget;
use glam::{DVec2, DVec3};
use gnomon_core::{Error, Result};
use serde_json::{Map, Value};

/// π, as JavaScript's `Math.PI`.
pub(super) const PI: f64 = std::f64::consts::PI;

/// Position, normal and texture coordinates of a vertex.
pub(super) type Vertex = (DVec3, DVec3, DVec2);

/// So many triangles from one on are drawn with a material of the list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Group {
    pub(super) first: usize,
    pub(super) count: usize,
    pub(super) material: usize,
}

/// Vertices and triangles of a geometry.
#[derive(Clone, Debug, Default)]
pub(super) struct Shape {
    pub(super) positions: Vec<DVec3>,
    pub(super) normals: Vec<DVec3>,
    pub(super) uvs: Vec<DVec2>,
    pub(super) triangles: Vec<[u32; 3]>,
    pub(super) groups: Vec<Group>,
}

impl Shape {
    /// Adds a vertex.
    pub(super) fn push(&mut self, (position, normal, uv): Vertex) {
        self.positions.push(position);
        self.normals.push(normal);
        self.uvs.push(uv);
    }

    /// Adds (across + 1) × (down + 1) vertices row by row; the number of the first.
    pub(super) fn rows(
        &mut self,
        across: u32,
        down: u32,
        vertex: impl Fn(u32, u32) -> Vertex,
    ) -> u32 {
        let first = self.positions.len() as u32;
        for y in 0..=down {
            (0..=across).for_each(|x| self.push(vertex(x, y)));
        }
        first
    }

    /// Adds the two triangles abd and bcd of every cell of such rows, row by row: a is the cell's first
    /// vertex, b the one a row on, c and d those beside them.
    pub(super) fn cells(&mut self, first: u32, across: u32, down: u32) {
        for y in 0..down {
            (0..across).for_each(|x| self.triangles.extend(cell(first, across, x, y)));
        }
    }

    /// Ends a group: all triangles since the last one.
    pub(super) fn group(&mut self, material: usize) {
        let first = self.groups.last().map_or(0, |last| last.first + last.count);
        self.groups.push(Group { first, count: self.triangles.len() - first, material });
    }
}

/// The triangles abd and bcd of a cell.
pub(super) fn cell(first: u32, across: u32, x: u32, y: u32) -> [[u32; 3]; 2] {
    let a = first + x + (across + 1) * y;
    let b = a + across + 1;
    [[a, b, a + 1], [b, b + 1, a + 1]]
}

/// `Vector3.normalize`: times 1/length, in f64; the zero vector stays.
pub(super) fn normalized(v: DVec3) -> DVec3 {
    let length = f64::sqrt(v.x * v.x + v.y * v.y + v.z * v.z);
    v * (1.0 / if length == 0.0 { 1.0 } else { length })
}

/// What a parametric geometry says of itself.
pub(super) struct Parameters<'a, 'b, 'c> {
    /// Where it stands, for complaints.
    pub(super) place: &'a str,
    pub(super) given: &'a Map<String, Value>,
    pub(super) budget: &'b mut Budget<'c>,
}

impl Parameters<'_, '_, '_> {
    /// A number, or three.js' default.
    pub(super) fn number(&self, key: &str, default: f64) -> Result<f64> {
        match self.given.get(key) {
            None | Some(Value::Null) => Ok(default),
            Some(value) => value.as_f64().filter(|x| x.abs() <= 1e30).ok_or_else(|| {
                let reason = format!("{key} is {value}, not a number within 1e30");
                Error::bad_input(self.place, reason, "export it again")
            }),
        }
    }

    /// A number of segments, rounded down and at least `least`.
    pub(super) fn count(&self, key: &str, default: u32, least: u32) -> Result<u32> {
        Ok((self.number(key, f64::from(default))?.floor() as u32).max(least))
    }

    pub(super) fn flag(&self, key: &str) -> bool {
        self.given.get(key).and_then(Value::as_bool).unwrap_or(false)
    }

    /// Refuses a grid with more vertices or triangles than a scene may have, before it is made.
    pub(super) fn afford(&mut self, across: u32, down: u32) -> Result<()> {
        let [across, down] = [across, down].map(u64::from);
        self.budget.vertices(self.place, (across + 1).saturating_mul(down + 1))?;
        self.budget.indices(self.place, across.saturating_mul(down).saturating_mul(6))
    }
}
