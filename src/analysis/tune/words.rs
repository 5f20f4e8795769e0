//! What is said of a tuned scene: the sentence on top, and why a parameter has no line.

use super::{Found, Tuned, Tuning};
use crate::analysis::measurement::{half_measured, share};
use crate::analysis::sweep::tally::{Kind, Tally};
use crate::report::number::{percent, significant};

/// The sides of the populations, in their order.
const SIDES: [&str; 2] = ["lit", "shadowed"];

impl Tuning {
    /// `12 % of the lit`, or that it is not measured.
    fn share(&self, count: i64, side: usize) -> String {
        share(count.unsigned_abs(), self.populations[side]).map_or_else(
            || format!("a share of the {} that is not measured", SIDES[side]),
            |share| format!("{} of the {}", percent(share, 3), SIDES[side]),
        )
    }

    /// Why a parameter has no line, in one sentence.
    pub(super) fn reason(&self, t: &Tuned) -> String {
        let (engine, name) = (self.engine, t.knob.name);
        match t.found {
            Found::Set(_) => String::new(),
            Found::NotNeeded => {
                let acne = t.swept.acne_free.map_or(0, |p| p.tally.of(Kind::ACNE));
                format!(
                    "{name}: no bias is needed, without any there is acne on {}.",
                    self.share(acne, 0)
                )
            }
            Found::OutOfRange(value) => {
                let [low, high] = t.knob.range.map(|end| significant(end, 4));
                let keeps = match t.knob.accepts(value) {
                    true => "that is more than the whole depth range".to_string(),
                    false => format!("{engine} keeps it from {low} to {high}"),
                };
                format!(
                    "{name} alone cannot do it: it would take {}, and {keeps}.",
                    significant(value, 4)
                )
            }
            Found::Withdrawn(w) => {
                let needed = match self.constant {
                    None => "no constant bias ends acne here".to_string(),
                    Some(bias) => format!(
                        "the constant bias needed here is {} in window depth",
                        significant(bias.into(), 4)
                    ),
                };
                format!(
                    "{engine}: no value of {name} is given, since {}; {}; {needed}.",
                    w.why, w.instead
                )
            }
            Found::Infeasible => self.least(t),
        }
    }

    /// What a parameter leaves at best, where it does not meet the target.
    fn least(&self, t: &Tuned) -> String {
        let least = t.swept.points.iter().min_by_key(|p| p.tally.of(Kind::ACNE));
        least.map_or_else(String::new, |p| {
            format!(
                "{} alone cannot do it: at best, at {}, it leaves {} with acne and lights {}.",
                t.knob.name,
                significant(t.knob.value(p.amount.into()), 4),
                self.share(p.tally.of(Kind::ACNE), 0),
                self.share(p.tally.false_light(), 1),
            )
        })
    }

    /// What is said where no receiver is lit, or none is counted at all.
    pub(super) fn nothing_lit(&self) -> String {
        match self.populations[1] {
            0 => "No receiver was measured, so no bias is recommended.".to_string(),
            n => format!(
                "No receiver is truly lit, so acne is not measured and no bias is recommended ({n} are truly shadowed)."
            ),
        }
    }

    /// Whether shadows detach before acne has ended, in words for the end of a sentence.
    fn conflict(t: &Tuned) -> String {
        let ends = t.swept.acne_free.map(|p| p.amount);
        let at = |amount: f32| significant(t.knob.value(amount.into()), 4);
        match (ends, t.swept.detachment) {
            (Some(free), Some(first)) if first <= free => {
                format!(" No value is free of both: shadows detach from {} on.", at(first))
            }
            (Some(_), Some(first)) if first.is_finite() => {
                format!(" Shadows detach from {} on.", at(first))
            }
            _ => String::new(),
        }
    }

    /// What the engine's defaults leave, in words for the end of a sentence.
    fn default(&self) -> String {
        if let Some(w) = self.no_default {
            return format!(" What the default leaves is not said: {}; {}.", w.why, w.instead);
        }
        let leaves = |t: &Tally| {
            let (shadow, light) = (self.share(t.of(Kind::ACNE), 0), self.share(t.false_light(), 1));
            format!(" The default leaves {shadow} with acne and {light} lit.")
        };
        self.defaults.as_ref().map_or_else(String::new, leaves)
    }

    /// The sentence on top.
    pub(super) fn sentence(&self) -> String {
        let default = self.default();
        if self.tuned.is_empty() {
            return format!("{}{default}", self.nothing_lit());
        }
        let half = half_measured(self.populations)
            .map_or_else(String::new, |missing| format!(" Here {missing}."));
        let Some(t) = self.best() else {
            return format!("{}{half}{default}", self.refusal());
        };
        let (acne, light) = t.swept.acne_free.map_or_else(Default::default, |p| {
            (self.share(p.tally.of(Kind::ACNE), 0), self.share(p.tally.false_light(), 1))
        });
        let conflict = Self::conflict(t);
        match t.found {
            Found::Set(value) => format!(
                "Set {} to {}: acne falls to {acne}, false light is {light}.{conflict}{half}{default}",
                t.knob.name,
                significant(value, 6),
            ),
            Found::NotNeeded | Found::Infeasible | Found::OutOfRange(_) | Found::Withdrawn(_) => {
                format!(
                    "No bias is needed: without any there is acne on {acne}, and false light is {light}.{conflict}{half}{default}"
                )
            }
        }
    }

    /// Why no value is recommended.
    fn refusal(&self) -> String {
        let is_known = |t: &&Tuned| !matches!(t.found, Found::Withdrawn(_));
        let Some(known) = self.tuned.iter().find(is_known) else {
            let mut reasons: Vec<(&str, String)> = Vec::new();
            for t in &self.tuned {
                if let Found::Withdrawn(w) = t.found
                    && reasons.iter().all(|(why, _)| *why != w.why)
                {
                    reasons.push((w.why, self.reason(t)));
                }
            }
            let reasons: Vec<String> = reasons.into_iter().map(|(_, reason)| reason).collect();
            return reasons.join(" ");
        };
        format!(
            "Infeasible: no value of any of {}'s parameters brings acne to {} or below on this map. {}",
            self.engine,
            percent(self.max_acne, 3),
            self.reason(known),
        )
    }

    /// The parameters whose lines are withdrawn beside others, a sentence each.
    pub(super) fn withdrawn(&self) -> Vec<String> {
        let is_withdrawn = |t: &&Tuned| matches!(t.found, Found::Withdrawn(_));
        let list = self.tuned.iter().filter(is_withdrawn);
        if list.clone().count() < self.tuned.len() {
            list.map(|t| self.reason(t)).collect()
        } else {
            Vec::new()
        }
    }

    /// What is said of the cheapest map; nothing where there is nothing to say.
    pub(super) fn cheapest_sentence(&self) -> Option<String> {
        let printable = |t: &Tuned| !matches!(t.found, Found::Withdrawn(_));
        let none = "No smaller configuration meets the target.".to_string();
        match &self.cheapest {
            Some(cheapest) => Some(cheapest.sentence()),
            None => self.tuned.iter().any(printable).then_some(none),
        }
    }
}
