//! Depth mappings: distance from the light ↔ window depth, and what one step of depth is worth.

use crate::{Error, Result};

crate::catalogue! {
    /// How a distance Z ∈ [near, far] becomes a window depth.
    pub enum MappingKind {
        /// (Z − n)/(f − n): directional lights.
        Orthographic = "orthographic",
        /// (Z − n)/(f − n) written by a shader under a perspective light.
        Linear = "linear",
        /// f(Z − n)/((f − n)Z): the usual projection, 0 at near and 1 at far.
        Perspective = "perspective",
        /// n(f − Z)/((f − n)Z): 1 at near and 0 at far, built into the matrix (never 1 − z).
        Reversed = "reversed",
        /// n/Z: reversed with far at infinity.
        ReversedInfinite = "reversed-infinite",
    }
}

/// A mapping with its planes.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct DepthMapping {
    kind: MappingKind,
    near: f64,
    far: f64,
}

impl DepthMapping {
    /// `near` and `far` in world units; `far` is only the end of the tables for
    /// [`MappingKind::ReversedInfinite`].
    ///
    /// # Errors
    /// Unless 0 < near < far, both finite.
    pub fn new(kind: MappingKind, near: f64, far: f64) -> Result<Self> {
        let fail = |reason: &str, fix: &str| {
            Err(Error::bad_input(format!("near {near}, far {far}"), reason, fix))
        };
        if !near.is_finite() || !far.is_finite() {
            return fail(
                "both must be finite numbers",
                "use reversed-infinite for a far of infinity",
            );
        }
        if near <= 0.0 {
            return fail("near must be above 0", "choose the distance of the closest caster");
        }
        if near >= far {
            return fail("near must be less than far", "exchange them");
        }
        Ok(Self { kind, near, far })
    }

    /// The kind of mapping.
    #[must_use]
    pub const fn kind(self) -> MappingKind {
        self.kind
    }

    /// Distance of the near plane, world units.
    #[must_use]
    pub const fn near(self) -> f64 {
        self.near
    }

    /// Distance of the far plane, world units.
    #[must_use]
    pub const fn far(self) -> f64 {
        self.far
    }

    /// Whether nearer is greater.
    #[must_use]
    pub const fn is_reversed(self) -> bool {
        matches!(self.kind, MappingKind::Reversed | MappingKind::ReversedInfinite)
    }

    /// Window depth of distance `z`, in f64: ≤ 5 ulp from the rational value, because every factor is
    /// a product or a single difference of inputs and nothing cancels (the form f/(f−n)·(1 − n/Z)
    /// is 13,348 ulp off near Z = n).
    #[must_use]
    pub fn window_from_distance(self, z: f64) -> f64 {
        let (n, f) = (self.near, self.far);
        match self.kind {
            MappingKind::Orthographic | MappingKind::Linear => (z - n) / (f - n),
            MappingKind::Perspective => f * (z - n) / ((f - n) * z),
            MappingKind::Reversed => n * (f - z) / ((f - n) * z),
            MappingKind::ReversedInfinite => n / z,
        }
    }

    /// Distance of window depth `d`. The error is 4·2⁻⁵³·Z²(f − n)/(nf) + 2 ulp(Z) for the
    /// perspective kinds: a relative error of d moves Z by Z²(f − n)/(nf).
    #[must_use]
    pub fn distance_from_window(self, d: f64) -> f64 {
        let (n, f) = (self.near, self.far);
        match self.kind {
            MappingKind::Orthographic | MappingKind::Linear => n + d * (f - n),
            MappingKind::Perspective => n * f / (f - d * (f - n)),
            MappingKind::Reversed => n * f / (n + d * (f - n)),
            MappingKind::ReversedInfinite => n / d,
        }
    }

    /// World length per unit of window depth at distance `z` (|dZ/dd|): f − n when linear,
    /// Z²(f − n)/(nf) in perspective, Z²/n when reversed with far at infinity.
    #[must_use]
    pub fn world_per_window(self, z: f64) -> f64 {
        let (n, f) = (self.near, self.far);
        match self.kind {
            MappingKind::Orthographic | MappingKind::Linear => f - n,
            MappingKind::Perspective | MappingKind::Reversed => z * z * (f - n) / (n * f),
            MappingKind::ReversedInfinite => z * z / n,
        }
    }

    /// The f32 the subject computes for distance `z`: the same formula, every operation rounded.
    #[must_use]
    pub fn window_f32(self, z: f32) -> f32 {
        let (n, f) = (self.near as f32, self.far as f32);
        match self.kind {
            MappingKind::Orthographic | MappingKind::Linear => (z - n) / (f - n),
            MappingKind::Perspective => f * (z - n) / ((f - n) * z),
            MappingKind::Reversed => n * (f - z) / ((f - n) * z),
            MappingKind::ReversedInfinite => n / z,
        }
    }

    /// [`Self::distance_from_window`] with every operation rounded to f32.
    #[must_use]
    pub fn distance_f32(self, d: f32) -> f32 {
        let (n, f) = (self.near as f32, self.far as f32);
        match self.kind {
            MappingKind::Orthographic | MappingKind::Linear => n + d * (f - n),
            MappingKind::Perspective => n * f / (f - d * (f - n)),
            MappingKind::Reversed => n * f / (n + d * (f - n)),
            MappingKind::ReversedInfinite => n / d,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn planes_map_to_the_ends_exactly() {
        for &kind in MappingKind::ALL {
            let mapping = DepthMapping::new(kind, 0.5, 10.0).expect("valid planes");
            let (near, far) = if mapping.is_reversed() { (1.0, 0.0) } else { (0.0, 1.0) };
            assert_eq!(mapping.window_from_distance(0.5), near, "{kind}");
            if kind != MappingKind::ReversedInfinite {
                assert_eq!(mapping.window_from_distance(10.0), far, "{kind}");
            }
        }
    }

    #[test]
    fn impossible_planes_are_refused_with_a_sentence() {
        for (near, far) in [(0.0, 1.0), (-1.0, 1.0), (2.0, 1.0), (1.0, 1.0), (f64::NAN, 1.0)] {
            let error = DepthMapping::new(MappingKind::Perspective, near, far).unwrap_err();
            assert_eq!(error.exit_code(), 2, "{error}");
        }
        assert!(DepthMapping::new(MappingKind::Reversed, 1.0, f64::INFINITY).is_err());
    }

    #[test]
    fn a_bias_in_the_documents_is_worth_metres_at_the_far_end() {
        let mapping = DepthMapping::new(MappingKind::Perspective, 1.0, 100.0).expect("valid");
        let world = 0.005 * mapping.world_per_window(41.73);
        assert!((world - 8.6).abs() < 0.1, "{world} (first order, field notes: 7.1 exact)");
        let depth = mapping.window_from_distance(41.73) - 0.005;
        let exact = 41.73 - mapping.distance_from_window(depth);
        assert!((exact - 7.1).abs() < 0.1, "{exact}");
    }
}
