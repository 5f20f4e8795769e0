//! Run time against error: what each format, map size, filter and bias strategy costs, and what is
//! left wrong with it.
//!
//! Costs are counted, not timed, so that they are the same on every machine: bytes of the map, passes
//! over the casters, texels fetched and arithmetic operations a look-up ([`cost`]). Errors are those at
//! the smallest amount of bias that ends acne, or where none does at the amount with the fewest wrong
//! verdicts. A combination is on the front where no other is at most as costly and at most as wrong in
//! everything and better in something. Measured times are another matter ([`time`]): they are printed,
//! and never part of a report.

pub mod algorithms;
pub mod cost;
pub mod report;
pub mod time;

use super::sweep::tally::{Kind, SHARE};
use super::sweep::{self, CaseSweep, Plan, Swept};
use crate::scene::{Filter, TexelFormat};
use crate::shadow::bias::{Strategy, Unit};
use cost::Cost;
use serde::Serialize;

/// What is left wrong.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LeftWrong {
    /// Share of their light that the truly lit lose: mean of 1 − v; `None` where there are none.
    pub false_shadow: Option<f64>,
    /// Share of light that the truly shadowed get: mean of v; `None` where there are none.
    pub false_light: Option<f64>,
    /// Longest way that a peter-panned receiver lies inside its true shadow, world units.
    pub peter_panning: f64,
}

/// One combination with its cost and its errors.
#[derive(Clone, Debug, Serialize)]
pub struct Combination {
    /// Case.
    pub case: String,
    /// Format or packing; its name in files.
    #[serde(serialize_with = "name")]
    pub format: TexelFormat,
    /// Texels per side.
    pub size: u32,
    /// Filter.
    pub filter: Filter,
    /// Bias strategy.
    pub strategy: Strategy,
    /// Its parameter.
    pub amount: f32,
    /// The parameter's unit.
    pub unit: Unit,
    /// Whether acne is within the limit; `None` where nothing is truly lit.
    pub acne_free: Option<bool>,
    /// What it costs.
    #[serde(flatten)]
    pub cost: Cost,
    /// What is left wrong.
    #[serde(flatten)]
    pub errors: LeftWrong,
    /// Whether nothing is at most as costly and as wrong, and better in something.
    pub front: bool,
}

fn name<S: serde::Serializer>(format: &TexelFormat, to: S) -> Result<S::Ok, S::Error> {
    to.serialize_str(format.name())
}

impl Combination {
    /// `None` where nothing was measured.
    fn new(case: &str, swept: &Swept) -> Option<Self> {
        if swept.populations == [0, 0] {
            return None;
        }
        let point = swept.acne_free.as_ref().or_else(|| swept.least())?;
        let share = |wrong: i64, of: u64| (of > 0).then(|| wrong as f64 / SHARE / of as f64);
        Some(Self {
            case: case.to_string(),
            format: swept.format,
            size: swept.size,
            filter: swept.filter,
            strategy: swept.strategy,
            amount: point.amount,
            unit: swept.strategy.unit(),
            acne_free: (swept.populations[0] > 0).then_some(swept.acne_free.is_some()),
            cost: Cost::of(swept.format, swept.size, swept.filter, swept.strategy),
            errors: LeftWrong {
                false_shadow: share(point.tally.shadow, swept.populations[0]),
                false_light: share(point.tally.light, swept.populations[1]),
                peter_panning: match point.tally.of(Kind::PETER_PANNING) {
                    0 => 0.0,
                    _ => point.gap,
                },
            },
            front: false,
        })
    }

    /// What is to be small, costs first.
    fn criteria(&self) -> [f64; 7] {
        let Cost { map_bytes, passes, fetches, operations } = self.cost;
        let LeftWrong { false_shadow, false_light, peter_panning } = self.errors;
        let costs =
            [map_bytes as f64, f64::from(passes), f64::from(fetches), f64::from(operations)];
        let [bytes, passes, fetches, operations] = costs;
        let [false_shadow, false_light] =
            [false_shadow, false_light].map(Option::unwrap_or_default);
        [bytes, passes, fetches, operations, false_shadow, false_light, peter_panning]
    }

    /// Share of wrong light of both kinds together, as far as they are measured.
    #[must_use]
    pub fn wrong(&self) -> f64 {
        self.errors.false_shadow.unwrap_or(0.0) + self.errors.false_light.unwrap_or(0.0)
    }
}

/// Whether `a` is at most `b` in everything and less in something.
fn dominates<const N: usize>(a: &[f64; N], b: &[f64; N]) -> bool {
    a.iter().zip(b).all(|(a, b)| a <= b) && a != b
}

/// Marks the members of the front of each case.
pub fn mark_front(entries: &mut [Combination]) {
    let criteria: Vec<_> = entries.iter().map(|e| (e.case.clone(), e.criteria())).collect();
    for (entry, (case, own)) in entries.iter_mut().zip(&criteria) {
        let better = |(other, c): &(String, [f64; 7])| other == case && dominates(c, own);
        entry.front = !criteria.iter().any(better);
    }
}

/// Filters looked at by default.
pub const FILTERS: [Filter; 2] = [Filter::Nearest, Filter::Pcf3];

/// Strategies looked at by default: one of each kind that engines ship.
pub const STRATEGIES: [Strategy; 5] = [
    Strategy::Constant,
    Strategy::SlopeRaster,
    Strategy::NormalOffset,
    Strategy::ReceiverPlane,
    Strategy::Midpoint,
];

/// Every combination of a plan with its cost and errors, the front marked, in the plan's order; `done` is
/// called after each case and map size.
///
/// ```
/// use gnomon::analysis::pareto;
/// use gnomon::analysis::sweep::{Plan, Range, plan};
/// use gnomon::shadow::bias::Strategy;
///
/// let plan = Plan {
///     cases: plan::cases_named(&["upc".to_string()])?,
///     sizes: vec![64, 128],
///     formats: vec![plan::format_named("unorm16")?],
///     filters: vec![None],
///     strategies: vec![Strategy::Constant, Strategy::SlopeRaster],
///     bias: Range { low: 1e-6, high: 1e-1, log: true, count: 20 },
///     step: 8,
///     max_acne: 0.001,
/// }
/// .checked()?;
/// let entries = pareto::entries(&plan, || ());
/// assert_eq!(entries.len(), 4);
/// for e in entries.iter().filter(|e| e.front) {
///     println!("{}² with {}: {} bytes, wrong {}", e.size, e.strategy, e.cost.map_bytes, e.wrong());
/// }
/// # Ok::<(), gnomon::Error>(())
/// ```
#[must_use]
pub fn entries(plan: &Plan, done: impl Fn()) -> Vec<Combination> {
    let of = |sweep: CaseSweep| {
        let entry = |swept: &Swept| Combination::new(&sweep.name, swept);
        sweep.swept.iter().filter_map(entry).collect::<Vec<_>>()
    };
    let mut entries: Vec<Combination> = sweep::run(plan, done).into_iter().flat_map(of).collect();
    mark_front(&mut entries);
    entries
}
