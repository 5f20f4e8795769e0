//! Which surface a texel stores: the nearest, the second, something between the two.

crate::catalogue! {
    /// What is made of the two nearest surfaces of a texel (depths z₁ ≤ z₂).
    pub enum Layers {
        /// z₁ of the faces that the case draws.
        Nearest = "nearest",
        /// z₁ of back faces alone (front-face culling).
        BackFaces = "back-faces",
        /// z₂; cleared where there is no second surface (Wang and Molnar 1994).
        Second = "second",
        /// (z₁ + z₂)/2; cleared where there is no second surface (Woo 1992).
        Midpoint = "midpoint",
        /// z₁ + min((z₂ − z₁)/2, offset) (Weiskopf and Ertl 2003).
        Dual = "dual",
    }
}

impl Layers {
    /// Whether the second nearest surface is needed.
    #[must_use]
    pub const fn needs_second(self) -> bool {
        matches!(self, Self::Second | Self::Midpoint | Self::Dual)
    }

    /// The depth that is stored, f32 arithmetic; `None` clears the texel.
    #[must_use]
    pub fn combine(self, first: f32, second: Option<f32>, offset: f32) -> Option<f32> {
        match (self, second) {
            (Self::Nearest | Self::BackFaces, _) => Some(first),
            (Self::Second, second) => second,
            (Self::Midpoint, second) => second.map(|z| first + (z - first) * 0.5),
            (Self::Dual, second) => {
                let half = second.map_or(f32::INFINITY, |z| (z - first) * 0.5);
                Some(first + half.min(offset))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layers_are_combined_as_published() {
        assert_eq!(Layers::Second.combine(0.25, Some(0.5), 0.0), Some(0.5));
        assert_eq!(Layers::Midpoint.combine(0.25, Some(0.5), 0.0), Some(0.375));
        assert_eq!(Layers::Dual.combine(0.25, Some(0.5), 0.0625), Some(0.3125));
        assert_eq!(Layers::Dual.combine(0.25, Some(0.5), 0.5), Some(0.375));
        assert_eq!(Layers::Dual.combine(0.25, None, 0.5), Some(0.75));
        assert_eq!(Layers::Midpoint.combine(0.25, None, 0.5), None);
    }
}
