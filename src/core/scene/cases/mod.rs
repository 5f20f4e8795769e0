//! Named cases: the documents' systems, the scenes whose answers are known in closed form, and the
//! standard scenes.

pub mod analytic;
pub mod documents;
pub mod standard;

use super::{
    Case, CompareRule, CoordForm, CullRule, DepthBuffer, Filter, LookupSpec, MapSpec, TexelFormat,
    Wrap,
};
use crate::depth::DepthFormat;
use crate::{Error, Result};

/// Every case of the documents and the closed forms, in report order: the documents' first. The
/// standard scenes are had by name alone.
#[must_use]
pub fn all() -> Vec<Case> {
    let mut cases = documents::all();
    cases.extend(analytic::all());
    cases
}

/// The closed forms that the main job shows beside the documents' systems.
const SHOWN: [&str; 4] = ["t1-tilted-plane", "t4-wall", "t7-sphere", "t11-plates"];

/// The cases of the main job: the documents' systems, and one closed form of each kind.
#[must_use]
pub fn main_job() -> Vec<Case> {
    let shown = |case: &Case| SHOWN.contains(&case.name.as_str());
    let mut cases = documents::all();
    cases.extend(all().into_iter().skip(cases.len()).filter(shown));
    cases
}

/// The case of that name.
///
/// # Errors
/// [`Error::BadInput`] listing the names.
pub fn named(name: &str) -> Result<Case> {
    if let Some(case) = standard::named(name) {
        return Ok(case);
    }
    let cases = all();
    let own = cases.iter().map(|case| case.name.as_str());
    let names = own.chain(standard::NAMES).collect::<Vec<_>>().join(", ");
    let fix = format!("use one of {names}, or terrain-N for a terrain of N triangles");
    cases
        .into_iter()
        .find(|case| case.name == name)
        .ok_or_else(|| Error::bad_input(format!("--case '{name}'"), "no such case", fix))
}

/// A 32-bit float depth texture of `size`² texels, cleared to far, nothing culled.
const fn float_map(size: u32) -> MapSpec {
    MapSpec {
        size,
        texel: TexelFormat::Depth(DepthFormat::F32),
        clear: [1.0; 4],
        depth_buffer: DepthBuffer::Texture,
        cull: CullRule::None,
    }
}

/// NEAREST look-ups; receivers outside the map are lit.
const fn plain_lookup() -> LookupSpec {
    LookupSpec {
        coord: CoordForm::Divide,
        compare: CompareRule::ReceiverBeyond,
        range_test: true,
        filter: Filter::Nearest,
        wrap: Wrap::Clamp,
    }
}
