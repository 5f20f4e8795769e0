//! Relations that need no oracle: what must not change when bias, scale, pose, mesh or threads do.

use glam::{DMat3, DVec3, Mat4, Vec3, Vec4};
use gnomon::analysis::documents::{self, Options, Which};
use gnomon::analysis::observe::{Observation, Observer};
use gnomon::device::DeviceProfile;
use gnomon::num::{check_float_mode, exp2};
use gnomon::raster::NO_TRIANGLE;
use gnomon::raster::passes::{MapRaster, Transformed, draw_map, map_depth_buffer};
use gnomon::report::Profile;
use gnomon::scene::{Case, Mesh, cases, cases::analytic};
use gnomon::shadow::visibility;
use gnomon::stress::{self, Sampling, Sheet};
use gnomon::view::{Projection, View};
use std::sync::Arc;

fn named(names: &[&str]) -> Vec<Case> {
    names.iter().map(|name| cases::named(name).expect("a known case")).collect()
}

fn observe(case: &Case, step: u32) -> Vec<Observation> {
    Observer::new(case, &case.device.device()).observe_canvas(step)
}

/// The case with every position sent through `point` and every direction through `direction`.
fn moved(
    case: &Case,
    point: impl Fn(DVec3) -> DVec3,
    direction: impl Fn(DVec3) -> DVec3,
    length: f64,
) -> Case {
    let mut case = case.clone();
    let view = |v: View| View {
        position: point(v.position),
        target: point(v.target),
        up: direction(v.up),
    };
    let projection = |mut projection: Projection| {
        match &mut projection {
            Projection::Perspective { near, far, .. } => {
                *near *= length;
                *far *= length;
            }
            Projection::Orthographic { width, height, near, far } => {
                [width, height, near, far].into_iter().for_each(|x| *x *= length);
            }
        }
        projection
    };
    case.light = case.light.remade(view, projection);
    case.camera.view = view(case.camera.view);
    case.camera.projection = projection(case.camera.projection);
    for object in &mut case.objects {
        // Model matrices of these cases translate; the move goes into the positions.
        let offset = object.model.w_axis.truncate();
        assert_eq!(object.model, Mat4::from_translation(offset), "a translation");
        let place = |p: &Vec3| point((*p + offset).as_dvec3()).as_vec3();
        let moved = object.mesh.positions.iter().map(place).collect();
        Arc::make_mut(&mut object.mesh).positions = moved;
        object.model = Mat4::IDENTITY;
    }
    case
}

fn unmoved(case: &Case) -> Case {
    moved(case, |p| p, |d| d, 1.0)
}

fn scaled(case: &Case, factor: f64) -> Case {
    moved(case, |p| p * factor, |d| d, factor)
}

/// What the classification of a receiver consists of, to the bit. Depths are in window units.
fn bits(o: &Observation) -> (Vec<u32>, Vec<u64>, String) {
    let coord = o.coord.iter().chain(&o.breakpoints).map(|x| x.to_bits()).collect();
    let stored = o.stored.iter().map(|x| x.to_bits()).collect();
    let verdict = (o.pixel, o.standing, o.lit_taps, o.wrong, o.outcome, o.caster, o.texel);
    (coord, stored, format!("{verdict:?}"))
}

/// R26: a larger bias never adds acne and never takes a leak away.
#[test]
fn acne_shrinks_and_leaks_grow_with_the_bias() {
    let mut pairs = 0u32;
    let mut changed = 0u32;
    for case in named(&["t1-tilted-plane", "t11-plates", "t4-wall", "exam-pcf"]) {
        let observations: Vec<_> =
            observe(&case, 16).into_iter().filter(|o| o.truly_lit().is_some()).collect();
        assert!(observations.len() > 200, "{}", case.name);
        let mut state = 1u32;
        let mut bias = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            // Log-uniform over nine decades and both signs.
            let step = (u64::from(state) * 0x0f00_0000) >> 32;
            let magnitude = f32::from_bits(0x3000_0000 + step as u32);
            if state & 0x1000 == 0 { magnitude } else { -magnitude }
        };
        for _ in 0..2500 {
            let (a, b) = (bias(), bias());
            let (low, high) = (a.min(b), a.max(b));
            pairs += 1;
            for o in &observations {
                let lit = |b: f32| visibility(&case.lookup, &o.lookups, &o.taps, b);
                let (before, after) = (lit(low), lit(high));
                assert!(before <= after, "{} {:?}: {low:e} {high:e}", case.name, o.pixel);
                changed += u32::from(before < after);
            }
        }
    }
    assert_eq!(pairs, 10_000);
    assert!(changed > 10_000, "only {changed} verdicts changed: the pairs have no teeth");
}

/// R27: scaling by a power of two changes no bit; scaling by three does.
#[test]
fn scaling_by_a_power_of_two_changes_no_bit() {
    let mut differ_by_three = 0;
    for case in
        named(&["t1-tilted-plane", "t4-wall", "t11-plates", "fundamentals-spot", "exam-pcf"])
    {
        let home: Vec<_> = observe(&unmoved(&case), 16).iter().map(bits).collect();
        assert!(home.len() > 200, "{}: {} receivers", case.name, home.len());
        for k in [-20, -7, -1, 1, 7, 20] {
            let away: Vec<_> = observe(&scaled(&case, exp2(k)), 16).iter().map(bits).collect();
            assert_eq!(home.len(), away.len(), "{} at 2^{k}", case.name);
            for (a, b) in home.iter().zip(&away) {
                assert_eq!(a, b, "{} at 2^{k}", case.name);
            }
        }
        let thrice: Vec<_> = observe(&scaled(&case, 3.0), 16).iter().map(bits).collect();
        differ_by_three += home.iter().zip(&thrice).filter(|(a, b)| a != b).count();
    }
    assert!(differ_by_three > 0, "scaling by 3 rounds, so something has to differ");
}

/// Distance of a coordinate from the nearest border between texels, in texels.
fn from_border(c: f64, size: u32) -> f64 {
    let texels = c * f64::from(size);
    (texels - texels.round()).abs()
}

/// Whether rounding may decide a receiver: it looks within `texels` of a border between texels, or its
/// comparison is within `depth` of a tie.
fn near_a_decision(case: &Case, o: &Observation, texels: f64, depth: f64) -> bool {
    let border = o.coord[..2].iter().any(|&c| from_border(f64::from(c), case.map.size) < texels);
    let tie = o.breakpoints.iter().any(|&b| f64::from((b - case.bias).abs()) < depth);
    border || tie
}

/// Receivers that are judged otherwise after a change though no rounding decides them, and how many were
/// compared. `pixel` says where a pixel went.
fn judged_otherwise(
    before: &Case,
    after: &Case,
    step: u32,
    tolerance: [f64; 2],
    pixel: impl Fn([u32; 2]) -> [u32; 2],
) -> (usize, usize, usize) {
    let [texels, depth] = tolerance;
    let other = Observer::new(after, &after.device.device());
    let (mut wrong, mut compared, mut undecided) = (0, 0, 0);
    for o in observe(before, step) {
        let [x, y] = pixel(o.pixel);
        let Some(p) = other.observe_pixel(x, y) else { continue };
        if p.receiver.triangle != o.receiver.triangle || o.truly_lit().is_none() {
            continue;
        }
        let doubtful =
            near_a_decision(before, &o, texels, depth) || near_a_decision(after, &p, texels, depth);
        compared += 1;
        undecided += usize::from(doubtful);
        wrong += usize::from(o.lit_taps != p.lit_taps && !doubtful);
    }
    (wrong, compared, undecided)
}

/// Two roundings of a coordinate in texels of a map of 64, and of a window depth.
const TWO_ULP: [f64; 2] = [64.0 * 2.4e-7, 2.4e-7];

/// R28: turning the map by a quarter exchanges its axes and changes no verdict.
#[test]
fn a_quarter_turn_of_the_map_changes_nothing() {
    for name in ["t1-tilted-plane", "t11-plates"] {
        let case = named(&[name]).remove(0);
        let mut turned = case.clone();
        turned.light = turned.light.remade(|v| View { up: DVec3::X, ..v }, |p| p);
        let turned = moved(&turned, |p| p, |d| d, 1.0);
        let (wrong, compared, undecided) =
            judged_otherwise(&unmoved(&case), &turned, 2, TWO_ULP, |p| p);
        assert!(compared > 20_000, "{name}: {compared} compared");
        assert!(undecided * 10 < compared, "{name}: {undecided} undecided");
        assert_eq!(wrong, 0, "{name}");
    }
}

/// R28: a mirrored world is judged as its original, pixel by mirrored pixel.
#[test]
fn a_mirrored_world_is_judged_alike() {
    for name in ["t1-tilted-plane", "t11-plates"] {
        let case = unmoved(&named(&[name]).remove(0));
        let flip = |v: DVec3| DVec3::new(-v.x, v.y, v.z);
        let mut mirrored = moved(&case, flip, flip, 1.0);
        for triangle in
            mirrored.objects.iter_mut().flat_map(|o| &mut Arc::make_mut(&mut o.mesh).triangles)
        {
            triangle.swap(1, 2);
        }
        let width = case.canvas[0];
        let (wrong, compared, undecided) =
            judged_otherwise(&case, &mirrored, 2, TWO_ULP, |[x, y]| [width - 1 - x, y]);
        assert!(compared > 20_000, "{name}: {compared} compared");
        assert!(undecided * 10 < compared, "{name}: {undecided} undecided");
        assert_eq!(wrong, 0, "{name}");
    }
}

/// R28: moving the light sideways by whole texels moves the map, not the verdicts.
#[test]
fn a_light_moved_by_whole_texels_judges_alike() {
    let case = analytic::tilted_plane(0.5, 0.25);
    for (i, j) in [(1, 0), (-3, 2), (4, -4)] {
        let step = DVec3::new(f64::from(i), 0.0, f64::from(j)) * 0.125;
        let mut moved_light = case.clone();
        moved_light.light = moved_light.light.moved(step);
        let moved_light = unmoved(&moved_light);
        let (wrong, compared, _) =
            judged_otherwise(&unmoved(&case), &moved_light, 2, TWO_ULP, |p| p);
        assert!(compared > 20_000, "{compared} compared");
        assert_eq!(wrong, 0, "by ({i}, {j}) texels");
        // Teeth: half a texel is another map.
        let half = DVec3::X * 0.0625;
        let mut other = case.clone();
        other.light = other.light.moved(half);
        let (wrong, ..) = judged_otherwise(&unmoved(&case), &unmoved(&other), 4, TWO_ULP, |p| p);
        assert!(wrong > 1000, "half a texel changes {wrong} verdicts");
    }
}

/// R29: under a rotation and a translation of everything, verdicts differ only where rounding decides.
#[test]
fn a_rigid_motion_changes_only_what_rounding_decides() {
    // Columns of a rotation in sevenths: nothing in it is dyadic.
    let turn = DMat3::from_cols(
        DVec3::new(2.0, 3.0, 6.0),
        DVec3::new(3.0, -6.0, 2.0),
        DVec3::new(6.0, 2.0, -3.0),
    ) * (1.0 / 7.0);
    assert!((turn.determinant() - 1.0).abs() < 1e-12, "a rotation");
    let shift = DVec3::new(3.3, -1.7, 5.1);
    for name in ["t1-tilted-plane", "t11-plates", "t4-wall"] {
        let case = unmoved(&named(&[name]).remove(0));
        let away = moved(&case, |p| turn * p + shift, |d| turn * d, 1.0);
        // Positions up to 32 and matrices with six roundings each: 16 ulp of 32 over the map's width.
        let error = 16.0 * 32.0 * exp2(-24) / 8.0;
        let tolerance = [error * f64::from(case.map.size), 2.0 * error];
        let (wrong, compared, undecided) = judged_otherwise(&case, &away, 2, tolerance, |p| p);
        assert!(compared > 10_000, "{name}: {compared} compared");
        assert!(undecided * 3 < compared, "{name}: {undecided} of {compared} undecided");
        assert_eq!(wrong, 0, "{name}");
    }
}

/// Every triangle in four, at the midpoints of its sides.
fn subdivided(mesh: &Mesh) -> Mesh {
    let mut fine = Mesh { triangles: Vec::new(), ..mesh.clone() };
    for t in &mesh.triangles {
        let [a, b, c] = t.map(|v| mesh.positions[v as usize]);
        let first = fine.positions.len() as u32;
        fine.positions.extend([a, b, c, (a + b) / 2.0, (b + c) / 2.0, (c + a) / 2.0]);
        let parts = [[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]];
        fine.triangles.extend(parts.map(|p: [u32; 3]| p.map(|v| v + first)));
    }
    fine
}

fn map_of(case: &Case) -> MapRaster {
    let device = case.device.device();
    let vertices = Transformed::new(case, case.chain, &device);
    draw_map(case, &device, &vertices, map_depth_buffer(case))
}

/// R30: subdividing at midpoints that the sub-pixel grid keeps changes no texel and no depth.
#[test]
fn subdivision_at_representable_midpoints_changes_no_texel() {
    for (gx, gz) in [(0.5, 0.25), (-0.625, 0.375), (0.0, 1.0)] {
        let whole = analytic::tilted_plane(gx, gz);
        let expected = map_of(&whole);
        let mut case = whole.clone();
        for level in 1..=4 {
            for object in &mut case.objects {
                object.mesh = subdivided(&object.mesh).into();
            }
            let map = map_of(&case);
            for (i, (&a, &b)) in expected.triangle.iter().zip(&map.triangle).enumerate() {
                assert_eq!(a == NO_TRIANGLE, b == NO_TRIANGLE, "texel {i} at level {level}");
                let (x, y) = (expected.depth[i], map.depth[i]);
                assert_eq!(x.to_bits(), y.to_bits(), "depth of texel {i} at level {level}");
            }
        }
        assert_eq!(case.objects[0].mesh.triangles.len(), 2 * 256);
    }
}

/// The largest margin over all closed corners, window depth; exact for dyadic gradients.
fn critical_margin(sheet: &Sheet) -> f64 {
    let mut margin = f64::NEG_INFINITY;
    sheet.corners(|i, j, x, y| {
        let depth = sheet.distance(x, y) / sheet.range;
        margin = margin.max(depth - f64::from(sheet.stored(i, j)));
    });
    margin
}

/// R30: twice the resolution halves the critical bias of a dyadic plane, to the bit.
#[test]
fn twice_the_resolution_halves_the_critical_bias() {
    let device = DeviceProfile::Ideal.device();
    for gradient in [[0.5, 0.25], [0.0, 1.0], [-2.0, 0.75], [4.0, -3.5]] {
        let at = |size: u32| Sheet::draw(&device, size, 4.0 / f64::from(size), gradient);
        for size in [16, 32, 64] {
            let (coarse, fine) = (at(size), at(2 * size));
            assert_eq!(coarse.range, fine.range, "one depth range");
            let (b, half) = (critical_margin(&coarse), critical_margin(&fine));
            assert_eq!(
                b.to_bits(),
                (2.0 * half).to_bits(),
                "{gradient:?} at {size}: {b:e} {half:e}"
            );
            assert_eq!(b, coarse.texel_world / 2.0 * coarse.slope() / coarse.range, "(s/2)|g|₁");
        }
    }
}

fn with_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads").install(work)
}

/// R42: every file of a report, and every number of the stresses, is the same with any number of threads.
#[test]
fn threads_change_no_byte() {
    let options = Options {
        profile: Profile::Quick,
        which: Which::Named("fundamentals-spot".to_string()),
        ..Options::default()
    };
    let files = || {
        let report = documents::report(&options, || ()).expect("a known case");
        report.files().into_iter().map(|f| (f.name, f.bytes)).collect::<Vec<_>>()
    };
    let numbers = || format!("{:?}", stress::run(&Sampling { samples: 32, seed: 1 }, || ()));
    let alone = with_threads(1, || (files(), numbers()));
    assert!(alone.0.len() > 5 && alone.1.len() > 10_000, "there is something to compare");
    for threads in [2, 3, 8] {
        let (many, many_numbers) = with_threads(threads, || (files(), numbers()));
        for (a, b) in alone.0.iter().zip(&many) {
            assert!(a == b, "{} differs with {threads} threads", a.0);
        }
        assert_eq!(alone.0.len(), many.len());
        assert!(alone.1 == many_numbers, "stresses differ with {threads} threads");
    }
}

/// R42: twenty times over, with as many threads as there may be.
#[test]
#[ignore = "soak: 80 reports, about a minute"]
fn twenty_repeats_change_no_byte() {
    let options = Options {
        profile: Profile::Quick,
        which: Which::Named("book-r8-y7".to_string()),
        ..Options::default()
    };
    let files = || documents::report(&options, || ()).expect("a known case").files();
    let first = with_threads(1, files);
    for round in 0..20 {
        for threads in [1, 2, 3, 8] {
            assert!(with_threads(threads, files) == first, "round {round}, {threads} threads");
        }
    }
}

/// R44: this thread and every worker compute in the default floating-point mode.
#[test]
fn every_worker_computes_in_the_default_mode() {
    check_float_mode().expect("the test's own thread");
    let answers = with_threads(4, || rayon::broadcast(|_| check_float_mode().is_ok()));
    assert_eq!(answers, [true; 4]);
}

/// The subject's arithmetic itself sees subnormals: a product that underflows keeps its bits.
#[test]
fn subnormals_survive_the_subject() {
    let device = DeviceProfile::Ideal.device();
    let tiny = Mat4::from_scale(Vec3::splat(f32::MIN_POSITIVE));
    let v = device.mat_vec(&tiny, Vec4::new(0.25, 0.5, 0.125, 1.0));
    assert_eq!(v.x.to_bits(), 1 << 21, "2⁻¹²⁸ is a subnormal with this bit");
    let flushed = DeviceProfile::WebglSwiftshader.device().mat_vec(&tiny, Vec4::splat(0.25));
    assert_eq!(flushed.x, 0.0, "the measured device flushes");
}
