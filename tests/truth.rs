//! The truth against closed meshes, integers, closed forms and itself.
#![allow(clippy::wildcard_enum_match_arm, reason = "singles one member out")]

#[path = "support/exact.rs"]
mod exact;
#[path = "support/meshes.rs"]
mod meshes;
#[path = "support/verdicts.rs"]
mod verdicts;

use glam::DVec3;
use gnomon::scene::Geometry;
use gnomon::truth::{Answer, Faces, FirstHit, Occlusion, Receiver, Tracer, Truth};
use meshes::{Random, append_grid, cube, icosphere, on_triangle, scene, still_life};
use proptest::prelude::*;
use verdicts::{FAR, check, lattice_scene, leaks, look, sphere_shadows};

/// R16.
#[test]
fn closed_meshes_far_from_the_origin_never_leak() {
    let mut random = Random::new(16);
    assert_eq!(leaks(&icosphere(4, FAR, 1.0), FAR, 60_000, &mut random), 0, "icosphere");
    assert_eq!(leaks(&cube(8, FAR, 1.0), FAR, 40_000, &mut random), 0, "cube");
}

/// R16, the other way round: a hole of one triangle does leak, so that the test has teeth.
#[test]
fn a_hole_leaks() {
    let mut mesh = icosphere(2, FAR, 1.0);
    mesh.triangles.truncate(mesh.triangles.len() - 4);
    mesh.object.truncate(mesh.triangles.len());
    assert!(leaks(&mesh, FAR, 20_000, &mut Random::new(16)) > 0);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1024, ..ProptestConfig::default() })]

    /// R18: every verdict on random and on badly degenerate integer scenes equals that of exact
    /// integers, the occluders at both ends too.
    #[test]
    fn verdicts_equal_integers(seed: u64, half in 2_i64..40) {
        let mut random = Random::new(seed);
        let scene = lattice_scene(&mut random, half);
        let tracer = Tracer::new(&scene);
        for _ in 0..24 {
            let mut lattice =
                || DVec3::from_array([0; 3].map(|_| random.integer(-half, half) as f64));
            let (from, to) = (lattice(), lattice());
            if from != to {
                let checked = check(&scene, &tracer, from, to);
                prop_assert!(checked.is_ok(), "{}", checked.unwrap_err());
            }
        }
    }

    /// R20: the tree answers as the test of every triangle, bit for bit.
    #[test]
    fn the_tree_equals_brute_force(seed: u64, count in 16_usize..200, offset in -1e6..1e6_f64) {
        let mut random = Random::new(seed);
        let size = random.unit() * random.unit() + 1e-3;
        let mut points = Vec::new();
        for _ in 0..count {
            let centre = random.cube() + offset;
            points.extend([0; 3].map(|_| centre + random.cube() * size));
        }
        let triangles: Vec<_> = (0..count as u32).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
        let scene = scene(&points, &triangles);
        let (tree, brute) = (Tracer::new(&scene), Tracer::brute_force(&scene));
        for k in 0..64 {
            let id = random.index(count) as u32;
            let from = match k % 3 {
                0 => random.cube() * 2.0 + offset,
                _ => on_triangle(&scene, id, &mut random),
            };
            let to = match k % 4 {
                0 => from + random.cube() * tree.reach(),
                1 => scene.corners(random.index(count) as u32)[0],
                _ => random.cube() * 3.0 + offset,
            };
            let receiver = Receiver { position: from, triangle: id };
            prop_assert_eq!(tree.truth(&receiver, to), brute.truth(&receiver, to));
            for faces in Faces::ALL.iter().copied() {
                let (a, b) = (tree.first_hit(from, to, faces, Some(id)), brute.first_hit(from, to, faces, Some(id)));
                prop_assert_eq!(a, b);
            }
        }
    }

    /// Scaling the world by a power of two changes no verdict and scales the gaps exactly.
    #[test]
    fn scale_changes_nothing(seed: u64, exponent in prop::sample::select(vec![-100, -20, -7, 1, 7, 20, 100])) {
        let mut random = Random::new(seed);
        let factor = f64::from_bits(((1023 + exponent) as u64) << 52);
        let scene = still_life(1);
        let mut big = scene.clone();
        big.positions.iter_mut().for_each(|p| *p *= factor);
        let (tracer, scaled) = (Tracer::new(&scene), Tracer::new(&big));
        for _ in 0..16 {
            let triangle = random.index(scene.triangles.len()) as u32;
            let position = on_triangle(&scene, triangle, &mut random);
            let light = DVec3::new(3.0, 9.0, 4.0) + random.cube();
            let one = tracer.truth(&Receiver { position, triangle }, light);
            let other = scaled.truth(&Receiver { position: position * factor, triangle }, light * factor);
            let expected = match one.truth {
                Truth::Shadowed(o) => Truth::Shadowed(Occlusion { gap: o.gap * factor, first_gap: o.first_gap * factor, ..o }),
                other => other,
            };
            prop_assert_eq!(other, Answer { truth: expected, ..one });
        }
    }
}

/// R18: lattice scenes do reach edges and vertices, so that the property above has teeth.
#[test]
fn lattice_scenes_are_degenerate_enough() {
    let mut random = Random::new(18);
    let (mut marginal, mut shadowed) = (0, 0);
    for _ in 0..300 {
        let scene = lattice_scene(&mut random, 6);
        let tracer = Tracer::new(&scene);
        for _ in 0..24 {
            let mut lattice = || DVec3::from_array([0; 3].map(|_| random.integer(-6, 6) as f64));
            let (from, to) = (lattice(), lattice());
            if from != to && check(&scene, &tracer, from, to).unwrap() {
                marginal += 1;
                shadowed += u32::from(look(&tracer, from, to).truth != Truth::Ambiguous);
            }
        }
    }
    assert!(marginal > 400 && shadowed > 200, "{marginal} marginal, {shadowed} of them decided");
}

/// R19.
#[test]
fn sphere_shadows_equal_the_closed_form() {
    let (shadowed, band) = sphere_shadows(100_000);
    assert!(shadowed > 10_000, "{shadowed} shadowed");
    assert!((1..100).contains(&band), "{band} in the band");
}

/// Receivers on a curved closed mesh see their neighbours at distance 0: touching or missed,
/// never occluding on the side of the light.
#[test]
fn receivers_on_a_convex_surface_are_lit_or_behind_it() {
    let mesh = icosphere(4, FAR, 1.0);
    let tracer = Tracer::new(&mesh);
    let light = FAR + DVec3::new(3.0, 5.0, 2.0);
    let mut random = Random::new(20);
    let mut touching = 0;
    for _ in 0..50_000 {
        let id = random.index(mesh.triangles.len()) as u32;
        let mut position = on_triangle(&mesh, id, &mut random);
        if random.bits().is_multiple_of(4) {
            position = mesh.corners(id)[0];
        }
        let [a, b, c] = mesh.corners(id);
        // Height of the light over the triangle's plane; neighbours are tilted by up to 0.1.
        let height = (b - a).cross(c - a).normalize().dot(light - position);
        let answer = tracer.truth(&Receiver { position, triangle: id }, light);
        touching += u32::from(answer.touching > 0);
        if height > 1e-3 {
            assert_eq!(answer.truth, Truth::Lit, "triangle {id} at {position}");
        } else if height < -1.0 {
            assert!(matches!(answer.truth, Truth::Shadowed(_)), "triangle {id} at {position}");
        }
    }
    assert!(touching > 10_000, "{touching}");
}

/// A wall on a floor, seen from both ends, with known distances.
#[test]
fn gaps_are_world_distances_at_both_ends() {
    let mut walls = Geometry::default();
    for x in [1.0, 2.0, 4.0] {
        append_grid(&mut walls, 3, |u, v| DVec3::new(x, u * 3.0, v * 3.0));
    }
    let tracer = Tracer::new(&walls);
    let from = DVec3::new(0.0, 0.25, 0.3);
    let to = from + DVec3::new(8.0, 1.0, 4.0);
    let Truth::Shadowed(o) = look(&tracer, from, to).truth else { panic!("not shadowed") };
    assert_eq!((o.gap, o.first_gap), (9.0 / 8.0, 9.0 / 2.0));
    assert_eq!((walls.object[o.occluder as usize], walls.object[o.first as usize]), (0, 2));
    let FirstHit::Hit { t, t_error, triangle } = tracer.first_hit(to, from, Faces::Both, None)
    else {
        panic!("no hit")
    };
    assert_eq!((t, triangle), (0.5, o.first));
    assert!(t_error > 0.0 && t_error < 1e-14, "{t_error}");
}

/// Facing: a cube seen from outside shows front, then back; from inside the other way round.
#[test]
fn faces_select_sides() {
    let tracer = Tracer::new(&cube(2, DVec3::ZERO, 1.0));
    let (out, into) = (DVec3::new(0.3, 0.2, 5.0), DVec3::new(0.1, 0.3, -5.0));
    let at = |faces, from, to| match tracer.first_hit(from, to, faces, None) {
        FirstHit::Hit { t, .. } => t,
        other => panic!("{other:?}"),
    };
    assert!((at(Faces::Front, out, into) - 0.4).abs() < 1e-12);
    assert!((at(Faces::Both, out, into) - 0.4).abs() < 1e-12);
    assert!((at(Faces::Back, out, into) - 0.6).abs() < 1e-12);
    assert_eq!(tracer.first_hit(DVec3::ZERO, into, Faces::Front, None), FirstHit::None);
}

/// Only accepted objects occlude, ids stay.
#[test]
fn objects_can_be_left_out() {
    let scene = still_life(2);
    let tracer = Tracer::with_objects(&scene, |object| object != 1);
    let through_sphere = (DVec3::new(-1.5, 0.1, 0.01), DVec3::new(-1.4, 9.0, 0.2));
    assert_eq!(look(&tracer, through_sphere.0, through_sphere.1).truth, Truth::Lit);
    let through_cube = (DVec3::new(2.1, 0.1, 0.4), DVec3::new(2.2, 9.0, 0.6));
    let Truth::Shadowed(o) = look(&tracer, through_cube.0, through_cube.1).truth else {
        panic!("the cube is left")
    };
    assert_eq!(scene.object[o.occluder as usize], 2);
}

/// Silhouettes, planes and light ends on a surface are ambiguous; zero area casts no shadow.
#[test]
fn grazing_is_never_guessed() {
    let [o, x, y] = [DVec3::ZERO, DVec3::X, DVec3::Y];
    let one = Tracer::new(&scene(&[o, x, y], &[[0, 1, 2]]));
    let down = |p: DVec3| look(&one, p + DVec3::Z, p - DVec3::Z).truth;
    assert_eq!(down(DVec3::new(0.5, 0.0, 0.0)), Truth::Ambiguous, "edge");
    assert_eq!(down(x), Truth::Ambiguous, "vertex");
    assert!(matches!(down(DVec3::new(0.25, 0.25, 0.0)), Truth::Shadowed(_)));
    assert_eq!(down(DVec3::new(-1e-90, 0.5, 0.0)), Truth::Lit, "just beside");
    assert_eq!(
        look(&one, DVec3::new(-1.0, 0.25, 0.0), DVec3::new(2.0, 0.25, 0.0)).truth,
        Truth::Ambiguous
    );
    assert_eq!(
        look(&one, DVec3::new(-1.0, 1.25, 0.0), DVec3::new(2.0, 1.25, 0.0)).truth,
        Truth::Lit
    );
    let on = DVec3::new(0.25, 0.25, 0.0);
    assert_eq!(look(&one, on + DVec3::Z, on).truth, Truth::Ambiguous, "light on a triangle");
    assert_eq!(look(&one, on, on + DVec3::Z), Answer { truth: Truth::Lit, touching: 1 });
    assert_eq!(look(&one, x, x).truth, Truth::Ambiguous, "receiver at the light");
    let line = Tracer::new(&scene(&[o, x, x * 2.0], &[[0, 1, 2]]));
    assert_eq!(look(&line, x + DVec3::Z, x - DVec3::Z).truth, Truth::Lit);
}

/// R17: far beyond the exponents that can be decided the answer is ambiguous, not wrong.
#[test]
fn absurd_exponents_are_ambiguous() {
    let tiny = 1e-290;
    let corners = [DVec3::new(0.0, 0.0, tiny), DVec3::X, DVec3::Y];
    let tracer = Tracer::new(&scene(&corners, &[[0, 1, 2]]));
    let truth = look(&tracer, DVec3::new(tiny, 0.0, 1e10), DVec3::new(tiny, 0.0, -1e10)).truth;
    assert_eq!(truth, Truth::Ambiguous);
}
