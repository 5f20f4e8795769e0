//! Materials of three.js: the sides that they draw into the picture and into maps, and what of them is not
//! read.

use super::file::{Material, Materials};
use super::shape::Shape;
use glam::Vec3;
use gnomon_core::scene::Sides;
use std::collections::HashMap;

/// A material of the file, or three.js' default.
#[derive(Clone, Copy)]
pub(super) struct Drawn<'a>(Option<&'a Material>);

/// All materials by their ids, and the sides of those that cast.
pub(super) struct Library<'a> {
    materials: HashMap<&'a str, &'a Material>,
    /// Sides in the picture and in the map of every caster.
    casters: Vec<(Sides, Sides)>,
}

/// three.js' numbers of sides.
fn sides(number: u8) -> Sides {
    match number {
        0 => Sides::Front,
        1 => Sides::Back,
        _ => Sides::Both,
    }
}

/// The sides that three.js draws into a map of a material that says nothing of it.
fn opposite(sides: Sides) -> Sides {
    match sides {
        Sides::Front => Sides::Back,
        Sides::Back => Sides::Front,
        Sides::Both => Sides::Both,
    }
}

/// Rules by which a map leaves faces out, as `map.cull` names them, with the sides that they draw.
type Rule = (&'static str, fn(Sides) -> Sides);

/// three.js' own rule first.
const RULES: [Rule; 5] = [
    ("material-opposite", opposite),
    ("material", |sides| sides),
    ("none", |_| Sides::Both),
    ("back", |_| Sides::Front),
    ("front", |_| Sides::Back),
];

impl<'a> Library<'a> {
    pub(super) fn new(materials: &'a [Material]) -> Self {
        let materials = materials.iter().map(|m| (m.uuid.as_str(), m)).collect();
        Self { materials, casters: Vec::new() }
    }

    /// The material of this id.
    pub(super) fn of(&self, id: Option<&str>) -> Drawn<'a> {
        Drawn(id.and_then(|id| self.materials.get(id).copied()))
    }

    /// What is drawn of a shape: triangles by material. One material draws all of it; a list draws the
    /// groups, as three.js does.
    pub(super) fn drawn<'n>(
        &self,
        given: Option<&'n Materials>,
        shape: &Shape,
    ) -> Vec<(Option<&'n str>, Vec<[u32; 3]>)> {
        match given {
            None => vec![(None, shape.triangles.clone())],
            Some(Materials::One(id)) => vec![(Some(id), shape.triangles.clone())],
            Some(Materials::Each(ids)) => shape
                .groups
                .iter()
                .filter_map(|group| {
                    let of_group = shape.triangles.iter().skip(group.first).take(group.count);
                    Some((Some(ids.get(group.material)?.as_str()), of_group.copied().collect()))
                })
                .collect(),
        }
    }

    /// Notes that a material casts.
    pub(super) fn cast_by(&mut self, material: Drawn<'_>) {
        let both = (material.sides(), material.map_sides());
        if !self.casters.contains(&both) {
            self.casters.push(both);
        }
    }

    /// The rule by which the maps' faces are left out, and a word where no one rule holds for all casters.
    pub(super) fn cull(&self) -> (&'static str, Option<String>) {
        let holds = |(_, rule): &&Rule| self.casters.iter().all(|&(own, map)| rule(own) == map);
        match RULES.iter().find(holds) {
            Some((name, _)) => (name, None),
            None => {
                let word = "materials differ in shadowSide: the map is drawn by their sides alone";
                ("material-opposite", Some(word.to_string()))
            }
        }
    }
}

impl Drawn<'_> {
    pub(super) fn name(&self) -> &str {
        self.0.map_or("default", |m| if m.name.is_empty() { &m.uuid } else { &m.name })
    }

    pub(super) fn sides(&self) -> Sides {
        sides(self.0.map_or(0, |m| m.side))
    }

    /// The sides drawn into a map: `shadowSide`, else those opposite to the material's.
    fn map_sides(&self) -> Sides {
        self.0.and_then(|m| m.shadow_side).map_or_else(|| opposite(self.sides()), sides)
    }

    /// Whether anything is drawn as triangles.
    pub(super) fn is_drawn(&self) -> bool {
        self.0.is_none_or(|m| m.visible != Some(false) && !m.wireframe)
    }

    /// Whether light, and so a shadow, falls on it.
    pub(super) fn is_lit(&self) -> bool {
        const UNLIT: [&str; 4] =
            ["MeshBasicMaterial", "MeshNormalMaterial", "MeshMatcapMaterial", "MeshDepthMaterial"];
        self.0.is_none_or(|m| !UNLIT.contains(&m.kind.as_str()))
    }

    /// Its colour; sRGB as the file has it, taken as linear: pictures alone use it.
    pub(super) fn colour(&self) -> Vec3 {
        let hex = self.0.and_then(|m| m.color).unwrap_or(0xff_ffff);
        let [_, r, g, b] = hex.to_be_bytes();
        Vec3::new(f32::from(r), f32::from(g), f32::from(b)) / 255.0
    }

    /// What of it is not read and can change a shadow.
    pub(super) fn untold(&self) -> Vec<String> {
        let Some(m) = self.0 else { return Vec::new() };
        let cut = m.alpha_test > 0.0 && (m.map.is_some() || m.alpha_map.is_some());
        let found = [
            (cut, "holes by alphaTest are not cut"),
            (m.displacement_map.is_some(), "displacement maps are left out"),
            (m.clipping_planes.is_some(), "clipping planes are left out"),
            (m.wireframe, "wireframes are left out"),
            (
                matches!(m.kind.as_str(), "ShaderMaterial" | "RawShaderMaterial"),
                "a shader of its own may move vertices: not read",
            ),
        ];
        found.into_iter().filter(|found| found.0).map(|found| found.1.to_string()).collect()
    }
}
