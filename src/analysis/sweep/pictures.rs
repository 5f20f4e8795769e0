//! What a swept amount looks like: classified pictures along the bias axis and EXR layers.

use super::chart::{Attachment, Chart, usable_filter};
use super::evaluate::Taps;
use super::field::Field;
use super::looks::Looks;
use super::tally::Kind;
use crate::report::{Colour, ExrImage, Picture};
use crate::scene::TexelFormat;
use crate::shadow::bias::Strategy;
use serde_json::json;

/// The colour of a kind of error on every picture.
#[must_use]
pub const fn colour(kind: Kind) -> Colour {
    match kind {
        Kind::Acne => Colour::Vermilion,
        Kind::EdgeShadow | Kind::EdgeLight => Colour::Yellow,
        Kind::EncodingFault => Colour::Purple,
        Kind::PeterPanning => Colour::Blue,
        Kind::LightLeak => Colour::Sky,
    }
}

/// The receivers of a case under one map, format and strategy, ready to be pictured.
#[derive(Debug)]
pub struct Gallery<'f, 'a> {
    chart: Chart<'f, 'a>,
    format: TexelFormat,
    step: u32,
}

/// The comparisons and tap biases of every receiver at one amount.
struct Shown {
    looks: Vec<Looks>,
    bias: Vec<f32>,
}

impl<'f, 'a> Gallery<'f, 'a> {
    /// Of a field sampled at every `step`-th pixel, under the case's own map size and filter.
    #[must_use]
    pub fn new(field: &'f Field<'a>, format: TexelFormat, step: u32) -> Self {
        let case = field.case();
        let filter = usable_filter(case.lookup.filter, format);
        let chart = Chart::new(field, case.map.size, filter, Attachment::of(format));
        Self { chart, format, step }
    }

    fn size(&self) -> [u32; 2] {
        self.chart.field.case().canvas.map(|n| n.div_ceil(self.step))
    }

    fn shown(&self, strategy: Strategy, amount: f32) -> Shown {
        let weights = self.chart.weights(self.format);
        let looks = self.chart.looks(self.format, &strategy.with(amount));
        let taps = Taps::new(strategy, &weights);
        Shown { bias: (0..looks.len()).map(|i| taps.bias(i, amount)).collect(), looks }
    }

    /// Index of a pixel in a picture whose top row comes first.
    fn place(&self, pixel: [u32; 2]) -> usize {
        let [width, height] = self.size();
        let (x, y) = (pixel[0] / self.step, pixel[1] / self.step);
        ((height - 1 - y) * width + x) as usize
    }

    /// The classified picture at one amount: white truly lit and right, grey truly shadowed and right.
    #[must_use]
    pub fn picture(&self, id: &str, strategy: Strategy, amount: f32, caption: String) -> Picture {
        let [width, height] = self.size();
        let rule = self.chart.field.case().lookup.compare;
        let shown = self.shown(strategy, amount);
        let mut rgb: Vec<u8> = Colour::Light.rgb().repeat((width * height) as usize);
        let mut wrong = 0u32;
        for ((sample, looks), &bias) in
            self.chart.field.samples.iter().zip(&shown.looks).zip(&shown.bias)
        {
            let kind = looks.verdict(rule, bias).0;
            wrong += u32::from(kind.is_some());
            let right = if sample.lit { Colour::White } else { Colour::Grey };
            let at = 3 * self.place(sample.pixel);
            rgb[at..at + 3].copy_from_slice(&kind.map_or(right, colour).rgb());
        }
        Picture {
            id: id.to_string(),
            alt: format!("{strategy} at {amount:e}: {wrong} wrong receivers"),
            caption,
            width,
            height,
            rgb,
            legend: Vec::new(),
            magnify: 2,
        }
    }

    /// What the colours of the pictures mean.
    #[must_use]
    pub fn legend() -> Vec<(Colour, String)> {
        let kind = |k: Kind| (colour(k), k.name().to_string());
        let kinds = [Kind::Acne, Kind::PeterPanning, Kind::LightLeak, Kind::EncodingFault];
        let mut legend: Vec<_> = kinds.into_iter().map(kind).collect();
        legend.push((Colour::Yellow, "edge aliasing".to_string()));
        legend.push((Colour::White, "lit and right".to_string()));
        legend.push((Colour::Grey, "shadowed and right".to_string()));
        legend.push((Colour::Light, "not counted".to_string()));
        legend
    }

    /// Layers at one amount: receiver and stored depth, margin, class and truth, so that a viewer can
    /// set a threshold of its own.
    #[must_use]
    pub fn exr(&self, id: &str, strategy: Strategy, amount: f32) -> ExrImage {
        let [width, height] = self.size();
        let rule = self.chart.field.case().lookup.compare;
        let shown = self.shown(strategy, amount);
        let names = ["depth.receiver.Z", "depth.stored.Z", "margin.Y", "class.Y", "truth.Y"];
        let mut layers = vec![vec![f32::NAN; (width * height) as usize]; names.len()];
        for ((sample, looks), &bias) in
            self.chart.field.samples.iter().zip(&shown.looks).zip(&shown.bias)
        {
            let at = self.place(sample.pixel);
            let Some(look) = looks.taps.get(looks.centre) else { continue };
            let kind = looks.verdict(rule, bias).0.map_or(0, |k| k as i32 + 1);
            let values =
                [look.z, look.stored, look.z - look.stored, kind as f32, f32::from(sample.lit)];
            for (layer, value) in layers.iter_mut().zip(values) {
                layer[at] = value;
            }
        }
        let kinds: Vec<_> = Kind::ALL.iter().map(|k| k.name()).collect();
        ExrImage {
            id: id.to_string(),
            width: width as usize,
            height: height as usize,
            channels: names.iter().map(|n| (*n).to_string()).zip(layers).collect(),
            metadata: json!({
                "case": self.chart.field.case().name,
                "format": self.format.name(),
                "strategy": strategy.name(),
                "amount": amount,
                "unit": strategy.unit(),
                "class": { "0": "right", "from 1": kinds },
                "margin": "receiver depth - stored depth of the centre tap, window depth",
                "truth": "1 lit, 0 shadowed; NaN where the receiver does not count",
            }),
        }
    }
}
