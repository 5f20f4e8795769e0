//! What is counted of wrong verdicts: *wrong*, *mean* and *seen* over receivers, *misplaced* and
//! *penumbra* of one.

use super::super::classify::Kind;
use super::{LookUp, SHARE, booked};
use glam::{DVec2, DVec3};

crate::catalogue! {
    /// How receivers with a wrong verdict are counted, each as a share of all counted ones.
    pub enum Measure {
        /// Receivers with any wrong share, however small.
        Wrong = "wrong",
        /// Σ|v − t|, v the visibility and t the truth (0 or 1).
        Mean = "mean",
        /// Σ max(N·L, 0)·|v − t| / Σ max(N·L, 0), N the unit normal that shades the side seen, L towards the light:
        /// what a white surface shows that only this light lights.
        Seen = "seen",
    }
}

/// A cosine in 2⁻⁴⁰, none below 0: sums of them do not depend on their order.
fn weight(cosine: f64) -> i128 {
    (cosine.clamp(0.0, 1.0) * SHARE) as i128
}

/// Sums over counted receivers, in integers: 2⁻⁴⁰ of one receiver, and 2⁻⁸⁰ where cosines weigh shares.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Counted {
    /// Receivers.
    receivers: u64,
    /// Receivers with any wrong share.
    wrong: u64,
    /// Σ max(N·L, 0).
    cosines: i128,
    /// Σ|v − t| by kind.
    error: [i128; Kind::COUNT],
    /// Σ max(N·L, 0)·|v − t| by kind.
    seen: [i128; Kind::COUNT],
}

impl Counted {
    /// Counts a receiver whose surface meets the light at `cosine` = N·L; every wrong share is booked to
    /// the artifact of its own part.
    pub fn add(&mut self, look: &impl LookUp, truly_lit: bool, cosine: f64) {
        let weight = weight(cosine);
        let mut is_wrong = false;
        booked(look, truly_lit, |kind, share| {
            is_wrong = true;
            self.error[kind.index()] += i128::from(share);
            self.seen[kind.index()] += weight * i128::from(share);
        });
        self.receivers += 1;
        self.wrong += u64::from(is_wrong);
        self.cosines += weight;
    }

    /// The sums over the receivers of both.
    #[must_use]
    pub fn joined(mut self, other: &Self) -> Self {
        self.receivers += other.receivers;
        self.wrong += other.wrong;
        self.cosines += other.cosines;
        self.error.iter_mut().zip(other.error).for_each(|(a, b)| *a += b);
        self.seen.iter_mut().zip(other.seen).for_each(|(a, b)| *a += b);
        self
    }

    /// A measure over all counted receivers; `None` where it has no population: not measured.
    #[must_use]
    pub fn of(&self, measure: Measure) -> Option<f64> {
        match measure {
            Measure::Wrong => ratio(self.wrong.into(), self.receivers.into(), 1.0),
            Measure::Mean => ratio(self.error.iter().sum(), self.receivers.into(), SHARE),
            Measure::Seen => ratio(self.seen.iter().sum(), self.cosines, SHARE),
        }
    }

    /// The part of *seen* that is of one kind; all of them add up to it.
    #[must_use]
    pub fn seen_of(&self, kind: Kind) -> Option<f64> {
        ratio(self.seen[kind.index()], self.cosines, SHARE)
    }
}

/// `sum` / `population` / `scale`, each step rounded to f64.
fn ratio(sum: i128, population: i128, scale: f64) -> Option<f64> {
    (population > 0).then(|| sum as f64 / population as f64 / scale)
}

/// Texels along an axis by which arithmetic must move a look-up before it is *misplaced*: from half a
/// texel on it reads another texel more often than not. A rounding across a texel's edge is none.
pub const MISPLACED: f64 = 0.5;

/// Whether arithmetic moved the look-up itself: the subject's coordinates lie [`MISPLACED`] texels or more
/// from the exact ones, along u or v, in a map of `size`² texels. Coordinates that are not numbers are.
#[must_use]
pub fn is_misplaced(exact: DVec2, looked: [f32; 2], size: u32) -> bool {
    let moved = (DVec2::from(looked.map(f64::from)) - exact) * f64::from(size);
    !(moved.x.abs() < MISPLACED && moved.y.abs() < MISPLACED)
}

/// Where the light's own ray through a tap, from `near` to `far`, meets the plane of a receiver; `None`
/// where they are parallel. World units, f64.
#[must_use]
pub fn on_plane(near: DVec3, far: DVec3, point: DVec3, normal: DVec3) -> Option<DVec3> {
    let ray = far - near;
    let t = normal.dot(point - near) / normal.dot(ray);
    t.is_finite().then(|| near + ray * t)
}

/// Whether a tap's error is *penumbra*: right for the point at which its own light ray meets the
/// receiver's plane ([`on_plane`]), and wrong for the receiver. No bias repairs it.
#[must_use]
pub const fn is_penumbra(tap_lit: bool, lit_at_its_point: bool, truly_lit: bool) -> bool {
    tap_lit == lit_at_its_point && tap_lit != truly_lit
}
