//! What a wrong verdict is called: by the stored caster at the deciding texel and the rung.

use super::ladder::Rung;
use crate::report::palette::Colour;

crate::catalogue! {
    /// What a wrong verdict looks like, named after what is stored where it was decided.
    pub enum Artifact {
        /// False shadow by the receiver's own or an adjacent surface.
        Acne = "acne",
        /// The texel centre sees another surface than the receiver does.
        EdgeAliasing = "edge-aliasing",
        /// False shadow by a cleared texel or a depth that no sound encoding would return.
        EncodingFault = "encoding-fault",
        /// False light because the bias exceeds the gap to the true occluder.
        PeterPanning = "peter-panning",
        /// False light past a thin, culled, clipped or wrongly stored caster.
        LightLeak = "light-leak",
    }
}

impl Artifact {
    /// Its colour on every page and picture.
    #[must_use]
    pub const fn colour(self) -> Colour {
        match self {
            Self::Acne => Colour::Vermilion,
            Self::EdgeAliasing => Colour::Yellow,
            Self::EncodingFault => Colour::Purple,
            Self::PeterPanning => Colour::Blue,
            Self::LightLeak => Colour::Sky,
        }
    }
}

/// What the map did to one counted receiver.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// The visibility equals the truth.
    Agree,
    /// Truth lit, map says (partly) shadowed.
    FalseShadow(Fault),
    /// Truth shadowed, map says (partly) lit.
    FalseLight(Fault),
}

/// Kind and cause of a wrong verdict.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fault {
    /// What it is called.
    pub artifact: Artifact,
    /// The first rung from which it stays wrong to the end.
    pub cause: Rung,
}

impl Outcome {
    /// The fault of a wrong verdict.
    #[must_use]
    pub const fn fault(self) -> Option<Fault> {
        match self {
            Self::Agree => None,
            Self::FalseShadow(fault) | Self::FalseLight(fault) => Some(fault),
        }
    }
}

/// Whose surface the deciding texel holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StoredCaster {
    /// Nothing was drawn there.
    Cleared,
    /// The receiver's own triangle or one adjacent to it.
    Own,
    /// The object of a true occluder.
    Occluder,
    /// Another surface.
    Other,
}

/// The name of a false shadow. `sound` tells whether the depth read is what the texel was drawn with,
/// up to the error of one 8-bit channel.
#[must_use]
pub fn false_shadow(stored: StoredCaster, sound: bool) -> Artifact {
    match stored {
        StoredCaster::Cleared => Artifact::EncodingFault,
        _ if !sound => Artifact::EncodingFault,
        StoredCaster::Own => Artifact::Acne,
        StoredCaster::Occluder | StoredCaster::Other => Artifact::EdgeAliasing,
    }
}

/// The name of a false light. `wrong_on_bias` tells whether the bias alone hides the occluder.
#[must_use]
pub fn false_light(stored: StoredCaster, wrong_on_bias: bool) -> Artifact {
    match stored {
        StoredCaster::Occluder if wrong_on_bias => Artifact::PeterPanning,
        StoredCaster::Own | StoredCaster::Cleared => Artifact::EdgeAliasing,
        StoredCaster::Occluder | StoredCaster::Other => Artifact::LightLeak,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_row_by_row() {
        use StoredCaster::{Cleared, Occluder, Other, Own};
        assert_eq!(false_shadow(Own, true), Artifact::Acne);
        assert_eq!(false_shadow(Other, true), Artifact::EdgeAliasing);
        assert_eq!(false_shadow(Cleared, true), Artifact::EncodingFault);
        assert_eq!(false_shadow(Own, false), Artifact::EncodingFault);
        assert_eq!(false_light(Occluder, true), Artifact::PeterPanning);
        assert_eq!(false_light(Own, true), Artifact::EdgeAliasing);
        assert_eq!(false_light(Cleared, false), Artifact::EdgeAliasing);
        assert_eq!(false_light(Other, true), Artifact::LightLeak);
        assert_eq!(false_light(Occluder, false), Artifact::LightLeak);
    }
}
