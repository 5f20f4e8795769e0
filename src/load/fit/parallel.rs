//! Boxes of directional lights: stated from where the light stands, or fitted along it.

use super::light::{Fit, Lit};
use super::{MARGIN, place, unit, up_for};
use crate::LoadedShadow;
use glam::DVec3;
use gnomon_core::view::{Projection, View, length};
use gnomon_core::{Error, Result};

impl Fit<'_> {
    /// Keys that say nothing of parallel light.
    fn parallel(&self) -> Result<()> {
        let given = self.given();
        let keys = [("light.fovy", given.fovy.is_some()), ("light.range", given.range.is_some())];
        let fix = "leave it out, or give light.position for a spot";
        self.settings.idle(&keys, "has no effect on a directional light", fix)
    }

    /// Left, right, bottom and top of the box that the settings, else the file, state.
    fn sides(&self, shadow: Option<&LoadedShadow>) -> Result<Option<[f64; 4]>> {
        let given = self.given();
        let sides = [given.left, given.right, given.bottom, given.top];
        let size = [given.width, given.height];
        match (sides, size) {
            ([None, None, None, None], [None, None]) => Ok(shadow.and_then(|shadow| shadow.sides)),
            ([Some(left), Some(right), Some(bottom), Some(top)], [None, None]) => {
                for (key, low, high) in [("light.left", left, right), ("light.bottom", bottom, top)]
                {
                    if low >= high {
                        let reason = format!("{low} is not below {high}, the opposite side");
                        return Err(Error::bad_input(key, reason, "give low < high"));
                    }
                }
                Ok(Some([left, right, bottom, top]))
            }
            ([None, None, None, None], _) => {
                let [width, height] = [size[0].or(size[1]), size[1].or(size[0])];
                let half = |x: Option<f64>| x.unwrap_or(0.0) / 2.0;
                Ok(Some([-half(width), half(width), -half(height), half(height)]))
            }
            _ => {
                let keys = given.box_keys();
                let key = keys.iter().find(|(_, given)| given.is_some()).map_or("light", |k| k.0);
                let fix = "give all of left, right, bottom and top, or width and height alone";
                Err(Error::bad_input(key, "is a part of a box that is not whole", fix))
            }
        }
    }

    /// A directional light that stands somewhere: three.js' DirectionalLightShadow where its box is stated,
    /// else the tightest box around what is in focus.
    pub(super) fn standing(
        &mut self,
        position: DVec3,
        target: DVec3,
        shadow: Option<&LoadedShadow>,
    ) -> Result<Lit> {
        self.parallel()?;
        let given = self.given();
        let direction = unit(target - position, "light.target")?;
        let parallel = length(DVec3::Y.cross(direction)) <= 1e-12;
        let usual = if parallel { DVec3::NEG_Z } else { DVec3::Y };
        let up = given.up.map_or(usual, DVec3::from_array);
        let right = unit(direction.cross(up), "light.up")?;
        let above = right.cross(direction);
        let fitted = |axis: DVec3| {
            let ((low, high), at) = (self.bounds.along(axis), position.dot(axis));
            let margin = (high - low) * MARGIN;
            [low - at - margin, high - at + margin]
        };
        let sides = match self.sides(shadow)? {
            Some(sides) => sides,
            None => {
                let ([left, right], [bottom, top]) = (fitted(right), fitted(above));
                [left, right, bottom, top]
            }
        };
        let (first, last) = self.bounds.depth(direction);
        let (at, margin) = (position.dot(direction), (last - first) * MARGIN);
        let near = given.near.or(shadow.map(|s| s.near)).unwrap_or(first - at - margin);
        let far = given.far.or(shadow.map(|s| s.far)).unwrap_or(last - at + margin);
        let [l, r, b, t] = sides;
        self.notes.push(format!(
            "light at {}, looking along {}: box left {l}, right {r}, bottom {b}, top {t}, near {near}, \
             far {far} from the light, fitted where not given",
            place(position),
            place(direction)
        ));
        // A projection is centred: the eye steps aside to the middle of the box.
        let aside = right * ((l + r) / 2.0) + above * ((b + t) / 2.0);
        let view = View { position: position + aside, target: target + aside, up };
        let projection = Projection::Orthographic { width: r - l, height: t - b, near, far };
        self.mapped(view, projection, None, shadow)
    }

    /// A directional light without a place: the tightest box along it. Where near or far are stated its
    /// near plane touches the scene.
    pub(super) fn along(&mut self, direction: DVec3, shadow: Option<&LoadedShadow>) -> Result<Lit> {
        self.parallel()?;
        let (bounds, given) = (self.bounds, self.given());
        let sides = given.box_keys();
        if let Some((key, _)) = sides.iter().take(4).find(|(_, given)| given.is_some()) {
            let reason = "counts from the light's position, which is not given";
            return Err(Error::bad_input(*key, reason, "give light.position, or width and height"));
        }
        let fix = "give light.position, or leave it out";
        let reason = "has no effect on a directional light without a position";
        self.settings.idle(&[("light.target", given.target.is_some())], reason, fix)?;
        let up = up_for(given.up, direction);
        let right = unit(direction.cross(up), "light.up")?;
        let above = right.cross(direction);
        let (x, y) = (bounds.along(right), bounds.along(above));
        let (first, last) = bounds.depth(direction);
        let middle = right * ((x.0 + x.1) / 2.0) + above * ((y.0 + y.1) / 2.0);
        let depth = (last - first).max(bounds.radius * 1e-6);
        let (near, far) = (given.near, given.far);
        let stand_off = match (near, far) {
            (None, None) => bounds.radius,
            (near, _) => near.unwrap_or(0.0) + MARGIN * depth,
        };
        let position = middle + direction * (first - stand_off);
        let size = self.size(shadow)?;
        // Texels are square: a map that is wider than high takes a wider box.
        let ratio = f64::from(size[0]) / f64::from(size[1]);
        let fitted = (x.1 - x.0).max((y.1 - y.0) * ratio) * (1.0 + 2.0 * MARGIN);
        let width = given.width.or(given.height).unwrap_or(fitted);
        let height = given.height.or(given.width).unwrap_or(fitted / ratio);
        let near = near.unwrap_or(stand_off - MARGIN * depth);
        let far = far.unwrap_or(stand_off + depth * (1.0 + MARGIN));
        self.notes.push(format!(
            "light box: {width} wide, {height} high, along {}, depth from {near} to {far} from a point \
             {stand_off} before the scene, fitted where not given",
            place(direction)
        ));
        let projection = Projection::Orthographic { width, height, near, far };
        let view = View { position, target: position + direction * bounds.radius, up };
        self.mapped(view, projection, None, shadow)
    }
}
