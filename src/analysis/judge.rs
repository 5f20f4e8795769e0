//! A counted receiver on the ladder: depths and verdicts of every rung, and the name of what is wrong.

use super::classify::{Fault, Outcome, StoredCaster};
use super::ladder::{self, Rung};
use super::observation::Observation;
use super::observe::Observer;
use super::verdict::counted::Counted;
use super::verdict::{self, Held, LookUp, SHARE, Verdict};
use crate::light::{Lens, Lookup, Rect};
use crate::raster::NO_TRIANGLE;
use crate::raster::passes::Subject;
use crate::scene::Filter;
use crate::shadow::in_square;
use crate::truth::{Answer, Faces, FirstHit, Receiver, Truth};
use glam::{DVec2, DVec3};
use rayon::prelude::*;

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
        let bias_depth = self.occluder_depth(o.map, &o.receiver, &o.answer);
        let culled = !truly_lit && self.is_culled(bias_depth);
        let (lookup, z32) = (Lookup { map: o.map, coord: o.coord, weight: 1.0 }, o.coord[2]);
        let drawn_texel = self.unquantized.nearest(device, case.lookup.wrap, &lookup) as usize;
        let drawn = self.unquantized.depth(device, drawn_texel);
        let stored_texel = self.subject.map.nearest(device, case.lookup.wrap, &lookup) as usize;
        let stored = self.subject.map.depth(device, stored_texel);
        let filtered = o.taps.depths()[o.taps.centre()];
        o.stored =
            [bias_depth, bias_depth, centre_depth, drawn.into(), stored.into(), filtered.into()];
        let taps = o.taps.depths().len();
        o.wrong = [
            culled,
            exact_lit(bias_depth) != truly_lit,
            exact_lit(centre_depth) != truly_lit,
            rule.is_lit(z32, drawn, bias) != truly_lit,
            rule.is_lit(z32, stored, bias) != truly_lit,
            o.lit_taps != if truly_lit { taps } else { 0 },
        ];
    }

    /// Whether culling leaves out all faces that occlude a truly shadowed receiver whose first drawn
    /// occluder has this depth or gap, +∞ where it has none.
    pub(super) fn is_culled(&self, first_drawn: f64) -> bool {
        !self.draws_all && first_drawn == f64::INFINITY
    }

    /// Depth in a map of the first drawn occluder on the receiver's own ray; +∞ if there is none.
    #[must_use]
    pub fn occluder_depth(&self, map: usize, receiver: &Receiver, answer: &Answer) -> f64 {
        let end = self.light_end(receiver.position);
        let point = match (self.draws_all, &answer.truth) {
            (true, Truth::Shadowed(occlusion)) => {
                let ray = end - receiver.position;
                receiver.position + ray * (occlusion.first_gap / crate::view::length(ray))
            }
            (true, _) => return f64::INFINITY,
            (false, _) => {
                let own = Some(receiver.triangle);
                match self.tracer.first_of(end, receiver.position, &self.drawn, own) {
                    FirstHit::Hit { t, t_error, .. } if t + t_error < 1.0 => {
                        end + (receiver.position - end) * t
                    }
                    FirstHit::None | FirstHit::Hit { .. } | FirstHit::Ambiguous => {
                        return f64::INFINITY;
                    }
                }
            }
        };
        depth_in(&self.lenses[map], point)
    }

    /// Exact depth at the centre of the texel under exact map coordinates; +∞ where it is empty.
    pub(super) fn centre_depth(&self, map: usize, exact: DVec3) -> f64 {
        let lens = &self.lenses[map];
        self.depth_at(lens, texel_centre(lens, exact.truncate()))
    }

    /// Exact depth of the first drawn caster at map coordinates; +∞ where there is none.
    pub(super) fn depth_at(&self, lens: &Lens, uv: DVec2) -> f64 {
        self.first_drawn(lens, uv).map_or(f64::INFINITY, |(_, p)| depth_in(lens, p))
    }

    /// Judges where `triangle` is known to be the first.
    pub(super) fn depth_of(&self, lens: &Lens, triangle: u32, uv: DVec2) -> f64 {
        let [near, far] = lens.ray(uv);
        match self.tracer.hit_of(triangle, near, far) {
            Some(t) => depth_in(lens, near + (far - near) * t),
            None => self.depth_at(lens, uv),
        }
    }

    /// The first drawn caster along the light's ray through map coordinates, and the point hit.
    /// A ray that only grazes a silhouette sees nothing there.
    #[must_use]
    pub fn first_drawn(&self, lens: &Lens, uv: DVec2) -> Option<(u32, DVec3)> {
        let [near, far] = lens.ray(uv);
        match self.tracer.first_of(near, far, &self.drawn, None) {
            FirstHit::Hit { triangle, t, .. } => Some((triangle, near + (far - near) * t)),
            FirstHit::None | FirstHit::Ambiguous => None,
        }
    }

    /// The first triangle of which `faces` are seen along the light's ray through map coordinates.
    #[must_use]
    pub fn first_along(&self, lens: &Lens, uv: DVec2, faces: Faces) -> FirstHit {
        let [near, far] = lens.ray(uv);
        self.tracer.first_hit(near, far, faces, None)
    }

    /// The owner of the surface that a texel read by a tap holds, as seen by a receiver.
    pub(super) fn stored_caster(&self, o: &Observation, tap: usize, texel: u32) -> StoredCaster {
        if o.wrong[Rung::Culling as usize] {
            return StoredCaster::Culled;
        }
        let caster = self.subject.map_raster.triangle[texel as usize];
        let map = o.taps.map(tap);
        let rect = self.subject.map_raster.layout.rect(map);
        self.caster_of(o.receiver.triangle, &o.answer.truth, caster, texel, (map, rect))
    }

    /// The relation of the triangle `caster` to a receiver on triangle `own`, stored in `texel` of a
    /// map drawn into a rectangle.
    #[must_use]
    pub fn caster_of(
        &self,
        own: u32,
        truth: &Truth,
        caster: u32,
        texel: u32,
        (map, rect): (usize, &Rect),
    ) -> StoredCaster {
        if caster == NO_TRIANGLE {
            return StoredCaster::Cleared;
        }
        let side = |size: [u32; 2]| DVec2::from_array(size.map(f64::from));
        let scale = side(rect.size) / side(self.lenses[map].size);
        let centre = DVec2::from_array(rect.place(texel).map(|c| c as f64 + 0.5));
        let project =
            |t: u32| self.projected[map][t as usize].map(|p| p.map(|corner| corner * scale));
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
            Truth::Lit | Truth::Shadowed(_) | Truth::Ambiguous => StoredCaster::Other,
        }
    }

    /// The tap and texel that decided, and the verdict's name.
    pub(super) fn name(&self, o: &mut Observation) {
        let truly_lit = o.answer.truth == Truth::Lit;
        let seen = Seen { observer: self, o, truly_lit };
        let found = verdict::verdict(&seen, truly_lit);
        // Where nothing is wrong, NEAREST's texel speaks for the look-up.
        let (part, texel) = match found {
            Some(Verdict { part: Some(part), .. }) => (part, seen.texel(part)),
            Some(Verdict { part: None, .. }) | None => {
                (o.taps.centre(), o.taps.texels(o.taps.centre())[0])
            }
        };
        let caster = self.stored_caster(o, part, texel);
        let own = |tap: usize, t: u32| match (tap, t) == (part, texel) {
            true => caster == StoredCaster::Own,
            false => self.stored_caster(o, tap, t) == StoredCaster::Own,
        };
        let own_surface =
            (0..o.taps.depths().len()).all(|i| o.taps.texels(i).iter().all(|&t| own(i, t)));
        (o.texel, o.caster, o.own_surface) = (texel, caster, own_surface);
        if let (Some(Verdict { kind, .. }), Some(cause)) = (found, ladder::cause(&o.wrong)) {
            o.outcome = Outcome::Wrong(Fault { kind, cause });
        }
    }

    /// The owner of the surface that a tap's own verdict rests on, and whether its texel is sound.
    #[must_use]
    pub fn tap_caster(&self, o: &Observation, tap: usize) -> (StoredCaster, bool) {
        let seen = Seen { observer: self, o, truly_lit: o.truly_lit() == Some(true) };
        (seen.caster(tap), seen.is_sound(tap))
    }

    /// The receivers that count by *wrong*, *mean* and *seen*.
    #[must_use]
    pub fn counted_by_measure(&self, observations: &[Observation]) -> Counted {
        let chunk = |observations: &[Observation]| {
            let mut counted = Counted::default();
            for o in observations {
                if let Some(truly_lit) = o.truly_lit() {
                    let seen = Seen { observer: self, o, truly_lit };
                    counted.add(&seen, truly_lit, self.cosine(&o.receiver));
                }
            }
            counted
        };
        let chunks = observations.par_chunks(1 << 14).map(chunk);
        chunks.reduce(Counted::default, |a, b| a.joined(&b))
    }
}

/// What an observed receiver read, at the case's bias.
struct Seen<'s> {
    observer: &'s Observer<'s>,
    o: &'s Observation,
    truly_lit: bool,
}

impl Seen<'_> {
    /// The texel whose surface a tap rests on.
    fn texel(&self, tap: usize) -> u32 {
        let texels = self.o.taps.texels(tap);
        if self.observer.case().lookup.filter != Filter::Linear {
            return texels[0];
        }
        let Subject { device, map, .. } = &self.observer.subject;
        let depth = |i: usize| map.depth(device, texels[i] as usize);
        texels[verdict::deciding_in_a_mix(self.truly_lit, texels.len(), depth)]
    }
}

impl Held for Seen<'_> {
    fn caster(&self, tap: usize) -> StoredCaster {
        self.observer.stored_caster(self.o, tap, self.texel(tap))
    }

    fn is_sound(&self, tap: usize) -> bool {
        let Subject { device, map, map_raster, .. } = &self.observer.subject;
        let texel = self.texel(tap) as usize;
        let drawn = map_raster.triangle[texel] != NO_TRIANGLE;
        verdict::is_sound(drawn.then(|| map_raster.depth[texel]), map.window_depth(device, texel))
    }

    fn share(&self, tap: usize) -> i64 {
        let all = self.parts() as f64;
        (self.o.taps.weights().map_or(1.0 / all, |weights| weights[tap]) * SHARE) as i64
    }
}

impl LookUp for Seen<'_> {
    fn parts(&self) -> usize {
        let tested = self.observer.case().lookup.range_test;
        match &*self.o.lookups {
            [only] if tested && !in_square(only.coord) => 0,
            _ => self.o.taps.depths().len(),
        }
    }

    fn centre(&self) -> usize {
        self.o.taps.centre()
    }

    fn visibility(&self, tap: usize) -> f64 {
        let (case, o) = (self.observer.case(), self.o);
        let lit = o.taps.is_lit(case.lookup.compare, tap, case.bias);
        if lit { 1.0 } else { 0.0 }
    }

    fn is_hidden(&self, _: usize) -> bool {
        self.o.wrong[Rung::Bias as usize]
    }
}

/// Exact depth of a point in a map; +∞ behind its eye.
fn depth_in(lens: &Lens, p_world: DVec3) -> f64 {
    lens.look(p_world).map_or(f64::INFINITY, |look| look.z)
}

/// Map coordinates of the centre of the texel under exact map coordinates.
fn texel_centre(lens: &Lens, uv: DVec2) -> DVec2 {
    (lens.texels(uv).floor() + 0.5) / lens.texels(DVec2::ONE)
}
