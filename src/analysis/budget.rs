//! How much of a needed bias comes from where: slope and arithmetic, format, packing, filter.

use super::sweep::Field;
use super::sweep::chart::{Attachment, Chart};
use super::sweep::tally::Kind;
use super::sweep::taps::Taps;
use crate::depth::DepthFormat;
use crate::report::number::significant;
use crate::scene::{Filter, TexelFormat};
use crate::shadow::bias::Strategy;
use serde::Serialize;

/// The critical bias taken apart: each component is what adding one imperfection costs, so that they
/// add up to `total` exactly. Window depth.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Budget {
    /// What slopes need: the largest (s/2)(|gx| + |gy|) over the receivers that have acne without a
    /// bias.
    pub slope: f64,
    /// What f32 transforms and snapping add to it under a float NEAREST map (negative where no receiver
    /// lies in a texel's worst corner).
    pub arithmetic: f64,
    /// What the sound format of as many bits adds.
    pub quantization: f64,
    /// What the case's own packing adds.
    pub packing: f64,
    /// What the case's own filter adds.
    pub filter: f64,
    /// The measured critical bias of the case itself; `None` where no bias ends acne.
    pub total: Option<f64>,
    /// The critical bias with twice the map size, up to 4096 texels a side.
    pub twice_the_map: Option<f64>,
    /// The critical bias of a 32-bit float map with the case's filter.
    pub float: Option<f64>,
    /// The critical bias of NEAREST with the case's format.
    pub nearest: Option<f64>,
    /// The critical bias left when the receiver's plane is followed.
    pub receiver_plane: Option<f64>,
}

/// The largest map that a budget draws to see what twice the size would buy.
const LARGEST: u32 = 4096;

/// Charts of one map size, each drawn once.
struct Charts<'f, 'a> {
    field: &'f Field<'a>,
    size: u32,
    drawn: Vec<Chart<'f, 'a>>,
}

impl<'f, 'a> Charts<'f, 'a> {
    const fn new(field: &'f Field<'a>, size: u32) -> Self {
        Self { field, size, drawn: Vec::new() }
    }

    fn chart(&mut self, format: TexelFormat, filter: Filter) -> &Chart<'f, 'a> {
        let (filter, attachment) = (format.usable(filter), Attachment::of(format));
        let known =
            self.drawn.iter().position(|c| c.filter == filter && c.attachment == attachment);
        let at = known.unwrap_or_else(|| {
            self.drawn.push(Chart::new(self.field, self.size, filter, attachment));
            self.drawn.len() - 1
        });
        &self.drawn[at]
    }
}

/// The smallest amount of a strategy that ends acne.
fn critical(chart: &Chart<'_, '_>, format: TexelFormat, strategy: Strategy) -> Option<f64> {
    let curve = Taps::on(chart, format, strategy).curve_on(chart, format, strategy);
    curve.quiet_from(0, Kind::ACNE).map(f64::from)
}

impl Budget {
    /// Takes the need of a case apart.
    #[must_use]
    pub fn of(field: &Field<'_>) -> Self {
        let case = field.case();
        let (size, own, filter) = (case.map.size, case.map.texel, case.lookup.filter);
        let float = TexelFormat::Depth(DepthFormat::F32);
        let mut charts = Charts::new(field, size);
        let mut at =
            |format, filter| critical(charts.chart(format, filter), format, Strategy::Constant);
        let ideal = at(float, Filter::Nearest).unwrap_or(0.0);
        let stored = at(TexelFormat::Depth(own.sound()), Filter::Nearest).unwrap_or(ideal);
        let nearest = at(own, Filter::Nearest);
        let total = at(own, filter);
        let float_total = at(float, filter);
        let slope = slope_need(charts.chart(float, Filter::Nearest));
        let receiver_plane = critical(charts.chart(own, filter), own, Strategy::ReceiverPlane);
        drop(charts);
        let twice =
            || critical(Charts::new(field, size * 2).chart(own, filter), own, Strategy::Constant);
        let packed = nearest.unwrap_or(stored);
        Self {
            slope,
            arithmetic: ideal - slope,
            quantization: stored - ideal,
            packing: packed - stored,
            filter: total.unwrap_or(packed) - packed,
            total,
            twice_the_map: if size * 2 <= LARGEST { twice() } else { None },
            float: float_total,
            nearest,
            receiver_plane,
        }
    }

    /// Sum of the components.
    #[must_use]
    pub fn sum(&self) -> f64 {
        self.slope + self.arithmetic + self.quantization + self.packing + self.filter
    }

    /// One sentence: where the need comes from and which knob helps most.
    #[must_use]
    pub fn sentence(&self, name: &str) -> String {
        let Some(total) = self.total else {
            return format!("{name}: no constant bias ends acne, so there is no budget to divide.");
        };
        let parts = [
            ("slope x texel", self.slope + self.arithmetic),
            ("quantization", self.quantization),
            ("packing", self.packing),
            ("filter reach", self.filter),
        ];
        let share = |x: f64| if total > 0.0 { 100.0 * x / total } else { 0.0 };
        let list: Vec<String> = parts
            .iter()
            .map(|(n, x)| format!("{n} {:.0} %", (share(*x)).round_ties_even() + 0.0))
            .collect();
        let knobs = [
            ("a map of twice the size", self.twice_the_map),
            ("a 32-bit float map", self.float),
            ("NEAREST", self.nearest),
            ("receiver-plane bias", self.receiver_plane),
        ];
        let known = knobs.iter().filter_map(|(n, b)| Some((n, (*b)?)));
        let best = known.min_by(|a, b| a.1.total_cmp(&b.1)).filter(|(_, b)| *b < total);
        let turn = best.map_or_else(
            || "no single knob lowers it".to_string(),
            |(knob, b)| format!("{knob} would lower it to {}", significant(b, 3)),
        );
        format!("{name} needs {}: {}; {turn}.", significant(total, 3), list.join(", "))
    }
}

/// The largest (s/2)(|gx| + |gy|) over truly lit receivers, window depth.
fn slope_need(chart: &Chart<'_, '_>) -> f64 {
    let (field, size) = (chart.field, chart.size);
    let format = TexelFormat::Depth(DepthFormat::F32);
    let looks = chart.looks(format, &Strategy::Constant.with(0.0));
    let rule = field.case().lookup.compare;
    let acne = |look: &super::sweep::looks::Looks| look.verdict(rule, 0.0).0 == Some(Kind::ACNE);
    let needs = field.samples.iter().zip(&looks).filter(|(_, l)| acne(l)).map(|(s, _)| {
        let need = (s.gradient.x.abs() + s.gradient.y.abs()) / (2.0 * f64::from(size));
        if need.is_finite() { need } else { 0.0 }
    });
    needs.fold(0.0, f64::max)
}
