//! Scenes whose artifacts are known in closed form: planes (T1, T2, T3), walls and boxes (T4, T5, T6,
//! T12), spheres (T7, T8, T9), a disc (T10), two plates (T11).
//!
//! Notation: s texel edge, g depth gradient in light space, |g|₁ = |gx| + |gy|, α elevation of the
//! light. Lights are orthographic unless a case says otherwise, so that window depth is linear: world
//! length = depth · (far − near).

use super::{float_map, plain_lookup};
use crate::camera::Camera;
use crate::device::DeviceProfile;
use crate::light::Light;
use crate::scene::shapes::{self, Mesh};
use crate::scene::{Case, Cull, Fact, MatrixChain, Object, Shading};
use crate::view::{Projection, View};
use glam::{DVec3, Mat4, Vec3};

/// The analytic cases.
#[must_use]
pub fn all() -> Vec<Case> {
    vec![
        tilted_plane(0.5, 0.25),
        wall(),
        sphere(),
        plates(),
        dyadic_plane(),
        spot_plane(0.5, 0.25),
        leaning_wall(),
        solid(Cull::None),
        solid(Cull::Front),
        sphere_under_spot(),
        ball(),
        disc(),
        stairs(),
    ]
}

const GROUND: Vec3 = Vec3::new(0.8, 0.8, 0.75);
const CASTER: Vec3 = Vec3::new(0.75, 0.55, 0.4);

/// An orthographic light of side `width` at `position`, looking at the origin.
fn sun(position: DVec3, up: DVec3, width: f64, near: f64, far: f64) -> Light {
    let eye = View { position, target: DVec3::ZERO, up };
    Light::new(eye, Projection::Orthographic { width, height: width, near, far }, None)
}

/// An orthographic camera 16 units from `target` in direction `from`, which sees only what lies
/// farther than `near`: a near plane between caster and receiver bares the shadow.
fn camera(from: DVec3, target: DVec3, width: f64, near: f64) -> Camera {
    Camera {
        view: View { position: target + from * 16.0, target, up: DVec3::NEG_Z },
        projection: Projection::Orthographic { width, height: width, near, far: 33.0 },
    }
}

struct Scene {
    name: &'static str,
    document: &'static str,
    parts: Vec<(&'static str, Mesh)>,
    light: Light,
    camera: Camera,
    canvas: u32,
    map_size: u32,
    bias: f32,
    facts: Vec<Fact>,
}

fn case(scene: Scene) -> Case {
    let chain = MatrixChain::BiasMatrix;
    let object = |(name, mesh): (&str, Mesh)| Object::new(name, mesh, Mat4::IDENTITY);
    Case {
        name: scene.name.to_string(),
        document: scene.document.to_string(),
        objects: scene.parts.into_iter().map(object).collect(),
        light: scene.light,
        camera: scene.camera,
        canvas: [scene.canvas; 2],
        chain,
        map: float_map(scene.map_size),
        lookup: plain_lookup(),
        camera_cull: Cull::None,
        bias: scene.bias,
        shading: Shading::Lambert,
        device: DeviceProfile::Ideal,
        assumptions: Vec::new(),
        skipped: Vec::new(),
        facts: scene.facts,
    }
}

/// A quad over x, z ∈ [−h, h] on the plane y = y0 + gx·x + gz·z, facing up.
fn sheet(h: f32, y0: f32, gx: f32, gz: f32, colour: Vec3) -> Mesh {
    let at = |x: f32, z: f32| Vec3::new(x, y0 + gx * x + gz * z, z);
    shapes::quad([at(-h, h), at(h, h), at(h, -h), at(-h, -h)], colour)
}

/// T1: the plane y = gx·x + gz·z under a vertical light; 64² texels of edge 1/8, depth range 16.
///
/// Acne ends at b* = (s/2)|g|₁ (closed at the texels' corners).
#[must_use]
pub fn tilted_plane(gx: f32, gz: f32) -> Case {
    let critical = 0.125 / 2.0 * f64::from(gx.abs() + gz.abs()) / 16.0;
    case(Scene {
        name: "t1-tilted-plane",
        document: "closed form: tilted plane",
        parts: vec![("plane", sheet(3.5, 0.0, gx, gz, GROUND))],
        light: sun(DVec3::Y * 8.0, DVec3::NEG_Z, 8.0, 0.0, 16.0),
        camera: camera(DVec3::Y, DVec3::ZERO, 8.0, 1.0),
        canvas: 500,
        map_size: 64,
        bias: 0.0,
        facts: vec![
            Fact { quantity: "critical_bias", value: critical, source: "(s/2)(|gx|+|gy|)" },
            Fact { quantity: "acne_rate_without_bias", value: 0.5, source: "F(0) = 1/2" },
        ],
    })
}

/// T4: a thin vertical wall on level ground, light elevation α with cos α = 3/5. A bias of b world
/// units along the ray opens a gap of b·cos α behind the wall's foot.
#[must_use]
pub fn wall() -> Case {
    let wall = shapes::quad(
        [
            Vec3::new(0.0, 0.0, -2.0),
            Vec3::new(0.0, 0.0, 2.0),
            Vec3::new(0.0, 2.0, 2.0),
            Vec3::new(0.0, 2.0, -2.0),
        ],
        CASTER,
    );
    case(Scene {
        name: "t4-wall",
        document: "closed form: wall on ground",
        parts: vec![("ground", sheet(4.0, 0.0, 0.0, 0.0, GROUND)), ("wall", wall)],
        light: sun(DVec3::new(-6.0, 8.0, 0.0), DVec3::Y, 12.0, 2.0, 18.0),
        camera: camera(DVec3::Y, DVec3::ZERO, 6.0, 1.0),
        canvas: 400,
        map_size: 4096,
        bias: 0.05,
        facts: vec![Fact {
            quantity: "peter_panning_world",
            value: 0.05 * 16.0 * 0.6,
            source: "gap = b cos(alpha)",
        }],
    })
}

/// T7: a sphere of radius 1, centre 2 above the ground, under a light of elevation α, sin α = 4/5: its
/// shadow is an ellipse of area πR²/sin α.
#[must_use]
pub fn sphere() -> Case {
    let mut ball = shapes::sphere(1.0, 128, 64, CASTER);
    ball.positions.iter_mut().for_each(|p| p.y += 2.0);
    case(Scene {
        name: "t7-sphere",
        document: "closed form: sphere under sun",
        parts: vec![("ground", sheet(5.0, 0.0, 0.0, 0.0, GROUND)), ("sphere", ball)],
        light: sun(DVec3::new(-6.0, 8.0, 0.0), DVec3::Y, 12.0, 2.0, 18.0),
        camera: camera(DVec3::Y, DVec3::X * 2.0, 5.0, 15.5),
        canvas: 400,
        map_size: 1024,
        bias: 0.004,
        facts: vec![Fact {
            quantity: "shadow_area_world",
            value: std::f64::consts::PI / 0.8,
            source: "pi R^2 / sin(alpha)",
        }],
    })
}

/// T11: two parallel tilted plates 1/2 apart along the light. A constant bias works if and only if
/// (s/2)|g|₁ ≤ b < t − (s/2)|g|₁.
#[must_use]
pub fn plates() -> Case {
    let (gx, gz) = (0.5, 0.25);
    let normal = DVec3::new(-f64::from(gx), 1.0, -f64::from(gz)) / f64::sqrt(1.3125);
    let half = 0.125 / 2.0 * 0.75 / 16.0;
    let mut upper = sheet(2.0, 0.5, gx, gz, CASTER);
    upper.positions.iter_mut().for_each(|p| {
        p.x += 1.5;
        p.y += 1.5 * gx;
    });
    case(Scene {
        name: "t11-plates",
        document: "closed form: two parallel plates",
        parts: vec![("lower", sheet(3.5, 0.0, gx, gz, GROUND)), ("upper", upper)],
        light: sun(DVec3::Y * 8.0, DVec3::NEG_Z, 8.0, 0.0, 16.0),
        camera: camera(normal, DVec3::ZERO, 8.0, 15.8),
        canvas: 500,
        map_size: 64,
        bias: 0.01,
        facts: vec![
            Fact { quantity: "critical_bias", value: half, source: "(s/2)|g|1" },
            Fact { quantity: "detachment_bias", value: 0.5 / 16.0 - half, source: "t - (s/2)|g|1" },
        ],
    })
}

/// T2: a plane whose gradients, texels and depths are dyadic, so that every threshold is exact in f32.
#[must_use]
pub fn dyadic_plane() -> Case {
    let mut case = tilted_plane(0.25, -0.125);
    case.name = "t2-dyadic-plane".to_string();
    case.document = "closed form: dyadic plane".to_string();
    case
}

/// A spot at (0, 8, 0) looking down, 60°, near 1, far 12.
fn spot() -> Light {
    let eye = View { position: DVec3::Y * 8.0, target: DVec3::ZERO, up: DVec3::NEG_Z };
    let projection =
        Projection::Perspective { fovy_degrees: 60.0, aspect: 1.0, near: 1.0, far: 12.0 };
    Light::new(eye, projection, None)
}

/// T3: the plane y = gx·x + gz·z under a spot 8 above the origin. In window depth the critical bias is
/// the same all over the plane: (τ/2)·nf/(f − n)·(|gx| + |gz|)/8, τ = 2·tan 30°/N.
#[must_use]
pub fn spot_plane(gx: f32, gz: f32) -> Case {
    let tau = 2.0 * libm::tan(30.0 * std::f64::consts::PI / 180.0) / 64.0;
    let gradients = f64::from(gx.abs() + gz.abs());
    case(Scene {
        name: "t3-spot-plane",
        document: "closed form: plane under a spot",
        parts: vec![("plane", sheet(2.5, 0.0, gx, gz, GROUND))],
        light: spot(),
        camera: camera(DVec3::Y, DVec3::ZERO, 5.5, 1.0),
        canvas: 500,
        map_size: 64,
        bias: 0.0,
        facts: vec![Fact {
            quantity: "critical_bias",
            value: tau / 2.0 * (12.0 / 11.0) * gradients / 8.0,
            source: "(tau/2) nf/(f-n) (|Nx|+|Ny|)/|D|",
        }],
    })
}

/// Light of elevation α from −x, cos α = 3/5, and a scene on level ground beside the axis.
fn on_ground(
    name: &'static str,
    document: &'static str,
    bias: f32,
    caster: Mesh,
    gap: f64,
) -> Scene {
    Scene {
        name,
        document,
        parts: vec![("ground", sheet(4.0, 0.0, 0.0, 0.0, GROUND)), ("caster", caster)],
        light: sun(DVec3::new(-6.0, 8.0, 0.0), DVec3::Y, 12.0, 2.0, 18.0),
        camera: camera(DVec3::Y, DVec3::ZERO, 6.0, 15.8),
        canvas: 400,
        map_size: 2048,
        bias,
        facts: vec![Fact { quantity: "peter_panning_world", value: gap, source: "section 4.6" }],
    }
}

/// T5: a wall that leans over its own shadow, interior angle ψ with cos ψ = 3/5: a bias b along the ray
/// opens a gap of b·sin(α + ψ)/sin ψ = 1.2 b.
#[must_use]
pub fn leaning_wall() -> Case {
    let at = |x: f32, y: f32, z: f32| Vec3::new(x, y, z);
    let corners = [at(0., 0., -2.), at(0., 0., 2.), at(1.2, 1.6, 2.), at(1.2, 1.6, -2.)];
    let wall = shapes::quad(corners, CASTER);
    case(on_ground("t5-leaning-wall", "closed form: leaning wall", 0.025, wall, 1.2 * 0.025 * 16.0))
}

/// T6: a box ½ thick along the light. Its near faces stored, the foot stays dark below b = ½/cos α;
/// its far faces stored, the gap is b·cos α.
#[must_use]
pub fn solid(cull: Cull) -> Case {
    let block = shapes::cuboid(Vec3::new(-0.5, 0.0, -1.5), Vec3::new(0.0, 1.5, 1.5), CASTER);
    let gap = if cull == Cull::Front { 0.025 * 16.0 * 0.6 } else { 0.0 };
    let name = if cull == Cull::Front { "t6-box-back-faces" } else { "t6-box" };
    let mut case = case(on_ground(name, "closed form: box on ground", 0.025, block, gap));
    case.map.cull = cull.into();
    case
}

/// T8: a sphere of radius 1, centre 2 above the ground, under a spot 8 above it: its shadow is a circle of
/// radius 8/√(6² − 1).
#[must_use]
pub fn sphere_under_spot() -> Case {
    let mut ball = shapes::sphere(1.0, 128, 64, CASTER);
    ball.positions.iter_mut().for_each(|p| p.y += 2.0);
    case(Scene {
        name: "t8-sphere-spot",
        document: "closed form: sphere under a point light",
        parts: vec![("ground", sheet(3.0, 0.0, 0.0, 0.0, GROUND)), ("sphere", ball)],
        light: spot(),
        camera: camera(DVec3::Y, DVec3::ZERO, 5.0, 15.5),
        canvas: 400,
        map_size: 1024,
        bias: 0.0005,
        facts: vec![Fact {
            quantity: "shadow_area_world",
            value: std::f64::consts::PI * 64.0 / 35.0,
            source: "pi (R h / sqrt((h-H)^2 - R^2))^2",
        }],
    })
}

/// T9: a sphere alone under a vertical light: nothing shadows it but itself.
#[must_use]
pub fn ball() -> Case {
    case(Scene {
        name: "t9-ball",
        document: "closed form: sphere, self-shadow",
        parts: vec![("sphere", shapes::sphere(1.0, 128, 64, CASTER))],
        light: sun(DVec3::Y * 8.0, DVec3::NEG_Z, 4.0, 0.0, 16.0),
        camera: camera(DVec3::Y, DVec3::ZERO, 2.5, 1.0),
        canvas: 400,
        map_size: 256,
        bias: 0.002,
        facts: Vec::new(),
    })
}

/// T10: a disc of radius 1 (256 corners) over the ground under a vertical light: on average 0.24357·s of
/// receiver per unit of its outline is on the wrong side.
#[must_use]
pub fn disc() -> Case {
    let turn = 2.0 * std::f64::consts::PI / 256.0;
    let rim = (0..256).map(|i| {
        let angle = turn * f64::from(i);
        Vec3::new(libm::cos(angle) as f32, 2.0, libm::sin(angle) as f32)
    });
    let positions: Vec<Vec3> = std::iter::once(Vec3::Y * 2.0).chain(rim).collect();
    let triangles = (0..256u32).map(|i| [0, 1 + (i + 1) % 256, 1 + i]).collect();
    case(Scene {
        name: "t10-disc",
        document: "closed form: disc over ground",
        parts: vec![
            ("ground", sheet(3.5, 0.0, 0.0, 0.0, GROUND)),
            ("disc", Mesh::new(positions, triangles, CASTER)),
        ],
        light: sun(DVec3::Y * 8.0, DVec3::NEG_Z, 8.0, 0.0, 16.0),
        camera: camera(DVec3::Y, DVec3::ZERO, 3.0, 15.0),
        canvas: 600,
        map_size: 128,
        bias: 0.001,
        facts: vec![Fact {
            quantity: "edge_aliasing_area_world",
            value: 0.243_57 * (8.0 / 128.0) * 2.0 * std::f64::consts::PI,
            source: "0.24357 s 2 pi R",
        }],
    })
}

/// T12: three steps down away from the light, ¼ high and 1 deep: behind each the gap is b·cos α.
#[must_use]
pub fn stairs() -> Case {
    let mut steps = Mesh::new(Vec::new(), Vec::new(), CASTER);
    for i in 0..3u8 {
        let (x, y) = (f32::from(i) - 2.0, 0.25 * f32::from(3 - i));
        let step = shapes::cuboid(Vec3::new(x, 0.0, -1.5), Vec3::new(x + 1.0, y, 1.5), CASTER);
        let first = steps.positions.len() as u32;
        steps.positions.extend(step.positions);
        steps.triangles.extend(step.triangles.iter().map(|t| t.map(|v| v + first)));
    }
    let mut scene = on_ground("t12-stairs", "closed form: stairs", 0.0, steps, 0.0);
    scene.facts.clear();
    scene.camera = camera(DVec3::Y, DVec3::ZERO, 6.0, 1.0);
    scene.bias = 1.0 / 1024.0;
    case(scene)
}
