//! A light along its up vector: what is refused, how skew the map's axes get, and the fallback.

use super::search::{ladder, onset, phases};
use super::{Fate, Forecast, Row, Sampling, Stress};
use crate::device::DeviceProfile;
use crate::load::config::Settings;
use crate::load::fit;
use crate::load::{LoadedScene, Part};
use crate::num::exp2;
use crate::raster::passes::{Transformed, draw_map, map_depth_buffer};
use crate::report::Scale;
use crate::scene::Surface;
use crate::scene::shapes::{Mesh, cuboid, quad};
use crate::view::View;
use glam::{DMat4, DVec3, Vec3};

/// An up vector with no zero component, of length 1.
fn up() -> DVec3 {
    let v = DVec3::new(2.0, 6.0, 3.0);
    v / 7.0
}

/// A view along an axis `1/closeness` off its up vector, at an azimuth in turns.
fn view(closeness: f64, turns: f64) -> View {
    let (up, first) = (up(), DVec3::new(3.0, -2.0, 2.0) / f64::sqrt(17.0));
    let first = (first - up * up.dot(first)) / crate::view::length(first - up * up.dot(first));
    let (azimuth, angle) = (2.0 * std::f64::consts::PI * turns, 1.0 / closeness);
    let aside = first * libm::cos(azimuth) + up.cross(first) * libm::sin(azimuth);
    let position = up * libm::cos(angle) + aside * libm::sin(angle);
    View { position, target: DVec3::ZERO, up }
}

/// Largest |x·z| of the map's axes over `count` azimuths.
fn skew(closeness: f64, count: u32) -> f64 {
    let of = |turns: f64| {
        let matrix = view(closeness, turns).view_from_world();
        let row = |k: usize| DVec3::from_array([0, 1, 2].map(|c| matrix.col(c)[k]));
        row(0).dot(row(2)).abs()
    };
    phases(count).map(of).fold(0.0, f64::max)
}

/// Rounding of up × z: each component is a difference of two products, so |x·z| sin δ is at most
/// 6|z₁z₂z₃|·2⁻⁵³ ≤ 1.16·2⁻⁵³; the rest rounds by a few 2⁻⁵³.
fn skew_bound(closeness: f64) -> f64 {
    exp2(-53) * (1.2 * closeness + 8.0)
}

/// Largest difference of a depth between the map of a scene lit `1/closeness` off straight down, where
/// no up vector is given, and the map of the scene turned by 90° so that its light is level.
fn turned_difference(closeness: f64) -> f64 {
    let (sin, cos) = (libm::sin(1.0 / closeness), libm::cos(1.0 / closeness));
    let turn = |p: Vec3| Vec3::new(p.x, -p.z, p.y);
    let upright = map([sin, -cos, 0.0], &|p| p);
    let level = map([sin, 0.0, -cos], &turn);
    let difference = |(a, b): (&f32, &f32)| (f64::from(*a) - f64::from(*b)).abs();
    // NaN is greater than all.
    let worst = |worst: f64, d: f64| if d <= worst { worst } else { d };
    upright.iter().zip(&level).map(difference).fold(0.0, worst)
}

/// The map of a floor and a box under a light with this direction.
fn map(direction: [f64; 3], place: &dyn Fn(Vec3) -> Vec3) -> Vec<f32> {
    let floor = [(-3.1, -2.9), (3.3, -2.9), (3.3, 3.2), (-3.1, 3.2)];
    let floor = quad(floor.map(|(x, z)| Vec3::new(x, -1.0, z)), Vec3::ONE);
    let cube = cuboid(Vec3::new(-0.7, -0.3, -0.9), Vec3::new(1.1, 0.8, 0.6), Vec3::ONE);
    let part = |mesh: Mesh| {
        let positions = mesh.positions.iter().map(|&p| place(p)).collect();
        let mesh = Mesh { positions, ..mesh }.into();
        let (model, surface) = (DMat4::IDENTITY, Surface::default());
        Part { name: "part".to_string(), mesh, model, surface }
    };
    let parts = vec![part(floor), part(cube)];
    let scene = LoadedScene { parts, ..LoadedScene::default() };
    let mut settings = Settings::default();
    settings.light.direction = Some(direction);
    settings.map.size = Some([64; 2]);
    let case = fit::case("up", scene, &settings).expect("a light along an axis is fitted");
    let device = DeviceProfile::Ideal.device();
    let vertices = Transformed::new(&case, case.chain, &device);
    draw_map(&case, &device, &vertices, map_depth_buffer(&case)).depth
}

fn holds(
    name: &str,
    event: &str,
    formula: &str,
    curve: Vec<(f64, f64)>,
    limit: &dyn Fn(f64) -> f64,
) -> Row {
    let parameters: Vec<f64> = curve.iter().map(|p| p.0).collect();
    let first = curve.iter().find(|p| !(p.1 <= limit(p.0))).map(|p| p.0);
    Forecast::never(name, event, formula).curve(&parameters, limit).met(first, curve)
}

/// Lights ever closer to their up vector.
pub(super) fn parallel(effort: &Sampling) -> Stress {
    let is_refused = |closeness: f64| view(closeness, 0.1).checked("light").is_err();
    let sides = ladder(10.0, 1e16, 16);
    let refused = Forecast::at(
        Fate::Breaks,
        1e12,
        "up-refused",
        "a view along its up vector is refused in a sentence",
        "|up × z| ≤ 10⁻¹²: from there on rounding could turn the map by 10⁻⁴ and more",
    );
    let refused = refused.curve(&sides, |c| f64::from(u8::from(c >= 1e12))).met(
        onset(10.0, 1e16, 60, is_refused),
        sides.iter().map(|&c| (c, f64::from(u8::from(is_refused(c))))).collect(),
    );
    let accepted = ladder(10.0, 5e11, 12);
    let skews = accepted.iter().map(|&c| (c, skew(c, effort.samples))).collect();
    let differences = sides.iter().map(|&c| (c, turned_difference(c))).collect();
    Stress {
        id: "light-along-up",
        title: "A light along its up vector",
        lead: "The closer a light comes to the up vector of its map, the less certain is which way the \
               map is turned. The curves: refused or not, how far the map's axes are from square, and the \
               difference of a fitted map, whose up vector falls back to −z, from that of the turned scene."
            .to_string(),
        parameter: "closeness to the up vector, 1/angle [1/radians]",
        error: "refused; cosine between axes; difference of depths",
        scale: Scale::Log,
        rows: vec![
            refused,
            holds(
                "up-skew",
                "the map's axes are farther from square than rounding explains",
                "1.2·2⁻⁵³/angle: two products of the cross product cancel",
                skews,
                &skew_bound,
            ),
            holds(
                "up-fallback",
                "a fitted light straight down gives another map than the turned scene",
                "the fallback's up vector is the turned scene's",
                differences,
                &|_| exp2(-22),
            ),
        ],
    }
}
