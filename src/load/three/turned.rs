//! Spheres, cylinders, cones, capsules and lathes, vertex for vertex as three.js r187 makes them.

use super::shape::{PI, Parameters, Shape, cell, normalized};
use glam::{DVec2, DVec3};
use gnomon_core::{Error, Result};
use libm::{cos, sin};
use serde_json::Value;

pub(super) fn sphere(p: &mut Parameters<'_, '_, '_>) -> Result<Shape> {
    let radius = p.number("radius", 1.0)?;
    let [across, down] = [p.count("widthSegments", 32, 3)?, p.count("heightSegments", 16, 2)?];
    let [phi, phis] = [p.number("phiStart", 0.0)?, p.number("phiLength", PI * 2.0)?];
    let [theta, thetas] = [p.number("thetaStart", 0.0)?, p.number("thetaLength", PI)?];
    p.afford(across, down)?;
    let end = (theta + thetas).min(PI);
    let [nx, ny] = [across, down].map(f64::from);
    let mut shape = Shape::default();
    shape.rows(across, down, |ix, iy| {
        let (u, v) = (f64::from(ix) / nx, f64::from(iy) / ny);
        let y = radius * cos(theta + v * thetas);
        let ring = f64::sqrt(radius * radius - y * y);
        let aside = match iy {
            0 if theta == 0.0 => 0.5 / nx,
            iy if iy == down && end == PI => -0.5 / nx,
            _ => 0.0,
        };
        let angle = phi + u * phis;
        let at = DVec3::new(-ring * cos(angle), y, ring * sin(angle));
        (at, normalized(at), DVec2::new(u + aside, 1.0 - v))
    });
    for iy in 0..down {
        for ix in 0..across {
            let b = ix + (across + 1) * iy;
            let (a, c, d) = (b + 1, b + across + 1, b + across + 2);
            shape.triangles.extend((iy != 0 || theta > 0.0).then_some([a, b, d]));
            shape.triangles.extend((iy != down - 1 || end < PI).then_some([b, c, d]));
        }
    }
    Ok(shape)
}

/// A cylinder's measures.
struct Cylinder {
    radii: [f64; 2],
    height: f64,
    segments: [u32; 2],
    theta: [f64; 2],
}

impl Cylinder {
    fn angle(&self, x: u32) -> (f64, [f64; 2]) {
        let u = f64::from(x) / f64::from(self.segments[0]);
        let theta = u * self.theta[1] + self.theta[0];
        (u, [sin(theta), cos(theta)])
    }

    fn torso(&self, shape: &mut Shape) {
        let ([top, bottom], [across, down]) = (self.radii, self.segments);
        let slope = (bottom - top) / self.height;
        shape.rows(across, down, |x, y| {
            let (u, [s, c]) = self.angle(x);
            let v = f64::from(y) / f64::from(down);
            let radius = v * (bottom - top) + top;
            let at = DVec3::new(radius * s, -v * self.height + self.height / 2.0, radius * c);
            (at, normalized(DVec3::new(s, slope, c)), DVec2::new(u, 1.0 - v))
        });
        for x in 0..across {
            for y in 0..down {
                let [upper, lower] = cell(0, across, x, y);
                shape.triangles.extend((top > 0.0 || y != 0).then_some(upper));
                shape.triangles.extend((bottom > 0.0 || y != down - 1).then_some(lower));
            }
        }
        shape.group(0);
    }

    fn cap(&self, shape: &mut Shape, radius: f64, sign: f64, material: usize) {
        let around = self.segments[0];
        let (y, normal) = (self.height / 2.0 * sign, DVec3::new(0.0, sign, 0.0));
        let first = shape.positions.len() as u32;
        for _ in 0..around {
            shape.push((DVec3::new(0.0, y, 0.0), normal, DVec2::splat(0.5)));
        }
        shape.rows(around, 0, |x, _| {
            let (_, [s, c]) = self.angle(x);
            let uv = DVec2::new(c * 0.5 + 0.5, s * 0.5 * sign + 0.5);
            (DVec3::new(radius * s, y, radius * c), normal, uv)
        });
        shape.triangles.extend((0..around).map(|x| {
            let (c, i) = (first + x, first + around + x);
            if sign > 0.0 { [i, i + 1, c] } else { [i + 1, i, c] }
        }));
        shape.group(material);
    }
}

/// A cylinder, or the cone that is one without a top.
pub(super) fn cylinder(p: &mut Parameters<'_, '_, '_>, is_cone: bool) -> Result<Shape> {
    let radii = match is_cone {
        true => [0.0, p.number("radius", 1.0)?],
        false => [p.number("radiusTop", 1.0)?, p.number("radiusBottom", 1.0)?],
    };
    let height = p.number("height", 1.0)?;
    let segments = [p.count("radialSegments", 32, 1)?, p.count("heightSegments", 1, 1)?];
    let theta = [p.number("thetaStart", 0.0)?, p.number("thetaLength", PI * 2.0)?];
    p.afford(segments[0], segments[1].saturating_add(6))?;
    let cylinder = Cylinder { radii, height, segments, theta };
    let mut shape = Shape::default();
    cylinder.torso(&mut shape);
    if !p.flag("openEnded") {
        for (radius, sign, material) in [(radii[0], 1.0, 1), (radii[1], -1.0, 2)] {
            if radius > 0.0 {
                cylinder.cap(&mut shape, radius, sign, material);
            }
        }
    }
    Ok(shape)
}

pub(super) fn capsule(p: &mut Parameters<'_, '_, '_>) -> Result<Shape> {
    let radius = p.number("radius", 1.0)?;
    let height = p.number("height", 1.0)?.max(0.0);
    let caps = p.count("capSegments", 4, 1)?;
    let around = p.count("radialSegments", 8, 3)?;
    let middle = p.count("heightSegments", 1, 1)?;
    let down = caps.saturating_mul(2).saturating_add(middle);
    p.afford(around, down)?;
    let (half, arc) = (height / 2.0, PI / 2.0 * radius);
    let (nc, nm, na) = (f64::from(caps), f64::from(middle), f64::from(around));
    // Height, radius, height of the normal and length of the way at a row of the outline.
    let outline = |iy: u32| match iy {
        iy if iy <= caps => {
            let t = f64::from(iy) / nc;
            let angle = t * PI / 2.0;
            let (s, c) = (sin(angle), cos(angle));
            [-half - radius * c, radius * s, -radius * c, t * arc]
        }
        iy if iy <= caps + middle => {
            let t = f64::from(iy - caps) / nm;
            [-half + t * height, radius, 0.0, arc + t * height]
        }
        iy => {
            let t = f64::from(iy - caps - middle) / nc;
            let angle = t * PI / 2.0;
            let (s, c) = (sin(angle), cos(angle));
            [half + radius * s, radius * c, radius * s, arc + height + t * arc]
        }
    };
    let mut shape = Shape::default();
    shape.rows(around, down, |ix, iy| {
        let [y, ring, rise, way] = outline(iy);
        let v = (way / (2.0 * arc + height)).clamp(0.0, 1.0);
        let aside = match iy {
            0 => 0.5 / na,
            iy if iy == down => -0.5 / na,
            _ => 0.0,
        };
        let u = f64::from(ix) / na;
        let theta = u * PI * 2.0;
        let [x, z] = [-ring * cos(theta), ring * sin(theta)];
        (DVec3::new(x, y, z), normalized(DVec3::new(x, rise, z)), DVec2::new(u + aside, v))
    });
    for iy in 1..=down {
        for ix in 0..around {
            let (below, here) = ((iy - 1) * (around + 1) + ix, iy * (around + 1) + ix);
            shape.triangles.extend([[below, below + 1, here], [below + 1, here + 1, here]]);
        }
    }
    Ok(shape)
}

/// The points of a lathe's outline.
fn outline(p: &Parameters<'_, '_, '_>) -> Result<Vec<DVec2>> {
    let Some(points) = p.given.get("points").and_then(Value::as_array) else {
        return Ok(vec![DVec2::new(0.0, -0.5), DVec2::new(0.5, 0.0), DVec2::new(0.0, 0.5)]);
    };
    let point = |value: &Value| {
        let number = |key: &str| value.get(key)?.as_f64();
        Some(DVec2::new(number("x")?, number("y")?))
    };
    let points: Option<Vec<DVec2>> = points.iter().map(point).collect();
    points.filter(|points| points.len() >= 2).ok_or_else(|| {
        Error::bad_input(p.place, "has no outline of at least two points", "export it again")
    })
}

/// Normals of an outline, as LatheGeometry mixes them.
fn outline_normals(points: &[DVec2]) -> Vec<DVec3> {
    let edge = |a: &DVec2, b: &DVec2| DVec3::new(b.y - a.y, -(b.x - a.x), 0.0);
    let edges: Vec<DVec3> = points.array_windows().map(|[a, b]| edge(a, b)).collect();
    let first = edges.first().copied().into_iter();
    let between = edges.array_windows().map(|[a, b]| *b + *a);
    let last = edges.last().copied();
    first.chain(between).chain(last).map(normalized).collect()
}

pub(super) fn lathe(p: &mut Parameters<'_, '_, '_>) -> Result<Shape> {
    let points = outline(p)?;
    let segments = p.count("segments", 12, 1)?;
    let start = p.number("phiStart", 0.0)?;
    let length = p.number("phiLength", PI * 2.0)?.clamp(0.0, PI * 2.0);
    let last = u32::try_from(points.len() - 1).unwrap_or(u32::MAX);
    p.afford(last, segments)?;
    let outline: Vec<_> = points.iter().copied().zip(outline_normals(&points)).collect();
    let share = 1.0 / f64::from(segments);
    let mut shape = Shape::default();
    shape.rows(last, segments, |j, i| {
        let phi = start + f64::from(i) * share * length;
        let (s, c) = (sin(phi), cos(phi));
        let (point, normal) = outline.get(j as usize).copied().unwrap_or_default();
        let at = DVec3::new(point.x * s, point.y, point.x * c);
        let normal = DVec3::new(normal.x * s, normal.y, normal.x * c);
        let uv = DVec2::new(f64::from(i) / f64::from(segments), f64::from(j) / f64::from(last));
        (at, normal, uv)
    });
    for i in 0..segments {
        for j in 0..last {
            let a = j + i * (last + 1);
            let b = a + last + 1;
            shape.triangles.extend([[a, b, a + 1], [b + 1, a + 1, b]]);
        }
    }
    Ok(shape)
}
