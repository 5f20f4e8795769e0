//! The truth, long runs: `cargo test --release --test truth_soak -- --ignored`.

#[path = "support/exact.rs"]
mod exact;
#[path = "support/meshes.rs"]
mod meshes;
#[path = "support/verdicts.rs"]
mod verdicts;

use glam::DVec3;
use gnomon::truth::{Tracer, Truth};
use meshes::{Random, cube, icosphere};
use verdicts::{FAR, check, lattice_scene, leaks, look, sphere_shadows};

/// R16: three quarters of the rays are aimed at vertices and edges.
#[test]
#[ignore = "soak: 10^7 rays, about 20 s"]
fn ten_million_rays_leave_no_closed_mesh() {
    let mut random = Random::new(160);
    assert_eq!(leaks(&icosphere(5, FAR, 1.0), FAR, 6_000_000, &mut random), 0, "icosphere");
    assert_eq!(leaks(&cube(16, FAR, 1.0), FAR, 4_000_000, &mut random), 0, "cube");
}

/// R18.
#[test]
#[ignore = "soak: 10^6 segments against integers, about 60 s"]
fn a_million_verdicts_equal_integers() {
    let mut random = Random::new(180);
    let mut marginal = 0;
    for round in 0..25_000 {
        let half = 2 + round % 40;
        let scene = lattice_scene(&mut random, half);
        let tracer = Tracer::new(&scene);
        for _ in 0..40 {
            let mut lattice =
                || DVec3::from_array([0; 3].map(|_| random.integer(-half, half) as f64));
            let (from, to) = (lattice(), lattice());
            if from != to {
                marginal += u32::from(check(&scene, &tracer, from, to).unwrap());
            }
        }
    }
    assert!(marginal > 10_000, "{marginal} marginal");
}

/// R19.
#[test]
#[ignore = "soak: 10^7 rays, about 20 s"]
fn ten_million_points_in_the_shadow_of_a_sphere() {
    let (shadowed, band) = sphere_shadows(10_000_000);
    assert!(shadowed > 1_000_000 && band < 10_000, "{shadowed} shadowed, {band} in the band");
}

/// R20: infinities and NaN end at once and in one verdict.
#[test]
#[ignore = "soak: timing"]
fn void_rays_are_no_slower_than_others() {
    let tracer = Tracer::new(&icosphere(5, DVec3::ZERO, 1.0));
    let mut random = Random::new(200);
    let ends: Vec<DVec3> = (0..200_000).map(|_| random.cube() * 4.0).collect();
    let time = |bad: f64| {
        let start = std::time::Instant::now();
        let void = |&&end: &&DVec3| look(&tracer, end, end + bad).truth == Truth::Ambiguous;
        (ends.iter().filter(void).count(), start.elapsed())
    };
    let (_, normal) = time(-0.5);
    for bad in [f64::NAN, f64::INFINITY, f64::MAX] {
        let (void, taken) = time(bad);
        assert!(void == ends.len(), "{bad}: {void} void");
        assert!(taken < normal.mul_f64(2.5), "{bad}: {taken:?} against {normal:?}");
    }
}
