//! Sentences about what was left out or taken otherwise: one a kind, with how many and the first names.

use std::collections::BTreeMap;

/// Names of each kind that are told; the rest are counted.
const NAMED: usize = 3;

/// What happened, by what is said of it.
#[derive(Default)]
pub(super) struct Told(BTreeMap<(String, &'static str), (usize, Vec<String>)>);

impl Told {
    /// Counts one more `unit` (a noun in the singular) of which `what` is said.
    pub(super) fn add(&mut self, unit: &'static str, what: impl Into<String>, name: &str) {
        let (count, names) = self.0.entry((what.into(), unit)).or_default();
        *count += 1;
        if names.len() < NAMED && !name.is_empty() && !names.iter().any(|n| n == name) {
            names.push(name.to_string());
        }
    }

    /// Every kind as a sentence: `5 parts (a, b, c, …) what`.
    pub(super) fn sentences(&self) -> Vec<String> {
        let sentence =
            |((what, unit), (count, names)): (&(String, &str), &(usize, Vec<String>))| {
                let plural = if *count == 1 { "" } else { "s" };
                let more = if *count > names.len() { ", …" } else { "" };
                let names = match names.is_empty() {
                    true => String::new(),
                    false => format!(" ({}{more})", names.join(", ")),
                };
                format!("{count} {unit}{plural}{names} {what}")
            };
        self.0.iter().map(sentence).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_kind_is_said_once_with_its_count_and_first_names() {
        let mut told = Told::default();
        ["a", "b", "a", "c", "d"].iter().for_each(|n| told.add("part", "of lines: left out", n));
        told.add("node", "hidden", "");
        assert_eq!(told.sentences(), ["1 node hidden", "5 parts (a, b, c, …) of lines: left out"]);
    }
}
