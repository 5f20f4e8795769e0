//! An axis fitted to its data: ends, ticks, labels and the place of zero; a plotters coordinate.

use std::ops::Range;

use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};

use super::{Axis, Scale};
use crate::report::number;

/// An axis in *placed* units (the value itself, or its logarithm).
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Ruler {
    scale: Scale,
    /// Lower end.
    pub(super) low: f64,
    /// Upper end.
    pub(super) high: f64,
    /// Where zero stands on a logarithmic axis that has zeros.
    pub(super) zero: Option<f64>,
    /// Labelled ticks, ascending.
    pub(super) ticks: Vec<(f64, String)>,
    /// Unlabelled grid lines.
    pub(super) light: Vec<f64>,
}

impl Ruler {
    /// Fits `axis` to `values`; those without a place on it are passed over.
    pub(super) fn new(axis: &Axis, values: impl Iterator<Item = f64>) -> Self {
        if !axis.names.is_empty() {
            return Self::named(&axis.names);
        }
        let values: Vec<_> = match axis.range {
            Some((low, high)) => vec![low, high],
            None => values.filter(|v| v.is_finite()).collect(),
        };
        let placed = values.iter().map(|v| axis.scale.place(*v)).filter(|t| t.is_finite());
        let ends = placed.fold(None, |ends: Option<(f64, f64)>, t| {
            Some(ends.map_or((t, t), |(low, high)| (low.min(t), high.max(t))))
        });
        let exact = axis.range.is_some();
        let (low, high) = padded(axis.scale, ends.unwrap_or((0.0, 1.0)), exact);
        let mut ruler =
            Self { scale: axis.scale, low, high, zero: None, ticks: vec![], light: vec![] };
        match axis.scale {
            Scale::Linear => ruler.linear_ticks(),
            Scale::Log => ruler.log_ticks(),
            Scale::SymLog { linear } => ruler.symlog_ticks(linear),
        }
        if axis.scale == Scale::Log && values.contains(&0.0) {
            ruler.make_room_for_zero();
        }
        ruler
    }

    /// One labelled place for each name.
    fn named(names: &[String]) -> Self {
        let place = |(i, name): (usize, &String)| (i as f64, name.clone());
        let ticks: Vec<_> = names.iter().enumerate().map(place).collect();
        let high = ticks.len() as f64 - 0.4;
        Self { scale: Scale::Linear, low: -0.6, high, zero: None, ticks, light: vec![] }
    }

    /// Position of a value, `None` where it has none.
    pub(super) fn place(&self, value: f64) -> Option<f64> {
        let t = match self.zero {
            Some(zero) if value == 0.0 => zero,
            _ => self.scale.place(value),
        };
        t.is_finite().then_some(t)
    }

    fn inside(&self, t: f64) -> bool {
        let slack = 1e-9 * (self.high - self.low);
        (self.low - slack..=self.high + slack).contains(&t)
    }

    fn linear_ticks(&mut self) {
        let step = nice_step((self.high - self.low) / 6.0);
        let largest = self.low.abs().max(self.high.abs());
        let digits = (libm::log10(largest / step).ceil().clamp(0.0, 14.0) as u8) + 1;
        let first = (self.low / step).ceil();
        let ticks = (0..=20).map(|i| (first + f64::from(i)) * step);
        let ticks: Vec<_> = ticks.filter(|t| self.inside(*t)).collect();
        self.ticks = ticks.into_iter().map(|t| (t, number::pretty(t, digits))).collect();
    }

    fn log_ticks(&mut self) {
        let decades: Vec<i32> = (self.low.ceil() as i32..=self.high.floor() as i32).collect();
        let within = |decade: i32, factor: i32| libm::log10(f64::from(factor)) + f64::from(decade);
        let fine = |factors: &[i32]| -> Vec<(i32, i32)> {
            let all = (self.low.floor() as i32..=self.high.floor() as i32)
                .flat_map(|decade| factors.iter().map(move |factor| (decade, *factor)));
            all.filter(|(decade, factor)| self.inside(within(*decade, *factor))).collect()
        };
        if decades.len() < 2 && self.high - self.low < 0.5 {
            return self.narrow_log_ticks();
        }
        if decades.len() < 3 {
            let labelled = fine(&[1, 2, 5]);
            let text = |(d, f): &(i32, i32)| number::pretty(f64::from(*f) * ten(*d), 3);
            self.ticks = labelled.iter().map(|p| (within(p.0, p.1), text(p))).collect();
            return;
        }
        let every = decades.len().div_ceil(8);
        let plain = decades.iter().all(|d| (-3..=4).contains(d));
        let text = |d: i32| match d {
            _ if plain => number::pretty(ten(d), 3),
            0 => "1".to_string(),
            _ => format!("10{}", number::superscript(d)),
        };
        let light = if decades.len() < 7 {
            fine(&[2, 3, 4, 5, 6, 7, 8, 9]).iter().map(|(d, f)| within(*d, *f)).collect()
        } else {
            decades.iter().map(|d| f64::from(*d)).collect()
        };
        let labelled = decades.iter().filter(|d| **d % every as i32 == 0);
        self.ticks = labelled.map(|d| (f64::from(*d), text(*d))).collect();
        self.light = light;
    }

    /// A logarithmic axis of less than half a decade gets ticks at round values.
    fn narrow_log_ticks(&mut self) {
        let ends = [libm::exp10(self.low), libm::exp10(self.high)];
        let step = nice_step((ends[1] - ends[0]) / 5.0);
        let first = (ends[0] / step).ceil();
        let values = (0..=12).map(|i| (first + f64::from(i)) * step);
        let ticks = values.map(|v| (libm::log10(v), number::pretty(v, 4)));
        self.ticks = ticks.filter(|(t, _)| self.inside(*t)).collect();
    }

    fn symlog_ticks(&mut self, linear: f64) {
        self.ticks = self.symlog_ticks_at(linear, &[1.0]);
        if self.ticks.len() < 3 {
            self.ticks = self.symlog_ticks_at(linear, &[1.0, 2.0, 5.0]);
        }
    }

    /// Zero and the multiples of powers of ten from `linear` on that stand apart from zero, at most four
    /// of each sign (twelve of the axis that begins beyond zero).
    fn symlog_ticks_at(&self, linear: f64, factors: &[f64]) -> Vec<(f64, String)> {
        let decade = libm::log10(linear).floor() as i32;
        let values = (0..40).flat_map(|i| factors.iter().map(move |f| f * ten(decade + i)));
        let reach = self.low.abs().max(self.high.abs());
        let scale = self.scale;
        // A label of its own needs a twentieth of the axis.
        let apart = |v: &f64| *v >= linear && scale.place(*v) >= 0.05 * (self.high - self.low);
        let inside: Vec<_> =
            values.take_while(|v| scale.place(*v) <= reach * 1.0001).filter(apart).collect();
        let seen = |v: &f64| self.inside(scale.place(*v)) || self.inside(scale.place(-*v));
        let every = inside.iter().filter(|v| seen(v)).count().div_ceil(4 * factors.len()).max(1);
        let positive = inside.into_iter().step_by(every);
        let signed = positive.flat_map(|v| [v, -v]).chain([0.0]);
        let ticks = signed.map(|v| (scale.place(v), number::pretty(v, 3)));
        let mut ticks: Vec<_> = ticks.filter(|(t, _)| self.inside(*t)).collect();
        ticks.sort_by(|a, b| a.0.total_cmp(&b.0));
        ticks
    }

    /// Zero stands a tenth of the axis below the smallest value.
    fn make_room_for_zero(&mut self) {
        let span = self.high - self.low;
        let zero = self.low - 0.06 * span;
        self.zero = Some(zero);
        self.low = zero - 0.04 * span;
        self.ticks.insert(0, (zero, "0".to_string()));
    }

    /// Where the logarithmic part begins on an axis with zeros.
    pub(super) fn break_at(&self) -> Option<f64> {
        self.zero.map(|zero| zero + (zero - self.low) * 0.75)
    }
}

impl Ranged for Ruler {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, t: &f64, (from, to): (i32, i32)) -> i32 {
        let share = (t - self.low) / (self.high - self.low);
        from + (share * f64::from(to - from)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        if hint.weight().allow_light_points() {
            return self.light.clone();
        }
        self.ticks.iter().map(|(t, _)| *t).collect()
    }

    fn range(&self) -> Range<f64> {
        self.low..self.high
    }
}

impl ValueFormatter<f64> for Ruler {
    fn format_ext(&self, t: &f64) -> String {
        let at = self.ticks.iter().find(|(tick, _)| tick == t);
        at.map_or_else(String::new, |(_, label)| label.clone())
    }
}

fn padded(scale: Scale, (low, high): (f64, f64), exact: bool) -> (f64, f64) {
    if exact && high > low {
        return (low, high);
    }
    let tiny = 1e-12 * low.abs().max(high.abs());
    if high - low <= tiny {
        let half = match scale {
            Scale::Linear if low != 0.0 => low.abs() * 0.5,
            Scale::Linear | Scale::Log | Scale::SymLog { .. } => 0.5,
        };
        return (low - half, high + half);
    }
    let pad = 0.04 * (high - low);
    // A proportional axis that begins near zero begins at zero.
    if scale == Scale::Linear && low >= 0.0 && low < 0.3 * high {
        return (0.0, high + pad);
    }
    (low - pad, high + pad)
}

/// The smallest of 1, 2, 5 times a power of ten that is not below `raw`.
fn nice_step(raw: f64) -> f64 {
    let decade = libm::log10(raw).floor() as i32;
    let steps = [1.0, 2.0, 5.0, 10.0].map(|factor| factor * ten(decade));
    steps.into_iter().find(|step| *step >= raw).unwrap_or(10.0 * ten(decade))
}

/// 10ⁿ, correctly rounded.
fn ten(n: i32) -> f64 {
    format!("1e{n}").parse().unwrap_or(f64::INFINITY)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(axis: &Axis, values: &[f64]) -> Vec<String> {
        let ruler = Ruler::new(axis, values.iter().copied());
        assert!(ruler.low < ruler.high, "{ruler:?}");
        ruler.ticks.into_iter().map(|(_, label)| label).collect()
    }

    #[test]
    fn ticks_are_round() {
        assert_eq!(labels(&Axis::linear(""), &[0.0, 1.0]), ["0", "0.2", "0.4", "0.6", "0.8", "1"]);
        assert_eq!(labels(&Axis::log(""), &[1e-7, 1e-4]), ["10⁻⁷", "10⁻⁶", "10⁻⁵", "10⁻⁴"]);
        assert_eq!(labels(&Axis::log(""), &[0.0, 0.1, 10.0]), ["0", "0.1", "1", "10"]);
        assert_eq!(labels(&Axis::log(""), &[2.0, 9.0]), ["2", "5"]);
        let narrow = Axis {
            scale: Scale::SymLog { linear: 0.1 },
            range: Some((1.5, 40.0)),
            ..Axis::default()
        };
        assert_eq!(labels(&narrow, &[]), ["2", "5", "10", "20"]);
        let symlog = Axis { scale: Scale::SymLog { linear: 1.0 }, ..Axis::default() };
        assert_eq!(labels(&symlog, &[-100.0, 10.0]), ["−100", "−10", "−1", "0", "1", "10"]);
    }

    #[test]
    fn awkward_data_still_gives_an_axis() {
        for axis in [Axis::linear(""), Axis::log("")] {
            for values in [&[][..], &[0.0], &[5.0, 5.0], &[-3.0], &[f64::NAN], &[1e-300, 1e300]] {
                assert!(!labels(&axis, values).is_empty(), "{axis:?} {values:?}");
            }
        }
    }

    #[test]
    fn places_lie_on_the_axis() {
        let values = [0.0, 1e-6, 3.0];
        let ruler = Ruler::new(&Axis::log(""), values.into_iter());
        for value in values {
            let t = ruler.place(value).unwrap();
            assert!(ruler.inside(t), "{value} at {t} in {ruler:?}");
        }
        assert_eq!(ruler.place(-1.0), None);
        assert!(ruler.place(0.0).unwrap() < ruler.break_at().unwrap());
        assert!(ruler.break_at().unwrap() < ruler.place(1e-6).unwrap());
    }
}
