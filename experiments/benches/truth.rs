//! How fast is the truth: rays, raster, and the public tracers on the same scene?
//!
//! `cargo bench --bench truth [-- terrain|still-life|sheets]`. Times are medians over rounds in which
//! all ways take turns; processor time on one thread, wall time on two. `GNOMON_DUMP=DIR` writes the
//! scenes and rays for `embree.py`.

#[path = "../../tests/support/meshes.rs"]
mod meshes;

use std::hint::black_box;
use std::path::Path;
use std::time::{Duration, Instant};

use glam::DVec3;
use gnomon::scene::Geometry;
use gnomon::simd::Level;
use gnomon::truth::izb::{Options, truths_with};
use gnomon::truth::{Faces, FirstHit, LightEnd, Receiver, Tracer, Truth};
use meshes::{append, append_grid, icosphere};
use obvhs::BvhBuildParams;
use obvhs::cwbvh::builder::build_cwbvh_from_tris;
use obvhs::ray::Ray;
use obvhs::rt_triangle::RtTriangle;
use obvhs::triangle::Triangle;
use rayon::prelude::*;

fn main() {
    let args: Vec<String> = std::env::args().skip(1).collect();
    for (name, scene, eye, sun) in [terrain(), still_life(), sheets()] {
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
        let mut rays = Vec::new();
        for (kind, light) in lights {
            let segments = lifted(&scene, &receivers, light);
            one_light(
                kind,
                &Job {
                    scene: &scene,
                    tracer: &tracer,
                    peer: &peer,
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
}

/// One scene under one light.
struct Job<'a> {
    scene: &'a Geometry,
    tracer: &'a Tracer,
    peer: &'a Obvhs,
    receivers: &'a [Receiver],
    light: LightEnd,
    segments: &'a [(DVec3, DVec3)],
}

/// Compares the answers, then times every way in turn.
fn one_light(kind: &str, job: &Job) {
    let pool = |n| rayon::ThreadPoolBuilder::new().num_threads(n).build().expect("threads");
    let (one, two) = (pool(1), pool(2));
    let raster = |level| {
        let options = Options { level, ..Options::default() };
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
        answers.iter().zip(&arbiter).filter(|(a, b)| a != b).count(),
    );
    let ways: [(&str, &dyn Fn() -> f64); 7] = [
        ("raster, one thread", &|| one.install(|| cpu_ms(|| raster(Level::best())))),
        ("raster, one thread, avx2", &|| {
            one.install(|| cpu_ms(|| raster(Level::best().min(Level::Avx2))))
        }),
        ("raster, one thread, baseline", &|| one.install(|| cpu_ms(|| raster(Level::Baseline)))),
        ("obvhs cwbvh f32, trace only", &|| cpu_ms(|| job.peer.shadowed(job.segments))),
        ("exact rays, one thread, trace", &|| {
            one.install(|| cpu_ms(|| job.tracer.truths(job.receivers, job.light)))
        }),
        ("raster, one thread, wall", &|| one.install(|| wall_ms(|| raster(Level::best())))),
        ("raster, two threads, wall", &|| two.install(|| wall_ms(|| raster(Level::best())))),
    ];
    let mut times = vec![Vec::new(); ways.len()];
    for _ in 0..ROUNDS {
        for (times, (_, way)) in times.iter_mut().zip(&ways) {
            times.push(way());
        }
    }
    for (times, (name, _)) in times.iter_mut().zip(&ways) {
        report(name, job.receivers.len(), times);
    }
}

const ROUNDS: usize = 7;

fn report(name: &str, receivers: usize, times: &mut [f64]) {
    times.sort_by(f64::total_cmp);
    let (best, median) = (times[0], times[times.len() / 2]);
    let rate = receivers as f64 / median / 1e3;
    println!("    {name:32} {median:8.1} ms (best {best:.1}), {rate:.2} M receivers a second");
}

fn wall_ms<R>(job: impl FnOnce() -> R) -> f64 {
    let start = Instant::now();
    black_box(job());
    start.elapsed().as_secs_f64() * 1e3
}

/// Milliseconds of processor time of this thread.
fn cpu_ms<R>(job: impl FnOnce() -> R) -> f64 {
    let now = || {
        let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
        text.split(' ').next().and_then(|ns| ns.parse::<f64>().ok()).unwrap_or(f64::NAN) / 1e6
    };
    let start = now();
    black_box(job());
    now() - start
}

/// First hits of a 1920 x 1080 view, on the surface.
fn seen_from(tracer: &Tracer, scene: &Geometry, eye: DVec3) -> Vec<Receiver> {
    let forward = (DVec3::new(0.0, 0.5, 0.0) - eye).normalize();
    let right = forward.cross(DVec3::Y).normalize();
    let up = right.cross(forward);
    let pixel = |k: u32| {
        let (x, y) = (f64::from(k % 1920) - 959.5, f64::from(k / 1920) - 539.5);
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

/// 640 * 640 bumpy squares and twelve spheres: 1,064,960 triangles.
fn terrain() -> Scene {
    let mut scene = Geometry::default();
    let wave = |x: f64, z: f64| {
        0.35 * libm::sin(3.1 * x) * libm::cos(2.7 * z)
            + 0.06 * libm::sin(17.0 * x + 2.0 * z)
            + 0.02 * libm::cos(61.0 * z - 23.0 * x)
    };
    append_grid(&mut scene, 640, |x, z| DVec3::new(8.0 * x, wave(8.0 * x, 8.0 * z), -8.0 * z));
    for k in 0..12_u32 {
        let (x, z) = (f64::from(k % 4) * 3.0 - 4.5, f64::from(k / 4) * 3.0 - 3.0);
        let ball = icosphere(5, DVec3::new(x, wave(x, -z) + 0.8, z), 0.45);
        append(&mut scene, &ball.positions, &ball.triangles);
    }
    ("terrain", in_f32(scene), DVec3::new(0.5, 4.0, 9.5), DVec3::new(0.35, 0.8, 0.3))
}

fn still_life() -> Scene {
    (
        "still-life",
        in_f32(meshes::still_life(6)),
        DVec3::new(0.5, 4.0, 7.5),
        DVec3::new(0.35, 0.8, 0.3),
    )
}

/// Large triangles over each other.
fn sheets() -> Scene {
    let mut scene = Geometry::default();
    append_grid(&mut scene, 1, |x, z| DVec3::new(9.0 * x, 0.0, -9.0 * z));
    for k in 0..100 {
        let at = DVec3::new(
            0.13 * f64::from(k % 10) - 0.6,
            1.0 + 0.02 * f64::from(k),
            0.1 * f64::from(k / 10) - 0.5,
        );
        append_grid(&mut scene, 2, |x, z| at + DVec3::new(1.5 * x, 0.3 * x * z, -1.5 * z));
    }
    ("sheets", in_f32(scene), DVec3::new(0.5, 5.0, 7.5), DVec3::new(0.35, 0.8, 0.3))
}

/// Coordinates that f32 holds, so that tracers in f32 get the same scene.
fn in_f32(mut scene: Geometry) -> Geometry {
    scene.positions.iter_mut().for_each(|p| *p = p.as_vec3().as_dvec3());
    scene
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
