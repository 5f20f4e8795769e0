//! Where the parts of a figure stand: legend rows below the plot, marker labels above it.

use std::sync::Once;

use plotters::style::{FontDesc, FontFamily, FontStyle};

use super::{Marker, Plot, Size};

/// Text size.
pub(super) const TEXT: u32 = 26;
/// Title size.
pub(super) const TITLE: u32 = 32;
/// Height of a row of the legend or of marker labels.
pub(super) const ROW: u32 = 40;
/// Length of the line in front of a legend entry.
pub(super) const SWATCH: u32 = 60;
/// Space left and right.
pub(super) const MARGIN: u32 = 28;

impl Size {
    /// Width of the figure in pixels; the page shows it at about half that.
    pub(super) const fn width(self) -> u32 {
        match self {
            Self::Whole => 1520,
            Self::Half => 1040,
        }
    }

    /// Height of the plot with its axes.
    const fn chart(self) -> u32 {
        match self {
            Self::Whole => 800,
            Self::Half => 660,
        }
    }
}

/// A text at a place of the figure.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Placed {
    pub(super) index: usize,
    pub(super) x: u32,
    pub(super) row: u32,
    pub(super) text: String,
}

/// Heights of the parts, and the legend.
#[derive(Clone, Debug)]
pub(super) struct Layout {
    pub(super) width: u32,
    pub(super) title: u32,
    pub(super) chart: u32,
    pub(super) legend: Vec<Placed>,
    pub(super) height: u32,
}

impl Layout {
    pub(super) fn new(plot: &Plot, size: Size, marker_rows: u32) -> Self {
        let width = size.width();
        let legend = legend(plot, width);
        let rows = legend.last().map_or(0, |entry| entry.row + 1);
        let title = if plot.title.is_empty() { 12 } else { 2 * TITLE };
        let chart = size.chart() + marker_rows * ROW;
        Self { width, title, chart, legend, height: title + chart + rows * ROW + 20 }
    }
}

/// The figure's font at `size`, known to every backend by measured widths.
pub(super) fn font(size: u32) -> FontDesc<'static> {
    static REGISTER: Once = Once::new();
    REGISTER.call_once(|| {
        let bytes = include_bytes!("../font/DejaVuSans-subset.ttf");
        let registered = plotters::style::register_font("sans-serif", FontStyle::Normal, bytes);
        assert!(registered.is_ok(), "the font that comes with the program is a font");
    });
    FontDesc::new(FontFamily::SansSerif, f64::from(size), FontStyle::Normal)
}

/// Width of a line of text in pixels.
pub(super) fn width(text: &str, size: u32) -> u32 {
    let ((left, _), (right, _)) = font(size).layout_box(text).expect("the font is registered");
    (right - left).unsigned_abs()
}

/// `text`, shortened in the middle until it fits.
fn fitted(text: &str, room: u32) -> String {
    let characters: Vec<char> = text.chars().collect();
    let shortened = |kept: usize| -> String {
        let (head, tail) = (kept.div_ceil(2), kept / 2);
        let tail = &characters[characters.len() - tail..];
        characters[..head].iter().chain(&['…']).chain(tail).collect()
    };
    let whole = (width(text, TEXT) <= room).then(|| text.to_string());
    whole.unwrap_or_else(|| {
        let lengths = (1..characters.len()).rev().map(shortened);
        lengths.into_iter().find(|line| width(line, TEXT) <= room).unwrap_or_default()
    })
}

/// Entries left to right, a new row where one would not fit.
fn legend(plot: &Plot, wide: u32) -> Vec<Placed> {
    let (mut x, mut row) = (MARGIN, 0);
    let mut entries = Vec::new();
    for (index, series) in plot.series.iter().enumerate() {
        let text = fitted(&series.name, wide - 2 * MARGIN - SWATCH - 14);
        let taken = SWATCH + 14 + width(&text, TEXT);
        if x > MARGIN && x + taken + MARGIN > wide {
            (x, row) = (MARGIN, row + 1);
        }
        entries.push(Placed { index, x, row, text });
        x += taken + 44;
    }
    entries
}

/// Labels of markers that stand at `x` pixels between `left` and `right`, each beside its line in
/// the lowest row where it touches no label and no line. Those that fit on the right of their line
/// come first, from right to left, so that lines rise to the left of labels; the others follow from
/// left to right, above them.
pub(super) fn markers(
    markers: &[Marker],
    xs: &[Option<u32>],
    left: u32,
    right: u32,
) -> Vec<Placed> {
    let lines = xs.iter().enumerate().filter_map(|(index, x)| Some((index, (*x)?)));
    let mut texts: Vec<(usize, u32, String)> =
        lines.map(|(index, x)| (index, x, fitted(&markers[index].label, right - left))).collect();
    texts.sort_by_key(|(index, x, text)| {
        let fits = x + 8 + width(text, TEXT) <= right;
        (!fits, if fits { u32::MAX - x } else { *x }, *index)
    });
    let mut taken: Vec<Label> = Vec::new();
    for (_, line, text) in &texts {
        let wide = width(text, TEXT);
        let starts = [line + 8, line.saturating_sub(wide + 8)];
        let beside = starts.into_iter().find(|start| *start >= left && start + wide <= right);
        let start = beside.unwrap_or(right.saturating_sub(wide));
        let label = |row| Label { line: *line, row, start, end: start + wide };
        let labels: Vec<Label> = (0..=texts.len() as u32).map(label).collect();
        let free = labels.iter().find(|label| taken.iter().all(|other| !label.meets(other)));
        taken.extend(free.or(labels.last()));
    }
    let placed = |(label, (index, _, text)): (&Label, (usize, u32, String))| Placed {
        index,
        x: label.start,
        row: label.row,
        text,
    };
    taken.iter().zip(texts).map(placed).collect()
}

/// A marker's label, its row counted upwards from the plot, and the pixel column of its line,
/// which reaches up to that row.
#[derive(Clone, Copy)]
struct Label {
    line: u32,
    row: u32,
    start: u32,
    end: u32,
}

impl Label {
    fn meets(&self, other: &Self) -> bool {
        let texts =
            self.row == other.row && self.start < other.end + 16 && other.start < self.end + 16;
        texts || self.is_crossed_by(other) || other.is_crossed_by(self)
    }

    fn is_crossed_by(&self, other: &Self) -> bool {
        other.row >= self.row && (self.start..self.end).contains(&other.line)
    }
}
