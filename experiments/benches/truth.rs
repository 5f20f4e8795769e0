//! How fast is the truth: rays, raster, and the public tracers on the same scene?
//!
//! `cargo bench --bench truth [-- terrain|bunny-sized|sheets] [--dump DIR] [--quick]`. Times are the
//! medians of several rounds in turn; one thread: processor time, more: wall time.

#[path = "../../tests/support/meshes.rs"]
mod meshes;

use std::hint::black_box;
use std::time::Instant;

use glam::DVec3;
use gnomon::scene::Geometry;
use gnomon::simd::Level;
use gnomon::truth::izb::{Options, truths_with};
use gnomon::truth::{Answer, Faces, FirstHit, LightEnd, Receiver, Tracer, Truth};
use meshes::{append, append_grid, icosphere};
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
        for (kind, light) in lights {
            one_light(kind, &scene, &tracer, &receivers, light);
        }
    }
}

/// Times every way under one light, and compares the answers.
fn one_light(
    kind: &str,
    scene: &Geometry,
    tracer: &Tracer,
    receivers: &[Receiver],
    light: LightEnd,
) {
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    let two = rayon::ThreadPoolBuilder::new().num_threads(2).build().expect("two threads");
    let raster = |level| truths_with(scene, receivers, light, Options { level });
    let (answers, work) = one.install(|| raster(Level::best()));
    let arbiter = two.install(|| tracer.truths(receivers, light));
    let count = |want: fn(&Truth) -> bool| answers.iter().filter(|a| want(&a.truth)).count();
    println!(
        "  {kind}: {} shadowed, {} ambiguous, {} triangles swept, {} pairs escalated, {} answers differ from the rays",
        count(|t| matches!(t, Truth::Shadowed(_))),
        count(|t| *t == Truth::Ambiguous),
        work.triangles,
        work.escalated,
        answers.iter().zip(&arbiter).filter(|(a, b)| a != b).count(),
    );
    let rays = || tracer.truths(receivers, light);
    report("rays, one thread", receivers, 1, || one.install(|| cpu_ms(rays)));
    for &level in Level::ALL.iter().rev().filter(|level| level.is_available()) {
        let name = format!("raster, one thread, {level}");
        report(&name, receivers, 5, || one.install(|| cpu_ms(|| raster(level))));
    }
    report("raster, one thread, wall", receivers, 5, || {
        one.install(|| wall_ms(|| raster(Level::best())))
    });
    report("raster, two threads, wall", receivers, 5, || {
        two.install(|| wall_ms(|| raster(Level::best())))
    });
}

fn report(name: &str, receivers: &[Receiver], rounds: usize, mut time: impl FnMut() -> f64) {
    let mut times: Vec<f64> = (0..rounds).map(|_| time()).collect();
    times.sort_by(f64::total_cmp);
    let (best, median) = (times[0], times[rounds / 2]);
    let rate = receivers.len() as f64 / median / 1e3;
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

/// 640 * 640 bumpy squares and twelve spheres: 1,065,x triangles.
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

#[allow(dead_code, reason = "used by the comparison with peers")]
fn is_shadowed(answer: &Answer) -> bool {
    matches!(answer.truth, Truth::Shadowed(_))
}
