//! One receiver at a time: its truth, its look-up, the verdict on every rung, and what went wrong.

use super::adjacency::Adjacency;
use super::classify::{Outcome, StoredCaster};
use super::effort::Effort;
use super::ladder::Rung;
pub use super::observation::{Observation, Standing};
use crate::depth::DepthFormat;
use crate::device::Device;
use crate::light::{Lens, Lookup};
use crate::raster::Interpolator;
use crate::raster::NO_TRIANGLE;
use crate::raster::passes::{Subject, draw_map, map_depth_buffer};
use crate::scene::{Case, Geometry, LookupSpec};
use crate::shadow::{self, Few, ShadowMap, Taps};
use crate::truth::{Answer, LightEnd, Receiver, SeenFaces, Tracer, Truth};
use glam::{DVec2, DVec3};
use rayon::prelude::*;

/// Share of a receiver's visibility that `lit` taps have: 1 where the range test lights all of them.
fn lit_share(taps: &Taps, lit: usize, is_lit: impl Fn(usize) -> bool) -> f64 {
    if lit == taps.depths().len() { 1.0 } else { taps.visibility(is_lit) }
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
    /// The exact matrices of each map.
    pub lenses: Vec<Lens>,
    pub(super) adjacency: Adjacency,
    /// The corners, for each map, of every triangle in its texels (`None` behind the eye).
    pub(super) projected: Vec<Vec<Option<[DVec2; 3]>>>,
    /// The rasteriser's own depths under a float depth attachment.
    pub(super) unquantized: ShadowMap,
    /// Its triangles.
    float_triangles: Vec<u32>,
    /// Which sides of casters the light sees in the map.
    pub drawn: SeenFaces,
    /// Whether the map draws both sides of all casters.
    pub(super) draws_all: bool,
    /// Where shadow rays end.
    light: LightEnd,
    /// The unit vector towards a directional light.
    sun: Option<DVec3>,
    /// Unit normals of the vertices in the world ([`Case::vertex_normals`]).
    pub(super) vertex_normals: Option<Vec<DVec3>>,
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
    let map = ShadowMap::unquantized(&raster.layout, raster.drawn());
    let triangles = drawn.map_or_else(|| map_raster.triangle.clone(), |raster| raster.triangle);
    (map, triangles)
}

/// A pixel's receiver, its coordinates in each map in the subject, and what it looks up.
#[derive(Clone, Debug)]
pub(super) struct Looking {
    pub(super) pixel: [u32; 2],
    pub(super) receiver: Receiver,
    pub(super) coords: Few<[f32; 3]>,
    pub(super) lookups: Few<Lookup>,
}

impl Looking {
    /// The look-up with the largest share; the first of equals.
    pub(super) fn main(&self) -> &Lookup {
        let heavier = |a, b: &'_ Lookup| if b.weight > a { b.weight } else { a };
        let most = self.lookups.iter().fold(0.0, heavier);
        let found = self.lookups.iter().find(|l| l.weight >= most);
        found.expect("every choice takes a map")
    }
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

    /// The receiver at a pixel centre, and what it looks up in the subject.
    pub(super) fn looking(&self, observer: &Observer<'_>, x: u32, y: u32) -> Looking {
        let weights = self.interpolator.barycentrics(x, y);
        let [a, b, c] = self.corners;
        let position = a * weights.x + b * weights.y + c * weights.z;
        let coords = observer.subject.coordinates(&self.interpolator, x, y);
        observer.looking([x, y], Receiver { position, triangle: self.triangle }, coords)
    }
}

/// The corners of all triangles in a map's texels.
fn projected(lens: &Lens, geometry: &Geometry) -> Vec<Option<[DVec2; 3]>> {
    let texels = |p: DVec3| Some(lens.texels(lens.look(p)?.truncate()));
    let corners = |t: u32| {
        let [a, b, c] = geometry.corners(t).map(texels);
        Some([a?, b?, c?])
    };
    let ids = (0..geometry.triangles.len() as u32).into_par_iter().with_min_len(1024);
    ids.map(corners).collect()
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
        let lenses = subject.lenses();
        let (unquantized, float_triangles) = float_map(&subject, effort);
        let projected = lenses.iter().map(|lens| projected(lens, &geometry)).collect();
        let sun = case.light.is_directional().then(|| case.light.eye().backward());
        let drawn = SeenFaces::left_by(&geometry.surfaces.culls(case.map.cull));
        Self {
            projected,
            light: match sun {
                Some(sun) => LightEnd::Along(sun * tracer.reach()),
                None => LightEnd::Point(case.light.eye().position),
            },
            sun,
            tracer,
            adjacency,
            draws_all: drawn.is_everything(),
            drawn,
            subject,
            geometry,
            lenses,
            unquantized,
            float_triangles,
            vertex_normals: case.vertex_normals(),
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
        let triangle = self.triangle_under(x, y)?;
        Some(self.observed(Spot::new(self, triangle).looking(self, x, y)))
    }

    /// The receiver under a pixel centre and the coordinates that the subject computes there in each map;
    /// `None` where it is background.
    #[must_use]
    pub fn receiver(&self, x: u32, y: u32) -> Option<(Receiver, Few<[f32; 3]>)> {
        let triangle = self.triangle_under(x, y)?;
        let looking = Spot::new(self, triangle).looking(self, x, y);
        Some((looking.receiver, looking.coords))
    }

    /// A receiver with what its choice takes.
    pub(super) fn looking(
        &self,
        pixel: [u32; 2],
        receiver: Receiver,
        coords: Few<[f32; 3]>,
    ) -> Looking {
        let lookups = self.subject.lookups(receiver.position, &coords);
        Looking { pixel, receiver, coords, lookups }
    }

    /// The triangle under a pixel centre.
    pub(super) fn triangle_under(&self, x: u32, y: u32) -> Option<u32> {
        let canvas = &self.subject.canvas;
        let triangle = canvas.triangle[y as usize * canvas.size[0] as usize + x as usize];
        (triangle != NO_TRIANGLE).then_some(triangle)
    }

    /// A receiver that looks up its exact coordinates, rounded once; those behind a map's eye count as
    /// outside of it. `None` where it is behind all of them.
    pub(super) fn exactly(&self, pixel: [u32; 2], receiver: &Receiver) -> Option<Looking> {
        let exact = self.lenses.iter().map(|lens| lens.look(receiver.position));
        let exact: Few<Option<DVec3>> = exact.collect();
        exact.iter().any(Option::is_some).then(|| {
            let outside = DVec3::splat(f64::NEG_INFINITY);
            let coord = |e: &Option<DVec3>| e.unwrap_or(outside).as_vec3().to_array();
            self.looking(pixel, *receiver, exact.iter().map(coord).collect())
        })
    }

    /// The map with the largest share of what a receiver looks up; `None` behind all of them.
    pub(super) fn main_map(&self, receiver: &Receiver) -> Option<usize> {
        Some(self.exactly([0; 2], receiver)?.main().map)
    }

    /// Exact coordinates of a receiver in a map, its truth, and whether it counts.
    #[must_use]
    pub fn witness(&self, receiver: &Receiver, map: usize) -> (Option<DVec3>, Answer, Standing) {
        let exact = self.lenses[map].look(receiver.position);
        let answer = self.tracer.truth(receiver, self.light_end(receiver.position));
        let standing =
            self.standing(receiver, exact.filter(|&e| self.lenses[map].holds(e)), &answer);
        (exact, answer, standing)
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

    /// Judges a receiver whose subject coordinates in each map are given.
    #[must_use]
    pub fn observe(
        &self,
        pixel: [u32; 2],
        receiver: Receiver,
        coords: Few<[f32; 3]>,
    ) -> Observation {
        self.observed(self.looking(pixel, receiver, coords))
    }

    fn observed(&self, looking: Looking) -> Observation {
        let map = looking.main().map;
        let (exact, answer, standing) = self.witness(&looking.receiver, map);
        let exact = exact.unwrap_or(DVec3::splat(f64::NAN));
        self.judge(looking, exact, answer, standing, || self.centre_depth(map, exact))
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
        let Lookup { map, coord, .. } = *looking.main();
        let Looking { pixel, receiver, lookups, .. } = looking;
        let case = self.case();
        let taps = self.taps(&case.lookup, &lookups, pixel);
        let lit_taps = shadow::visibility(&case.lookup, &lookups, &taps, case.bias);
        let rule = case.lookup.compare;
        let breakpoint = |(i, &d): (usize, &f32)| shadow::breakpoint(rule, taps.z(i), d);
        let mut observation = Observation {
            pixel,
            receiver,
            object: self.geometry.object[receiver.triangle as usize],
            map,
            coord,
            exact,
            standing,
            answer,
            breakpoints: taps.depths().iter().enumerate().map(breakpoint).collect(),
            lit_share: lit_share(&taps, lit_taps, |i| taps.is_lit(rule, i, case.bias)),
            texel: taps.texels(taps.centre())[0],
            taps,
            lookups,
            lit_taps,
            stored: [f64::INFINITY; Rung::ALL.len()],
            wrong: [false; Rung::ALL.len()],
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

    /// What look-ups read.
    #[must_use]
    pub fn taps(&self, spec: &LookupSpec, lookups: &[Lookup], pixel: [u32; 2]) -> Taps {
        self.subject.map.taps(&self.subject.device, spec, lookups, pixel)
    }

    /// The geometric normal of the side of a receiver that the camera sees, not normalised: what standings go
    /// by.
    #[must_use]
    pub fn seen_normal(&self, receiver: &Receiver) -> DVec3 {
        let normal = self.geometry.area_normal(receiver.triangle);
        let to_camera = self.case().camera.towards(receiver.position);
        if normal.dot(to_camera) < 0.0 { -normal } else { normal }
    }

    /// The unit vector from a receiver towards the light.
    pub(super) fn to_light(&self, receiver: &Receiver) -> DVec3 {
        self.sun.unwrap_or_else(|| self.case().light.direction_from(receiver.position))
    }

    /// N·L of the side of a receiver that the camera sees, N the normal that shades; 0 where it has none.
    #[must_use]
    pub fn cosine(&self, receiver: &Receiver) -> f64 {
        if let Some(normals) = self.vertex_normals_at(receiver) {
            return normals.shading.dot(self.to_light(receiver));
        }
        let normal = self.seen_normal(receiver);
        let cosine = normal.dot(self.to_light(receiver)) / crate::view::length(normal);
        if cosine.is_finite() { cosine } else { 0.0 }
    }

    /// Whether a receiver counts; `inside` are its exact coordinates if they lie in its map's volume.
    pub(super) fn standing(
        &self,
        receiver: &Receiver,
        inside: Option<DVec3>,
        answer: &Answer,
    ) -> Standing {
        let case = self.case();
        let object = self.geometry.object[receiver.triangle as usize];
        if !self.geometry.surfaces.receives(object) {
            Standing::ReceivesNone
        } else if self.seen_normal(receiver).dot(self.to_light(receiver)) <= 0.0 {
            Standing::FacingAway
        } else if inside.is_none() {
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
