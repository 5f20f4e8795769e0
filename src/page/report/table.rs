//! Tables: columns with units, typed cells, and their text, Markdown and CSV forms.

use super::number;
use super::palette::Colour;

/// A table that becomes a part of the page, a CSV file and, where asked, text on stdout.
#[derive(Clone, Debug, Default)]
pub struct Table {
    /// Unique in the report; names the CSV file and the anchor.
    pub id: String,
    /// One sentence above the table.
    pub caption: String,
    /// Columns, left to right.
    pub columns: Vec<Column>,
    /// Rows, each as long as `columns`.
    pub rows: Vec<Vec<Cell>>,
}

/// A column's heading.
#[derive(Clone, Debug, Default)]
pub struct Column {
    /// Heading without the unit.
    pub name: String,
    /// Unit of every number in the column, empty where there is none.
    pub unit: String,
    /// What the column means, shown on hover and in the page's definitions; may be empty.
    pub help: String,
}

/// One entry of a table.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// Words.
    Text(String),
    /// A command or an identifier, set in a fixed-width face, with a button that copies it.
    Code(String),
    /// Words that lead to an anchor (`#id`) or a relative file.
    Link {
        /// What is shown.
        text: String,
        /// Where it leads.
        to: String,
    },
    /// A class with its colour.
    Class(Colour, String),
    /// A count.
    Integer(i64),
    /// A number and how many significant digits people see; CSV has all of it.
    Number(f64, u8),
    /// A fraction, shown to three digits as per cent; CSV has the fraction.
    Percent(f64),
    /// Not measured or not defined.
    Missing,
}

impl Cell {
    /// A number shown to four significant digits, or [`Cell::Missing`].
    #[must_use]
    pub fn number(value: impl Into<Option<f64>>) -> Self {
        value.into().map_or(Self::Missing, |value| Self::Number(value, 4))
    }

    /// A fraction shown as per cent, or [`Cell::Missing`].
    #[must_use]
    pub fn share(value: Option<f64>) -> Self {
        value.map_or(Self::Missing, Self::Percent)
    }

    /// A count.
    ///
    /// # Panics
    /// Where the count does not fit an `i64`.
    #[must_use]
    pub fn count(value: impl TryInto<i64>) -> Self {
        Self::Integer(value.try_into().ok().expect("a count fits 63 bits"))
    }

    /// Plain text for a terminal.
    #[must_use]
    pub fn to_text(&self) -> String {
        match self {
            Self::Text(text)
            | Self::Code(text)
            | Self::Link { text, .. }
            | Self::Class(_, text) => text.clone(),
            Self::Integer(value) => value.to_string(),
            Self::Number(value, digits) => number::significant(*value, *digits),
            Self::Percent(value) => number::percent(*value, 3).replace('\u{a0}', " "),
            Self::Missing => "–".to_string(),
        }
    }

    /// Text for the page, with powers of ten and grouped digits.
    #[must_use]
    pub fn to_page(&self) -> String {
        match self {
            Self::Integer(value) => number::grouped(*value),
            Self::Number(value, digits) => number::pretty(*value, *digits),
            Self::Percent(value) => format!("{}\u{a0}%", number::pretty(*value * 100.0, 3)),
            Self::Text(_) | Self::Code(_) | Self::Link { .. } | Self::Class(..) | Self::Missing => {
                self.to_text()
            }
        }
    }

    /// Text for CSV: numbers read back to the same bits, a missing value is empty, and words are no
    /// formula.
    #[must_use]
    pub fn to_csv(&self) -> String {
        match self {
            Self::Number(value, _) | Self::Percent(value) => number::shortest(*value),
            Self::Missing => String::new(),
            Self::Integer(value) => value.to_string(),
            Self::Text(_) | Self::Code(_) | Self::Link { .. } | Self::Class(..) => {
                inert(self.to_text())
            }
        }
    }

    /// Whether the cell is set flush right.
    #[must_use]
    pub const fn is_numeric(&self) -> bool {
        matches!(self, Self::Integer(_) | Self::Number(..) | Self::Percent(_))
    }
}

/// Words that no spreadsheet takes for a formula: after an apostrophe where one would. Numbers stay.
fn inert(text: String) -> String {
    let formula = text.starts_with(['=', '+', '-', '@', '\t', '\r', '\n', '＝', '＋', '－', '＠']);
    if formula && text.parse::<f64>().is_err() { format!("'{text}") } else { text }
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        Self::Text(text.to_string())
    }
}

impl From<String> for Cell {
    fn from(text: String) -> Self {
        Self::Text(text)
    }
}

impl Column {
    /// `name [unit]`, or the name alone.
    #[must_use]
    pub fn heading(&self) -> String {
        if self.unit.is_empty() {
            return self.name.clone();
        }
        format!("{} [{}]", self.name, self.unit)
    }
}

impl Table {
    /// A table without columns and rows yet.
    pub fn new(id: impl Into<String>, caption: impl Into<String>) -> Self {
        Self { id: id.into(), caption: caption.into(), ..Self::default() }
    }

    /// Adds a column on the right.
    #[must_use]
    pub fn column(mut self, name: &str, unit: &str, help: &str) -> Self {
        let (name, unit, help) = (name.to_string(), unit.to_string(), help.to_string());
        self.columns.push(Column { name, unit, help });
        self
    }

    /// Adds a row at the end.
    ///
    /// # Panics
    /// Where the row is not as long as the table is wide.
    pub fn push(&mut self, row: Vec<Cell>) {
        assert_eq!(row.len(), self.columns.len(), "a row of table {} has another width", self.id);
        self.rows.push(row);
    }

    /// Whether the column holds numbers only (missing ones aside).
    #[must_use]
    pub fn is_numeric(&self, column: usize) -> bool {
        let mut cells = self.rows.iter().map(|row| &row[column]).filter(|c| **c != Cell::Missing);
        cells.clone().next().is_some() && cells.all(Cell::is_numeric)
    }

    /// Comma-separated values with a heading line, LF line ends, quotes where needed.
    #[must_use]
    pub fn to_csv(&self) -> String {
        let mut writer = csv::WriterBuilder::new().from_writer(Vec::new());
        let headings = self.columns.iter().map(|column| inert(column.heading()));
        let headings = std::iter::once(headings.collect());
        let rows = self.rows.iter().map(|row| row.iter().map(Cell::to_csv).collect::<Vec<_>>());
        for record in headings.chain(rows) {
            writer.write_record(record).expect("rows of one width are written to memory");
        }
        let bytes = writer.into_inner().expect("memory takes what is flushed");
        String::from_utf8(bytes).expect("text stays text")
    }

    /// Aligned text that is a Markdown table too: `|` inside cells is escaped.
    #[must_use]
    pub fn to_text(&self) -> String {
        let clean = |text: String| text.replace('|', "\\|").replace('\n', " ");
        let headings: Vec<_> = self.columns.iter().map(|c| clean(c.heading())).collect();
        let rows: Vec<Vec<_>> =
            self.rows.iter().map(|row| row.iter().map(|c| clean(c.to_text())).collect()).collect();
        let right: Vec<_> = (0..self.columns.len()).map(|c| self.is_numeric(c)).collect();
        let widths: Vec<_> = (0..self.columns.len())
            .map(|c| {
                rows.iter().chain([&headings]).map(|r| r[c].chars().count()).max().unwrap_or(0)
            })
            .map(|width| width.max(3))
            .collect();
        let rule = widths.iter().zip(&right).map(|(width, right)| {
            if *right { format!("{}:", "-".repeat(width - 1)) } else { "-".repeat(*width) }
        });
        let rule: Vec<_> = rule.collect();
        [headings, rule].iter().chain(&rows).map(|row| line(row, &widths, &right)).collect()
    }
}

fn line(row: &[String], widths: &[usize], right: &[bool]) -> String {
    let cells: Vec<_> = row
        .iter()
        .zip(widths.iter().zip(right))
        .map(
            |(text, (&width, &right))| {
                if right { format!("{text:>width$}") } else { format!("{text:<width$}") }
            },
        )
        .collect();
    format!("| {} |\n", cells.join(" | "))
}
