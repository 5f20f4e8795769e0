//! Frusta of spots: stated, or fitted to what is in front of them.

use super::light::{Fit, Lit};
use super::{MARGIN, unit, up_for};
use crate::LoadedShadow;
use glam::DVec3;
use gnomon_core::view::{Projection, View, length};
use gnomon_core::{Error, Result};

impl Fit<'_> {
    /// The tightest frustum around what is in focus in front of a spot.
    pub(super) fn spot(
        &mut self,
        position: DVec3,
        target: DVec3,
        cone: Option<f64>,
        reach: Option<f64>,
        shadow: Option<&LoadedShadow>,
    ) -> Result<Lit> {
        let given = self.given();
        let fix = "leave it out, or give light.type = \"directional\"";
        let keys = given.box_keys().map(|(key, given)| (key, given.is_some()));
        self.settings.idle(&keys, "has no effect on a spot", fix)?;
        if given.far.is_some() {
            let fix = "leave one of them out";
            let reason = "has no effect beside light.far";
            self.settings.idle(&[("light.range", given.range.is_some())], reason, fix)?;
        }
        let direction = unit(target - position, "light.target")?;
        let up = up_for(given.up, direction);
        let Seen { nearest, farthest, widest } = self.seen(position, direction)?;
        let fitted = 2.0 * libm::atan(widest * (1.0 + MARGIN)) * 180.0 / std::f64::consts::PI;
        let fovy_degrees = given
            .fovy
            .or(shadow.and_then(|s| s.fovy_degrees))
            .or(cone)
            .unwrap_or_else(|| fitted.min(120.0));
        let stated = given.far.or(given.range).or(shadow.map(|s| s.far)).or(reach);
        let far = stated.unwrap_or(farthest * (1.0 + MARGIN));
        let fitted_near = (nearest * (1.0 - MARGIN)).max(far * 1e-4);
        let near = given.near.or(shadow.map(|s| s.near)).unwrap_or(fitted_near);
        self.notes.push(format!(
            "light frustum: {fovy_degrees} degrees, depth from {near} to {far}, fitted where not given"
        ));
        let size = self.size(shadow)?;
        let aspect = f64::from(size[0]) / f64::from(size[1]);
        let projection = Projection::Perspective { fovy_degrees, aspect, near, far };
        let lit = given.fovy.or(cone).unwrap_or(fovy_degrees);
        let cone = libm::cos(lit / 2.0 * std::f64::consts::PI / 180.0);
        self.mapped(View { position, target, up }, projection, Some(cone), shadow)
    }

    /// How far everything reaches in front of a point, and how wide what is in focus is.
    fn seen(&self, position: DVec3, direction: DVec3) -> Result<Seen> {
        let mut seen = Seen { nearest: f64::INFINITY, farthest: 0.0, widest: 0.0 };
        for (i, p) in self.bounds.all().enumerate() {
            let depth = (p - position).dot(direction);
            if depth > 0.0 {
                seen.nearest = seen.nearest.min(depth);
                seen.farthest = seen.farthest.max(depth);
                if i < self.bounds.points.len() {
                    let aside = length(p - position - direction * depth);
                    seen.widest = seen.widest.max(aside / depth);
                }
            }
        }
        if seen.farthest > 0.0 {
            return Ok(seen);
        }
        Err(Error::bad_input("light", "sees no vertex", "turn it towards the scene"))
    }
}

/// What a spot has in front of it.
struct Seen {
    nearest: f64,
    farthest: f64,
    widest: f64,
}
