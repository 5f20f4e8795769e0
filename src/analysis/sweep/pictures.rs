//! What a swept amount looks like: classified pictures along the bias axis and EXR layers.

use super::chart::{Attachment, Chart};
use super::field::Field;
use super::looks::Looks;
use super::tally::Kind;
use super::taps::Taps;
use crate::report::{Colour, ExrImage, Picture};
use crate::scene::TexelFormat;
use crate::shadow::bias::Strategy;
use serde_json::json;

/// Gives a pixel a colour.
fn paint(rgb: &mut [u8], place: u32, colour: Colour) {
    rgb[3 * place as usize..][..3].copy_from_slice(&colour.rgb());
}

/// The receivers of a case under one map, format and strategy, ready to be pictured.
#[derive(Debug)]
pub struct Gallery<'f, 'a> {
    chart: Chart<'f, 'a>,
    format: TexelFormat,
    step: u32,
    /// The picture of a map that is never wrong, and where on it each receiver is.
    right: Vec<u8>,
    places: Vec<u32>,
}

/// The comparisons of every receiver at one amount, and the kind of each wrong verdict.
struct Shown {
    looks: Vec<Looks>,
    kinds: Vec<Option<Kind>>,
}

impl<'f, 'a> Gallery<'f, 'a> {
    /// The gallery of a field sampled at every `step`-th pixel, under the case's own map size and filter.
    #[must_use]
    pub fn new(field: &'f Field<'a>, format: TexelFormat, step: u32) -> Self {
        let case = field.case();
        let filter = format.usable(case.lookup.filter);
        let chart = Chart::new(field, case.map.size, filter, Attachment::of(format));
        let [width, height] = case.canvas.map(|n| n.div_ceil(step));
        // The top row comes first.
        let place = |[x, y]: [u32; 2]| (height - 1 - y / step) * width + x / step;
        let places: Vec<u32> = field.samples.iter().map(|sample| place(sample.pixel)).collect();
        let mut right: Vec<u8> = Colour::Light.rgb().repeat((width * height) as usize);
        for (sample, &place) in field.samples.iter().zip(&places) {
            paint(&mut right, place, if sample.lit { Colour::White } else { Colour::Grey });
        }
        Self { format, chart, step, right, places }
    }

    fn size(&self) -> [u32; 2] {
        self.chart.field.case().canvas.map(|n| n.div_ceil(self.step))
    }

    fn shown(&self, strategy: Strategy, amount: f32) -> Shown {
        let looks = self.chart.looks(self.format, &strategy.with(amount));
        let taps = Taps::on(&self.chart, self.format, strategy);
        let rule = self.chart.field.case().lookup.compare;
        let kind = |(i, looks): (usize, &Looks)| {
            looks.verdict_by(rule, |look| taps.bias_in(i, look.map, amount)).0
        };
        Shown { kinds: looks.iter().enumerate().map(kind).collect(), looks }
    }

    /// The classified picture at one amount: white truly lit and right, grey truly shadowed and right.
    #[must_use]
    pub fn picture(&self, id: &str, strategy: Strategy, amount: f32, caption: String) -> Picture {
        let [width, height] = self.size();
        let recipe = strategy.with(amount);
        let found = self.chart.wrong(&[self.format], &recipe, &self.chart.all());
        let (mut rgb, mut count) = (self.right.clone(), 0);
        for wrong in found.iter().flatten() {
            paint(&mut rgb, self.places[wrong.receiver as usize], wrong.kind.artifact().colour());
            count += 1;
        }
        Picture {
            id: id.to_string(),
            alt: format!("{strategy} at {amount:e}: {count} wrong receivers"),
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
        let kind = |k: Kind| (k.artifact().colour(), k.name().to_string());
        let kinds = [Kind::ACNE, Kind::PETER_PANNING, Kind::LIGHT_LEAK, Kind::ENCODING_FAULT];
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
        let shown = self.shown(strategy, amount);
        let names = ["depth.receiver.Z", "depth.stored.Z", "margin.Y", "class.Y", "truth.Y"];
        let mut layers = vec![vec![f32::NAN; (width * height) as usize]; names.len()];
        let shown = shown.looks.iter().zip(&shown.kinds).zip(&self.places);
        for (sample, ((looks, kind), &at)) in self.chart.field.samples.iter().zip(shown) {
            let Some(look) = looks.taps.get(looks.centre) else { continue };
            let kind = kind.map_or(0, |k| k.index() as i32 + 1);
            let values =
                [look.z, look.stored, look.z - look.stored, kind as f32, f32::from(sample.lit)];
            for (layer, value) in layers.iter_mut().zip(values) {
                layer[at as usize] = value;
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
