//! A user's scene on the command line: the file, its settings and the flags that stand above them.

use crate::Result;
use crate::load::config::Settings;
use crate::load::{self, Limits, fit};
use crate::scene::Case;
use std::path::PathBuf;

/// A scene file and its light on the command line; flatten it into a binary's arguments.
#[derive(Clone, Debug, Default, clap::Args)]
pub struct SceneFile {
    /// A scene file of your own (.gltf, .glb, .obj, .ply); settings from the .toml beside it, if there is one
    #[arg(long, value_name = "FILE")]
    pub scene: Option<PathBuf>,
    /// Leave damaged triangles and nodes of the scene out, and count them in the report
    #[arg(long, requires = "scene")]
    pub lenient: bool,
    /// Settings from this TOML file instead
    #[arg(long, value_name = "FILE", requires = "scene")]
    pub config: Option<PathBuf>,
    /// Directional light shining along this direction
    #[arg(long, value_name = "X,Y,Z", value_parser = vector, requires = "scene", allow_hyphen_values = true)]
    pub light_dir: Option<[f64; 3]>,
    /// Spot light at this position, looking at the scene's centre
    #[arg(long, value_name = "X,Y,Z", value_parser = vector, requires = "scene", allow_hyphen_values = true)]
    pub light_pos: Option<[f64; 3]>,
}

/// A user's scene with its map on the command line; flatten it into a binary's arguments.
#[derive(Clone, Debug, Default, clap::Args)]
pub struct UserScene {
    #[command(flatten)]
    #[allow(missing_docs, reason = "clap would print it as the help of every flag inside")]
    pub file: SceneFile,
    /// Map side in texels
    #[arg(long, value_name = "N", requires = "scene")]
    pub map: Option<u32>,
    /// Depth format or packing of the map
    #[arg(long, value_name = "NAME", requires = "scene")]
    pub format: Option<String>,
    /// Constant bias in window depth
    #[arg(long, value_name = "B", requires = "scene", allow_hyphen_values = true)]
    pub bias: Option<f32>,
}

fn vector(text: &str) -> std::result::Result<[f64; 3], String> {
    let numbers: Vec<f64> = text.split(',').filter_map(|n| n.trim().parse().ok()).collect();
    <[f64; 3]>::try_from(numbers)
        .ok()
        .filter(|v| v.iter().all(|x| x.is_finite()) && text.split(',').count() == 3)
        .ok_or_else(|| format!("'{text}' is no vector; give three numbers such as 1,-2,0.5"))
}

impl SceneFile {
    /// The case of the scene file, if one is given: flags stand above the TOML, the TOML above the
    /// scene file, and what nobody says is fitted to the geometry.
    ///
    /// # Errors
    /// [`Error::BadInput`](crate::Error::BadInput) or [`Error::Read`](crate::Error::Read) in one sentence.
    pub fn case(&self) -> Result<Option<Case>> {
        self.case_with(|_| {})
    }

    fn case_with(&self, change: impl FnOnce(&mut Settings)) -> Result<Option<Case>> {
        let Some(path) = &self.scene else { return Ok(None) };
        let beside = path.with_extension("toml");
        let mut settings = match &self.config {
            Some(config) => Settings::read(config)?,
            None if beside.is_file() => Settings::read(&beside)?,
            None => Settings::default(),
        };
        if self.light_dir.is_some() || self.light_pos.is_some() {
            settings.light.direction = self.light_dir;
            settings.light.position = self.light_pos;
        }
        change(&mut settings);
        let name = path.file_stem().map_or("scene".into(), |s| s.to_string_lossy().into_owned());
        let limits = Limits { lenient: self.lenient, ..Limits::default() };
        fit::case(&name, load::load(path, &limits)?, &settings).map(Some)
    }
}

impl UserScene {
    /// [`SceneFile::case`] with the map and bias of these flags.
    ///
    /// # Errors
    /// As [`SceneFile::case`].
    pub fn case(&self) -> Result<Option<Case>> {
        self.file.case_with(|settings| {
            settings.map.size = self.map.or(settings.map.size);
            settings.map.format = self.format.clone().or(settings.map.format.take());
            settings.lookup.bias = self.bias.or(settings.lookup.bias);
        })
    }
}
