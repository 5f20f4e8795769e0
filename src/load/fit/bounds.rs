//! World bounds of what is drawn: what boxes, cones and cameras are fitted to.

use crate::{LoadedScene, Part};
use glam::{DMat4, DVec3, Vec3};
use gnomon_core::scene::Mesh;
use gnomon_core::scene::shapes::quad;
use gnomon_core::view::length;
use gnomon_core::{Error, Result};
use std::collections::BTreeSet;

/// What the ground plane is called.
pub const GROUND: &str = "ground";
/// Side of the ground plane in extents of what stands on it.
const GROUND_EXTENTS: f64 = 4.0;

/// World bounds of the vertices that triangles name.
pub(super) struct Bounds {
    /// What boxes and cameras are fitted to.
    pub points: Vec<DVec3>,
    /// What else is drawn: depth ranges hold it too.
    pub rest: Vec<DVec3>,
    /// The middle of `points`.
    pub centre: DVec3,
    /// The farthest of `points` from the centre.
    pub radius: f64,
    /// The farthest of all from the centre.
    pub reach: f64,
}

impl Bounds {
    /// Bounds of the parts in focus, all others beside them.
    pub(super) fn of(scene: &LoadedScene, in_focus: impl Fn(usize, &Part) -> bool) -> Self {
        let (mut points, mut rest) = (Vec::new(), Vec::new());
        for (i, part) in scene.parts.iter().enumerate() {
            if in_focus(i, part) { &mut points } else { &mut rest }.extend(part.drawn_points());
        }
        let (low, high) = corners(&points);
        let centre = (low + high) / 2.0;
        let farthest =
            |points: &[DVec3]| points.iter().map(|&p| length(p - centre)).fold(0.0, f64::max);
        let (radius, others) = (farthest(&points), farthest(&rest));
        Self { points, rest, centre, radius, reach: radius.max(others) }
    }

    /// Smallest and largest coordinate of the points in focus along an axis through the origin.
    pub(super) fn along(&self, axis: DVec3) -> (f64, f64) {
        span(&self.points, axis)
    }

    /// Smallest and largest coordinate of everything along an axis through the origin.
    pub(super) fn depth(&self, axis: DVec3) -> (f64, f64) {
        let ((a, b), (c, d)) = (span(&self.points, axis), span(&self.rest, axis));
        (a.min(c), b.max(d))
    }

    /// Everything, what is in focus first.
    pub(super) fn all(&self) -> impl Iterator<Item = DVec3> + '_ {
        self.points.iter().chain(&self.rest).copied()
    }
}

fn corners(points: &[DVec3]) -> (DVec3, DVec3) {
    let fold = |start, f: fn(DVec3, DVec3) -> DVec3| points.iter().copied().fold(start, f);
    (fold(DVec3::INFINITY, DVec3::min), fold(DVec3::NEG_INFINITY, DVec3::max))
}

fn span(points: &[DVec3], axis: DVec3) -> (f64, f64) {
    points
        .iter()
        .map(|p| p.dot(axis))
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), d| (low.min(d), high.max(d)))
}

/// Adds a receiver plane at the lowest point, [`GROUND_EXTENTS`] times as wide as what stands on it, and
/// says so.
pub(super) fn add_ground(scene: &mut LoadedScene) -> Result<()> {
    let points: Vec<DVec3> = scene.parts.iter().flat_map(Part::drawn_points).collect();
    let (low, high) = corners(&points);
    let size = (high - low).max_element() * GROUND_EXTENTS;
    let half = (size / 2.0) as f32;
    if !(half > 0.0 && half.is_finite()) {
        return Err(Error::bad_input("ground", "the scene has no extent", "leave it out"));
    }
    let (centre, height) = ((low + high) / 2.0, low.y);
    let at = |x: f32, z: f32| Vec3::new(x * half, 0.0, z * half);
    let mesh = quad([at(-1.0, 1.0), at(1.0, 1.0), at(1.0, -1.0), at(-1.0, -1.0)], Vec3::splat(0.8));
    let mut part = Part::drawn(GROUND.into(), mesh);
    part.model = DMat4::from_translation(DVec3::new(centre.x, height, centre.z));
    scene.parts.push(part);
    scene.notes.push(format!("a ground plane {size} wide is added at y = {height}"));
    Ok(())
}

/// Whether a part is the one called `name`, or one of the pieces `name#…` of it.
pub(super) fn is_called(part: &Part, name: &str) -> bool {
    part.name == name || part.name.split('#').next() == Some(name)
}

/// Refuses a focus that no part has.
pub(super) fn known_focus(scene: &LoadedScene, name: &str) -> Result<()> {
    if scene.parts.iter().any(|part| is_called(part, name)) {
        return Ok(());
    }
    let names: BTreeSet<&str> =
        scene.parts.iter().filter_map(|part| part.name.split('#').next()).collect();
    let few: Vec<&str> = names.iter().copied().take(12).collect();
    let more = if names.len() > few.len() { ", ..." } else { "" };
    Err(Error::bad_input(
        format!("focus '{name}'"),
        "is no object of the scene",
        format!("use one of {}{more}", few.join(", ")),
    ))
}

/// Vertices of all parts that no triangle names.
pub(super) fn strays(scene: &LoadedScene) -> usize {
    let mut counted = BTreeSet::new();
    let once = scene.parts.iter().filter(|part| counted.insert(std::sync::Arc::as_ptr(&part.mesh)));
    once.map(|part| part.mesh.positions.len() - named(&part.mesh).filter(|&named| named).count())
        .sum()
}

/// Whether each vertex is named by a triangle.
fn named(mesh: &Mesh) -> impl Iterator<Item = bool> + use<> {
    let mut named = vec![false; mesh.positions.len()];
    for &v in mesh.triangles.iter().flatten() {
        if let Some(named) = named.get_mut(v as usize) {
            *named = true;
        }
    }
    named.into_iter()
}

impl Part {
    /// The world positions of the vertices that triangles name, f64.
    pub(crate) fn drawn_points(&self) -> impl Iterator<Item = DVec3> + '_ {
        let named = named(&self.mesh).enumerate().filter(|(_, named)| *named);
        named.map(|(v, _)| self.model.transform_point3(self.mesh.at(v)))
    }
}
