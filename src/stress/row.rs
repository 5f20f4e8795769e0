//! A row of the verdict table: what theory forecast, what was measured, and the curve between.

use crate::report::{Scale, number};

crate::catalogue! {
    /// What happens from a row's onset on.
    pub enum Fate {
        /// Nothing: it holds over the whole range of the parameter.
        Holds = "holds",
        /// The answer gets worse by degrees; a bias or a bound still covers it.
        Degrades = "degrades",
        /// The answer is wrong and no bias repairs it.
        Breaks = "breaks",
    }
}

/// What theory says before the run.
#[derive(Clone, Debug, PartialEq)]
pub struct Forecast {
    /// Name of the row: lower case, digits, hyphens; unique in the report.
    pub name: String,
    /// What happens at the onset, as a clause: "the plates coincide in the map".
    pub event: String,
    /// The formula that gives the onset.
    pub formula: String,
    /// What follows from the onset on.
    pub fate: Fate,
    /// The parameter's value there; `None` for never.
    pub onset: Option<f64>,
    /// Points (parameter, error) of the theory.
    pub theory: Vec<(f64, f64)>,
}

/// A forecast and what the run measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Stated before the run.
    pub forecast: Forecast,
    /// The parameter's value from which on the event was seen; `None` for never.
    pub measured: Option<f64>,
    /// Points (parameter, error) of the run.
    pub curve: Vec<(f64, f64)>,
    /// What else was measured, one sentence; may be empty.
    pub note: String,
}

/// One parameter driven to its extreme.
#[derive(Clone, Debug, PartialEq)]
pub struct Stress {
    /// Name of its figure: lower case, digits, hyphens; unique in the report.
    pub id: &'static str,
    /// Heading.
    pub title: &'static str,
    /// What is driven, and what is looked at.
    pub lead: String,
    /// The parameter and its unit.
    pub parameter: &'static str,
    /// The error and its unit.
    pub error: &'static str,
    /// How the parameter is laid out.
    pub scale: Scale,
    /// Its rows.
    pub rows: Vec<Row>,
}

/// Largest relative difference between forecast and measurement that counts as agreement.
pub const AGREEMENT: f64 = 0.05;

impl Forecast {
    /// A forecast with its onset.
    pub fn at(fate: Fate, onset: f64, name: impl Into<String>, event: &str, formula: &str) -> Self {
        let (event, formula) = (event.to_string(), formula.to_string());
        let (name, onset, theory) = (name.into(), Some(onset), Vec::new());
        Self { name, event, formula, fate, onset, theory }
    }

    /// The forecast that `event` never happens.
    pub fn never(name: impl Into<String>, event: &str, formula: &str) -> Self {
        Self { onset: None, ..Self::at(Fate::Holds, 0.0, name, event, formula) }
    }

    /// The forecast with the theory's curve: `error` at each of the parameters.
    #[must_use]
    pub fn curve(self, parameters: &[f64], error: impl Fn(f64) -> f64) -> Self {
        Self { theory: parameters.iter().map(|&p| (p, error(p))).collect(), ..self }
    }

    /// The row once it has been measured.
    #[must_use]
    pub fn met(self, measured: Option<f64>, curve: Vec<(f64, f64)>) -> Row {
        Row { forecast: self, measured, curve, note: String::new() }
    }
}

impl Row {
    /// The row with a further sentence.
    #[must_use]
    pub fn noting(self, note: impl Into<String>) -> Self {
        Self { note: note.into(), ..self }
    }

    /// |measured − predicted| / predicted: 0 where both say never, infinite where only one does.
    #[must_use]
    pub fn relative_error(&self) -> f64 {
        match (self.forecast.onset, self.measured) {
            (Some(predicted), Some(measured)) => ((measured - predicted) / predicted).abs(),
            (None, None) => 0.0,
            _ => f64::INFINITY,
        }
    }

    /// Whether measurement and forecast agree within [`AGREEMENT`].
    #[must_use]
    pub fn agrees(&self) -> bool {
        self.relative_error() <= AGREEMENT
    }

    /// `holds`, `degrades at …` or `breaks at …`, from what was measured.
    #[must_use]
    pub fn verdict(&self) -> String {
        match (self.measured, self.forecast.fate) {
            (None, _) => Fate::Holds.name().to_string(),
            (Some(at), Fate::Holds) => format!("{} at {}", Fate::Breaks, text(at)),
            (Some(at), fate) => format!("{fate} at {}", text(at)),
        }
    }

    /// The finding in one sentence.
    #[must_use]
    pub fn sentence(&self) -> String {
        let Forecast { event, formula, .. } = &self.forecast;
        let seen = match self.measured {
            Some(at) => format!("From {} on {event}", text(at)),
            None => format!("Never in this range: {event}"),
        };
        let theory = match self.forecast.onset {
            Some(at) => format!("theory says {} ({formula})", text(at)),
            None => format!("theory says never ({formula})"),
        };
        let note = if self.note.is_empty() { String::new() } else { format!(" {}", self.note) };
        format!("{seen}; {theory}.{note}")
    }
}

fn text(value: f64) -> String {
    number::pretty(value, 4)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_agrees_only_within_five_per_cent() {
        let row = |onset: f64, measured| {
            Forecast::at(Fate::Breaks, onset, "row", "it breaks", "x").met(measured, Vec::new())
        };
        assert!(row(100.0, Some(105.0)).agrees() && !row(100.0, Some(106.0)).agrees());
        assert!(!row(100.0, None).agrees(), "forecast but not seen");
        assert_eq!(row(100.0, Some(99.0)).verdict(), "breaks at 99");
        let never = Forecast::never("row", "it breaks", "x");
        assert!(never.clone().met(None, Vec::new()).agrees());
        let seen = never.met(Some(2.0), Vec::new());
        assert!(!seen.agrees(), "seen but not forecast");
        assert_eq!(seen.verdict(), "breaks at 2");
    }
}
