//! The receivers of a case with their truth: found once, looked up under every map, format and bias.

use super::moves::Moves;
use super::receivers::Receivers;
pub use super::receivers::Sample;
use crate::analysis::classify::StoredCaster;
use crate::analysis::effort::Effort;
use crate::analysis::foot::Way;
use crate::analysis::observe::{Looking, Observer, Standing};
use crate::analysis::outside::OutsideCounts;
use crate::light::{Layout, Lens, Lookup};
use crate::raster::passes::Subject;
use crate::scene::{Case, TexelFormat};
use crate::shadow::Few;
use crate::shadow::bias::{Recipe, Site};
use crate::truth::{Answer, Receiver, Truth};
use crate::view::length;
use crate::{Error, Result};
use glam::DVec3;
use rayon::prelude::*;
use std::sync::Arc;

/// All counted receivers of a case.
#[derive(Debug)]
pub struct Field<'a> {
    /// The drawn case and its truth.
    pub observer: Arc<Observer<'a>>,
    /// Row by row from the bottom.
    pub samples: Vec<Sample>,
    pub(super) receivers: Receivers,
    /// Truly lit and truly shadowed.
    pub populations: [u64; 2],
    /// Where receivers look under each move that was asked for, for all maps and formats.
    pub(super) moves: Moves,
    /// What lies outside the light's volume.
    outside: OutsideCounts,
}

impl<'a> Field<'a> {
    /// The counted receivers at every `step`-th pixel of a case on its own device.
    #[must_use]
    pub fn new(case: &'a Case, step: u32) -> Self {
        Self::with(case, step, Effort::default())
    }

    /// A field over a case of a guest's own, which is checked.
    ///
    /// # Errors
    /// [`Error::BadInput`] for a step of 0 and where [`Case::check`] finds a fault.
    pub fn checked(case: &'a Case, step: u32) -> Result<Self> {
        if step == 0 {
            return Err(Error::bad_input("step", "0 is no step", "give 1 for every pixel"));
        }
        case.check()?;
        Ok(Self::new(case, step))
    }

    /// A field worked out by a given effort; so are the sweeps over them.
    #[must_use]
    pub fn with(case: &'a Case, step: u32, effort: Effort) -> Self {
        Self::over(Arc::new(Observer::with(case, &case.device.device(), effort)), step)
    }

    /// The counted receivers at every `step`-th pixel of a case that is drawn already.
    #[must_use]
    pub fn over(observer: Arc<Observer<'a>>, step: u32) -> Self {
        let sample = |(looking, exact, answer)| judged(&observer, looking, exact, answer);
        let (counted, outside) = observer.counted(step);
        let samples = counted.into_par_iter().map(sample).collect();
        Self { outside, ..Self::of(observer, samples) }
    }

    /// The first lines of every answer about the case: what was left out of its scene, what lies outside
    /// the light's volume, which casters are cut off; each a sentence.
    #[must_use]
    pub fn first_lines(&self) -> Vec<String> {
        self.outside.first_lines(&self.observer, !self.samples.is_empty())
    }

    /// Given receivers instead of a camera's: coordinates are the exact ones, rounded once.
    #[must_use]
    pub fn at(case: &'a Case, receivers: &[Receiver]) -> Self {
        let observer = Observer::new(case, &case.device.device());
        let of = |(i, receiver): (usize, &Receiver)| {
            let looking = observer.exactly([i as u32, 0], receiver)?;
            let (exact, answer, standing) = observer.witness(receiver, looking.main().map);
            let exact = exact.filter(|_| standing == Standing::Counted)?;
            Some(judged(&observer, looking, exact, answer))
        };
        let samples = receivers.par_iter().enumerate().filter_map(of).collect();
        Self::of(Arc::new(observer), samples)
    }

    fn of(observer: Arc<Observer<'a>>, samples: Vec<Sample>) -> Self {
        let lit = samples.iter().filter(|s| s.lit).count() as u64;
        let populations = [lit, samples.len() as u64 - lit];
        let receivers = Receivers::of(&samples);
        let (moves, outside) = (Moves::default(), OutsideCounts::default());
        Self { populations, observer, samples, receivers, moves, outside }
    }

    /// These receivers, each looking from where a recipe moves it under maps that lie as `layout` says;
    /// those that would land behind the light stay.
    #[must_use]
    pub fn looking_from(&self, recipe: &Recipe, layout: &Layout) -> Self {
        let of = |sample: &Sample| {
            let offset = recipe.receiver_offset(&self.site(sample, layout));
            let coord = self.moved(sample, offset).unwrap_or(sample.coord);
            let lookups = match self.chooses() {
                true => self.lookups_from(sample, offset),
                false => Few::One(Lookup::only(coord)),
            };
            Sample { coord, lookups, ..sample.clone() }
        };
        let samples = self.samples.iter().map(of).collect();
        Self::of(self.observer.clone(), samples)
    }

    /// The subject's own coordinates of a receiver plus the change of the exact ones, one rounding each;
    /// `None` behind the light.
    pub(super) fn moved(&self, sample: &Sample, offset: DVec3) -> Option<[f32; 3]> {
        let look = self.observer.lenses[sample.map].look(sample.receiver.position + offset)?;
        let change = (look - sample.exact).as_vec3().to_array();
        Some(std::array::from_fn(|i| sample.coord[i] + change[i]))
    }

    /// Whether receivers choose among several maps: then every comparison is made literally.
    pub(super) fn chooses(&self) -> bool {
        self.observer.lenses.len() > 1
    }

    /// A receiver as another of its maps sees it; the depths of one behind that map's eye are infinite.
    pub(super) fn in_map(&self, sample: &Sample, map: usize) -> Sample {
        let lens = &self.observer.lenses[map];
        let position = sample.receiver.position;
        let exact = lens.look(position).unwrap_or(DVec3::splat(f64::NEG_INFINITY));
        let occluder = || self.observer.occluder_depth(map, &sample.receiver, &sample.answer);
        let gap = if sample.lit { f64::INFINITY } else { exact.z - occluder() };
        Sample {
            map,
            coord: sample.coords[map],
            exact,
            gap: if gap.is_finite() { gap } else { f64::INFINITY },
            gradient: lens.gradient(sample.normal, position),
            ..sample.clone()
        }
    }

    /// What a receiver looks up after a move: in each map the subject's own coordinates plus the change of
    /// the exact ones, one rounding each, and the choice among them; nothing behind all maps.
    pub(super) fn lookups_from(&self, sample: &Sample, offset: DVec3) -> Few<Lookup> {
        let from = sample.receiver.position;
        let behind = [f32::NEG_INFINITY; 3];
        let moved = |(lens, coord): (&Lens, &[f32; 3])| {
            let Some((there, here)) = lens.look(from + offset).zip(lens.look(from)) else {
                return behind;
            };
            let change = (there - here).as_vec3().to_array();
            std::array::from_fn(|i| coord[i] + change[i])
        };
        let coords: Few<[f32; 3]> =
            self.observer.lenses.iter().zip(&*sample.coords).map(moved).collect();
        if coords.iter().all(|coord| *coord == behind) {
            return Few::default();
        }
        self.observer.subject.lookups(from + offset, &coords)
    }

    /// Whether what no result depends on is left out.
    pub(super) fn skips(&self) -> bool {
        self.observer.effort.skip
    }

    /// The case.
    #[must_use]
    pub fn case(&self) -> &'a Case {
        self.observer.case()
    }

    /// What a bias may know of a receiver under maps that lie as `layout` says.
    #[must_use]
    pub fn site(&self, sample: &Sample, layout: &Layout) -> Site {
        let position = sample.receiver.position;
        let map = &self.observer.lenses[sample.map].map;
        let (z, map_size) = (map.axial_distance(position), layout.rect(sample.map).size);
        Site {
            position,
            normal: sample.normal,
            normals: self.observer.vertex_normals_at(&sample.receiver),
            to_light: self.case().light.direction_from(position),
            texel_world: map.texel_world(map_size[0], z),
            window_per_world: map.depth_per_world(z),
            gradient: sample.gradient,
            map_size,
            w: if map.is_orthographic() { 1.0 } else { z },
        }
    }

    /// The receiver in the middle of the list: where units are converted. `None` where there is none.
    #[must_use]
    pub fn middle(&self) -> Option<&Sample> {
        self.samples.get(self.samples.len() / 2)
    }

    /// What a polygon offset multiplies on the receiver's own triangle in its map of a format: slope m and
    /// unit r, window depth, as the sweeps draw it.
    #[must_use]
    pub fn offset_terms(&self, sample: &Sample, layout: &Layout, format: TexelFormat) -> [f32; 2] {
        let Subject { device, .. } = &self.observer.subject;
        let setup = self.observer.subject.map_setup(sample.receiver.triangle, sample.map, layout);
        let attachment = self.case().map.with(layout.side(), format).attachment();
        [setup.max_slope(device), setup.resolvable(device, attachment)]
    }

    /// The smallest positive unit r among the triangles that receivers lie on; 2⁻²⁴ where there is none.
    #[must_use]
    pub fn smallest_resolvable(&self, size: u32, format: TexelFormat) -> f64 {
        let attachment = self.case().map.with(size, format).attachment();
        let subject = &self.observer.subject;
        let layout = self.case().light.layout(size);
        let unit = |(t, map): (u32, usize)| {
            subject.map_setup(t, map, &layout).resolvable(&subject.device, attachment)
        };
        let seen = self.samples.iter().map(|s| (s.receiver.triangle, s.map));
        let mut triangles: Vec<(u32, usize)> = seen.collect();
        triangles.sort_unstable();
        triangles.dedup();
        let least = triangles.into_iter().map(unit).filter(|&r| r > 0.0).fold(f32::MAX, f32::min);
        if least < f32::MAX { least.into() } else { crate::num::exp2(-24) }
    }

    /// The relation of a stored triangle to a receiver.
    #[must_use]
    pub fn caster(
        &self,
        sample: &Sample,
        caster: u32,
        texel: u32,
        layout: &Layout,
    ) -> StoredCaster {
        if !sample.lit && self.observer.is_culled(sample.gap) {
            return StoredCaster::Culled;
        }
        let (own, place) = (sample.receiver.triangle, (sample.map, layout.rect(sample.map)));
        self.observer.caster_of(own, &sample.answer.truth, caster, texel, place)
    }

    /// Whether a receiver would be lit were it moved: what the bias alone does to its shadow.
    #[must_use]
    pub fn is_lit_from(&self, sample: &Sample, offset: DVec3) -> bool {
        let position = sample.receiver.position + offset;
        let moved = Receiver { position, triangle: sample.receiver.triangle };
        let light_end = self.observer.light_end(position);
        let tracer = &self.observer.tracer;
        let guess = match sample.answer.truth {
            Truth::Shadowed(by) => by.occluder,
            Truth::Lit | Truth::Ambiguous => sample.receiver.triangle,
        };
        tracer.blocker(&moved, light_end, guess).is_none()
            && tracer.truth(&moved, light_end).truth == Truth::Lit
    }
}

/// A receiver that counts, of known truth.
fn judged(observer: &Observer<'_>, looking: Looking, exact: DVec3, answer: Answer) -> Sample {
    let Lookup { map, coord, .. } = *looking.main();
    let Looking { pixel, receiver, coords, lookups } = looking;
    let lit = answer.truth == Truth::Lit;
    let case = observer.case();
    let area_normal = observer.geometry.area_normal(receiver.triangle);
    let normal = area_normal / length(area_normal);
    let normal = normal
        * if normal.dot(case.light.direction_from(receiver.position)) < 0.0 { -1.0 } else { 1.0 };
    let gap = if lit {
        f64::INFINITY
    } else {
        exact.z - observer.occluder_depth(map, &receiver, &answer)
    };
    let mut sample = Sample {
        pixel,
        receiver,
        coords,
        lookups,
        map,
        coord,
        exact,
        lit,
        gap: if gap.is_finite() { gap } else { f64::INFINITY },
        answer,
        inside: 0.0,
        normal,
        gradient: observer.lenses[map].gradient(normal, receiver.position),
    };
    if !lit {
        sample.inside = inside(observer, &sample);
    }
    sample
}

/// Steps of the walk out of the shadow, in texels of the case's own map, and how many at most.
const STEP: f64 = 2.0;
const STEPS: u32 = 256;

/// Way along the surface towards the light until the truth is lit or something stands on the surface; up to
/// [`STEPS`] steps, refined to 2⁻¹² of a step.
fn inside(observer: &Observer<'_>, sample: &Sample) -> f64 {
    let light = &observer.case().light;
    let p = sample.receiver.position;
    let to_light = light.direction_from(p);
    let along = to_light - sample.normal * sample.normal.dot(to_light);
    let size = length(along);
    if !size.is_finite() || size < 1e-9 {
        return 0.0;
    }
    let step = STEP * observer.lenses[sample.map].scales(p)[0];
    let way = Way { along: along / size, texel: step / STEP, touching: sample.answer.touching > 0 };
    let seen = |reach: f64| observer.clearance(&sample.receiver, &way, reach);
    let receiver =
        |s: f64| Receiver { position: p + along * (s / size), triangle: sample.receiver.triangle };
    let mut blocker = sample.receiver.triangle;
    let mut at = 0;
    while observer.is_shadowed(&receiver(f64::from(at + 1) * step), &mut blocker) {
        let blocks = |i: u32| observer.is_blocked_by(&receiver(f64::from(i) * step), blocker);
        at = last_blocked(at + 1, blocks);
        if at == STEPS {
            return seen(f64::from(STEPS) * step);
        }
    }
    let (mut dark, mut lit) = (f64::from(at) * step, f64::from(at + 1) * step);
    for _ in 0..12 {
        let middle = (dark + lit) / 2.0;
        let shadowed = observer.is_shadowed(&receiver(middle), &mut blocker);
        if shadowed { dark = middle } else { lit = middle }
    }
    seen(dark)
}

/// The last step up to [`STEPS`] that one triangle blocks, from a step that it blocks: its shadow on a
/// plane is convex, so that it blocks every step between two that it blocks.
fn last_blocked(from: u32, blocks: impl Fn(u32) -> bool) -> u32 {
    let (mut at, mut stride) = (from, 1);
    while at + stride <= STEPS && blocks(at + stride) {
        at += stride;
        stride *= 2;
    }
    while stride > 1 {
        stride /= 2;
        if at + stride <= STEPS && blocks(at + stride) {
            at += stride;
        }
    }
    at
}
