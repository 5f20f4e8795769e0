//! Measured thresholds against the closed forms of planes, filters, normal offsets and scales.

use glam::DVec3;
use gnomon::analysis::budget::Budget;
use gnomon::analysis::sweep::chart::{Attachment, Chart};
use gnomon::analysis::sweep::tally::Kind;
use gnomon::analysis::sweep::{Field, Question, Swept, sweep};
use gnomon::depth::{DepthFormat, Packing};
use gnomon::raster::passes::Subject;
use gnomon::scene::{Case, Filter, TexelFormat, cases::analytic};
use gnomon::shadow::bias::Strategy;
use gnomon::shadow::{breakpoint, texel_depth};
use gnomon::truth::Receiver;
use gnomon::view::{Projection, View};
use std::sync::Arc;

/// Texel edge, depth range and map size of the analytic planes under the sun.
const TEXEL: f64 = 0.125;
const RANGE: f64 = 16.0;
const SIZE: u32 = 64;

fn random(seed: &mut u64) -> f64 {
    *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*seed >> 11) as f64 / (1u64 << 53) as f64
}

/// The largest margin and the largest breakpoint over the four closed corners of every texel inside the
/// plane: stored depths as rasterised, receiver depths of the plane rounded to f32.
fn corner_thresholds(gx: f32, gz: f32) -> [f64; 2] {
    let case = analytic::tilted_plane(gx, gz);
    let subject = Subject::draw(&case, &case.device.device());
    let depth = |x: f64, z: f64| ((8.0 - (f64::from(gx) * x + f64::from(gz) * z)) / RANGE) as f32;
    let mut largest = [f64::NEG_INFINITY; 2];
    for row in 8..SIZE - 8 {
        for column in 8..SIZE - 8 {
            let stored = subject.map.depth(&subject.device, (row * SIZE + column) as usize);
            for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                let x = f64::from(column + dx) * TEXEL - 4.0;
                let z = 4.0 - f64::from(row + dy) * TEXEL;
                let margin = f64::from(depth(x, z)) - f64::from(stored);
                let first_lit = breakpoint(case.lookup.compare, depth(x, z), stored);
                largest = [largest[0].max(margin), largest[1].max(f64::from(first_lit))];
            }
        }
    }
    largest
}

fn predicted(gx: f64, gz: f64) -> f64 {
    TEXEL / 2.0 * (gx.abs() + gz.abs()) / RANGE
}

#[test]
fn dyadic_planes_meet_their_threshold_to_the_bit() {
    for i in 1..=10i16 {
        for j in -5..5i16 {
            let (gx, gz) = (f32::from(i) / 16.0, f32::from(j) / 16.0);
            let exact = predicted(gx.into(), gz.into());
            let [margin, first_lit] = corner_thresholds(gx, gz);
            assert_eq!(margin, exact, "gradient {gx}, {gz}");
            // D + b rounds to z from half an ulp of z below.
            let half_ulp = 0.5 / f64::from(1 << 24);
            assert!((exact - half_ulp..=exact).contains(&first_lit), "{gx}, {gz}: {first_lit:e}");
        }
    }
}

/// R21 with q > 0: a quantiser to nearest adds q/2 to the threshold, the supremum over 10⁴ phases of the
/// grid, each a texel's centre at another depth and its farthest corner.
#[test]
fn quantised_planes_stay_on_the_safe_side() {
    let mut seed = 12;
    let formats = [
        (TexelFormat::Packed(Packing::R8), 1.0 / 255.0),
        (TexelFormat::Depth(DepthFormat::Unorm16), 1.0 / 65_535.0),
    ];
    for i in 0..1000 {
        let [gx, gz] = [0, 1].map(|_| (random(&mut seed) - 0.5) * 2.0);
        let (texel, quantum) = formats[i % 2];
        let mut case = analytic::tilted_plane(gx as f32, gz as f32);
        case.map = case.map.with(SIZE, texel);
        let (device, rule) = (case.device.device(), case.lookup.compare);
        let corner = predicted(gx, gz);
        let first_lit = |_| {
            let centre = 0.2 + 0.6 * random(&mut seed);
            let stored = texel_depth(&device, &case.map, Some(centre as f32));
            f64::from(breakpoint(rule, (centre + corner) as f32, stored))
        };
        let found = (0..10_000).map(first_lit).fold(f64::NEG_INFINITY, f64::max);
        let exact = corner + quantum / 2.0;
        let rounding = 2.0 / f64::from(1 << 24);
        assert!(found <= exact + rounding, "{gx}, {gz}: {found:e} above {exact:e}");
        assert!(found >= 0.99 * exact - rounding, "{gx}, {gz}: {found:e} below {exact:e}");
    }
}

/// Within 1 % below b*, and above it by no more than the rounding of two f32 depths in [0, 1).
#[test]
fn random_planes_stay_on_the_safe_side() {
    let mut seed = 11;
    for _ in 0..1000 {
        let [gx, gz] = [0, 1].map(|_| ((random(&mut seed) - 0.5) * 2.0) as f32);
        if gx.abs() + gz.abs() < 0.1 {
            continue;
        }
        let ([_, found], exact) = (corner_thresholds(gx, gz), predicted(gx.into(), gz.into()));
        let rounding = 2.0 / f64::from(1 << 24);
        assert!(found <= exact + rounding, "{gx}, {gz}: {found:e} above {exact:e}");
        assert!(found >= 0.99 * exact - rounding, "{gx}, {gz}: {found:e} below {exact:e}");
    }
}

/// Receivers that look up the corners and the surroundings of the centre of texels inside the plane,
/// where every filter has its farthest tap, after a move sideways by (x, z).
fn receivers(gx: f64, gz: f64, moved: [f64; 2]) -> Vec<Receiver> {
    const NEAR: f64 = 1.0 / 4096.0;
    let offsets = [NEAR, 0.5 - NEAR, 0.5 + NEAR, 1.0 - NEAR];
    let mut list = Vec::new();
    for row in 20..26 {
        for column in 30..36 {
            for dx in offsets {
                for dy in offsets {
                    let x = (f64::from(column) + dx) * TEXEL - 4.0 - moved[0];
                    let z = 4.0 - (f64::from(row) + dy) * TEXEL - moved[1];
                    let position = DVec3::new(x, gx * x + gz * z, z);
                    list.push(Receiver { position, triangle: 0 });
                }
            }
        }
    }
    list
}

fn swept(case: &Case, list: &[Receiver], filter: Filter, strategy: Strategy, around: f64) -> Swept {
    let field = Field::at(case, list);
    assert_eq!(field.populations[1], 0, "a plane alone is lit");
    let chart = Chart::new(&field, SIZE, filter, Attachment::Depth);
    let amounts = [0.0, 0.5 * around, 2.0 * around].map(|a| a as f32);
    let question = Question { amounts: &amounts, max_acne: 0.0 };
    sweep(&chart, case.map.texel, strategy, &question)
}

#[test]
fn filters_need_their_half_width() {
    let (gx, gz) = (0.5, 0.25);
    let case = analytic::tilted_plane(gx as f32, gz as f32);
    let exact = [
        Filter::Nearest,
        Filter::Bilinear,
        Filter::Pcf3,
        Filter::Pcf5,
        Filter::Pcf7,
        Filter::Pcf9,
        Filter::Pcf3Bilinear,
    ];
    for &filter in Filter::ALL.iter().filter(|&&f| f != Filter::Linear) {
        let need = 2.0 * filter.half_width() * predicted(gx, gz);
        let swept = swept(&case, &receivers(gx, gz, [0.0; 2]), filter, Strategy::Constant, need);
        let found = f64::from(swept.acne_free.expect("it ends").amount);
        assert!(found <= need * (1.0 + 1e-5), "{filter}: {found:e} above {need:e}");
        if exact.contains(&filter) {
            assert!(found >= 0.995 * need, "{filter}: {found:e} is far below {need:e}");
        }
    }
}

#[test]
fn normal_offsets_need_their_closed_form() {
    for (gx, gz) in [(0.5, 0.25), (1.0, 0.0), (0.25, -0.75), (1.0, 0.75)] {
        let case = analytic::tilted_plane(gx as f32, gz as f32);
        let cosine = 1.0 / f64::sqrt(1.0 + gx * gx + gz * gz);
        let need = TEXEL / 2.0 * (gx.abs() + gz.abs()) * cosine;
        let sideways = [-gx * cosine * need, -gz * cosine * need];
        let list = receivers(gx, gz, sideways);
        let swept = swept(&case, &list, Filter::Nearest, Strategy::NormalOffset, need);
        let found = f64::from(swept.acne_free.expect("it ends").amount);
        let off = (found - need).abs() / need;
        assert!(off <= 0.005, "{gx}, {gz}: {found} instead of {need}");
    }
}

#[test]
fn the_receivers_own_plane_needs_no_bias() {
    let (gx, gz) = (0.25, 0.125);
    let case = analytic::tilted_plane(gx as f32, gz as f32);
    let list = receivers(gx, gz, [0.0; 2]);
    for filter in [Filter::Nearest, Filter::Pcf5, Filter::Bilinear] {
        let swept = swept(&case, &list, filter, Strategy::ReceiverPlane, 1e-3);
        let found = swept.acne_free.expect("it ends").amount;
        assert!(f64::from(found) <= 2.0 / f64::from(1 << 24), "{filter}: {found:e}");
    }
}

/// Receivers near the corners of texels in the middle of a spot's map, on the plane y = gx·x + gz·z.
fn receivers_under_spot(gx: f64, gz: f64) -> Vec<Receiver> {
    const NEAR: f64 = 1.0 / 4096.0;
    let half = libm::tan(30.0 * std::f64::consts::PI / 180.0);
    let tangent = |texel: f64| (2.0 * texel / f64::from(SIZE) - 1.0) * half;
    let mut list = Vec::new();
    for row in 24..40 {
        for column in 24..40 {
            for (dx, dy) in
                [(NEAR, NEAR), (1.0 - NEAR, NEAR), (NEAR, 1.0 - NEAR), (1.0 - NEAR, 1.0 - NEAR)]
            {
                let [x, y] = [f64::from(column) + dx, f64::from(row) + dy].map(tangent);
                // The map's up is −z.
                let distance = 8.0 / (1.0 + gx * x - gz * y);
                let position = DVec3::new(distance * x, 8.0 - distance, -distance * y);
                list.push(Receiver { position, triangle: 0 });
            }
        }
    }
    list
}

/// In window depth the threshold under a spot is the same all over the plane.
#[test]
fn a_spot_needs_one_window_bias_everywhere() {
    for (gx, gz) in [(0.5, 0.25), (0.25, -0.5), (-0.125, 0.375)] {
        let case = analytic::spot_plane(gx as f32, gz as f32);
        let need = case.facts[0].value;
        let list = receivers_under_spot(gx, gz);
        let found = swept(&case, &list, Filter::Nearest, Strategy::Constant, need);
        let found = f64::from(found.acne_free.expect("it ends").amount);
        // Two depths and their sum are rounded to f32; snapped vertices tilt a plane by up to 1/256.
        let rounding = 2.0 / f64::from(1 << 24);
        let bound = need * (1.0 + 1.0 / 256.0) + rounding;
        assert!(found <= bound, "{gx}, {gz}: {found:e} above {need:e}");
        assert!(found >= 0.995 * need - rounding, "{gx}, {gz}: {found:e} below {need:e}");
    }
    let case = analytic::spot_plane(0.5, 0.25);
    let field = Field::new(&case, 2);
    let chart = Chart::new(&field, SIZE, Filter::Nearest, Attachment::Depth);
    let question = Question { amounts: &[0.0], max_acne: 0.0 };
    let swept = sweep(&chart, case.map.texel, Strategy::Constant, &question);
    let rate = swept.points[0].tally.of(Kind::ACNE) as f64 / swept.populations[0] as f64;
    assert!((rate - 0.5).abs() < 0.01, "half of the plane is dark without a bias: {rate}");
}

/// The components of a need add up to it, and on planes the slope's share is all of it within 5 %.
#[test]
fn budgets_add_up() {
    for case in [
        analytic::tilted_plane(0.5, 0.25),
        analytic::dyadic_plane(),
        analytic::spot_plane(0.5, 0.25),
    ] {
        let field = Field::new(&case, 1);
        let budget = Budget::of(&field);
        let total = budget.total.expect("acne ends");
        assert!((budget.sum() - total).abs() <= 1e-12, "{}: {budget:?}", case.name);
        assert!((budget.slope - total).abs() <= 0.05 * total, "{}: {budget:?}", case.name);
        let half = budget.twice_the_map.expect("acne ends") / total;
        assert!((half - 0.5).abs() < 0.03, "{}: a map of twice the size needs {half}", case.name);
    }
}

/// A scene scaled by a power of two has the same verdicts to the bit.
#[test]
fn powers_of_two_change_nothing() {
    let kinds = |k: i32| {
        let scale = gnomon::num::exp2(k);
        let mut case = analytic::plates();
        for object in &mut case.objects {
            Arc::make_mut(&mut object.mesh).positions.iter_mut().for_each(|p| *p *= scale as f32);
        }
        let length = |x: &mut f64| *x *= scale;
        let view = |v: View| View { position: v.position * scale, target: v.target * scale, ..v };
        let projection = |mut projection: Projection| {
            if let Projection::Orthographic { width, height, near, far } = &mut projection {
                [width, height, near, far].into_iter().for_each(length);
            }
            projection
        };
        case.light = case.light.remade(view, projection);
        case.camera.view = view(case.camera.view);
        case.camera.projection = projection(case.camera.projection);
        let field = Field::new(&case, 8);
        let chart = Chart::new(&field, SIZE, Filter::Nearest, Attachment::Depth);
        let looks = chart.looks(case.map.texel, &Strategy::Constant.with(0.0));
        let rule = case.lookup.compare;
        looks.iter().map(|l| l.verdict(rule, 0.002).0).collect::<Vec<_>>()
    };
    let unit = kinds(0);
    assert!(unit.iter().any(Option::is_some), "something is wrong at this bias");
    for k in [1, -1, 7, -7, 20, -20] {
        assert_eq!(kinds(k), unit, "scaled by 2^{k}");
    }
}
