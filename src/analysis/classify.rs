//! What a wrong verdict is called: a pair of side and artifact, by the stored caster that decided it.

use super::ladder::Rung;
use crate::report::palette::Colour;

crate::catalogue! {
    /// To which side a verdict is wrong.
    pub enum Side {
        /// Truth lit, map says (partly) shadowed.
        FalseShadow = "false-shadow",
        /// Truth shadowed, map says (partly) lit.
        FalseLight = "false-light",
    }
}

impl Side {
    /// The side to which a wrong verdict errs.
    #[must_use]
    pub const fn of(truly_lit: bool) -> Self {
        if truly_lit { Self::FalseShadow } else { Self::FalseLight }
    }
}

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

    /// The sides on which it occurs.
    #[must_use]
    pub const fn sides(self) -> &'static [Side] {
        match self {
            Self::Acne | Self::EncodingFault => &[Side::FalseShadow],
            Self::PeterPanning | Self::LightLeak => &[Side::FalseLight],
            Self::EdgeAliasing => &[Side::FalseShadow, Side::FalseLight],
        }
    }
}

/// A kind of wrong verdict: its side and its artifact, which occurs on that side.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Kind {
    side: Side,
    artifact: Artifact,
}

impl Kind {
    /// False shadow by the receiver's own surface.
    pub const ACNE: Self = Self::pair(Side::FalseShadow, Artifact::Acne);
    /// False shadow because the texel's centre sees another surface.
    pub const EDGE_SHADOW: Self = Self::pair(Side::FalseShadow, Artifact::EdgeAliasing);
    /// False shadow by a cleared texel or a depth that no sound encoding returns.
    pub const ENCODING_FAULT: Self = Self::pair(Side::FalseShadow, Artifact::EncodingFault);
    /// False light because the bias hides the occluder.
    pub const PETER_PANNING: Self = Self::pair(Side::FalseLight, Artifact::PeterPanning);
    /// False light because the texel's centre misses the occluder.
    pub const EDGE_LIGHT: Self = Self::pair(Side::FalseLight, Artifact::EdgeAliasing);
    /// False light past a thin, culled or wrongly stored caster.
    pub const LIGHT_LEAK: Self = Self::pair(Side::FalseLight, Artifact::LightLeak);

    /// How many pairs there are: an artifact that is missing in [`Self::ALL`] does not compile.
    pub const COUNT: usize = {
        let (mut count, mut i) = (0, 0);
        while i < Artifact::ALL.len() {
            count += Artifact::ALL[i].sides().len();
            i += 1;
        }
        count
    };

    /// Every pair, in report order.
    pub const ALL: [Self; Self::COUNT] = [
        Self::ACNE,
        Self::EDGE_SHADOW,
        Self::ENCODING_FAULT,
        Self::PETER_PANNING,
        Self::EDGE_LIGHT,
        Self::LIGHT_LEAK,
    ];

    /// The place of each pair in [`Self::ALL`], by side and artifact.
    const PLACES: [[u8; Artifact::ALL.len()]; Side::ALL.len()] = {
        let mut places = [[u8::MAX; Artifact::ALL.len()]; Side::ALL.len()];
        let mut i = 0;
        while i < Self::COUNT {
            let Self { side, artifact } = Self::ALL[i];
            places[side as usize][artifact as usize] = i as u8;
            i += 1;
        }
        places
    };

    const fn pair(side: Side, artifact: Artifact) -> Self {
        let (sides, mut i) = (artifact.sides(), 0);
        while i < sides.len() {
            if sides[i] as usize == side as usize {
                return Self { side, artifact };
            }
            i += 1;
        }
        panic!("the artifact does not occur on that side")
    }

    /// The side of the error.
    #[must_use]
    pub const fn side(self) -> Side {
        self.side
    }

    /// The artifact.
    #[must_use]
    pub const fn artifact(self) -> Artifact {
        self.artifact
    }

    /// Its place in [`Self::ALL`].
    #[must_use]
    #[inline(always)]
    pub const fn index(self) -> usize {
        Self::PLACES[self.side as usize][self.artifact as usize] as usize
    }

    /// Its stable name in files: the artifact's, told apart where it occurs on both sides.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match (self.artifact, self.side) {
            (Artifact::EdgeAliasing, Side::FalseShadow) => "edge-shadow",
            (Artifact::EdgeAliasing, Side::FalseLight) => "edge-light",
            (artifact, _) => artifact.name(),
        }
    }

    /// Whether it darkens truly lit receivers.
    #[must_use]
    pub const fn is_shadow(self) -> bool {
        matches!(self.side, Side::FalseShadow)
    }

    /// The name of a false shadow. `sound` tells whether the depth read is what the texel was drawn with
    /// ([`super::verdict::is_sound`]).
    #[must_use]
    pub const fn false_shadow(stored: StoredCaster, sound: bool) -> Self {
        match (stored, sound) {
            (StoredCaster::Cleared, _) | (_, false) => Self::ENCODING_FAULT,
            (StoredCaster::Own, true) => Self::ACNE,
            (StoredCaster::Occluder | StoredCaster::Other | StoredCaster::Culled, true) => {
                Self::EDGE_SHADOW
            }
        }
    }

    /// The name of a false light. `hidden` tells whether the bias alone hides the occluder.
    #[must_use]
    pub const fn false_light(stored: StoredCaster, hidden: bool) -> Self {
        match stored {
            StoredCaster::Occluder if hidden => Self::PETER_PANNING,
            StoredCaster::Own | StoredCaster::Cleared => Self::EDGE_LIGHT,
            StoredCaster::Occluder | StoredCaster::Other | StoredCaster::Culled => Self::LIGHT_LEAK,
        }
    }
}

impl std::fmt::Display for Kind {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(self.name())
    }
}

impl serde::Serialize for Kind {
    fn serialize<S: serde::Serializer>(&self, s: S) -> Result<S::Ok, S::Error> {
        s.serialize_str(self.name())
    }
}

/// What the map did to one counted receiver.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// The visibility equals the truth.
    Agree,
    /// The visibility differs from the truth.
    Wrong(Fault),
}

/// Kind and cause of a wrong verdict.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fault {
    /// Its side and what it is called.
    pub kind: Kind,
    /// The first rung from which it stays wrong to the end.
    pub cause: Rung,
}

impl Outcome {
    /// The fault of a wrong verdict.
    #[must_use]
    pub const fn fault(self) -> Option<Fault> {
        match self {
            Self::Agree => None,
            Self::Wrong(fault) => Some(fault),
        }
    }
}

/// The owner of the surface that the deciding texel holds.
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
    /// Whatever is there: every face that occludes the receiver is left out of the map.
    Culled,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_row_by_row() {
        use StoredCaster::{Cleared, Culled, Occluder, Other, Own};
        assert_eq!(Kind::false_shadow(Own, true), Kind::ACNE);
        assert_eq!(Kind::false_shadow(Other, true), Kind::EDGE_SHADOW);
        assert_eq!(Kind::false_shadow(Occluder, true), Kind::EDGE_SHADOW);
        assert_eq!(Kind::false_shadow(Cleared, true), Kind::ENCODING_FAULT);
        assert_eq!(Kind::false_shadow(Own, false), Kind::ENCODING_FAULT);
        assert_eq!(Kind::false_light(Occluder, true), Kind::PETER_PANNING);
        assert_eq!(Kind::false_light(Own, true), Kind::EDGE_LIGHT);
        assert_eq!(Kind::false_light(Cleared, false), Kind::EDGE_LIGHT);
        assert_eq!(Kind::false_light(Other, true), Kind::LIGHT_LEAK);
        assert_eq!(Kind::false_light(Occluder, false), Kind::LIGHT_LEAK);
        assert_eq!(Kind::false_light(Culled, true), Kind::LIGHT_LEAK);
    }

    #[test]
    fn every_artifact_on_each_of_its_sides_is_a_kind_with_a_name_of_its_own() {
        for (i, kind) in Kind::ALL.into_iter().enumerate() {
            assert_eq!(kind.index(), i);
            assert!(kind.artifact().sides().contains(&kind.side()), "{kind}");
            let alike = |other: &&Kind| other.name() == kind.name();
            assert_eq!(Kind::ALL.iter().filter(alike).count(), 1, "{kind}");
        }
        for artifact in Artifact::ALL {
            for side in artifact.sides() {
                let is = |k: &&Kind| (k.artifact(), k.side()) == (*artifact, *side);
                assert_eq!(Kind::ALL.iter().filter(is).count(), 1, "{artifact} {side}");
            }
        }
    }
}
