//! Polygon offset as APIs state it, and the slope of a receiver's own plane.

use glam::DVec2;

/// Caster-side raster depth bias: o = clamp(m·factor + r·units).
///
/// m is the largest depth slope of the triangle per texel (its norm is the device's), r the smallest
/// resolvable difference ([`crate::device::OffsetUnit`]). GL: `glPolygonOffset(factor, units)`;
/// Vulkan: depthBiasSlopeFactor, depthBiasConstantFactor, depthBiasClamp; D3D11/12 and WebGPU:
/// SlopeScaledDepthBias, DepthBias (an integer), DepthBiasClamp.
/// Sources: OpenGL 4.6 §14.6.5, Vulkan 1.3 "Depth Bias", D3D11.3 functional spec §15.10.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PolygonOffset {
    /// Multiplies the largest depth slope m.
    pub factor: f32,
    /// Multiplies the smallest resolvable difference r.
    pub units: f32,
    /// Upper bound of the sum if > 0, lower bound if < 0, none if 0 or NaN. Window depth.
    pub clamp: f32,
}

impl PolygonOffset {
    /// None.
    pub const NONE: Self = Self { factor: 0.0, units: 0.0, clamp: 0.0 };

    /// m·factor + r·units, clamped; each operation rounded to f32. A factor or unit count of 0 adds
    /// exactly 0 whatever m and r are, so that 0·∞ never arises.
    #[must_use]
    pub fn value(&self, slope: f32, resolvable: f32) -> f32 {
        let slope = if self.factor == 0.0 { 0.0 } else { self.factor * slope };
        let constant = if self.units == 0.0 { 0.0 } else { self.units * resolvable };
        let sum = slope + constant;
        if self.clamp > 0.0 {
            sum.min(self.clamp)
        } else if self.clamp < 0.0 {
            sum.max(self.clamp)
        } else {
            sum
        }
    }
}

/// |g| of a receiver's plane per texel, window depth: what shaders compute as tan θ, Euclidean norm.
/// `gradient` is compared depth per unit of u and v, `map_size` the map's width and height. f64, within
/// 4 ulp.
#[must_use]
pub fn receiver_slope(gradient: DVec2, map_size: [u32; 2]) -> f64 {
    let [width, height] = map_size.map(f64::from);
    let y = gradient.y * (width / height);
    let squared = gradient.x * gradient.x + y * y;
    f64::sqrt(squared) / width
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_clamp_bounds_from_its_own_side_and_nan_does_not() {
        let offset = |clamp| PolygonOffset { factor: 2.0, units: 1.0, clamp }.value(0.5, 0.25);
        assert_eq!(offset(0.0), 1.25);
        assert_eq!(offset(f32::NAN), 1.25);
        assert_eq!(offset(1.0), 1.0);
        assert_eq!(offset(-2.0), 1.25);
        let negative = PolygonOffset { factor: -2.0, units: 0.0, clamp: -0.5 };
        assert_eq!(negative.value(1.0, f32::INFINITY), -0.5, "0 units of an infinite r are 0");
    }
}
