//! Drawing by tiles gives the bits of drawing triangle by triangle.

#[path = "support/meshes.rs"]
mod meshes;

use glam::Vec4;
use gnomon::depth::DepthFormat;
use gnomon::device::{Device, DeviceProfile};
use gnomon::raster::{Pass, PolygonOffset, Raster, draw, draw_at, draw_each, draw_into};
use gnomon::scene::Cull;
use gnomon::simd::Level;
use gnomon::view::{ClipRange, ClipSpace};
use meshes::Random;

/// Triangles of every size and place: inside, across the borders, through the near plane, behind
/// the eye, without area, on the pixel grid, over each other, with absurd and subnormal numbers.
fn soup(count: usize, random: &mut Random) -> (Vec<Vec4>, Vec<[u32; 3]>) {
    let mut clip = Vec::new();
    for k in 0..count {
        let size = [1.5, 0.3, 0.03, 0.004][random.index(4)];
        let centre = random.cube() * if k % 3 == 0 { 1.2 } else { 0.7 };
        for _ in 0..3 {
            let mut p = centre + random.cube() * size;
            if k % 5 == 0 {
                p = (p * 64.0).round() / 64.0;
            }
            let w = match k % 7 {
                0 => random.unit() * 3.0 - 1.0,
                1 => 0.01 + random.unit() * 100.0,
                _ => 1.0,
            };
            clip.push(Vec4::new((p.x * w) as f32, (p.y * w) as f32, (p.z * w) as f32, w as f32));
        }
        let last = clip.len() - 1;
        match k % 23 {
            0 => clip[last] = clip[last - 1],
            1 => clip[last].z = f32::NAN,
            2 => clip[last] *= 1e-42,
            3 => clip[last].w = 0.0,
            4 => clip[last].z = -clip[last].w,
            5 => clip[last].w = f32::INFINITY,
            _ => {}
        }
    }
    let corner = |k: usize| (0..3).map(move |c| 3 * k as u32 + c);
    let mut triangles: Vec<[u32; 3]> =
        (0..count).map(|k| corner(k).collect::<Vec<_>>().try_into().expect("three")).collect();
    // The same triangles again, turned around: equal depths, of which the first stays.
    triangles.extend((0..count / 4).map(|k| [3 * k as u32 + 1, 3 * k as u32, 3 * k as u32 + 2]));
    (clip, triangles)
}

fn assert_same(expected: &Raster, found: &Raster, what: &str) {
    assert_eq!(expected.size, found.size, "{what}");
    assert_eq!(expected.empty_triangles, found.empty_triangles, "{what}: empty triangles");
    for i in 0..expected.depth.len() {
        let (want, got) = (expected.depth[i], found.depth[i]);
        let at = [i as u32 % expected.size[0], i as u32 / expected.size[0]];
        assert!(
            want.to_bits() == got.to_bits() && expected.triangle[i] == found.triangle[i],
            "{what}, texel {at:?}: depth {want:e} of {} became {got:e} of {}",
            expected.triangle[i],
            found.triangle[i]
        );
    }
}

fn passes() -> Vec<Pass> {
    let offsets = [
        PolygonOffset::default(),
        PolygonOffset { factor: 1.5, units: 2.0, clamp: 0.0 },
        PolygonOffset { factor: -1.0, units: 0.0, clamp: -0.01 },
    ];
    let mut passes = Vec::new();
    for (k, &depth_buffer) in DepthFormat::ALL.iter().enumerate() {
        let size = [[64, 64], [129, 70], [1, 1], [300, 5], [63, 200], [128, 128], [77, 0]][k];
        for (j, &offset) in offsets.iter().enumerate() {
            passes.push(Pass {
                size,
                cull: Cull::ALL[(k + j) % 3],
                depth_buffer,
                offset,
                clip: Default::default(),
            });
        }
    }
    // The same in the clip spaces of other interfaces, each with another part of them.
    let spaces = [
        (ClipRange::ZeroToOne, true),
        (ClipRange::ZeroToOne, false),
        (ClipRange::MinusOneToOne, true),
    ];
    let turned = passes.clone().into_iter().enumerate().map(|(k, pass)| {
        let (range, reversed) = spaces[k % 3];
        Pass { clip: ClipSpace { range, reversed, y_down: k % 2 == 0 }, ..pass }
    });
    passes.extend(turned.collect::<Vec<_>>());
    passes
}

#[test]
fn every_device_format_offset_and_culling() {
    let mut random = Random::new(11);
    let mut covered = 0;
    for &profile in DeviceProfile::ALL {
        for pass in passes() {
            let (clip, triangles) = soup(120, &mut random);
            let device = profile.device();
            let expected = draw_each(&device, &pass, &clip, &triangles);
            covered += expected.triangle.iter().filter(|&&t| t != u32::MAX).count();
            let what = format!("{profile} {pass:?}");
            assert_same(&expected, &draw(&device, &pass, &clip, &triangles), &what);
        }
    }
    assert!(covered > 100_000, "{covered} texels covered");
}

#[test]
fn levels_threads_and_memory_used_again() {
    let mut random = Random::new(12);
    let device = DeviceProfile::Ideal.device();
    let (clip, triangles) = soup(6_000, &mut random);
    let pass = Pass {
        size: [500, 333],
        cull: Cull::None,
        depth_buffer: DepthFormat::F32,
        offset: PolygonOffset::default(),
        clip: Default::default(),
    };
    let expected = draw_each(&device, &pass, &clip, &triangles);
    let mut again = expected.clone();
    again.depth.fill(0.0);
    for &level in Level::ALL.iter().filter(|level| level.is_available()) {
        for threads in [1, 2, 5] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let what = format!("{level}, {threads} threads");
            let found = pool.install(|| draw_at(level, &device, &pass, &clip, &triangles));
            assert_same(&expected, &found, &what);
            pool.install(|| draw_into(&mut again, level, &device, &pass, &clip, &triangles));
            assert_same(&expected, &again, &what);
        }
    }
}

/// Finer grids than the integers of the fast path hold are drawn all the same.
#[test]
fn fine_grids_and_coarse_ones() {
    let mut random = Random::new(13);
    let (clip, triangles) = soup(200, &mut random);
    let pass = passes()[3];
    for subpixel_bits in [1, 4, 7, 8, 9, 12] {
        let device = Device { subpixel_bits, ..DeviceProfile::Ideal.device() };
        let expected = draw_each(&device, &pass, &clip, &triangles);
        let what = format!("{subpixel_bits} bits");
        assert_same(&expected, &draw(&device, &pass, &clip, &triangles), &what);
    }
}
