//! Lights and cameras of a glTF where their nodes stand.

use super::super::{LightKind, LoadedCamera, LoadedLens, LoadedLight};
use glam::{DMat4, DVec3};
use gltf::khr_lights_punctual::{Kind, Light};

pub(super) fn light(node: &gltf::Node<'_>, light: &Light<'_>, world: DMat4) -> LoadedLight {
    let kind = match light.kind() {
        Kind::Directional => LightKind::Directional,
        Kind::Spot { outer_cone_angle, .. } => LightKind::Spot {
            cone_degrees: 2.0 * f64::from(outer_cone_angle) * 180.0 / std::f64::consts::PI,
        },
        Kind::Point => LightKind::Point,
    };
    let index = format!("lights[{}]", light.index());
    LoadedLight {
        name: light.name().or(node.name()).map_or(index, str::to_string),
        kind,
        position: position(world),
        direction: axis(world, DVec3::NEG_Z),
        range: light.range().map(f64::from),
        shadow: None,
    }
}

pub(super) fn camera(
    node: &gltf::Node<'_>,
    camera: &gltf::Camera<'_>,
    world: DMat4,
) -> LoadedCamera {
    let lens = match camera.projection() {
        gltf::camera::Projection::Perspective(lens) => LoadedLens::Perspective {
            fovy_degrees: f64::from(lens.yfov()) * 180.0 / std::f64::consts::PI,
        },
        gltf::camera::Projection::Orthographic(lens) => {
            LoadedLens::Orthographic { height: 2.0 * f64::from(lens.ymag()) }
        }
    };
    let index = format!("cameras[{}]", camera.index());
    LoadedCamera {
        name: camera.name().or(node.name()).map_or(index, str::to_string),
        position: position(world),
        direction: axis(world, DVec3::NEG_Z),
        up: axis(world, DVec3::Y),
        lens,
    }
}

fn position(world: DMat4) -> DVec3 {
    world.w_axis.truncate()
}

fn axis(world: DMat4, local: DVec3) -> DVec3 {
    let v = world.transform_vector3(local);
    v / gnomon_core::view::length(v)
}
