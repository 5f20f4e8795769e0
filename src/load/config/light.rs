//! The light of the settings: its kind, where it stands and looks, and the box or cone of its map.

use super::{parsed, strict};
use gnomon_core::{Error, Result};
use serde::Deserialize;

gnomon_core::catalogue! {
    /// What a light is, as engines name it.
    pub enum LightType {
        /// Parallel rays; a position is that of its shadow camera.
        Directional = "directional",
        /// A cone.
        Spot = "spot",
        /// Into all directions, by a cube of maps.
        Point = "point",
    }
}

/// A light. A direction makes it directional, a position a spot, unless `type` or a box says otherwise.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct LightSettings {
    /// `directional`, `spot` or `point`.
    #[serde(rename = "type")]
    pub kind: Option<String>,
    /// Name or number of a light of the scene file.
    pub name: Option<String>,
    /// Where it shines.
    #[serde(deserialize_with = "strict::vector")]
    pub direction: Option<[f64; 3]>,
    /// Where a spot, or the shadow camera of a directional light, stands.
    #[serde(deserialize_with = "strict::vector")]
    pub position: Option<[f64; 3]>,
    /// What it looks at from there.
    #[serde(deserialize_with = "strict::vector")]
    pub target: Option<[f64; 3]>,
    /// Up of the map.
    #[serde(deserialize_with = "strict::vector")]
    pub up: Option<[f64; 3]>,
    /// Full cone angle of a spot in degrees: the field of view of its map.
    #[serde(deserialize_with = "strict::number")]
    pub fovy: Option<f64>,
    /// Reach of a spot in world units: its far plane, where none is given.
    #[serde(deserialize_with = "strict::number")]
    pub range: Option<f64>,
    /// Width of a directional light's box.
    #[serde(deserialize_with = "strict::number")]
    pub width: Option<f64>,
    /// Height of that box; the width where it is not given.
    #[serde(deserialize_with = "strict::number")]
    pub height: Option<f64>,
    /// Left side of the box, from the line of sight.
    #[serde(deserialize_with = "strict::number")]
    pub left: Option<f64>,
    /// Right side.
    #[serde(deserialize_with = "strict::number")]
    pub right: Option<f64>,
    /// Upper side.
    #[serde(deserialize_with = "strict::number")]
    pub top: Option<f64>,
    /// Lower side.
    #[serde(deserialize_with = "strict::number")]
    pub bottom: Option<f64>,
    /// Near plane, from the light.
    #[serde(deserialize_with = "strict::number")]
    pub near: Option<f64>,
    /// Far plane, from the light.
    #[serde(deserialize_with = "strict::number")]
    pub far: Option<f64>,
}

impl LightSettings {
    /// The keys of a box with what they say, sides first.
    #[must_use]
    pub const fn box_keys(&self) -> [(&'static str, Option<f64>); 6] {
        [
            ("light.left", self.left),
            ("light.right", self.right),
            ("light.bottom", self.bottom),
            ("light.top", self.top),
            ("light.width", self.width),
            ("light.height", self.height),
        ]
    }

    /// Whether anything is said of a directional light's box.
    #[must_use]
    pub fn has_box(&self) -> bool {
        self.box_keys().iter().any(|(_, given)| given.is_some())
    }

    /// The kind that the settings state: the type's, else that of a direction, of a position with a box,
    /// or of a position; `None` leaves it to the scene file.
    ///
    /// # Errors
    /// [`Error::BadInput`] for an unknown type, a point light, or a direction and a position without a
    /// type.
    pub fn stated(&self) -> Result<Option<LightType>> {
        let kind = match &self.kind {
            Some(_) => Some(parsed("light.type", &self.kind, LightType::Directional)?),
            None => None,
        };
        match kind {
            Some(LightType::Point) => Err(no_cube("light.type")),
            Some(kind) => Ok(Some(kind)),
            None => match (self.direction, self.position) {
                (Some(_), Some(_)) if !self.has_box() => Err(Error::bad_input(
                    "light.direction/position",
                    "may be a directional light or a spot, since a position is given too",
                    "add light.type = \"directional\" or \"spot\"",
                )),
                (Some(_), _) => Ok(Some(LightType::Directional)),
                (None, Some(_)) if self.has_box() => Ok(Some(LightType::Directional)),
                (None, Some(_)) => Ok(Some(LightType::Spot)),
                (None, None) => Ok(None),
            },
        }
    }
}

/// The complaint about a light that needs six maps.
pub(crate) fn no_cube(place: &str) -> Error {
    Error::bad_input(
        place,
        "is a point light, whose cube of maps is not measured yet",
        "measure one face: light.type = \"spot\" with fovy = 90 and a target",
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stated(text: &str) -> Result<Option<LightType>> {
        let light: LightSettings = toml::from_str(text).expect("sound TOML");
        light.stated()
    }

    #[test]
    fn a_kind_is_stated_or_follows_from_the_keys() {
        for (text, kind) in [
            ("", None),
            ("direction = [0, -1, 0]", Some(LightType::Directional)),
            ("position = [0, 1, 0]", Some(LightType::Spot)),
            ("position = [0, 1, 0]\nwidth = 3", Some(LightType::Directional)),
            ("position = [0, 1, 0]\ntop = 3", Some(LightType::Directional)),
            ("type = \"spot\"\nposition = [0, 1, 0]\nwidth = 3", Some(LightType::Spot)),
            ("type = \"directional\"\nposition = [0, 1, 0]", Some(LightType::Directional)),
        ] {
            assert_eq!(stated(text).expect(text), kind, "{text}");
        }
        for (text, word) in [
            ("direction = [0, -1, 0]\nposition = [0, 1, 0]", "light.type"),
            ("type = \"point\"\nposition = [0, 1, 0]", "90"),
            ("type = \"sun\"", "directional, spot, point"),
        ] {
            let message = stated(text).expect_err(text).to_string();
            assert!(message.contains(word), "{text}: {message}");
        }
    }
}
