//! Captured maps: the shadow map that an engine has drawn, read from a file in place of our own raster.
//!
//! - **Rows.** PNG and EXR are written top row first, so their last row is texel row 0; raw files are
//!   what `glReadPixels` and map buffers hold: texel row 0 first.
//! - **Channels.** A packing reads R, G, B, A bytes (a missing A is 255, a grey picture is R, G and B
//!   alike). A depth format reads the grey or red channel of a PNG, the channel Z, R or Y of an EXR.
//! - **Numbers.** PNG: 8 bits are `unorm8`, 16 bits `unorm16`. EXR: depths as they are, `f32` unless
//!   another format is named. Raw: little-endian codes: 4 bytes a texel for packings, `unorm24` (low 24
//!   bits), `unorm32` and `f32`; 2 for `unorm16`, `f16` and `bf16`; 1 for `unorm8`.

mod pictures;

use crate::depth::DepthFormat;
use crate::device::Device;
use crate::light::Layout;
use crate::scene::{Case, CompareRule, TexelFormat, matrix};
use crate::shadow::ShadowMap;
use crate::{Error, Result, input};
use glam::DMat4;
use std::fs;
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
        let format = self.packing.as_deref().map(str::parse::<TexelFormat>).transpose()?;
        let bytes = input::read(path, input::DATA)?;
        let place = path.display().to_string();
        let extension = path.extension().and_then(|e| e.to_str()).unwrap_or("").to_lowercase();
        let device = case.device.device();
        let map = match extension.as_str() {
            "png" => pictures::from_png(&place, &bytes, format, &device)?,
            "exr" => pictures::from_exr(&place, bytes, format)?,
            "raw" => self.raw(&place, &bytes, format, &device)?,
            _ => {
                let reason = format!("'.{extension}' is no map file known here");
                return Err(Error::bad_input(place, reason, "give a .png, .exr or .raw file"));
            }
        };
        (case.map.size, case.map.texel) = (map.layout().side(), map.format());
        case.lookup.compare = self.compare.unwrap_or(case.lookup.compare);
        self.turn_light(case)?;
        let layout = case.layout();
        if layout.only().map(|rect| rect.size) != map.layout().only().map(|rect| rect.size) {
            let reason = format!("is one square; the light has {} maps", layout.rects().len());
            return Err(Error::bad_input(place, reason, "give a case with one square map"));
        }
        Ok(Some(Captured { map: map.lying(layout) }))
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
                let texels = bytes.chunks_exact(4).map(texel).collect();
                Ok(ShadowMap::from_bytes(Layout::whole([side; 2]), packing, texels))
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
    Ok(ShadowMap::from_depths(Layout::whole([side; 2]), format, depths))
}

/// Rows from top first to bottom first.
fn bottom_up<T: Copy>(texels: &[T], side: u32) -> Vec<T> {
    texels.chunks_exact(side as usize).rev().flatten().copied().collect()
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
    0..map.layout().texels()
}

/// Something of every texel of the picture with all textures, top row first; `empty` beside them.
fn pictured<T: Clone>(map: &ShadowMap, empty: &T, of: impl Fn(usize) -> T) -> Vec<T> {
    let [width, height] = map.layout().picture();
    let places = (0..height).rev().flat_map(|y| (0..width).map(move |x| (x, y)));
    let texel = |(x, y)| match map.layout().pictured(x, y) {
        Some(texel) => of(texel as usize),
        None => empty.clone(),
    };
    places.map(texel).collect()
}

fn code(map: &ShadowMap, device: &Device, format: DepthFormat, texel: usize) -> u32 {
    format.encode(map.window_depth(device, texel))
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
        TexelFormat::Packed(_) => (png::ColorType::Rgba, png::BitDepth::Eight, 4),
        TexelFormat::Depth(DepthFormat::Unorm8) => {
            (png::ColorType::Grayscale, png::BitDepth::Eight, 1)
        }
        TexelFormat::Depth(_) => (png::ColorType::Grayscale, png::BitDepth::Sixteen, 2),
    };
    // PNG holds the high byte first.
    let texel = |i: usize| match map.format() {
        TexelFormat::Packed(_) => map.bytes(i).unwrap_or_default().to_vec(),
        TexelFormat::Depth(format) => {
            code(map, device, format, i).to_be_bytes()[4 - step..].to_vec()
        }
    };
    let data = pictured(map, &vec![0; step], texel).concat();
    let ([width, height], mut bytes) = (map.layout().picture(), Vec::new());
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(colour);
    encoder.set_depth(depth);
    let mut writer = encoder.write_header().expect("a header in memory");
    writer.write_image_data(&data).expect("as many samples as the size says");
    drop(writer);
    bytes
}

fn exr_bytes(map: &ShadowMap, device: &Device) -> Vec<u8> {
    let depths = pictured(map, &map.layout().cleared(), |i| map.window_depth(device, i));
    let [width, height] = map.layout().picture().map(|side| side as usize);
    crate::report::ExrImage {
        id: "map".to_string(),
        width,
        height,
        channels: vec![("Z".to_string(), depths)],
        metadata: serde_json::json!({ "format": map.format().name() }),
    }
    .to_exr()
}
