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
