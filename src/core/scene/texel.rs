//! What a texel of a shadow map holds, and every fact of that format: bytes, step, worst error, unit r.

use super::Filter;
use crate::depth::{DepthFormat, Packing};
use crate::device::Device;
use crate::{Error, Result};

crate::catalogue! {
    /// The depth attachment that decides which fragment a texel keeps.
    pub enum DepthBuffer {
        /// A 16-bit renderbuffer under a colour-packed pass.
        Unorm16 = "d16",
        /// The depth texture itself, as float.
        Texture = "d32f-texture",
    }
}

/// What a texel holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TexelFormat {
    /// A depth texture.
    Depth(DepthFormat),
    /// Four colour bytes.
    Packed(Packing),
}

impl std::str::FromStr for TexelFormat {
    type Err = Error;

    /// A depth format or packing by name.
    fn from_str(name: &str) -> Result<Self> {
        let format = name.parse().map(Self::Depth);
        format.or_else(|_: Error| name.parse().map(Self::Packed)).map_err(|_: Error| {
            let names: Vec<_> = Self::all().map(Self::name).collect();
            let fix = format!("use one of {}", names.join(", "));
            Error::bad_input(format!("'{name}'"), "is no known depth format or packing", fix)
        })
    }
}

impl TexelFormat {
    /// The name of the format or packing.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Depth(format) => format.name(),
            Self::Packed(packing) => packing.name(),
        }
    }

    /// Every depth format, then every packing, in the order of their catalogues.
    pub fn all() -> impl Iterator<Item = Self> {
        let depths = DepthFormat::ALL.iter().map(|&format| Self::Depth(format));
        depths.chain(Packing::ALL.iter().map(|&packing| Self::Packed(packing)))
    }

    /// Whether it is a packing.
    #[must_use]
    pub const fn is_packed(self) -> bool {
        matches!(self, Self::Packed(_))
    }

    /// Bytes of a texel as graphics memory and raw files keep it: 24-bit depth takes 32 bits, packings are
    /// RGBA8.
    #[must_use]
    pub const fn bytes(self) -> u32 {
        match self {
            Self::Depth(format) => format.bytes(),
            Self::Packed(_) => 4,
        }
    }

    /// The largest |decoded − z| of a depth z ∈ [0, 1), window depth, as certified: stored to nearest and
    /// sampled exactly.
    #[must_use]
    pub fn worst_error(self) -> f64 {
        match self {
            Self::Depth(format) => format.worst_error(),
            Self::Packed(packing) => packing.worst_error(),
        }
    }

    /// One step of the format at a window depth, which beyond 0 and 1 counts as these: the smallest
    /// difference that it keeps. Of a depth format the spacing of its values, of a packing twice its
    /// worst error (whole bytes may be lost on the way), at most 1; of a packing that loses nothing the
    /// spacing of f32.
    #[must_use]
    pub fn step(self, depth: f32) -> f64 {
        let depth = depth.clamp(0.0, 1.0);
        match self {
            Self::Depth(format) => format.quantum(depth),
            Self::Packed(packing) => match packing.worst_error() {
                0.0 => DepthFormat::F32.quantum(depth),
                error => (2.0 * error).min(1.0),
            },
        }
    }

    /// The format of the depth attachment of a pass that fills such texels: its own, or of a packing what
    /// lies under it.
    #[must_use]
    pub const fn attachment(self, under: DepthBuffer) -> DepthFormat {
        match (self, under) {
            (Self::Depth(format), _) => format,
            (Self::Packed(_), DepthBuffer::Unorm16) => DepthFormat::Unorm16,
            (Self::Packed(_), DepthBuffer::Texture) => DepthFormat::F32,
        }
    }

    /// The unit r of a polygon offset in a pass that fills such texels: [`Device::resolvable`] of its
    /// attachment.
    #[must_use]
    pub fn resolvable(self, device: &Device, under: DepthBuffer, depth: f32) -> f32 {
        device.resolvable(self.attachment(under), depth)
    }

    /// The depth format that keeps as many bits without a packing's faults; a depth format is its own.
    #[must_use]
    pub fn sound(self) -> DepthFormat {
        match self {
            Self::Depth(format) => format,
            Self::Packed(packing) => match packing.channels() {
                1 => DepthFormat::Unorm8,
                2 => DepthFormat::Unorm16,
                3 => DepthFormat::Unorm24,
                _ => DepthFormat::Unorm32,
            },
        }
    }

    /// The filter that look-ups can use: LINEAR reads 0 from depth textures without a compare mode, so
    /// that they are read NEAREST instead.
    #[must_use]
    pub fn usable(self, filter: Filter) -> Filter {
        let unread = filter == Filter::Linear && !self.is_packed();
        if unread { Filter::Nearest } else { filter }
    }
}
