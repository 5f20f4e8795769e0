//! A user's scene as a case: light and camera from settings or file, else fitted to the geometry.

use super::config::Settings;
use super::{LightKind, LoadedCamera, LoadedLens, LoadedLight, LoadedScene, Part, range};
use glam::DVec3;
use gnomon_core::camera::Camera;
use gnomon_core::light::Light;
use gnomon_core::scene::chain::MatrixChain;
use gnomon_core::scene::{
    Case, CoordForm, Cull, DepthBuffer, LookupSpec, MapSpec, Object, Shading, TexelFormat,
};
use gnomon_core::view::{Projection, View, length};
use gnomon_core::{Error, Result};

/// Largest map side and canvas side: 2²⁶ texels.
const LARGEST_SIDE: u32 = 8192;
/// Fitted planes and boxes stand off the geometry by this share.
const MARGIN: f64 = 0.01;

/// The document of every user's scene.
pub const YOURS: &str = "your scene";

/// World bounds of a scene.
struct Bounds {
    points: Vec<DVec3>,
    centre: DVec3,
    radius: f64,
}

impl Bounds {
    fn of(scene: &LoadedScene) -> Self {
        let world = scene.parts.iter().flat_map(|Part { mesh, model, .. }| {
            mesh.positions.iter().map(move |p| model.transform_point3(p.as_dvec3()))
        });
        let points: Vec<DVec3> = world.collect();
        let low = points.iter().copied().fold(DVec3::INFINITY, DVec3::min);
        let high = points.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
        let centre = (low + high) / 2.0;
        let radius = points.iter().map(|&p| length(p - centre)).fold(0.0, f64::max);
        Self { points, centre, radius }
    }

    /// Smallest and largest coordinate of all points along an axis through the origin.
    fn along(&self, axis: DVec3) -> (f64, f64) {
        self.points
            .iter()
            .map(|p| p.dot(axis))
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), d| (low.min(d), high.max(d)))
    }
}

/// A name as people may see it: as it is, without control characters.
fn shown(name: &str) -> String {
    name.replace(char::is_control, "\u{fffd}")
}

/// Builds the case of a user's scene.
///
/// # Errors
/// [`Error::BadInput`] naming the setting and where it was written.
pub fn case(name: &str, scene: LoadedScene, settings: &Settings) -> Result<Case> {
    fitted(name, scene, settings).map_err(|e| settings.origin.located(e))
}

fn fitted(name: &str, scene: LoadedScene, settings: &Settings) -> Result<Case> {
    let bounds = Bounds::of(&scene);
    if !(bounds.radius > 0.0 && bounds.radius.is_finite()) {
        return Err(Error::bad_input(name, "all vertices coincide", "give a scene with extent"));
    }
    let mut assumptions = scene.notes.clone();
    let light = light(&bounds, &scene, settings, &mut assumptions)?;
    let canvas = settings.canvas.unwrap_or([512, 512]);
    let camera = camera(&bounds, &scene, settings, canvas, &mut assumptions)?;
    let size = settings.map.size.unwrap_or(2048);
    for (key, side) in [("map.size", size), ("canvas", canvas[0]), ("canvas", canvas[1])] {
        if !(1..=LARGEST_SIDE).contains(&side) {
            return Err(Error::bad_input(
                key,
                format!("{side} is not from 1 to {LARGEST_SIDE}"),
                "give another size",
            ));
        }
    }
    let bias = settings.lookup.bias.unwrap_or(0.0);
    if !bias.is_finite() {
        return Err(Error::bad_input("lookup.bias", "is not finite", "give a number"));
    }
    let (filter, compare, wrap, cull, device) = settings.choices()?;
    let chain = MatrixChain::World;
    let object = |Part { name, mesh, model, surface }| {
        Object::new(shown(&name), mesh, model.as_mat4()).with_surface(surface)
    };
    let texel = settings.texel()?;
    Ok(Case {
        name: shown(name),
        document: YOURS.to_string(),
        objects: scene.parts.into_iter().map(object).collect(),
        light,
        camera,
        canvas,
        chain,
        map: MapSpec {
            size,
            texel,
            clear: [1.0; 4],
            depth_buffer: match texel {
                TexelFormat::Depth(_) => DepthBuffer::Texture,
                TexelFormat::Packed(_) => DepthBuffer::Unorm16,
            },
            cull,
        },
        lookup: LookupSpec { coord: CoordForm::Divide, compare, range_test: true, filter, wrap },
        camera_cull: Cull::None,
        bias,
        shading: Shading::AmbientLambert,
        device,
        assumptions,
        skipped: scene.skipped,
        facts: Vec::new(),
    })
}

fn unit(v: DVec3, place: &str) -> Result<DVec3> {
    let size = length(v);
    if size > 0.0 && size.is_finite() {
        Ok(v / size)
    } else {
        Err(Error::bad_input(place, "is zero or not finite", "give a direction"))
    }
}

/// An up vector that is not parallel to the line of sight, which may have any length.
fn up_for(given: Option<[f64; 3]>, direction: DVec3) -> DVec3 {
    let fallback =
        if direction.y.abs() > 0.99 * length(direction) { DVec3::NEG_Z } else { DVec3::Y };
    given.map_or(fallback, DVec3::from_array)
}

fn light(
    bounds: &Bounds,
    scene: &LoadedScene,
    settings: &Settings,
    notes: &mut Vec<String>,
) -> Result<Light> {
    let given = &settings.light;
    for (key, point) in [("light.position", given.position), ("light.target", given.target)] {
        range::setting(key, point)?;
    }
    if given.direction.is_some() && given.position.is_some() {
        return Err(Error::bad_input(
            "light",
            "has a direction and a position",
            "give a direction for a directional light, or a position for a spot",
        ));
    }
    if let Some(position) = given.position {
        let target = given.target.map_or(bounds.centre, DVec3::from_array);
        return spot(bounds, settings, DVec3::from_array(position), target, given.fovy, notes);
    }
    if let Some(direction) = given.direction {
        let direction = unit(DVec3::from_array(direction), "light.direction")?;
        return directional(bounds, settings, direction, notes);
    }
    for other in scene.lights.iter().filter(|light| light.kind == LightKind::Point) {
        let name = &other.name;
        notes.push(format!("light '{name}' is a point light, which needs six maps: left out"));
    }
    let mut mapped = scene.lights.iter().filter(|light| light.kind != LightKind::Point);
    let first = mapped.next();
    for LoadedLight { name, .. } in mapped {
        notes.push(format!("light '{name}' is not the first, left out"));
    }
    match first {
        Some(l) => match l.kind {
            LightKind::Spot { cone_degrees: cone } => {
                let reason = "has no effect: the light stands where the scene file says";
                let fix = "give light.position too, or leave it out";
                settings.idle(&[("light.target", given.target.is_some())], reason, fix)?;
                let target = l.position + l.direction * bounds.radius;
                spot(bounds, settings, l.position, target, Some(given.fovy.unwrap_or(cone)), notes)
            }
            LightKind::Directional | LightKind::Point => {
                directional(bounds, settings, l.direction, notes)
            }
        },
        None => {
            notes.push("no light is given: directional along (-0.5, -1, -0.3)".to_string());
            directional(bounds, settings, unit(DVec3::new(-0.5, -1.0, -0.3), "light")?, notes)
        }
    }
}

/// The tightest box around all vertices along the light.
fn directional(
    bounds: &Bounds,
    settings: &Settings,
    direction: DVec3,
    notes: &mut Vec<String>,
) -> Result<Light> {
    let given = &settings.light;
    let keys = [("light.target", given.target.is_some()), ("light.fovy", given.fovy.is_some())];
    let fix = "leave it out, or give light.position for a spot";
    settings.idle(&keys, "has no effect on a directional light", fix)?;
    let up = up_for(settings.light.up, direction);
    let right = unit(direction.cross(up), "light.up")?;
    let above = right.cross(direction);
    let (x, y) = (bounds.along(right), bounds.along(above));
    let (first, last) = bounds.along(direction);
    let middle = right * ((x.0 + x.1) / 2.0) + above * ((y.0 + y.1) / 2.0);
    let depth = (last - first).max(bounds.radius * 1e-6);
    let stand_off = bounds.radius;
    let position = middle + direction * (first - stand_off);
    let fitted = (x.1 - x.0).max(y.1 - y.0) * (1.0 + 2.0 * MARGIN);
    let width = settings.light.width.unwrap_or(fitted);
    let near = settings.light.near.unwrap_or(stand_off - MARGIN * depth);
    let far = settings.light.far.unwrap_or(stand_off + depth * (1.0 + MARGIN));
    notes.push(format!(
        "light box: {width} wide, depth from {near} to {far}, fitted where not given"
    ));
    let projection = Projection::Orthographic { width, height: width, near, far };
    let view = View { position, target: position + direction * bounds.radius, up };
    Ok(Light::new(view.checked("light")?, projection.checked("light")?, None))
}

/// The tightest frustum around all vertices in front of a spot.
fn spot(
    bounds: &Bounds,
    settings: &Settings,
    position: DVec3,
    target: DVec3,
    fovy: Option<f64>,
    notes: &mut Vec<String>,
) -> Result<Light> {
    let fix = "leave it out, or give light.direction for a directional light";
    let keys = [("light.width", settings.light.width.is_some())];
    settings.idle(&keys, "has no effect on a spot", fix)?;
    let direction = unit(target - position, "light.target")?;
    let up = up_for(settings.light.up, direction);
    let (mut nearest, mut farthest, mut widest) = (f64::INFINITY, 0.0f64, 0.0f64);
    for &p in &bounds.points {
        let depth = (p - position).dot(direction);
        if depth > 0.0 {
            nearest = nearest.min(depth);
            farthest = farthest.max(depth);
            let aside = length(p - position - direction * depth);
            widest = widest.max(aside / depth);
        }
    }
    if farthest <= 0.0 {
        return Err(Error::bad_input("light", "sees no vertex", "turn it towards the scene"));
    }
    let fitted = 2.0 * libm::atan(widest * (1.0 + MARGIN)) * 180.0 / std::f64::consts::PI;
    let fovy_degrees = fovy.unwrap_or_else(|| fitted.min(120.0));
    let far = settings.light.far.unwrap_or(farthest * (1.0 + MARGIN));
    let fitted_near = (nearest * (1.0 - MARGIN)).max(far * 1e-4);
    let near = settings.light.near.unwrap_or(fitted_near);
    notes.push(format!(
        "light frustum: {fovy_degrees} degrees, depth from {near} to {far}, fitted where not given"
    ));
    let projection = Projection::Perspective { fovy_degrees, aspect: 1.0, near, far };
    let cone = libm::cos(fovy_degrees / 2.0 * std::f64::consts::PI / 180.0);
    let view = View { position, target, up }.checked("light")?;
    Ok(Light::new(view, projection.checked("light")?, Some(cone)))
}

fn camera(
    bounds: &Bounds,
    scene: &LoadedScene,
    settings: &Settings,
    canvas: [u32; 2],
    notes: &mut Vec<String>,
) -> Result<Camera> {
    let given = &settings.camera;
    if given.position.is_none() {
        let keys = [("camera.target", given.target.is_some()), ("camera.up", given.up.is_some())];
        let fix = "give camera.position too, or leave it out";
        settings.idle(&keys, "has no effect without camera.position", fix)?;
    }
    for (key, point) in [("camera.position", given.position), ("camera.target", given.target)] {
        range::setting(key, point)?;
    }
    if let Some(fovy) = given.fovy.filter(|f| !(*f > 0.0 && *f < 180.0)) {
        let reason = format!("{fovy} is not in (0, 180)");
        return Err(Error::bad_input("camera.fovy", reason, "give degrees"));
    }
    let perspective = |c: &&LoadedCamera| matches!(c.lens, LoadedLens::Perspective { .. });
    let from_file = scene.cameras.iter().find(perspective).filter(|_| given.position.is_none());
    let of_file = from_file.and_then(|c| match c.lens {
        LoadedLens::Perspective { fovy_degrees } => Some(fovy_degrees),
        LoadedLens::Orthographic { .. } => None,
    });
    let fovy_degrees = given.fovy.or(of_file).unwrap_or(45.0);
    let view = match (given.position, from_file) {
        (Some(position), _) => {
            let position = DVec3::from_array(position);
            let target = given.target.map_or(bounds.centre, DVec3::from_array);
            View { position, target, up: up_for(given.up, target - position) }
        }
        (None, Some(c)) => {
            View { position: c.position, target: c.position + c.direction, up: c.up }
        }
        (None, None) => {
            notes.push("no camera is given: the whole scene from (1, 0.8, 1.3)".to_string());
            let away = unit(DVec3::new(1.0, 0.8, 1.3), "camera")?;
            let half = fovy_degrees / 2.0 * std::f64::consts::PI / 180.0;
            let distance = bounds.radius / libm::sin(half);
            View { position: bounds.centre + away * distance, target: bounds.centre, up: DVec3::Y }
        }
    };
    let view = view.checked("camera")?;
    let distance = length(view.position - bounds.centre);
    let far = given.far.unwrap_or(distance + bounds.radius * 1.05);
    let near = given.near.unwrap_or((distance - bounds.radius * 1.05).max(far * 1e-3));
    let aspect = f64::from(canvas[0]) / f64::from(canvas[1]);
    let projection = Projection::Perspective { fovy_degrees, aspect, near, far };
    Ok(Camera { view, projection: projection.checked("camera")? })
}
