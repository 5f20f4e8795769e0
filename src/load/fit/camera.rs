//! The camera of a case: stated by the settings, taken from the file, or one that sees what is in focus.

use super::bounds::Bounds;
use super::{chosen, unit, up_for};
use crate::config::{CameraType, Settings, parsed};
use crate::{LoadedCamera, LoadedLens, LoadedScene, range};
use glam::DVec3;
use gnomon_core::camera::Camera;
use gnomon_core::view::{Projection, View, length};
use gnomon_core::{Error, Result};

/// Degrees of a camera of which nobody says more.
const FOVY: f64 = 45.0;

/// The camera that the settings ask for.
pub(super) fn camera(
    bounds: &Bounds,
    scene: &LoadedScene,
    settings: &Settings,
    canvas: [u32; 2],
    notes: &mut Vec<String>,
) -> Result<Camera> {
    let given = &settings.camera;
    let stands = given.position.is_some();
    if !stands {
        let keys = [("camera.target", given.target.is_some()), ("camera.up", given.up.is_some())];
        let fix = "give camera.position too, or leave it out";
        settings.idle(&keys, "has no effect without camera.position", fix)?;
    }
    for (key, point) in [("camera.position", given.position), ("camera.target", given.target)] {
        range::setting(key, point)?;
    }
    let of_file = of_file(scene, settings, notes)?;
    let lens = lens(bounds, settings, of_file.map(|camera| camera.lens))?;
    let view = match (given.position, of_file) {
        (Some(position), _) => {
            let position = DVec3::from_array(position);
            let target = given.target.map_or(bounds.centre, DVec3::from_array);
            View { position, target, up: up_for(given.up, target - position) }
        }
        (None, Some(c)) => {
            View { position: c.position, target: c.position + c.direction, up: c.up }
        }
        (None, None) => overview(bounds, lens, notes)?,
    };
    let view = view.checked("camera")?;
    let distance = length(view.position - bounds.centre);
    let far = given.far.unwrap_or(distance + bounds.reach * 1.05);
    let near = given.near.unwrap_or((distance - bounds.reach * 1.05).max(far * 1e-3));
    let aspect = f64::from(canvas[0]) / f64::from(canvas[1]);
    let projection = match lens {
        LoadedLens::Perspective { fovy_degrees } => {
            Projection::Perspective { fovy_degrees, aspect, near, far }
        }
        LoadedLens::Orthographic { height } => {
            Projection::Orthographic { width: height * aspect, height, near, far }
        }
    };
    Ok(Camera { view, projection: projection.checked("camera")? })
}

/// The camera of the file that is asked for: the named one, else the first, unless one is stated.
fn of_file<'a>(
    scene: &'a LoadedScene,
    settings: &Settings,
    notes: &mut Vec<String>,
) -> Result<Option<&'a LoadedCamera>> {
    let given = &settings.camera;
    if given.position.is_some() {
        let reason = "has no effect: the settings say where the camera is";
        let fix = "leave it out, or camera.position";
        settings.idle(&[("camera.name", given.name.is_some())], reason, fix)?;
        return Ok(None);
    }
    let name = |camera: &'a LoadedCamera| camera.name.as_str();
    if let Some(wanted) = &given.name {
        return chosen("camera", &scene.cameras, name, wanted).map(Some);
    }
    let first = scene.cameras.first();
    if let (Some(first), 2..) = (first, scene.cameras.len()) {
        let count = scene.cameras.len();
        let name = &first.name;
        notes.push(format!("camera '{name}' is used, one of {count}: choose with --camera NAME"));
    }
    Ok(first)
}

/// The stated lens, else the file's, else a pinhole.
fn lens(bounds: &Bounds, settings: &Settings, file: Option<LoadedLens>) -> Result<LoadedLens> {
    let given = &settings.camera;
    let of_file = match file {
        Some(LoadedLens::Orthographic { .. }) => CameraType::Orthographic,
        Some(LoadedLens::Perspective { .. }) | None => CameraType::Perspective,
    };
    match parsed("camera.type", &given.kind, of_file)? {
        CameraType::Perspective => {
            let fix = "leave it out, or give camera.type = \"orthographic\"";
            let keys = [("camera.height", given.height.is_some())];
            settings.idle(&keys, "has no effect on a perspective camera", fix)?;
            if let Some(fovy) = given.fovy.filter(|f| !(*f > 0.0 && *f < 180.0)) {
                let reason = format!("{fovy} is not in (0, 180)");
                return Err(Error::bad_input("camera.fovy", reason, "give degrees"));
            }
            let of_file = match file {
                Some(LoadedLens::Perspective { fovy_degrees }) => Some(fovy_degrees),
                Some(LoadedLens::Orthographic { .. }) | None => None,
            };
            let fovy_degrees = given.fovy.or(of_file).unwrap_or(FOVY);
            Ok(LoadedLens::Perspective { fovy_degrees })
        }
        CameraType::Orthographic => {
            let fix = "leave it out, or give camera.height";
            let keys = [("camera.fovy", given.fovy.is_some())];
            settings.idle(&keys, "has no effect on an orthographic camera", fix)?;
            if let Some(height) = given.height.filter(|&height| height <= 0.0) {
                let reason = format!("{height} is not positive");
                return Err(Error::bad_input("camera.height", reason, "give world units"));
            }
            let of_file = match file {
                Some(LoadedLens::Orthographic { height }) => Some(height),
                Some(LoadedLens::Perspective { .. }) | None => None,
            };
            let height = given.height.or(of_file).unwrap_or(bounds.radius * 2.0);
            Ok(LoadedLens::Orthographic { height })
        }
    }
}

/// All that is in focus, from one side and above.
fn overview(bounds: &Bounds, lens: LoadedLens, notes: &mut Vec<String>) -> Result<View> {
    notes.push("no camera is given: the whole scene from (1, 0.8, 1.3)".to_string());
    let away = unit(DVec3::new(1.0, 0.8, 1.3), "camera")?;
    let distance = match lens {
        LoadedLens::Perspective { fovy_degrees } => {
            let half = fovy_degrees / 2.0 * std::f64::consts::PI / 180.0;
            bounds.radius / libm::sin(half)
        }
        LoadedLens::Orthographic { .. } => bounds.reach * 2.0,
    };
    Ok(View { position: bounds.centre + away * distance, target: bounds.centre, up: DVec3::Y })
}
