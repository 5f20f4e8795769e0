//! Which texels a look-up reads, and with what arithmetic.

use super::{ShadowMap, Texels};
use crate::device::{Device, NearestCoord};
use crate::scene::{Filter, TexelFormat, Wrap};

/// The depths that one look-up compares: one for NEAREST and LINEAR, nine for 3×3 PCF.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Taps {
    depths: [f32; 9],
    texels: [u32; 9],
    len: usize,
}

impl Taps {
    fn one(depth: f32, texel: u32) -> Self {
        Self { depths: [depth; 9], texels: [texel; 9], len: 1 }
    }

    /// Stored depths, as compared.
    #[must_use]
    pub fn depths(&self) -> &[f32] {
        &self.depths[..self.len]
    }

    /// The texel of each tap; for LINEAR the one that NEAREST would have read.
    #[must_use]
    pub fn texels(&self) -> &[u32] {
        &self.texels[..self.len]
    }

    /// The tap in the middle.
    #[must_use]
    pub const fn centre(&self) -> usize {
        self.len / 2
    }
}

impl ShadowMap {
    /// Reads the map at (u, v).
    #[must_use]
    pub fn taps(&self, device: &Device, filter: Filter, wrap: Wrap, u: f32, v: f32) -> Taps {
        match filter {
            Filter::Nearest => {
                let texel = self.nearest(device, wrap, u, v);
                Taps::one(self.depth(device, texel as usize), texel)
            }
            Filter::Linear => {
                let texel = self.nearest(device, wrap, u, v);
                Taps::one(self.linear(device, wrap, u, v), texel)
            }
            Filter::Pcf3 => self.pcf3(device, wrap, u, v),
        }
    }

    fn pcf3(&self, device: &Device, wrap: Wrap, u: f32, v: f32) -> Taps {
        let step = 1.0 / self.size as f32;
        let mut taps = Taps { depths: [0.0; 9], texels: [0; 9], len: 9 };
        for i in 0..9u8 {
            let (dx, dy) = (f32::from(i % 3) - 1.0, f32::from(i / 3) - 1.0);
            let texel = self.nearest(device, wrap, u + dx * step, v + dy * step);
            taps.texels[usize::from(i)] = texel;
            taps.depths[usize::from(i)] = self.depth(device, texel as usize);
        }
        taps
    }

    /// Index of the texel that NEAREST picks.
    #[must_use]
    pub fn nearest(&self, device: &Device, wrap: Wrap, u: f32, v: f32) -> u32 {
        let fixed = device.nearest == NearestCoord::Fixed16
            && matches!(self.format, TexelFormat::Packed(_));
        let axis = |c: f32| nearest_texel(c, self.size, wrap, fixed);
        axis(v) * self.size + axis(u)
    }

    /// LINEAR: bytes are mixed in f32 on 0…255 (x before y), times f32(1/255), then decoded; depth
    /// textures without a compare mode read 0, as measured.
    fn linear(&self, device: &Device, wrap: Wrap, u: f32, v: f32) -> f32 {
        let (Texels::Bytes(bytes), TexelFormat::Packed(packing)) = (&self.texels, self.format)
        else {
            return 0.0;
        };
        packing.unpack(linear_bytes(bytes, self.size, device, wrap, u, v))
    }
}

/// The texel index along one axis.
fn nearest_texel(c: f32, size: u32, wrap: Wrap, fixed16: bool) -> u32 {
    let last = i64::from(size) - 1;
    if fixed16 {
        let fixed = match wrap {
            Wrap::Clamp => ((c * 65_536.0) as i64).clamp(0, 65_535),
            Wrap::Repeat => (c * 65_536.0) as i64 & 0xffff,
        };
        return (fixed * i64::from(size) >> 16) as u32;
    }
    let index = match wrap {
        Wrap::Clamp => (c * size as f32) as i64,
        Wrap::Repeat => ((c - c.floor()) * size as f32) as i64,
    };
    index.clamp(0, last) as u32
}

/// Four channels at (u, v) of a square RGBA8 texture under LINEAR, in [0,1].
fn linear_bytes(
    bytes: &[[u8; 4]],
    size: u32,
    device: &Device,
    wrap: Wrap,
    u: f32,
    v: f32,
) -> [f32; 4] {
    let ([x0, x1], fx) = linear_axis(u, size, wrap);
    let ([y0, y1], fy) = linear_axis(v, size, wrap);
    let at = |x: u32, y: u32, c: usize| f32::from(bytes[(y * size + x) as usize][c]);
    let mix = |a: f32, b: f32, t: f32| a + (b - a) * t;
    let scale = device.load.value(1, 255);
    std::array::from_fn(|c| {
        let low = mix(at(x0, y0, c), at(x1, y0, c), fx);
        let high = mix(at(x0, y1, c), at(x1, y1, c), fx);
        mix(low, high, fy) * scale
    })
}

/// The two texels along one axis and the weight of the second.
fn linear_axis(c: f32, size: u32, wrap: Wrap) -> ([u32; 2], f32) {
    let wrapped = match wrap {
        Wrap::Clamp => c,
        Wrap::Repeat => c - c.floor(),
    };
    let position = wrapped * size as f32 - 0.5;
    let base = position.floor();
    let index = |i: i64| match wrap {
        Wrap::Clamp => i.clamp(0, i64::from(size) - 1) as u32,
        Wrap::Repeat => i.rem_euclid(i64::from(size)) as u32,
    };
    ([index(base as i64), index(base as i64 + 1)], position - base)
}
