//! Boxes, planes, disks and rings, tori and torus knots, vertex for vertex as three.js r187 makes them.

use super::shape::{PI, Parameters, Shape, normalized};
use glam::{DVec2, DVec3};
use gnomon_core::Result;
use libm::{cos, sin};

pub(super) fn plane(p: &mut Parameters<'_, '_, '_>) -> Result<Shape> {
    let [width, height] = [p.number("width", 1.0)?, p.number("height", 1.0)?];
    let [across, down] = [p.count("widthSegments", 1, 1)?, p.count("heightSegments", 1, 1)?];
    p.afford(across, down)?;
    let [nx, ny] = [across, down].map(f64::from);
    let mut shape = Shape::default();
    shape.rows(across, down, |x, y| {
        let [x, y] = [x, y].map(f64::from);
        let at =
            DVec3::new(x * (width / nx) - width / 2.0, -(y * (height / ny) - height / 2.0), 0.0);
        (at, DVec3::Z, DVec2::new(x / nx, 1.0 - y / ny))
    });
    shape.cells(0, across, down);
    Ok(shape)
}

/// One side of a box: the axes that u, v and w stand for, and their directions.
struct Side {
    axes: [usize; 3],
    turn: [f64; 2],
    size: [f64; 3],
    segments: [u32; 2],
}

impl Side {
    fn add(&self, shape: &mut Shape) {
        let ([width, height, depth], [across, down]) = (self.size, self.segments);
        let [nx, ny] = self.segments.map(f64::from);
        let placed = |u: f64, v: f64, w: f64| {
            let mut at = [0.0; 3];
            for (axis, value) in self.axes.into_iter().zip([u, v, w]) {
                at.iter_mut().skip(axis).take(1).for_each(|x| *x = value);
            }
            DVec3::from_array(at)
        };
        let first = shape.rows(across, down, |x, y| {
            let [x, y] = [x, y].map(f64::from);
            let u = x * (width / nx) - width / 2.0;
            let v = y * (height / ny) - height / 2.0;
            let at = placed(u * self.turn[0], v * self.turn[1], depth / 2.0);
            let normal = placed(0.0, 0.0, if depth > 0.0 { 1.0 } else { -1.0 });
            (at, normal, DVec2::new(x / nx, 1.0 - y / ny))
        });
        shape.cells(first, across, down);
    }
}

pub(super) fn cuboid(p: &mut Parameters<'_, '_, '_>) -> Result<Shape> {
    let w = p.number("width", 1.0)?;
    let h = p.number("height", 1.0)?;
    let d = p.number("depth", 1.0)?;
    let nw = p.count("widthSegments", 1, 1)?;
    let nh = p.count("heightSegments", 1, 1)?;
    let nd = p.count("depthSegments", 1, 1)?;
    let (x, y, z) = (0, 1, 2);
    let sides = [
        Side { axes: [z, y, x], turn: [-1.0, -1.0], size: [d, h, w], segments: [nd, nh] },
        Side { axes: [z, y, x], turn: [1.0, -1.0], size: [d, h, -w], segments: [nd, nh] },
        Side { axes: [x, z, y], turn: [1.0, 1.0], size: [w, d, h], segments: [nw, nd] },
        Side { axes: [x, z, y], turn: [1.0, -1.0], size: [w, d, -h], segments: [nw, nd] },
        Side { axes: [x, y, z], turn: [1.0, -1.0], size: [w, h, d], segments: [nw, nh] },
        Side { axes: [x, y, z], turn: [-1.0, -1.0], size: [w, h, -d], segments: [nw, nh] },
    ];
    let mut shape = Shape::default();
    for (material, side) in sides.iter().enumerate() {
        p.afford(side.segments[0], side.segments[1])?;
        side.add(&mut shape);
        shape.group(material);
    }
    Ok(shape)
}

pub(super) fn circle(p: &mut Parameters<'_, '_, '_>) -> Result<Shape> {
    let (radius, segments) = (p.number("radius", 1.0)?, p.count("segments", 32, 3)?);
    let start = p.number("thetaStart", 0.0)?;
    let length = p.number("thetaLength", PI * 2.0)?;
    p.afford(segments, 1)?;
    let mut shape = Shape::default();
    shape.push((DVec3::ZERO, DVec3::Z, DVec2::splat(0.5)));
    shape.rows(segments, 0, |s, _| {
        let angle = start + f64::from(s) / f64::from(segments) * length;
        let at = DVec3::new(radius * cos(angle), radius * sin(angle), 0.0);
        (at, DVec3::Z, (at.truncate() / radius + 1.0) / 2.0)
    });
    shape.triangles.extend((1..=segments).map(|i| [i, i + 1, 0]));
    Ok(shape)
}

pub(super) fn ring(p: &mut Parameters<'_, '_, '_>) -> Result<Shape> {
    let [inner, outer] = [p.number("innerRadius", 0.5)?, p.number("outerRadius", 1.0)?];
    let [across, down] = [p.count("thetaSegments", 32, 3)?, p.count("phiSegments", 1, 1)?];
    let start = p.number("thetaStart", 0.0)?;
    let length = p.number("thetaLength", PI * 2.0)?;
    p.afford(across, down)?;
    let step = (outer - inner) / f64::from(down);
    // Radii are summed up, as three.js does.
    let radii: Vec<f64> = std::iter::successors(Some(inner), |radius| Some(radius + step))
        .take(down as usize + 1)
        .collect();
    let mut shape = Shape::default();
    shape.rows(across, down, |i, j| {
        let radius = radii.get(j as usize).copied().unwrap_or(outer);
        let angle = start + f64::from(i) / f64::from(across) * length;
        let at = DVec3::new(radius * cos(angle), radius * sin(angle), 0.0);
        (at, DVec3::Z, (at.truncate() / outer + 1.0) / 2.0)
    });
    shape.cells(0, across, down);
    Ok(shape)
}

pub(super) fn torus(p: &mut Parameters<'_, '_, '_>) -> Result<Shape> {
    let [radius, tube] = [p.number("radius", 1.0)?, p.number("tube", 0.4)?];
    let [radial, tubular] = [p.count("radialSegments", 12, 1)?, p.count("tubularSegments", 48, 1)?];
    let arc = p.number("arc", PI * 2.0)?;
    let start = p.number("thetaStart", 0.0)?;
    let length = p.number("thetaLength", PI * 2.0)?;
    p.afford(tubular, radial)?;
    let [nr, nt] = [radial, tubular].map(f64::from);
    let mut shape = Shape::default();
    shape.rows(tubular, radial, |i, j| {
        let [i, j] = [i, j].map(f64::from);
        let (u, v) = (i / nt * arc, start + (j / nr) * length);
        let reach = radius + tube * cos(v);
        let at = DVec3::new(reach * cos(u), reach * sin(u), tube * sin(v));
        let centre = DVec3::new(radius * cos(u), radius * sin(u), 0.0);
        (at, normalized(at - centre), DVec2::new(i / nt, j / nr))
    });
    // Here a is the later row.
    for j in 1..=radial {
        for i in 1..=tubular {
            let a = (tubular + 1) * j + i - 1;
            let b = (tubular + 1) * (j - 1) + i - 1;
            shape.triangles.extend([[a, b, a + 1], [b, b + 1, a + 1]]);
        }
    }
    Ok(shape)
}

/// A point of the curve that a torus knot winds around.
fn knot(u: f64, p: f64, q: f64, radius: f64) -> DVec3 {
    let turn = q / p * u;
    let reach = 2.0 + cos(turn);
    DVec3::new(
        radius * reach * 0.5 * cos(u),
        radius * reach * sin(u) * 0.5,
        radius * sin(turn) * 0.5,
    )
}

pub(super) fn torus_knot(p: &mut Parameters<'_, '_, '_>) -> Result<Shape> {
    let [radius, tube] = [p.number("radius", 1.0)?, p.number("tube", 0.4)?];
    let [tubular, radial] = [p.count("tubularSegments", 64, 1)?, p.count("radialSegments", 8, 1)?];
    let [winds, turns] = [p.number("p", 2.0)?, p.number("q", 3.0)?];
    p.afford(radial, tubular)?;
    let [nt, nr] = [tubular, radial].map(f64::from);
    let mut shape = Shape::default();
    shape.rows(radial, tubular, |j, i| {
        let [i, j] = [i, j].map(f64::from);
        let u = i / nt * winds * PI * 2.0;
        let [here, ahead] = [u, u + 0.01].map(|u| knot(u, winds, turns, radius));
        let (along, middle) = (ahead - here, ahead + here);
        let across = along.cross(middle);
        let (out, across) = (normalized(across.cross(along)), normalized(across));
        let v = j / nr * PI * 2.0;
        let (x, y) = (-tube * cos(v), tube * sin(v));
        let at = here + (out * x + across * y);
        (at, normalized(at - here), DVec2::new(i / nt, j / nr))
    });
    shape.cells(0, radial, tubular);
    Ok(shape)
}
