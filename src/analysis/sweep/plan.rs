//! What is swept: axes as flags give them, checked before anything runs.

use crate::analysis::need::Need;
use crate::scene::{Case, Filter, TexelFormat, cases};
use crate::shadow::bias::Strategy;
use crate::{Error, Result};
use std::collections::BTreeSet;

/// The axes of a sweep.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Cases.
    pub cases: Vec<Case>,
    /// Map sizes.
    pub sizes: Vec<u32>,
    /// Formats.
    pub formats: Vec<TexelFormat>,
    /// Filters; `None` is the case's own.
    pub filters: Vec<Option<Filter>>,
    /// Strategies.
    pub strategies: Vec<Strategy>,
    /// Amounts of strategies in window depth; others take as many in ranges of their own.
    pub bias: Range,
    /// Every so many-th pixel.
    pub step: u32,
    /// Acne allowed as a share of the truly lit.
    pub max_acne: f64,
}

/// Map sizes beyond this are refused: 2²⁶ texels.
const LARGEST_MAP: u32 = 8192;
/// More combinations than this are refused.
const MOST: u128 = 100_000_000;

/// `lo:hi:log:n`, `lo:hi:lin:n`, or one value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// First value.
    pub low: f64,
    /// Last value.
    pub high: f64,
    /// Whether values are spaced by a factor.
    pub log: bool,
    /// How many; 1 means `low`.
    pub count: u32,
}

impl Range {
    /// The values, ascending, in f32; factors through `libm`.
    #[must_use]
    pub fn values(&self) -> Vec<f32> {
        let last = f64::from(self.count.max(2) - 1);
        let at = |i: u32| {
            let t = f64::from(i) / last;
            match self.log {
                true => self.low * libm::exp(libm::log(self.high / self.low) * t),
                false => self.low + (self.high - self.low) * t,
            }
        };
        (0..self.count).map(|i| at(i) as f32).collect()
    }

    /// As many values between other ends.
    #[must_use]
    pub const fn between(&self, low: f64, high: f64) -> Self {
        Self { low, high, log: true, count: self.count }
    }
}

impl std::str::FromStr for Range {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let bad = |reason: String| {
            let fix = "write lo:hi:log:n or lo:hi:lin:n, such as 1e-7:1e-2:log:200, or one value";
            Err(Error::bad_input(format!("--bias '{text}'"), reason, fix))
        };
        let number = |t: &str| t.parse::<f64>().ok().filter(|x| x.is_finite()).map(|x| x + 0.0);
        let parts: Vec<&str> = text.split(':').collect();
        let (low, high, log, count) = match parts.as_slice() {
            [one] => match number(one) {
                Some(value) => (value, value, false, 1),
                None => return bad("not a number".into()),
            },
            [low, high, spacing, count] => {
                let (Some(low), Some(high)) = (number(low), number(high)) else {
                    return bad("an end is not a number".into());
                };
                let Ok(count) = count.parse::<u32>() else {
                    return bad("the count is not a whole number".into());
                };
                match *spacing {
                    "log" => (low, high, true, count),
                    "lin" => (low, high, false, count),
                    other => return bad(format!("'{other}' is no spacing")),
                }
            }
            _ => return bad(format!("{} parts instead of 1 or 4", parts.len())),
        };
        if count == 0 || count > 1_000_000 {
            return bad("the count must be from 1 to 1000000".into());
        }
        if low > high || low < 0.0 {
            return bad("the ends must satisfy 0 <= lo <= hi".into());
        }
        if log && low <= 0.0 {
            return bad("a logarithmic range needs lo > 0".into());
        }
        Ok(Self { low, high, log, count })
    }
}

/// A format or packing by name.
///
/// # Errors
/// [`Error::BadInput`] listing the names.
pub fn format_named(name: &str) -> Result<TexelFormat> {
    name.parse()
}

/// A filter by name; `own` is the case's.
///
/// # Errors
/// [`Error::BadInput`] listing the names.
pub fn filter_named(name: &str) -> Result<Option<Filter>> {
    if name == "own" { Ok(None) } else { name.parse().map(Some) }
}

/// Cases by name, each once; `documents` and `all` stand for lists.
///
/// # Errors
/// [`Error::BadInput`] listing the names.
pub fn cases_named(names: &[String]) -> Result<Vec<Case>> {
    let one = |name: &String| match name.as_str() {
        "documents" => Ok(cases::documents::all()),
        "all" => Ok(cases::all()),
        name => cases::named(name).map(|case| vec![case]),
    };
    let mut cases = names.iter().map(one).collect::<Result<Vec<_>>>()?.concat();
    let mut seen = BTreeSet::new();
    cases.retain(|case| seen.insert(case.name.clone()));
    Ok(cases)
}

impl Plan {
    /// Checks the axes.
    ///
    /// # Errors
    /// [`Error::BadInput`] for an empty axis, a map size of 0 or beyond 8192, or more than 10⁸
    /// combinations.
    pub fn checked(self) -> Result<Self> {
        let axes = [
            ("--case", self.cases.len()),
            ("--map", self.sizes.len()),
            ("--format", self.formats.len()),
            ("--filter", self.filters.len()),
            ("--strategy", self.strategies.len()),
        ];
        if let Some((flag, _)) = axes.iter().find(|(_, n)| *n == 0) {
            return Err(Error::bad_input(*flag, "is empty", "give at least one"));
        }
        let texels = self.sizes.iter().find(|&&s| s == 0 || s > LARGEST_MAP);
        if let Some(size) = texels {
            return Err(Error::bad_input(
                format!("--map {size}"),
                "not a possible map size",
                format!("give 1 to {LARGEST_MAP} texels per side"),
            ));
        }
        let product = axes.iter().map(|&(_, n)| n as u128).product::<u128>();
        let product = product * u128::from(self.bias.count);
        if product > MOST {
            return Err(Error::bad_input(
                "the sweep",
                format!("{product} combinations are too many"),
                format!("give at most {MOST}, for instance fewer values of --bias"),
            ));
        }
        let largest = self.sizes.iter().copied().max().unwrap_or(1);
        let widest = |case: &Case| {
            let filters = self.filters.iter().map(|f| f.unwrap_or(case.lookup.filter));
            filters.max_by_key(|f| f.fetches()).unwrap_or(case.lookup.filter)
        };
        let affordable =
            |case: &Case| Need::SWEEP.check_with(case, largest, widest(case), self.step);
        self.cases.iter().try_for_each(affordable)?;
        Ok(self)
    }

    /// Combinations of all axes but the amounts.
    #[must_use]
    pub fn combinations(&self) -> usize {
        let formats = self.formats.len() * self.filters.len() * self.strategies.len();
        self.cases.len() * self.sizes.len() * formats
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_read_and_refused_with_a_sentence() {
        let range: Range = "1e-4:1e-2:log:3".parse().unwrap();
        assert_eq!(range.values(), [1e-4, 1e-3, 1e-2]);
        assert_eq!("0.005".parse::<Range>().unwrap().values(), [0.005]);
        assert_eq!("2:4:lin:1".parse::<Range>().unwrap().values(), [2.0], "n = 1 means lo");
        for bad in ["", "1:2", "0:1:log:5", "2:1:lin:5", "1:2:lin:0", "nan", "1:2:cubic:4", "-1"] {
            let error = bad.parse::<Range>().unwrap_err();
            assert_eq!(error.exit_code(), 2, "{bad}: {error}");
        }
    }
}
