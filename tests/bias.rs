//! Polygon offset against exact rationals, and the filters' and strategies' basic promises.

use glam::Vec4;
use gnomon::depth::DepthFormat;
use gnomon::device::{Device, DeviceProfile, OffsetUnit, SlopeNorm};
use gnomon::num::{exp2, ulps_between};
use gnomon::raster::{PolygonOffset, Setup};
use proptest::prelude::*;

fn device(norm: SlopeNorm, unit: OffsetUnit) -> Device {
    Device { slope_norm: norm, offset_unit: unit, ..DeviceProfile::Ideal.device() }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100_000))]

    /// The sum of two f32 products is within 1 ulp of the exact sum where nothing cancels, clamped from
    /// the clamp's own side; a NaN clamp is none.
    #[test]
    fn polygon_offset_is_the_formula(
        slope in 0.0f32..1e5, unit in 1e-8f32..1e-2, factor in -16.0f32..16.0,
        units in -64.0f32..64.0, clamp in prop_oneof![Just(0.0f32), Just(-0.0), Just(f32::NAN), -1.0f32..1.0],
    ) {
        let offset = PolygonOffset { factor, units, clamp };
        let exact = f64::from(factor) * f64::from(slope) + f64::from(units) * f64::from(unit);
        let bounded = if clamp > 0.0 {
            exact.min(f64::from(clamp))
        } else if clamp < 0.0 {
            exact.max(f64::from(clamp))
        } else {
            exact
        };
        let found = offset.value(slope, unit);
        let size = (factor * slope).abs().max((units * unit).abs());
        let allowed = 1.5 * gnomon::num::ulp(size);
        prop_assert!((f64::from(found) - bounded).abs() <= allowed, "{found:e} {bounded:e}");
        if factor.signum() == units.signum() || units == 0.0 {
            prop_assert!(ulps_between(found, bounded as f32) <= 1, "{found:e} {bounded:e}");
        }
    }

    /// Both norms of a plane's slope, from three vertices: the Euclidean norm lies between the maximum
    /// norm and √2 times it, and both match the gradient that was put in.
    #[test]
    fn slopes_have_the_norm_of_the_device(gx in -0.4f32..0.4, gy in -0.4f32..0.4) {
        let at = |x: f32, y: f32| Vec4::new(x, y, gx * x + gy * y, 1.0);
        let corners = [at(-1.0, -1.0), at(1.0, -1.0), at(-1.0, 1.0)];
        let slope = |norm| {
            let device = device(norm, OffsetUnit::Specification);
            Setup::new(&device, [64; 2], corners).max_slope(&device)
        };
        // One NDC unit is 32 texels and half a window depth.
        let (x, y) = (f64::from(gx) / 64.0, f64::from(gy) / 64.0);
        let (max, euclid) = (f64::from(slope(SlopeNorm::Max)), f64::from(slope(SlopeNorm::Euclid)));
        prop_assert!((max - x.abs().max(y.abs())).abs() <= 1e-8);
        prop_assert!((euclid - f64::sqrt(x * x + y * y)).abs() <= 1e-8);
    }
}

#[test]
fn an_infinite_slope_times_no_factor_is_no_offset() {
    let constant = PolygonOffset { factor: 0.0, units: 2.0, clamp: 0.0 };
    assert_eq!(constant.value(f32::INFINITY, 0.25), 0.5);
    let slope = PolygonOffset { factor: 1.0, units: 0.0, clamp: 0.125 };
    assert_eq!(slope.value(f32::INFINITY, f32::INFINITY), 0.125, "clamped");
}

#[test]
fn the_unit_is_that_of_the_api_and_format() {
    let corner = |x: f32, y: f32| Vec4::new(x, y, 0.5, 1.0);
    let corners = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(-1.0, 1.0)];
    let unit = |model: OffsetUnit, format| {
        let device = device(SlopeNorm::Max, model);
        Setup::new(&device, [16; 2], corners).resolvable(&device, format)
    };
    use DepthFormat::{F32, Unorm16, Unorm24};
    use OffsetUnit::{AmdPal, D3d, Doubled, ForceUnorm, One, Specification};
    let two = |n: i32| exp2(n) as f32;
    let table = [
        (Specification, Unorm16, two(-16)),
        (Specification, Unorm24, two(-24)),
        // Window depth 0.75 has exponent −1.
        (Specification, F32, two(-24)),
        (D3d, Unorm16, 1.0 / 65_535.0),
        (D3d, F32, two(-24)),
        (ForceUnorm, Unorm16, two(-16)),
        (ForceUnorm, F32, two(-24)),
        (One, Unorm24, 1.0),
        (Doubled, Unorm16, two(-15)),
        (Doubled, Unorm24, two(-23)),
        (AmdPal, Unorm16, two(-15)),
        (AmdPal, Unorm24, two(-22)),
    ];
    for (model, format, expected) in table {
        assert_eq!(unit(model, format), expected, "{model} {format}");
    }
}
