//! One receiver at a time: its truth, its look-up, the verdict on every rung, and what went wrong.

use super::adjacency::Adjacency;
use super::classify::{self, Fault, Outcome, StoredCaster};
use super::ladder::{self, Rung, Wrong};
use crate::depth::DepthFormat;
use crate::device::Device;
use crate::raster::NO_TRIANGLE;
use crate::raster::passes::{Subject, draw_map};
use crate::scene::{Case, Cull, Filter, Geometry, LookupSpec};
use crate::shadow::{self, ShadowMap, Taps};
use crate::truth::{Answer, Faces, FirstHit, Receiver, Tracer, Truth};
use glam::{DMat4, DVec2, DVec3};
use rayon::prelude::*;

crate::catalogue! {
    /// Whether a receiver counts in the rates, and if not, why.
    pub enum Standing {
        /// It counts.
        Counted = "counted",
        /// The truth cannot be decided in f64.
        Ambiguous = "ambiguous",
        /// The surface faces away from the light.
        FacingAway = "facing-away",
        /// Outside the spot's cone.
        OutsideCone = "outside-cone",
        /// Outside the map's volume.
        OutsideMap = "outside-map",
    }
}

/// Everything known about one receiver.
#[derive(Clone, Debug, PartialEq)]
pub struct Observation {
    /// Pixel of the canvas, from the bottom left.
    pub pixel: [u32; 2],
    /// Where it is, f64.
    pub receiver: Receiver,
    /// Object that it belongs to.
    pub object: u16,
    /// Map coordinates and depth as the subject computes them.
    pub coord: [f32; 3],
    /// The same, f64.
    pub exact: DVec3,
    /// Whether it counts.
    pub standing: Standing,
    /// What it truly sees.
    pub answer: Answer,
    /// What the look-up read.
    pub taps: Taps,
    /// Lit taps at the case's bias.
    pub lit_taps: usize,
    /// Their share of the visibility, in [0,1].
    pub lit_share: f64,
    /// Smallest bias that lights each tap.
    pub breakpoints: Vec<f32>,
    /// Stored depth on each rung; +∞ where nothing is in front.
    pub stored: [f64; 5],
    /// Whether each rung is wrong.
    pub wrong: Wrong,
    /// The verdict's fault, if it counts and is wrong.
    pub outcome: Outcome,
    /// Whose surface the deciding texel holds.
    pub caster: StoredCaster,
    /// The texel that decided.
    pub texel: u32,
    /// Whether every texel read holds the receiver's own or an adjacent surface.
    pub own_surface: bool,
}

impl Observation {
    /// Whether the truth is *lit*; `None` where it does not count.
    #[must_use]
    pub fn truly_lit(&self) -> Option<bool> {
        (self.standing == Standing::Counted).then_some(self.answer.truth == Truth::Lit)
    }

    /// Fractional visibility in [0,1].
    #[must_use]
    pub const fn visibility(&self) -> f64 {
        self.lit_share
    }
}

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
    world_from_clip: DMat4,
    adjacency: Adjacency,
    /// Window-space corners of every triangle in map texels (`None` behind the eye).
    projected: Vec<Option<[DVec2; 3]>>,
    /// The rasteriser's own depths under a float depth attachment.
    unquantized: ShadowMap,
    /// Its triangles.
    float_triangles: Vec<u32>,
    /// Which sides of casters the light sees in the map.
    drawn_faces: Faces,
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
        let triangle = self.subject.canvas.triangle[(y * self.subject.canvas.size[0] + x) as usize];
        if triangle == NO_TRIANGLE {
            return None;
        }
        let weights = self.subject.barycentrics(triangle, x, y);
        let [a, b, c] = self.geometry.corners(triangle);
        let position = a * weights.x + b * weights.y + c * weights.z;
        let coord = self.subject.coordinate(triangle, x, y);
        Some(self.observe([x, y], Receiver { position, triangle }, coord))
    }

    /// Judges a receiver whose subject coordinates are given.
    #[must_use]
    pub fn observe(&self, pixel: [u32; 2], receiver: Receiver, coord: [f32; 3]) -> Observation {
        let case = self.case();
        let window = case.light.window_from_world(&self.clip_from_world, receiver.position);
        let answer = self.tracer.truth(&receiver, self.light_end(receiver.position));
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
            standing: self.standing(&receiver, window, &answer),
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

    /// Fills in the stored depth and the verdict of every rung.
    fn climb(&self, o: &mut Observation) {
        let case = self.case();
        let device = &self.subject.device;
        let (rule, bias) = (case.lookup.compare, case.bias);
        let truly_lit = o.answer.truth == Truth::Lit;
        let z = o.exact.z;
        let exact_lit =
            |stored: f64| stored == f64::INFINITY || rule.is_lit_exact(z, stored, f64::from(bias));
        let bias_depth = self.occluder_depth(o);
        let centre_depth = self.centre_depth(o.exact);
        let [u, v, z32] = o.coord;
        let drawn_texel = self.unquantized.nearest(device, case.lookup.wrap, u, v) as usize;
        let drawn = self.unquantized.depth(device, drawn_texel);
        let stored_texel = self.subject.map.nearest(device, case.lookup.wrap, u, v) as usize;
        let stored = self.subject.map.depth(device, stored_texel);
        let filtered = o.taps.depths()[o.taps.centre()];
        o.stored =
            [bias_depth, centre_depth, f64::from(drawn), f64::from(stored), f64::from(filtered)];
        let taps = o.taps.depths().len();
        o.wrong = [
            exact_lit(bias_depth) != truly_lit,
            exact_lit(centre_depth) != truly_lit,
            rule.is_lit(z32, drawn, bias) != truly_lit,
            rule.is_lit(z32, stored, bias) != truly_lit,
            o.lit_taps != if truly_lit { taps } else { 0 },
        ];
    }

    /// Window depth of the first drawn occluder on the receiver's own ray; +∞ if there is none.
    fn occluder_depth(&self, o: &Observation) -> f64 {
        let end = self.light_end(o.receiver.position);
        let point = match (self.drawn_faces, &o.answer.truth) {
            (Faces::Both, Truth::Shadowed(occlusion)) => {
                let ray = end - o.receiver.position;
                o.receiver.position + ray * (occlusion.first_gap / crate::view::length(ray))
            }
            (Faces::Both, _) => return f64::INFINITY,
            (faces, _) => {
                let own = Some(o.receiver.triangle);
                match self.tracer.first_hit(end, o.receiver.position, faces, own) {
                    FirstHit::Hit { t, t_error, .. } if t + t_error < 1.0 => {
                        end + (o.receiver.position - end) * t
                    }
                    _ => return f64::INFINITY,
                }
            }
        };
        self.window_depth(point)
    }

    fn window_depth(&self, p_world: DVec3) -> f64 {
        let window = self.case().light.window_from_world(&self.clip_from_world, p_world);
        window.map_or(f64::INFINITY, |w| w.z)
    }

    /// Exact depth at the centre of the texel under exact map coordinates; +∞ where it is empty.
    fn centre_depth(&self, exact: DVec3) -> f64 {
        let size = f64::from(self.case().map.size);
        let centre = ((exact.truncate() * size).floor() + 0.5) / size;
        self.first_drawn(centre).map_or(f64::INFINITY, |(_, p)| self.window_depth(p))
    }

    /// The first drawn caster along the light's ray through map coordinates, and the point hit.
    /// A ray that only grazes a silhouette sees nothing there.
    #[must_use]
    pub fn first_drawn(&self, uv: DVec2) -> Option<(u32, DVec3)> {
        let [near, far] = self.light_ray(uv);
        match self.tracer.first_hit(near, far, self.drawn_faces, None) {
            FirstHit::Hit { triangle, t, .. } => Some((triangle, near + (far - near) * t)),
            FirstHit::None | FirstHit::Ambiguous => None,
        }
    }

    /// The first triangle of which `faces` are seen along the light's ray through map coordinates.
    #[must_use]
    pub fn first_along(&self, uv: DVec2, faces: Faces) -> FirstHit {
        let [near, far] = self.light_ray(uv);
        self.tracer.first_hit(near, far, faces, None)
    }

    /// Where the light's ray through map coordinates crosses the near and the far plane.
    fn light_ray(&self, uv: DVec2) -> [DVec3; 2] {
        let ndc = uv * 2.0 - 1.0;
        [-1.0, 1.0].map(|z| self.world_from_clip.project_point3(ndc.extend(z)))
    }

    /// Whose surface a texel holds, as seen by a receiver.
    fn stored_caster(&self, o: &Observation, texel: u32) -> StoredCaster {
        let caster = self.subject.map_raster.triangle[texel as usize];
        if caster == NO_TRIANGLE {
            return StoredCaster::Cleared;
        }
        let size = self.case().map.size;
        let centre = DVec2::new(f64::from(texel % size) + 0.5, f64::from(texel / size) + 0.5);
        let project = |t: u32| self.projected[t as usize];
        if self.adjacency.is_own(o.receiver.triangle, caster, centre, project) {
            return StoredCaster::Own;
        }
        let object = |t: u32| self.geometry.object[t as usize];
        match &o.answer.truth {
            Truth::Shadowed(occlusion)
                if [occlusion.first, occlusion.occluder].contains(&caster)
                    || [occlusion.first, occlusion.occluder]
                        .map(object)
                        .contains(&object(caster)) =>
            {
                StoredCaster::Occluder
            }
            _ => StoredCaster::Other,
        }
    }

    /// The tap and texel that decided, and the verdict's name.
    fn name(&self, o: &mut Observation) {
        let own = |t: &u32| self.stored_caster(o, *t) == StoredCaster::Own;
        o.own_surface = (0..o.taps.depths().len()).all(|i| o.taps.texels(i).iter().all(own));
        let truly_lit = o.answer.truth == Truth::Lit;
        o.texel = self.deciding_texel(o, truly_lit);
        o.caster = self.stored_caster(o, o.texel);
        let Some(cause) = ladder::cause(&o.wrong) else { return };
        let fault = |artifact| Fault { artifact, cause };
        o.outcome = if truly_lit {
            Outcome::FalseShadow(fault(classify::false_shadow(o.caster, self.is_sound(o.texel))))
        } else {
            let wrong_on_bias = o.wrong[Rung::Bias as usize];
            Outcome::FalseLight(fault(classify::false_light(o.caster, wrong_on_bias)))
        };
    }

    /// The centre tap's texel, or that of the first wrong tap where the centre is right. Where a mix
    /// of texels made a false shadow, the nearest of them to the light.
    fn deciding_texel(&self, o: &Observation, truly_lit: bool) -> u32 {
        let case = self.case();
        let is_wrong = |i: usize| {
            case.lookup.compare.is_lit(o.coord[2], o.taps.depths()[i], case.bias) != truly_lit
        };
        let centre = o.taps.centre();
        let tap = if is_wrong(centre) {
            centre
        } else {
            (0..o.taps.depths().len()).find(|&i| is_wrong(i)).unwrap_or(centre)
        };
        let texels = o.taps.texels(tap);
        if case.lookup.filter != Filter::Linear || !truly_lit || !is_wrong(tap) {
            return texels[0];
        }
        let depth = |t: &u32| self.subject.map.depth(&self.subject.device, *t as usize);
        texels.iter().copied().min_by(|a, b| depth(a).total_cmp(&depth(b))).unwrap_or(texels[0])
    }

    /// Whose surface a tap's own verdict rests on, and whether its texel is sound. Where a mix of
    /// texels makes a false shadow, the nearest of them to the light.
    #[must_use]
    pub fn tap_caster(&self, o: &Observation, tap: usize) -> (StoredCaster, bool) {
        let texels = o.taps.texels(tap);
        let depth = |t: &u32| self.subject.map.depth(&self.subject.device, *t as usize);
        let nearest = || texels.iter().copied().min_by(|a, b| depth(a).total_cmp(&depth(b)));
        let mixed = self.case().lookup.filter == Filter::Linear && o.truly_lit() == Some(true);
        let texel = if mixed { nearest().unwrap_or(texels[0]) } else { texels[0] };
        (self.stored_caster(o, texel), self.is_sound(texel))
    }

    /// Whether a texel decodes to the depth it was drawn with, up to two codes of one 8-bit channel:
    /// what even the coarsest sound store keeps.
    fn is_sound(&self, texel: u32) -> bool {
        let drawn = self.subject.map_raster.depth[texel as usize].clamp(0.0, 1.0);
        let read = self.subject.map.depth(&self.subject.device, texel as usize);
        (f64::from(read) - f64::from(drawn)).abs() <= 2.0 / 255.0
    }
}
