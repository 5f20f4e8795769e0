//! How the triangles of a scene are there: which sides each pass draws, which cast, where they have holes.

use super::alpha::Mask;
use super::{Cull, CullRule, Object, Sides, Surface};
use glam::Vec2;
use std::ops::Range;
use std::sync::Arc;

/// The surfaces of all objects of a scene, by triangle: data that subject and truth share.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Surfaces {
    /// One an object; empty where every one has both sides and no holes, casts, and is not mirrored.
    coats: Vec<Coat>,
    /// Texture coordinates by vertex; empty where nothing has holes.
    uvs: Vec<Vec2>,
    /// The object of each triangle that has holes, else [`SOLID`]; empty where none has.
    masked: Vec<u16>,
}

/// The object of a triangle without holes.
const SOLID: u16 = u16::MAX;

/// The surface of one object.
#[derive(Clone, Debug, PartialEq)]
struct Coat {
    /// Its triangles.
    ids: Range<u32>,
    surface: Surface,
    /// Whether its model matrix turns counter-clockwise triangles clockwise.
    mirrored: bool,
}

/// Which faces a pass leaves out of each triangle.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Culls {
    /// Every triangle alike.
    Alike(Cull),
    /// By triangle id; `None` leaves the triangle out.
    Each(Arc<[Option<Cull>]>),
}

impl Culls {
    /// The faces left out of a triangle; `None` where it is not drawn at all.
    #[must_use]
    pub fn of(&self, id: u32) -> Option<Cull> {
        match self {
            Self::Alike(cull) => Some(*cull),
            Self::Each(culls) => culls[id as usize],
        }
    }

    /// Whether both faces of every triangle are drawn that is drawn at all.
    #[must_use]
    pub fn is_nothing(&self) -> bool {
        match self {
            Self::Alike(cull) => *cull == Cull::None,
            Self::Each(culls) => culls.iter().all(|cull| cull.is_none_or(|c| c == Cull::None)),
        }
    }

    /// Faces by triangle, or the same of all where they agree.
    fn each(culls: impl Iterator<Item = Option<Cull>>) -> Self {
        let culls: Arc<[_]> = culls.collect();
        match culls.split_first() {
            Some((Some(first), rest)) if rest.iter().all(|c| *c == Some(*first)) => {
                Self::Alike(*first)
            }
            _ => Self::Each(culls),
        }
    }
}

/// Whether front and back are drawn, as what is left out; `None` where neither is.
const fn left_out([front, back]: [bool; 2]) -> Option<Cull> {
    match (front, back) {
        (true, true) => Some(Cull::None),
        (true, false) => Some(Cull::Back),
        (false, true) => Some(Cull::Front),
        (false, false) => None,
    }
}

/// Whether front and back are drawn where a pass leaves out faces of every object alike.
const fn drawn_under(cull: Cull) -> [bool; 2] {
    match cull {
        Cull::None => [true; 2],
        Cull::Front => [false, true],
        Cull::Back => [true, false],
    }
}

/// Whether a material draws front and back.
const fn drawn_by(sides: Sides) -> [bool; 2] {
    match sides {
        Sides::Front => [true, false],
        Sides::Back => [false, true],
        Sides::Both => [true; 2],
    }
}

impl Coat {
    /// What is left out of faces as they turn, if these sides are drawn.
    fn turned(&self, [front, back]: [bool; 2]) -> Option<Cull> {
        left_out(if self.mirrored { [back, front] } else { [front, back] })
    }

    fn in_map(&self, rule: CullRule) -> Option<Cull> {
        let [front, back] = drawn_by(self.surface.sides);
        let drawn = match rule {
            CullRule::None => drawn_under(Cull::None),
            CullRule::Front => drawn_under(Cull::Front),
            CullRule::Back => drawn_under(Cull::Back),
            CullRule::Material => [front, back],
            CullRule::MaterialOpposite => [back, front],
        };
        self.turned(drawn).filter(|_| self.surface.casts)
    }

    fn in_picture(&self, cull: Cull) -> Option<Cull> {
        let ([front, back], [f, b]) = (drawn_by(self.surface.sides), drawn_under(cull));
        self.turned([front && f, back && b])
    }
}

impl Surfaces {
    /// The surfaces of objects in drawing order.
    #[must_use]
    pub fn of(objects: &[Object]) -> Self {
        let mut next = 0;
        let coat = |object: &Object| {
            let first = next;
            next += object.mesh.triangles.len() as u32;
            let mirrored = object.model.determinant() < 0.0;
            Coat { ids: first..next, surface: object.surface.clone(), mirrored }
        };
        let coats: Vec<Coat> = objects.iter().map(coat).collect();
        let is_plain = |coat: &Coat| !coat.mirrored && coat.surface == Surface::default();
        if coats.iter().all(is_plain) {
            return Self::default();
        }
        if coats.iter().all(|coat| coat.surface.mask.is_none()) {
            return Self { coats, ..Self::default() };
        }
        let masked = coats.iter().enumerate().flat_map(|(k, coat)| {
            let object = if coat.surface.mask.is_some() { k as u16 } else { SOLID };
            std::iter::repeat_n(object, coat.ids.len())
        });
        let uvs = objects.iter().flat_map(|object| {
            let uv = |v| object.mesh.uvs.get(v).copied().unwrap_or_default();
            (0..object.mesh.positions.len()).map(uv)
        });
        Self { masked: masked.collect(), uvs: uvs.collect(), coats }
    }

    /// Whether anything has holes.
    #[must_use]
    pub const fn have_holes(&self) -> bool {
        !self.masked.is_empty()
    }

    /// Whether an object casts and has holes.
    #[must_use]
    pub fn casts_with_holes(&self, object: u16) -> bool {
        let coat = self.coats.get(usize::from(object));
        coat.is_some_and(|coat| coat.surface.casts && coat.surface.mask.is_some())
    }

    /// Where a triangle has holes; `None` where it has none.
    #[must_use]
    pub fn mask(&self, id: u32) -> Option<&Mask> {
        let object = *self.masked.get(id as usize).filter(|object| **object != SOLID)?;
        self.coats[usize::from(object)].surface.mask.as_deref()
    }

    /// The texture coordinates of three vertices; 0 where nothing has holes.
    #[must_use]
    pub fn uvs(&self, vertices: [u32; 3]) -> [Vec2; 3] {
        vertices.map(|v| self.uvs.get(v as usize).copied().unwrap_or_default())
    }

    /// Whether a triangle throws shadows.
    #[must_use]
    pub fn casts(&self, id: u32) -> bool {
        self.coat(id).is_none_or(|coat| coat.surface.casts)
    }

    /// Whether a triangle's front is the side that turns clockwise, its model being mirrored (glTF 2.0,
    /// 3.7.4).
    #[must_use]
    pub fn is_mirrored(&self, id: u32) -> bool {
        self.coat(id).is_some_and(|coat| coat.mirrored)
    }

    /// Whether shadows fall on the triangles of an object.
    #[must_use]
    pub fn receives(&self, object: u16) -> bool {
        self.coats.get(usize::from(object)).is_none_or(|coat| coat.surface.receives)
    }

    /// The triangles that throw shadows among the first `count`, all of them or runs of those; each run is
    /// with holes or without.
    #[must_use]
    pub fn casters(&self, count: u32) -> Vec<Range<u32>> {
        if self.coats.is_empty() {
            return std::iter::once(0..count).collect();
        }
        let holes = |ids: &Range<u32>| self.mask(ids.start).is_some();
        let mut runs: Vec<Range<u32>> = Vec::new();
        let casting = self.coats.iter().filter(|c| c.surface.casts && !c.ids.is_empty());
        for ids in casting.map(|coat| coat.ids.clone()) {
            match runs.last_mut() {
                Some(last) if last.end == ids.start && holes(last) == holes(&ids) => {
                    last.end = ids.end;
                }
                _ => runs.push(ids),
            }
        }
        runs
    }

    /// Which faces are left out of maps.
    #[must_use]
    pub fn culls(&self, rule: CullRule) -> Culls {
        if !self.coats.is_empty() {
            return self.each(|coat| coat.in_map(rule));
        }
        Culls::Alike(match rule {
            CullRule::None | CullRule::Material | CullRule::MaterialOpposite => Cull::None,
            CullRule::Front => Cull::Front,
            CullRule::Back => Cull::Back,
        })
    }

    /// Which faces are left out of a picture: those that the pass leaves out of all, and the sides that a
    /// material does not draw.
    #[must_use]
    pub fn picture_culls(&self, cull: Cull) -> Culls {
        match self.coats.is_empty() {
            true => Culls::Alike(cull),
            false => self.each(|coat| coat.in_picture(cull)),
        }
    }

    fn each(&self, of: impl Fn(&Coat) -> Option<Cull>) -> Culls {
        let each = self.coats.iter().flat_map(|c| std::iter::repeat_n(of(c), c.ids.len()));
        Culls::each(each)
    }

    fn coat(&self, id: u32) -> Option<&Coat> {
        self.coats.get(self.coats.partition_point(|coat| coat.ids.end <= id))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::shapes;
    use glam::{Mat4, Vec3};

    fn floor(surface: Surface, scale: f32) -> Object {
        let mesh = shapes::floor(1.0, Vec3::ONE);
        Object::new("floor", mesh, Mat4::from_scale(Vec3::new(scale, 1.0, 1.0)))
            .with_surface(surface)
    }

    fn sided(sides: Sides) -> Surface {
        Surface { sides, ..Surface::default() }
    }

    #[test]
    fn plain_objects_agree_and_cost_nothing() {
        let surfaces =
            Surfaces::of(&[floor(Surface::default(), 1.0), floor(Surface::default(), 1.0)]);
        assert_eq!(surfaces, Surfaces::default());
        assert_eq!(surfaces.culls(CullRule::Material), Culls::Alike(Cull::None));
        assert_eq!(surfaces.culls(CullRule::Front), Culls::Alike(Cull::Front));
        assert_eq!(surfaces.picture_culls(Cull::Back), Culls::Alike(Cull::Back));
        assert_eq!(surfaces.casters(4).into_iter().flatten().count(), 4);
    }

    #[test]
    fn a_map_follows_the_material_or_its_opposite() {
        let objects = Sides::ALL.iter().map(|&sides| floor(sided(sides), 1.0)).collect::<Vec<_>>();
        let surfaces = Surfaces::of(&objects);
        let of = |culls: Culls| [0, 2, 4].map(|id| culls.of(id));
        let (front, back, none) = (Some(Cull::Front), Some(Cull::Back), Some(Cull::None));
        assert_eq!(of(surfaces.culls(CullRule::Material)), [back, front, none]);
        assert_eq!(of(surfaces.culls(CullRule::MaterialOpposite)), [front, back, none]);
        assert_eq!(of(surfaces.culls(CullRule::Back)), [back; 3], "every object");
        assert_eq!(of(surfaces.picture_culls(Cull::None)), [back, front, none]);
        assert_eq!(of(surfaces.picture_culls(Cull::Back)), [back, None, back], "both leave out");
    }

    #[test]
    fn a_mirrored_model_turns_its_front() {
        let surfaces = Surfaces::of(&[floor(sided(Sides::Front), -1.0)]);
        assert_eq!(surfaces.picture_culls(Cull::None), Culls::Alike(Cull::Front));
        assert_eq!(surfaces.culls(CullRule::Back), Culls::Alike(Cull::Front));
    }

    #[test]
    fn runs_of_casters_leave_out_what_does_not_cast() {
        let silent = Surface { casts: false, ..Surface::default() };
        let (cast, silent) = (|| floor(Surface::default(), 1.0), || floor(silent.clone(), 1.0));
        let surfaces = Surfaces::of(&[cast(), cast(), silent(), cast()]);
        assert_eq!(surfaces.casters(8), [0..4, 6..8]);
        assert_eq!([3, 4, 5, 6].map(|id| surfaces.casts(id)), [true, false, false, true]);
        assert_eq!(surfaces.culls(CullRule::None).of(5), None);
        assert_eq!(surfaces.picture_culls(Cull::None), Culls::Alike(Cull::None));
    }
}
