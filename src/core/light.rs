//! Lights: where their rays come from, which maps they have, and which of these a receiver looks up.

mod choice;
mod layout;
mod map;

use crate::view::{self, ClipSpace, Projection, View};
use crate::{Error, Result};
pub use choice::{Choice, Chosen, Lookup, PlaceInMaps};
use glam::DVec3;
pub use layout::{Layout, Rect};
pub use map::{Lens, Map, Viewport};

crate::catalogue! {
    /// Where the rays of a light come from.
    pub enum Rays {
        /// One direction: a sun.
        Parallel = "parallel",
        /// One point: a spot, where it has a cone, or a point light.
        FromPoint = "from a point",
    }
}

/// A light with its maps and the choice among them.
///
/// Fields are private, so that a light moves with all its maps and no choice names a map that it has not.
#[derive(Clone, Debug, PartialEq)]
pub struct Light {
    eye: View,
    rays: Rays,
    cone_cos: Option<f64>,
    maps: Vec<Map>,
    choice: Choice,
}

impl Light {
    /// A light with one map that looks from where it stands, in OpenGL's clip space: its rays are parallel
    /// where the projection is orthographic. `cone_cos` is the cosine of the angle from the axis beyond
    /// which a spot gives no light.
    #[must_use]
    pub fn new(eye: View, projection: Projection, cone_cos: Option<f64>) -> Self {
        let rays = match projection {
            Projection::Orthographic { .. } => Rays::Parallel,
            Projection::Perspective { .. } => Rays::FromPoint,
        };
        let maps = vec![Map::new(eye, projection)];
        Self { eye, rays, cone_cos, maps, choice: Choice::Only }
    }

    /// This light with other maps and a choice among them.
    ///
    /// # Errors
    /// [`Error::BadInput`] where there is no map, a map does not look from the point that the rays come
    /// from, or the choice does not fit the list.
    pub fn with_maps(self, maps: Vec<Map>, choice: Choice) -> Result<Self> {
        if maps.is_empty() {
            return Err(Error::bad_input("light.maps", "is empty", "give at least one map"));
        }
        for (i, map) in maps.iter().enumerate() {
            map.checked(&format!("light.maps[{i}]"))?;
            if self.rays == Rays::FromPoint && map.view.position != self.eye.position {
                return Err(Error::bad_input(
                    format!("light.maps[{i}].view.position"),
                    "is not where the light stands",
                    "let all maps of a spot or point light look from its position",
                ));
            }
        }
        if maps.iter().any(|map| map.clip.reversed) && !maps.iter().all(|map| map.clip.reversed) {
            return Err(Error::bad_input(
                "light.maps",
                "are reversed in part, but one comparison serves all of them",
                "reverse the depth of all maps or of none",
            ));
        }
        if let Some([a, b]) = overlapping(&maps) {
            return Err(Error::bad_input(
                format!("light.maps[{b}].viewport"),
                format!("and that of map {a} overlap"),
                "give each map its own part of a texture, or a texture (layer) of its own",
            ));
        }
        choice.checked(maps.len())?;
        Ok(Self { maps, choice, ..self })
    }

    /// This light in other clip spaces, one rule for all its maps.
    #[must_use]
    pub fn in_clip_space(mut self, clip: ClipSpace) -> Self {
        self.maps.iter_mut().for_each(|map| map.clip = clip);
        self
    }

    /// The light and all its maps with other eyes and projections: what moves a light or makes it larger.
    #[must_use]
    pub fn remade(
        &self,
        view: impl Fn(View) -> View,
        projection: impl Fn(Projection) -> Projection,
    ) -> Self {
        let mut light = Self { eye: view(self.eye), ..self.clone() };
        for map in &mut light.maps {
            (map.view, map.projection) = (view(map.view), projection(map.projection));
        }
        light
    }

    /// The light moved by an offset, world units.
    #[must_use]
    pub fn moved(&self, by: DVec3) -> Self {
        let view = |v: View| View { position: v.position + by, target: v.target + by, ..v };
        self.remade(view, |projection| projection)
    }

    /// Where the light stands and looks.
    #[must_use]
    pub const fn eye(&self) -> &View {
        &self.eye
    }

    /// Where its rays come from.
    #[must_use]
    pub const fn rays(&self) -> Rays {
        self.rays
    }

    /// Its maps; at least one.
    #[must_use]
    pub fn maps(&self) -> &[Map] {
        &self.maps
    }

    /// Its map, where it has one alone.
    #[must_use]
    pub fn only_map(&self) -> Option<&Map> {
        match self.maps.as_slice() {
            [map] => Some(map),
            _ => None,
        }
    }

    /// Which of them a receiver looks up.
    #[must_use]
    pub const fn choice(&self) -> &Choice {
        &self.choice
    }

    /// The look-ups of a place: one, or two whose visibilities are mixed by weight.
    #[must_use]
    pub fn lookups<L: FromIterator<Lookup>>(&self, place: &PlaceInMaps<'_>) -> L {
        let chosen = self.choice.among(&self.maps, place).into_iter().flatten();
        chosen
            .map(|Chosen { map, weight }| Lookup { map, coord: place.coords[map], weight })
            .collect()
    }

    /// Where the texels of its maps lie, if the longest side of a whole texture has `side` texels.
    #[must_use]
    pub fn layout(&self, side: u32) -> Layout {
        Layout::new(&self.maps, side)
    }

    /// Cosine of the angle from the axis beyond which a spot gives no light, if it has a cone.
    #[must_use]
    pub const fn cone_cos(&self) -> Option<f64> {
        self.cone_cos
    }

    /// Whether all rays share a direction.
    #[must_use]
    pub fn is_directional(&self) -> bool {
        self.rays == Rays::Parallel
    }

    /// Unit vector from a world point towards the light.
    #[must_use]
    pub fn direction_from(&self, p_world: DVec3) -> DVec3 {
        match self.rays {
            Rays::Parallel => self.eye.backward(),
            Rays::FromPoint => {
                let to_light = self.eye.position - p_world;
                to_light / view::length(to_light)
            }
        }
    }

    /// Whether a world point lies in the spot's cone (always true without one).
    #[must_use]
    pub fn in_cone(&self, p_world: DVec3) -> bool {
        self.cone_cos
            .is_none_or(|limit| self.direction_from(p_world).dot(self.eye.backward()) >= limit)
    }
}

/// Two maps whose viewports share a part of a texture.
fn overlapping(maps: &[Map]) -> Option<[usize; 2]> {
    let meet = |a: &Viewport, b: &Viewport| {
        let [p, q] = [a.parts, b.parts].map(u64::from);
        let before = |x: u32, y: u32| u64::from(x) * q < u64::from(y) * p;
        let shares = |k: usize| {
            before(a.low[k], b.high[k]) && {
                let after = |x: u32, y: u32| u64::from(x) * p < u64::from(y) * q;
                after(b.low[k], a.high[k])
            }
        };
        a.layer == b.layer && shares(0) && shares(1)
    };
    let pairs = (0..maps.len()).flat_map(|b| (0..b).map(move |a| [a, b]));
    pairs.into_iter().find(|&[a, b]| meet(&maps[a].viewport, &maps[b].viewport))
}
