//! Surfaces as their materials say: sides in map and picture, what casts and receives, and what a culled
//! caster is called.

use glam::{DVec3, Mat4, Vec3};
use gnomon::analysis::classify::Artifact;
use gnomon::analysis::ladder::Rung;
use gnomon::analysis::measure::{Measured, measure};
use gnomon::analysis::observe::Observer;
use gnomon::camera::Camera;
use gnomon::depth::DepthFormat;
use gnomon::device::DeviceProfile;
use gnomon::light::Light;
use gnomon::raster::passes::Subject;
use gnomon::raster::{Pass, PolygonOffset, Triangles, draw_each_of, draw_of};
use gnomon::scene::{
    Case, CaseBuilder, Cull, CullRule, Mesh, Object, Sides, Surface, TexelFormat, shapes,
};
use gnomon::truth::{Receiver, Tracer, izb};
use gnomon::view::{Projection, View};

/// A floor of 10 × 10 and objects over it, under a slanted sun, seen from the side.
fn yard(objects: Vec<Object>, cull: CullRule, bias: f32) -> Case {
    let looking = |from: DVec3, target: DVec3| View { position: from, target, up: DVec3::Y };
    let sun = Projection::Orthographic { width: 16.0, height: 16.0, near: 1.0, far: 30.0 };
    let eye =
        Projection::Perspective { fovy_degrees: 45.0, aspect: 4.0 / 3.0, near: 0.1, far: 60.0 };
    let light = Light::new(looking(DVec3::new(-2.0, 10.0, -3.0), DVec3::ZERO), sun, None);
    let view = looking(DVec3::new(0.0, 1.0, -8.0), DVec3::new(0.0, 0.5, 0.0));
    let mut case = CaseBuilder::new("yard", light, Camera { view, projection: eye })
        .mesh("floor", shapes::floor(10.0, Vec3::ONE))
        .canvas([200, 150])
        .map(512, TexelFormat::Depth(DepthFormat::F32))
        .bias(bias)
        .build()
        .unwrap();
    case.objects.extend(objects);
    case.map.cull = cull;
    case
}

/// A roof of 4 × 4 at height 2 whose front looks down, or up where its triangles are turned.
fn roof(looks_up: bool) -> Mesh {
    let at = |x: f32, z: f32| Vec3::new(x, 2.0, z);
    let mut mesh =
        shapes::quad([at(-2.0, -2.0), at(2.0, -2.0), at(2.0, 2.0), at(-2.0, 2.0)], Vec3::ONE);
    if looks_up {
        mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    }
    mesh
}

fn object(mesh: Mesh, surface: Surface) -> Object {
    Object::new("thing", mesh, Mat4::IDENTITY).with_surface(surface)
}

fn sided(sides: Sides) -> Surface {
    Surface { sides, ..Surface::default() }
}

fn count(measured: &Measured<'_>, rung: Rung, artifact: Artifact) -> [u64; 3] {
    let light = &measured.measurement.false_light;
    [light.count, light.by_cause[&rung], light.by_artifact[&artifact]]
}

#[test]
fn a_culled_roof_is_a_light_leak_that_both_faces_repair() {
    for bias in [0.0, 5e-4] {
        let case = yard(vec![object(roof(false), Surface::default())], CullRule::Back, bias);
        let measured = measure(&case, 1);
        let [wrong, culling, leaks] = count(&measured, Rung::Culling, Artifact::LightLeak);
        assert!(wrong > 100, "{wrong} falsely lit");
        assert_eq!([culling, leaks], [wrong; 2], "bias {bias}");
        let m = &measured.measurement;
        let both = m.both_faces.expect("culling is told");
        assert!(m.verdict.contains("with both faces drawn"), "{}", m.verdict);
        let open = yard(case.objects[1..].to_vec(), CullRule::None, bias);
        let open = measure(&open, 1).measurement;
        assert_eq!(both.false_light, open.false_light.rate);
        assert_eq!(open.both_faces, None);
        assert_eq!(open.false_light.by_cause[&Rung::Culling], 0);
    }
}

#[test]
fn what_throws_no_shadow_is_nobodys_occluder() {
    let silent = Surface { casts: false, ..Surface::default() };
    let m = measure(&yard(vec![object(roof(true), silent)], CullRule::None, 5e-4), 1).measurement;
    assert_eq!((m.shadowed, m.false_shadow.count), (0, 0));
    let thrown = yard(vec![object(roof(true), Surface::default())], CullRule::None, 5e-4);
    assert!(measure(&thrown, 1).measurement.shadowed > 100);
}

#[test]
fn what_receives_no_shadow_counts_in_no_rate() {
    let deaf = Surface { receives: false, ..Surface::default() };
    let mut case = yard(vec![object(roof(true), Surface::default())], CullRule::None, 5e-4);
    let floor_alone = measure(&case, 1).measurement.by_object["floor"].clone();
    case.objects[0].surface = deaf;
    let m = measure(&case, 1).measurement;
    assert_eq!((m.by_object["floor"].lit, m.by_object["floor"].shadowed), (0, 0));
    assert!(m.samples.receives_none >= floor_alone.lit + floor_alone.shadowed);
}

#[test]
fn a_picture_shows_the_sides_that_materials_draw() {
    let under = |surface, looks_up| {
        let case = yard(vec![object(roof(looks_up), surface)], CullRule::None, 0.0);
        let device = DeviceProfile::Ideal.device();
        let canvas = Subject::draw(&case, &device).canvas;
        canvas.triangle.iter().filter(|&&t| t == 2 || t == 3).count()
    };
    // The camera stands below the roof's height: it sees what looks down.
    let seen = under(sided(Sides::Both), false);
    assert!(seen > 100);
    assert_eq!(under(sided(Sides::Front), false), seen);
    assert_eq!(under(sided(Sides::Front), true), 0);
    assert_eq!(under(sided(Sides::Back), true), seen);
}

#[test]
fn a_map_by_the_material_draws_what_the_same_rule_draws_of_all() {
    let cube = || shapes::cuboid(Vec3::new(-1.0, 0.2, -1.0), Vec3::new(1.0, 1.5, 1.0), Vec3::ONE);
    let map = |sides, rule| {
        let case = yard(vec![object(cube(), sided(sides))], rule, 0.0);
        let mut case = case;
        case.objects[0].surface = sided(sides);
        Subject::draw(&case, &DeviceProfile::Ideal.device()).map_raster
    };
    let [back, front, none] =
        [CullRule::Back, CullRule::Front, CullRule::None].map(|rule| map(Sides::Both, rule));
    assert!(back != front && front != none);
    assert_eq!(map(Sides::Front, CullRule::Material), back);
    assert_eq!(map(Sides::Front, CullRule::MaterialOpposite), front);
    assert_eq!(map(Sides::Back, CullRule::MaterialOpposite), back);
    assert_eq!(map(Sides::Both, CullRule::MaterialOpposite), none);
    assert_eq!(map(Sides::Front, CullRule::Front), front, "every object");
}

#[test]
fn a_mirrored_instance_keeps_its_outside() {
    let cube = shapes::cuboid(Vec3::new(0.5, 0.2, -1.0), Vec3::new(1.5, 1.5, 1.0), Vec3::ONE);
    let depths = |model: Mat4| {
        let object = Object::new("cube", cube.clone(), model).with_surface(sided(Sides::Front));
        let case = yard(vec![object], CullRule::Material, 0.0);
        Subject::draw(&case, &DeviceProfile::Ideal.device()).map_raster.depth
    };
    let mirrored = depths(Mat4::from_scale(Vec3::new(-1.0, 1.0, 1.0)));
    let turned = depths(Mat4::from_translation(Vec3::new(-2.0, 0.0, 0.0)));
    // The same box, one drawn as a mirror image: its outer faces are drawn, not its inner ones.
    let off = mirrored.iter().zip(&turned).filter(|(a, b)| (**a - **b).abs() > 1e-4).count();
    assert_eq!(off, 0);
}

/// Objects of every kind of surface.
fn mixed() -> Case {
    let cube = |i: u32| {
        let low = Vec3::new(i as f32 * 0.9 - 3.0, 0.3 * i as f32, -0.8 + 0.2 * i as f32);
        shapes::cuboid(low, low + Vec3::new(0.7, 0.6, 1.1), Vec3::ONE)
    };
    let surface = |i: u32| Surface {
        sides: Sides::ALL[i as usize % 3],
        casts: i % 4 != 3,
        receives: i % 5 != 2,
        ..Surface::default()
    };
    yard((0..7).map(|i| object(cube(i), surface(i))).collect(), CullRule::MaterialOpposite, 1e-3)
}

#[test]
fn tiles_draw_what_the_literal_loop_draws() {
    let case = mixed();
    let device = DeviceProfile::Ideal.device();
    let subject = Subject::draw(&case, &device);
    let vertices = &subject.vertices;
    for rule in CullRule::ALL {
        let culls = vertices.surfaces.culls(*rule);
        let pass = Pass {
            size: [137, 91],
            cull: Cull::None,
            depth_buffer: DepthFormat::Unorm24,
            offset: PolygonOffset::default(),
            clip: case.light.maps()[0].clip,
        };
        let triangles = Triangles::alike(&vertices.maps[0].clip, &vertices.triangles);
        let (pass, triangles) = triangles.under(pass, &culls);
        assert_eq!(
            draw_of(&device, &pass, &triangles),
            draw_each_of(&device, &pass, &triangles),
            "{rule}"
        );
    }
}

#[test]
fn all_truths_leave_out_what_does_not_cast() {
    let case = mixed();
    let observer = Observer::new(&case, &DeviceProfile::Ideal.device());
    let receivers: Vec<Receiver> = (0..150)
        .flat_map(|y| (0..200).map(move |x| (x, y)))
        .filter_map(|(x, y)| Some(observer.receiver(x, y)?.0))
        .collect();
    let light = observer.light();
    let geometry = case.geometry();
    let brute = Tracer::brute_force(&geometry).truths(&receivers, light);
    assert_eq!(observer.tracer.truths(&receivers, light), brute);
    let swept = izb::truths(&geometry, &receivers, light);
    assert!(swept.iter().eq(brute));
    assert!(receivers.len() > 1000);
}
