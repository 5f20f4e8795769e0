//! What lies outside a light's maps and cone: receivers by reason, with the value that would include them,
//! casters that near and far cut off, surfaces that receive no shadow, normals that point away from the light.

mod words;

use super::observe::{Observation, Observer, Standing};
use crate::light::{Lens, Map};
use crate::truth::{Answer, Receiver, Truth};
use crate::view::Projection;
use glam::DVec3;
use rayon::prelude::*;
use serde::Serialize;
pub(super) use words::reasons;
pub use words::{first_lines, named};

crate::catalogue! {
    /// Why a receiver lies outside what a light draws or lights; of several reasons the first.
    pub enum Outside {
        /// On the far side of the light, where its map does not look.
        BehindLight = "behind-light",
        /// Nearer to the light than its near plane.
        BeforeNear = "before-near",
        /// Farther from the light than its far plane.
        BeyondFar = "beyond-far",
        /// To the left of the map, as the light sees it.
        Left = "left",
        /// To the right of the map.
        Right = "right",
        /// Below the map.
        Below = "below",
        /// Above the map.
        Above = "above",
        /// In the map, but outside the spot's cone.
        BeyondCone = "beyond-cone",
    }
}

crate::catalogue! {
    /// A number of a light that says how far it reaches.
    pub enum Reach {
        /// Distance of the near plane from the light along its axis, world units.
        Near = "near",
        /// Distance of the far plane from the light along its axis, world units.
        Far = "far",
        /// Width of a directional light's box, of a square one its height too, world units.
        Width = "width",
        /// Height of a directional light's box, world units.
        Height = "height",
        /// Vertical field of view of a spot, which is its cone too, degrees.
        Fovy = "fovy",
    }
}

/// Receivers that one reason keeps out of the rates.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct LeftOut {
    /// The reason.
    pub why: Outside,
    /// How many there are.
    pub receivers: u64,
    /// The values that together include them; empty where none can, and for a light with several maps.
    pub include: Vec<Include>,
}

/// A value that would include what lies outside.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Include {
    /// The number of the light.
    pub reach: Reach,
    /// What it is, in the unit of [`Reach`].
    pub is: f64,
    /// What the outermost receiver takes, f64.
    pub takes: f64,
    /// The value to set: 0.1 % beyond that, rounded to 4 digits, so at least 0.05 % beyond.
    pub set: f64,
}

/// An object that truly shadows receivers from where the map does not draw it.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct LostCaster {
    /// The object's name.
    pub object: String,
    /// Before near or beyond far.
    pub why: Outside,
    /// Whether all of the object lies there.
    pub whole: bool,
    /// Receivers that it truly shadows from there.
    pub receivers: u64,
    /// The value that includes what shadows them.
    pub include: Option<Include>,
}

/// A value for each reach that is taken.
type Takes = [Option<f64>; Reach::ALL.len()];

/// Sums over receivers; they do not depend on the order of these.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct OutsideCounts {
    /// Receivers of any standing.
    seen: u64,
    receivers: [u64; Outside::ALL.len()],
    /// The outermost value of each reach that they take, by reason.
    takes: [Takes; Outside::ALL.len()],
    /// Receivers whose first occluder lies before near and beyond far, by its object.
    cut: [Vec<u64>; 2],
    /// The outermost near and far that those occluders take.
    cut_takes: [Option<f64>; 2],
    /// Receivers on surfaces that receive no shadow.
    receive_none: u64,
    /// Truly lit receivers, and those whose vertices' normals point away from the light.
    lit: [u64; 2],
}

/// The smaller of two near distances, the larger of two others.
fn outermost(near: bool, a: Option<f64>, b: Option<f64>) -> Option<f64> {
    let farther = if near { f64::min } else { f64::max };
    a.zip(b).map_or(a.or(b), |(a, b)| Some(farther(a, b)))
}

/// A distance as f64 gives it must exceed a plane's by this share of both to lie beyond it.
const SLACK: f64 = 1e-9;

impl OutsideCounts {
    /// The counts over observed receivers.
    pub(super) fn of(observer: &Observer<'_>, observations: &[Observation]) -> Self {
        let add = |mut counts: Self, o: &Observation| {
            let exact = (!o.exact.x.is_nan()).then_some(o.exact);
            counts.add(observer, &o.receiver, o.map, exact, (&o.answer, o.standing));
            counts
        };
        let chunks = observations.par_chunks(1 << 14);
        chunks
            .map(|list| list.iter().fold(Self::default(), add))
            .reduce(Self::default, Self::joined)
    }

    /// The counts of both.
    pub(super) fn joined(mut self, other: Self) -> Self {
        self.seen += other.seen;
        self.receive_none += other.receive_none;
        self.lit.iter_mut().zip(other.lit).for_each(|(a, b)| *a += b);
        self.receivers.iter_mut().zip(other.receivers).for_each(|(a, b)| *a += b);
        self.takes.iter_mut().zip(other.takes).for_each(|(a, b)| join(a, b));
        for (end, cut) in other.cut.into_iter().enumerate() {
            let mine = &mut self.cut[end];
            mine.resize(mine.len().max(cut.len()), 0);
            mine.iter_mut().zip(cut).for_each(|(a, b)| *a += b);
            self.cut_takes[end] = outermost(end == 0, self.cut_takes[end], other.cut_takes[end]);
        }
        self
    }

    /// Counts a receiver of a map, `exact` being its coordinates there.
    pub(super) fn add(
        &mut self,
        observer: &Observer<'_>,
        receiver: &Receiver,
        map: usize,
        exact: Option<DVec3>,
        (answer, standing): (&Answer, Standing),
    ) {
        self.seen += 1;
        let object = usize::from(observer.geometry.object[receiver.triangle as usize]);
        self.receive_none += u64::from(!observer.case().objects[object].surface.receives);
        let lens = &observer.lenses[map];
        let is_outside = standing == Standing::OutsideMap || standing == Standing::OutsideCone;
        if is_outside {
            let place = Place::of(observer, lens, receiver.position, exact);
            let why = place.why() as usize;
            self.receivers[why] += 1;
            join(&mut self.takes[why], place.takes());
        }
        if standing == Standing::Counted && answer.truth == Truth::Lit {
            let away = observer
                .vertex_normals_at(receiver)
                .is_some_and(|normals| normals.interpolated.dot(observer.to_light(receiver)) < 0.0);
            self.lit = [self.lit[0] + 1, self.lit[1] + u64::from(away)];
        }
        if is_outside || standing == Standing::Counted {
            self.add_occluder(observer, receiver, &lens.map, answer);
        }
    }

    /// Counts a shadowed receiver whose first occluder the map's near or far plane cuts off.
    fn add_occluder(
        &mut self,
        observer: &Observer<'_>,
        receiver: &Receiver,
        map: &Map,
        answer: &Answer,
    ) {
        let Truth::Shadowed(occlusion) = &answer.truth else { return };
        let ray = observer.light_end(receiver.position) - receiver.position;
        let hit = receiver.position + ray * (occlusion.first_gap / f64::sqrt(ray.dot(ray)));
        let (distance, (near, far)) = (map.axial_distance(hit), map.projection.near_far());
        let slack = |plane: f64| SLACK * (plane.abs() + distance.abs());
        let end = match (distance < near - slack(near), distance > far + slack(far)) {
            (true, _) => 0,
            (_, true) => 1,
            (false, false) => return,
        };
        let object = usize::from(observer.geometry.object[occlusion.first as usize]);
        let cut = &mut self.cut[end];
        cut.resize(cut.len().max(object + 1), 0);
        cut[object] += 1;
        self.cut_takes[end] = outermost(end == 0, self.cut_takes[end], Some(distance));
    }

    /// Receivers left out by reason; reasons without any are absent.
    pub(super) fn left_out(&self, observer: &Observer<'_>) -> Vec<LeftOut> {
        let map = observer.case().light.only_map();
        let of = |&why: &Outside| {
            let takes = self.takes[why as usize];
            let include = |&reach: &Reach| Some(Include::of(reach, map?, takes[reach as usize]?));
            let all: Option<Vec<Include>> = Reach::ALL.iter().filter_map(include).collect();
            LeftOut {
                why,
                receivers: self.receivers[why as usize],
                include: all.unwrap_or_default(),
            }
        };
        Outside::ALL.iter().map(of).filter(|left| left.receivers > 0).collect()
    }

    /// Objects whose shadows near or far cut off.
    pub(super) fn lost_casters(&self, observer: &Observer<'_>) -> Vec<LostCaster> {
        let case = observer.case();
        let Some(map) = case.light.only_map() else { return Vec::new() };
        let (near, far) = map.projection.near_far();
        let (geometry, mut lost) = (&observer.geometry, Vec::new());
        for (end, why) in [Outside::BeforeNear, Outside::BeyondFar].into_iter().enumerate() {
            for (index, &receivers) in self.cut[end].iter().enumerate().filter(|(_, n)| **n > 0) {
                let own = |&(_, object): &(_, &u16)| usize::from(*object) == index;
                let triangles = geometry.triangles.iter().zip(&geometry.object).filter(own);
                let whole = triangles.flat_map(|(corners, _)| corners).all(|&v| {
                    let distance = map.axial_distance(geometry.positions[v as usize]);
                    if end == 0 { distance < near } else { distance > far }
                });
                let reach = if end == 0 { Reach::Near } else { Reach::Far };
                lost.push(LostCaster {
                    object: case.objects[index].name.clone(),
                    why,
                    whole,
                    receivers,
                    include: Include::of(reach, map, self.cut_takes[end].unwrap_or(f64::NAN)),
                });
            }
        }
        lost
    }
}

/// A place against a map's volume.
struct Place<'p> {
    map: &'p Map,
    /// In the space of its eye.
    at: DVec3,
    /// Full angle of the cone that holds it, degrees; `None` where the light's own does.
    cone: Option<f64>,
    /// Map coordinates and depth; `None` behind the eye.
    exact: Option<DVec3>,
}

const DEGREES: f64 = 180.0 / std::f64::consts::PI;

impl<'p> Place<'p> {
    fn of(observer: &Observer<'_>, lens: &'p Lens, p_world: DVec3, exact: Option<DVec3>) -> Self {
        let (map, light) = (&lens.map, &observer.case().light);
        let cosine = light.direction_from(p_world).dot(light.eye().backward()).clamp(-1.0, 1.0);
        let cone = || 2.0 * libm::acos(cosine) * DEGREES;
        Self {
            map,
            at: map.view.view_from_world().transform_point3(p_world),
            cone: (!light.in_cone(p_world)).then(cone),
            exact,
        }
    }

    /// Whether it lies before near, beyond far, beside and above or below the map.
    fn beyond(&self) -> Option<[bool; 4]> {
        let [low, high] = self.map.clip.depths();
        let beside = |x: f64| !(0.0..=1.0).contains(&x);
        let exact = self.exact?;
        Some([exact.z < low, exact.z > high, beside(exact.x), beside(exact.y)])
    }

    /// The first reason for which it lies outside.
    fn why(&self) -> Outside {
        match self.beyond() {
            None => Outside::BehindLight,
            Some([true, ..]) => Outside::BeforeNear,
            Some([_, true, ..]) => Outside::BeyondFar,
            Some([_, _, true, _]) if self.at.x < 0.0 => Outside::Left,
            Some([_, _, true, _]) => Outside::Right,
            Some([.., true]) if self.at.y < 0.0 => Outside::Below,
            Some([.., true]) => Outside::Above,
            Some([false, false, false, false]) => Outside::BeyondCone,
        }
    }

    /// What it takes of each reach that does not hold it.
    fn takes(&self) -> Takes {
        let mut takes = Takes::default();
        let Some([before, beyond, beside, above]) = self.beyond() else { return takes };
        let [x, y, distance] = [self.at.x.abs(), self.at.y.abs(), -self.at.z];
        let mut take = |reach: Reach, value: f64| {
            let known = &mut takes[reach as usize];
            *known = outermost(false, *known, Some(value));
        };
        if before {
            take(Reach::Near, distance);
        }
        if beyond {
            take(Reach::Far, distance);
        }
        match self.map.projection {
            Projection::Orthographic { width, height, .. } => {
                let square = width == height;
                if beside {
                    take(Reach::Width, 2.0 * x);
                }
                if above {
                    take(if square { Reach::Width } else { Reach::Height }, 2.0 * y);
                }
            }
            Projection::Perspective { aspect, .. } => {
                if beside || above {
                    let half = libm::atan2(y.max(x / aspect), distance);
                    take(Reach::Fovy, 2.0 * half * DEGREES);
                }
                if let Some(cone) = self.cone {
                    take(Reach::Fovy, cone);
                }
            }
        }
        takes
    }
}

/// The outermost of each.
fn join(mine: &mut Takes, other: Takes) {
    for (&reach, other) in Reach::ALL.iter().zip(other) {
        let known = &mut mine[reach as usize];
        *known = outermost(reach == Reach::Near, *known, other);
    }
}

/// No perspective opens wider, degrees.
const WIDEST: f64 = 175.0;

impl Include {
    /// The value of a map's reach that takes in what takes `takes`; `None` where it cannot be set.
    fn of(reach: Reach, map: &Map, takes: f64) -> Option<Self> {
        let (near, far) = map.projection.near_far();
        let is = match (reach, map.projection) {
            (Reach::Near, _) => near,
            (Reach::Far, _) => far,
            (Reach::Width, Projection::Orthographic { width, .. }) => width,
            (Reach::Height, Projection::Orthographic { height, .. }) => height,
            (Reach::Fovy, Projection::Perspective { fovy_degrees, .. }) => fovy_degrees,
            (Reach::Width | Reach::Height | Reach::Fovy, _) => return None,
        };
        let outwards = if reach == Reach::Near { -1.0 } else { 1.0 };
        let set = four_digits(takes + outwards * 1e-3 * takes.abs());
        let possible = match reach {
            Reach::Near => map.is_orthographic() || set > 0.0,
            Reach::Fovy => set <= WIDEST,
            Reach::Far | Reach::Width | Reach::Height => true,
        };
        (possible && takes.is_finite()).then_some(Self { reach, is, takes, set })
    }
}

/// The nearest number of four significant digits.
fn four_digits(x: f64) -> f64 {
    format!("{x:.3e}").parse().unwrap_or(x)
}
