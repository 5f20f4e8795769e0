//! A user's scene on the command line: the file, its settings and the flags that stand above them.

use crate::error::printable_lines;
use crate::load::config::Settings;
use crate::load::{self, Blend, Limits, LoadedScene, Summary, Wanted, fit};
use crate::scene::Case;
use crate::{Error, Result, input, memory};
use std::fs;
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

/// Reads a scene file and the files that it names, which lie in its own folder, links resolved.
///
/// # Errors
/// [`Error::BadInput`] or [`Error::Read`] in one sentence: file, place, reason, what to do.
pub fn load(path: &Path, limits: &Limits) -> Result<LoadedScene> {
    parse(path, &input::read(path, limits.bytes)?, limits)
}

/// [`load`](fn@load) with the bytes of the file at `path` given; files that they name are looked for beside it.
///
/// # Errors
/// As [`load`](fn@load).
pub fn parse(path: &Path, bytes: &[u8], limits: &Limits) -> Result<LoadedScene> {
    let folder = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    load::read(path, bytes, limits, &|name, most| beside(folder, name, most))
}

/// A file below a folder, through no link that leads out of it.
fn beside(folder: &Path, name: &Path, most: u64) -> Result<Vec<u8>> {
    let path = folder.join(name);
    let resolve = |p: &Path| fs::canonicalize(p).map_err(|e| Error::read(p, e));
    if !resolve(&path)?.starts_with(resolve(folder)?) {
        return Err(Error::bad_input(
            path.display().to_string(),
            "leads outside the scene's folder",
            "keep buffers beside the scene",
        ));
    }
    input::read(&path, most)
}

fn settings_of(path: &Path) -> Result<Settings> {
    Settings::parse(&path.display().to_string(), &input::text(path, input::SETTINGS)?)
}

/// A scene file and its light on the command line; flatten it into a binary's arguments.
#[derive(Clone, Debug, Default, clap::Args)]
pub struct SceneFile {
    /// A scene file of your own (.gltf, .glb, .obj, .ply, .stl, three.js' .json); settings from the .toml beside it, if there is one
    #[arg(long, value_name = "FILE")]
    pub scene: Option<PathBuf>,
    /// Leave damaged triangles and nodes of the scene out, and count them in the report
    #[arg(long, requires = "scene")]
    pub lenient: bool,
    /// Say what the scene holds and how it would be measured, and do nothing else
    #[arg(long, requires = "scene")]
    pub dry_run: bool,
    /// Name or number of the scene in the file [default: the file's own]
    #[arg(long, value_name = "NAME", requires = "scene")]
    pub scene_name: Option<String>,
    /// Pose the scene this many seconds into its animation [default: at rest]
    #[arg(long, value_name = "SECONDS", requires = "scene", allow_hyphen_values = true, value_parser = seconds)]
    pub time: Option<f64>,
    /// Name or number of the animation [default: the first]
    #[arg(long, value_name = "NAME", requires = "time")]
    pub animation: Option<String>,
    /// How surfaces with blended alpha throw shadows: opaque (as three.js), cutout, none [default: opaque]
    #[arg(long, value_name = "HOW", requires = "scene")]
    pub blend: Option<Blend>,
    /// Settings from this TOML file instead
    #[arg(long, value_name = "FILE", requires = "scene")]
    pub config: Option<PathBuf>,
    /// A light of the scene file by name or number; `all` gives one verdict each
    #[arg(long, value_name = "NAME", requires = "scene", conflicts_with_all = ["light_dir", "light_pos"])]
    pub light: Option<String>,
    /// A camera of the scene file by name or number
    #[arg(long, value_name = "NAME", requires = "scene")]
    pub camera: Option<String>,
    /// Add a receiver plane under the scene
    #[arg(long, requires = "scene")]
    pub ground: bool,
    /// Fit light and camera to this object; everything still casts
    #[arg(long, value_name = "NODE", requires = "scene")]
    pub focus: Option<String>,
    /// Order in which matrices multiply: combined, model-view, world, bias-matrix
    #[arg(long, value_name = "NAME", requires = "scene")]
    pub chain: Option<String>,
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

fn seconds(text: &str) -> std::result::Result<f64, String> {
    let time = text.parse().ok().filter(|time: &f64| time.is_finite());
    time.ok_or_else(|| format!("'{text}' is no time; give seconds such as 0.5"))
}

impl SceneFile {
    /// The case of the scene file, if one is given: flags stand above the TOML, the TOML above the
    /// scene file, and what nobody says is fitted to the geometry.
    ///
    /// # Errors
    /// [`Error::BadInput`] or [`Error::Read`] in one sentence; where several lights are asked for.
    pub fn case(&self) -> Result<Option<Case>> {
        let mut cases = self.cases()?;
        if cases.len() > 1 {
            let fix = "name one of them; gnomon-report and gnomon-sweep take all";
            return Err(Error::bad_input("--light all", "asks for several lights", fix));
        }
        Ok(cases.pop())
    }

    /// The cases of the scene file: one, or one for each light where all are asked for; none without a
    /// scene file.
    ///
    /// # Errors
    /// As [`Self::case`].
    pub fn cases(&self) -> Result<Vec<Case>> {
        self.cases_with(|_| {})
    }

    fn cases_with(&self, change: impl FnOnce(&mut Settings)) -> Result<Vec<Case>> {
        let Some(path) = &self.scene else { return Ok(Vec::new()) };
        let beside = path.with_extension("toml");
        let mut settings = match &self.config {
            Some(config) => settings_of(config)?,
            None if beside.exists() => settings_of(&beside)?,
            None => Settings::default(),
        };
        self.override_settings(&mut settings);
        change(&mut settings);
        let name = path.file_stem().map_or("scene".into(), |s| s.to_string_lossy().into_owned());
        let memory = memory::budget();
        let wanted = Wanted {
            scene: self.scene_name.clone(),
            time: self.time,
            animation: self.animation.clone(),
            blend: self.blend.unwrap_or(Blend::Opaque),
        };
        let limits = Limits { lenient: self.lenient, memory, wanted, ..Limits::default() };
        let mut scene = load(path, &limits)?;
        let summary = scene.summary();
        let file = path.file_name().map_or_else(|| name.clone(), |f| f.to_string_lossy().into());
        scene.notes.insert(0, summary.line(&file));
        let cases = fit::cases(&name, scene, &settings)?;
        if let (true, Some(case)) = (self.dry_run, cases.first()) {
            show(&summary, case);
        }
        Ok(cases)
    }

    fn override_settings(&self, settings: &mut Settings) {
        if self.light_dir.is_some() || self.light_pos.is_some() {
            settings.override_light(self.light_dir, self.light_pos);
        }
        if let Some(name) = &self.light {
            settings.choose_light(name);
        }
        if let Some(name) = &self.camera {
            settings.choose_camera(name);
        }
        settings.ground |= self.ground;
        if self.chain.is_some() {
            settings.pipeline.chain.clone_from(&self.chain);
            settings.origin.override_by("pipeline.chain", "--chain (pipeline.chain)");
        }
        if self.focus.is_some() {
            settings.focus.clone_from(&self.focus);
            settings.origin.override_by("focus", "--focus");
        }
    }
}

/// Prints what a scene holds and how it would be measured, and ends the program, as `--help` does.
fn show(summary: &Summary, case: &Case) -> ! {
    let fitted = case.assumptions.iter().skip(1).map(|what| format!("note        {what}"));
    let lines: Vec<String> = summary.lines().into_iter().chain(fitted).collect();
    let text = format!("{}\n", printable_lines(&lines.join("\n")));
    // A closed pipe is no fault of the scene.
    let _ = io::stdout().write_all(text.as_bytes());
    std::process::exit(0)
}

impl UserScene {
    /// [`SceneFile::cases`] with the map and bias of these flags.
    ///
    /// # Errors
    /// As [`SceneFile::cases`].
    pub fn cases(&self) -> Result<Vec<Case>> {
        self.file.cases_with(|settings| {
            let flags = [
                ("map.size", "--map", self.map.is_some()),
                ("map.format", "--format", self.format.is_some()),
                ("lookup.bias", "--bias", self.bias.is_some()),
            ];
            for (key, flag, _) in flags.into_iter().filter(|flag| flag.2) {
                settings.origin.override_by(key, &format!("{flag} ({key})"));
            }
            settings.map.size = self.map.map(|side| [side; 2]).or(settings.map.size);
            settings.map.format = self.format.clone().or(settings.map.format.take());
            settings.lookup.bias = self.bias.or(settings.lookup.bias);
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_outside_the_folder_is_read() {
        let outer = tempfile::tempdir().expect("a folder");
        let folder = outer.path().join("scene");
        fs::create_dir(&folder).expect("a folder");
        fs::write(outer.path().join("secret.bin"), "secret").expect("a file");
        fs::write(folder.join("good.bin"), "good").expect("a file");
        let read = |name: &str| beside(&folder, Path::new(name), 100);
        assert_eq!(read("good.bin").expect("inside"), b"good");
        let message = read("../secret.bin").expect_err("outside").to_string();
        assert!(message.contains("outside"), "{message}");
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink("../secret.bin", folder.join("link.bin")).expect("a link");
            assert!(read("link.bin").expect_err("a link").to_string().contains("outside"));
        }
    }
}
