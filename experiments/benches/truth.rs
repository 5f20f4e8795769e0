//! How fast is the truth: rays, raster, and the public tracers on the same scene?
//!
//! `cargo bench --bench truth [--features peers] [-- terrain|still-life|sheets|fence|curve]`.
//! Times are medians over rounds in which all ways take turns: processor time on one thread; of two
//! threads that of the busier one, which is the wall time of a machine that does nothing else.
//! `GNOMON_DUMP=DIR` writes the scenes and rays for `embree.py`; `GNOMON_CSV=FILE` keeps the curve.
#![allow(clippy::wildcard_enum_match_arm, reason = "singles one member out")]

#[path = "../../tests/support/meshes.rs"]
mod meshes;
#[path = "scenes.rs"]
mod scenes;
#[path = "timing.rs"]
mod timing;

use std::path::Path;
use std::time::{Duration, Instant};

use glam::DVec3;
use gnomon::scene::Geometry;
use gnomon::simd::Level;
use gnomon::truth::izb::{Options, Skips, truths_with};
use gnomon::truth::{Faces, FirstHit, LightEnd, Receiver, Tracer, Truth};
use obvhs::BvhBuildParams;
use obvhs::cwbvh::builder::build_cwbvh_from_tris;
use obvhs::ray::Ray;
use obvhs::rt_triangle::RtTriangle;
use obvhs::triangle::Triangle;
use rayon::prelude::*;
use timing::{Ways, busiest_ms, cpu_ms, threads};

#[cfg(feature = "peers")]
use parry3d::{math::Vector, query::RayCast, shape::TriMesh};

fn main() {
    let args: Vec<String> = std::env::args().skip(1).collect();
    for (name, scene, eye, sun) in [terrain(), still_life(), sheets(), fence()] {
        if args.iter().any(|a| !a.starts_with('-')) && !args.iter().any(|a| *a == name) {
            continue;
        }
        let start = Instant::now();
        let tracer = Tracer::new(&scene);
        let built = start.elapsed().as_secs_f64() * 1e3;
        let receivers = seen_from(&tracer, &scene, eye);
        println!(
            "{name}: {} triangles, {} receivers; tree of the rays {built:.0} ms",
            scene.triangles.len(),
            receivers.len()
        );
        let lights = [
            ("point", LightEnd::Point(sun * 30.0)),
            ("directional", LightEnd::Along(sun.normalize() * tracer.reach())),
        ];
        let peer = Obvhs::new(&scene);
        println!("  tree of obvhs {:.0} ms", peer.built);
        #[cfg(feature = "peers")]
        let parry = Parry::new(&scene);
        let mut rays = Vec::new();
        for (kind, light) in lights {
            let segments = lifted(&scene, &receivers, light);
            one_light(
                kind,
                &Job {
                    scene: &scene,
                    tracer: &tracer,
                    peer: &peer,
                    #[cfg(feature = "peers")]
                    parry: &parry,
                    receivers: &receivers,
                    light,
                    segments: &segments,
                },
            );
            rays.push((kind, segments));
        }
        if let Ok(folder) = std::env::var("GNOMON_DUMP") {
            dump(Path::new(&folder), name, &scene, &rays);
        }
    }
    if args.iter().all(|a| a.starts_with('-')) || args.iter().any(|a| a == "curve") {
        curve();
    }
}

/// One scene under one light.
struct Job<'a> {
    scene: &'a Geometry,
    tracer: &'a Tracer,
    peer: &'a Obvhs,
    #[cfg(feature = "peers")]
    parry: &'a Parry,
    receivers: &'a [Receiver],
    light: LightEnd,
    segments: &'a [(DVec3, DVec3)],
}

/// Compares the answers, then times every way in turn.
fn one_light(kind: &str, job: &Job) {
    let (one, two) = (threads(1), threads(2));
    let raster = |level| {
        let options = Options { level, skips: Skips::ALL };
        truths_with(job.scene, job.receivers, job.light, options)
    };
    let (answers, work) = one.install(|| raster(Level::best()));
    let arbiter = two.install(|| job.tracer.truths(job.receivers, job.light));
    let count = |want: fn(&Truth) -> bool| answers.iter().filter(|a| want(&a.truth)).count();
    println!(
        "  {kind}: {} shadowed (obvhs {}), {} ambiguous; {} triangles swept, {} pairs escalated; \
         {} answers differ from the rays",
        count(|t| matches!(t, Truth::Shadowed(_))),
        job.peer.shadowed(job.segments),
        count(|t| *t == Truth::Ambiguous),
        work.swept,
        work.escalated,
        answers.iter().zip(&arbiter).filter(|(a, b)| a != *b).count(),
    );
    let bare = Options { skips: Skips::NONE, ..Options::default() };
    let mut ways = Ways::default();
    for _ in 0..ROUNDS {
        one.install(|| {
            ways.add("raster, one thread", cpu_ms(|| raster(Level::best())));
            let avx2 = Level::best().min(Level::Avx2);
            ways.add("raster, one thread, avx2", cpu_ms(|| raster(avx2)));
            ways.add("raster, one thread, baseline", cpu_ms(|| raster(Level::Baseline)));
            let all = || truths_with(job.scene, job.receivers, job.light, bare);
            ways.add("raster, one thread, no skips", cpu_ms(all));
            ways.add("obvhs cwbvh f32, trace only", cpu_ms(|| job.peer.shadowed(job.segments)));
            #[cfg(feature = "peers")]
            ways.add("parry3d f32, trace only", cpu_ms(|| job.parry.shadowed(job.segments)));
            let rays = || job.tracer.truths(job.receivers, job.light);
            ways.add("exact rays, one thread, trace", cpu_ms(rays));
        });
        ways.add("raster, two threads, busier", busiest_ms(&two, || drop(raster(Level::best()))));
    }
    ways.report(job.receivers.len(), "receivers");
}

const ROUNDS: usize = 5;

/// From 10⁴ to 10⁷ triangles, as many receivers.
fn curve() {
    let one = threads(1);
    let mut rows = vec!["triangles,receivers,ms,ns_per_triangle,ns_per_receiver".to_owned()];
    println!("curve, one thread: triangles, receivers, ms, ns a triangle, ns a receiver");
    for side in [71, 224, 707, 2236] {
        let scene = scenes::grid(side);
        let light = LightEnd::Point(scenes::SUN * 30.0);
        for count in [scene.triangles.len(), 1_000_000] {
            let receivers = spread(&scene, count);
            let run = || truths_with(&scene, &receivers, light, Options::default());
            let mut times: Vec<f64> = (0..3).map(|_| one.install(|| cpu_ms(run))).collect();
            times.sort_by(f64::total_cmp);
            let (ms, n) = (times[1], scene.triangles.len());
            let (each, receiver) = (ms * 1e6 / n as f64, ms * 1e6 / count as f64);
            println!("  {n:9} {count:9} {ms:8.1} {each:7.1} {receiver:7.1}");
            rows.push(format!("{n},{count},{ms:.3},{each:.2},{receiver:.2}"));
        }
    }
    timing::csv(&rows);
}

/// Receivers spread evenly over the triangles.
fn spread(scene: &Geometry, count: usize) -> Vec<Receiver> {
    let mut random = meshes::Random::new(1);
    let triangle = |k: usize| (k * scene.triangles.len() / count) as u32;
    let mut receiver = |triangle| Receiver {
        position: meshes::on_triangle(scene, triangle, &mut random),
        triangle,
    };
    (0..count).map(triangle).map(&mut receiver).collect()
}

/// First hits of a 1920 x 1080 view, on the surface, by squares of 4 x 4 pixels: rays next to each other
/// suit tracers, most of all those that take sixteen at a time.
fn seen_from(tracer: &Tracer, scene: &Geometry, eye: DVec3) -> Vec<Receiver> {
    let forward = (DVec3::new(0.0, 0.5, 0.0) - eye).normalize();
    let right = forward.cross(DVec3::Y).normalize();
    let up = right.cross(forward);
    let pixel = |k: u32| {
        let (square, pixel) = (k / 16, k % 16);
        let (x, y) = (square % 480 * 4 + pixel % 4, square / 480 * 4 + pixel / 4);
        let (x, y) = (f64::from(x) - 959.5, f64::from(y) - 539.5);
        let far = eye + (forward + (right * x + up * y) / 1100.0) * 60.0;
        match tracer.first_hit(eye, far, Faces::Both, None) {
            FirstHit::Hit { triangle, t, .. } => Some(Receiver {
                position: on_plane(scene, triangle, eye + (far - eye) * t),
                triangle,
            }),
            _ => None,
        }
    };
    (0..1920 * 1080).into_par_iter().filter_map(pixel).collect()
}

/// The point by barycentrics, as receivers are made.
fn on_plane(scene: &Geometry, triangle: u32, p: DVec3) -> DVec3 {
    let [a, b, c] = scene.corners(triangle);
    let n = (b - a).cross(c - a);
    let (u, v) = ((p - a).cross(c - a).dot(n), (b - a).cross(p - a).dot(n));
    let (u, v) = (u / n.length_squared(), v / n.length_squared());
    a * (1.0 - u - v) + b * u + c * v
}

type Scene = (&'static str, Geometry, DVec3, DVec3);

fn terrain() -> Scene {
    ("terrain", scenes::terrain(640), DVec3::new(0.5, 5.5, 5.75), scenes::SUN)
}

fn still_life() -> Scene {
    let scene = scenes::in_f32(meshes::still_life(6));
    ("still-life", scene, DVec3::new(0.5, 4.0, 7.5), scenes::SUN)
}

fn sheets() -> Scene {
    ("sheets", scenes::sheets(), DVec3::new(0.5, 5.0, 7.5), scenes::SUN)
}

fn fence() -> Scene {
    ("fence", scenes::fence(), DVec3::new(0.5, 4.0, 9.5), scenes::SUN)
}

/// The best Rust tracer: `obvhs`, f32, eight-wide compressed nodes, any hit.
struct Obvhs {
    bvh: obvhs::cwbvh::CwBvh,
    triangles: Vec<RtTriangle>,
    built: f64,
}

impl Obvhs {
    fn new(scene: &Geometry) -> Self {
        let corners = (0..scene.triangles.len() as u32).map(|id| scene.corners(id));
        let triangles: Vec<Triangle> = corners
            .map(|c| c.map(|p| p.as_vec3a()))
            .map(|[v0, v1, v2]| Triangle { v0, v1, v2 })
            .collect();
        let mut built = Duration::ZERO;
        let bvh = build_cwbvh_from_tris(&triangles, BvhBuildParams::fast_build(), &mut built);
        let order = bvh.primitive_indices.iter();
        let triangles = order.map(|&k| RtTriangle::from(&triangles[k as usize])).collect();
        Self { bvh, triangles, built: built.as_secs_f64() * 1e3 }
    }

    /// How many of the segments are blocked. Receivers are lifted by 1e-3 along their normals:
    /// without that, f32 rays hit their own surface.
    fn shadowed(&self, rays: &[(DVec3, DVec3)]) -> usize {
        let blocked = |(from, to): &&(DVec3, DVec3)| {
            let ray = Ray::new(from.as_vec3a(), (to - from).as_vec3a(), 0.0, 1.0);
            !self.bvh.ray_traverse_miss(ray, |ray, k| self.triangles[k].intersect(ray))
        };
        rays.iter().filter(blocked).count()
    }
}

/// A Rust tracer that many games use: `parry3d`, f32, first hit (it has no any-hit call).
#[cfg(feature = "peers")]
struct Parry(TriMesh);

#[cfg(feature = "peers")]
impl Parry {
    fn new(scene: &Geometry) -> Self {
        let start = Instant::now();
        let point = |p: &DVec3| Vector::new(p.x as f32, p.y as f32, p.z as f32);
        let points = scene.positions.iter().map(point).collect();
        let mesh = TriMesh::new(points, scene.triangles.clone()).expect("a mesh");
        println!("  tree of parry3d {:.0} ms", start.elapsed().as_secs_f64() * 1e3);
        Self(mesh)
    }

    fn shadowed(&self, rays: &[(DVec3, DVec3)]) -> usize {
        let vector = |p: DVec3| Vector::new(p.x as f32, p.y as f32, p.z as f32);
        let blocked = |(from, to): &&(DVec3, DVec3)| {
            let ray = parry3d::query::Ray::new(vector(*from), vector(*to - *from));
            self.0.cast_local_ray(&ray, 1.0, true).is_some()
        };
        rays.iter().filter(blocked).count()
    }
}

/// Segments of lifted receivers.
fn lifted(scene: &Geometry, receivers: &[Receiver], light: LightEnd) -> Vec<(DVec3, DVec3)> {
    let lift = |r: &Receiver| {
        let [a, b, c] = scene.corners(r.triangle);
        let normal = (b - a).cross(c - a).normalize();
        let side = (light.of(r.position) - r.position).dot(normal).signum();
        let from = r.position + normal * side * 1e-3;
        (from, light.of(from))
    };
    receivers.iter().map(lift).collect()
}

/// Writes a scene for `embree.py`: raw little-endian arrays.
fn dump(folder: &Path, name: &str, scene: &Geometry, lights: &[(&str, Vec<(DVec3, DVec3)>)]) {
    let write = |file: String, bytes: Vec<u8>| {
        std::fs::write(folder.join(file), bytes).expect("the dump folder is writable");
    };
    let points = |points: &mut dyn Iterator<Item = DVec3>| -> Vec<u8> {
        points.flat_map(|p| p.as_vec3().to_array()).flat_map(f32::to_le_bytes).collect()
    };
    write(format!("{name}.vertices"), points(&mut scene.positions.iter().copied()));
    let indices = scene.triangles.iter().flatten().flat_map(|v| v.to_le_bytes()).collect();
    write(format!("{name}.triangles"), indices);
    for (light, rays) in lights {
        let rays = points(&mut rays.iter().flat_map(|(from, to)| [*from, *to - *from]));
        write(format!("{name}.{light}.rays"), rays);
    }
}
