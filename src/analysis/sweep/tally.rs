//! Counts of wrong verdicts by kind.

pub use crate::analysis::classify::{Kind, Side};
pub use crate::analysis::verdict::SHARE;

/// Wrong verdicts at one amount.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// Receivers by [`Kind::index`].
    pub kinds: [i64; Kind::COUNT],
    /// Σ(1 − v) over truly lit receivers, in 2⁻⁴⁰.
    pub shadow: i64,
    /// Σ v over truly shadowed receivers, in 2⁻⁴⁰.
    pub light: i64,
}

impl Tally {
    /// Receivers of one kind.
    #[must_use]
    pub const fn of(&self, kind: Kind) -> i64 {
        self.kinds[kind.index()]
    }

    /// Receivers that are wrong to one side.
    fn on(&self, side: Side) -> i64 {
        Kind::ALL.into_iter().filter(|kind| kind.side() == side).map(|kind| self.of(kind)).sum()
    }

    /// Truly lit receivers that are not fully lit.
    #[must_use]
    pub fn false_shadow(&self) -> i64 {
        self.on(Side::FalseShadow)
    }

    /// Truly shadowed receivers that are not fully dark.
    #[must_use]
    pub fn false_light(&self) -> i64 {
        self.on(Side::FalseLight)
    }
}
