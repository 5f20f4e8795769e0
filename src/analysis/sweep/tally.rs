//! Counts of wrong verdicts by kind, at one amount of bias or along all of them.

use crate::num::ordinal;

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

    const fn change(&mut self, entry: Entry, by: i64) {
        match entry {
            Entry::Kind(kind) => self.kinds[kind as usize] += by,
            Entry::Shadow => self.shadow += by,
            Entry::Light => self.light += by,
        }
    }
}

/// What a breakpoint changes: the receivers of a kind, or one of the sums of shares.
#[derive(Clone, Copy, Debug)]
enum Entry {
    Kind(Kind),
    Shadow,
    Light,
}

/// From `at` on, an entry changes by `change`: 16 bytes, since millions are sorted.
#[derive(Clone, Copy, Debug)]
struct Event {
    at: f32,
    entry: Entry,
    change: i64,
}

/// The counts at every amount ≥ 0: a step function given by its breakpoints.
#[derive(Clone, Debug, Default)]
pub struct Curve {
    base: Tally,
    events: Vec<Event>,
    /// Peter-panned receivers: from which amount on, and how far inside their true shadow.
    gaps: Vec<(f32, f64)>,
    /// Largest breakpoint of truly lit receivers that see their own surface alone and have acne at 0.
    pub critical: Option<f32>,
    /// Smallest breakpoint of truly shadowed receivers whose texel holds a true occluder.
    pub detachment: Option<f32>,
}

impl Curve {
    /// Counts `change` from `at` on: from the beginning where that is not positive, never where it is
    /// +∞.
    fn from(&mut self, at: f32, entry: Entry, change: i64) {
        if at <= 0.0 {
            self.base.change(entry, change);
        } else if at < f32::INFINITY {
            self.events.push(Event { at, entry, change });
        }
    }

    /// Counts one receiver of `kind` on [from, until).
    pub fn count(&mut self, kind: Kind, from: f32, until: f32) {
        if from < until && until > 0.0 {
            self.from(from, Entry::Kind(kind), 1);
            self.from(until, Entry::Kind(kind), -1);
        }
    }

    /// A tap with this share of a truly lit (or truly shadowed) receiver is lit from an amount on.
    pub fn lights(&mut self, truly_lit: bool, from: f32, share: i64) {
        if truly_lit {
            self.base.change(Entry::Shadow, share);
            self.from(from, Entry::Shadow, -share);
        } else {
            self.from(from, Entry::Light, share);
        }
    }

    /// A receiver `inside` world units deep in its true shadow is peter-panned from an amount on.
    pub fn panned(&mut self, from: f32, inside: f64) {
        self.gaps.push((from, inside));
    }

    /// The longest way inside the true shadow of any receiver that is peter-panned at each of
    /// `amounts`, which ascend; an upper bound where a later tap takes a verdict over.
    #[must_use]
    pub fn gaps_at(&self, amounts: &[f32]) -> Vec<f64> {
        let (mut longest, mut next) = (0.0f64, 0);
        let mut reach = |amount: f32| {
            while let Some(&(_, inside)) = self.gaps.get(next).filter(|g| g.0 <= amount) {
                longest = longest.max(inside);
                next += 1;
            }
            longest
        };
        amounts.iter().map(|&amount| reach(amount)).collect()
    }

    /// Puts the breakpoints in order; call once after all are in.
    #[must_use]
    pub fn sorted(mut self) -> Self {
        self.gaps.sort_unstable_by_key(|&(from, inside)| (ordinal(from), inside.to_bits()));
        self.events.sort_unstable_by_key(|event| ordinal(event.at));
        self
    }

    /// The counts at each of `amounts`, which ascend. One walk along all breakpoints.
    #[must_use]
    pub fn at(&self, amounts: &[f32]) -> Vec<Tally> {
        let (mut tally, mut next) = (self.base, 0);
        let mut reach = |amount: f32| {
            while let Some(event) = self.events.get(next).filter(|e| e.at <= amount) {
                tally.change(event.entry, event.change);
                next += 1;
            }
            tally
        };
        amounts.iter().map(|&amount| reach(amount)).collect()
    }

    /// The smallest amount ≥ 0 at which at most `limit` receivers are of one of `kinds`, and for every
    /// larger amount too; `None` where that never happens.
    #[must_use]
    pub fn quiet_from(&self, limit: i64, kinds: &[Kind]) -> Option<f32> {
        let sum = |tally: &Tally| kinds.iter().map(|&k| tally.of(k)).sum::<i64>();
        let mut tally = self.base;
        let mut from = (sum(&tally) <= limit).then_some(0.0f32);
        let mut events = self.events.iter().peekable();
        while let Some(event) = events.next() {
            tally.change(event.entry, event.change);
            if events.peek().is_some_and(|e| e.at == event.at) {
                continue;
            }
            match (sum(&tally) <= limit, from) {
                (true, None) => from = Some(event.at.max(0.0)),
                (false, _) => from = None,
                _ => {}
            }
        }
        from
    }

    /// The smallest amount ≥ 0 at which a receiver is of `kind`; `None` if there is none.
    #[must_use]
    pub fn first(&self, kind: Kind) -> Option<f32> {
        let mut tally = self.base;
        for (i, event) in self.events.iter().enumerate() {
            let settled = i == 0 || self.events[i - 1].at < event.at;
            if settled && event.at > 0.0 && tally.of(kind) > 0 {
                return Some(if i == 0 { 0.0 } else { self.events[i - 1].at.max(0.0) });
            }
            tally.change(event.entry, event.change);
        }
        let last = self.events.last().map_or(0.0, |e| e.at.max(0.0));
        (tally.of(kind) > 0).then_some(last)
    }

    /// Every positive breakpoint, ascending, each once.
    #[must_use]
    pub fn breakpoints(&self) -> Vec<f32> {
        let mut list: Vec<f32> = self.events.iter().map(|e| e.at).collect();
        list.dedup();
        list
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_counts_half_open_intervals() {
        let mut curve = Curve::default();
        curve.count(Kind::Acne, f32::NEG_INFINITY, 0.5);
        curve.count(Kind::Acne, f32::NEG_INFINITY, 0.25);
        curve.count(Kind::PeterPanning, 0.75, f32::INFINITY);
        let curve = curve.sorted();
        let acne: Vec<i64> =
            curve.at(&[0.0, 0.25, 0.4, 0.5, 1.0]).iter().map(|t| t.of(Kind::Acne)).collect();
        assert_eq!(acne, [2, 1, 1, 0, 0]);
        assert_eq!(curve.quiet_from(0, &[Kind::Acne]), Some(0.5));
        assert_eq!(curve.quiet_from(1, &[Kind::Acne]), Some(0.25));
        assert_eq!(curve.first(Kind::PeterPanning), Some(0.75));
        assert_eq!(curve.first(Kind::LightLeak), None);
        assert_eq!(curve.quiet_from(0, &[Kind::PeterPanning]), None);
    }
}
