//! What a polygon offset adds to a covering plane: the probe that a page runs on its reader's GPU.

use super::{PolygonOffset, Setup};
use crate::depth::DepthFormat;
use crate::device::Device;
use glam::Vec4;

/// Depth of the probe's planes at the middle of the target.
const MIDDLE: f64 = 0.625;
/// Their rise per pixel in x and y where they are tilted.
const SLOPE: f64 = 1.0 / 128.0;
/// Side of the target in pixels, and units of the constant probe.
const SIDE: u32 = 8;
const UNITS: f32 = 1024.0;

/// Window depth differences that a polygon offset makes after the store.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct OffsetProbe {
    /// A 1024th of what 1024 units add: the unit r, to a 1024th of the format's step.
    pub r: f64,
    /// What one unit adds: the nearest step of the format.
    pub one_unit: f64,
    /// What factor 1 adds over the slope in x of a plane that rises alike in x and y: 1 under the
    /// largest component, √2 under the length.
    pub slope_over_gradient: f64,
}

impl OffsetProbe {
    /// The probe on `device` in a depth texture of `format`.
    #[must_use]
    pub fn of(device: &Device, format: DepthFormat) -> Self {
        let depth = |slope, factor, units| {
            stored(device, format, slope, PolygonOffset { factor, units, clamp: 0.0 })
        };
        let flat = depth(0.0, 0.0, 0.0);
        Self {
            r: (depth(0.0, 0.0, UNITS) - flat) / f64::from(UNITS),
            one_unit: depth(0.0, 0.0, 1.0) - flat,
            slope_over_gradient: (depth(SLOPE, 1.0, 0.0) - depth(SLOPE, 0.0, 0.0)) / SLOPE,
        }
    }
}

/// The stored depth at the pixel right above the middle.
fn stored(device: &Device, format: DepthFormat, slope: f64, offset: PolygonOffset) -> f64 {
    let half = f64::from(SIDE / 2);
    let corner = |x: f64, y: f64| {
        let z = 2.0 * (MIDDLE + half * (slope * x + slope * y)) - 1.0;
        Vec4::new(x as f32, y as f32, z as f32, 1.0)
    };
    let corners = [corner(-1.0, -1.0), corner(3.0, -1.0), corner(-1.0, 3.0)];
    let setup = Setup::new(device, [SIDE; 2], corners);
    let added = setup.offset(device, format, offset);
    let pixel = (SIDE / 2) as f32;
    let z = setup.depth().moved(added).at(pixel, pixel).clamp(0.0, 1.0);
    f64::from(device.stored_depth(format, z))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::device::{DeviceProfile, OffsetUnit};

    #[test]
    fn the_unit_is_read_back_to_a_1024th_of_a_step() {
        for &offset_unit in OffsetUnit::ALL.iter().filter(|unit| **unit != OffsetUnit::One) {
            let device = Device { offset_unit, ..DeviceProfile::Ideal.device() };
            let corners = [[-1.0, -1.0], [3.0, -1.0], [-1.0, 3.0]];
            let flat = corners.map(|[x, y]| Vec4::new(x, y, 0.25, 1.0));
            let r = Setup::new(&device, [SIDE; 2], flat).resolvable(&device, DepthFormat::Unorm16);
            let probe = OffsetProbe::of(&device, DepthFormat::Unorm16);
            assert!((probe.r - f64::from(r)).abs() < 1.0 / 65_535.0 / 1024.0, "{offset_unit}");
        }
    }

    #[test]
    fn norms_are_told_apart() {
        let device = DeviceProfile::Ideal.device();
        let max = OffsetProbe::of(&device, DepthFormat::F32).slope_over_gradient;
        let euclid = Device { slope_norm: crate::device::SlopeNorm::Euclid, ..device };
        let length = OffsetProbe::of(&euclid, DepthFormat::F32).slope_over_gradient;
        assert!(
            (max - 1.0).abs() < 1e-4 && (length - 2.0f64.sqrt()).abs() < 1e-4,
            "{max} {length}"
        );
    }
}
