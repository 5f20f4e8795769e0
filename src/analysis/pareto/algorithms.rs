//! The toolkit's own algorithms against their arbiters: what each works out, and what it gets wrong.

use crate::analysis::effort::{Count, Effort, TruthBy};
use crate::analysis::measure::measure_by;
use crate::analysis::observe::Observer;
use crate::analysis::roundtrip::{Certificate, Certifier, Conditions, Method};
use crate::depth::{ByteStore, Packing};
use crate::scene::{Case, Geometry};
use crate::simd::Level;
use crate::truth::izb::{self, Skips};
use crate::truth::{Answer, LightEnd, Receiver, Truth};
use glam::Vec3A;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::{BvhBuildParams, aabb::Aabb, ray::Ray};
use rayon::prelude::*;
use serde::Serialize;
use std::time::Instant;

/// One way to the same answers.
#[derive(Clone, Debug, Serialize)]
pub struct Way {
    /// What is computed.
    pub job: &'static str,
    /// How.
    pub way: &'static str,
    /// Answers given.
    pub answered: u64,
    /// Answers, pairs or floats worked out one by one.
    pub evaluated: u64,
    /// Answers that differ from the arbiter's.
    pub different: u64,
    /// The largest error that it overlooks or makes, where the answer is a number.
    pub error: Option<f64>,
    /// Wall seconds of this run; never part of a report.
    #[serde(skip)]
    pub seconds: f64,
}

/// All of them on one case.
#[must_use]
pub fn ways(case: &Case, step: u32) -> Vec<Way> {
    let observer = Observer::new(case, &case.device.device());
    let receivers: Vec<Receiver> =
        observer.observe_canvas(step).into_iter().map(|o| o.receiver).collect();
    let mut ways = truths(&observer, &receivers);
    ways.extend(measurements(case, step));
    ways.extend(round_trips());
    ways
}

fn timed<T>(run: impl FnOnce() -> T) -> (T, f64) {
    let started = Instant::now();
    let value = run();
    (value, started.elapsed().as_secs_f64())
}

fn truths(observer: &Observer<'_>, receivers: &[Receiver]) -> Vec<Way> {
    let geometry = &observer.geometry;
    let light = observer.light();
    let (arbiter, seconds) = timed(|| observer.tracer.truths(receivers, light));
    let count = receivers.len() as u64;
    let pairs = count * geometry.triangles.len() as u64;
    let way = |way, answered, evaluated, different, seconds| {
        let job = "truth of all receivers";
        Way { job, way, answered, evaluated, different, error: None, seconds }
    };
    let mut ways = vec![way("rays, f64, exact signs (the arbiter)", count, count, 0, seconds)];
    for (name, skips) in [
        ("irregular z-buffer, f64, exact signs", Skips::ALL),
        ("the same without skips", Skips::NONE),
    ] {
        let options = izb::Options { skips, ..izb::Options::default() };
        let ((answers, work), seconds) =
            timed(|| izb::truths_with(geometry, receivers, light, options));
        let different = answers.iter().zip(&arbiter).filter(|(a, b)| a != *b).count() as u64;
        ways.push(way(name, pairs, work.evaluated, different, seconds));
    }
    for (name, offset) in [
        ("rays, f32, own triangle left out", 0.0),
        ("rays, f32, moved 1e-4 of the scene along the normal", 1e-4),
    ] {
        let (lit, seconds) = timed(|| f32_rays(geometry, receivers, light, offset));
        let wrong = |(lit, answer): (&bool, &Answer)| match answer.truth {
            Truth::Lit => !*lit,
            Truth::Shadowed(_) => *lit,
            Truth::Ambiguous => false,
        };
        let different = lit.iter().zip(&arbiter).filter(|&(l, a)| wrong((l, a))).count() as u64;
        ways.push(way(name, count, count, different, seconds));
    }
    ways
}

/// Whether each receiver is lit by a plain f32 ray tracer: Möller and Trumbore's test over a tree,
/// from receivers moved along their normals by a share of the scene's size.
fn f32_rays(
    geometry: &Geometry,
    receivers: &[Receiver],
    light: LightEnd,
    offset: f64,
) -> Vec<bool> {
    let corners = |t: u32| geometry.corners(t).map(|p| Vec3A::from(p.as_vec3()));
    let triangles: Vec<[Vec3A; 3]> = (0..geometry.triangles.len() as u32).map(corners).collect();
    let around = |t: &[Vec3A; 3]| Aabb::new(t[0].min(t[1]).min(t[2]), t[0].max(t[1]).max(t[2]));
    let boxes: Vec<Aabb> = triangles.iter().map(around).collect();
    let bvh = build_bvh2(&boxes, BvhBuildParams::medium_build(), &mut Default::default());
    let all = boxes.iter().fold(Aabb::empty(), |a, b| a.union(b));
    let size = f64::from((all.max - all.min).max_element());
    let one = |receiver: &Receiver| {
        let end = light.of(receiver.position);
        let normal = geometry.area_normal(receiver.triangle);
        let towards = if normal.dot(end - receiver.position) < 0.0 { -1.0 } else { 1.0 };
        let unit = normal / crate::view::length(normal) * towards;
        let from = Vec3A::from((receiver.position + unit * (offset * size)).as_vec3());
        let along = Vec3A::from(end.as_vec3()) - from;
        let ray = Ray::new(from, along, 0.0, 1.0);
        let mut lit = true;
        bvh.ray_traverse_anyhit(ray, |_, k| {
            let id = bvh.primitive_indices[k];
            lit &= id == receiver.triangle || !meets(from, along, &triangles[id as usize]);
        });
        lit
    };
    receivers.par_iter().map(one).collect()
}

/// Möller and Trumbore 1997 in f32, both sides, 0 < t < 1.
fn meets(from: Vec3A, along: Vec3A, [a, b, c]: &[Vec3A; 3]) -> bool {
    let (e1, e2) = (*b - *a, *c - *a);
    let p = along.cross(e2);
    let inverse = 1.0 / e1.dot(p);
    let s = from - *a;
    let u = s.dot(p) * inverse;
    let q = s.cross(e1);
    let v = along.dot(q) * inverse;
    let t = e2.dot(q) * inverse;
    u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0 && t < 1.0
}

/// A whole measurement with and without skips, counting numbers that differ.
fn measurements(case: &Case, step: u32) -> Vec<Way> {
    let run = |effort| {
        let (measured, seconds) = timed(|| measure_by(case, step, effort));
        let value = serde_json::to_value(&measured.measurement).unwrap_or_default();
        (value, measured.work, seconds)
    };
    let sum = |work: &[Count], of: fn(&Count) -> u64| {
        let looks = |c: &&Count| c.what.contains("map points") || c.what.contains("texel centres");
        work.iter().filter(looks).map(of).sum()
    };
    let (arbiter, work, seconds) = run(Effort::ARBITER);
    let way = |way, work: &[Count], different, seconds| Way {
        job: "measurement of a case: light rays",
        way,
        answered: sum(work, |c| c.answered),
        evaluated: sum(work, |c| c.evaluated),
        different,
        error: None,
        seconds,
    };
    let mut ways = vec![way("no skip, rays (the arbiter)", &work, 0, seconds)];
    for (name, effort) in [
        ("skips, raster truth", Effort::default()),
        ("skips, rays", Effort { truth: TruthBy::Rays, skip: true }),
    ] {
        let (value, work, seconds) = run(effort);
        ways.push(way(name, &work, u64::from(value != arbiter), seconds));
    }
    ways
}

/// The largest round-trip error of a packing: proved for every float against sampled.
fn round_trips() -> Vec<Way> {
    let run = |method| {
        let look = Certifier { method, level: Level::best() };
        let conditions = Conditions::plain(ByteStore::HalfEven);
        timed(|| look.certify_packing(Packing::Book, conditions))
    };
    let (exact, seconds) = run(Method::Pruned);
    let way = |way, c: &Certificate, seconds| Way {
        job: "largest round-trip error of the book's packing",
        way,
        answered: c.answered,
        evaluated: c.evaluated,
        different: u64::from(c.max.error != exact.max.error),
        error: Some(c.max.error),
        seconds,
    };
    let (sampled, sampled_seconds) = run(Method::Sampled);
    vec![
        way("every float, by interval proofs (the arbiter)", &exact, seconds),
        way("sampled", &sampled, sampled_seconds),
    ]
}
