//! The cheapest map that a scene can do with.

use super::{Found, Tuned, Tuning};
use crate::analysis::sweep::Field;
use crate::analysis::sweep::chart::{Attachment, Chart};
use crate::depth::DepthFormat;
use crate::engines::Knob;
use crate::report::number::significant;
use crate::scene::{Filter, TexelFormat};

/// A configuration that meets the target.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Configuration {
    /// Map side, format and filter.
    pub size: u32,
    /// The texel format.
    pub format: TexelFormat,
    /// The filter.
    pub filter: Filter,
    /// Bytes of the map.
    pub bytes: u64,
    /// The knob.
    pub knob: Knob,
    /// Its value; 0 where no bias is needed.
    pub value: f64,
    /// Share of the truly shadowed that is lit there; `None` where there are none.
    pub false_light: Option<f64>,
}

impl Configuration {
    /// The configuration in one sentence.
    pub(super) fn sentence(&self) -> String {
        let fetches = match self.filter.fetches() {
            1 => "1 fetch".into(),
            n => format!("{n} fetches"),
        };
        let bias = match self.value {
            0.0 => "no bias".to_string(),
            value => format!("{} = {}", self.knob.name, significant(value, 4)),
        };
        format!(
            "The cheapest map that meets the target is {0} x {0} {1} with {2} ({3} bytes, {fetches}, {bias}).",
            self.size,
            self.format.name(),
            self.filter,
            self.bytes,
        )
    }
}

/// The cheapest map, by bytes and then fetches, on which the best knob (or else the first whose line is
/// known) ends acne and lights hardly more of the shadow than on the asked map.
pub(super) fn cheapest(field: &Field<'_>, tuning: &Tuning) -> Option<Configuration> {
    let known = |t: &&Tuned| !matches!(t.found, Found::Withdrawn(_));
    let best = tuning.best();
    let knob = best.or_else(|| tuning.tuned.iter().find(known))?.knob;
    let light = best.and_then(|t| t.swept.acne_free).map_or(0.0, |p| p.tally.false_light() as f64);
    let allowed = light / field.populations[1].max(1) as f64 + 0.005;
    let sizes = [128, 256, 512, 1024, 2048];
    let formats =
        [DepthFormat::Unorm16, DepthFormat::Unorm24, DepthFormat::F32].map(TexelFormat::Depth);
    let filters = [Filter::Nearest, field.case().lookup.filter].map(|f| formats[0].usable(f));
    let mut options: Vec<(u64, u32, u32, TexelFormat, Filter)> = Vec::new();
    for size in sizes {
        for format in formats {
            for filter in filters {
                let bytes = u64::from(size) * u64::from(size) * u64::from(format.bytes());
                options.push((bytes, filter.fetches(), size, format, filter));
            }
        }
    }
    options.sort_by_key(|&(bytes, fetches, ..)| (bytes, fetches));
    options.into_iter().find_map(|(bytes, _, size, format, filter)| {
        let chart = Chart::new(field, size, filter, Attachment::of(format));
        let tuned = Tuned::new(&chart, format, knob, tuning.max_acne);
        let false_light = tuned.swept.share(tuned.swept.acne_free?.tally.false_light(), 1);
        let value = tuned.value()?;
        (false_light.unwrap_or(0.0) <= allowed).then_some(Configuration {
            size,
            format,
            filter,
            bytes,
            knob,
            value,
            false_light,
        })
    })
}
