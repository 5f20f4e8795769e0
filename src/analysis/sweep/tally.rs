//! Counts of wrong verdicts by kind.

crate::catalogue! {
    /// A kind of wrong verdict, told apart by the side of the error.
    pub enum Kind {
        /// False shadow by the receiver's own surface.
        Acne = "acne",
        /// False shadow because the texel's centre sees another surface.
        EdgeShadow = "edge-shadow",
        /// False shadow by a cleared texel or a depth that no sound encoding returns.
        EncodingFault = "encoding-fault",
        /// False light because the bias hides the occluder.
        PeterPanning = "peter-panning",
        /// False light because the texel's centre misses the occluder.
        EdgeLight = "edge-light",
        /// False light past a thin, culled or wrongly stored caster.
        LightLeak = "light-leak",
    }
}

impl Kind {
    /// Whether it darkens truly lit receivers.
    #[must_use]
    pub const fn is_shadow(self) -> bool {
        matches!(self, Self::Acne | Self::EdgeShadow | Self::EncodingFault)
    }
}

/// Shares of visibility are summed as integers of 2⁻⁴⁰, so that sums do not depend on their order.
pub const SHARE: f64 = 1_099_511_627_776.0;

/// Wrong verdicts at one amount.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// Receivers by [`Kind`].
    pub kinds: [i64; 6],
    /// Σ(1 − v) over truly lit receivers, in 2⁻⁴⁰.
    pub shadow: i64,
    /// Σ v over truly shadowed receivers, in 2⁻⁴⁰.
    pub light: i64,
}

impl Tally {
    /// Receivers of one kind.
    #[must_use]
    pub const fn of(&self, kind: Kind) -> i64 {
        self.kinds[kind as usize]
    }

    /// Truly lit receivers that are not fully lit.
    #[must_use]
    pub const fn false_shadow(&self) -> i64 {
        self.kinds[0] + self.kinds[1] + self.kinds[2]
    }

    /// Truly shadowed receivers that are not fully dark.
    #[must_use]
    pub const fn false_light(&self) -> i64 {
        self.kinds[3] + self.kinds[4] + self.kinds[5]
    }
}
