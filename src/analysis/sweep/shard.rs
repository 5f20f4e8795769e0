//! A sweep as work items: one case on one map size each.

use super::{CaseSweep, Field, Plan, Swept, sweep_size};
use crate::analysis::effort::Effort;
use rayon::prelude::*;
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::fmt::{self, Write};

/// Changes whenever the meaning of a stored result does.
const SCHEMA: &str = concat!("gnomon-sweep-items-3 ", env!("CARGO_PKG_VERSION"));

/// Every item in words, in order: the cases of the plan, under each its map sizes.
#[must_use]
pub fn items(plan: &Plan) -> Vec<String> {
    let of = |i: usize| format!("{} {}", plan.cases[i / plan.sizes.len()].name, size_of(plan, i));
    (0..plan.cases.len() * plan.sizes.len()).map(of).collect()
}

fn size_of(plan: &Plan, item: usize) -> u32 {
    plan.sizes[item % plan.sizes.len()]
}

/// SHA-256 (hex) of the whole plan: every axis, and of every case its geometry, light and pipeline.
///
/// `Debug` writes each float as its shortest text that reads back to the same bits, so plans with one
/// key are equal.
///
/// # Panics
/// Never: a digest takes any text.
#[must_use]
pub fn key(plan: &Plan) -> String {
    struct Text(Sha256);
    impl Write for Text {
        fn write_str(&mut self, text: &str) -> fmt::Result {
            self.0.update(text.as_bytes());
            Ok(())
        }
    }
    let mut text = Text(Sha256::new());
    write!(text, "{SCHEMA} {plan:?}").expect("a digest takes any text");
    text.0.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}

/// What one item gives: the sweeps of one case on one map size, and what is known of the case.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Part {
    /// World units per unit of window depth at the middle receiver.
    pub world_per_window: f64,
    /// Edge of a texel of the case's own map there, world units.
    pub texel_world: f64,
    /// Bias and predicted share of acne, as in [`CaseSweep::theory`].
    pub theory: Vec<(f32, f64)>,
    /// The first lines of every answer about the case.
    pub first_lines: Vec<String>,
    /// In the order of the plan: filters, formats, strategies.
    pub swept: Vec<Swept>,
}

/// Computes items. Those of one case share its receivers while they come one after the other.
#[derive(Debug)]
pub struct Worker<'p> {
    plan: &'p Plan,
    effort: Effort,
    field: Option<(usize, Field<'p>)>,
}

impl<'p> Worker<'p> {
    /// A worker on a plan; no result depends on the effort.
    #[must_use]
    pub const fn new(plan: &'p Plan, effort: Effort) -> Self {
        Self { plan, effort, field: None }
    }

    /// The result of one item; the same on every machine.
    ///
    /// # Panics
    /// If there is no such item.
    pub fn compute(&mut self, item: u32) -> Part {
        let (plan, item) = (self.plan, item as usize);
        let index = item / plan.sizes.len();
        let case = &plan.cases[index];
        if self.field.as_ref().is_none_or(|f| f.0 != index) {
            self.field = None;
            self.field = Some((index, Field::with(case, plan.step, self.effort)));
        }
        let (_, field) = self.field.as_ref().expect("it has just been set");
        let CaseSweep { world_per_window, texel_world, theory, first_lines, .. } =
            CaseSweep::of(field, plan);
        let one = |filter: &Option<_>| {
            let filter = filter.unwrap_or(case.lookup.filter);
            sweep_size(field, size_of(plan, item), filter, plan)
        };
        let swept: Vec<Vec<Swept>> = plan.filters.par_iter().map(one).collect();
        let swept = swept.into_iter().flatten().collect();
        Part { world_per_window, texel_world, theory, first_lines, swept }
    }
}

/// The sweeps of a plan from the results of its items; what is missing is left out.
#[must_use]
pub fn assemble(plan: &Plan, parts: BTreeMap<u32, Part>) -> Vec<CaseSweep> {
    let mut sweeps: Vec<CaseSweep> = plan.cases.iter().map(CaseSweep::named).collect();
    for (item, part) in parts {
        let sweep = &mut sweeps[item as usize / plan.sizes.len()];
        sweep.world_per_window = part.world_per_window;
        sweep.texel_world = part.texel_world;
        sweep.theory = part.theory;
        sweep.first_lines = part.first_lines;
        sweep.swept.extend(part.swept);
    }
    sweeps
}
