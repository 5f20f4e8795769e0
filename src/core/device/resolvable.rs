//! The smallest resolvable difference r: the unit of a constant polygon offset on a device.

use super::{Device, OffsetUnit};
use crate::depth::DepthFormat;
use crate::num::exp2;

/// 2^(e−23) of a depth with exponent e; 0 for 0.
fn exponent_unit(depth: f32) -> f32 {
    let exponent = (depth.to_bits() >> 23 & 0xff) as i32 - 127;
    if depth == 0.0 { 0.0 } else { f32::from_bits(((exponent - 23 + 127).max(0) as u32) << 23) }
}

impl Device {
    /// r of a depth buffer of `format`, window depth. `depth` ≥ 0 is the one whose exponent counts where
    /// the format is a float: [`crate::raster::Setup::reference_depth`] of the triangle that is offset.
    /// Sources: [`OffsetUnit`].
    #[must_use]
    pub fn resolvable(&self, format: DepthFormat, depth: f32) -> f32 {
        let format = self.depth_format(format);
        let exact = exp2(-(format.significant_bits() as i32)) as f32;
        match (self.offset_unit, format.unorm_max()) {
            (OffsetUnit::One, _) => 1.0,
            (OffsetUnit::ForceUnorm, _) => exact,
            (OffsetUnit::Measured, Some(max)) => 1.01 / max as f32,
            (OffsetUnit::Specification, Some(max)) => 1.0 / (max as f32 + 1.0),
            (OffsetUnit::D3d, Some(max)) => 1.0 / max as f32,
            (OffsetUnit::Doubled, Some(_)) => 2.0 * exact,
            (OffsetUnit::AmdPal, Some(_)) if format == DepthFormat::Unorm24 => 4.0 * exact,
            (OffsetUnit::AmdPal, Some(_)) => 2.0 * exact,
            (
                OffsetUnit::Measured
                | OffsetUnit::Specification
                | OffsetUnit::D3d
                | OffsetUnit::Doubled
                | OffsetUnit::AmdPal,
                None,
            ) => exponent_unit(depth),
        }
    }
}
