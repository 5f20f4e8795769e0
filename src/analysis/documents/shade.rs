//! Pictures of a case: shaded by the document's own formula, classified, and the map itself.

use crate::analysis::classify::{Artifact, Outcome};
use crate::analysis::observe::{Observation, Observer, Standing};
use crate::raster::NO_TRIANGLE;
use crate::report::number::pretty;
use crate::report::{Colour, Picture};
use crate::scene::Shading;
use crate::view::length;
use glam::DVec3;

/// Pictures of at most this many pixels a side are enlarged on the page.
const LARGE: u32 = 300;
/// The map picture shows at most so many texels a side.
const MAP_SIDE: u32 = 400;

/// The observed pixels as a picture, top row first; `None` pixels take `background`.
fn picture(
    observer: &Observer<'_>,
    observations: &[Observation],
    step: u32,
    background: [u8; 3],
    colour: impl Fn(&Observation) -> [u8; 3],
) -> Picture {
    let [width, height] = observer.case().canvas.map(|side| side.div_ceil(step));
    let mut rgb = background.repeat((width * height) as usize);
    for o in observations {
        let row = height - 1 - o.pixel[1] / step;
        let at = 3 * (row * width + o.pixel[0] / step) as usize;
        rgb[at..at + 3].copy_from_slice(&colour(o));
    }
    let magnify = if width < LARGE { LARGE.div_ceil(width) } else { 1 };
    Picture { width, height, rgb, magnify, ..Picture::default() }
}

/// Each receiver in the colour of its class.
pub(super) fn classified(
    id: &str,
    observer: &Observer<'_>,
    observations: &[Observation],
    step: u32,
) -> Picture {
    let name = &observer.case().name;
    let colour = |o: &Observation| class(o).rgb();
    let mut legend = vec![
        (Colour::White, "lit, right".to_string()),
        (Colour::Grey, "shadowed, right".to_string()),
        (Colour::Light, "not counted".to_string()),
    ];
    let present = |a: &&Artifact| {
        observations.iter().any(|o| o.outcome.fault().is_some_and(|f| f.kind.artifact() == **a))
    };
    let faults = Artifact::ALL.iter().filter(present);
    legend.extend(faults.map(|a| (a.colour(), a.name().replace('-', " "))));
    Picture {
        id: format!("{id}-classes"),
        caption: "What the map says against the truth".to_string(),
        alt: format!("{name}: every receiver coloured by its artifact"),
        legend,
        ..picture(observer, observations, step, Colour::Ink.rgb(), colour)
    }
}

fn class(o: &Observation) -> Colour {
    match (o.truly_lit(), o.outcome) {
        (None, _) if o.standing == Standing::Ambiguous => Colour::Green,
        (None, _) => Colour::Light,
        (_, Outcome::Wrong(fault)) => fault.kind.artifact().colour(),
        (Some(true), Outcome::Agree) => Colour::White,
        (Some(false), Outcome::Agree) => Colour::Grey,
    }
}

/// Each receiver shaded as the document writes it, with the subject's own visibility.
pub(super) fn shaded(
    id: &str,
    observer: &Observer<'_>,
    observations: &[Observation],
    step: u32,
) -> Picture {
    let name = &observer.case().name;
    let colour = |o: &Observation| shade(observer, o);
    Picture {
        id: format!("{id}-shaded"),
        caption: format!("Shaded by the document's formula ({})", observer.case().shading),
        alt: format!("{name}: the picture that the document's program draws"),
        ..picture(observer, observations, step, [0; 3], colour)
    }
}

fn shade(observer: &Observer<'_>, o: &Observation) -> [u8; 3] {
    let case = observer.case();
    let mesh = &case.objects[usize::from(o.object)].mesh;
    let first: usize =
        case.objects[..usize::from(o.object)].iter().map(|o| o.mesh.triangles.len()).sum();
    let corners = mesh.triangles[o.receiver.triangle as usize - first];
    let weights = observer.subject.barycentrics(o.receiver.triangle, o.pixel[0], o.pixel[1]);
    let colour = (0..3).fold(DVec3::ZERO, |sum, i| {
        sum + mesh.colour(corners[i]).as_dvec3() * weights.to_array()[i]
    });
    let lit = o.visibility();
    let cosine = facing(observer, o);
    let shaded = match case.shading {
        Shading::Tint => colour * (0.7 + 0.3 * lit),
        Shading::AmbientDiffuseSpecular => {
            colour * (0.2 + 0.8 * cosine * lit) + DVec3::splat(highlight(observer, o) * lit)
        }
        Shading::Lambert if o.standing == Standing::OutsideCone => DVec3::ZERO,
        Shading::Lambert => colour * (cosine * lit),
        Shading::AmbientLambert => colour * (0.2 + 0.8 * cosine * lit),
    };
    shaded.clamp(DVec3::ZERO, DVec3::ONE).to_array().map(|x| (x * 255.0).round_ties_even() as u8)
}

/// The unit normal that shades: interpolated from the vertices, else the face's turned to the camera.
fn normal(observer: &Observer<'_>, o: &Observation) -> DVec3 {
    if let Some(normals) = observer.vertex_normals_at(&o.receiver) {
        return normals.shading;
    }
    let normal = observer.geometry.area_normal(o.receiver.triangle);
    let to_camera = observer.case().camera.towards(o.receiver.position);
    let unit = normal / length(normal);
    if unit.dot(to_camera) < 0.0 { -unit } else { unit }
}

/// max(0, N·L).
fn facing(observer: &Observer<'_>, o: &Observation) -> f64 {
    normal(observer, o).dot(observer.case().light.direction_from(o.receiver.position)).max(0.0)
}

/// A Blinn highlight of exponent 32 and strength 0.3.
fn highlight(observer: &Observer<'_>, o: &Observation) -> f64 {
    let to_camera = observer.case().camera.towards(o.receiver.position);
    let half =
        observer.case().light.direction_from(o.receiver.position) + to_camera / length(to_camera);
    let cosine = normal(observer, o).dot(half / length(half)).max(0.0);
    let squared = |x: f64| x * x;
    0.3 * squared(squared(squared(squared(squared(cosine)))))
}

/// The stored depths, stretched over the range that was drawn; cleared texels black.
pub(super) fn map(id: &str, observer: &Observer<'_>) -> Picture {
    let map = &observer.subject.map;
    let raster = &observer.subject.map_raster;
    let [width, height] = map.layout().picture();
    let stride = width.max(height).div_ceil(MAP_SIDE);
    let [columns, lines] = [width, height].map(|side| side.div_ceil(stride));
    let texel = |x: u32, y: u32| map.layout().pictured(x * stride, y * stride).map(|t| t as usize);
    let drawn = |i: usize| raster.triangle[i] != NO_TRIANGLE;
    let depth = |i: usize| map.depth(&observer.subject.device, i);
    let (mut near, mut far) = (f32::INFINITY, f32::NEG_INFINITY);
    let places = (0..lines).flat_map(|y| (0..columns).map(move |x| (x, y)));
    for i in places.filter_map(|(x, y)| texel(x, y)).filter(|&i| drawn(i)) {
        near = near.min(depth(i));
        far = far.max(depth(i));
    }
    let grey = |i: Option<usize>| {
        let Some(i) = i.filter(|&i| drawn(i)) else { return Colour::Ink.rgb() };
        let t = (depth(i) - near) / (far - near).max(f32::MIN_POSITIVE);
        [(80.0 + 165.0 * t).round_ties_even() as u8; 3]
    };
    let rows = (0..lines).rev();
    let rgb = rows.flat_map(|y| (0..columns).flat_map(move |x| grey(texel(x, y)))).collect();
    Picture {
        id: format!("{id}-map"),
        caption: match near <= far {
            true => format!(
                "Shadow map as decoded: {} (dark) to {} (light) window depth{}",
                pretty(f64::from(near), 4),
                pretty(f64::from(far), 4),
                if stride > 1 {
                    format!(", one texel in {stride} across and down")
                } else {
                    String::new()
                }
            ),
            false => "Shadow map: no texel that is shown was drawn".to_string(),
        },
        alt: format!("{}: the shadow map", observer.case().name),
        width: columns,
        height: lines,
        rgb,
        legend: vec![(Colour::Ink, "cleared".to_string())],
        magnify: 1,
    }
}
