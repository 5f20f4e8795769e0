//! Properties of the margin shortcut, the rasteriser and the stores, on inputs biased to trouble.

use glam::Vec4;
use gnomon::depth::DepthFormat;
use gnomon::device::{DeviceProfile, PlaneSetup};
use gnomon::num::{from_ordinal, ordinal};
use gnomon::raster::{NO_TRIANGLE, Pass, PolygonOffset, Setup, draw};
use gnomon::scene::{CompareRule, Cull};
use gnomon::shadow::breakpoint;
use proptest::prelude::*;

fn config() -> ProptestConfig {
    ProptestConfig { cases: 1024, failure_persistence: None, ..ProptestConfig::default() }
}

/// A window depth, half the time within 32 floats of a code boundary.
fn depth() -> impl Strategy<Value = f32> {
    let near_code = (0u32..=255, -32i32..=32).prop_map(|(k, ulps)| {
        let at = (f64::from(k) / 255.0) as f32;
        from_ordinal((ordinal(at) + ulps).clamp(0, ordinal(1.0)))
    });
    prop_oneof![0.0f32..=1.0, near_code, Just(1.0 - f32::EPSILON / 2.0), Just(0.0), Just(1.0)]
}

fn rule() -> impl Strategy<Value = CompareRule> {
    prop::sample::select(CompareRule::ALL)
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn a_breakpoint_is_the_first_lit_bias(rule in rule(), z in depth(), d in depth(), other in -1.0f32..1.0) {
        let b = breakpoint(rule, z, d);
        prop_assert!(rule.is_lit(z, d, b), "{rule}: z {z:e} D {d:e} dark at its breakpoint {b:e}");
        let below = from_ordinal(ordinal(b) - 1);
        prop_assert!(!rule.is_lit(z, d, below), "{rule}: z {z:e} D {d:e} lit below {b:e}");
        prop_assert_eq!(rule.is_lit(z, d, other), other >= b, "{}: z {:e} D {:e} b {:e}", rule, z, d, other);
    }

    #[test]
    fn more_bias_never_darkens(rule in rule(), z in depth(), d in depth(), a in -1.0f32..1.0, c in -1.0f32..1.0) {
        let (low, high) = (a.min(c), a.max(c));
        prop_assert!(!rule.is_lit(z, d, low) || rule.is_lit(z, d, high), "{rule} {z:e} {d:e} {low:e} {high:e}");
    }

    #[test]
    fn stores_are_monotone_and_idempotent(a in depth(), b in depth()) {
        for &format in DepthFormat::ALL {
            let (low, high) = (a.min(b), a.max(b));
            prop_assert!(format.encode(low) <= format.encode(high), "{format} {low:e} {high:e}");
            let once = format.decode(format.encode(a));
            prop_assert_eq!(format.encode(once), format.encode(a), "{} {:e}", format, a);
        }
    }

    /// A fan of triangles around a point covers every pixel of its square exactly once (R8).
    #[test]
    fn fans_neither_double_nor_miss_a_pixel(
        centre in (0i32..512, 0i32..512),
        spokes in prop::collection::vec(0i32..2048, 3..9),
        profile in prop::sample::select(DeviceProfile::ALL),
    ) {
        let device = profile.device();
        let size = [32u32, 32];
        let at = |x: i32, y: i32| Vec4::new(x as f32 / 256.0 - 1.0, y as f32 / 256.0 - 1.0, 0.0, 1.0);
        let rim = |s: i32| match s / 512 {
            0 => at(s % 512, 0),
            1 => at(512, s % 512),
            2 => at(512 - s % 512, 512),
            _ => at(0, 512 - s % 512),
        };
        let mut stops: Vec<i32> = spokes.into_iter().chain([0, 512, 1024, 1536]).collect();
        stops.sort_unstable();
        stops.dedup();
        let mut hits = vec![0u32; 32 * 32];
        for (i, &s) in stops.iter().enumerate() {
            let corners = [at(centre.0, centre.1), rim(s), rim(stops[(i + 1) % stops.len()])];
            let setup = Setup::new(&device, size, corners);
            setup.cover(&device, size, Cull::None, |y, first, end| {
                (first..end).for_each(|x| hits[(y * 32 + x) as usize] += 1);
            });
        }
        prop_assert!(hits.iter().all(|&h| h == 1), "{profile}: {:?}", hits.iter().position(|&h| h != 1));
    }

    /// The order of triangles changes nothing but ties (R11).
    #[test]
    fn drawing_order_does_not_matter(seeds in prop::collection::vec((-1.2f32..1.2, -1.2f32..1.2, -1.2f32..1.2), 9..24)) {
        let clip: Vec<Vec4> = seeds.iter().map(|&(x, y, z)| Vec4::new(x, y, z, 1.0)).collect();
        let triangles: Vec<[u32; 3]> = (0..clip.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let mut backwards = triangles.clone();
        backwards.reverse();
        let pass = Pass {
            size: [48, 48],
            cull: Cull::None,
            depth_buffer: DepthFormat::F32,
            offset: PolygonOffset::default(), clip: Default::default(), };
        let device = DeviceProfile::Ideal.device();
        let (a, b) = (draw(&device, &pass, &clip, &triangles), draw(&device, &pass, &clip, &backwards));
        for (i, (x, y)) in a.depth.iter().zip(&b.depth).enumerate() {
            prop_assert_eq!(x.to_bits(), y.to_bits(), "texel {}", i);
        }
        prop_assert_eq!(a.empty_triangles, b.empty_triangles);
    }

    /// Triangles through the near plane and behind the eye leave no NaN and no depth outside [0,1] (R13).
    #[test]
    fn clipping_leaves_sound_depths(corners in prop::collection::vec((-3.0f32..3.0, -3.0f32..3.0, -3.0f32..3.0, -2.0f32..3.0), 3)) {
        let clip: Vec<Vec4> = corners.iter().map(|&(x, y, z, w)| Vec4::new(x, y, z, w)).collect();
        let pass = Pass {
            size: [32, 32],
            cull: Cull::None,
            depth_buffer: DepthFormat::F32,
            offset: PolygonOffset::default(), clip: Default::default(), };
        for profile in DeviceProfile::ALL {
            let raster = draw(&profile.device(), &pass, &clip, &[[0, 1, 2]]);
            for (z, t) in raster.depth.iter().zip(&raster.triangle) {
                prop_assert!(!z.is_nan(), "{profile}: NaN in the map");
                // The measured f32 planes extrapolate from the unclipped triangle, as the real ones do.
                let exact = profile.device().setup == PlaneSetup::Exact;
                let sound = *t == NO_TRIANGLE || (-0.01..=1.01).contains(z);
                prop_assert!(!exact || sound, "{profile}: depth {z}");
            }
        }
    }
}
