//! Comparisons at the receiver's own plane: the depth that the plane has where the tap looks.

use crate::shadow::Offset;
use glam::DVec2;

crate::catalogue! {
    /// With which receiver depth a tap is compared.
    pub enum Follow {
        /// The receiver's own.
        Receiver = "receiver",
        /// The plane's at the texel's centre: exact receiver-plane depth bias.
        TexelCentre = "texel-centre",
        /// The plane's at the point that the filter samples (Isidoro 2006; MJP Shadows): the texel's
        /// own extent is left to a constant.
        Sample = "sample",
        /// The nearer of the receiver's and the plane's at the texel's centre (Dou, Yan, Kerzner,
        /// Dai, Wyman, JCGT 3(4), 2014).
        NearerOfCentre = "nearer-of-centre",
    }
}

/// Largest change of the compared depth, window depth: MJP's clamp, for grazing planes.
pub const LARGEST_STEP: f32 = 0.01;

impl Follow {
    /// What is added to the receiver's depth for a tap at an offset, given the plane's window depth per
    /// unit of u and v. f64 product, rounded once, clamped to ±[`LARGEST_STEP`]; a plane seen edge-on
    /// adds nothing.
    #[must_use]
    pub fn shift(self, gradient: DVec2, offset: Offset) -> f32 {
        let along = |o: [f32; 2]| {
            let shift = gradient.x * f64::from(o[0]) + gradient.y * f64::from(o[1]);
            let shift = if shift.is_finite() { shift as f32 } else { 0.0 };
            shift.clamp(-LARGEST_STEP, LARGEST_STEP)
        };
        match self {
            Self::Receiver => 0.0,
            Self::TexelCentre => along(offset.centre),
            Self::Sample => along(offset.sample),
            Self::NearerOfCentre => along(offset.centre).min(0.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shifts_follow_the_plane_and_stop_at_the_clamp() {
        let g = DVec2::new(0.5, -0.25);
        let to = |x: f32, y: f32| Offset { sample: [0.0; 2], centre: [x, y] };
        assert_eq!(Follow::TexelCentre.shift(g, to(0.01, 0.01)), 0.0025);
        assert_eq!(Follow::NearerOfCentre.shift(g, to(0.01, 0.01)), 0.0);
        assert_eq!(Follow::TexelCentre.shift(g, to(1.0, 0.0)), LARGEST_STEP);
        let edge_on = DVec2::new(f64::INFINITY, 0.0);
        assert_eq!(Follow::TexelCentre.shift(edge_on, to(1.0, 0.0)), 0.0);
    }
}
