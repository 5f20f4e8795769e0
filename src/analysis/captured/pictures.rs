//! PNG and EXR maps: what a picture needs is known from its header before any of it is decoded.

use super::{bottom_up, checked, from_codes, side};
use crate::depth::DepthFormat;
use crate::device::Device;
use crate::light::Layout;
use crate::scene::TexelFormat;
use crate::shadow::ShadowMap;
use crate::{Error, Result, memory};
use exr::prelude::{MetaData, ReadChannels, ReadLayers, read};
use png::{BitDepth, ColorType, DecodingError, Transformations};
use std::io::Cursor;

/// Bytes that a decoder may take beside the picture itself.
const DECODER: usize = 64 << 20;
/// Bytes a texel that our own copies of a map take while it is turned over.
const COPIES: u64 = 12;

/// Refuses a picture whose samples and texels go beyond the budget.
fn afford(place: &str, samples: u64, side: u32) -> Result<()> {
    let texels = u64::from(side) * u64::from(side) * COPIES;
    memory::check(place, samples.saturating_add(texels), "give a smaller map")
}

/// The samples of a PNG, top row first: 1 to 4 channels of 1 or 2 bytes.
struct Picture {
    side: u32,
    channels: usize,
    sixteen: bool,
    samples: Vec<u8>,
}

impl Picture {
    fn decode(place: &str, bytes: &[u8]) -> Result<Self> {
        let bad = |e: DecodingError| {
            Error::bad_input(place, format!("is no usable PNG ({e})"), "dump the map again")
        };
        let limits = png::Limits { bytes: DECODER };
        let mut decoder = png::Decoder::new_with_limits(Cursor::new(bytes), limits);
        // Texts and colour profiles may unpack to gigabytes, and say nothing about depth.
        decoder.set_ignore_text_chunk(true);
        decoder.set_ignore_iccp_chunk(true);
        decoder.set_transformations(Transformations::EXPAND);
        let (width, height) = decoder.read_header_info().map_err(bad)?.size();
        let side = side(place, width, height)?;
        let mut reader = decoder.read_info().map_err(bad)?;
        let size = reader.output_buffer_size().ok_or(DecodingError::LimitsExceeded).map_err(bad)?;
        afford(place, size as u64, side)?;
        let mut samples = vec![0; size];
        let info = reader.next_frame(&mut samples).map_err(bad)?;
        if (info.width, info.height) != (side, side) {
            let reason = format!("its first frame is {} x {}", info.width, info.height);
            return Err(Error::bad_input(place, reason, "dump the map as one whole picture"));
        }
        let channels = match info.color_type {
            ColorType::Grayscale => 1,
            ColorType::GrayscaleAlpha => 2,
            ColorType::Rgb | ColorType::Indexed => 3,
            ColorType::Rgba => 4,
        };
        Ok(Self { side, channels, sixteen: info.bit_depth == BitDepth::Sixteen, samples })
    }

    /// R, G, B, A of every texel: grey stands for all three, a missing A is 255.
    fn bytes(&self) -> Vec<[u8; 4]> {
        let texel = |t: &[u8]| match *t {
            [grey] => [grey, grey, grey, 255],
            [grey, a] => [grey, grey, grey, a],
            [r, g, b] => [r, g, b, 255],
            [r, g, b, a, ..] => [r, g, b, a],
            [] => [0; 4],
        };
        bottom_up(
            &self.samples.chunks_exact(self.channels).map(texel).collect::<Vec<_>>(),
            self.side,
        )
    }

    /// Grey or red of every texel; 16-bit samples stand high byte first.
    fn red(&self) -> Vec<u32> {
        let step = if self.sixteen { 2 } else { 1 };
        let code = |t: &[u8]| t.iter().take(step).fold(0, |code, b| code << 8 | u32::from(*b));
        let texels = self.samples.chunks_exact(self.channels * step).map(code);
        bottom_up(&texels.collect::<Vec<_>>(), self.side)
    }
}

/// The map that a PNG holds.
pub(super) fn from_png(
    place: &str,
    bytes: &[u8],
    format: Option<TexelFormat>,
    device: &Device,
) -> Result<ShadowMap> {
    let picture = Picture::decode(place, bytes)?;
    let (side, sixteen) = (picture.side, picture.sixteen);
    let missing = || Error::bad_input(place, "does not say how it holds depth", "give --packing");
    match format.ok_or_else(missing)? {
        TexelFormat::Packed(packing) if !sixteen => {
            Ok(ShadowMap::from_bytes(Layout::whole([side; 2]), packing, picture.bytes()))
        }
        TexelFormat::Depth(DepthFormat::Unorm8) if !sixteen => {
            from_codes(place, side, DepthFormat::Unorm8, picture.red().into_iter(), device)
        }
        TexelFormat::Depth(DepthFormat::Unorm16) if sixteen => {
            from_codes(place, side, DepthFormat::Unorm16, picture.red().into_iter(), device)
        }
        other @ (TexelFormat::Depth(_) | TexelFormat::Packed(_)) => {
            let bits = if sixteen { 16 } else { 8 };
            let reason = format!("has {bits} bits a channel, which hold no {}", other.name());
            let fix = "dump an EXR or raw bytes, or name another --packing";
            Err(Error::bad_input(place, reason, fix))
        }
    }
}

/// The side of an EXR's map; all its channels are decoded, so all of them are counted.
fn exr_side(place: &str, bytes: &[u8]) -> Result<u32> {
    let bad = |e: exr::error::Error| {
        Error::bad_input(place, format!("is no usable EXR ({e})"), "dump the map again")
    };
    let meta = MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(bad)?;
    let [header] = &meta.headers[..] else {
        let reason = format!("has {} parts", meta.headers.len());
        return Err(Error::bad_input(place, reason, "dump one part"));
    };
    let size = header.layer_size;
    let [width, height] = [size.0, size.1].map(|n| u32::try_from(n).unwrap_or(u32::MAX));
    let side = side(place, width, height)?;
    if header.deep {
        return Err(Error::bad_input(place, "holds deep samples", "dump one depth a texel"));
    }
    let samples = (size.area() as u64).saturating_mul(header.channels.bytes_per_pixel as u64);
    afford(place, samples.saturating_mul(2), side)?;
    Ok(side)
}

/// The map that an EXR holds: depths as they are.
pub(super) fn from_exr(
    place: &str,
    bytes: Vec<u8>,
    format: Option<TexelFormat>,
) -> Result<ShadowMap> {
    let bad = |e: exr::error::Error| {
        Error::bad_input(place, format!("is no usable EXR ({e})"), "dump the map again")
    };
    let format = match format.unwrap_or(TexelFormat::Depth(DepthFormat::F32)) {
        TexelFormat::Depth(format) => format,
        TexelFormat::Packed(packing) => {
            let reason = format!("holds floats, not the bytes of {packing}");
            return Err(Error::bad_input(place, reason, "dump a PNG or raw bytes"));
        }
    };
    let side = exr_side(place, &bytes)?;
    let reader = read().no_deep_data().largest_resolution_level().all_channels();
    let image = reader.first_valid_layer().all_attributes();
    let image = image.from_buffered(Cursor::new(bytes)).map_err(bad)?;
    let channels = &image.layer_data.channel_data.list;
    let named = |name: &str| channels.iter().find(|c| c.name.to_string() == name);
    let only = || if channels.len() == 1 { channels.first() } else { None };
    let channel = ["Z", "R", "Y"].into_iter().find_map(named).or_else(only).ok_or_else(|| {
        let names: Vec<String> = channels.iter().map(|c| c.name.to_string()).collect();
        let reason = format!("has no channel Z, R or Y but {}", names.join(", "));
        Error::bad_input(place, reason, "name the depth channel Z")
    })?;
    let depths: Vec<f32> = channel.sample_data.values_as_f32().collect();
    if depths.len() != side as usize * side as usize {
        let reason = format!("channel {} does not hold every texel", channel.name);
        return Err(Error::bad_input(place, reason, "dump it without subsampling"));
    }
    checked(place, side, format, bottom_up(&depths, side))
}
