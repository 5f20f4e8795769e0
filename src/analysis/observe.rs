//! One receiver at a time: its truth, its look-up, the verdict on every rung, and what went wrong.

use super::adjacency::Adjacency;
use super::classify::{Outcome, StoredCaster};
pub use super::observation::{Observation, Standing};
use crate::depth::DepthFormat;
use crate::device::Device;
use crate::raster::NO_TRIANGLE;
use crate::raster::passes::{Subject, draw_map};
use crate::scene::{Case, Cull, Geometry, LookupSpec};
use crate::shadow::{self, ShadowMap, Taps};
use crate::truth::{Answer, Faces, Receiver, Tracer, Truth};
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
}

impl<'a> Observer<'a> {
    /// Draws the case on a device and prepares its truth.
    #[must_use]
    pub fn new(case: &'a Case, device: &Device) -> Self {
        let subject = Subject::draw(case, device);
        let geometry = case.geometry();
        let clip_from_world = case.light.clip_from_world();
        let float = draw_map(case, device, &subject.vertices, DepthFormat::F32);
        let covered = |i: usize| float.triangle[i] != NO_TRIANGLE;
        let size = case.map.size;
        let unquantized = ShadowMap::unquantized(size, &float.depth, f32::INFINITY, covered);
        let texels = |p: DVec3| {
            let window = case.light.window_from_world(&clip_from_world, p)?;
            Some(window.truncate() * f64::from(size))
        };
        let projected = (0..geometry.triangles.len() as u32)
            .map(|t| {
                let [a, b, c] = geometry.corners(t).map(texels);
                Some([a?, b?, c?])
            })
            .collect();
        Self {
            tracer: Tracer::new(&geometry),
            adjacency: Adjacency::new(&geometry),
            world_from_clip: clip_from_world.inverse(),
            drawn_faces: match case.map.cull {
                Cull::None => Faces::Both,
                Cull::Back => Faces::Front,
                Cull::Front => Faces::Back,
            },
            subject,
            geometry,
            clip_from_world,
            projected,
            unquantized,
            float_triangles: float.triangle,
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
        let [width, height] = self.subject.canvas.size;
        let row = |y: u32| {
            let pixel = move |x: u32| self.observe_pixel(x, y);
            (0..width).step_by(step as usize).filter_map(pixel).collect::<Vec<_>>()
        };
        let rows: Vec<u32> = (0..height).step_by(step as usize).collect();
        let observed: Vec<Vec<Observation>> = rows.into_par_iter().map(row).collect();
        observed.into_iter().flatten().collect()
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
        let triangle = self.subject.canvas.triangle[(y * self.subject.canvas.size[0] + x) as usize];
        if triangle == NO_TRIANGLE {
            return None;
        }
        let weights = self.subject.barycentrics(triangle, x, y);
        let [a, b, c] = self.geometry.corners(triangle);
        let position = a * weights.x + b * weights.y + c * weights.z;
        Some((Receiver { position, triangle }, self.subject.coordinate(triangle, x, y)))
    }

    /// Exact window coordinates of a receiver, its truth, and whether it counts.
    #[must_use]
    pub fn witness(&self, receiver: &Receiver) -> (Option<DVec3>, Answer, Standing) {
        let window = self.case().light.window_from_world(&self.clip_from_world, receiver.position);
        let answer = self.tracer.truth(receiver, self.light_end(receiver.position));
        let standing = self.standing(receiver, window, &answer);
        (window, answer, standing)
    }

    /// Judges a receiver whose subject coordinates are given.
    #[must_use]
    pub fn observe(&self, pixel: [u32; 2], receiver: Receiver, coord: [f32; 3]) -> Observation {
        let case = self.case();
        let (window, answer, standing) = self.witness(&receiver);
        let taps = self.taps(&case.lookup, coord);
        let lit_taps = shadow::visibility(&case.lookup, coord, &taps, case.bias);
        let rule = case.lookup.compare;
        let breakpoint = |&d: &f32| shadow::breakpoint(rule, coord[2], d);
        let exact = window.unwrap_or(DVec3::splat(f64::NAN));
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
            self.climb(&mut observation);
            self.name(&mut observation);
        }
        observation
    }

    /// The far end of a receiver's shadow ray.
    #[must_use]
    pub fn light_end(&self, p_world: DVec3) -> DVec3 {
        let light = &self.case().light;
        if light.is_directional() {
            p_world + light.view.backward() * self.tracer.reach()
        } else {
            light.view.position
        }
    }

    /// What a look-up reads at subject coordinates.
    #[must_use]
    pub fn taps(&self, lookup: &LookupSpec, coord: [f32; 3]) -> Taps {
        let [u, v, _] = coord;
        self.subject.map.taps(&self.subject.device, lookup.filter, lookup.wrap, u, v)
    }

    fn standing(&self, receiver: &Receiver, window: Option<DVec3>, answer: &Answer) -> Standing {
        let case = self.case();
        let inside = |w: DVec3| w.min_element() >= 0.0 && w.max_element() <= 1.0;
        let normal = self.geometry.area_normal(receiver.triangle);
        let to_camera = case.camera.view.position - receiver.position;
        let towards_camera = if normal.dot(to_camera) < 0.0 { -normal } else { normal };
        let to_light = case.light.direction_from(receiver.position);
        if towards_camera.dot(to_light) <= 0.0 {
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
