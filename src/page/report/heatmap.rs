//! Heat maps: a table of one quantity over two parameters, coloured by size.

use super::number;
use super::palette::{self, Colour};
use super::plot::Scale;
use super::table::{Cell, Table};

/// One quantity over two parameters.
#[derive(Clone, Debug, Default)]
pub struct HeatMap {
    /// Unique in the report; names the CSV file and the anchor.
    pub id: String,
    /// Heading.
    pub title: String,
    /// One sentence: what a reader should see.
    pub caption: String,
    /// What the rows are ("format").
    pub row_name: String,
    /// What the columns are, with unit ("bias [window depth]").
    pub column_name: String,
    /// Row labels, top to bottom.
    pub rows: Vec<String>,
    /// Column labels, left to right.
    pub columns: Vec<String>,
    /// Row by row; `None` where nothing was measured.
    pub values: Vec<Option<f64>>,
    /// How values become colours. On a log scale zero has the colour of the smallest value.
    pub scale: Scale,
    /// Unit of the values; `%` shows fractions as per cent.
    pub unit: String,
    /// Significant digits shown in the cells.
    pub digits: u8,
}

/// A coloured cell of the page.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub(super) struct Shade {
    pub(super) text: String,
    pub(super) background: String,
    pub(super) ink: String,
}

impl HeatMap {
    /// These numbers as a table with a row label in front.
    #[must_use]
    pub fn to_table(&self) -> Table {
        let mut table = Table::new(self.id.clone(), self.caption.clone());
        table = table.column(&self.row_name, "", "");
        for column in &self.columns {
            table = table.column(column, &self.unit, "");
        }
        for (label, values) in self.rows.iter().zip(self.values.chunks(self.columns.len().max(1))) {
            let cells = values.iter().map(|value| self.cell(*value));
            table.push(std::iter::once(Cell::from(label.as_str())).chain(cells).collect());
        }
        table
    }

    fn cell(&self, value: Option<f64>) -> Cell {
        match value {
            None => Cell::Missing,
            Some(value) if self.unit == "%" => Cell::Percent(value),
            Some(value) => Cell::Number(value, self.digits.max(1)),
        }
    }

    /// Smallest and largest finite value (positive ones only on a log scale).
    #[must_use]
    pub fn range(&self) -> Option<(f64, f64)> {
        let values = self.values.iter().flatten().copied();
        let drawn = values.filter(|v| v.is_finite() && (self.scale != Scale::Log || *v > 0.0));
        drawn.fold(None, |range, v| match range {
            None => Some((v, v)),
            Some((low, high)) => Some((v.min(low), v.max(high))),
        })
    }

    /// Position in [0, 1] of a value between the smallest and the largest.
    fn position(&self, value: f64) -> f64 {
        let Some((low, high)) = self.range() else { return 0.0 };
        let place = |v: f64| self.scale.place(v);
        if value.is_nan() {
            f64::NAN
        } else if self.scale == Scale::Log && value <= 0.0 || high == low {
            0.0
        } else {
            ((place(value) - place(low)) / (place(high) - place(low))).clamp(0.0, 1.0)
        }
    }

    /// Cells row by row with their colours.
    pub(super) fn shades(&self) -> Vec<Vec<Shade>> {
        let shade = |value: &Option<f64>| match value {
            None => Shade { text: "–".into(), background: String::new(), ink: String::new() },
            Some(v) => {
                let background = palette::magnitude(self.position(*v));
                Shade {
                    text: self.cell(Some(*v)).to_page(),
                    background: palette::css(background),
                    ink: palette::text_on(background).css(),
                }
            }
        };
        let rows = self.values.chunks(self.columns.len().max(1));
        rows.map(|row| row.iter().map(shade).collect()).collect()
    }

    /// The colour bar: its ends as text and eleven colours between them.
    pub(super) fn bar(&self) -> (String, Vec<String>, String) {
        let steps = (0..=10).map(|i| palette::css(palette::magnitude(f64::from(i) / 10.0)));
        let text = |v| self.cell(Some(v)).to_page();
        let (low, high) = self.range().map_or_else(
            || (String::new(), Colour::Grey.css()),
            |(low, high)| (text(low), text(high)),
        );
        (low, steps.collect(), high)
    }

    /// The unit after a space, empty where there is none or where cells carry it.
    pub(super) fn unit_suffix(&self) -> String {
        if self.unit.is_empty() || self.unit == "%" {
            String::new()
        } else {
            format!("{}{}", '\u{a0}', self.unit)
        }
    }

    /// One line for people who cannot see the colours.
    pub(super) fn summary(&self) -> String {
        let size = format!("{} by {}", self.rows.len(), self.columns.len());
        self.range().map_or_else(
            || format!("{size}, nothing measured"),
            |(low, high)| {
                let [low, high] = [low, high].map(|v| number::significant(v, self.digits.max(1)));
                format!("{size}, from {low} to {high}{}", self.unit_suffix())
            },
        )
    }
}
