//! Families without breakpoints: the literal counts value by value, on the receivers whose verdict can
//! still change, and thresholds by bisection.

use super::chart::{Attachment, Chart};
use super::swept::{Point, Swept};
use super::tally::{Kind, Tally};
use super::wrong::Wrong;
use crate::scene::TexelFormat;
use crate::shadow::bias::{Family, Layers, Recipe};
use rayon::prelude::*;

/// The literal counts at one amount, and which receivers are wrong there.
struct Evaluated {
    point: Point,
    wrong: Vec<Wrong>,
}

/// The receivers that are wrong at one of two amounts in a way that counts.
fn wrong_at(ends: [&Evaluated; 2], counts: impl Fn(Kind) -> bool) -> Vec<u32> {
    let wrong = ends.into_iter().flat_map(|e| &e.wrong).filter(|w| counts(w.kind));
    let mut which: Vec<u32> = wrong.map(|w| w.receiver).collect();
    which.sort();
    which.dedup();
    which
}

/// A strategy on a chart, to be evaluated at any amount.
struct Literal<'c, 'f, 'a> {
    chart: &'c Chart<'f, 'a>,
    format: TexelFormat,
    recipe: &'c (dyn Fn(f32) -> Recipe + Sync),
    all: &'c [u32],
}

impl Literal<'_, '_, '_> {
    /// The counts over the receivers of `which`.
    fn at(&self, amount: f32, which: &[u32]) -> Evaluated {
        let wrong = self.chart.wrong(&[self.format], &(self.recipe)(amount), which);
        self.counted(amount, wrong.into_iter().flatten().collect())
    }

    fn counted(&self, amount: f32, wrong: Vec<Wrong>) -> Evaluated {
        let (mut tally, mut gap) = (Tally::default(), 0.0f64);
        for w in &wrong {
            w.tally(&mut tally);
            if w.kind == Kind::PETER_PANNING {
                gap = gap.max(self.chart.field.samples[w.receiver as usize].inside);
            }
        }
        Evaluated { point: Point { amount, tally, gap }, wrong }
    }

    /// Whether more of the strategy only ever lights: the nearest surface's depth under a polygon offset
    /// grows with it, through every rounding (a depth texture is its own attachment and monotone).
    fn only_lights(&self) -> bool {
        let [recipe, more] = [1.0, 2.0].map(self.recipe);
        self.chart.field.skips()
            && Family::between(&recipe, &more) == Family::Map
            && recipe.layers == Layers::Nearest
            && recipe.oriented == 0.0
            && Attachment::of(self.format) == Attachment::Depth
    }

    /// Every amount, ascending, where more only lights: a receiver that is right at two amounts is right
    /// between them, and is left out there.
    fn grid(&self, amounts: &[f32]) -> Vec<Evaluated> {
        let last = amounts.len().saturating_sub(1);
        if last < 2 {
            return amounts.par_iter().map(|&a| self.at(a, self.all)).collect();
        }
        let [first, end] = [amounts[0], amounts[last]].map(|a| self.at(a, self.all));
        let inner = self.between(&first, &end, &amounts[1..last]);
        std::iter::once(first).chain(inner).chain(std::iter::once(end)).collect()
    }

    fn between(&self, low: &Evaluated, high: &Evaluated, amounts: &[f32]) -> Vec<Evaluated> {
        let Some(&amount) = amounts.get(amounts.len() / 2) else { return Vec::new() };
        let middle = self.at(amount, &wrong_at([low, high], |_| true));
        let (below, above) = amounts.split_at(amounts.len() / 2);
        let (mut list, above) = rayon::join(
            || self.between(low, &middle, below),
            || self.between(&middle, high, &above[1..]),
        );
        list.push(middle);
        list.extend(above);
        list
    }

    /// The two ends between which `wanted` begins to hold over the receivers of `which`, after
    /// [`BISECTIONS`] halvings of [without, with].
    fn narrow(&self, ends: [f32; 2], which: &[u32], wanted: impl Fn(&Tally) -> bool) -> [f32; 2] {
        let [mut without, mut with] = ends;
        for _ in 0..BISECTIONS {
            let middle = without + (with - without) * 0.5;
            if middle <= without || middle >= with {
                break;
            }
            let holds = wanted(&self.at(middle, which).point.tally);
            *(if holds { &mut with } else { &mut without }) = middle;
        }
        [without, with]
    }

    /// Where acne falls to the limit: bisected on the receivers that are dark at one of the ends, then
    /// held against all of them.
    fn acne_free(&self, below: &Evaluated, at: &Evaluated, limit: i64) -> Point {
        let quiet = |t: &Tally| t.of(Kind::ACNE) <= limit;
        let ends = [below.point.amount, at.point.amount];
        let dark = wrong_at([below, at], Kind::is_shadow);
        let [_, found] = self.narrow(ends, &dark, quiet);
        let point = self.at(found, self.all).point;
        if quiet(&point.tally) {
            return point;
        }
        let [_, found] = self.narrow(ends, self.all, quiet);
        self.at(found, self.all).point
    }

    /// Where the first shadow detaches: bisected on the receivers that are lit at one of the ends, then
    /// held against all of them.
    fn detachment(&self, below: &Evaluated, at: &Evaluated) -> f32 {
        let pans = |t: &Tally| t.of(Kind::PETER_PANNING) > 0;
        let ends = [below.point.amount, at.point.amount];
        let lit = wrong_at([below, at], |kind| !kind.is_shadow());
        let [without, found] = self.narrow(ends, &lit, pans);
        if without == ends[0] || !pans(&self.at(without, self.all).point.tally) {
            return found;
        }
        self.narrow(ends, self.all, pans)[1]
    }
}

/// Bisections of a threshold between two evaluated amounts: 2⁻¹⁰ of their distance.
const BISECTIONS: u32 = 10;

/// Every amount, ascending, of several formats, which share all that does not depend on them; the outer
/// list by format.
fn shared_grid(literals: &[Literal<'_, '_, '_>], amounts: &[f32]) -> Vec<Vec<Evaluated>> {
    let Some(Literal { chart, recipe, all, .. }) = literals.first() else { return Vec::new() };
    let formats: Vec<TexelFormat> = literals.iter().map(|l| l.format).collect();
    let at = |&amount: &f32| chart.wrong(&formats, &recipe(amount), all);
    let mut found: Vec<_> = amounts.par_iter().map(at).collect();
    let grid = |(k, literal): (usize, &Literal<'_, '_, '_>)| {
        let wrong = found.iter_mut().map(|formats| std::mem::take(&mut formats[k]));
        amounts.iter().zip(wrong).map(|(&a, wrong)| literal.counted(a, wrong)).collect()
    };
    literals.iter().enumerate().map(grid).collect()
}

/// Sweeps a strategy amount by amount in several formats of one chart.
pub(super) fn by_values(
    chart: &Chart<'_, '_>,
    swept: Vec<Swept>,
    amounts: &[f32],
    limit: i64,
) -> Vec<Swept> {
    let all = chart.all();
    let Some(strategy) = swept.first().map(|s| s.strategy) else { return swept };
    let recipe = |amount: f32| strategy.with(amount);
    let literal = |s: &Swept| Literal { chart, format: s.format, recipe: &recipe, all: &all };
    let (lighting, others): (Vec<_>, Vec<_>) =
        swept.into_iter().map(|s| (literal(&s), s)).partition(|(l, _)| l.only_lights());
    let (literals, bases): (Vec<_>, Vec<_>) = others.into_iter().unzip();
    let grids = shared_grid(&literals, amounts);
    let shared = literals.into_iter().zip(bases).zip(grids);
    let own = lighting.into_par_iter().map(|(literal, base)| {
        let grid = literal.grid(amounts);
        ((literal, base), grid)
    });
    let grids: Vec<_> = shared.chain(own.collect::<Vec<_>>()).collect();
    grids.into_par_iter().map(|((l, base), grid)| thresholds(&l, base, grid, limit)).collect()
}

/// What a grid says, its thresholds bisected.
fn thresholds(
    literal: &Literal<'_, '_, '_>,
    mut swept: Swept,
    grid: Vec<Evaluated>,
    limit: i64,
) -> Swept {
    (swept.acne_free, swept.detachment) = literal.thresholds(&grid, limit, true);
    swept.points = grid.into_iter().map(|e| e.point).collect();
    swept
}

impl Literal<'_, '_, '_> {
    /// Where acne ends for good and where the first shadow detaches: between two amounts by bisection,
    /// or at one of the grid.
    fn thresholds(
        &self,
        grid: &[Evaluated],
        limit: i64,
        between: bool,
    ) -> (Option<Point>, Option<f32>) {
        let loud = |e: &Evaluated| e.point.tally.of(Kind::ACNE) > limit;
        let free = grid.iter().rposition(loud).map_or(0, |i| i + 1);
        let acne_free = grid.get(free).map(|at| match free {
            1.. if between => self.acne_free(&grid[free - 1], at, limit),
            0.. => at.point,
        });
        let pans = |e: &Evaluated| e.point.tally.of(Kind::PETER_PANNING) > 0;
        let detachment = grid.iter().position(pans).map(|i| match i {
            1.. if between => self.detachment(&grid[i - 1], &grid[i]),
            0.. => grid[i].point.amount,
        });
        (acne_free, detachment)
    }
}

/// Points and thresholds of any recipe of one amount; between two amounts only where that is asked for.
pub(super) fn along(
    chart: &Chart<'_, '_>,
    format: TexelFormat,
    recipe: &(dyn Fn(f32) -> Recipe + Sync),
    amounts: &[f32],
    (limit, between): (i64, bool),
) -> (Vec<Point>, Option<Point>, Option<f32>) {
    let literal = Literal { chart, format, recipe, all: &chart.all() };
    let grid: Vec<Evaluated> = amounts.par_iter().map(|&a| literal.at(a, literal.all)).collect();
    let (acne_free, detachment) = literal.thresholds(&grid, limit, between);
    (grid.into_iter().map(|e| e.point).collect(), acne_free, detachment)
}
