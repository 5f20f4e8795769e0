//! Sweeps: every format, filter and bias strategy of a case from one raster per map size and one truth.
//!
//! [`field`] finds the receivers and their truth once. A [`chart`] draws the casters for one map size; it
//! knows which texels each receiver reads (`reads`), what is drawn (`drawn`, `maps`) and kept there (`store`).
//! [`evaluate`] takes a strategy along its amounts: biases of the taps by the breakpoints of all
//! receivers, many at a time (`receivers`, `block`, `margins`), counted in a [`curve`]; all others value
//! by value (`values`, [`wrong`]). The literal way keeps every comparison ([`looks`]): it is the arbiter.

mod block;
pub mod chart;
mod chosen;
pub mod curve;
mod drawn;
pub mod evaluate;
pub mod field;
pub mod gate;
pub mod guest;
mod layer;
pub mod looks;
mod maps;
mod margins;
mod moves;
mod moving;
pub mod pictures;
pub mod plan;
pub(super) mod plots;
mod reading;
mod reads;
mod receivers;
pub mod report;
mod results;
pub mod scales;
pub mod shard;
mod steps;
mod store;
mod stored;
mod swept;
pub mod tally;
pub mod taps;
mod theory;
mod turns;
mod values;
mod verdicts;
pub mod wrong;

use crate::analysis::effort::Effort;
use crate::scene::{Case, TexelFormat};
use crate::shadow::bias::Strategy;
use chart::{Attachment, Chart};
pub use evaluate::{Question, sweep};
pub use field::Field;
pub use plan::{Plan, Range};
use rayon::prelude::*;
pub use scales::{Scales, amounts};
pub use swept::{Point, Swept};

/// All sweeps of one case.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct CaseSweep {
    /// The case's name.
    pub name: String,
    /// The case's own format, which its bias was chosen for.
    pub own_format: &'static str,
    /// The case's own map size.
    pub own_size: u32,
    /// The case's own bias, window depth.
    pub own_bias: f32,
    /// World units per unit of window depth at the middle receiver.
    pub world_per_window: f64,
    /// Edge of a texel of the own map there, world units.
    pub texel_world: f64,
    /// Bias and predicted share of acne under NEAREST at the own map size, by the closed form of planes.
    pub theory: Vec<(f32, f64)>,
    /// The closed form of the critical bias, where the case has one.
    pub known_critical: Option<f64>,
    /// The first lines of every answer about the case: [`Field::first_lines`].
    pub first_lines: Vec<String>,
    /// In the order of the plan: sizes, filters, formats, strategies.
    pub swept: Vec<Swept>,
}

impl CaseSweep {
    /// A case of which nothing is known yet.
    #[must_use]
    pub fn named(case: &Case) -> Self {
        let known = case.facts.iter().find(|f| f.quantity == "critical_bias");
        Self {
            name: case.name.clone(),
            own_format: case.map.texel.name(),
            own_size: case.map.size,
            own_bias: case.bias,
            world_per_window: 1.0,
            texel_world: 0.0,
            theory: Vec::new(),
            known_critical: known.map(|f| f.value),
            first_lines: Vec::new(),
            swept: Vec::new(),
        }
    }

    /// A case at its middle receiver, not swept yet.
    #[must_use]
    pub fn of(field: &Field<'_>, plan: &Plan) -> Self {
        let base = Self::named(field.case());
        let site = field.middle().map(|s| field.site(s, &field.case().layout()));
        let base = Self { first_lines: field.first_lines(), ..base };
        let mut known = site.map_or(base.clone(), |site| Self {
            world_per_window: 1.0 / site.window_per_world,
            texel_world: site.texel_world,
            ..base
        });
        let biases = amounts(Strategy::Constant, &plan.bias, &Scales::default());
        let shares = theory::acne(field, known.own_size, &biases);
        known.theory = biases.into_iter().zip(shares).collect();
        known
    }
}

/// All formats and strategies of one size and filter: one chart for depth textures, one for packings.
fn sweep_size(
    field: &Field<'_>,
    size: u32,
    filter: crate::scene::Filter,
    plan: &Plan,
) -> Vec<Swept> {
    let chart = |attachment: Attachment| {
        let formats = || plan.formats.iter().filter(|&&f| Attachment::of(f) == attachment);
        let format = *formats().next()?;
        Some(Chart::new(field, size, format.usable(filter), attachment))
    };
    let (depth, colour) = rayon::join(|| chart(Attachment::Depth), || chart(Attachment::Colour));
    let on = |chart: &&Chart<'_, '_>| -> Vec<TexelFormat> {
        plan.formats.iter().copied().filter(|&f| Attachment::of(f) == chart.attachment).collect()
    };
    let charts: Vec<_> = [&depth, &colour].into_iter().flatten().map(|c| (c, on(&c))).collect();
    let of = |&strategy: &Strategy| {
        let together = |chart: &Chart<'_, '_>, formats: &[TexelFormat]| {
            let scales = Scales::on(field, size, formats[0], strategy);
            let amounts = amounts(strategy, &plan.bias, &scales);
            let question = Question { amounts: &amounts, max_acne: plan.max_acne };
            evaluate::sweep_formats(chart, formats, strategy, &question)
        };
        let all = |(chart, formats): &(&Chart<'_, '_>, Vec<TexelFormat>)| {
            let share = if scales::by_format(strategy) { 1 } else { formats.len().max(1) };
            formats.par_chunks(share).flat_map(|f| together(chart, f)).collect::<Vec<_>>()
        };
        charts.par_iter().flat_map(all).collect::<Vec<_>>()
    };
    let mut swept: Vec<Swept> = plan.strategies.par_iter().flat_map(of).collect();
    let format = |s: &Swept| plan.formats.iter().position(|&f| f == s.format);
    let strategy = |s: &Swept| plan.strategies.iter().position(|&t| t == s.strategy);
    swept.sort_by_key(|s| (format(s), strategy(s)));
    swept
}

/// Sweeps one case along all axes of a plan, whatever the plan's own cases are.
///
/// # Panics
/// Never: one case gives one sweep.
#[must_use]
pub fn sweep_case(case: &Case, plan: &Plan, done: &impl Fn()) -> CaseSweep {
    let alone = Plan { cases: vec![case.clone()], ..plan.clone() };
    run(&alone, done).pop().expect("one case gives one sweep")
}

/// Sweeps all cases of a plan; `done` is called after each case and map size.
///
/// ```
/// use gnomon::analysis::sweep::tally::Kind;
/// use gnomon::analysis::sweep::{self, Plan, Range, plan};
/// use gnomon::shadow::bias::Strategy;
///
/// let plan = Plan {
///     cases: plan::cases_named(&["upc".to_string()])?,
///     sizes: vec![64],
///     formats: vec![plan::format_named("unorm16")?],
///     filters: vec![None],
///     strategies: vec![Strategy::Constant],
///     bias: Range { low: 1e-6, high: 1e-1, log: true, count: 20 },
///     step: 8,
///     max_acne: 0.0,
/// }
/// .checked()?;
/// let sweeps = sweep::run(&plan, || ());
/// let constant = &sweeps[0].swept[0];
/// let ends = constant.acne_free.expect("some bias ends its acne");
/// assert_eq!(ends.tally.of(Kind::ACNE), 0);
/// println!("{} of window depth end acne, {:?} detaches", ends.amount, constant.detachment);
/// # Ok::<(), gnomon::Error>(())
/// ```
#[must_use]
pub fn run(plan: &Plan, done: impl Fn()) -> Vec<CaseSweep> {
    run_by(plan, Effort::default(), done)
}

/// Sweeps a plan like [`run`] by a given effort: `--truth`, `--no-skip`. No result depends on it.
#[must_use]
pub fn run_by(plan: &Plan, effort: Effort, done: impl Fn()) -> Vec<CaseSweep> {
    let mut worker = shard::Worker::new(plan, effort);
    let compute = |item: u32| {
        let part = worker.compute(item);
        done();
        (item, part)
    };
    shard::assemble(plan, (0..shard::items(plan).len() as u32).map(compute).collect())
}
