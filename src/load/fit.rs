//! A user's scene as a case: light and camera from settings or file, else fitted to the geometry.

mod bounds;
mod camera;
mod cone;
mod light;
mod parallel;

use super::config::{Settings, parsed};
use super::{LoadedScene, LoadedShadow, Part};
use bounds::Bounds;
pub use bounds::GROUND;
use glam::{DVec3, Mat4};
use gnomon_core::scene::chain::MatrixChain;
use gnomon_core::scene::{
    Case, CoordForm, Cull, CullRule, DepthBuffer, Filter, LookupSpec, MapSpec, Object, Shading,
    TexelFormat,
};
use gnomon_core::view::length;
use gnomon_core::{Error, Result};
use light::{Fit, Lit, is_mapped};

/// Largest map side and canvas side: 2²⁶ texels.
const LARGEST_SIDE: u32 = 8192;
/// Fitted planes and boxes stand off the geometry by this share.
const MARGIN: f64 = 0.01;

/// Asks for a verdict on each light of a scene file, in place of a light's name.
pub const ALL_LIGHTS: &str = "all";

/// The document of every user's scene.
pub const YOURS: &str = "your scene";

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

/// Builds one case for each light of the scene that can have a map, where [`ALL_LIGHTS`] is asked for,
/// else the one case.
///
/// # Errors
/// As [`case`].
pub fn cases(name: &str, scene: LoadedScene, settings: &Settings) -> Result<Vec<Case>> {
    let asked = settings.light.name.as_deref() == Some(ALL_LIGHTS);
    if !asked || scene.lights.iter().any(|light| light.name == ALL_LIGHTS) {
        return case(name, scene, settings).map(|case| vec![case]);
    }
    let mapped = scene.lights.iter().enumerate().filter(|(_, light)| is_mapped(light));
    let lights: Vec<(usize, String)> = mapped.map(|(i, l)| (i, l.name.clone())).collect();
    if lights.is_empty() {
        let place = settings.origin.at("light.name");
        let reason = "the scene file has no directional or spot light";
        return Err(Error::bad_input(place, reason, "give light.direction or light.position"));
    }
    let alone = lights.len() == 1;
    let each = lights.into_iter().map(|(i, light)| {
        let mut settings = settings.clone();
        settings.light.name = Some(i.to_string());
        let light = if light.is_empty() { i.to_string() } else { light };
        let name = if alone { name.to_string() } else { format!("{name} by {light}") };
        case(&name, scene.clone(), &settings)
    });
    each.collect()
}

/// Refuses a picture or map without texels, or with too many along a side.
fn sized(key: &str, sides: [u32; 2]) -> Result<()> {
    match sides.into_iter().find(|side| !(1..=LARGEST_SIDE).contains(side)) {
        None => Ok(()),
        Some(side) => {
            let reason = format!("{side} is not from 1 to {LARGEST_SIDE}");
            Err(Error::bad_input(key, reason, "give another size"))
        }
    }
}

/// Filter and culling as the settings say, else as the file's engine has them.
fn of_engine(
    scene: &LoadedScene,
    settings: &Settings,
    (filter, cull): (Filter, CullRule),
    skipped: &mut Vec<String>,
) -> (Filter, CullRule) {
    let cull_of_engine = scene.cull.filter(|_| settings.map.cull.is_none());
    let filter_of_engine = scene.filter.filter(|_| settings.lookup.filter.is_none());
    skipped.extend(filter_of_engine.map(|word| {
        format!(
            "renderer.shadowMap.type, which the file does not hold: taken as PCFShadowMap, three.js' \
             default (lookup.filter = \"{word}\"; BasicShadowMap is \"nearest\")"
        )
    }));
    (
        filter_of_engine.and_then(|word| word.parse().ok()).unwrap_or(filter),
        cull_of_engine.and_then(|word| word.parse().ok()).unwrap_or(cull),
    )
}

fn fitted(name: &str, mut scene: LoadedScene, settings: &Settings) -> Result<Case> {
    let canvas = settings.canvas.unwrap_or([512, 512]);
    sized("canvas", canvas)?;
    let focus = settings.focus.as_deref();
    if let Some(focus) = focus {
        bounds::known_focus(&scene, focus)?;
    }
    let stood = scene.parts.len();
    if settings.ground {
        bounds::add_ground(&mut scene)?;
    }
    let bounds = Bounds::of(&scene, |i, part| match focus {
        Some(focus) => bounds::is_called(part, focus),
        None => i < stood,
    });
    if !(bounds.radius > 0.0 && bounds.radius.is_finite()) {
        return Err(Error::bad_input(name, "all vertices coincide", "give a scene with extent"));
    }
    let (mut assumptions, mut skipped) = (scene.notes.clone(), scene.skipped.clone());
    assumptions.extend(match bounds::strays(&scene) {
        0 => None,
        count => Some(format!("vertices that no triangle names are ignored: {count}")),
    });
    assumptions.extend(focus.map(|focus| format!("light and camera are fitted to '{focus}'")));
    let fit = &mut Fit {
        bounds: &bounds,
        scene: &scene,
        settings,
        notes: &mut assumptions,
        skipped: &mut skipped,
    };
    let Lit { light, size, shadow } = fit.light()?;
    let camera = camera::camera(&bounds, &scene, settings, canvas, &mut assumptions)?;
    let bias =
        settings.lookup.bias.or(shadow.as_ref().and_then(|shadow| shadow.bias)).unwrap_or(0.0);
    if !bias.is_finite() {
        return Err(Error::bad_input("lookup.bias", "is not finite", "give a number"));
    }
    let (filter, compare, wrap, cull, device) = settings.choices()?;
    let (filter, cull) = of_engine(&scene, settings, (filter, cull), &mut skipped);
    skipped.extend(shadow.iter().flat_map(LoadedShadow::unapplied));
    let chain = parsed("pipeline.chain", &settings.pipeline.chain, MatrixChain::World)?;
    let object = |Part { name, mesh, model, surface }| {
        Object::new(shown(&name), mesh, Mat4::IDENTITY).placed(model).with_surface(surface)
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
            size: size[0].max(size[1]),
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
        skipped,
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

/// A point or direction as people read it.
fn place(p: DVec3) -> String {
    format!("({}, {}, {})", p.x, p.y, p.z)
}

/// The member of a list with this name, else of this number, counted from 0.
fn chosen<'a, T>(
    what: &str,
    list: &'a [T],
    name: impl Fn(&'a T) -> &'a str,
    wanted: &str,
) -> Result<&'a T> {
    let by_number = || list.get(wanted.parse::<usize>().ok()?);
    list.iter().find(|&item| name(item) == wanted).or_else(by_number).ok_or_else(|| {
        let all = list.iter().enumerate().map(|(i, item)| format!("{i} '{}'", name(item)));
        let all: Vec<_> = all.collect();
        let fix = match all.is_empty() {
            true => format!("the file has none: give {what}.position"),
            false => format!("use one of {}", all.join(", ")),
        };
        Error::bad_input(
            format!("{what}.name '{wanted}'"),
            format!("is no {what} of the scene"),
            fix,
        )
    })
}

#[cfg(test)]
mod tests;
