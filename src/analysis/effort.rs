//! How a measurement is made: by which truth, with which skips, and what they saved. No result
//! depends on it.

use crate::report::{Cell, Table};

crate::catalogue! {
    /// Who answers what receivers see.
    pub enum TruthBy {
        /// The irregular z-buffer: all receivers of the light in one pass.
        Raster = "raster",
        /// One ray after the other: the arbiter.
        Rays = "rays",
    }
}

/// How a measurement is made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Effort {
    /// Who answers what receivers see.
    pub truth: TruthBy,
    /// Whether what the scene does not need is left out.
    pub skip: bool,
}

impl Default for Effort {
    fn default() -> Self {
        Self { truth: TruthBy::Raster, skip: true }
    }
}

impl Effort {
    /// Every answer by its own ray, nothing left out: what skips are proved against.
    pub const ARBITER: Self = Self { truth: TruthBy::Rays, skip: false };
}

/// How many answers of one kind were given, and how many of them had to be worked out one by one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Count {
    /// What was asked.
    pub what: &'static str,
    /// Answers given.
    pub answered: u64,
    /// Answers worked out.
    pub evaluated: u64,
    /// Why the others need no work.
    pub because: &'static str,
}

/// The effort on the command line; flatten it into a binary's arguments.
#[derive(Clone, Copy, Debug, Default, clap::Args)]
pub struct EffortArguments {
    /// Who answers what receivers see; the results are the same
    #[arg(long, value_name = "raster|rays", default_value = "raster")]
    pub truth: TruthBy,
    /// Work everything out one by one; the results are the same
    #[arg(long)]
    pub no_skip: bool,
}

impl EffortArguments {
    /// As asked for.
    #[must_use]
    pub const fn effort(self) -> Effort {
        Effort { truth: self.truth, skip: !self.no_skip }
    }
}

#[allow(clippy::derivable_impls, reason = "a catalogue's members carry names, not attributes")]
impl Default for TruthBy {
    fn default() -> Self {
        Self::Raster
    }
}

/// What the skips saved, as a table for a report.
#[must_use]
pub fn table(id: &str, work: &[Count]) -> Table {
    let mut table = Table::new(id, "What was worked out, and what needed no work")
        .column("work", "", "")
        .column("answered", "", "answers given")
        .column("evaluated", "", "answers worked out one by one")
        .column("share", "", "evaluated of answered")
        .column("why the others need none", "", "");
    for count in work {
        table.push(vec![
            count.what.into(),
            Cell::count(count.answered),
            Cell::count(count.evaluated),
            match count.answered {
                0 => Cell::Missing,
                n => Cell::Percent(count.evaluated as f64 / n as f64),
            },
            count.because.into(),
        ]);
    }
    table
}
