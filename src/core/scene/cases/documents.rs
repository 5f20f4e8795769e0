//! The thirteen systems of the five documents, vertex for vertex and matrix for matrix.

use crate::camera::Camera;
use crate::depth::{DepthFormat, Packing};
use crate::device::DeviceProfile;
use crate::light::Light;
use crate::scene::shapes::{self, Mesh};
use crate::scene::{
    Case, CompareRule, CoordForm, Cull, CullRule, DepthBuffer, Filter, LookupSpec, MapSpec,
    MatrixChain, Object, Shading, TexelFormat, Wrap,
};
use crate::view::{Projection, View};
use glam::{DMat3, DVec3, Mat4, Vec3};

const OPAQUE_BLACK: [f32; 4] = [0.0, 0.0, 0.0, 1.0];
const TRANSPARENT_BLACK: [f32; 4] = [0.0; 4];

/// All thirteen, in the documents' order.
#[must_use]
pub fn all() -> Vec<Case> {
    let mut cases = Vec::new();
    for packing in [Packing::R8, Packing::Book] {
        for light_y in [7.0, 40.0] {
            for slanted in [false, true] {
                cases.push(book(packing, light_y, slanted));
            }
        }
    }
    cases.extend([runnable(), upc(), fundamentals(false), fundamentals(true), exam()]);
    cases
}

fn perspective(fovy_degrees: f64, near: f64, far: f64) -> Projection {
    Projection::Perspective { fovy_degrees, aspect: 1.0, near, far }
}

fn view(position: [f64; 3], target: [f64; 3]) -> View {
    View { position: DVec3::from_array(position), target: DVec3::from_array(target), up: DVec3::Y }
}

fn light(position: [f64; 3], target: [f64; 3], projection: Projection) -> Light {
    Light::new(view(position, target), projection, None)
}

fn camera(position: [f64; 3], fovy: f64, far: f64) -> Camera {
    Camera { view: view(position, [0.0; 3]), projection: perspective(fovy, 1.0, far) }
}

fn objects(parts: Vec<(&str, Mesh, Mat4)>) -> Vec<Object> {
    parts.into_iter().map(|(name, mesh, model)| Object::new(name, mesh, model)).collect()
}

/// Triangle and plane of document 004 and of the book's sample.
fn triangle_and_plane(plane_model: Mat4) -> Vec<(&'static str, Mesh, Mat4)> {
    let orange = Vec3::new(1.0, 0.5, 0.0);
    let triangle = Mesh {
        positions: vec![
            Vec3::new(-0.8, 3.5, 0.0),
            Vec3::new(0.8, 3.5, 0.0),
            Vec3::new(0.0, 3.5, 1.8),
        ],
        triangles: vec![[0, 1, 2]],
        colours: vec![orange, orange, Vec3::new(1.0, 0.0, 0.0)],
        ..Mesh::default()
    };
    let at = |x: f32, z: f32| Vec3::new(x, -1.7, z);
    let plane =
        shapes::quad([at(3.0, 2.5), at(-3.0, 2.5), at(-3.0, -2.5), at(3.0, -2.5)], Vec3::ONE);
    vec![("triangle", triangle, Mat4::IDENTITY), ("plane", plane, plane_model)]
}

/// −45° about (0,1,1): the pose assumed where the book only says "slanted".
fn slant() -> Mat4 {
    let angle = -45.0 * std::f64::consts::PI / 180.0;
    let axis = DVec3::new(0.0, 1.0, 1.0) / f64::sqrt(2.0);
    let (sin, cos) = (libm::sin(angle), libm::cos(angle));
    let cross = DMat3::from_cols(
        DVec3::new(0.0, axis.z, -axis.y),
        DVec3::new(-axis.z, 0.0, axis.x),
        DVec3::new(axis.y, -axis.x, 0.0),
    );
    let outer = DMat3::from_cols(axis * axis.x, axis * axis.y, axis * axis.z);
    let rotation = DMat3::IDENTITY * cos + outer * (1.0 - cos) + cross * sin;
    Mat4::from_mat3(rotation.as_mat3())
}

const COLOUR_PASS: &str =
    "the map pass has a DEPTH_COMPONENT16 renderbuffer, wrap REPEAT, filter LINEAR (the defaults)";

struct ColourCase<'a> {
    name: &'a str,
    document: &'a str,
    packing: Packing,
    light: Light,
    map_size: u32,
    canvas: u32,
    bias: f32,
    plane_model: Mat4,
}

/// A case of documents 000 or 004, which share geometry, camera, rule and clear colour.
fn colour_case(c: ColourCase<'_>) -> Case {
    let camera = camera([0.0, 7.0, 9.0], 45.0, 100.0);
    let chain = MatrixChain::Combined;
    Case {
        name: c.name.to_string(),
        document: c.document.to_string(),
        objects: objects(triangle_and_plane(c.plane_model)),
        light: c.light,
        camera,
        canvas: [c.canvas; 2],
        chain,
        map: MapSpec {
            size: c.map_size,
            texel: TexelFormat::Packed(c.packing),
            clear: OPAQUE_BLACK,
            depth_buffer: DepthBuffer::Unorm16,
            cull: CullRule::None,
        },
        lookup: LookupSpec {
            coord: CoordForm::DivideHalveAdd,
            compare: CompareRule::ReceiverBeyond,
            range_test: false,
            filter: Filter::Linear,
            wrap: Wrap::Repeat,
        },
        camera_cull: Cull::None,
        bias: c.bias,
        shading: Shading::Tint,
        device: DeviceProfile::WebglSwiftshader,
        assumptions: vec![COLOUR_PASS.to_string()],
        skipped: Vec::new(),
        facts: Vec::new(),
    }
}

fn book(packing: Packing, light_y: f64, slanted: bool) -> Case {
    let (program, bias) = if packing == Packing::R8 { ("r8", 0.005) } else { ("rgba8", 0.0015) };
    let pose = if slanted { "-slant" } else { "" };
    let mut case = colour_case(ColourCase {
        name: &format!("book-{program}-y{light_y}{pose}"),
        document: if program == "r8" { "000 Shadow.js" } else { "000 Shadow_highp.js" },
        packing,
        light: light([0.0, light_y, 2.0], [0.0; 3], perspective(70.0, 1.0, 100.0)),
        map_size: 1024,
        canvas: 400,
        bias,
        plane_model: if slanted { slant() } else { Mat4::IDENTITY },
    });
    case.assumptions.push("geometry taken from document 004, clear colour (0,0,0,1)".into());
    case.assumptions.push("triangle at rotation angle 0, canvas 400 x 400".into());
    case.assumptions.push(if slanted {
        "plane rotated -45 degrees about (0,1,1): the document says only that it is slanted".into()
    } else {
        "plane not rotated, as in document 004".into()
    });
    case
}

fn runnable() -> Case {
    colour_case(ColourCase {
        name: "runnable-rgba8",
        document: "004 runnable example",
        packing: Packing::Book,
        light: light([0.0, 40.0, 2.0], [0.0; 3], perspective(70.0, 1.0, 200.0)),
        map_size: 2048,
        canvas: 500,
        bias: 0.0015,
        plane_model: Mat4::IDENTITY,
    })
}

fn upc() -> Case {
    let light = light([0.0, 7.0, 2.0], [0.0; 3], perspective(70.0, 1.0, 100.0));
    let base = colour_case(ColourCase {
        name: "upc",
        document: "001 UPC slides",
        packing: Packing::Upc,
        light,
        map_size: 2048,
        canvas: 400,
        bias: 0.001,
        plane_model: Mat4::IDENTITY,
    });
    let chain = MatrixChain::ModelView;
    Case {
        objects: objects(triangle_and_plane(Mat4::IDENTITY)),
        chain,
        map: MapSpec { clear: TRANSPARENT_BLACK, ..base.map },
        lookup: LookupSpec {
            coord: CoordForm::HalveDivideAdd,
            compare: CompareRule::NotStoredBeyond,
            ..base.lookup
        },
        shading: Shading::AmbientDiffuseSpecular,
        assumptions: vec![
            "geometry and camera of document 004, light (0,7,2), 70 degrees, near 1, far 100"
                .into(),
            "the packing's vec3 by vec4 product, which does not compile, read as xxyz".into(),
            "default clear colour (0,0,0,0), canvas 400 x 400, wrap REPEAT".into(),
        ],
        ..base
    }
}

/// Sphere, floor and cube of document 002.
fn sphere_floor_cube() -> Vec<(&'static str, Mesh, Mat4)> {
    let sphere = shapes::sphere(1.0, 32, 24, Vec3::new(1.0, 0.5, 0.5));
    let floor = shapes::floor(20.0, Vec3::new(0.5, 0.5, 1.0));
    let cube = shapes::cube(2.0, Vec3::new(0.5, 1.0, 0.5));
    vec![
        ("sphere", sphere, Mat4::from_translation(Vec3::new(2.0, 3.0, 4.0))),
        ("plane", floor, Mat4::IDENTITY),
        ("cube", cube, Mat4::from_translation(Vec3::new(3.0, 1.0, 0.0))),
    ]
}

const SPHERE_SOURCE: &str = "sphere of radius 1 (32 x 24) at (2,3,4) and floor 20 x 20 at y = 0 are \
not in the document but in the article before it";

/// A case of documents 002 or 003, which share geometry, map size and depth texture.
fn depth_case(
    name: &str,
    document: &str,
    light: Light,
    camera: Camera,
    chain: MatrixChain,
    lookup: LookupSpec,
) -> Case {
    Case {
        name: name.to_string(),
        document: document.to_string(),
        objects: objects(sphere_floor_cube()),
        light,
        camera,
        canvas: [400; 2],
        chain,
        map: MapSpec {
            size: 512,
            texel: TexelFormat::Depth(DepthFormat::Unorm24),
            clear: [1.0; 4],
            depth_buffer: DepthBuffer::Texture,
            cull: CullRule::Back,
        },
        lookup,
        camera_cull: Cull::Back,
        bias: 0.006,
        shading: Shading::Lambert,
        device: DeviceProfile::WebglSwiftshader,
        skipped: Vec::new(),
        assumptions: vec![SPHERE_SOURCE.to_string(), "canvas 400 x 400, camera 60 degrees".into()],
        facts: Vec::new(),
    }
}

fn fundamentals(directional: bool) -> Case {
    let projection = if directional {
        Projection::Orthographic { width: 10.0, height: 10.0, near: 0.5, far: 10.0 }
    } else {
        perspective(120.0, 0.5, 10.0)
    };
    let cone = (!directional).then(|| libm::cos(60.0 * std::f64::consts::PI / 180.0));
    let light = Light::new(view([2.5, 4.8, 4.3], [2.5, 0.0, 3.5]), projection, cone);
    let eye = if directional { [6.0, 12.0, 7.0] } else { [2.75, 5.0, 7.0] };
    let lookup = LookupSpec {
        coord: CoordForm::Divide,
        compare: CompareRule::StoredAtMost,
        range_test: true,
        filter: Filter::Nearest,
        wrap: Wrap::Clamp,
    };
    let name = if directional { "fundamentals-directional" } else { "fundamentals-spot" };
    let camera = camera(eye, 60.0, 2000.0);
    let document = "002 WebGLFundamentals";
    let mut case = depth_case(name, document, light, camera, MatrixChain::World, lookup);
    if directional {
        case.assumptions.push(
            "orthographic 10 x 10 (printed 1 x 1) and camera (6,12,7): the document says only that \
             the camera was moved to see more"
                .into(),
        );
    }
    case
}

fn exam() -> Case {
    let light = light([5.0, 8.0, 4.0], [0.0; 3], perspective(60.0, 1.0, 20.0));
    let lookup = LookupSpec {
        coord: CoordForm::Divide,
        compare: CompareRule::NotReceiverBefore,
        range_test: false,
        filter: Filter::Pcf3,
        wrap: Wrap::Clamp,
    };
    let camera = camera([6.0, 5.0, 7.0], 60.0, 2000.0);
    let document = "003 WebGL2 PCF";
    let mut case = depth_case("exam-pcf", document, light, camera, MatrixChain::BiasMatrix, lookup);
    case.map.cull = CullRule::Front;
    case.bias = 0.001;
    case.shading = Shading::AmbientLambert;
    case.assumptions = vec![
        "geometry of document 002; light (5,8,4) to the origin, 60 degrees, near 1, far 20; camera \
         (6,5,7); map 512: none of these is in the document"
            .into(),
        "bias matrix with its third column corrected to (0,0,0.5,0)".into(),
        "a missing brace put back, so that the division by 9 runs once".into(),
    ];
    case
}
