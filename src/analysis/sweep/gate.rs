//! Verdicts for continuous integration: limits on acne and peter-panning, and an older run to compare
//! with.

use super::results::cost;
pub use super::results::key;
use super::{CaseSweep, Point, Swept};
use crate::{Error, Result, input};
use serde_json::Value;
use std::path::Path;

/// A length limit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LengthLimit {
    /// Texel edges of the swept map at the middle receiver.
    Texels(f64),
    /// World units.
    World(f64),
}

impl std::str::FromStr for LengthLimit {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let number = |t: &str| t.trim().parse::<f64>().ok().filter(|x| x.is_finite() && *x >= 0.0);
        let texels = text.strip_suffix("texels").or_else(|| text.strip_suffix("texel"));
        let parsed = match texels {
            Some(rest) => number(rest).map(Self::Texels),
            None => number(text).map(Self::World),
        };
        parsed.ok_or_else(|| {
            Error::bad_input(
                format!("'{text}'"),
                "not a length",
                "write 2texels, or a number of world units",
            )
        })
    }
}

/// A share such as `0.1%` or `0.001`.
///
/// # Errors
/// [`Error::BadInput`] unless it lies in [0, 1].
pub fn share(text: &str) -> Result<f64> {
    let (number, scale) = match text.strip_suffix('%') {
        Some(number) => (number, 100.0),
        None => (text, 1.0),
    };
    let value = number.trim().parse::<f64>().map(|x| x / scale).unwrap_or(f64::NAN);
    if (0.0..=1.0).contains(&value) {
        return Ok(value);
    }
    Err(Error::bad_input(format!("'{text}'"), "not a share", "write 0.1% or 0.001"))
}

/// Limits that every combination of a sweep must meet at one of the amounts that were asked for.
#[derive(Clone, Copy, Debug, Default)]
pub struct Limits {
    /// Largest share of the truly lit with acne.
    pub acne: Option<f64>,
    /// Longest contact gap.
    pub peter_panning: Option<LengthLimit>,
}

/// Combinations that fail, one sentence each; one whose own rate is not measured fails.
#[must_use]
pub fn failures(sweeps: &[CaseSweep], limits: &Limits) -> Vec<String> {
    if limits.acne.is_none() && limits.peter_panning.is_none() {
        return Vec::new();
    }
    let of = |case: &CaseSweep| {
        let failed = |s: &Swept| failure(case, s, limits);
        case.swept.iter().filter_map(failed).collect::<Vec<_>>()
    };
    sweeps.iter().flat_map(of).collect()
}

fn failure(case: &CaseSweep, s: &Swept, limits: &Limits) -> Option<String> {
    let name = key(&case.name, s);
    let [lit, shadowed] = s.populations;
    if limits.acne.is_some() && lit == 0 {
        return Some(format!("{name}: acne is not measured, no receiver is truly lit"));
    }
    if limits.peter_panning.is_some() && shadowed == 0 {
        return Some(format!(
            "{name}: peter-panning is not measured, no receiver is truly shadowed"
        ));
    }
    let lit = lit.max(1) as f64;
    let rate = |p: &Point| p.tally.of(super::tally::Kind::ACNE) as f64 / lit;
    let texel = case.texel_world * f64::from(case.own_size) / f64::from(s.size);
    let longest = limits.peter_panning.map_or(f64::INFINITY, |length| match length {
        LengthLimit::Texels(n) => n * texel,
        LengthLimit::World(world) => world,
    });
    let acne = limits.acne.unwrap_or(1.0);
    let all = || s.points.iter();
    if all().any(|p| rate(p) <= acne && p.gap <= longest) {
        return None;
    }
    let best = all().min_by(|a, b| rate(a).total_cmp(&rate(b)))?;
    Some(if rate(best) > acne {
        format!("{name}: at best {:.3} % acne, at {:.4e}", 100.0 * rate(best), best.amount)
    } else {
        let shortest =
            all().filter(|p| rate(p) <= acne).map(|p| p.gap).fold(f64::INFINITY, f64::min);
        format!("{name}: gaps of {:.2} texels where acne is within its limit", shortest / texel)
    })
}

/// How a run compares with an older one.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Comparison {
    /// Combinations that got worse: `key: was … is …`.
    pub worse: Vec<String>,
    /// Combinations that got better.
    pub better: usize,
    /// Unchanged ones.
    pub same: usize,
    /// In only one of the two runs.
    pub unmatched: usize,
}

/// The `results.json` of an older run.
///
/// # Errors
/// [`Error::Read`] or [`Error::BadInput`] with the path.
pub fn baseline(path: &Path) -> Result<Value> {
    let text = input::text(path, input::DATA)?;
    let fix = "give the results.json of a sweep";
    serde_json::from_str(&text)
        .map_err(|e| Error::bad_input(path.display().to_string(), e.to_string(), fix))
}

/// Compares the acne-free amounts and the errors there with the `results.json` of an older run.
///
/// # Errors
/// [`Error::BadInput`] where it is not one.
pub fn compare(baseline: &Value, sweeps: &[CaseSweep]) -> Result<Comparison> {
    let bad = || Error::bad_input("--baseline", "is no results.json of a sweep", "give one");
    let old = baseline.get("combinations").and_then(Value::as_object).ok_or_else(bad)?;
    let mut comparison = Comparison::default();
    let mut seen = 0;
    for (case, s) in sweeps.iter().flat_map(|c| c.swept.iter().map(move |s| (c, s))) {
        let name = key(&case.name, s);
        let Some(before) = old.get(&name) else {
            comparison.unmatched += 1;
            continue;
        };
        seen += 1;
        if s.populations == [0, 0] {
            comparison.worse.push(format!("{name}: no receiver is measured now"));
            continue;
        }
        let (was, is) = (cost_before(before), cost(s));
        match is.partial_cmp(&was) {
            Some(std::cmp::Ordering::Equal) => comparison.same += 1,
            Some(std::cmp::Ordering::Less) => comparison.better += 1,
            _ => comparison.worse.push(format!("{name}: wrong receivers {was:?} are now {is:?}")),
        }
    }
    comparison.unmatched += old.len() - seen;
    Ok(comparison)
}

/// The [`cost`] of a combination of an older run.
fn cost_before(combination: &Value) -> [f64; 3] {
    let number = |name: &str| combination.get(name).and_then(Value::as_f64);
    match number("acne_free") {
        None => [1.0, number("least_wrong").unwrap_or(0.0), 0.0],
        Some(amount) => [0.0, number("wrong_at_acne_free").unwrap_or(0.0), amount],
    }
}
