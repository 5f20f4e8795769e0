//! Reading the results of a sweep: names, winners, and the combinations of a case's own map.

use super::{CaseSweep, Point, Swept};
use serde_json::Value;

/// A combination's name in messages and files.
#[must_use]
pub fn key(case: &str, s: &Swept) -> String {
    format!("{case} {} {} {} {}", s.size, s.format.name(), s.filter, s.strategy)
}

/// The shortest decimal of an f32 as a number.
fn short(x: f32) -> f64 {
    x.to_string().parse().unwrap_or(f64::NAN)
}

/// Receivers with a wrong verdict at a point.
fn wrong(p: &Point) -> i64 {
    p.tally.false_shadow() + p.tally.false_light()
}

/// What runs are compared by, as `results.json` would say it: infeasible first, then wrong receivers at
/// the acne-free amount (or the fewest at any), then that amount.
pub(super) fn cost(s: &Swept) -> [f64; 3] {
    match s.acne_free {
        None => [1.0, s.least().map_or(0.0, |p| wrong(p) as f64), 0.0],
        Some(p) => [0.0, wrong(&p) as f64, short(p.amount)],
    }
}

/// One combination as it stands in `results.json`; what there is none of is left out.
#[must_use]
pub fn combination(s: &Swept) -> Value {
    let mut entry = serde_json::Map::new();
    let mut put = |name: &str, value: Option<Value>| {
        entry.extend(value.map(|v| (name.to_string(), v)));
    };
    put("acne_free", s.acne_free.map(|p| short(p.amount).into()));
    put("wrong_at_acne_free", s.acne_free.as_ref().map(|p| wrong(p).into()));
    put(
        "contact_gap_world",
        s.acne_free.filter(|p| p.gap > 0.0).map(|p| short(p.gap as f32).into()),
    );
    let measured = s.populations != [0, 0];
    put("least_wrong", s.least().filter(|_| measured).map(|p| wrong(p).into()));
    put("detachment", s.detachment.filter(|b| b.is_finite()).map(|b| short(b).into()));
    Value::Object(entry)
}

/// What a strategy leaves wrong where its acne ends: the share of all counted receivers in false shadow or
/// false light.
fn left_wrong(s: &Swept) -> Option<f64> {
    let tally = s.acne_free?.tally;
    let wrong = tally.false_shadow() + tally.false_light();
    Some(wrong as f64 / s.populations.iter().sum::<u64>().max(1) as f64)
}

/// The winner among combinations of one map, format and filter: the one that leaves least wrong; of
/// equals the first.
pub(super) fn winner<'s>(list: &[&'s Swept]) -> Option<&'s Swept> {
    let rated = list.iter().filter_map(|&s| Some((left_wrong(s)?, s)));
    rated.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, s)| s)
}

/// Combinations at the case's own map size and format (or the first of each that was swept).
pub(super) fn own(case: &CaseSweep) -> Vec<&Swept> {
    let has = |name: &str| case.swept.iter().any(|s| s.format.name() == name);
    let first = case.swept.first();
    let format =
        if has(case.own_format) { case.own_format } else { first.map_or("", |s| s.format.name()) };
    let sized = case.swept.iter().any(|s| s.size == case.own_size);
    let size = if sized { case.own_size } else { first.map_or(0, |s| s.size) };
    case.swept.iter().filter(|s| s.size == size && s.format.name() == format).collect()
}
