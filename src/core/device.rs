//! Device profiles as data: what differs between implementations of one pipeline.

mod fields;
mod resolvable;

use crate::depth::{DepthFormat, UnormLoad, UnormStore};
pub use fields::{FIELDS, Field};
use glam::{Mat4, Vec4};

crate::catalogue! {
    /// How depth and varying planes are set up from the snapped vertices.
    pub enum PlaneSetup {
        /// f64 planes through the snapped vertices, evaluated in f64 and rounded once to f32.
        Exact = "exact",
        /// f32 planes in the order measured on the WebGL of the dumps.
        Measured = "measured",
    }
}

crate::catalogue! {
    /// Precision of a texture coordinate that picks a NEAREST texel of a colour texture.
    pub enum NearestCoord {
        /// floor of the f32 product u·W.
        Float = "float",
        /// u truncated to 16-bit fixed point first.
        Fixed16 = "fixed16",
    }
}

crate::catalogue! {
    /// Norm of the depth gradient that polygon offset multiplies by its factor.
    pub enum SlopeNorm {
        /// max(|dz/dx|, |dz/dy|).
        Max = "max",
        /// √((dz/dx)² + (dz/dy)²).
        Euclid = "euclid",
    }
}

crate::catalogue! {
    /// The unit r of a constant polygon offset.
    pub enum OffsetUnit {
        /// 2⁻ⁿ for n-bit UNORM; for floats 2^(e−23), e the exponent of the primitive's largest depth
        /// (Vulkan's exact representation; D3D's formula).
        Specification = "specification",
        /// 1.01/65535 for 16 bits; for floats 2^(e−23), e the largest exponent among the reference
        /// vertex' depth and the other two's *differences* from it (measured; departs from the
        /// specification and depends on the vertex order).
        Measured = "measured",
        /// The smallest value above 0 that the format holds: 1/(2ⁿ−1) for UNORM, else as
        /// `specification` (D3D11.3, D3D12, WebGPU: "minimum representable value > 0").
        D3d = "d3d",
        /// 2⁻ⁿ also for floats, n = 24 for 32 bits, 11 for 16 (VK_EXT_depth_bias_control
        /// LEAST_REPRESENTABLE_VALUE_FORCE_UNORM).
        ForceUnorm = "force-unorm",
        /// 1: the constant is in window depth (VK_EXT_depth_bias_control FLOAT).
        One = "one",
        /// 2⁻¹⁵ for 16 and 2⁻²³ for 24 bits: twice the exact value, as Vulkan allows and NVIDIA does
        /// unless asked for the exact one (dxvk #2892, #3501).
        Doubled = "doubled",
        /// 2·2⁻¹⁶ and 4·2⁻²⁴: AMD PAL's multipliers of the constant (AMDVLK #361).
        AmdPal = "amd-pal",
    }
}

/// One implementation of the pipeline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Device {
    /// The profile's name on the command line.
    pub profile: DeviceProfile,
    /// Vertices snap to 2^−bits of a pixel, round half even.
    pub subpixel_bits: u32,
    /// Plane equations.
    pub setup: PlaneSetup,
    /// Float → UNORM of colour and depth stores.
    pub store: UnormStore,
    /// UNORM → float of samplers.
    pub load: UnormLoad,
    /// What a 24-bit depth buffer really is.
    pub depth24: DepthFormat,
    /// Coordinates of NEAREST look-ups in colour textures.
    pub nearest: NearestCoord,
    /// Whether subnormal results become zero.
    pub flush_denormals: bool,
    /// Whether a·b + c is contracted to one rounding in matrix products.
    pub fma: bool,
    /// Whether `gl_FragCoord.z` is clamped to [0, 1] before the shader sees it.
    pub clamp_frag_z: bool,
    /// Norm of polygon offset's slope.
    pub slope_norm: SlopeNorm,
    /// Unit of polygon offset's constant.
    pub offset_unit: OffsetUnit,
}

crate::catalogue! {
    /// The known implementations.
    pub enum DeviceProfile {
        /// Correctly rounded wherever a specification leaves room: 8 subpixel bits, exact planes,
        /// true 24-bit depth.
        Ideal = "ideal",
        /// Chromium's WebGL on SwiftShader, as measured: 4 subpixel bits, f32 planes, 24-bit depth kept
        /// as float.
        WebglSwiftshader = "webgl-swiftshader",
        /// A desktop GPU within the specifications: 8 subpixel bits, contracted multiply-adds, true
        /// 24-bit depth.
        DesktopFma = "desktop-fma",
        /// A GPU that truncates on store, as Vulkan and old GL allow.
        Truncating = "truncating",
    }
}

impl DeviceProfile {
    /// The profile's data.
    #[must_use]
    pub const fn device(self) -> Device {
        let ideal = Device {
            profile: Self::Ideal,
            subpixel_bits: 8,
            setup: PlaneSetup::Exact,
            store: UnormStore::Exact,
            load: UnormLoad::Divide,
            depth24: DepthFormat::Unorm24,
            nearest: NearestCoord::Float,
            flush_denormals: false,
            fma: false,
            clamp_frag_z: true,
            slope_norm: SlopeNorm::Max,
            offset_unit: OffsetUnit::Specification,
        };
        match self {
            Self::Ideal => ideal,
            Self::WebglSwiftshader => Device {
                profile: self,
                subpixel_bits: 4,
                setup: PlaneSetup::Measured,
                store: UnormStore::HalfEven,
                load: UnormLoad::Reciprocal,
                depth24: DepthFormat::F32,
                nearest: NearestCoord::Fixed16,
                flush_denormals: true,
                clamp_frag_z: false,
                offset_unit: OffsetUnit::Measured,
                ..ideal
            },
            Self::DesktopFma => Device { profile: self, fma: true, ..ideal },
            Self::Truncating => Device { profile: self, store: UnormStore::Truncate, ..ideal },
        }
    }
}

impl Device {
    /// `x`, or zero where the device flushes subnormals.
    #[must_use]
    pub fn flush(&self, x: f32) -> f32 {
        if self.flush_denormals && x.is_subnormal() { 0.0 * x } else { x }
    }

    /// The format that a requested depth format becomes here.
    #[must_use]
    pub const fn depth_format(&self, requested: DepthFormat) -> DepthFormat {
        if matches!(requested, DepthFormat::Unorm24) { self.depth24 } else { requested }
    }

    /// A depth as it comes back from a texel of `format`.
    #[must_use]
    pub fn stored_depth(&self, format: DepthFormat, depth: f32) -> f32 {
        let format = self.depth_format(format);
        format.decode_with(self.load, format.encode_with(self.store, self.flush(depth)))
    }

    /// The shader's m·v: columns left to right, each operation rounded to f32, contracted where the
    /// device does.
    #[must_use]
    pub fn mat_vec(&self, m: &Mat4, v: Vec4) -> Vec4 {
        let row = |r: usize| {
            let mad = |column: Vec4, x: f32, sum: f32| {
                if self.fma { column[r].mul_add(x, sum) } else { self.flush(column[r] * x) + sum }
            };
            let first = self.flush(m.x_axis[r] * v.x);
            let sum = [(m.y_axis, v.y), (m.z_axis, v.z), (m.w_axis, v.w)]
                .into_iter()
                .fold(first, |sum, (column, x)| mad(column, x, sum));
            self.flush(sum)
        };
        Vec4::new(row(0), row(1), row(2), row(3))
    }

    /// The shader's a·b: each column of b through [`Self::mat_vec`].
    #[must_use]
    pub fn mat_mat(&self, a: &Mat4, b: &Mat4) -> Mat4 {
        Mat4::from_cols(
            self.mat_vec(a, b.x_axis),
            self.mat_vec(a, b.y_axis),
            self.mat_vec(a, b.z_axis),
            self.mat_vec(a, b.w_axis),
        )
    }
}
