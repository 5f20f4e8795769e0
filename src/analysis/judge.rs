//! A counted receiver on the ladder: depths and verdicts of every rung, and the name of what is wrong.

use super::classify::{self, Fault, Outcome, StoredCaster};
use super::ladder::{self, Rung};
use super::observation::Observation;
use super::observe::Observer;
use crate::raster::NO_TRIANGLE;
use crate::scene::Filter;
use crate::truth::{Answer, Faces, FirstHit, Receiver, Truth};
use glam::{DVec2, DVec3};

impl Observer<'_> {
    /// Fills in the stored depth and the verdict of every rung; `centre_depth` is the exact depth at
    /// the centre of the texel under its exact coordinates.
    pub(super) fn climb(&self, o: &mut Observation, centre_depth: f64) {
        let case = self.case();
        let device = &self.subject.device;
        let (rule, bias) = (case.lookup.compare, case.bias);
        let truly_lit = o.answer.truth == Truth::Lit;
        let z = o.exact.z;
        let exact_lit =
            |stored: f64| stored == f64::INFINITY || rule.is_lit_exact(z, stored, f64::from(bias));
        let bias_depth = self.occluder_depth(&o.receiver, &o.answer);
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
    #[must_use]
    pub fn occluder_depth(&self, receiver: &Receiver, answer: &Answer) -> f64 {
        let end = self.light_end(receiver.position);
        let point = match (self.drawn_faces, &answer.truth) {
            (Faces::Both, Truth::Shadowed(occlusion)) => {
                let ray = end - receiver.position;
                receiver.position + ray * (occlusion.first_gap / crate::view::length(ray))
            }
            (Faces::Both, _) => return f64::INFINITY,
            (faces, _) => {
                let own = Some(receiver.triangle);
                match self.tracer.first_hit(end, receiver.position, faces, own) {
                    FirstHit::Hit { t, t_error, .. } if t + t_error < 1.0 => {
                        end + (receiver.position - end) * t
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
    pub(super) fn centre_depth(&self, exact: DVec3) -> f64 {
        self.depth_at(self.texel_centre(exact))
    }

    /// Map coordinates of the centre of the texel under exact map coordinates.
    pub(super) fn texel_centre(&self, exact: DVec3) -> DVec2 {
        let size = f64::from(self.case().map.size);
        ((exact.truncate() * size).floor() + 0.5) / size
    }

    /// Exact depth of the first drawn caster at map coordinates; +∞ where there is none.
    pub(super) fn depth_at(&self, uv: DVec2) -> f64 {
        self.first_drawn(uv).map_or(f64::INFINITY, |(_, p)| self.window_depth(p))
    }

    /// The same where `triangle` is known to be the first.
    pub(super) fn depth_of(&self, triangle: u32, uv: DVec2) -> f64 {
        let [near, far] = self.light_ray(uv);
        match self.tracer.hit_of(triangle, near, far) {
            Some(t) => self.window_depth(near + (far - near) * t),
            None => self.depth_at(uv),
        }
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
    pub(super) fn light_ray(&self, uv: DVec2) -> [DVec3; 2] {
        let ndc = uv * 2.0 - 1.0;
        [-1.0, 1.0].map(|z| self.world_from_clip.project_point3(ndc.extend(z)))
    }

    /// Whose surface a texel holds, as seen by a receiver.
    pub(super) fn stored_caster(&self, o: &Observation, texel: u32) -> StoredCaster {
        let caster = self.subject.map_raster.triangle[texel as usize];
        self.caster_of(o.receiver.triangle, &o.answer.truth, caster, texel, self.case().map.size)
    }

    /// Whose surface the triangle `caster` is to a receiver on triangle `own`, stored in `texel` of a
    /// map of `size`² texels.
    #[must_use]
    pub fn caster_of(
        &self,
        own: u32,
        truth: &Truth,
        caster: u32,
        texel: u32,
        size: u32,
    ) -> StoredCaster {
        if caster == NO_TRIANGLE {
            return StoredCaster::Cleared;
        }
        let scale = f64::from(size) / f64::from(self.case().map.size);
        let centre = DVec2::new(f64::from(texel % size) + 0.5, f64::from(texel / size) + 0.5);
        let project = |t: u32| self.projected[t as usize].map(|p| p.map(|corner| corner * scale));
        if self.adjacency.is_own(own, caster, centre, project) {
            return StoredCaster::Own;
        }
        let object = |t: u32| self.geometry.object[t as usize];
        match truth {
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
    pub(super) fn name(&self, o: &mut Observation) {
        let truly_lit = o.answer.truth == Truth::Lit;
        o.texel = self.deciding_texel(o, truly_lit);
        o.caster = self.stored_caster(o, o.texel);
        let own = |t: &u32| match *t == o.texel {
            true => o.caster == StoredCaster::Own,
            false => self.stored_caster(o, *t) == StoredCaster::Own,
        };
        o.own_surface = (0..o.taps.depths().len()).all(|i| o.taps.texels(i).iter().all(own));
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
    pub(super) fn deciding_texel(&self, o: &Observation, truly_lit: bool) -> u32 {
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
    pub(super) fn is_sound(&self, texel: u32) -> bool {
        let drawn = self.subject.map_raster.depth[texel as usize].clamp(0.0, 1.0);
        let read = self.subject.map.depth(&self.subject.device, texel as usize);
        (f64::from(read) - f64::from(drawn)).abs() <= 2.0 / 255.0
    }
}
