//! Counts of wrong verdicts along all amounts of a bias: step functions, given by their breakpoints.

use super::steps::{Shares, Steps, sort};
use super::tally::{Kind, SHARE, Tally};
use rayon::prelude::*;

/// The counts at every amount ≥ 0.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SweptCurve {
    /// Receivers by [`Kind`].
    kinds: [Steps; Kind::COUNT],
    /// Shares of the taps of truly lit and of truly shadowed receivers; `None` while every look-up has one tap,
    /// whose share is all of it.
    shares: Option<[Shares; 2]>,
    /// Peter-panned receivers: from which amount on, and how far inside their true shadow.
    gaps: Vec<(f32, f64)>,
    /// Largest breakpoint of truly lit receivers that see their own surface alone and have acne at 0.
    pub critical: Option<f32>,
}

impl SweptCurve {
    /// A curve without receivers, for look-ups with one tap each or with any number.
    #[must_use]
    pub fn new(single_taps: bool) -> Self {
        Self { shares: (!single_taps).then(Default::default), ..Self::default() }
    }

    /// Counts one receiver of `kind` on [from, until).
    pub fn count(&mut self, kind: Kind, from: f32, until: f32) {
        if from < until && until > 0.0 {
            self.kinds[kind.index()].count(from, until);
        }
    }

    /// A tap with this share of a truly lit (or truly shadowed) receiver is lit from an amount on.
    pub fn lights(&mut self, truly_lit: bool, from: f32, share: impl Fn() -> i64) {
        if let Some(shares) = &mut self.shares {
            shares[usize::from(!truly_lit)].add(from, share());
        }
    }

    /// A receiver `inside` world units deep in its true shadow is peter-panned from an amount on.
    pub fn panned(&mut self, from: f32, inside: f64) {
        self.gaps.push((from, inside));
    }

    /// A truly lit receiver that sees its own surface alone is dark up to an amount.
    pub fn needs(&mut self, until: f32) {
        self.critical = Some(self.critical.map_or(until, |most| most.max(until)));
    }

    /// The counts of both, which are of look-ups of the same filter.
    #[must_use]
    pub fn joined(mut self, other: &Self) -> Self {
        self.kinds.iter_mut().zip(&other.kinds).for_each(|(all, some)| all.join(some));
        if let (Some(all), Some(some)) = (&mut self.shares, &other.shares) {
            all.iter_mut().zip(some).for_each(|(all, some)| all.join(some));
        }
        self.gaps.extend(&other.gaps);
        other.critical.into_iter().for_each(|until| self.needs(until));
        self
    }

    /// Puts the breakpoints in order; call once after all are in.
    #[must_use]
    pub fn sorted(mut self) -> Self {
        self.kinds.par_iter_mut().for_each(Steps::sort);
        self.shares.iter_mut().flatten().for_each(Shares::sort);
        self.thinned()
    }

    /// Leaves out the gaps that are not longer than all before them: no answer depends on them.
    #[must_use]
    pub fn thinned(mut self) -> Self {
        self.gaps.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(b.1.total_cmp(&a.1)));
        let mut longest = f64::NEG_INFINITY;
        self.gaps.retain(|&(_, inside)| {
            let longer = inside > longest;
            longest = longest.max(inside);
            longer
        });
        self
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

    /// The counts at each of `amounts`, which ascend. One walk along all breakpoints.
    #[must_use]
    pub fn at(&self, amounts: &[f32]) -> Vec<Tally> {
        let mut tallies = vec![Tally::default(); amounts.len()];
        for (kind, steps) in self.kinds.iter().enumerate() {
            tallies.iter_mut().zip(steps.at(amounts)).for_each(|(t, n)| t.kinds[kind] = n);
        }
        match &self.shares {
            Some([lit, shadowed]) => {
                let light = lit.at(amounts).zip(shadowed.at(amounts));
                tallies.iter_mut().zip(light).for_each(|(t, (lit_light, light))| {
                    (t.shadow, t.light) = (lit.all - lit_light, light);
                });
            }
            None => {
                let whole = SHARE as i64;
                tallies.iter_mut().for_each(|t| {
                    (t.shadow, t.light) = (t.false_shadow() * whole, t.false_light() * whole);
                });
            }
        }
        tallies
    }

    /// The smallest amount ≥ 0 at which at most `limit` receivers are of `kind`, and for every larger
    /// amount too; `None` where that never happens.
    #[must_use]
    pub fn quiet_from(&self, limit: i64, kind: Kind) -> Option<f32> {
        self.kinds[kind.index()].quiet_from(limit)
    }

    /// The smallest amount ≥ 0 at which a receiver is of `kind`; `None` if there is none.
    #[must_use]
    pub fn first(&self, kind: Kind) -> Option<f32> {
        self.kinds[kind.index()].first()
    }

    /// Every positive breakpoint, ascending, each once.
    #[must_use]
    pub fn breakpoints(&self) -> Vec<f32> {
        let kinds = self.kinds.iter().flat_map(|steps| steps.up.iter().chain(&steps.down));
        let shares = self.shares.iter().flatten().flat_map(|shares| &shares.at);
        let mut list: Vec<f32> = kinds.chain(shares).copied().collect();
        sort(&mut list);
        list.dedup();
        list
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_counts_half_open_intervals() {
        let mut curve = SweptCurve::new(true);
        curve.count(Kind::ACNE, f32::NEG_INFINITY, 0.5);
        curve.count(Kind::ACNE, f32::NEG_INFINITY, 0.25);
        curve.count(Kind::PETER_PANNING, 0.75, f32::INFINITY);
        let curve = curve.sorted();
        let acne: Vec<i64> =
            curve.at(&[0.0, 0.25, 0.4, 0.5, 1.0]).iter().map(|t| t.of(Kind::ACNE)).collect();
        assert_eq!(acne, [2, 1, 1, 0, 0]);
        assert_eq!(curve.quiet_from(0, Kind::ACNE), Some(0.5));
        assert_eq!(curve.quiet_from(1, Kind::ACNE), Some(0.25));
        assert_eq!(curve.quiet_from(2, Kind::ACNE), Some(0.0));
        assert_eq!(curve.first(Kind::PETER_PANNING), Some(0.75));
        assert_eq!(curve.first(Kind::LIGHT_LEAK), None);
        assert_eq!(curve.quiet_from(0, Kind::PETER_PANNING), None);
        let full = SHARE as i64;
        let shares: Vec<_> = curve.at(&[0.25, 0.8]).iter().map(|t| (t.shadow, t.light)).collect();
        assert_eq!(shares, [(full, 0), (0, full)]);
    }

    #[test]
    fn what_comes_and_goes_at_one_amount_is_never_there() {
        let mut curve = SweptCurve::new(true);
        curve.count(Kind::LIGHT_LEAK, 0.25, 0.5);
        curve.count(Kind::LIGHT_LEAK, 0.5, 0.75);
        curve.count(Kind::LIGHT_LEAK, 0.1, 0.1);
        let curve = curve.sorted();
        assert_eq!(curve.first(Kind::LIGHT_LEAK), Some(0.25));
        assert_eq!(curve.quiet_from(0, Kind::LIGHT_LEAK), Some(0.75));
        assert_eq!(curve.quiet_from(1, Kind::LIGHT_LEAK), Some(0.0));
        assert_eq!(curve.breakpoints(), [0.25, 0.5, 0.75]);
    }

    #[test]
    fn shares_are_summed_whether_alike_or_not() {
        let taps = [(-1.0, 5), (0.25, 5), (0.5, 5), (0.5, 7), (f32::INFINITY, 3), (0.75, 5)];
        let mut alone = SweptCurve::new(false);
        taps.iter().for_each(|&(from, share)| alone.lights(true, from, || share));
        let some = |taps: &[(f32, i64)]| {
            let mut curve = SweptCurve::new(false);
            taps.iter().for_each(|&(from, share)| curve.lights(true, from, || share));
            curve
        };
        for split in 0..=taps.len() {
            let (a, b) = taps.split_at(split);
            let curve = some(a).joined(&some(b)).sorted();
            let dark = |t: &Tally| t.shadow;
            let found: Vec<i64> = curve.at(&[0.0, 0.3, 0.5, 1.0]).iter().map(dark).collect();
            assert_eq!(found, [25, 20, 8, 3], "split at {split}");
        }
        assert_eq!(alone.sorted().breakpoints(), [0.25, 0.5, 0.75]);
    }

    #[test]
    fn only_gaps_longer_than_those_before_are_kept() {
        let mut curve = SweptCurve::new(true);
        for (from, inside) in [(0.3, 2.0), (0.1, 1.0), (0.2, 0.5), (0.1, 0.75), (0.4, 2.0)] {
            curve.panned(from, inside);
        }
        let curve = curve.sorted();
        assert_eq!(curve.gaps, [(0.1, 1.0), (0.3, 2.0)]);
        assert_eq!(curve.gaps_at(&[0.0, 0.1, 0.25, 0.3, 9.0]), [0.0, 1.0, 1.0, 2.0, 2.0]);
    }
}
