//! Lights with their shadow cameras, and cameras, as three.js updates them before it draws.

use super::file::{Lens, Node, Shadow};
use crate::{LightKind, LoadedCamera, LoadedLens, LoadedLight, LoadedShadow};
use glam::{DMat4, DVec3};
use gnomon_core::view::length;
use std::collections::HashMap;

/// World matrices of all objects by their ids.
pub(super) type Targets<'a> = HashMap<&'a str, DMat4>;

/// three.js' defaults of an orthographic shadow camera: half its sides, near and far.
const BOX: [f64; 3] = [5.0, 0.5, 500.0];

fn named(node: &Node) -> String {
    if node.name.is_empty() { node.kind.clone() } else { node.name.clone() }
}

/// An axis of a matrix in the world, unit length.
fn axis(world: DMat4, local: DVec3) -> DVec3 {
    let axis = world.transform_vector3(local);
    let size = length(axis);
    if size > 0.0 { axis / size } else { local }
}

/// A light, and a word on where it looks.
pub(super) fn light(
    node: &Node,
    world: DMat4,
    targets: &Targets<'_>,
) -> (LoadedLight, Option<String>) {
    let position = world.w_axis.truncate();
    let target = node.target.as_deref().and_then(|id| targets.get(id));
    let target_at = target.map_or(DVec3::ZERO, |target| target.w_axis.truncate());
    let sight = target_at - position;
    let size = length(sight);
    let direction = if size > 0.0 { sight / size } else { DVec3::NEG_Z };
    let (kind, shadow) = match node.kind.as_str() {
        "DirectionalLight" => (LightKind::Directional, Some(directional(node.shadow.as_ref()))),
        "SpotLight" => {
            let angle = node.angle.unwrap_or(std::f64::consts::FRAC_PI_3);
            let cone_degrees = degrees(2.0 * angle);
            (LightKind::Spot { cone_degrees }, Some(spot(node, cone_degrees)))
        }
        _ => (LightKind::Point, None),
    };
    let range = node.distance.filter(|&distance| distance > 0.0);
    let aimed = kind != LightKind::Point && target.is_none();
    let word = aimed.then(|| {
        format!("light '{}' looks at the origin: its target is no part of the scene", named(node))
    });
    (LoadedLight { name: named(node), kind, position, direction, range, shadow }, word)
}

fn degrees(radians: f64) -> f64 {
    radians * (180.0 / std::f64::consts::PI)
}

/// What all shadows have; three.js adds its bias to the receiver's depth, so that its sign turns.
fn common(shadow: Option<&Shadow>) -> LoadedShadow {
    let size = shadow.and_then(|s| s.map_size).unwrap_or([512.0; 2]);
    LoadedShadow {
        sides: None,
        fovy_degrees: None,
        near: BOX[1],
        far: BOX[2],
        size: Some(size.map(|side| side as u32)),
        bias: Some(-(shadow.map_or(0.0, |s| s.bias) as f32)).map(|bias| bias + 0.0),
        normal_bias: shadow.map_or(0.0, |s| s.normal_bias),
        radius: shadow.and_then(|s| s.radius).unwrap_or(1.0),
    }
}

/// DirectionalLightShadow: a box of ±5 from 0.5 to 500 unless it says otherwise.
fn directional(shadow: Option<&Shadow>) -> LoadedShadow {
    let lens = shadow.map_or(Lens::default(), |shadow| shadow.camera);
    let [left, right, bottom, top] = sides(&lens);
    LoadedShadow {
        sides: Some([left, right, bottom, top]),
        near: lens.near.unwrap_or(BOX[1]),
        far: lens.far.unwrap_or(BOX[2]),
        ..common(shadow)
    }
}

/// The sides of an orthographic camera, zoomed about their middle.
fn sides(lens: &Lens) -> [f64; 4] {
    let zoom = lens.zoom.unwrap_or(1.0);
    let zoomed = |low: Option<f64>, high: Option<f64>| {
        let (low, high) = (low.unwrap_or(-BOX[0]), high.unwrap_or(BOX[0]));
        let (half, middle) = ((high - low) / (2.0 * zoom), (high + low) / 2.0);
        [middle - half, middle + half]
    };
    let ([left, right], [bottom, top]) =
        (zoomed(lens.left, lens.right), zoomed(lens.bottom, lens.top));
    [left, right, bottom, top]
}

/// SpotLightShadow: the cone's angle, as far as the light reaches.
fn spot(node: &Node, cone_degrees: f64) -> LoadedShadow {
    let shadow = node.shadow.as_ref();
    let lens = shadow.map_or(Lens::default(), |shadow| shadow.camera);
    let reach = node.distance.filter(|&distance| distance > 0.0);
    LoadedShadow {
        fovy_degrees: Some(cone_degrees * shadow.and_then(|s| s.focus).unwrap_or(1.0)),
        near: lens.near.unwrap_or(BOX[1]),
        far: reach.or(lens.far).unwrap_or(BOX[2]),
        ..common(shadow)
    }
}

/// A camera.
pub(super) fn camera(node: &Node, world: DMat4) -> LoadedCamera {
    let zoom = node.lens.zoom.unwrap_or(1.0);
    let (lens, [aside, above]) = match node.kind.as_str() {
        "OrthographicCamera" => {
            let [left, right, bottom, top] = sides(&node.lens);
            let lens = LoadedLens::Orthographic { height: top - bottom };
            (lens, [(left + right) / 2.0, (bottom + top) / 2.0])
        }
        _ => {
            let half = node.lens.fov.unwrap_or(50.0) / 2.0 * std::f64::consts::PI / 180.0;
            let fovy_degrees = degrees(2.0 * libm::atan(libm::tan(half) / zoom));
            (LoadedLens::Perspective { fovy_degrees }, [0.0; 2])
        }
    };
    let (right, up) = (axis(world, DVec3::X), axis(world, DVec3::Y));
    LoadedCamera {
        name: named(node),
        position: world.w_axis.truncate() + right * aside + up * above,
        direction: axis(world, DVec3::NEG_Z),
        up,
        lens,
    }
}
