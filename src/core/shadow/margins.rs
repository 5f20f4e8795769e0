//! Many comparisons at once: from which amount of bias on each is lit.
#![allow(clippy::needless_range_loop, reason = "loops over indices become vectors")]

use super::breakpoint_where;
use crate::num::{from_ordinal, ordinal};
use crate::scene::CompareRule;
use crate::simd::{Kernel, Level};

/// Comparisons side by side, 12 bytes each, whose bias grows with an amount a: min(a · weight, bound).
/// All lists are of one length.
#[derive(Clone, Copy, Debug)]
pub struct Margins<'m> {
    /// Receiver depths.
    pub z: &'m [f32],
    /// Stored depths.
    pub stored: &'m [f32],
    /// Window depth per unit of the amount; not negative.
    pub weight: &'m [f32],
    /// No bias is larger.
    pub bound: f32,
}

/// The bias at an amount, each operation rounded to f32.
#[must_use]
#[inline(always)]
pub fn biased(amount: f32, weight: f32, bound: f32) -> f32 {
    let product = amount * weight;
    if product < bound { product } else { bound }
}

impl Margins<'_> {
    /// Whether the literal rule says lit of each comparison at an amount.
    ///
    /// # Panics
    /// When the machine lacks the level, or lists differ in length.
    pub fn lit(&self, level: Level, rule: CompareRule, amount: f32, out: &mut [bool]) {
        self.under(rule, out.len(), Lit { level, amount, out });
    }

    /// The smallest finite amount from which each comparison is lit by the literal rule: +∞ where none
    /// lights it, −∞ where all do. Bit for bit [`breakpoint_where`] of each.
    ///
    /// # Panics
    /// When the machine lacks the level, or lists differ in length.
    pub fn breakpoints(&self, level: Level, rule: CompareRule, out: &mut [f32]) {
        self.under(rule, out.len(), Turns { level, out });
    }

    /// Does something with all comparisons under a rule that is known when it is compiled.
    fn under(&self, rule: CompareRule, len: usize, job: impl Job) {
        let Self { z, stored, weight, .. } = self;
        assert!([z.len(), stored.len(), weight.len()] == [len; 3], "lists of one length");
        match rule {
            CompareRule::ReceiverBeyond => job.run(Compared::<0>(*self)),
            CompareRule::NotStoredBeyond => job.run(Compared::<1>(*self)),
            CompareRule::StoredAtMost => job.run(Compared::<2>(*self)),
            CompareRule::NotReceiverBefore => job.run(Compared::<3>(*self)),
        }
    }
}

/// The smallest finite amount whose bias min(a · weight, bound) reaches each gap; +∞ where none does,
/// −∞ where all do. Bit for bit [`breakpoint_where`] of each.
///
/// # Panics
/// When the machine lacks the level, or lists differ in length.
pub fn reaching(level: Level, gap: &[f64], weight: &[f32], bound: f32, out: &mut [f32]) {
    assert!([gap.len(), weight.len()] == [out.len(); 2], "lists of one length");
    Turns { level, out }.run(Reached { gap, weight, bound });
}

/// Conditions that hold from some amount on, each of its own.
trait Turning: Copy {
    /// The first `len` of them: so many, the compiler knows.
    fn first(self, len: usize) -> Self;
    /// About where condition k begins to hold.
    fn guess(&self, k: usize) -> f32;
    /// Whether it holds; monotone in the amount.
    fn holds(&self, k: usize, amount: f32) -> bool;
}

/// What is done with many conditions.
trait Job {
    fn run(self, turning: impl Turning);
}

/// Comparisons under the rule of this place in the catalogue.
#[derive(Clone, Copy)]
struct Compared<'c, const RULE: usize>(Margins<'c>);

/// An amount that gives about this bias.
#[inline(always)]
fn amount(bias: f32, weight: f32) -> f32 {
    bias / if weight > 0.0 { weight } else { 1.0 }
}

impl<const RULE: usize> Turning for Compared<'_, RULE> {
    #[inline(always)]
    fn first(self, len: usize) -> Self {
        let Margins { z, stored, weight, bound } = self.0;
        let [z, stored, weight] = [&z[..len], &stored[..len], &weight[..len]];
        Self(Margins { z, stored, weight, bound })
    }

    #[inline(always)]
    fn guess(&self, k: usize) -> f32 {
        let Margins { z, stored, weight, .. } = self.0;
        amount(CompareRule::ALL[RULE].turning_point(z[k], stored[k]), weight[k])
    }

    #[inline(always)]
    fn holds(&self, k: usize, amount: f32) -> bool {
        let Margins { z, stored, weight, bound } = self.0;
        CompareRule::ALL[RULE].is_lit(z[k], stored[k], biased(amount, weight[k], bound))
    }
}

#[derive(Clone, Copy)]
struct Reached<'r> {
    gap: &'r [f64],
    weight: &'r [f32],
    bound: f32,
}

impl Turning for Reached<'_> {
    #[inline(always)]
    fn first(self, len: usize) -> Self {
        Self { gap: &self.gap[..len], weight: &self.weight[..len], bound: self.bound }
    }

    #[inline(always)]
    fn guess(&self, k: usize) -> f32 {
        amount(self.gap[k] as f32, self.weight[k])
    }

    #[inline(always)]
    fn holds(&self, k: usize, amount: f32) -> bool {
        f64::from(biased(amount, self.weight[k], self.bound)) >= self.gap[k]
    }
}

/// Asks of each condition whether it holds at one amount.
struct Lit<'l> {
    level: Level,
    amount: f32,
    out: &'l mut [bool],
}

impl Job for Lit<'_> {
    fn run(self, turning: impl Turning) {
        let Self { level, amount, out } = self;
        level.run(Holds { turning, amount, out });
    }
}

struct Holds<'h, T> {
    turning: T,
    amount: f32,
    out: &'h mut [bool],
}

impl<T: Turning> Kernel for Holds<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run(self, _: bool) {
        let Self { turning, amount, out } = self;
        let turning = turning.first(out.len());
        for k in 0..out.len() {
            out[k] = turning.holds(k, amount);
        }
    }
}

/// Finds where each condition begins to hold: near its guess by vectors, elsewhere one by one.
struct Turns<'t> {
    level: Level,
    out: &'t mut [f32],
}

impl Job for Turns<'_> {
    fn run(self, turning: impl Turning) {
        let Self { level, out } = self;
        level.run(Near { turning, out: &mut *out });
        for (k, found) in out.iter_mut().enumerate().filter(|(_, found)| found.is_nan()) {
            *found = breakpoint_where(turning.guess(k), |amount| turning.holds(k, amount));
        }
    }
}

/// Whether condition k holds so many floats beyond `middle`.
#[inline(always)]
fn beyond<T: Turning>(turning: &T, k: usize, middle: i32, steps: i32) -> bool {
    turning.holds(k, from_ordinal(middle.wrapping_add(steps)))
}

/// Looks at six neighbouring amounts around each guess; NaN where the condition turns at none of them.
struct Near<'n, T> {
    turning: T,
    out: &'n mut [f32],
}

impl<T: Turning> Kernel for Near<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run(self, _: bool) {
        let Self { turning, out } = self;
        let turning = turning.first(out.len());
        for k in 0..out.len() {
            let guess = turning.guess(k);
            let small = guess.abs() < f32::MAX / 2.0;
            let middle = ordinal(if small { guess } else { 0.0 });
            // The condition is monotone: it holds from the first neighbour that is not dark.
            let mut dark = 0;
            for steps in -2..2 {
                dark += i32::from(!beyond(&turning, k, middle, steps));
            }
            let turns = small & !beyond(&turning, k, middle, -3) & beyond(&turning, k, middle, 2);
            let found = from_ordinal(middle.wrapping_add(dark).wrapping_sub(2));
            out[k] = if turns { found } else { f32::NAN };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pairs of depths: random ones, near ones, equal ones, and what no depth should be.
    fn pairs() -> impl Iterator<Item = (f32, f32)> {
        let mut seed = 5u32;
        let mut random = move || {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            seed
        };
        let odd = [0.0, -0.0, 1.0, 0.5, 1e-40, -0.25, 2.5, f32::MAX, f32::INFINITY, f32::NAN];
        let drawn = (0..20_000).map(move |_| {
            let [z, near] = [random(), random()].map(|bits| (bits >> 8) as f32 / 16_777_216.0);
            let steps = (random() >> 22) as i32 - 512;
            let stored = match random() >> 30 {
                0 => near,
                1 => z + (near - 0.5) * 1e-3,
                _ => from_ordinal(ordinal(z) + steps),
            };
            (z, stored)
        });
        drawn.chain(odd.into_iter().flat_map(move |z| odd.map(|stored| (z, stored))))
    }

    fn levels() -> impl Iterator<Item = Level> {
        Level::ALL.iter().copied().filter(|level| level.is_available())
    }

    /// Weights and bounds of a bias: none, tiny, usual, huge.
    const BIASES: [(f32, f32); 6] = [
        (1.0, f32::INFINITY),
        (3.1e-4, f32::INFINITY),
        (1.0 / 65_535.0, 0.01),
        (1.7e-3, 1e-3),
        (0.0, f32::INFINITY),
        (f32::MAX, f32::INFINITY),
    ];

    #[test]
    fn many_breakpoints_are_those_of_each() {
        let (z, stored): (Vec<f32>, Vec<f32>) = pairs().unzip();
        let mut out = vec![0.0; z.len()];
        for (level, &rule) in levels().flat_map(|l| CompareRule::ALL.iter().map(move |r| (l, r))) {
            for (w, bound) in BIASES {
                let weight = vec![w; z.len()];
                let margins = Margins { z: &z, stored: &stored, weight: &weight, bound };
                margins.breakpoints(level, rule, &mut out);
                for (k, &found) in out.iter().enumerate() {
                    let (z, stored) = (z[k], stored[k]);
                    let lit = |a: f32| rule.is_lit(z, stored, (a * w).min(bound));
                    let one = breakpoint_where(rule.turning_point(z, stored), lit);
                    assert_eq!(found.to_bits(), one.to_bits(), "{level} {rule} {z} {stored} {w}");
                }
                let mut says = vec![false; z.len()];
                for amount in [0.0, 1e-4, 0.25, 3.0] {
                    margins.lit(level, rule, amount, &mut says);
                    for (k, &lit) in says.iter().enumerate() {
                        let one = rule.is_lit(z[k], stored[k], (amount * w).min(bound));
                        assert_eq!(lit, one, "{level} {rule} {} {} at {amount}", z[k], stored[k]);
                    }
                }
            }
        }
    }

    #[test]
    fn many_gaps_are_reached_where_each_is() {
        let gap: Vec<f64> = pairs().map(|(z, d)| f64::from(z) - f64::from(d) * 0.9).collect();
        let mut out = vec![0.0; gap.len()];
        for (level, (w, bound)) in levels().flat_map(|l| BIASES.map(|b| (l, b))) {
            reaching(level, &gap, &vec![w; gap.len()], bound, &mut out);
            for (&gap, found) in gap.iter().zip(&out) {
                let one = breakpoint_where(gap as f32, |a| f64::from((a * w).min(bound)) >= gap);
                assert_eq!(found.to_bits(), one.to_bits(), "{level} {gap} {w}");
            }
        }
    }
}
