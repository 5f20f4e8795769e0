//! Captured maps: the shadow map that an engine has drawn, read from a file in place of our own raster.
//!
//! - **Rows.** PNG and EXR are written top row first, so their last row is texel row 0; raw files are
//!   what `glReadPixels` and map buffers hold: texel row 0 first.
//! - **Channels.** A packing reads R, G, B, A bytes (a missing A is 255, a grey picture is R, G and B
//!   alike). A depth format reads the grey or red channel of a PNG, the channel Z, R or Y of an EXR.
//! - **Numbers.** PNG: 8 bits are `unorm8`, 16 bits `unorm16`. EXR: depths as they are, `f32` unless
//!   another format is named. Raw: little-endian codes: 4 bytes a texel for packings, `unorm24` (low 24
//!   bits), `unorm32` and `f32`; 2 for `unorm16`, `f16` and `bf16`; 1 for `unorm8`.

use crate::depth::DepthFormat;
use crate::device::Device;
use crate::scene::{Case, CompareRule, TexelFormat, matrix};
use crate::shadow::ShadowMap;
use crate::{Error, Result};
use glam::{DMat4, Mat4};
use std::fs;
use std::io::Cursor;
use std::path::{Path, PathBuf};

/// A map to be looked up in place of the one that a case draws.
#[derive(Clone, Debug, PartialEq)]
pub struct Captured {
    /// Its texels.
    pub map: ShadowMap,
}

/// Largest side in texels.
const LARGEST: u32 = 8192;

/// A captured map on the command line; flatten it into a binary's arguments.
#[derive(Clone, Debug, Default, clap::Args)]
pub struct CapturedArguments {
    /// The shadow map that your engine drew (.png, .exr or .raw), looked up in place of ours
    #[arg(long, value_name = "FILE")]
    pub map_file: Option<PathBuf>,
    /// Clip from world of its light, row by row (OpenGL's clip space); needed with --scene
    #[arg(
        long,
        value_name = "16 NUMBERS",
        value_delimiter = ',',
        requires = "map_file",
        allow_hyphen_values = true
    )]
    pub light_matrix: Vec<f64>,
    /// How a texel holds its depth: a packing or a depth format
    #[arg(long, value_name = "NAME", requires = "map_file")]
    pub packing: Option<String>,
    /// When a receiver is in shadow, as a rule of the catalogue
    #[arg(long, value_name = "RULE", requires = "map_file")]
    pub compare: Option<CompareRule>,
    /// Texels across of a raw file
    #[arg(long, value_name = "N", requires = "map_file")]
    pub map_width: Option<u32>,
    /// Texels down of a raw file
    #[arg(long, value_name = "N", requires = "map_file")]
    pub map_height: Option<u32>,
}

impl CapturedArguments {
    /// Reads the map and turns the case's light, map and comparison to it; `fitted` tells that the
    /// case's light is our own guess, so that the engine's must be given.
    ///
    /// # Errors
    /// [`Error::BadInput`] or [`Error::Read`] in one sentence.
    pub fn apply(&self, case: &mut Case, fitted: bool) -> Result<Option<Captured>> {
        let Some(path) = &self.map_file else { return Ok(None) };
        if self.light_matrix.is_empty() && fitted {
            return Err(Error::bad_input(
                "--map-file",
                "needs the matrix that the map was drawn with",
                "give --light-matrix",
            ));
        }
        let format = self.packing.as_deref().map(super::sweep::plan::format_named).transpose()?;
        let bytes = fs::read(path).map_err(|e| Error::read(path, e))?;
        let place = path.display().to_string();
        let extension = path.extension().and_then(|e| e.to_str()).unwrap_or("").to_lowercase();
        let device = case.device.device();
        let map = match extension.as_str() {
            "png" => png(&place, &bytes, format, &device)?,
            "exr" => exr(&place, bytes, format)?,
            "raw" => self.raw(&place, &bytes, format, &device)?,
            _ => {
                let reason = format!("'.{extension}' is no map file known here");
                return Err(Error::bad_input(place, reason, "give a .png, .exr or .raw file"));
            }
        };
        (case.map.size, case.map.texel) = (map.size(), map.format());
        case.lookup.compare = self.compare.unwrap_or(case.lookup.compare);
        self.turn_light(case)?;
        Ok(Some(Captured { map }))
    }

    fn turn_light(&self, case: &mut Case) -> Result<()> {
        if self.light_matrix.is_empty() {
            return Ok(());
        }
        let numbers = <[f64; 16]>::try_from(self.light_matrix.as_slice()).map_err(|_| {
            let reason = format!("has {} numbers", self.light_matrix.len());
            Error::bad_input("--light-matrix", reason, "give 16, row by row, between commas")
        })?;
        let clip_from_world = DMat4::from_cols_array(&numbers).transpose();
        case.light = matrix::light(clip_from_world)?;
        let uploaded: Mat4 = clip_from_world.as_mat4();
        for object in &mut case.objects {
            object.matrices = case.chain.matrices(&case.light, &case.camera, &object.model);
            case.chain.set_light(&mut object.matrices, &uploaded, &object.model);
        }
        Ok(())
    }

    fn raw(
        &self,
        place: &str,
        bytes: &[u8],
        format: Option<TexelFormat>,
        device: &Device,
    ) -> Result<ShadowMap> {
        let missing =
            |what: &str, fix: &str| Error::bad_input(place, format!("raw texels need {what}"), fix);
        let format = format.ok_or_else(|| missing("a format", "give --packing"))?;
        let size = self.map_width.zip(self.map_height);
        let (width, height) =
            size.ok_or_else(|| missing("a size", "give --map-width and --map-height"))?;
        let side = side(place, width, height)?;
        let texels = side as usize * side as usize;
        let step = format.bytes() as usize;
        if bytes.len() != texels * step {
            let reason =
                format!("holds {} bytes, not {side} x {side} texels of {step} bytes", bytes.len());
            return Err(Error::bad_input(
                place,
                reason,
                "check --map-width, --map-height, --packing",
            ));
        }
        let code =
            |texel: &[u8]| texel.iter().rev().fold(0u32, |code, b| code << 8 | u32::from(*b));
        match format {
            TexelFormat::Packed(packing) => {
                let texel = |t: &[u8]| [t[0], t[1], t[2], t[3]];
                Ok(ShadowMap::from_bytes(side, packing, bytes.chunks_exact(4).map(texel).collect()))
            }
            TexelFormat::Depth(format) => {
                let codes = bytes.chunks_exact(step).map(code);
                from_codes(place, side, format, codes, device)
            }
        }
    }
}

fn side(place: &str, width: u32, height: u32) -> Result<u32> {
    if width != height || !(1..=LARGEST).contains(&width) {
        return Err(Error::bad_input(
            place,
            format!("is {width} x {height} texels"),
            format!("give a square map of at most {LARGEST} texels a side"),
        ));
    }
    Ok(width)
}

fn from_codes(
    place: &str,
    side: u32,
    format: DepthFormat,
    codes: impl Iterator<Item = u32>,
    device: &Device,
) -> Result<ShadowMap> {
    let mask = format.unorm_max().unwrap_or(u32::MAX);
    let depths = codes.map(|code| format.decode_with(device.load, code & mask)).collect();
    checked(place, side, format, depths)
}

/// Refuses depths that are not numbers, naming the first texel.
fn checked(place: &str, side: u32, format: DepthFormat, depths: Vec<f32>) -> Result<ShadowMap> {
    if let Some(i) = depths.iter().position(|d| !d.is_finite()) {
        let (x, y) = (i as u32 % side, i as u32 / side);
        let reason = format!("texel ({x}, {y}) from the bottom left is {}", depths[i]);
        return Err(Error::bad_input(place, reason, "dump finite depths"));
    }
    Ok(ShadowMap::from_depths(side, format, depths))
}

/// Rows from top first to bottom first.
fn bottom_up<T: Copy>(texels: &[T], side: u32) -> Vec<T> {
    texels.chunks_exact(side as usize).rev().flatten().copied().collect()
}

fn png(
    place: &str,
    bytes: &[u8],
    format: Option<TexelFormat>,
    device: &Device,
) -> Result<ShadowMap> {
    let mut reader = image::ImageReader::with_format(Cursor::new(bytes), image::ImageFormat::Png);
    let mut limits = image::Limits::default();
    (limits.max_image_width, limits.max_image_height) = (Some(LARGEST), Some(LARGEST));
    reader.limits(limits);
    let picture = reader.decode().map_err(|e| {
        Error::bad_input(place, format!("is no usable PNG ({e})"), "dump the map again")
    })?;
    let side = side(place, picture.width(), picture.height())?;
    let sixteen = picture.color().bytes_per_pixel() / picture.color().channel_count() == 2;
    let missing = || Error::bad_input(place, "does not say how it holds depth", "give --packing");
    match format.ok_or_else(missing)? {
        TexelFormat::Packed(packing) if !sixteen => {
            let texels: Vec<[u8; 4]> = picture.to_rgba8().pixels().map(|p| p.0).collect();
            Ok(ShadowMap::from_bytes(side, packing, bottom_up(&texels, side)))
        }
        TexelFormat::Depth(DepthFormat::Unorm8) if !sixteen => {
            let red: Vec<u32> = picture.to_rgb8().pixels().map(|p| u32::from(p.0[0])).collect();
            let codes = bottom_up(&red, side).into_iter();
            from_codes(place, side, DepthFormat::Unorm8, codes, device)
        }
        TexelFormat::Depth(DepthFormat::Unorm16) if sixteen => {
            let red: Vec<u32> = picture.to_rgb16().pixels().map(|p| u32::from(p.0[0])).collect();
            let codes = bottom_up(&red, side).into_iter();
            from_codes(place, side, DepthFormat::Unorm16, codes, device)
        }
        other @ (TexelFormat::Depth(_) | TexelFormat::Packed(_)) => {
            let bits = if sixteen { 16 } else { 8 };
            let reason = format!("has {bits} bits a channel, which hold no {}", other.name());
            Err(Error::bad_input(
                place,
                reason,
                "dump an EXR or raw bytes, or name another --packing",
            ))
        }
    }
}

fn exr(place: &str, bytes: Vec<u8>, format: Option<TexelFormat>) -> Result<ShadowMap> {
    use ::exr::prelude::{MetaData, ReadChannels, ReadLayers, read};
    let bad = |e: ::exr::error::Error| {
        Error::bad_input(place, format!("is no usable EXR ({e})"), "dump the map again")
    };
    let format = match format.unwrap_or(TexelFormat::Depth(DepthFormat::F32)) {
        TexelFormat::Depth(format) => format,
        TexelFormat::Packed(packing) => {
            let reason = format!("holds floats, not the bytes of {packing}");
            return Err(Error::bad_input(place, reason, "dump a PNG or raw bytes"));
        }
    };
    let meta = MetaData::read_from_buffered(Cursor::new(&bytes), false).map_err(bad)?;
    let size = meta.headers.first().map_or((0, 0), |h| (h.layer_size.0, h.layer_size.1));
    let side = side(place, size.0 as u32, size.1 as u32)?;
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
    checked(place, side, format, bottom_up(&depths, side))
}

/// Writes a map as it would be captured: packings and UNORM up to 16 bits as PNG, other depth formats
/// as EXR, whatever the extension says as raw codes.
///
/// # Errors
/// [`Error::BadInput`] where the extension cannot hold the format, [`Error::Write`].
pub fn write(map: &ShadowMap, device: &Device, path: &Path) -> Result<()> {
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or("").to_lowercase();
    let bytes = match (extension.as_str(), map.format()) {
        ("raw", _) => raw_bytes(map, device),
        (
            "png",
            TexelFormat::Packed(_) | TexelFormat::Depth(DepthFormat::Unorm8 | DepthFormat::Unorm16),
        ) => png_bytes(map, device),
        ("exr", TexelFormat::Depth(_)) => exr_bytes(map, device),
        (_, format) => {
            return Err(Error::bad_input(
                path.display().to_string(),
                format!("cannot hold {}", format.name()),
                "use .png for packings, unorm8 and unorm16, .exr for depth formats, .raw for all",
            ));
        }
    };
    fs::write(path, bytes).map_err(|e| Error::write(path, e))
}

fn texels(map: &ShadowMap) -> std::ops::Range<usize> {
    0..map.size() as usize * map.size() as usize
}

fn code(map: &ShadowMap, device: &Device, format: DepthFormat, texel: usize) -> u32 {
    format.encode(map.depth(device, texel))
}

fn raw_bytes(map: &ShadowMap, device: &Device) -> Vec<u8> {
    let step = map.format().bytes() as usize;
    let texel = |i: usize| match map.format() {
        TexelFormat::Packed(_) => map.bytes(i).unwrap_or_default(),
        TexelFormat::Depth(format) => code(map, device, format, i).to_le_bytes(),
    };
    texels(map).flat_map(|i| texel(i).into_iter().take(step)).collect()
}

fn png_bytes(map: &ShadowMap, device: &Device) -> Vec<u8> {
    let (colour, depth, step) = match map.format() {
        TexelFormat::Packed(_) => (::png::ColorType::Rgba, ::png::BitDepth::Eight, 4),
        TexelFormat::Depth(DepthFormat::Unorm8) => {
            (::png::ColorType::Grayscale, ::png::BitDepth::Eight, 1)
        }
        TexelFormat::Depth(_) => (::png::ColorType::Grayscale, ::png::BitDepth::Sixteen, 2),
    };
    // PNG holds the high byte first.
    let texel = |i: usize| match map.format() {
        TexelFormat::Packed(_) => map.bytes(i).unwrap_or_default().to_vec(),
        TexelFormat::Depth(format) => {
            code(map, device, format, i).to_be_bytes()[4 - step..].to_vec()
        }
    };
    let rows: Vec<Vec<u8>> = texels(map).map(texel).collect();
    let data = bottom_up_rows(&rows, map.size());
    let mut bytes = Vec::new();
    let mut encoder = ::png::Encoder::new(&mut bytes, map.size(), map.size());
    encoder.set_color(colour);
    encoder.set_depth(depth);
    let mut writer = encoder.write_header().expect("a header in memory");
    writer.write_image_data(&data).expect("as many samples as the size says");
    drop(writer);
    bytes
}

fn bottom_up_rows(texels: &[Vec<u8>], side: u32) -> Vec<u8> {
    texels.chunks_exact(side as usize).rev().flatten().flatten().copied().collect()
}

fn exr_bytes(map: &ShadowMap, device: &Device) -> Vec<u8> {
    let depths: Vec<f32> = texels(map).map(|i| map.depth(device, i)).collect();
    let side = map.size() as usize;
    crate::report::ExrImage {
        id: "map".to_string(),
        width: side,
        height: side,
        channels: vec![("Z".to_string(), bottom_up(&depths, map.size()))],
        metadata: serde_json::json!({ "format": map.format().name() }),
    }
    .to_exr()
}
