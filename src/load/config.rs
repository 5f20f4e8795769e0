//! The small TOML beside a scene file: light, camera, map and look-up that the file does not say.

mod camera;
mod light;
mod origin;
mod strict;

pub use camera::{CameraSettings, CameraType};
use gnomon_core::depth::{DepthFormat, Packing};
use gnomon_core::device::DeviceProfile;
use gnomon_core::scene::{CompareRule, CullRule, Filter, TexelFormat, Wrap};
use gnomon_core::{Error, Result};
pub(crate) use light::no_cube;
pub use light::{LightSettings, LightType};
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
    /// What else the program does.
    pub pipeline: PipelineSettings,
    /// Width and height of the picture in pixels.
    #[serde(deserialize_with = "strict::pair")]
    pub canvas: Option<[u32; 2]>,
    /// Whether a receiver plane is added under the scene.
    pub ground: bool,
    /// The object that light and camera are fitted to, instead of all; everything still casts.
    pub focus: Option<String>,
    /// Device profile.
    pub device: Option<String>,
    /// Where they were written.
    #[serde(skip)]
    pub origin: Origin,
}

/// A map.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct MapSettings {
    /// Width and height in texels; one number makes a square.
    #[serde(deserialize_with = "strict::size")]
    pub size: Option<[u32; 2]>,
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

/// The arithmetic of the program.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct PipelineSettings {
    /// Order in which matrices multiply, by the name of its chain.
    pub chain: Option<String>,
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

    /// A light of the command line stands above the file's, whose keys for another light go.
    pub fn override_light(&mut self, direction: Option<[f64; 3]>, position: Option<[f64; 3]>) {
        let LightSettings { up, near, far, fovy, range, width, height, .. } = self.light;
        let kept = LightSettings { direction, position, up, near, far, ..LightSettings::default() };
        self.light = match position {
            Some(_) => LightSettings { fovy, range, ..kept },
            None => LightSettings { width, height, ..kept },
        };
        self.origin.override_by("light.direction", "--light-dir (light.direction)");
        self.origin.override_by("light.position", "--light-pos (light.position)");
    }

    /// A light of the scene file, chosen on the command line, stands above the settings' own.
    pub fn choose_light(&mut self, name: &str) {
        let LightSettings { up, near, far, fovy, range, width, height, .. } = self.light;
        let name = Some(name.to_string());
        let of_map =
            LightSettings { up, near, far, fovy, range, width, height, ..Default::default() };
        self.light = LightSettings { name, ..of_map };
        self.origin.override_by("light.name", "--light (light.name)");
    }

    /// A camera of the scene file, chosen on the command line, stands above the settings' own.
    pub fn choose_camera(&mut self, name: &str) {
        let CameraSettings { near, far, .. } = self.camera;
        let name = Some(name.to_string());
        self.camera = CameraSettings { name, near, far, ..CameraSettings::default() };
        self.origin.override_by("camera.name", "--camera (camera.name)");
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

/// The member called `text`, or the default.
pub(crate) fn parsed<T: FromStr<Err = Error>>(
    key: &str,
    text: &Option<String>,
    default: T,
) -> Result<T> {
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
