//! Scenes whose artifacts are known in closed form: T1 tilted plane, T4 wall, T7 sphere under sun,
//! T11 two plates.
//!
//! Notation: s texel edge, g depth gradient in light space, |g|₁ = |gx| + |gy|, α elevation of the
//! light. All lights are orthographic, so window depth is linear: world length = depth · (far − near).

use crate::camera::Camera;
use crate::depth::DepthFormat;
use crate::device::DeviceProfile;
use crate::light::Light;
use crate::scene::shapes::{self, Mesh};
use crate::scene::{
    Case, CompareRule, CoordForm, Cull, DepthBuffer, Fact, Filter, LookupSpec, MapSpec,
    MatrixChain, Object, Shading, TexelFormat, Wrap,
};
use crate::view::{Projection, View};
use glam::{DVec3, Mat4, Vec3};

/// The analytic cases.
#[must_use]
pub fn all() -> Vec<Case> {
    vec![tilted_plane(0.5, 0.25), wall(), sphere(), plates()]
}

const GROUND: Vec3 = Vec3::new(0.8, 0.8, 0.75);
const CASTER: Vec3 = Vec3::new(0.75, 0.55, 0.4);

/// An orthographic light of side `width` at `position`, looking at the origin.
fn sun(position: DVec3, up: DVec3, width: f64, near: f64, far: f64) -> Light {
    Light {
        view: View { position, target: DVec3::ZERO, up },
        projection: Projection::Orthographic { width, height: width, near, far },
        cone_cos: None,
    }
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
    let object = |(name, mesh): (&str, Mesh)| Object {
        name: name.to_string(),
        mesh,
        model: Mat4::IDENTITY,
        matrices: chain.matrices(&scene.light, &scene.camera, &Mat4::IDENTITY),
    };
    Case {
        name: scene.name.to_string(),
        document: scene.document.to_string(),
        objects: scene.parts.into_iter().map(object).collect(),
        light: scene.light,
        camera: scene.camera,
        canvas: [scene.canvas; 2],
        chain,
        map: MapSpec {
            size: scene.map_size,
            texel: TexelFormat::Depth(DepthFormat::F32),
            clear: [1.0; 4],
            depth_buffer: DepthBuffer::Texture,
            cull: Cull::None,
        },
        lookup: LookupSpec {
            coord: CoordForm::Divide,
            compare: CompareRule::ReceiverBeyond,
            range_test: true,
            filter: Filter::Nearest,
            wrap: Wrap::Clamp,
        },
        camera_cull: Cull::None,
        bias: scene.bias,
        shading: Shading::Lambert,
        device: DeviceProfile::Ideal,
        assumptions: Vec::new(),
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
