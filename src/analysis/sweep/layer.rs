//! How far a stored layer lies behind a receiver's first occluder, on the receiver's own ray.

use super::field::{Field, Sample};
use crate::shadow::bias::{Layers, Recipe};
use crate::truth::{Faces, FirstHit, Truth};
use glam::DVec3;

impl Field<'_> {
    /// Compared depth from the first occluder of a truly shadowed receiver to the depth that a recipe's layer
    /// has on the receiver's own ray: what the layer alone does to its shadow, wherever texels have their
    /// centres. +∞ where no layer of it is in front of the receiver.
    pub(super) fn layer_gain(&self, sample: &Sample, recipe: &Recipe) -> f64 {
        let Truth::Shadowed(occlusion) = &sample.answer.truth else { return 0.0 };
        let first = sample.exact.z - sample.gap;
        // Where nothing is between, the receiver's own surface is the second one.
        let behind = || {
            let second = self.depth_behind(sample, occlusion.first, occlusion.first_gap);
            second.map(|z| z - first)
        };
        match recipe.layers {
            Layers::Nearest => 0.0,
            Layers::BackFaces => {
                let ends = self.ray(sample);
                self.hit(sample, ends, Faces::Back, None).map_or(f64::INFINITY, |z| z - first)
            }
            Layers::Second => behind().unwrap_or(f64::INFINITY),
            Layers::Midpoint => behind().unwrap_or(sample.gap) * 0.5,
            Layers::Dual => {
                let half = behind().unwrap_or(sample.gap) * 0.5;
                half.min(f64::from(recipe.layer_offset))
            }
        }
    }

    /// From the light to the receiver.
    fn ray(&self, sample: &Sample) -> [DVec3; 2] {
        let position = sample.receiver.position;
        [self.observer.light_end(position), position]
    }

    /// Depth of the next surface behind the first occluder, which lies `gap` world units from the receiver.
    fn depth_behind(&self, sample: &Sample, first: u32, gap: f64) -> Option<f64> {
        let [light, position] = self.ray(sample);
        let ray = light - position;
        let from = position + ray * (gap / crate::view::length(ray));
        self.hit(sample, [from, position], Faces::Both, Some(first))
    }

    /// Compared depth of the first surface on the way to the receiver.
    fn hit(
        &self,
        sample: &Sample,
        [from, to]: [DVec3; 2],
        faces: Faces,
        without: Option<u32>,
    ) -> Option<f64> {
        let without = without.or(Some(sample.receiver.triangle));
        match self.observer.tracer.first_hit(from, to, faces, without) {
            FirstHit::Hit { triangle, t, t_error }
                if t + t_error < 1.0 && triangle != sample.receiver.triangle =>
            {
                let look = self.observer.lenses[sample.map].look(from + (to - from) * t)?;
                Some(look.z)
            }
            FirstHit::None | FirstHit::Hit { .. } | FirstHit::Ambiguous => None,
        }
    }
}
