//! The cheapest map that a scene can do with.

use super::{Request, Tuned};
use crate::analysis::sweep::Field;
use crate::analysis::sweep::chart::{Attachment, Chart};
use crate::depth::DepthFormat;
use crate::engines::Knob;
use crate::report::number::significant;
use crate::scene::{Filter, TexelFormat};

/// A configuration that meets the target.
#[derive(Clone, Debug, PartialEq)]
pub struct Configuration {
    /// Map side, format and filter.
    pub size: u32,
    /// The texel format.
    pub format: TexelFormat,
    /// The filter.
    pub filter: Filter,
    /// Bytes of the map.
    pub bytes: u64,
    /// Value of the best knob.
    pub value: f64,
    /// Share of the truly shadowed that is lit there.
    pub false_light: f64,
}

impl Configuration {
    /// The configuration in one sentence, `knob` being what its value belongs to.
    pub(super) fn sentence(&self, knob: Knob) -> String {
        let fetches = match self.filter.fetches() {
            1 => "1 fetch".into(),
            n => format!("{n} fetches"),
        };
        format!(
            "The cheapest map that meets the target is {0} x {0} {1} with {2} ({3} bytes, {fetches}, {4} = {5}).",
            self.size,
            self.format.name(),
            self.filter,
            self.bytes,
            knob.name,
            significant(self.value, 4),
        )
    }
}

/// The cheapest map, by bytes and then fetches, on which some knob ends acne and lights no more of the
/// shadow than `allowed`.
pub(super) fn cheapest(
    field: &Field<'_>,
    request: &Request,
    knob: Knob,
    allowed: f64,
) -> Option<Configuration> {
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
        let tuned = Tuned::new(&chart, format, knob, request.max_acne);
        let light = tuned.swept.acne_free?.tally.false_light() as f64;
        let false_light = light / field.populations[1].max(1) as f64;
        let value = tuned.value?;
        (false_light <= allowed).then_some(Configuration {
            size,
            format,
            filter,
            bytes,
            value,
            false_light,
        })
    })
}
