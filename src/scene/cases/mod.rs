//! Named cases: the documents' systems and the scenes whose answers are known in closed form.

pub mod analytic;
pub mod documents;

use super::Case;
use crate::{Error, Result};

/// Every named case, in report order: the documents' first.
#[must_use]
pub fn all() -> Vec<Case> {
    let mut cases = documents::all();
    cases.extend(analytic::all());
    cases
}

/// The closed forms that the main job shows beside the documents' systems.
const SHOWN: [&str; 4] = ["t1-tilted-plane", "t4-wall", "t7-sphere", "t11-plates"];

/// The cases of the main job: the documents' systems, and one closed form of each kind.
#[must_use]
pub fn main_job() -> Vec<Case> {
    let shown = |case: &Case| SHOWN.contains(&case.name.as_str());
    let mut cases = documents::all();
    cases.extend(all().into_iter().skip(cases.len()).filter(shown));
    cases
}

/// The case of that name.
///
/// # Errors
/// [`Error::BadInput`] listing the names.
pub fn named(name: &str) -> Result<Case> {
    let cases = all();
    let names = cases.iter().map(|case| case.name.clone()).collect::<Vec<_>>().join(", ");
    cases.into_iter().find(|case| case.name == name).ok_or_else(|| {
        Error::bad_input(format!("--case '{name}'"), "no such case", format!("use one of {names}"))
    })
}
