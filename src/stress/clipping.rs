//! Where projection ends: receivers behind the light, outside the map, triangles through the near plane.

use super::search::{Random, ladder, onset};
use super::{Fate, Forecast, Row, Sampling, Stress};
use crate::camera::Camera;
use crate::depth::DepthFormat;
use crate::device::{Device, DeviceProfile};
use crate::light::{Layout, Lens, Lookup, Map};
use crate::raster::Setup;
use crate::report::Scale;
use crate::scene::{
    CompareRule, CoordForm, Cull, CullRule, DepthBuffer, Filter, LookupSpec, MapSpec, MatrixChain,
    TexelFormat, Wrap,
};
use crate::shadow::sampler::nearest_texel;
use crate::shadow::{Drawn, ShadowMap, visibility};
use crate::view::{Projection, View};
use glam::{DMat3, DVec3, Mat4, Vec4};

/// Texels per side of the maps.
const SIZE: u32 = 32;
/// Field of view of the spot, degrees.
const FIELD: f64 = 70.0;

fn device() -> Device {
    DeviceProfile::Ideal.device()
}

/// A map in which every texel holds `depth`.
fn uniform_map(depth: f32) -> ShadowMap {
    let spec = MapSpec {
        size: SIZE,
        texel: TexelFormat::Depth(DepthFormat::F32),
        clear: [1.0; 4],
        depth_buffer: DepthBuffer::Texture,
        cull: CullRule::None,
    };
    let texels = (SIZE * SIZE) as usize;
    let (depth, triangle) = (vec![depth; texels], vec![0; texels]);
    let layout = Layout::whole([SIZE; 2]);
    ShadowMap::store(&device(), &spec, &layout, Drawn { depth: &depth, triangle: &triangle })
}

fn lookup(range_test: bool, wrap: Wrap) -> LookupSpec {
    LookupSpec {
        coord: CoordForm::Divide,
        compare: CompareRule::ReceiverBeyond,
        range_test,
        filter: Filter::Nearest,
        wrap,
    }
}

/// Whether the documents' look-up at `coord` says lit.
fn lit(map: &ShadowMap, spec: &LookupSpec, coord: [f32; 3]) -> bool {
    let lookups = [Lookup::only(coord)];
    let taps = map.taps(&device(), spec, &lookups, [0; 2]);
    visibility(spec, &lookups, &taps, 0.005) > 0
}

/// A spot at the origin that looks down −z over an empty scene, and its look-up matrix in f32.
struct Spot {
    lens: Lens,
    coord_from_world: Mat4,
}

impl Spot {
    fn new() -> Self {
        let view = View { position: DVec3::ZERO, target: DVec3::NEG_Z, up: DVec3::Y };
        let projection =
            Projection::Perspective { fovy_degrees: FIELD, aspect: 1.0, near: 1.0, far: 100.0 };
        let map = Map::new(view, projection);
        let chain = MatrixChain::BiasMatrix;
        let matrices = chain.matrices(&map, &Camera { view, projection }, &Mat4::IDENTITY);
        let stages = matrices.stages(&device(), &Mat4::IDENTITY);
        Self { lens: Lens::new(&map, [SIZE; 2]), coord_from_world: stages.light_coord[0] }
    }

    /// A point 10 from the light, `degrees` off its axis.
    fn around(degrees: f64) -> DVec3 {
        let angle = degrees * std::f64::consts::PI / 180.0;
        DVec3::new(10.0 * libm::sin(angle), 0.0, -10.0 * libm::cos(angle))
    }

    /// The documents' verdict: no look at the sign of w.
    fn lit_unguarded(&self, map: &ShadowMap, degrees: f64) -> bool {
        let p = Self::around(degrees).as_vec3().extend(1.0);
        let coord = CoordForm::Divide
            .apply(device().mat_vec(&self.coord_from_world, p), Default::default());
        lit(map, &lookup(true, Wrap::Clamp), coord)
    }

    /// Whether the look-up says lit where w ≤ 0 means outside the map.
    fn lit_guarded(&self, map: &ShadowMap, degrees: f64) -> bool {
        let window = self.lens.look(Self::around(degrees));
        window.is_none_or(|w| lit(map, &lookup(true, Wrap::Clamp), w.as_vec3().to_array()))
    }
}

fn dark(is_lit: bool) -> f64 {
    f64::from(u8::from(!is_lit))
}

/// Receivers all around a spot over an empty scene.
pub(super) fn behind(_: &Sampling) -> Stress {
    let (spot, map) = (Spot::new(), uniform_map(1.0));
    let angles: Vec<f64> = (0..=18).map(|i| 10.0 * f64::from(i)).collect();
    let predicted = 180.0 - FIELD / 2.0;
    let event = "receivers behind the light are in shadow of an empty scene";
    let mirrored = "xyz/w with w < 0 mirrors them into the map with z > 1, from 180° − fov/2 on";
    let unguarded = Forecast::at(Fate::Breaks, predicted, "behind-unguarded", event, mirrored)
        .curve(&angles, |a| f64::from(u8::from(a >= predicted)));
    let guarded = Forecast::never("behind-guarded", event, "w ≤ 0 is outside the map: lit")
        .curve(&angles, |_| 0.0);
    let row = |forecast: Forecast, is_lit: &dyn Fn(f64) -> bool| {
        let measured = onset(1.0, 180.0, 400, |a| !is_lit(a));
        forecast.met(measured, angles.iter().map(|&a| (a, dark(is_lit(a)))).collect())
    };
    Stress {
        id: "behind-the-light",
        title: "Behind the light (w ≤ 0)",
        lead: format!(
            "A spot of {FIELD}° over an empty scene: nothing is in shadow. Receivers on a circle around \
             it are looked up as the documents do, and with w ≤ 0 taken as outside the map. 1 = shadow."
        ),
        parameter: "angle off the light's axis [degrees]",
        error: "false shadow",
        scale: Scale::Linear,
        rows: vec![
            row(unguarded, &|a| spot.lit_unguarded(&map, a)),
            row(guarded, &|a| spot.lit_guarded(&map, a)),
        ],
    }
}

/// Receivers beyond the map's border, where the border texels hold an occluder.
pub(super) fn border(_: &Sampling) -> Stress {
    let map = uniform_map(0.2);
    let coordinates = ladder(0.25, 8.0, 11);
    let verdict = |spec: &LookupSpec, u: f64| lit(&map, spec, [u as f32, 0.5, 0.5]);
    let event = "receivers outside the map are lit";
    let row = |name: &str, spec: LookupSpec, formula: &str, predicted: Option<f64>| {
        let forecast = match predicted {
            Some(at) => Forecast::at(Fate::Degrades, at, name, event, formula),
            None => Forecast::never(name, event, formula),
        };
        let inside = |u: f64| f64::from(u8::from(predicted.is_none_or(|at| u <= at)));
        let forecast = forecast.curve(&coordinates, inside);
        let measured = onset(0.25, 8.0, 200, |u| verdict(&spec, u));
        forecast.met(measured, coordinates.iter().map(|&u| (u, dark(verdict(&spec, u)))).collect())
    };
    let beyond =
        [1.0f32, 1.0f32.next_up(), 8.0].map(|u| nearest_texel(u, SIZE, Wrap::Clamp, false));
    let note = format!(
        "At u = 1, just above and at 8 the texel read is {beyond:?} of 0–{}: index {SIZE} never is.",
        SIZE - 1
    );
    let tested = row("border-tested", lookup(true, Wrap::Clamp), "outside means u > 1", Some(1.0));
    Stress {
        id: "map-border",
        title: "Outside the map",
        lead:
            "Every texel holds an occluder; receivers walk over the border. With a range test they \
               are lit outside, without one the border texel or the repeated map shadows for ever. \
               1 = shadow."
                .to_string(),
        parameter: "coordinate u",
        error: "in shadow",
        scale: Scale::Log,
        rows: vec![
            tested.noting(note),
            row("border-clamped", lookup(false, Wrap::Clamp), "the border texel goes on", None),
            row("border-repeated", lookup(false, Wrap::Repeat), "the map repeats", None),
        ],
    }
}

/// Clip-space vertices: two before the eye, one `behind` it by so much.
fn crossing(behind: f64, random: &mut Random) -> [Vec4; 3] {
    let projection =
        Projection::Perspective { fovy_degrees: 90.0, aspect: 1.0, near: 0.1, far: 100.0 };
    let matrix = projection.clip_from_view().as_mat4();
    let mut vertex = |z: f64| {
        let [x, y] = [0; 2].map(|_| (random.unit() - 0.5) * 2.0 * z.abs().max(0.5));
        device().mat_vec(&matrix, DVec3::new(x, y, z).as_vec3().extend(1.0))
    };
    [vertex(-1.0), vertex(-4.0), vertex(behind)]
}

/// Whether a triangle given in homogeneous coordinates shows at a place of the picture: all weights of
/// Σλv = (x, y, z, 1) nonnegative and −1 ≤ z ≤ 1. f64, no clipping.
fn shows(corners: &[Vec4; 3], px: f64, py: f64) -> bool {
    let half = f64::from(SIZE) / 2.0;
    let columns = corners.map(|v| DVec3::new(v.x.into(), v.y.into(), v.w.into()));
    let place = DVec3::new((px + 0.5) / half - 1.0, (py + 0.5) / half - 1.0, 1.0);
    let weights = DMat3::from_cols(columns[0], columns[1], columns[2]).inverse() * place;
    let z: f64 = (0..3).map(|i| weights[i] * f64::from(corners[i].z)).sum();
    weights.min_element() >= 0.0 && z.abs() <= 1.0
}

/// Pixels on which the rasteriser differs from [`shows`] though all places within 2 sub-pixels agree.
fn differing(corners: &[Vec4; 3]) -> usize {
    let setup = Setup::new(&device(), [SIZE; 2], *corners);
    let mut hit = vec![false; (SIZE * SIZE) as usize];
    setup.cover(&device(), [SIZE; 2], Cull::None, |y, first, end| {
        (first..end).for_each(|x| hit[(y * SIZE + x) as usize] = true);
    });
    let near = 2.0 / 256.0;
    let wrong = |i: &u32| {
        let (x, y) = (f64::from(i % SIZE), f64::from(i / SIZE));
        let expected = shows(corners, x, y);
        let sides = [(near, 0.0), (-near, 0.0), (0.0, near), (0.0, -near)];
        let decided = sides.iter().all(|(dx, dy)| shows(corners, x + dx, y + dy) == expected);
        decided && hit[*i as usize] != expected
    };
    (0..SIZE * SIZE).filter(wrong).count()
}

/// Pixels covered twice by two triangles that share an edge through the near plane.
fn doubled(corners: &[Vec4; 3]) -> usize {
    let [a, b, c] = *corners;
    // The fourth corner lies beyond edge a–c from b: the parallelogram's.
    let other = [a, c, a + c - b];
    let mut hits = vec![0u8; (SIZE * SIZE) as usize];
    for triangle in [[a, b, c], other] {
        let setup = Setup::new(&device(), [SIZE; 2], triangle);
        setup.cover(&device(), [SIZE; 2], Cull::None, |y, first, end| {
            (first..end).for_each(|x| hits[(y * SIZE + x) as usize] += 1);
        });
    }
    hits.iter().filter(|&&n| n > 1).count()
}

/// Triangles with a vertex ever farther behind the eye.
pub(super) fn near_plane(effort: &Sampling) -> Stress {
    let depths = ladder(1e-6, 1e6, 13);
    let mut random = Random(effort.seed);
    let mut count = |of: &dyn Fn(&[Vec4; 3]) -> usize| -> Vec<(f64, f64)> {
        let one = |&behind: &f64| {
            let wrong: usize =
                (0..effort.samples / 8).map(|_| of(&crossing(behind, &mut random))).sum();
            (behind, wrong as f64)
        };
        depths.iter().map(one).collect()
    };
    let row = |name: &str, event: &str, formula: &str, curve: Vec<(f64, f64)>| -> Row {
        let first = curve.iter().find(|p| p.1 > 0.0).map(|p| p.0);
        let total: f64 = curve.iter().map(|p| p.1).sum();
        let note =
            format!("{total} pixels in {} triangles.", depths.len() as u32 * (effort.samples / 8));
        Forecast::never(name, event, formula).curve(&depths, |_| 0.0).met(first, curve).noting(note)
    };
    let wrong = count(&differing);
    let twice = count(&doubled);
    Stress {
        id: "near-plane",
        title: "Through the near plane",
        lead:
            "Triangles with two vertices before the eye and one behind it, against the homogeneous \
               definition in f64 (no clipping there), and pairs that share a clipped edge."
                .to_string(),
        parameter: "distance of the third vertex behind the eye [world units]",
        error: "wrong pixels",
        scale: Scale::Log,
        rows: vec![
            row(
                "near-plane-coverage",
                "a pixel farther than 2 sub-pixels from an edge is wrong",
                "clipping before the division keeps every w positive",
                wrong,
            ),
            row(
                "near-plane-shared-edge",
                "a clipped shared edge covers a pixel twice",
                "both sides cut the edge at the same f32 point",
                twice,
            ),
        ],
    }
}
