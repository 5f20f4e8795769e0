//! Numerical stress: where shadow mapping breaks, against an onset that theory gives beforehand.
//!
//! A [`Stress`] drives one parameter to its extreme. Each of its rows states a [`Forecast`] *before*
//! anything is drawn: from which value of the parameter on something stops holding, by formula. The
//! run then measures that value on the subject's own code (raster, stores, look-ups), and the
//! [`Row`] keeps both with the curve of the error and the theory beside it.

mod clipping;
mod coverage;
mod degenerate;
mod depth_clamp;
mod depths;
pub mod document;
mod grazing;
mod grid;
mod mediump;
mod origin;
mod range;
mod row;
mod sampling;
mod search;
mod sheet;
mod ties;
mod up;
mod winding;

pub use row::{AGREEMENT, Fate, Forecast, Row, Stress};
pub use sheet::Sheet;

use rayon::prelude::*;

/// How many samples a supremum over phases takes, and the seed of every random choice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sampling {
    /// Samples of a phase.
    pub samples: u32,
    /// Seed.
    pub seed: u64,
}

/// The stresses in report order.
const ALL: &[fn(&Sampling) -> Stress] = &[
    range::distances,
    range::ratios,
    origin::spacing,
    origin::transform,
    origin::moved_plane,
    grazing::constant,
    grazing::normal_offset,
    grazing::edge_on,
    coverage::slivers,
    coverage::junctions,
    coverage::counts,
    clipping::behind,
    clipping::border,
    clipping::near_plane,
    depth_clamp::casters_before_near,
    up::parallel,
    depths::vanishing,
    depths::one,
    ties::comparisons,
    sampling::commensurate,
    mediump::coordinates,
    mediump::digits,
    mediump::overflow,
    degenerate::sets_on_devices,
    degenerate::clip_scale,
];

/// How many stresses there are.
#[must_use]
pub fn count() -> usize {
    ALL.len()
}

/// Runs every stress, in report order; `done` is called after each.
///
/// ```
/// use gnomon::stress::{Sampling, run};
///
/// let stresses = run(&Sampling { samples: 8, seed: 1 }, || ());
/// let rows = || stresses.iter().flat_map(|stress| &stress.rows);
/// for row in rows().filter(|row| row.measured.is_some()).take(3) {
///     println!("{}: {} ({:?} by theory)", row.forecast.name, row.verdict(), row.forecast.onset);
/// }
/// assert!(rows().any(|row| row.agrees()));
/// ```
#[must_use]
pub fn run(effort: &Sampling, done: impl Fn() + Sync) -> Vec<Stress> {
    let one = |stress: &fn(&Sampling) -> Stress| {
        let stress = stress(effort);
        done();
        stress
    };
    ALL.par_iter().map(one).collect()
}
