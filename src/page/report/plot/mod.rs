//! Plots as data: axes with units, series, markers; drawn as SVG and PNG.

mod compact;
mod draw;
mod layout;
mod ruler;

use super::palette::Colour;

/// A plot of series over two axes.
#[derive(Clone, Debug, Default)]
pub struct Plot {
    /// Unique in the report; names the SVG and PNG files and the anchor.
    pub id: String,
    /// Heading, drawn into the figure.
    pub title: String,
    /// One sentence: what a reader should see.
    pub caption: String,
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// What is drawn, back to front.
    pub series: Vec<Series>,
    /// Vertical lines with labels above the plot.
    pub markers: Vec<Marker>,
}

/// One axis.
#[derive(Clone, Debug, Default)]
pub struct Axis {
    /// Quantity with its unit: `bias [window depth]`.
    pub label: String,
    /// How values become positions.
    pub scale: Scale,
    /// Ends in axis units; `None` fits the data.
    pub range: Option<(f64, f64)>,
    /// Categories, upwards or to the right: the i-th stands at i. Empty for an axis of numbers; scale
    /// and range do not matter otherwise.
    pub names: Vec<String>,
}

/// How values become positions.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Scale {
    /// Proportional.
    #[default]
    Linear,
    /// By logarithm. Zero has a place of its own beside the smallest value; negative values are
    /// not drawn.
    Log,
    /// Proportional within ± `linear`, by logarithm beyond, for values of both signs.
    SymLog {
        /// Where the proportional part ends, in axis units, above zero.
        linear: f64,
    },
}

/// One line, or one set of points.
#[derive(Clone, Debug, Default)]
pub struct Series {
    /// Name in the legend.
    pub name: String,
    /// How it is drawn.
    pub style: Style,
    /// Colour; the same class has the same colour everywhere.
    pub colour: Colour,
    /// Points (x, y) in axis units. NaN parts the line.
    pub points: Vec<(f64, f64)>,
}

/// How a series is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Style {
    /// Straight lines from point to point.
    #[default]
    Line,
    /// Each value holds until the next x.
    Steps,
    /// A dot per point.
    Points,
    /// A dashed line: what theory says.
    Theory,
    /// A broad line: ranges, parted by NaN.
    Bar,
}

/// How much of the page's width a figure takes; the text stays as large.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Size {
    /// The page's width.
    Whole,
    /// Half of it, for figures side by side.
    Half,
}

/// A vertical line at a value worth naming.
#[derive(Clone, Debug, Default)]
pub struct Marker {
    /// Position in units of the x axis.
    pub x: f64,
    /// What stands there.
    pub label: String,
    /// Colour of line and label.
    pub colour: Colour,
}

impl Scale {
    /// Position of a value, before it is fitted to the figure. NaN and −∞ have no place.
    #[must_use]
    pub fn place(self, value: f64) -> f64 {
        match self {
            Self::Linear => value,
            Self::Log => libm::log10(value),
            Self::SymLog { linear } => {
                libm::log10(1.0 + value.abs() / linear) * if value < 0.0 { -1.0 } else { 1.0 }
            }
        }
    }
}

impl Axis {
    /// A proportional axis that fits its data.
    pub fn linear(label: impl Into<String>) -> Self {
        Self { label: label.into(), ..Self::default() }
    }

    /// A logarithmic axis that fits its data.
    pub fn log(label: impl Into<String>) -> Self {
        Self { label: label.into(), scale: Scale::Log, ..Self::default() }
    }

    /// An axis of categories, upwards or to the right.
    #[must_use]
    pub fn named(names: Vec<String>) -> Self {
        Self { names, ..Self::default() }
    }
}

impl Plot {
    /// The figure as a standalone SVG document.
    #[must_use]
    pub fn to_svg(&self, size: Size) -> String {
        draw::svg(self, size)
    }

    /// The figure as a PNG file, at twice the page's resolution.
    #[must_use]
    pub fn to_png(&self, size: Size) -> Vec<u8> {
        draw::png(self, size)
    }

    /// One sentence for people who cannot see the figure.
    #[must_use]
    pub fn summary(&self) -> String {
        let names: Vec<_> = self.series.iter().map(|series| series.name.as_str()).collect();
        let markers: Vec<_> = self.markers.iter().map(|marker| marker.label.as_str()).collect();
        let marked = if markers.is_empty() {
            String::new()
        } else {
            format!("; marked: {}", markers.join(", "))
        };
        let (y, x) = (&self.y.label, &self.x.label);
        format!("{}: {y} over {x}; series: {}{marked}", self.title, names.join(", "))
    }
}
