//! One receiver at a time: its truth, its look-up, the verdict on every rung, and what went wrong.

use super::adjacency::Adjacency;
use super::classify::{Outcome, StoredCaster};
use super::effort::Effort;
pub use super::observation::{Observation, Standing};
use crate::depth::DepthFormat;
use crate::device::Device;
use crate::raster::Interpolator;
use crate::raster::NO_TRIANGLE;
use crate::raster::passes::{Subject, draw_map, map_depth_buffer};
use crate::scene::{Case, Cull, Geometry, LookupSpec};
use crate::shadow::{self, ShadowMap, Taps};
use crate::truth::{Answer, Faces, LightEnd, Receiver, Tracer, Truth};
use glam::{DMat4, DVec2, DVec3};
use rayon::prelude::*;

/// Share of a look-up's visibility that `lit` taps have: 1 where the range test lights all of them.
fn lit_share(taps: &Taps, lit: usize, is_lit: impl Fn(f32) -> bool) -> f64 {
    if lit == taps.depths().len() { 1.0 } else { taps.visibility(|i| is_lit(taps.depths()[i])) }
}

/// A drawn case with everything needed to judge any of its receivers.
#[derive(Debug)]
pub struct Observer<'a> {
    /// The drawn case.
    pub subject: Subject<'a>,
    /// World triangles.
    pub geometry: Geometry,
    /// Truth.
    pub tracer: Tracer,
    /// The map's clip matrix in f64.
    pub clip_from_world: DMat4,
    /// Its inverse.
    pub world_from_clip: DMat4,
    pub(super) adjacency: Adjacency,
    /// Window-space corners of every triangle in map texels (`None` behind the eye).
    pub(super) projected: Vec<Option<[DVec2; 3]>>,
    /// The rasteriser's own depths under a float depth attachment.
    pub(super) unquantized: ShadowMap,
    /// Its triangles.
    float_triangles: Vec<u32>,
    /// Which sides of casters the light sees in the map.
    pub(super) drawn_faces: Faces,
    /// Where shadow rays end.
    light: LightEnd,
    /// The unit vector towards a directional light.
    sun: Option<DVec3>,
    /// How answers are found.
    pub effort: Effort,
}

/// The map under a float depth attachment, not quantized, and its triangles. Where the case's own
/// attachment is one, its raster is the same.
fn float_map(subject: &Subject<'_>, effort: Effort) -> (ShadowMap, Vec<u32>) {
    let Subject { case, device, vertices, map_raster, .. } = subject;
    let own = device.depth_format(map_depth_buffer(case)) == device.depth_format(DepthFormat::F32);
    let drawn = (!(own && effort.skip)).then(|| draw_map(case, device, vertices, DepthFormat::F32));
    let raster = drawn.as_ref().unwrap_or(map_raster);
    let map = ShadowMap::unquantized(case.map.size, raster.drawn(), f32::INFINITY);
    let triangles = drawn.map_or_else(|| map_raster.triangle.clone(), |raster| raster.triangle);
    (map, triangles)
}

/// A pixel's receiver and its map coordinates in the subject.
#[derive(Clone, Copy, Debug)]
pub(super) struct Looking {
    pub(super) pixel: [u32; 2],
    pub(super) receiver: Receiver,
    pub(super) coord: [f32; 3],
}

/// A triangle of the camera pass, set up for all its pixels.
pub(super) struct Spot {
    pub(super) triangle: u32,
    interpolator: Interpolator,
    corners: [DVec3; 3],
}

impl Spot {
    pub(super) fn new(observer: &Observer<'_>, triangle: u32) -> Self {
        Self {
            triangle,
            interpolator: observer.subject.interpolator(triangle),
            corners: observer.geometry.corners(triangle),
        }
    }

    /// The receiver at a pixel centre, and its map coordinates in the subject.
    pub(super) fn receiver(&self, observer: &Observer<'_>, x: u32, y: u32) -> (Receiver, [f32; 3]) {
        let weights = self.interpolator.barycentrics(x, y);
        let [a, b, c] = self.corners;
        let position = a * weights.x + b * weights.y + c * weights.z;
        let varying = self.interpolator.vector(x as f32, y as f32);
        let coord = observer.case().lookup.coord.apply(varying);
        (Receiver { position, triangle: self.triangle }, coord)
    }
}

impl<'a> Observer<'a> {
    /// Draws the case on a device and prepares its truth.
    #[must_use]
    pub fn new(case: &'a Case, device: &Device) -> Self {
        Self::with(case, device, Effort::default())
    }

    /// An observer that works by a given effort.
    #[must_use]
    pub fn with(case: &'a Case, device: &Device, effort: Effort) -> Self {
        let (subject, (geometry, tracer, adjacency)) = rayon::join(
            || Subject::draw(case, device),
            || {
                let geometry = case.geometry();
                let (tracer, adjacency) =
                    rayon::join(|| Tracer::new(&geometry), || Adjacency::new(&geometry));
                (geometry, tracer, adjacency)
            },
        );
        let clip_from_world = case.light.clip_from_world();
        let size = case.map.size;
        let (unquantized, float_triangles) = float_map(&subject, effort);
        let texels = |p: DVec3| {
            let window = case.light.window_from_world(&clip_from_world, p)?;
            Some(window.truncate() * f64::from(size))
        };
        let corners = |t: u32| {
            let [a, b, c] = geometry.corners(t).map(texels);
            Some([a?, b?, c?])
        };
        let ids = (0..geometry.triangles.len() as u32).into_par_iter().with_min_len(1024);
        let sun = case.light.is_directional().then(|| case.light.view.backward());
        Self {
            projected: ids.map(corners).collect(),
            light: match sun {
                Some(sun) => LightEnd::Along(sun * tracer.reach()),
                None => LightEnd::Point(case.light.view.position),
            },
            sun,
            tracer,
            adjacency,
            world_from_clip: clip_from_world.inverse(),
            drawn_faces: match case.map.cull {
                Cull::None => Faces::Both,
                Cull::Back => Faces::Front,
                Cull::Front => Faces::Back,
            },
            subject,
            geometry,
            clip_from_world,
            unquantized,
            float_triangles,
            effort,
        }
    }

    /// The case.
    #[must_use]
    pub fn case(&self) -> &'a Case {
        self.subject.case
    }

    /// The triangles that a float depth attachment keeps, texel by texel.
    #[must_use]
    pub fn float_triangles(&self) -> &[u32] {
        &self.float_triangles
    }

    /// Judges every `step`-th covered pixel in x and y, row by row from the bottom.
    #[must_use]
    pub fn observe_canvas(&self, step: u32) -> Vec<Observation> {
        self.observe_all(step).0
    }

    /// Judges one pixel; `None` where it is background.
    #[must_use]
    pub fn observe_pixel(&self, x: u32, y: u32) -> Option<Observation> {
        let (receiver, coord) = self.receiver(x, y)?;
        Some(self.observe([x, y], receiver, coord))
    }

    /// The receiver under a pixel centre and the map coordinates that the subject computes there;
    /// `None` where it is background.
    #[must_use]
    pub fn receiver(&self, x: u32, y: u32) -> Option<(Receiver, [f32; 3])> {
        let triangle = self.triangle_under(x, y)?;
        Some(Spot::new(self, triangle).receiver(self, x, y))
    }

    /// The triangle under a pixel centre.
    pub(super) fn triangle_under(&self, x: u32, y: u32) -> Option<u32> {
        let canvas = &self.subject.canvas;
        let triangle = canvas.triangle[y as usize * canvas.size[0] as usize + x as usize];
        (triangle != NO_TRIANGLE).then_some(triangle)
    }

    /// Exact window coordinates of a receiver, its truth, and whether it counts.
    #[must_use]
    pub fn witness(&self, receiver: &Receiver) -> (Option<DVec3>, Answer, Standing) {
        let window = self.case().light.window_from_world(&self.clip_from_world, receiver.position);
        let answer = self.tracer.truth(receiver, self.light_end(receiver.position));
        let standing = self.standing(receiver, window, &answer);
        (window, answer, standing)
    }

    /// Whether a receiver is certainly shadowed. `guess` is a triangle that may well block it, and
    /// becomes one that does.
    pub(super) fn is_shadowed(&self, receiver: &Receiver, guess: &mut u32) -> bool {
        let light_end = self.light_end(receiver.position);
        if let Some(blocker) = self.tracer.blocker(receiver, light_end, *guess) {
            *guess = blocker;
            return true;
        }
        matches!(self.tracer.truth(receiver, light_end).truth, Truth::Shadowed(_))
    }

    /// Whether a triangle certainly blocks a receiver with its inside.
    pub(super) fn is_blocked_by(&self, receiver: &Receiver, id: u32) -> bool {
        let light_end = self.light_end(receiver.position);
        id != receiver.triangle && self.tracer.hit_of(id, receiver.position, light_end).is_some()
    }

    /// Judges a receiver whose subject coordinates are given.
    #[must_use]
    pub fn observe(&self, pixel: [u32; 2], receiver: Receiver, coord: [f32; 3]) -> Observation {
        let (window, answer, standing) = self.witness(&receiver);
        let looking = Looking { pixel, receiver, coord };
        let window = window.unwrap_or(DVec3::splat(f64::NAN));
        self.judge(looking, window, answer, standing, || self.centre_depth(window))
    }

    /// Judges a receiver of known truth. `centre_depth` is asked where the receiver counts.
    pub(super) fn judge(
        &self,
        looking: Looking,
        exact: DVec3,
        answer: Answer,
        standing: Standing,
        centre_depth: impl FnOnce() -> f64,
    ) -> Observation {
        let Looking { pixel, receiver, coord } = looking;
        let case = self.case();
        let taps = self.taps(&case.lookup, coord);
        let lit_taps = shadow::visibility(&case.lookup, coord, &taps, case.bias);
        let rule = case.lookup.compare;
        let breakpoint = |&d: &f32| shadow::breakpoint(rule, coord[2], d);
        let mut observation = Observation {
            pixel,
            receiver,
            object: self.geometry.object[receiver.triangle as usize],
            coord,
            exact,
            standing,
            answer,
            breakpoints: taps.depths().iter().map(breakpoint).collect(),
            lit_share: lit_share(&taps, lit_taps, |d| rule.is_lit(coord[2], d, case.bias)),
            texel: taps.texels(taps.centre())[0],
            taps,
            lit_taps,
            stored: [f64::INFINITY; 5],
            wrong: [false; 5],
            outcome: Outcome::Agree,
            caster: StoredCaster::Own,
            own_surface: false,
        };
        if observation.standing == Standing::Counted {
            self.climb(&mut observation, centre_depth());
            self.name(&mut observation);
        }
        observation
    }

    /// The far end of a receiver's shadow ray.
    #[must_use]
    pub fn light_end(&self, p_world: DVec3) -> DVec3 {
        self.light.of(p_world)
    }

    /// Where the shadow rays of all receivers end.
    #[must_use]
    pub const fn light(&self) -> LightEnd {
        self.light
    }

    /// What a look-up reads at subject coordinates.
    #[must_use]
    pub fn taps(&self, lookup: &LookupSpec, coord: [f32; 3]) -> Taps {
        let [u, v, _] = coord;
        self.subject.map.taps(&self.subject.device, lookup.filter, lookup.wrap, u, v)
    }

    /// The normal of the side of a receiver that the camera sees, not normalised: what shading and *seen*
    /// go by. The geometric one.
    #[must_use]
    pub fn seen_normal(&self, receiver: &Receiver) -> DVec3 {
        let normal = self.geometry.area_normal(receiver.triangle);
        let to_camera = self.case().camera.view.position - receiver.position;
        if normal.dot(to_camera) < 0.0 { -normal } else { normal }
    }

    /// The unit vector from a receiver towards the light.
    fn to_light(&self, receiver: &Receiver) -> DVec3 {
        self.sun.unwrap_or_else(|| self.case().light.direction_from(receiver.position))
    }

    /// N·L of the side of a receiver that the camera sees; 0 where it has no normal.
    #[must_use]
    pub fn cosine(&self, receiver: &Receiver) -> f64 {
        let normal = self.seen_normal(receiver);
        let cosine = normal.dot(self.to_light(receiver)) / crate::view::length(normal);
        if cosine.is_finite() { cosine } else { 0.0 }
    }

    pub(super) fn standing(
        &self,
        receiver: &Receiver,
        window: Option<DVec3>,
        answer: &Answer,
    ) -> Standing {
        let case = self.case();
        let inside = |w: DVec3| w.min_element() >= 0.0 && w.max_element() <= 1.0;
        if self.seen_normal(receiver).dot(self.to_light(receiver)) <= 0.0 {
            Standing::FacingAway
        } else if !window.is_some_and(inside) {
            Standing::OutsideMap
        } else if !case.light.in_cone(receiver.position) {
            Standing::OutsideCone
        } else if answer.truth == Truth::Ambiguous {
            Standing::Ambiguous
        } else {
            Standing::Counted
        }
    }
}
