//! Lengths on the receiver: the falsely lit strip through a sample and the period of acne stripes,
//! walked along the surface and refined by bisection.

use super::foot::Way;
use super::observe::Observer;
use crate::shadow;
use crate::truth::{Receiver, Truth};
use crate::view::length;
use glam::DVec3;
use std::cell::OnceCell;

/// Steps per texel while looking for the next change.
const STEPS_PER_TEXEL: f64 = 4.0;
/// Bisections of each change: 2⁻³⁰ of a step.
const BISECTIONS: u32 = 30;
/// A walk gives up after so many steps.
const LONGEST_WALK: u32 = 4000;

/// What the subject and the truth say at a point of the receiver's plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct State {
    subject_lit: bool,
    truly_lit: bool,
}

/// Walks over the surface of one triangle's plane.
#[derive(Debug)]
pub struct Walk<'o, 'a> {
    observer: &'o Observer<'a>,
    triangle: u32,
    origin: DVec3,
    direction: DVec3,
    step: f64,
    bias: f32,
    /// Triangles in the plane of the walk's own, by id; found when the walk first leaves that.
    coplanar: OnceCell<Vec<u32>>,
}

impl<'o, 'a> Walk<'o, 'a> {
    /// A walk from `receiver` along the light's direction projected on its surface; `None` where the
    /// light stands straight above (no direction) or the triangle has no area.
    #[must_use]
    pub fn along_light(observer: &'o Observer<'a>, receiver: &Receiver, bias: f32) -> Option<Self> {
        let case = observer.case();
        let normal = observer.geometry.area_normal(receiver.triangle);
        let normal = normal / length(normal);
        let to_light = case.light.direction_from(receiver.position);
        let along = to_light - normal * normal.dot(to_light);
        let size = length(along);
        if !size.is_finite() || size < 1e-9 {
            return None;
        }
        let map = observer.main_map(receiver)?;
        let [texel, _] = observer.lenses[map].scales(receiver.position);
        Some(Self {
            observer,
            triangle: receiver.triangle,
            origin: receiver.position,
            direction: along / size,
            step: texel / STEPS_PER_TEXEL,
            bias,
            coplanar: OnceCell::new(),
        })
    }

    /// World length of a step.
    #[must_use]
    pub fn texel_world(&self) -> f64 {
        self.step * STEPS_PER_TEXEL
    }

    /// The state `s` world units towards the light; `None` off the object or the map.
    fn state(&self, s: f64) -> Option<State> {
        let observer = self.observer;
        let case = observer.case();
        let position = self.origin + self.direction * s;
        let triangle = self.triangle_at(position)?;
        let receiver = Receiver { position, triangle };
        let looking = observer.exactly([0; 2], &receiver)?;
        let main = looking.main().map;
        if !observer.lenses[main].holds(observer.lenses[main].look(position)?) {
            return None;
        }
        let taps = observer.taps(&case.lookup, &looking.lookups, looking.pixel);
        let lit = shadow::visibility(&case.lookup, &looking.lookups, &taps, self.bias);
        let truth = observer.tracer.truth(&receiver, observer.light_end(position)).truth;
        let subject_lit = 2 * lit > taps.depths().len();
        (truth != Truth::Ambiguous).then_some(State { subject_lit, truly_lit: truth == Truth::Lit })
    }

    /// The triangle under a point of the plane: the walk's own or a coplanar one of its object.
    fn triangle_at(&self, position: DVec3) -> Option<u32> {
        let geometry = &self.observer.geometry;
        let own = geometry.area_normal(self.triangle);
        let own_length = length(own);
        let inside = |t: u32| {
            let [a, b, c] = geometry.corners(t);
            let normal = geometry.area_normal(t);
            let side = |p: DVec3, q: DVec3| (q - p).cross(position - p).dot(normal);
            let slack = -1e-9 * normal.dot(normal);
            side(a, b) >= slack && side(b, c) >= slack && side(c, a) >= slack
        };
        let coplanar = |t: u32| {
            let offset = (geometry.corners(t)[0] - self.origin).dot(own);
            if offset.abs() > 1e-9 * own_length {
                return false;
            }
            let normal = geometry.area_normal(t);
            length(normal.cross(own)) <= 1e-9 * length(normal) * own_length
        };
        if inside(self.triangle) {
            return Some(self.triangle);
        }
        let all = || (0..geometry.triangles.len() as u32).filter(|&t| coplanar(t)).collect();
        self.coplanar.get_or_init(all).iter().copied().find(|&t| inside(t))
    }

    /// Where `wanted` stops holding, going from 0 in direction `sign`.
    fn end_of(&self, sign: f64, wanted: impl Fn(State) -> bool) -> f64 {
        let holds = |s: f64| self.state(s).is_some_and(&wanted);
        let mut good = 0.0;
        for i in 1..=LONGEST_WALK {
            let next = sign * self.step * f64::from(i);
            if !holds(next) {
                return self.refine(good, next, holds);
            }
            good = next;
        }
        good
    }

    /// The change between `good`, where `holds`, and `bad`, where it does not.
    fn refine(&self, mut good: f64, mut bad: f64, holds: impl Fn(f64) -> bool) -> f64 {
        for _ in 0..BISECTIONS {
            let middle = (good + bad) / 2.0;
            if holds(middle) { good = middle } else { bad = middle }
        }
        (good + bad) / 2.0
    }

    /// Length of the falsely lit strip through the walk's origin, along the light's direction on the
    /// receiver, as far as a viewer sees it: it ends where something stands on the receiver's plane. `None`
    /// if the origin is not falsely lit.
    #[must_use]
    pub fn false_light_length(&self) -> Option<f64> {
        let falsely_lit = |s: State| s.subject_lit && !s.truly_lit;
        let receiver = Receiver { position: self.origin, triangle: self.triangle };
        let light_end = self.observer.light_end(self.origin);
        let touching = self.observer.tracer.truth(&receiver, light_end).touching > 0;
        let seen = |sign: f64| {
            let length = sign * self.end_of(sign, falsely_lit);
            let along = self.direction * sign;
            let way = Way { along, texel: self.texel_world(), touching };
            self.observer.clearance(&receiver, &way, length)
        };
        self.state(0.0).is_some_and(falsely_lit).then(|| seen(1.0) + seen(-1.0))
    }

    /// Mean distance between the starts of successive false-shadow stripes around the origin;
    /// `None` if fewer than three begin within the walk.
    #[must_use]
    pub fn stripe_period(&self) -> Option<f64> {
        let striped = |s: f64| self.state(s).map(|s| s.truly_lit && !s.subject_lit);
        let mut starts = Vec::new();
        let mut before = striped(0.0)?;
        for i in 1..=LONGEST_WALK {
            let s = self.step * f64::from(i);
            let Some(now) = striped(s) else { break };
            if now && !before {
                starts.push(self.refine(s - self.step, s, |s| striped(s) == Some(false)));
            }
            before = now;
        }
        let count = starts.len().checked_sub(1).filter(|&n| n >= 2)?;
        Some((starts[count] - starts[0]) / count as f64)
    }
}
