//! A receiver exactly at its own stored depth: which comparison calls it lit, and from which bias on.

use super::search::{onset, phases};
use super::{Fate, Forecast, Row, Sampling, Stress};
use crate::num::exp2;
use crate::report::Scale;
use crate::scene::CompareRule;

const RULES: [(CompareRule, &str); 4] = [
    (CompareRule::ReceiverBeyond, "tie-receiver-beyond"),
    (CompareRule::NotStoredBeyond, "tie-not-stored-beyond"),
    (CompareRule::StoredAtMost, "tie-stored-at-most"),
    (CompareRule::NotReceiverBefore, "tie-not-receiver-before"),
];

/// Share of depths in (½, 1), stored without error, that are dark under a bias of `ulps` steps of f32.
fn dark(rule: CompareRule, ulps: f64, samples: u32) -> f64 {
    let bias = (ulps * exp2(-24)) as f32;
    let is_dark = |phase: f64| {
        let z = (0.5 + phase / 2.0) as f32;
        !rule.is_lit(z, z, bias)
    };
    phases(samples).filter(|&p| is_dark(p)).count() as f64 / f64::from(samples)
}

fn row(effort: &Sampling, (rule, name): (CompareRule, &str)) -> Row {
    let biases: Vec<f64> = (0..=16).map(|i| f64::from(i) / 8.0).collect();
    let curve = biases.iter().map(|&b| (b, dark(rule, b, effort.samples))).collect();
    if rule.is_lit_exact(0.5, 0.5, 0.0) {
        let event = format!("a receiver at its own stored depth is dark under {rule}");
        let seen = biases.iter().copied().find(|&b| dark(rule, b, effort.samples) > 0.0);
        let forecast = Forecast::never(name, &event, "a strict comparison of equals is false");
        return forecast.curve(&biases, |_| 0.0).met(seen, curve);
    }
    let event = format!("a receiver at its own stored depth is lit under {rule}");
    let formula = "½ulp: a smaller bias is rounded away, and equals are in shadow";
    let all_lit = |b: f64| dark(rule, b, effort.samples) == 0.0;
    Forecast::at(Fate::Degrades, 0.5, name, &event, formula)
        .curve(&biases, |b| if b < 0.5 { 1.0 } else { 0.0 })
        .met(onset(1.0 / 64.0, 4.0, 100, all_lit), curve)
}

/// The light straight above, an exact store: only the comparison decides.
pub(super) fn comparisons(effort: &Sampling) -> Stress {
    Stress {
        id: "ties",
        title: "A receiver at its own stored depth",
        lead: "Light along the normal and a map without rounding: receiver and stored depth are equal, \
               and the comparison alone decides. The curve is the share of depths that are dark."
            .to_string(),
        parameter: "bias [ulp of the depth]",
        error: "share in shadow of itself",
        scale: Scale::Linear,
        rows: RULES.map(|rule| row(effort, rule)).into(),
    }
}
