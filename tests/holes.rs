//! Alpha-masked surfaces: their holes in map, picture and truth.

use glam::{DVec3, Mat4, Vec2, Vec3};
use gnomon::analysis::measure::measure;
use gnomon::analysis::observe::Observer;
use gnomon::analysis::sweep::Field;
use gnomon::analysis::sweep::chart::{Attachment, Chart};
use gnomon::analysis::sweep::evaluate::{Question, sweep};
use gnomon::camera::Camera;
use gnomon::depth::DepthFormat;
use gnomon::device::DeviceProfile;
use gnomon::light::Light;
use gnomon::scene::alpha::{AlphaImage, Mask, Tiling};
use gnomon::scene::{
    Case, CaseBuilder, CullRule, Filter, Mesh, Object, Surface, TexelFormat, shapes,
};
use gnomon::shadow::bias::Strategy;
use gnomon::truth::{Receiver, Tracer, Truth, izb};
use gnomon::view::{Projection, View};
use std::sync::Arc;

const F32: TexelFormat = TexelFormat::Depth(DepthFormat::F32);

/// A 6 × 6 floor at y = 0 and objects over it, under an upright sun, seen from above at a slant.
fn scene(objects: Vec<Object>) -> Case {
    let sun = Projection::Orthographic { width: 8.0, height: 8.0, near: 0.5, far: 12.0 };
    let eye = Projection::Perspective { fovy_degrees: 50.0, aspect: 1.0, near: 0.1, far: 40.0 };
    let light = View { position: DVec3::Y * 8.0, target: DVec3::ZERO, up: DVec3::NEG_Z };
    let view = View { position: DVec3::new(0.3, 3.0, 5.2), target: DVec3::ZERO, up: DVec3::Y };
    let mut case =
        CaseBuilder::new("holes", Light::new(light, sun, None), Camera { view, projection: eye })
            .mesh("floor", shapes::floor(6.0, Vec3::ONE))
            .canvas([256, 256])
            .map(1024, F32)
            .bias(1e-3)
            .build()
            .unwrap();
    case.objects.extend(objects);
    case
}

/// A level card of this side at a height, its texture once over it.
fn card(side: f32, y: f32) -> Mesh {
    let h = side / 2.0;
    let at = |x: f32, z: f32| Vec3::new(x, y, z);
    let mut mesh = shapes::quad([at(-h, -h), at(-h, h), at(h, h), at(h, -h)], Vec3::ONE);
    mesh.uvs = [[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]].map(Vec2::from_array).to_vec();
    mesh
}

fn masked(image: Option<AlphaImage>, factor: f32, cutoff: f32) -> Surface {
    let mask = Mask { image, factor, cutoff, scale_rotate: [Vec2::X, Vec2::Y], offset: Vec2::ZERO };
    Surface { mask: Some(Arc::new(mask)), ..Surface::default() }
}

/// 8 × 8 texels of which the four in the middle are there.
fn centre(linear: bool) -> AlphaImage {
    let inside = |i: usize| (3..5).contains(&(i % 8)) && (3..5).contains(&(i / 8));
    let alpha = (0..64).map(|i| if inside(i) { 255 } else { 0 }).collect();
    AlphaImage { size: [8; 2], alpha, tiling: [Tiling::Repeat; 2], linear }
}

fn object(mesh: Mesh, surface: Surface) -> Object {
    Object::new("card", mesh, Mat4::IDENTITY).with_surface(surface)
}

/// The share of a 3 × 3 square of the floor that is truly shadowed, by a lattice, and the undecided points.
fn shadowed(case: &Case) -> (f64, usize) {
    let tracer = Tracer::new(&case.geometry());
    let steps = 301;
    let at = |i: usize| -1.5 + 3.0 * (i as f64 + 0.37) / steps as f64;
    let (mut dark, mut unsure) = (0, 0);
    for (i, j) in (0..steps).flat_map(|i| (0..steps).map(move |j| (i, j))) {
        let position = DVec3::new(at(i), 0.0, at(j));
        let end = position + DVec3::Y * tracer.reach();
        match tracer.truth(&Receiver { position, triangle: 0 }, end).truth {
            Truth::Shadowed(_) => dark += 1,
            Truth::Ambiguous => unsure += 1,
            Truth::Lit => {}
        }
    }
    (dark as f64 / (steps * steps) as f64, unsure)
}

#[test]
fn a_card_shadows_where_its_texture_says() {
    let solid = scene(vec![object(card(3.0, 1.0), Surface::default())]);
    assert!(shadowed(&solid).0 > 0.99);
    // Four of 64 texels, 1/16 of the card: 0.5625 of 9, two lattice lines more or less.
    let cut = scene(vec![object(card(3.0, 1.0), masked(Some(centre(false)), 1.0, 0.5))]);
    let (share, unsure) = shadowed(&cut);
    assert!((share - 1.0 / 16.0).abs() < 0.003, "{share}");
    assert!(unsure < 10, "{unsure} undecided");
    let (soft, _) =
        shadowed(&scene(vec![object(card(3.0, 1.0), masked(Some(centre(true)), 1.0, 0.5))]));
    // By hand: the square between the centres, half a texel beside each of its sides, and at each corner
    // where (1 − s)(1 − t) ≥ ½, which is ½(1 − ln 2).
    let texels = 1.0 + 4.0 * 0.5 + 4.0 * 0.5 * (1.0 - std::f64::consts::LN_2);
    assert!((soft * 64.0 - texels).abs() < 0.25, "{} texels, by hand {texels}", soft * 64.0);
}

#[test]
fn a_factor_alone_takes_all_or_nothing() {
    let with = |factor| shadowed(&scene(vec![object(card(3.0, 1.0), masked(None, factor, 0.5))])).0;
    assert_eq!(with(0.25), 0.0);
    assert!(with(0.5) > 0.99, "alpha at the cutoff is there");
}

#[test]
fn the_map_and_the_picture_have_the_same_holes() {
    let cut = scene(vec![object(card(3.0, 1.0), masked(Some(centre(false)), 1.0, 0.5))]);
    let device = DeviceProfile::Ideal.device();
    let observer = Observer::new(&cut, &device);
    let drawn = |triangles: &[u32]| triangles.iter().filter(|&&t| t >= 2 && t != u32::MAX).count();
    // 1024 texels over 8 units: 96 × 96 texels of card that are there.
    let texels = drawn(&observer.subject.map_raster.triangle);
    assert!((texels as f64 / (96.0 * 96.0) - 1.0).abs() < 0.03, "{texels}");
    assert!(drawn(&observer.subject.canvas.triangle) > 50);
    let m = measure(&cut, 1).measurement;
    assert!(m.shadowed > 500 && m.lit > 5000, "{} {}", m.shadowed, m.lit);
    assert!(m.false_light.rate.unwrap() < 0.06, "{:?}", m.false_light);
    assert!(m.false_shadow.rate.unwrap() < 0.01, "{:?}", m.false_shadow);
}

/// Cards with random textures over each other, some without holes.
fn leaves(seed: u64) -> Case {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    let mut random = move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 40) as f32 / (1u32 << 24) as f32
    };
    let mut leaf = |k: usize| {
        let alpha = (0..24).map(|_| (random() * 256.0) as u8).collect();
        let tiling = [Tiling::ALL[k % 3], Tiling::ALL[(k + 1) % 3]];
        let image = AlphaImage { size: [6, 4], alpha, tiling, linear: k.is_multiple_of(2) };
        let mut mesh = card(0.6 + random(), 0.3 + 0.2 * k as f32);
        mesh.uvs.iter_mut().for_each(|uv| *uv = *uv * 2.5 - Vec2::splat(random()));
        let turn = Mat4::from_rotation_x(random() - 0.5) * Mat4::from_rotation_z(random() - 0.5);
        let place = Vec3::new(random() * 3.0 - 1.5, 0.0, random() * 3.0 - 1.5);
        let surface = match k % 4 {
            3 => Surface::default(),
            _ => masked(Some(image), 0.9, 0.4),
        };
        let model = Mat4::from_translation(place) * turn;
        Object::new("leaf", mesh, model).with_surface(surface)
    };
    scene((0..12).map(&mut leaf).collect())
}

#[test]
fn all_truths_agree_on_leaves() {
    for seed in 1..7 {
        let case = leaves(seed);
        let observer = Observer::new(&case, &DeviceProfile::Ideal.device());
        let pixels = (0..256).flat_map(|y| (0..256).map(move |x| (x, y)));
        let receivers: Vec<Receiver> =
            pixels.filter_map(|(x, y)| Some(observer.receiver(x, y)?.0)).collect();
        let (geometry, light) = (case.geometry(), observer.light());
        let brute = Tracer::brute_force(&geometry).truths(&receivers, light);
        let shadowed = brute.iter().filter(|a| matches!(a.truth, Truth::Shadowed(_))).count();
        assert!(shadowed > 500, "seed {seed}: {shadowed} shadowed");
        assert_eq!(observer.tracer.truths(&receivers, light), brute, "seed {seed}: the tree");
        assert!(
            izb::truths(&geometry, &receivers, light).iter().eq(brute),
            "seed {seed}: the raster"
        );
    }
}

#[test]
fn a_sweep_counts_what_a_measurement_counts() {
    let case = leaves(3);
    let m = measure(&case, 4).measurement;
    let field = Field::new(&case, 4);
    let chart = Chart::new(&field, case.map.size, Filter::Nearest, Attachment::Depth);
    let count = |strategy, amount| {
        let question = Question { amounts: &[amount], max_acne: 0.0 };
        let swept = sweep(&chart, F32, strategy, &question);
        swept.points[0].tally.false_shadow() + swept.points[0].tally.false_light()
    };
    let wrong = (m.false_shadow.count + m.false_light.count) as i64;
    assert_eq!(count(Strategy::Constant, case.bias), wrong);
    // Through the fragments of all faces: a polygon offset of nothing.
    let none = count(Strategy::RasterUnits, 0.0);
    let mut unbiased = case.clone();
    unbiased.bias = 0.0;
    let m = measure(&unbiased, 4).measurement;
    assert_eq!(none, (m.false_shadow.count + m.false_light.count) as i64);
    assert_eq!(case.map.cull, CullRule::None);
}
