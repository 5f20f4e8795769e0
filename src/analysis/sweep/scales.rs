//! How large one unit of a strategy's amount is on a case, and which amounts are worth sweeping.

use super::field::Field;
use super::plan::Range;
use crate::scene::TexelFormat;
use crate::shadow::bias::{Family, Strategy, Unit};

/// Window depth against the other units of amounts, on one map of a case.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scales {
    /// World units per unit of window depth at the middle receiver.
    pub world_per_window: f64,
    /// The smallest unit r of a polygon offset among the triangles that receivers lie on.
    pub resolvable: f64,
    /// One step of the format at the middle receiver.
    pub step: f64,
    /// The w of the middle receiver's clip position.
    pub w: f64,
}

impl Default for Scales {
    /// 24 bits over one world unit.
    fn default() -> Self {
        let ulp = crate::num::exp2(-24);
        Self { world_per_window: 1.0, resolvable: ulp, step: ulp, w: 1.0 }
    }
}

impl Scales {
    /// On a map of `size`² texels of a format; the default where nothing is received, and of r where the
    /// strategy does not count in it.
    #[must_use]
    pub fn on(field: &Field<'_>, size: u32, format: TexelFormat, strategy: Strategy) -> Self {
        let (none, counts) = (Self::default(), strategy.unit() == Unit::UnitsR);
        let Some(middle) = field.middle() else { return none };
        let resolvable = || field.smallest_resolvable(size, format);
        let site = field.site(middle, &field.case().light.layout(size));
        Self {
            world_per_window: 1.0 / site.window_per_world,
            w: site.w,
            resolvable: if counts { resolvable() } else { none.resolvable },
            step: format.step(field.case().layout().compared(middle.coord[2])),
        }
    }
}

/// Whether the amounts of a strategy depend on the format.
#[must_use]
pub fn by_format(strategy: Strategy) -> bool {
    matches!(strategy.unit(), Unit::FormatSteps | Unit::UnitsR)
}

/// Amounts for a strategy: those of the plan where its unit is window depth, else as many (25 where each
/// needs a pass of its own) between ends that suit the unit: units r and steps of a format reach to the
/// whole window depth.
#[must_use]
pub fn amounts(strategy: Strategy, bias: &Range, scales: &Scales) -> Vec<f32> {
    let count = if strategy.family() == Family::Tap { bias.count } else { bias.count.min(25) };
    let range = Range { count, ..*bias };
    if bias.count == 1 {
        return bias.values();
    }
    let own = match strategy.unit() {
        Unit::WindowDepth => range,
        Unit::WorldUnits => {
            let world = scales.world_per_window;
            range.between(bias.low.max(1e-9) * world, bias.high * world)
        }
        Unit::ClipDepth => range.between(bias.low.max(1e-9) * scales.w, bias.high * scales.w),
        Unit::FormatSteps => range.between(0.25, 1.0 / scales.step),
        Unit::UnitsR => range.between(0.25, 1.0 / scales.resolvable),
        Unit::Nothing
        | Unit::Texels
        | Unit::Slopes
        | Unit::TenthsOfASlope
        | Unit::TexelDiagonals
        | Unit::HalfTexels
        | Unit::QuarterTexels
        | Unit::OwnMultiples => range.between(0.01, 32.0),
    };
    let mut values = own.values();
    values.insert(0, 0.0);
    values.dedup();
    values
}
