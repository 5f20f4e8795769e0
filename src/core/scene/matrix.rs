//! A light from the matrix that an engine uploads: the view and projection that it must be made of.

use crate::light::{Choice, Light, Map};
use crate::view::{Projection, View, length};
use crate::{Error, Result};
use glam::{DMat4, DVec3};

/// Rows that should be orthogonal or parallel may be off by this share: a matrix of f32 numbers.
const OFF: f64 = 1e-5;

fn bad(reason: &str) -> Error {
    Error::bad_input(
        "--light-matrix",
        reason,
        "give clip from world, row by row, of a centred light with OpenGL's clip space",
    )
}

/// The light whose clip-from-world matrix this is, to within the rounding of an f32 matrix. The subject
/// uses the matrix itself, rounded to f32.
///
/// # Errors
/// [`Error::BadInput`] where it is singular, mirrored, skewed, off-centre or reversed.
pub fn light(clip_from_world: DMat4) -> Result<Light> {
    let m = clip_from_world.transpose();
    if !m.is_finite() || m.determinant() == 0.0 {
        return Err(bad("is singular or not finite"));
    }
    let away = m.w_axis.truncate();
    let is_directional = length(away) <= 1e-12 * m.w_axis.w.abs();
    let scale = if is_directional { m.w_axis.w } else { length(away) };
    let rows = [m.x_axis, m.y_axis, m.z_axis, m.w_axis].map(|row| row / scale);
    let [x, y, z, w] = rows.map(|row| row.truncate());
    let forward = if is_directional { z / length(z) } else { w };
    let (right, up) = (x / length(x), y / length(y));
    if right.dot(up).abs() > OFF || forward.dot(right).abs() > OFF || forward.dot(up).abs() > OFF {
        return Err(bad("has a skewed or off-centre volume"));
    }
    if length(z) == 0.0 || (z / length(z) - forward).abs().max_element() > OFF {
        return Err(bad("has a depth row that does not grow away from the light"));
    }
    if right.cross(up).dot(forward) > 0.0 {
        return Err(bad("is mirrored"));
    }
    let constants = rows.map(|row| row.w);
    let (position, projection) = if is_directional {
        directional([right, up, forward], [x, y, z], constants)
    } else {
        perspective([x, y, z, w], constants)?
    };
    let view = View { position, target: position + forward, up };
    let map = Map::new(view.checked("--light-matrix")?, projection.checked("--light-matrix")?)
        .with_uploaded(clip_from_world.as_mat4());
    Light::new(view, projection, None).with_maps(vec![map], Choice::Only)
}

/// The eye stands in the middle of the near plane.
fn directional(axes: [DVec3; 3], rows: [DVec3; 3], constants: [f64; 4]) -> (DVec3, Projection) {
    let size = rows.map(length);
    let at = [0.0, 0.0, -1.0];
    let along = |i: usize| axes[i] * ((at[i] - constants[i]) / size[i]);
    let position = along(0) + along(1) + along(2);
    let [width, height, far] = size.map(|s| 2.0 / s);
    (position, Projection::Orthographic { width, height, near: 0.0, far })
}

/// The eye is where x, y and w are 0; depth is (A·w + B)/w.
fn perspective(rows: [DVec3; 4], constants: [f64; 4]) -> Result<(DVec3, Projection)> {
    let [x, y, z, w] = rows;
    let place = glam::DMat3::from_cols(x, y, w).transpose();
    let position = place.inverse() * -DVec3::new(constants[0], constants[1], constants[3]);
    let (a, b) = (z.dot(w), z.dot(position) + constants[2]);
    let (near, far) = (-b / (a + 1.0), -b / (a - 1.0));
    if !(near > 0.0 && far > near) {
        return Err(bad("has no near and far plane (an infinite or reversed projection?)"));
    }
    let fovy_degrees = 2.0 * libm::atan(1.0 / length(y)) * 180.0 / std::f64::consts::PI;
    let aspect = length(y) / length(x);
    Ok((position, Projection::Perspective { fovy_degrees, aspect, near, far }))
}
