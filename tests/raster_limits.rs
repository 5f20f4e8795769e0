//! The raster at its limits: any order of drawing (R11), the near plane (R13), the largest map (R14).

#[path = "support/meshes.rs"]
mod meshes;

use glam::{DVec2, DVec4, Vec4};
use gnomon::depth::DepthFormat;
use gnomon::device::DeviceProfile;
use gnomon::raster::{NO_TRIANGLE, Pass, PolygonOffset, Raster, Setup, draw};
use gnomon::scene::Cull;
use meshes::Random;

const SIDE: u32 = 48;

fn drawn(depth_buffer: DepthFormat, clip: &[Vec4], triangles: &[[u32; 3]]) -> Raster {
    let offset = PolygonOffset::default();
    let pass =
        Pass { size: [SIDE; 2], cull: Cull::None, depth_buffer, offset, clip: Default::default() };
    draw(&DeviceProfile::Ideal.device(), &pass, clip, triangles)
}

fn between(random: &mut Random, low: f64, high: f64) -> f64 {
    low + (high - low) * random.integer(0, 1 << 20) as f64 / f64::from(1 << 20)
}

/// R11: 1000 shuffles of the triangles, each with one of the six orders of its vertices, draw the same
/// depths bit for bit.
#[test]
fn no_order_of_triangles_or_vertices_changes_a_depth() {
    const ORDERS: [[usize; 3]; 6] =
        [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0], [1, 0, 2]];
    let mut random = Random::new(11);
    let clip: Vec<Vec4> = (0..60)
        .map(|_| {
            let w = between(&mut random, 0.5, 4.0);
            let at = [0; 3].map(|_| (between(&mut random, -1.3, 1.3) * w) as f32);
            Vec4::new(at[0], at[1], at[2], w as f32)
        })
        .collect();
    let mut triangles: Vec<[u32; 3]> =
        (0..40).map(|_| [0; 3].map(|_| random.index(clip.len()) as u32)).collect();
    for format in [DepthFormat::F32, DepthFormat::Unorm16] {
        let first = drawn(format, &clip, &triangles);
        let covered = first.triangle.iter().filter(|&&t| t != NO_TRIANGLE).count();
        assert!(covered > 1000, "{covered} texels covered");
        for round in 0..1000 {
            for i in (1..triangles.len()).rev() {
                triangles.swap(i, random.index(i + 1));
            }
            for triangle in &mut triangles {
                *triangle = ORDERS[random.index(6)].map(|k| triangle[k]);
            }
            let again = drawn(format, &clip, &triangles);
            let differ = (0..first.depth.len())
                .find(|&i| first.depth[i].to_bits() != again.depth[i].to_bits());
            assert_eq!(differ, None, "{format} in round {round}");
        }
    }
}

/// A triangle cut to the view volume in f64, its corners in pixels, origin at the centre of pixel (0, 0).
fn visible(corners: [Vec4; 3]) -> Vec<DVec2> {
    let planes = [
        DVec4::new(0.0, 0.0, 1.0, 1.0),
        DVec4::new(0.0, 0.0, -1.0, 1.0),
        DVec4::new(1.0, 0.0, 0.0, 1.0),
        DVec4::new(-1.0, 0.0, 0.0, 1.0),
        DVec4::new(0.0, 1.0, 0.0, 1.0),
        DVec4::new(0.0, -1.0, 0.0, 1.0),
    ];
    let mut polygon: Vec<DVec4> = corners.map(|v| v.as_dvec4()).to_vec();
    for plane in planes {
        let mut kept = Vec::new();
        for (i, &a) in polygon.iter().enumerate() {
            let b = polygon[(i + 1) % polygon.len()];
            let (da, db) = (plane.dot(a), plane.dot(b));
            if da >= 0.0 {
                kept.push(a);
            }
            if (da >= 0.0) != (db >= 0.0) {
                kept.push((a * db - b * da) / (db - da));
            }
        }
        polygon = kept;
    }
    let pixel = |x: f64| (x + 1.0) * 0.5 * f64::from(SIDE) - 0.5;
    let flat = |v: &DVec4| DVec2::new(pixel(v.x / v.w), pixel(v.y / v.w));
    polygon.iter().filter(|v| v.w > 0.0).map(flat).collect()
}

fn to_segment(p: DVec2, a: DVec2, b: DVec2) -> f64 {
    let along = b - a;
    let t = ((p - a).dot(along) / along.length_squared().max(1e-300)).clamp(0.0, 1.0);
    (p - a - along * t).length()
}

/// How far a point lies outside a convex polygon, in pixels; 0 inside.
fn outside(p: DVec2, polygon: &[DVec2]) -> f64 {
    let edges = || (0..polygon.len()).map(|i| (polygon[i], polygon[(i + 1) % polygon.len()]));
    let sides: Vec<f64> = edges().map(|(a, b)| (b - a).perp_dot(p - a)).collect();
    let inside = sides.iter().all(|&s| s >= 0.0) || sides.iter().all(|&s| s <= 0.0);
    if inside && polygon.len() > 2 {
        return 0.0;
    }
    edges().map(|(a, b)| to_segment(p, a, b)).fold(f64::INFINITY, f64::min)
}

/// A corner before, behind or beside the eye, half of them nearer than the near plane.
fn corner(random: &mut Random) -> Vec4 {
    let w = between(random, -2.0, 3.0);
    let [x, y, z] = [0; 3].map(|_| between(random, -3.0, 3.0));
    Vec4::new(x as f32, y as f32, z as f32, w as f32)
}

fn centre(pixel: usize) -> DVec2 {
    DVec2::new((pixel % SIDE as usize) as f64, (pixel / SIDE as usize) as f64)
}

/// Vertices move by half a sub-pixel, and new ones by a few ulps before: 1/128 pixel holds both.
const SNAP: f64 = 1.0 / 128.0;

/// R13: of 10⁵ triangles through the near plane or behind the eye nothing is drawn outside what is
/// visible of them, and no depth is NaN.
#[test]
fn nothing_is_drawn_outside_a_clipped_triangle() {
    let mut random = Random::new(13);
    let (mut crossing, mut covered) = (0, 0);
    while crossing < 100_000 {
        let corners = [0; 3].map(|_| corner(&mut random));
        let before = |v: &Vec4| v.z + v.w >= 0.0 && v.w > 0.0;
        if corners.iter().all(before) || !corners.iter().any(before) {
            continue;
        }
        crossing += 1;
        let raster = drawn(DepthFormat::F32, &corners, &[[0, 1, 2]]);
        let polygon = visible(corners);
        for (i, &triangle) in raster.triangle.iter().enumerate() {
            assert!(!raster.depth[i].is_nan(), "NaN from {corners:?}");
            if triangle != NO_TRIANGLE {
                covered += 1;
                let off = outside(centre(i), &polygon);
                assert!(off <= SNAP, "pixel {i} is {off} pixels outside {corners:?}");
            }
        }
    }
    assert!(covered > 1_000_000, "{covered} covered");
}

/// R13: two triangles that meet in an edge through the near plane leave no pixel along it out, and cover
/// none twice.
#[test]
fn clipped_neighbours_have_no_crack() {
    let mut random = Random::new(14);
    let (mut pairs, mut along) = (0, 0);
    while pairs < 20_000 {
        let [a, b, c, d] = [0; 4].map(|_| corner(&mut random));
        let both = [visible([a, b, c]), visible([b, a, d])];
        let shared = visible([a, b, b]);
        if both.iter().any(|p| p.len() < 3) || shared.len() < 2 || (a.z + a.w) * (b.z + b.w) >= 0.0
        {
            continue;
        }
        let ends = farthest(&shared);
        let side = |p: &[DVec2]| {
            let middle = p.iter().sum::<DVec2>() / p.len() as f64;
            (ends[1] - ends[0]).perp_dot(middle - ends[0])
        };
        if side(&both[0]) * side(&both[1]) >= 0.0 {
            continue;
        }
        pairs += 1;
        let rasters = [[a, b, c], [b, a, d]].map(|t| drawn(DepthFormat::F32, &t, &[[0, 1, 2]]));
        for i in 0..rasters[0].triangle.len() {
            let p = centre(i);
            let hits = rasters.iter().filter(|r| r.triangle[i] != NO_TRIANGLE).count();
            assert!(hits < 2, "pixel {i} twice: {a:?} {b:?} {c:?} {d:?}");
            let others = both.iter().flat_map(|polygon| {
                let edges =
                    (0..polygon.len()).map(|k| [polygon[k], polygon[(k + 1) % polygon.len()]]);
                edges.filter(|edge| edge.iter().any(|&q| to_segment(q, ends[0], ends[1]) > 1e-6))
            });
            let free = others.map(|[q, r]| to_segment(p, q, r)).fold(f64::INFINITY, f64::min);
            if to_segment(p, ends[0], ends[1]) < 1.0 && free > 1.5 {
                along += 1;
                assert_eq!(hits, 1, "pixel {i} left out: {a:?} {b:?} {c:?} {d:?}");
            }
        }
    }
    assert!(along > 20_000, "{along} pixels along shared edges");
}

/// The two points that are farthest from each other.
fn farthest(points: &[DVec2]) -> [DVec2; 2] {
    let pairs = points.iter().flat_map(|&p| points.iter().map(move |&q| [p, q]));
    let length = |pair: &[DVec2; 2]| (pair[1] - pair[0]).length_squared();
    pairs.max_by(|p, q| length(p).total_cmp(&length(q))).expect("points")
}

/// R14: on a map of 65,536² texels with 8 sub-pixel bits no product overflows (overflow checks are on in
/// release too): a square up to twice the view covers every texel once, wherever its triangles meet. Corners
/// farther away are cut in the subject's f32, whose error may reach into the view: never a texel twice.
#[test]
fn the_largest_map_is_covered_to_the_texel() {
    let device = DeviceProfile::Ideal.device();
    let size = [1u32 << 16; 2];
    let mut random = Random::new(14);
    for reach in [1.0f32, 1.000_001, 2.0, 1e6, 1e30] {
        let at = |x: f32, y: f32| Vec4::new(x * reach, y * reach, 0.0, 1.0);
        let [p, q, r, s] = [at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)];
        let apex = [0; 2].map(|_| (between(&mut random, -1.0, 1.0) as f32) * reach);
        let apex = Vec4::new(apex[0], apex[1], 0.0, 1.0);
        let fan = [[p, q, apex], [q, r, apex], [r, s, apex], [s, p, apex]];
        let mut texels = 0u64;
        for corners in fan {
            Setup::new(&device, size, corners).cover(&device, size, Cull::None, |_, first, end| {
                texels += u64::from(end - first);
            });
        }
        match reach {
            ..=2.0 => assert_eq!(texels, 1 << 32, "reach {reach}"),
            _ => assert!(texels <= 1 << 32, "reach {reach}: {texels}"),
        }
    }
}
