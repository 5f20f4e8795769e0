//! The rules of coverage and depth, against exact integers: R9, R10 and R12 of the raster (R8 is in `fans.rs`).

#[path = "support/meshes.rs"]
mod meshes;

use glam::Vec4;
use gnomon::depth::DepthFormat;
use gnomon::device::DeviceProfile;
use gnomon::raster::{NO_TRIANGLE, Pass, PolygonOffset, Raster, draw};
use gnomon::scene::Cull;
use meshes::Random;

/// Pixels along a side, and sub-pixels of a pixel.
const SIDE: i64 = 32;
const GRID: i64 = 256;

type Point = [i64; 2];

/// A place in sub-pixels, whose origin is the centre of pixel (0, 0), in clip space: exact in f32.
fn clip([x, y]: Point, depth: f64) -> Vec4 {
    let half = (SIDE * GRID / 2) as f64;
    let axis = |x: i64| ((x + GRID / 2) as f64 / half - 1.0) as f32;
    Vec4::new(axis(x), axis(y), (2.0 * depth - 1.0) as f32, 1.0)
}

fn drawn(corners: &[Vec4], triangles: &[[u32; 3]]) -> Raster {
    let pass = Pass {
        size: [SIDE as u32; 2],
        cull: Cull::None,
        depth_buffer: DepthFormat::F32,
        offset: PolygonOffset::default(),
        clip: Default::default(),
    };
    draw(&DeviceProfile::Ideal.device(), &pass, corners, triangles)
}

fn double_area([a, b, c]: [Point; 3]) -> i64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])
}

/// Whether a pixel's centre is inside: left and lower edges belong to the triangle.
fn covers(corners: [Point; 3], pixel: usize) -> bool {
    let p = [pixel as i64 % SIDE * GRID, pixel as i64 / SIDE * GRID];
    let [a, b, c] = corners;
    let turned = if double_area(corners) < 0 { [a, c, b] } else { corners };
    double_area(corners) != 0
        && (0..3).all(|i| {
            let (from, to) = (turned[i], turned[(i + 1) % 3]);
            let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
            let side = double_area([from, to, p]);
            side > 0 || (side == 0 && (dy < 0 || (dy == 0 && dx > 0)))
        })
}

/// A third slivers, a tenth with a corner on a pixel's centre and an edge through others.
fn triangle(random: &mut Random) -> [Point; 3] {
    let span = SIDE * GRID;
    let mut point = || [0; 2].map(|_| random.integer(-GRID / 2, span - GRID / 2));
    let mut corners = [point(), point(), point()];
    if random.index(10) < 3 {
        let k = random.integer(0, 64);
        let mix = |axis: usize| {
            let (a, b) = (corners[0][axis], corners[1][axis]);
            (a + (b - a) * k / 64 + random.integer(-3, 3)).clamp(-GRID / 2, span - GRID / 2)
        };
        corners[2] = [0, 1].map(mix);
    }
    if random.index(10) == 0 {
        let on_centre = |p: Point| p.map(|x| (x / GRID).max(0) * GRID);
        corners = [on_centre(corners[0]), on_centre(corners[1]), corners[2]];
    }
    corners
}

/// R10: differing pixels of random triangles, and covered ones.
fn coverage(count: usize, seed: u64) -> (usize, usize) {
    let mut random = Random::new(seed);
    let (mut differing, mut covered) = (0, 0);
    for _ in 0..count {
        let corners = triangle(&mut random);
        let raster = drawn(&corners.map(|p| clip(p, 0.5)), &[[0, 1, 2]]);
        for (pixel, &id) in raster.triangle.iter().enumerate() {
            let inside = covers(corners, pixel);
            differing += usize::from(inside != (id != NO_TRIANGLE));
            covered += usize::from(inside);
        }
    }
    (differing, covered)
}

#[test]
fn ten_thousand_triangles_cover_what_integers_say() {
    let (differing, covered) = coverage(10_000, 10);
    assert_eq!(differing, 0);
    assert!(covered > 500_000, "{covered} covered");
}

#[test]
#[ignore = "soak: 10^6 triangles against integers, about 60 s"]
fn a_million_triangles_cover_what_integers_say() {
    let (differing, covered) = coverage(1_000_000, 11);
    println!("{covered} covered, {differing} differ");
    assert_eq!(differing, 0);
}

/// How often each pixel is covered by triangles drawn one by one.
fn hits(corners: &[Vec4], triangles: &[[u32; 3]]) -> Vec<u32> {
    let mut hits = vec![0; (SIDE * SIDE) as usize];
    for &t in triangles {
        let raster = drawn(corners, &[t]);
        for (hits, &id) in hits.iter_mut().zip(&raster.triangle) {
            *hits += u32::from(id != NO_TRIANGLE);
        }
    }
    hits
}

/// R9: the five fill-rule cases of dEQP (basic, reversed, clipped in part and in full, projected),
/// each in 32 rotations: a strip of four quads never covers a pixel twice, and leaves no hole that
/// the same strip as one quad covers.
#[test]
fn rotated_quads_neither_overlap_nor_leave_holes() {
    let mut covered = 0;
    for (name, half, reversed, perspective) in [
        ("basic", 0.6, false, 0.0),
        ("reversed", 0.6, true, 0.0),
        ("clipped in part", 1.1, false, 0.0),
        ("clipped in full", 3.0, false, 0.0),
        ("projected", 0.6, false, 0.5),
    ] {
        for turn in 0..32 {
            let angle = f64::from(turn) * std::f64::consts::TAU / 32.0 + 0.01;
            let (sin, cos) = (libm::sin(angle), libm::cos(angle));
            let corner = |x: f64, y: f64| {
                let (x, y) = (half * (cos * x - sin * y), half * (sin * x + cos * y));
                let w = 1.0 + perspective * x;
                Vec4::new((x * w) as f32, (y * w) as f32, 0.0, w as f32)
            };
            let rows = (0..=4).map(|k| f64::from(k) / 2.0 - 1.0);
            let corners: Vec<Vec4> = rows.flat_map(|y| [corner(-1.0, y), corner(1.0, y)]).collect();
            let quads = (0..4u32).flat_map(|k| {
                let [a, b, c, d] = [2 * k, 2 * k + 1, 2 * k + 2, 2 * k + 3];
                if reversed { [[c, b, a], [d, b, c]] } else { [[a, b, c], [c, b, d]] }
            });
            let triangles: Vec<[u32; 3]> = quads.collect();
            let strip = hits(&corners, &triangles);
            assert!(strip.iter().all(|&h| h <= 1), "{name}, turn {turn}: drawn twice");
            covered += strip.iter().filter(|&&h| h == 1).count();
            // Every pixel whose eight neighbours are covered is covered: no hole inside.
            let at = |x: usize, y: usize| strip[y * SIDE as usize + x];
            for y in 1..SIDE as usize - 1 {
                for x in 1..SIDE as usize - 1 {
                    let around =
                        (0..9).filter(|k| *k != 4).map(|k| at(x + k % 3 - 1, y + k / 3 - 1));
                    let hole = at(x, y) == 0 && around.sum::<u32>() == 8;
                    assert!(!hole, "{name}, turn {turn}: a hole at {x}, {y}");
                }
            }
            if name == "clipped in full" {
                assert!(strip.iter().all(|&h| h == 1), "turn {turn}: the target is not filled");
            }
        }
    }
    assert!(covered > 30_000, "{covered} covered");
}

/// R12: the largest error of stored depths against the rational plane through the snapped triangle,
/// in ulps of f32 and in quanta of 16 bits, over so many samples.
fn depth_errors(samples: usize, seed: u64) -> (f64, f64) {
    let mut random = Random::new(seed);
    let device = DeviceProfile::Ideal.device();
    let (mut seen, mut ulps, mut quanta) = (0, 0.0f64, 0.0f64);
    while seen < samples {
        let corners = triangle(&mut random);
        // Depths are multiples of 2^-23 in [1/8, 7/8): exact in clip space as well.
        let depths = [0; 3].map(|_| random.integer(1 << 20, 7 << 20));
        let exact = |k: i64| k as f64 / f64::from(1 << 23);
        let clip: Vec<Vec4> = (0..3).map(|i| clip(corners[i], exact(depths[i]))).collect();
        let area = i128::from(double_area(corners));
        let raster = drawn(&clip, &[[0, 1, 2]]);
        for (pixel, &z) in raster.depth.iter().enumerate() {
            if raster.triangle[pixel] == NO_TRIANGLE {
                continue;
            }
            seen += 1;
            let p = [pixel as i64 % SIDE * GRID, pixel as i64 / SIDE * GRID];
            let [a, b, c] = corners;
            let weights = [[p, b, c], [a, p, c], [a, b, p]].map(double_area);
            let terms = (0..3).map(|i| i128::from(weights[i]) * i128::from(depths[i]));
            let value: i128 = terms.sum();
            // Error times area, in units of 2^-50: z is a multiple of 2^-27 there.
            let error = |z: f64| {
                let z = (z * (1u64 << 50) as f64) as i128;
                (z * area - (value << 27)).abs() as f64 / (area.abs() as f64 * (1u64 << 50) as f64)
            };
            let ulp = f64::from(z.next_up()) - f64::from(z);
            ulps = ulps.max(error(f64::from(z)) / ulp);
            let code = device.depth_format(DepthFormat::Unorm16).encode(z);
            let truth = value as f64 / area as f64 / f64::from(1 << 23);
            quanta = quanta.max((f64::from(code) - truth * 65_535.0).abs());
        }
    }
    (ulps, quanta)
}

#[test]
fn depths_are_rounded_once() {
    let (ulps, quanta) = depth_errors(300_000, 12);
    assert!(ulps > 0.49 && ulps <= 0.500_000_1, "{ulps} ulp");
    // Half a quantum, and half an ulp of the depth that is quantised.
    assert!(quanta <= 0.5 + 65_535.0 / f64::from(1 << 24) / 2.0, "{quanta} quanta");
}

#[test]
#[ignore = "soak: 10^7 samples, about 30 s"]
fn ten_million_depths_are_rounded_once() {
    let (ulps, quanta) = depth_errors(10_000_000, 13);
    println!("{ulps} ulp, {quanta} quanta");
    assert!(ulps <= 0.500_000_1, "{ulps} ulp");
    assert!(quanta <= 0.5 + 65_535.0 / f64::from(1 << 24) / 2.0, "{quanta} quanta");
}
