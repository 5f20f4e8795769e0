//! Figures drawn by plotters, once for SVG and once for PNG.

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::compact::compact;
use super::layout::{self, Layout, MARGIN, Placed, ROW, SWATCH, TEXT, TITLE, font};
use super::ruler::Ruler;
use super::{Plot, Series, Size, Style};
use crate::report::image;
use crate::report::palette::Colour;

type Drawn<DB> = Result<(), DrawingAreaErrorKind<<DB as DrawingBackend>::ErrorType>>;
type Coordinates = Cartesian2d<Ruler, Ruler>;
type Chart<'a, DB> = ChartContext<'a, DB, Coordinates>;

/// Thickness of a bar.
const BAR: u32 = 18;

/// A figure with its axes fitted and its texts placed.
struct Figure<'a> {
    plot: &'a Plot,
    x: Ruler,
    y: Ruler,
    /// Width of the vertical axis's labels.
    left: u32,
    markers: Vec<Placed>,
    marker_rows: u32,
    layout: Layout,
}

pub(super) fn svg(plot: &Plot, size: Size) -> String {
    let figure = Figure::new(plot, size);
    let mut text = String::new();
    let size = (figure.layout.width, figure.layout.height);
    let area = SVGBackend::with_string(&mut text, size).into_drawing_area();
    figure.draw(&area).expect("drawing into a string cannot fail");
    drop(area);
    compact(&text)
}

pub(super) fn png(plot: &Plot, size: Size) -> Vec<u8> {
    let figure = Figure::new(plot, size);
    let (width, height) = (figure.layout.width, figure.layout.height);
    let mut pixels = vec![0; (width * height * 3) as usize];
    let area = BitMapBackend::with_buffer(&mut pixels, (width, height)).into_drawing_area();
    figure.draw(&area).expect("drawing into memory cannot fail");
    drop(area);
    // Anti-aliasing makes more colours than a palette holds: 16 levels a channel look the same.
    let level = |byte: u8| ((u16::from(byte) + 8) / 17 * 17) as u8;
    let rounded: Vec<u8> = pixels.iter().map(|&byte| level(byte)).collect();
    image::png(width, height, &rounded)
}

impl<'a> Figure<'a> {
    fn new(plot: &'a Plot, size: Size) -> Self {
        let width = size.width();
        let points = || plot.series.iter().flat_map(|series| &series.points);
        let marked = plot.markers.iter().map(|marker| marker.x);
        let x = Ruler::new(&plot.x, points().map(|p| p.0).chain(marked));
        let y = Ruler::new(&plot.y, points().map(|p| p.1));
        let widest = y.ticks.iter().map(|(_, label)| layout::width(label, TEXT)).max().unwrap_or(0);
        let left = widest + 24 + if plot.y.label.is_empty() { 0 } else { TEXT + 24 };
        let (start, end) = (MARGIN + left, width - 2 * MARGIN);
        let pixel = |t: f64| {
            let share = (t - x.low) / (x.high - x.low);
            (0.0..=1.0).contains(&share).then(|| start + (share * f64::from(end - start)) as u32)
        };
        let xs: Vec<_> = plot.markers.iter().map(|m| x.place(m.x).and_then(pixel)).collect();
        let markers = layout::markers(&plot.markers, &xs, start, width - MARGIN);
        let marker_rows = markers.iter().map(|label| label.row + 1).max().unwrap_or(0);
        let layout = Layout::new(plot, size, marker_rows);
        Self { plot, x, y, left, markers, marker_rows, layout }
    }

    fn draw<DB: DrawingBackend>(&self, area: &DrawingArea<DB, Shift>) -> Drawn<DB> {
        area.fill(&WHITE)?;
        let title = ink(TITLE).pos(Pos::new(HPos::Center, VPos::Center));
        area.draw_text(
            &self.plot.title,
            &title,
            (self.layout.width as i32 / 2, self.layout.title as i32 / 2),
        )?;
        let bottom = self.layout.title + self.layout.chart;
        let (upper, _) = area.split_vertically(bottom);
        let (_, middle) = upper.split_vertically(self.layout.title);
        self.draw_chart(&middle)?;
        for entry in &self.layout.legend {
            self.draw_entry(area, entry, bottom)?;
        }
        area.present()
    }

    fn draw_chart<DB: DrawingBackend>(&self, area: &DrawingArea<DB, Shift>) -> Drawn<DB> {
        let mut chart = ChartBuilder::on(area)
            .margin_left(MARGIN)
            .margin_right(2 * MARGIN)
            .margin_top(self.marker_rows * ROW + 8)
            .x_label_area_size(2 * TEXT + 30)
            .y_label_area_size(self.left)
            .build_cartesian_2d(self.x.clone(), self.y.clone())?;
        chart
            .configure_mesh()
            .label_style(ink(TEXT))
            .axis_desc_style(ink(TEXT))
            .axis_style(colour(Colour::Ink).stroke_width(2))
            .bold_line_style(RGBColor(214, 214, 220).stroke_width(2))
            .light_line_style(RGBColor(238, 238, 242).stroke_width(1))
            .x_desc(&self.plot.x.label)
            .y_desc(&self.plot.y.label)
            .draw()?;
        self.draw_breaks(&mut chart)?;
        self.draw_markers(&mut chart, area)?;
        for series in &self.plot.series {
            self.draw_series(&mut chart, series)?;
        }
        if self.plot.series.iter().all(|series| self.runs(series).is_empty()) {
            let text = ink(TEXT).pos(Pos::new(HPos::Center, VPos::Center));
            let (wide, high) = area.dim_in_pixel();
            area.draw_text("nothing measured", &text, (wide as i32 / 2, high as i32 / 2))?;
        }
        Ok(())
    }

    /// A dotted line parts zero from the logarithmic part of an axis.
    fn draw_breaks<DB: DrawingBackend>(&self, chart: &mut Chart<'_, DB>) -> Drawn<DB> {
        let style = colour(Colour::Grey).stroke_width(2);
        let ((x0, x1), (y0, y1)) = ((self.x.low, self.x.high), (self.y.low, self.y.high));
        let lines = [
            self.x.break_at().map(|x| [(x, y0), (x, y1)]),
            self.y.break_at().map(|y| [(x0, y), (x1, y)]),
        ];
        for line in lines.into_iter().flatten() {
            chart.draw_series(DashedLineSeries::new(line, 4, 10, style))?;
        }
        Ok(())
    }

    fn draw_markers<DB: DrawingBackend>(
        &self,
        chart: &mut Chart<'_, DB>,
        area: &DrawingArea<DB, Shift>,
    ) -> Drawn<DB> {
        for label in &self.markers {
            let marker = &self.plot.markers[label.index];
            let Some(t) = self.x.place(marker.x) else { continue };
            let style = colour(marker.colour).stroke_width(3);
            chart.draw_series([PathElement::new([(t, self.y.low), (t, self.y.high)], style)])?;
            let (x, top) = chart.plotting_area().map_coordinate(&(t, self.y.high));
            let base = area.get_base_pixel();
            let (x, top) = (x - base.0, top - base.1);
            let y = top - ((label.row + 1) * ROW) as i32;
            area.draw(&PathElement::new([(x, y + 8), (x, top)], style))?;
            let shade = colour(marker.colour);
            let text = ink(TEXT).color(&shade);
            let wide = layout::width(&label.text, TEXT) as i32;
            let corner = (label.x as i32, y + 2);
            let ground = [corner, (corner.0 + wide, corner.1 + ROW as i32 - 6)];
            area.draw(&Rectangle::new(ground, WHITE.filled()))?;
            area.draw_text(&label.text, &text, (label.x as i32, y + 4))?;
        }
        Ok(())
    }

    fn draw_series<DB: DrawingBackend>(
        &self,
        chart: &mut Chart<'_, DB>,
        series: &Series,
    ) -> Drawn<DB> {
        let style = colour(series.colour).stroke_width(4);
        let dots = |points: Vec<(f64, f64)>| {
            points.into_iter().map(move |p| Circle::new(p, 6, colour(series.colour).filled()))
        };
        let runs = self.runs(series);
        if series.style == Style::Points {
            chart.draw_series(dots(runs.concat()))?;
            return Ok(());
        }
        for run in runs {
            let run = if series.style == Style::Steps { steps(&run) } else { run };
            if run.len() == 1 {
                chart.draw_series(dots(run))?;
                continue;
            }
            for part in clipped(&thinned(&run, self.pitch()), &self.x, &self.y) {
                match series.style {
                    Style::Theory => {
                        chart.draw_series(DashedLineSeries::new(part, 16, 10, style))?
                    }
                    Style::Bar => {
                        chart.draw_series(LineSeries::new(part, style.stroke_width(BAR)))?
                    }
                    Style::Line | Style::Steps | Style::Points => {
                        chart.draw_series(LineSeries::new(part, style))?
                    }
                };
            }
        }
        Ok(())
    }

    /// Width of one pixel in placed units of the x axis.
    fn pitch(&self) -> f64 {
        (self.x.high - self.x.low) / f64::from(self.layout.width)
    }

    /// The series in placed units, parted where a point has no place; dots outside go.
    fn runs(&self, series: &Series) -> Vec<Vec<(f64, f64)>> {
        let inside = |(x, y): &(f64, f64)| {
            (self.x.low..=self.x.high).contains(x) && (self.y.low..=self.y.high).contains(y)
        };
        let placed = series.points.iter().map(|(x, y)| self.x.place(*x).zip(self.y.place(*y)));
        let placed: Vec<_> = match series.style == Style::Points {
            true => placed.map(|p| p.filter(inside)).collect(),
            false => placed.collect(),
        };
        let runs = placed.split(Option::is_none).filter(|run| !run.is_empty());
        runs.map(|run| run.iter().flatten().copied().collect()).collect()
    }

    fn draw_entry<DB: DrawingBackend>(
        &self,
        area: &DrawingArea<DB, Shift>,
        entry: &Placed,
        top: u32,
    ) -> Drawn<DB> {
        let series = &self.plot.series[entry.index];
        let y = (top + entry.row * ROW + ROW / 2) as i32;
        let (x0, x1) = (entry.x as i32, (entry.x + SWATCH) as i32);
        let style = colour(series.colour).stroke_width(5);
        match series.style {
            Style::Points => {
                let centre = (i32::midpoint(x0, x1), y);
                area.draw(&Circle::new(centre, 7, colour(series.colour).filled()))?;
            }
            Style::Theory => {
                for start in (x0..x1 - 10).step_by(22) {
                    area.draw(&PathElement::new([(start, y), (start + 14, y)], style))?;
                }
            }
            Style::Bar => {
                area.draw(&PathElement::new([(x0, y), (x1, y)], style.stroke_width(BAR)))?;
            }
            Style::Line | Style::Steps => {
                area.draw(&PathElement::new([(x0, y), (x1, y)], style))?;
            }
        }
        let text = ink(TEXT).pos(Pos::new(HPos::Left, VPos::Center));
        area.draw_text(&entry.text, &text, (x1 + 14, y))
    }
}

fn colour(colour: Colour) -> RGBColor {
    let [r, g, b] = colour.rgb();
    RGBColor(r, g, b)
}

fn ink(size: u32) -> TextStyle<'static> {
    font(size).color(&colour(Colour::Ink))
}

/// Each value held until the next x.
fn steps(run: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let corners = run.windows(2).flat_map(|pair| [pair[0], (pair[1].0, pair[0].1)]);
    corners.chain(run.last().copied()).collect()
}

/// This line with at most four points a pixel column: first, lowest, highest, last.
fn thinned(run: &[(f64, f64)], pitch: f64) -> Vec<(f64, f64)> {
    let column = |p: &(f64, f64)| (p.0 / pitch).floor();
    let keep = |group: &[(f64, f64)]| -> Vec<(f64, f64)> {
        let by_y = |a: &usize, b: &usize| group[*a].1.total_cmp(&group[*b].1);
        let lowest = (0..group.len()).min_by(by_y).unwrap_or(0);
        let highest = (0..group.len()).max_by(by_y).unwrap_or(0);
        let mut kept = vec![0, lowest, highest, group.len() - 1];
        kept.sort_unstable();
        kept.dedup();
        kept.into_iter().map(|index| group[index]).collect()
    };
    run.chunk_by(|a, b| column(a) == column(b)).flat_map(keep).collect()
}

/// The parts of a line inside both axes (Liang and Barsky, segment by segment).
fn clipped(run: &[(f64, f64)], x: &Ruler, y: &Ruler) -> Vec<Vec<(f64, f64)>> {
    let mut parts: Vec<Vec<(f64, f64)>> = Vec::new();
    for pair in run.windows(2) {
        let Some([from, to]) = clip(pair[0], pair[1], x, y) else { continue };
        match parts.last_mut() {
            Some(part) if part.last() == Some(&from) => part.push(to),
            _ => parts.push(vec![from, to]),
        }
    }
    parts
}

fn clip(a: (f64, f64), b: (f64, f64), x: &Ruler, y: &Ruler) -> Option<[(f64, f64); 2]> {
    let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
    let (dx, dy) = (b.0 - a.0, b.1 - a.1);
    let sides = [(-dx, a.0 - x.low), (dx, x.high - a.0), (-dy, a.1 - y.low), (dy, y.high - a.1)];
    for (step, room) in sides {
        if step < 0.0 {
            enter = enter.max(room / step);
        } else if step > 0.0 {
            leave = leave.min(room / step);
        } else if room < 0.0 {
            return None;
        }
    }
    let at = |t: f64| {
        if t <= 0.0 {
            a
        } else if t >= 1.0 {
            b
        } else {
            (a.0 + t * dx, a.1 + t * dy)
        }
    };
    (enter <= leave).then(|| [at(enter), at(leave)])
}
