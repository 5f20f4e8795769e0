//! How far a surface can be seen from a receiver on: where something stands on it, it ends for a viewer.

use super::observe::Observer;
use crate::truth::{Faces, FirstHit, Receiver};
use crate::view::length;
use glam::DVec3;

/// Height above the surface at which a walk looks ahead, in texels: what leaves a lower gap below rests on
/// the surface.
const HEIGHT: f64 = 1.0 / 64.0;

/// Cosine of 45°: a surface ahead that is turned by less goes on with the receiver's own (a terrain, a
/// curved model); one that is turned by more, or away, stands on it.
const GOES_ON: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// Surfaces that go on which a look passes before it gives up.
const PASSED: usize = 64;

/// A way along a receiver's plane.
pub(super) struct Way {
    /// Where to; unit.
    pub(super) along: DVec3,
    /// Edge of a texel at the receiver, world units.
    pub(super) texel: f64,
    /// Whether triangles meet the receiver itself ([`crate::truth::Answer::touching`]).
    pub(super) touching: bool,
}

impl Observer<'_> {
    /// World length of a way from a receiver to where something stands on the
    /// side that is seen, and `reach` where nothing does before; 0 where it is covered.
    ///
    /// A ray at a 64th of a texel above the plane: what it meets hides the plane behind. Under a box that
    /// rests on a floor or is sunk into it the way ends at its side, under one that floats it goes on.
    pub(super) fn clearance(&self, receiver: &Receiver, way: &Way, reach: f64) -> f64 {
        let Way { along, texel, touching } = *way;
        let seen = self.seen_normal(receiver);
        let up = seen / length(seen);
        if !(up.is_finite() && reach > 0.0) {
            return reach;
        }
        if touching && self.is_covered(receiver, up, HEIGHT * texel) {
            return 0.0;
        }
        let winding = self.geometry.area_normal(receiver.triangle).dot(seen).signum();
        let start = receiver.position + up * (HEIGHT * texel);
        let end = start + along * reach;
        let (mut from, mut own) = (start, receiver.triangle);
        for _ in 0..PASSED {
            let hit = self.tracer.first_hit(from, end, Faces::Both, Some(own));
            let FirstHit::Hit { triangle, t, .. } = hit else { return reach };
            from += (end - from) * t;
            let normal = self.geometry.area_normal(triangle);
            if winding * normal.dot(up) < GOES_ON * length(normal) {
                return (from - start).dot(along).clamp(0.0, reach);
            }
            own = triangle;
        }
        reach
    }

    /// Whether another object rests on a receiver itself: upwards it is seen from within, and its foot lies
    /// on the receiver. Only a camera whose near plane cuts that object sees such a one.
    fn is_covered(&self, receiver: &Receiver, up: DVec3, height: f64) -> bool {
        let above = receiver.position + up * height;
        let first = |to: DVec3| match self.tracer.first_hit(
            above,
            to,
            Faces::Both,
            Some(receiver.triangle),
        ) {
            FirstHit::Hit { triangle, .. } => Some(triangle),
            FirstHit::None | FirstHit::Ambiguous => None,
        };
        let object = |t: u32| self.geometry.object[t as usize];
        let within = |t: &u32| {
            self.geometry.area_normal(*t).dot(up) > 0.0 && object(*t) != object(receiver.triangle)
        };
        let Some(roof) = first(above + up * self.tracer.reach()).filter(within) else {
            return false;
        };
        let below = receiver.position - up * height;
        first(below).is_some_and(|foot| object(foot) == object(roof))
    }
}
