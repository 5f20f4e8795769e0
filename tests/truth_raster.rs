//! The irregular z-buffer answers as the rays do, on every receiver.

#[path = "support/meshes.rs"]
mod meshes;

use glam::DVec3;
use gnomon::scene::Geometry;
use gnomon::simd::Level;
use gnomon::truth::izb::{Options, Skips, truths, truths_with};
use gnomon::truth::{Answer, LightEnd, Receiver, Tracer, Truth};
use meshes::{Random, append, append_grid, cube, icosphere, on_triangle, scene, still_life};
use proptest::prelude::*;

/// Receivers on the surface (offset 0), at corners and on edges, and in free space.
fn receivers(scene: &Geometry, count: usize, random: &mut Random) -> Vec<Receiver> {
    let triangles = scene.triangles.len();
    (0..count)
        .map(|k| {
            let triangle = random.index(triangles) as u32;
            let [a, b, c] = scene.corners(triangle);
            let position = match k % 8 {
                0 => a,
                1 => (a + b) / 2.0,
                2 => b + (c - b) * random.unit(),
                3 => a + random.cube(),
                _ => on_triangle(scene, triangle, random),
            };
            Receiver { position, triangle }
        })
        .collect()
}

fn equal(scene: &Geometry, receivers: &[Receiver], light: LightEnd) -> Result<(), String> {
    let tracer = Tracer::new(scene);
    let raster = truths(scene, receivers, light);
    for (receiver, answer) in receivers.iter().zip(raster.iter()) {
        let expected = tracer.truth(receiver, light.of(receiver.position));
        if answer != expected {
            return Err(format!("{receiver:?} {light:?}: raster {answer:?}, rays {expected:?}"));
        }
    }
    Ok(())
}

fn lights(scene: &Geometry, random: &mut Random) -> [LightEnd; 4] {
    let tracer = Tracer::new(scene);
    let reach = tracer.reach();
    let anywhere = scene.positions[random.index(scene.positions.len())] + random.cube() * 2.0;
    let above = DVec3::new(random.unit(), 1.0 + random.unit(), random.unit());
    [
        LightEnd::Point(anywhere),
        LightEnd::Point(scene.positions[0] + above * reach),
        LightEnd::Along(above.normalize() * reach),
        LightEnd::Along(random.cube().normalize_or(DVec3::Y) * reach),
    ]
}

/// Triangles of every size, far too large ones and slivers among them.
fn soup(count: usize, offset: f64, random: &mut Random) -> Geometry {
    let mut points = Vec::new();
    for k in 0..count {
        let centre = random.cube() * 4.0 + offset;
        let size = [3.0, 0.3, 0.02, 1e-4][k % 4];
        let (a, b) = (random.cube() * size, random.cube() * size);
        let thin = if k % 5 == 0 { 1e-7 } else { 1.0 };
        points.extend([centre, centre + a, centre + a * 0.5 + b * thin]);
    }
    let triangles: Vec<_> = (0..count as u32).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
    scene(&points, &triangles)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1024, ..ProptestConfig::default() })]

    #[test]
    fn soups(seed: u64, count in 1_usize..120, offset in prop::sample::select(vec![0.0, 1.0, 1e3, 1e5])) {
        let mut random = Random::new(seed);
        let scene = soup(count, offset, &mut random);
        let receivers = receivers(&scene, 200, &mut random);
        for light in lights(&scene, &mut random) {
            let checked = equal(&scene, &receivers, light);
            prop_assert!(checked.is_ok(), "{}", checked.unwrap_err());
        }
    }

    #[test]
    fn still_lives(seed: u64) {
        let mut random = Random::new(seed);
        let scene = still_life(1);
        let receivers = receivers(&scene, 300, &mut random);
        for light in lights(&scene, &mut random) {
            let checked = equal(&scene, &receivers, light);
            prop_assert!(checked.is_ok(), "{}", checked.unwrap_err());
        }
    }
}

/// Lattice scenes under lattice lights: edges and vertices are met all the time.
#[test]
fn degenerate_lattices() {
    let mut random = Random::new(5);
    let (mut ambiguous, mut shadowed, mut touching) = (0, 0, 0);
    for _ in 0..400 {
        let mut lattice =
            |low: i64| DVec3::from_array([0; 3].map(|_| random.integer(low, 6) as f64));
        let points: Vec<DVec3> = (0..24).map(|_| lattice(-6)).collect();
        let places: Vec<DVec3> = (0..200).map(|_| lattice(-6)).collect();
        let (point, along) = (lattice(-6), lattice(-6));
        let mut mesh = scene(&points, &[[0, 1, 2], [3, 4, 5], [6, 7, 8], [0, 4, 8], [9, 10, 11]]);
        append_grid(&mut mesh, 6, |x, z| DVec3::new(6.0 * x, 0.0, 6.0 * z));
        append_grid(&mut mesh, 3, |x, y| DVec3::new(6.0 * x, 6.0 * y, 2.0));
        let receivers: Vec<_> =
            places.iter().map(|&position| Receiver { position, triangle: u32::MAX }).collect();
        for light in [LightEnd::Point(point), LightEnd::Along(along * 16.0)] {
            equal(&mesh, &receivers, light).unwrap();
            for answer in truths(&mesh, &receivers, light).iter() {
                ambiguous += u32::from(answer.truth == Truth::Ambiguous);
                shadowed += u32::from(matches!(answer.truth, Truth::Shadowed(_)));
                touching += u32::from(answer.touching > 0);
            }
        }
    }
    assert!(
        ambiguous > 1000 && shadowed > 10_000 && touching > 1000,
        "{ambiguous} ambiguous, {shadowed} shadowed, {touching} touching"
    );
}

/// A lamp inside a closed room: receivers all around, walls that reach behind the light.
#[test]
fn a_lamp_inside_a_room() {
    let mut room = cube(6, DVec3::ZERO, 4.0);
    let ball = icosphere(2, DVec3::new(1.0, 0.5, -0.5), 0.75);
    append(&mut room, &ball.positions, &ball.triangles);
    let mut random = Random::new(6);
    let receivers = receivers(&room, 20_000, &mut random);
    equal(&room, &receivers, LightEnd::Point(DVec3::new(-1.0, 0.25, 0.3))).unwrap();
    equal(&room, &receivers, LightEnd::Point(DVec3::new(0.0, 3.999, 0.0))).unwrap();
    // On a wall, and at a receiver.
    equal(&room, &receivers, LightEnd::Point(DVec3::new(0.3, 4.0, 0.1))).unwrap();
    equal(&room, &receivers, LightEnd::Point(receivers[77].position)).unwrap();
}

/// A hundred sheets over each other, and a fence of slats much thinner than a cell.
#[test]
fn large_overlap_and_thin_geometry() {
    let mut sheets = Geometry::default();
    for k in 0..100 {
        append_grid(&mut sheets, 2, |x, z| DVec3::new(9.0 * x, 0.05 * f64::from(k), 9.0 * z));
    }
    let mut fence = Geometry::default();
    append_grid(&mut fence, 1, |x, z| DVec3::new(8.0 * x, 0.0, 8.0 * z));
    for k in 0..400 {
        let x = 0.03 * f64::from(k) - 6.0;
        append_grid(&mut fence, 1, |s, y| DVec3::new(x + 2e-4 * s, 1.0 + y, 0.01 * x));
    }
    let mut random = Random::new(7);
    for scene in [sheets, fence] {
        let receivers = receivers(&scene, 30_000, &mut random);
        for light in lights(&scene, &mut random) {
            equal(&scene, &receivers, light).unwrap();
        }
    }
}

/// Every instruction set and any number of threads give the same answers.
#[test]
fn levels_and_threads_agree() {
    let scene = still_life(3);
    let mut random = Random::new(8);
    let receivers = receivers(&scene, 40_000, &mut random);
    let light = LightEnd::Point(DVec3::new(3.0, 9.0, 4.0));
    let expected = truths(&scene, &receivers, light);
    let mut first = None;
    for &level in Level::ALL.iter().filter(|level| level.is_available()) {
        for threads in [1, 2, 5] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let options = Options { level, ..Options::default() };
            let run = || truths_with(&scene, &receivers, light, options);
            let (answers, work) = pool.install(run);
            assert!(answers == expected, "{level}, {threads} threads");
            assert!(work.escalated < 40_000, "{work:?}");
            assert_eq!(work, *first.get_or_insert(work), "{level}, {threads} threads");
        }
    }
}

/// Every skip alone, and none of them, leave the answers as they are; each does skip something.
#[test]
fn skips_change_no_answer() {
    let mut scene = still_life(3);
    // A sheet under the floor, another beside all receivers.
    append_grid(&mut scene, 16, |x, z| DVec3::new(4.0 * x, -2.0, 4.0 * z));
    append_grid(&mut scene, 4, |x, z| DVec3::new(40.0 + x, 0.0, 40.0 + z));
    let mut random = Random::new(9);
    let seen = 0..still_life(3).triangles.len() as u32;
    let mut receivers = receivers(&scene, 40_000, &mut random);
    receivers.retain(|r| seen.contains(&r.triangle));
    for light in [LightEnd::Point(DVec3::new(3.0, 9.0, 4.0)), LightEnd::Along(DVec3::Y * 200.0)] {
        let run =
            |skips| truths_with(&scene, &receivers, light, Options { skips, ..Options::default() });
        let (expected, none) = run(Skips::NONE);
        assert_eq!((none.empty, none.behind), (0, 0), "{none:?}");
        let only = [
            Skips { empty: true, ..Skips::NONE },
            Skips { behind: true, ..Skips::NONE },
            Skips { between: true, ..Skips::NONE },
            Skips::ALL,
        ];
        for skips in only {
            let (answers, work) = run(skips);
            assert!(answers == expected, "{skips:?}");
            let sum = work.outside + work.empty + work.behind + work.swept;
            assert_eq!(sum, work.triangles, "{work:?}");
            assert!(work.evaluated <= none.evaluated, "{skips:?}");
        }
        let (_, all) = run(Skips::ALL);
        assert!(all.behind > 0 && all.empty > 0 && all.outside > 0, "{all:?}");
        assert!(all.evaluated < none.evaluated, "{all:?} {none:?}");
    }
}

/// The grid's box is guessed from a sample; receivers beside it are answered like the others.
#[test]
fn receivers_beside_the_sampled_box() {
    let scene = still_life(2);
    let mut random = Random::new(10);
    let mut receivers = receivers(&scene, 40_000, &mut random);
    // Every third one is in the sample.
    receivers[1].position = DVec3::new(-60.0, 1.0, 50.0);
    receivers[20_000].position = DVec3::new(40.0, -30.0, 0.0);
    for light in [LightEnd::Point(DVec3::new(3.0, 9.0, 4.0)), LightEnd::Along(DVec3::Y * 200.0)] {
        equal(&scene, &receivers, light).unwrap();
    }
}

/// What the raster cannot hold goes to the rays: absurd coordinates, receivers at the light.
#[test]
fn leftovers_are_answered_too() {
    let scene = still_life(1);
    let light = DVec3::new(3.0, 9.0, 4.0);
    let odd =
        [light, DVec3::splat(f64::NAN), DVec3::splat(1e300), DVec3::new(1.0, f64::INFINITY, 0.0)];
    let receivers = odd.map(|position| Receiver { position, triangle: 0 });
    for light in [LightEnd::Point(light), LightEnd::Along(DVec3::new(1.0, 90.0, 3.0))] {
        equal(&scene, &receivers, light).unwrap();
        for receiver in receivers {
            equal(&scene, &[receiver], light).unwrap();
        }
    }
    let nothing = Geometry::default();
    let one = truths(&nothing, &receivers[..1], LightEnd::Point(DVec3::ZERO));
    assert_eq!(one.iter().collect::<Vec<_>>(), [Answer::LIT]);
    assert!(truths(&scene, &[], LightEnd::Point(light)).is_empty());
}
