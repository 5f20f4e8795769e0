//! Closed forms against measurement: tilted plane, wall, sphere, two plates.

use glam::DVec3;
use gnomon::analysis::ladder::Rung;
use gnomon::analysis::measure::measure;
use gnomon::analysis::observe::{Observer, Standing};
use gnomon::analysis::walk::Walk;
use gnomon::light::Lens;
use gnomon::raster::NO_TRIANGLE;
use gnomon::scene::{Case, cases::analytic};
use gnomon::shadow::breakpoint;
use gnomon::truth::Truth;
use std::sync::Arc;

/// A look-up of the map of a case at a world position, as its own f32 rule sees it.
struct Probe<'a> {
    observer: Observer<'a>,
}

impl<'a> Probe<'a> {
    fn new(case: &'a Case) -> Self {
        Self { observer: Observer::new(case, &case.device.device()) }
    }

    /// Receiver depth and stored depth.
    fn depths(&self, position: DVec3) -> (f32, f32) {
        let case = self.observer.case();
        let subject = &self.observer.subject;
        let coord = |lens: &Lens| lens.look(position).expect("before the light").as_vec3();
        let coords: Vec<_> = self.observer.lenses.iter().map(|l| coord(l).to_array()).collect();
        let [lookup] = subject.lookups(position, &coords)[..] else { panic!("one look-up") };
        let texel = subject.map.nearest(&subject.device, case.lookup.wrap, &lookup);
        (lookup.coord[2], subject.map.depth(&subject.device, texel as usize))
    }

    fn is_lit(&self, position: DVec3, bias: f32) -> bool {
        let (z, stored) = self.depths(position);
        self.observer.case().lookup.compare.is_lit(z, stored, bias)
    }

    /// Where along x the verdict changes on the plane y = gx·x at this z, to 2⁻³⁰, and whether it
    /// becomes lit there.
    fn changes(&self, gx: f64, z: f64, bias: f32, ends: [f64; 2]) -> Vec<(f64, bool)> {
        let lit = |x: f64| self.is_lit(DVec3::new(x, gx * x, z), bias);
        let steps = 40_000;
        let x_at = |i: i32| ends[0] + (ends[1] - ends[0]) * f64::from(i) / f64::from(steps);
        let mut list = Vec::new();
        for i in 0..steps {
            let (mut low, mut high) = (x_at(i), x_at(i + 1));
            let (before, after) = (lit(low), lit(high));
            if before == after {
                continue;
            }
            while high - low > 1e-9 {
                let middle = (low + high) / 2.0;
                if lit(middle) == before { low = middle } else { high = middle }
            }
            list.push((high, after));
        }
        list
    }
}

fn random(seed: &mut u64) -> f64 {
    *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*seed >> 11) as f64 / (1u64 << 53) as f64
}

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
        measured.false_light.by_cause[&Rung::Bias],
        measured.false_light.count,
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

/// The largest |Z| of the share of acne against F(b), over planes and 20 biases each, with 10⁶ jittered
/// receivers a plane; 6·10⁻⁸ of depth rounding is too little to matter. 4.565 is Šidák's 1 % of 2000
/// tests.
fn worst_deviation(planes: u32) -> f64 {
    const SAMPLES: u32 = 1_000_000;
    let mut seed = 22;
    let mut worst: f64 = 0.0;
    for plane in 0..planes {
        let [gx, gz] = [0, 1].map(|_| f64::from(((random(&mut seed) - 0.5) * 2.0) as f32));
        let case = analytic::tilted_plane(gx as f32, gz as f32);
        let probe = Probe::new(&case);
        let [a, c] = [gx, gz].map(|g| g.abs() * 0.125 / 2.0 / 16.0);
        let (a, c) = (a.max(c), a.min(c));
        let biases: Vec<f32> = (0..20).map(|i| ((a + c) * f64::from(i) / 20.0) as f32).collect();
        let mut dark = [0u32; 20];
        for _ in 0..SAMPLES {
            let [x, z] = [0, 1].map(|_| (random(&mut seed) - 0.5) * 6.0);
            let (depth, stored) = probe.depths(DVec3::new(x, gx * x + gz * z, z));
            let first_lit = depth - stored;
            let count = biases.partition_point(|&b| first_lit > b);
            dark[..count].iter_mut().for_each(|n| *n += 1);
        }
        for (&b, &n) in biases.iter().zip(&dark) {
            let b = f64::from(b);
            let expected = match b <= a - c {
                true => 0.5 - b / (2.0 * a),
                false => (a + c - b) * (a + c - b) / (8.0 * a * c),
            };
            let n_all = f64::from(SAMPLES);
            let deviation = f64::sqrt(expected * (1.0 - expected) / n_all);
            let z = (f64::from(n) / n_all - expected) / deviation;
            worst = worst.max(z.abs());
            assert!(z.abs() <= 4.565, "plane {plane} ({gx}, {gz}) at {b:e}: Z = {z}");
        }
    }
    worst
}

/// R22: acne covers the predicted share of a plane.
#[test]
fn acne_covers_the_predicted_share() {
    let worst = worst_deviation(6);
    assert!(worst > 1.0, "120 Z-tests scatter: {worst}");
}

#[test]
#[ignore = "R22 in full: 100 planes, 10^8 look-ups, some 10 s"]
fn acne_covers_the_predicted_share_of_a_hundred_planes() {
    let worst = worst_deviation(100);
    println!("largest |Z| of 2000: {worst}");
    assert!(worst > 2.0, "2000 Z-tests scatter: {worst}");
}

/// R23: stripes under the sun repeat every s/cos θ and are (s/2 − b/tan θ)/cos θ wide.
#[test]
fn stripes_have_their_width_and_period() {
    for (gx, share) in [(0.5, 0.0), (0.5, 0.5), (0.75, 0.25), (1.0, 0.75)] {
        let case = analytic::tilted_plane(gx as f32, 0.0);
        let probe = Probe::new(&case);
        let need = 0.125 / 2.0 * gx / 16.0;
        let changes = probe.changes(gx, 0.03, (share * need) as f32, [-2.0, 2.0]);
        let slant = f64::sqrt(1.0 + gx * gx);
        let (mut stripes, mut periods) = (0, 0);
        for triple in changes.windows(3) {
            let along = |i: usize, j: usize| (triple[j].0 - triple[i].0) * slant;
            let period = along(0, 2);
            assert!((period / (0.125 * slant) - 1.0).abs() < 1e-3, "{gx}: period {period}");
            periods += 1;
            if triple[1].1 {
                let width = 0.125 / 2.0 * (1.0 - share) * slant;
                let found = along(0, 1);
                assert!((found / width - 1.0).abs() < 5e-3, "{gx} {share}: {found} for {width}");
                stripes += 1;
            }
        }
        assert!(stripes > 25 && periods > 50, "{stripes} stripes");
    }
}

/// R23: under a spot the texels' edges lie τ·Z_k·Z_{k+1}/|D| apart on the surface.
#[test]
fn stripes_under_a_spot_grow_with_both_distances() {
    let gx = 0.5;
    let case = analytic::spot_plane(gx as f32, 0.0);
    let probe = Probe::new(&case);
    let tau = 2.0 * libm::tan(30.0 * std::f64::consts::PI / 180.0) / 64.0;
    let slant = f64::sqrt(1.0 + gx * gx);
    let changes = probe.changes(gx, 0.03, 0.0, [-2.0, 2.0]);
    // Stored depths jump at texels' edges, where the receiver becomes lit or dark at once; inside a
    // texel it changes at the centre.
    let jumps: Vec<f64> = changes.iter().filter(|c| !c.1).map(|c| c.0).collect();
    let edges: Vec<f64> = if jumps.len() > 20 { jumps } else { Vec::new() };
    let mut compared = 0;
    for pair in edges.windows(2) {
        let [near, far] = [pair[0], pair[1]].map(|x| 8.0 - gx * x);
        let expected = tau * near * far / (8.0 / slant);
        let found = (pair[1] - pair[0]) * slant;
        assert!((found / expected - 1.0).abs() < 1e-3, "{found} for {expected}");
        compared += 1;
    }
    assert!(compared > 20, "{compared} texels");
}

/// R24: the gaps behind a leaning wall and a box of stored back faces.
#[test]
fn gaps_open_as_the_law_of_sines_says() {
    // Where sampling moves a shadow's edge by up to a texel on the ground (12/2048 over sin α).
    let slack = |expected: f64| (0.005 * expected).max(12.0 / 2048.0 / 0.8);
    // The ½ of ground below the box is lit as well, but nobody can look there.
    let box_of_back_faces = analytic::solid(gnomon::scene::Cull::Front);
    for case in [analytic::leaning_wall(), box_of_back_faces] {
        let expected = fact(&case, "peter_panning_world");
        let gap = measure(&case, 4).measurement.peter_panning.expect("peter-panning").world;
        assert!((gap - expected).abs() <= slack(expected), "{}: {gap}, {expected}", case.name);
    }
}

/// T8: a sphere right under a spot casts a circle of radius R h/√((h − H)² − R²).
#[test]
fn a_sphere_under_a_spot_casts_a_circle() {
    let case = analytic::sphere_under_spot();
    let measured = measure(&case, 1);
    let dark = |o: &&gnomon::analysis::observe::Observation| {
        o.standing == Standing::Counted && matches!(o.answer.truth, Truth::Shadowed(_))
    };
    let pixel = 5.0 / 400.0;
    let area = measured.observations.iter().filter(dark).count() as f64 * pixel * pixel;
    let expected = fact(&case, "shadow_area_world");
    assert!((area / expected - 1.0).abs() < 0.003, "{area} against {expected}");
}

/// T9: a ball shadows itself least at its pole: no texel needs more than its farthest corner.
#[test]
fn a_ball_needs_what_its_steepest_texel_needs() {
    let case = analytic::ball();
    let measured = measure(&case, 1);
    let (s, range) = (4.0 / 256.0, 16.0);
    for o in measured.observations.iter().filter(|o| o.truly_lit() == Some(true) && o.own_surface) {
        let p = o.receiver.position;
        let radius = f64::sqrt(p.x * p.x + p.z * p.z);
        if radius > 0.9 {
            continue;
        }
        // The farthest corner of any texel around p lies at most s·√2 farther out.
        let height = |r: f64| f64::sqrt((1.0 - r * r).max(0.0));
        let need = (height(radius) - height(radius + s * std::f64::consts::SQRT_2)) / range;
        let faceting = 0.002 / range;
        let largest = o.breakpoints.iter().copied().fold(f32::NEG_INFINITY, f32::max);
        assert!(f64::from(largest) <= need + faceting, "at {p}: {largest:e} exceeds {need:e}");
    }
}

/// R25: along a disc's outline 0.24357·s per unit of length is on the wrong side, averaged over 40
/// phases of the grid, and nothing farther than s/√2 from it.
#[test]
fn a_disc_is_aliased_as_predicted() {
    let (s, radius) = (8.0 / 128.0, 1.0);
    let sector = 2.0 * std::f64::consts::PI / 256.0;
    let (angles, rings) = (2048u32, 64u32);
    let mut total = 0.0;
    let mut seed = 25;
    for _ in 0..40 {
        let mut case = analytic::disc();
        let shift = [0, 1].map(|_| f64::from((random(&mut seed) * s) as f32));
        for p in &mut Arc::make_mut(&mut case.objects[1].mesh).positions {
            (p.x, p.z) = (p.x + shift[0] as f32, p.z + shift[1] as f32);
        }
        let probe = Probe::new(&case);
        let turn = random(&mut seed);
        for i in 0..angles {
            let angle = 2.0 * std::f64::consts::PI * (f64::from(i) + turn) / f64::from(angles);
            let (sine, cosine) = (libm::sin(angle), libm::cos(angle));
            let within = angle - (angle / sector).floor() * sector - sector / 2.0;
            let rim = radius * libm::cos(sector / 2.0) / libm::cos(within);
            for j in 0..rings {
                let r = rim + s * 2.0 * ((f64::from(j) + 0.5) / f64::from(rings) - 0.5);
                let at = DVec3::new(r * cosine + shift[0], 0.0, r * sine + shift[1]);
                if probe.is_lit(at, case.bias) == (r > rim) {
                    continue;
                }
                // Vertices are snapped to at most 1/256 of a texel.
                let farthest = s * (std::f64::consts::FRAC_1_SQRT_2 + 1.0 / 256.0);
                assert!((r - rim).abs() <= farthest, "{} texels away", (r - rim) / s);
                total += r * (2.0 * s / f64::from(rings));
            }
        }
    }
    let area = total * 2.0 * std::f64::consts::PI / f64::from(angles) / 40.0;
    let expected = fact(&analytic::disc(), "edge_aliasing_area_world");
    assert!((area / expected - 1.0).abs() < 0.01, "{area} against {expected}");
}
