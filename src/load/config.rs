//! The small TOML beside a scene file: light, camera, map and look-up that the file does not say.

use gnomon_core::depth::{DepthFormat, Packing};
use gnomon_core::device::DeviceProfile;
use gnomon_core::scene::{CompareRule, Cull, Filter, TexelFormat, Wrap};
use gnomon_core::{Error, Result};
use serde::Deserialize;
use std::path::Path;
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
    pub canvas: Option<[u32; 2]>,
    /// Device profile.
    pub device: Option<String>,
}

/// A light: a direction makes it directional, a position a spot.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct LightSettings {
    /// Where a directional light shines.
    pub direction: Option<[f64; 3]>,
    /// Where a spot stands.
    pub position: Option<[f64; 3]>,
    /// What a spot looks at.
    pub target: Option<[f64; 3]>,
    /// Up of the map.
    pub up: Option<[f64; 3]>,
    /// Field of view of a spot in degrees.
    pub fovy: Option<f64>,
    /// Width of a directional light's box.
    pub width: Option<f64>,
    /// Near plane.
    pub near: Option<f64>,
    /// Far plane.
    pub far: Option<f64>,
}

/// A camera.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct CameraSettings {
    /// The eye.
    pub position: Option<[f64; 3]>,
    /// What it looks at.
    pub target: Option<[f64; 3]>,
    /// Up.
    pub up: Option<[f64; 3]>,
    /// Vertical field of view in degrees.
    pub fovy: Option<f64>,
    /// Near plane.
    pub near: Option<f64>,
    /// Far plane.
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
    pub bias: Option<f32>,
    /// Filter name.
    pub filter: Option<String>,
    /// Comparison rule.
    pub compare: Option<String>,
    /// What happens outside the map.
    pub wrap: Option<String>,
}

impl Settings {
    /// Reads a TOML file.
    ///
    /// # Errors
    /// [`Error::Read`], or [`Error::BadInput`] naming file, line and key.
    pub fn read(path: &Path) -> Result<Self> {
        let meta = std::fs::metadata(path).map_err(|e| Error::read(path, e))?;
        if !meta.is_file() || meta.len() > 1 << 20 {
            return Err(Error::bad_input(
                path.display().to_string(),
                "is no regular file of at most 1 MiB",
                "give a small TOML file",
            ));
        }
        let text = std::fs::read_to_string(path).map_err(|e| Error::read(path, e))?;
        Self::parse(&path.display().to_string(), &text)
    }

    /// Parses TOML text; `place` names it in complaints.
    ///
    /// # Errors
    /// [`Error::BadInput`] naming place, line and key.
    pub fn parse(place: &str, text: &str) -> Result<Self> {
        toml::from_str(text).map_err(|e| {
            let line = e.span().map_or(1, |span| text[..span.start].matches('\n').count() + 1);
            let reason = e.message().replace('\n', " ");
            Error::bad_input(format!("{place}: line {line}"), reason, "see the README for the keys")
        })
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
    pub fn choices(&self) -> Result<(Filter, CompareRule, Wrap, Cull, DeviceProfile)> {
        Ok((
            parsed("lookup.filter", &self.lookup.filter, Filter::Nearest)?,
            parsed("lookup.compare", &self.lookup.compare, CompareRule::ReceiverBeyond)?,
            parsed("lookup.wrap", &self.lookup.wrap, Wrap::Clamp)?,
            parsed("map.cull", &self.map.cull, Cull::None)?,
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
