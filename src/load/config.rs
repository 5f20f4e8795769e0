//! The small TOML beside a scene file: light, camera, map and look-up that the file does not say.

mod origin;
mod strict;

use gnomon_core::depth::{DepthFormat, Packing};
use gnomon_core::device::DeviceProfile;
use gnomon_core::scene::{CompareRule, CullRule, Filter, TexelFormat, Wrap};
use gnomon_core::{Error, Result};
pub use origin::Origin;
use serde::Deserialize;
use std::str::FromStr;

/// Settings of a user's scene; whatever is absent is fitted or defaulted.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Settings {
    /// The light with the map.
    pub light: LightSettings,
    /// The camera whose pixels are the receivers.
    pub camera: CameraSettings,
    /// The map.
    pub map: MapSettings,
    /// The look-up.
    pub lookup: LookupSettings,
    /// Width and height of the picture in pixels.
    #[serde(deserialize_with = "strict::pair")]
    pub canvas: Option<[u32; 2]>,
    /// Device profile.
    pub device: Option<String>,
    /// Where they were written.
    #[serde(skip)]
    pub origin: Origin,
}

/// A light: a direction makes it directional, a position a spot.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct LightSettings {
    /// Where a directional light shines.
    #[serde(deserialize_with = "strict::vector")]
    pub direction: Option<[f64; 3]>,
    /// Where a spot stands.
    #[serde(deserialize_with = "strict::vector")]
    pub position: Option<[f64; 3]>,
    /// What a spot looks at.
    #[serde(deserialize_with = "strict::vector")]
    pub target: Option<[f64; 3]>,
    /// Up of the map.
    #[serde(deserialize_with = "strict::vector")]
    pub up: Option<[f64; 3]>,
    /// Field of view of a spot in degrees.
    #[serde(deserialize_with = "strict::number")]
    pub fovy: Option<f64>,
    /// Width of a directional light's box.
    #[serde(deserialize_with = "strict::number")]
    pub width: Option<f64>,
    /// Near plane.
    #[serde(deserialize_with = "strict::number")]
    pub near: Option<f64>,
    /// Far plane.
    #[serde(deserialize_with = "strict::number")]
    pub far: Option<f64>,
}

/// A camera.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct CameraSettings {
    /// The eye.
    #[serde(deserialize_with = "strict::vector")]
    pub position: Option<[f64; 3]>,
    /// What it looks at.
    #[serde(deserialize_with = "strict::vector")]
    pub target: Option<[f64; 3]>,
    /// Up.
    #[serde(deserialize_with = "strict::vector")]
    pub up: Option<[f64; 3]>,
    /// Vertical field of view in degrees.
    #[serde(deserialize_with = "strict::number")]
    pub fovy: Option<f64>,
    /// Near plane.
    #[serde(deserialize_with = "strict::number")]
    pub near: Option<f64>,
    /// Far plane.
    #[serde(deserialize_with = "strict::number")]
    pub far: Option<f64>,
}

/// A map.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct MapSettings {
    /// Texels per side.
    pub size: Option<u32>,
    /// Name of a depth format or packing.
    pub format: Option<String>,
    /// Faces left out of the map: none, front, back.
    pub cull: Option<String>,
}

/// A look-up.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct LookupSettings {
    /// Constant bias in window depth; positive repairs acne.
    #[serde(deserialize_with = "strict::float")]
    pub bias: Option<f32>,
    /// Filter name.
    pub filter: Option<String>,
    /// Comparison rule.
    pub compare: Option<String>,
    /// What happens outside the map.
    pub wrap: Option<String>,
}

impl Settings {
    /// Parses TOML text; `place` names it in complaints.
    ///
    /// # Errors
    /// [`Error::BadInput`] naming place, line and key.
    pub fn parse(place: &str, text: &str) -> Result<Self> {
        let mut settings: Self = toml::from_str(text).map_err(|e| {
            let line = e.span().map_or(1, |span| text[..span.start].matches('\n').count() + 1);
            let reason = e.message().replace('\n', " ");
            Error::bad_input(format!("{place}: line {line}"), reason, "see the README for the keys")
        })?;
        settings.origin = Origin::of(place, text);
        Ok(settings)
    }

    /// A light of the command line stands above the file's, whose keys for the other kind of light go.
    pub fn override_light(&mut self, direction: Option<[f64; 3]>, position: Option<[f64; 3]>) {
        if direction.is_some() {
            (self.light.target, self.light.fovy) = (None, None);
        }
        if position.is_some() {
            self.light.width = None;
        }
        (self.light.direction, self.light.position) = (direction, position);
        self.origin.override_by("light.direction", "--light-dir (light.direction)");
        self.origin.override_by("light.position", "--light-pos (light.position)");
    }

    /// Refuses the first of the given `keys` that is there: it would say nothing.
    ///
    /// # Errors
    /// [`Error::BadInput`] with its line, the reason and what to do.
    pub(super) fn idle(&self, keys: &[(&str, bool)], reason: &str, fix: &str) -> Result<()> {
        match keys.iter().find(|(_, given)| *given) {
            Some((key, _)) => Err(Error::bad_input(self.origin.at(key), reason, fix)),
            None => Ok(()),
        }
    }

    /// The texel format, f32 by default.
    ///
    /// # Errors
    /// [`Error::BadInput`] listing formats and packings.
    pub fn texel(&self) -> Result<TexelFormat> {
        let Some(name) = &self.map.format else { return Ok(TexelFormat::Depth(DepthFormat::F32)) };
        let format = DepthFormat::from_str(name).map(TexelFormat::Depth);
        format.or_else(|_| Packing::from_str(name).map(TexelFormat::Packed)).map_err(|_| {
            let formats = DepthFormat::ALL.iter().map(|f| f.name());
            let names: Vec<_> = formats.chain(Packing::ALL.iter().map(|p| p.name())).collect();
            Error::bad_input(
                format!("map.format '{name}'"),
                "is no known depth format or packing",
                format!("use one of {}", names.join(", ")),
            )
        })
    }

    /// Filter, comparison, wrap, cull and device by name, or their defaults.
    ///
    /// # Errors
    /// [`Error::BadInput`] listing the names.
    pub fn choices(&self) -> Result<(Filter, CompareRule, Wrap, CullRule, DeviceProfile)> {
        Ok((
            parsed("lookup.filter", &self.lookup.filter, Filter::Nearest)?,
            parsed("lookup.compare", &self.lookup.compare, CompareRule::ReceiverBeyond)?,
            parsed("lookup.wrap", &self.lookup.wrap, Wrap::Clamp)?,
            parsed("map.cull", &self.map.cull, CullRule::None)?,
            parsed("device", &self.device, DeviceProfile::Ideal)?,
        ))
    }
}

fn parsed<T: FromStr<Err = Error>>(key: &str, text: &Option<String>, default: T) -> Result<T> {
    text.as_ref().map_or(Ok(default), |text| {
        text.parse().map_err(|e| {
            let Error::BadInput { place, reason, fix } = e else { return e };
            Error::bad_input(format!("{key} {place}"), reason, fix)
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mistakes_name_line_and_key() {
        let complaint = |text: &str| Settings::parse("s.toml", text).unwrap_err().to_string();
        let text = complaint("[light]\nposition = [1, 2, 3]\nbrightness = 3\n");
        assert!(text.starts_with("s.toml: line 3") && text.contains("brightness"), "{text}");
        let text = complaint("canvas = \"big\"\n");
        assert!(text.contains("line 1"), "{text}");
        let settings = Settings::parse("s.toml", "[map]\nformat = \"d17\"\n").expect("parses");
        let text = settings.texel().unwrap_err().to_string();
        assert!(text.contains("unorm16") && text.contains("book"), "{text}");
    }
}
