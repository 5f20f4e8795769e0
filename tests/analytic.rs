//! Closed forms against measurement: tilted plane, wall, sphere, two plates.

use gnomon::analysis::measure::measure;
use gnomon::analysis::observe::{Observer, Standing};
use gnomon::analysis::walk::Walk;
use gnomon::raster::NO_TRIANGLE;
use gnomon::scene::{Case, cases::analytic};
use gnomon::shadow::breakpoint;
use gnomon::truth::Truth;

fn fact(case: &Case, quantity: &str) -> f64 {
    case.facts.iter().find(|f| f.quantity == quantity).expect("a known fact").value
}

/// The largest margin and breakpoint over every interior texel, each taken at its four closed corners.
/// All numbers are dyadic, so the receiver depths are exact in f32 and the margins exact in f64.
fn critical_at_corners(case: &Case, gx: f64, gz: f64) -> (f64, f32) {
    let observer = Observer::new(case, &case.device.device());
    let size = case.map.size;
    let subject = &observer.subject;
    let (mut margin, mut critical) = (f64::NEG_INFINITY, f32::NEG_INFINITY);
    let mut texels = 0;
    for y in 0..size {
        for x in 0..size {
            let texel = (y * size + x) as usize;
            if subject.map_raster.triangle[texel] == NO_TRIANGLE {
                continue;
            }
            texels += 1;
            let stored = subject.map.depth(&subject.device, texel);
            for (dx, dy) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)] {
                let world_x = (f64::from(x) + dx) / 8.0 - 4.0;
                let world_z = 4.0 - (f64::from(y) + dy) / 8.0;
                let depth = (8.0 - (gx * world_x + gz * world_z)) / 16.0;
                assert_eq!(f64::from(depth as f32), depth, "dyadic");
                margin = margin.max(depth - f64::from(stored));
                critical = critical.max(breakpoint(case.lookup.compare, depth as f32, stored));
            }
        }
    }
    assert_eq!(texels, 56 * 56, "the plane covers 7 of 8 world units");
    (margin, critical)
}

#[test]
fn critical_bias_of_dyadic_planes_is_exact_to_the_bit() {
    let mut planes = 0;
    for i in -5i32..=5 {
        for j in -5i32..=5 {
            let (gx, gz) = (f64::from(i) / 8.0, f64::from(j) / 16.0);
            if (i, j) == (0, 0) {
                continue;
            }
            let case = analytic::tilted_plane(gx as f32, gz as f32);
            let expected = fact(&case, "critical_bias");
            let (margin, critical) = critical_at_corners(&case, gx, gz);
            assert_eq!(margin.to_bits(), expected.to_bits(), "g = ({gx}, {gz}): {margin:e}");
            // The literal rule rounds D + b to f32: lit from half an ulp of the depth below on.
            let slack = expected - f64::from(critical);
            let half_ulp = f64::from(f32::EPSILON) / 4.0;
            assert!((0.0..=half_ulp).contains(&slack), "g = ({gx}, {gz}): {critical:e}");
            planes += 1;
        }
    }
    assert!(planes >= 100, "{planes} planes");
}

#[test]
fn pixels_never_need_more_than_the_critical_bias() {
    let case = analytic::tilted_plane(0.5, 0.25);
    let measured = measure(&case, 1).measurement;
    let bound = fact(&case, "critical_bias");
    let critical = f64::from(measured.thresholds.critical.expect("acne"));
    assert!(critical <= bound * (1.0 + 1e-6), "{critical} exceeds {bound}");
    assert!(critical >= 0.99 * bound, "{critical} against {bound}");
    let rate = measured.without_bias.false_shadow as f64 / measured.lit as f64;
    assert!((rate - 0.5).abs() < 0.005, "half the plane is dark without bias: {rate}");
}

#[test]
fn stripes_repeat_with_the_texel() {
    // Axis-aligned slope gx: stripes along z, period s/cos(theta) on the surface.
    let case = analytic::tilted_plane(0.5, 0.0);
    let measured = measure(&case, 4).measurement;
    let period = measured.stripe_period.expect("stripes").world;
    let expected = 0.125 * f64::sqrt(1.25);
    assert!((period / expected - 1.0).abs() < 1e-3, "{period} against {expected}");
}

#[test]
fn a_wall_opens_a_gap_of_b_cos_alpha() {
    let case = analytic::wall();
    let expected = fact(&case, "peter_panning_world");
    let measured = measure(&case, 4).measurement;
    let gap = measured.peter_panning.expect("peter-panning").world;
    assert!((gap / expected - 1.0).abs() < 0.005, "{gap} against {expected}");
    assert_eq!(
        measured.false_light.by_cause["bias"], measured.false_light.count,
        "by the bias alone"
    );
}

#[test]
fn the_gap_grows_with_the_bias() {
    let case = analytic::wall();
    let measured = measure(&case, 8);
    let falsely_lit = measured.observations.iter().find(|o| {
        o.truly_lit() == Some(false) && o.breakpoints[0] < 0.02 && o.breakpoints[0] > 0.01
    });
    let receiver = falsely_lit.expect("a receiver near the foot").receiver;
    for bias in [0.02f32, 0.04, 0.06] {
        let walk = Walk::along_light(&measured.observer, &receiver, bias).expect("a direction");
        let gap = walk.false_light_length().expect("lit at this bias");
        let expected = f64::from(bias) * 16.0 * 0.6;
        assert!((gap / expected - 1.0).abs() < 0.01, "bias {bias}: {gap} against {expected}");
    }
}

#[test]
fn a_sphere_casts_an_ellipse() {
    let case = analytic::sphere();
    let measured = measure(&case, 1);
    let shadowed = measured.observations.iter().filter(|o| {
        o.standing == Standing::Counted && matches!(o.answer.truth, Truth::Shadowed(_))
    });
    let pixel = 5.0 / 400.0;
    let area = shadowed.count() as f64 * pixel * pixel;
    let expected = fact(&case, "shadow_area_world");
    // The inscribed 128-gon loses 4e-4 of the area; pixel counting adds a border's noise.
    assert!((area / expected - 1.0).abs() < 0.002, "{area} against {expected}");
    assert_eq!(measured.measurement.samples.ambiguous, 0);
}

#[test]
fn two_plates_leave_the_predicted_window() {
    let case = analytic::plates();
    let measured = measure(&case, 1).measurement;
    let critical = f64::from(measured.thresholds.critical.expect("acne"));
    let detachment = f64::from(measured.thresholds.detachment.expect("a shadow"));
    let (low, high) = (fact(&case, "critical_bias"), fact(&case, "detachment_bias"));
    assert!(critical <= low * (1.0 + 1e-6) && critical > 0.95 * low, "{critical} against {low}");
    assert!(detachment >= high * (1.0 - 1e-6) && detachment < 1.05 * high, "{detachment}, {high}");
}
