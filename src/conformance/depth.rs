//! The depth section: what depth attachments store, and the window depth of points and planes.

use super::outcome::{Entry, Tally};
use super::{dump, json};
use crate::Result;
use crate::depth::DepthFormat;
use crate::device::Device;
use crate::raster::{NO_TRIANGLE, Pass, PolygonOffset, draw};
use crate::scene::Cull;
use glam::Vec4;
use std::path::Path;

const SECTION: &str = "depth";

/// Attachment names of the layout.
const FORMATS: [(&str, DepthFormat); 5] = [
    ("d16", DepthFormat::Unorm16),
    ("d24", DepthFormat::Unorm24),
    ("d32f", DepthFormat::F32),
    ("d24s8", DepthFormat::Unorm24),
    ("d32fs8", DepthFormat::F32),
];

/// WebGL 1 depth texture types of the layout.
const WEBGL1: [(&str, DepthFormat); 3] = [
    ("unsigned_short", DepthFormat::Unorm16),
    ("unsigned_int", DepthFormat::Unorm24),
    ("unsigned_int_24_8", DepthFormat::Unorm24),
];

/// Compares stored fragment depths, points, planes, clear values and WebGL 1 depth textures.
pub(super) fn compare(folder: &Path, device: &Device) -> Result<Vec<Entry>> {
    let layout = folder.join("depth.json");
    let value = json::read(&layout)?;
    let root = json::Field::root(&layout, &value);
    let mut entries = fragment_depths(folder, device, &root)?;
    entries.extend(points(folder, device, &root)?);
    entries.push(clear_values(device, &root)?);
    entries.extend(planes(folder, device, &root)?);
    entries.extend(webgl1(folder, device, &root)?);
    Ok(entries)
}

/// Compares one dump of floats with values computed from inputs of the same length.
fn floats(folder: &Path, file: &str, inputs: &[f32], found: impl Fn(f32) -> f32) -> Result<Entry> {
    let Some(expected) = dump::floats(&folder.join(file), inputs.len())? else {
        return Ok(Tally::missing(SECTION, file));
    };
    let mut tally = Tally::new(SECTION, file);
    for (i, (&x, want)) in inputs.iter().zip(expected).enumerate() {
        tally.float(|| format!("[{i}] of {x:e}"), want, found(x));
    }
    Ok(tally.finish())
}

fn fragment_depths(folder: &Path, device: &Device, root: &json::Field<'_>) -> Result<Vec<Entry>> {
    let count = root.get("fragdepth")?.get("N")?.count(1 << 26)? as usize;
    let file = "fragdepth_in.bin";
    let Some(inputs) = dump::floats(&folder.join(file), count)? else {
        return Ok(vec![Tally::missing(SECTION, file)]);
    };
    let format = |(name, format): (&str, DepthFormat)| {
        let file = format!("fragdepth_{name}.bin");
        floats(folder, &file, &inputs, |z| device.stored_depth(format, z))
    };
    FORMATS.into_iter().map(format).collect()
}

/// f32(f32(f32(z·rhw)·½) + ½) with rhw = f32(1/w).
fn window_depth(device: &Device, z: f32, w: f32) -> f32 {
    device.flush(z * (1.0 / w)) * 0.5 + 0.5
}

fn points(folder: &Path, device: &Device, root: &json::Field<'_>) -> Result<Vec<Entry>> {
    let count = root.get("points")?.get("N")?.count(1 << 26)? as usize;
    let Some(inputs) = dump::floats(&folder.join("points_in.bin"), count * 4)? else {
        return Ok(vec![Tally::missing(SECTION, "points_in.bin")]);
    };
    let file = "points_fragcoord_zw.bin";
    let mut entries = Vec::new();
    entries.push(match dump::floats(&folder.join(file), count * 2)? {
        None => Tally::missing(SECTION, file),
        Some(expected) => {
            let mut tally = Tally::new(SECTION, file);
            for (i, (p, want)) in inputs.chunks_exact(4).zip(expected.chunks_exact(2)).enumerate() {
                tally.float(|| format!("[{i}] z"), want[0], window_depth(device, p[2], p[3]));
                tally.float(|| format!("[{i}] 1/w"), want[1], 1.0 / p[3]);
            }
            tally.finish()
        }
    });
    let depths: Vec<f32> =
        inputs.chunks_exact(4).map(|p| window_depth(device, p[2], p[3])).collect();
    for (name, format) in &FORMATS[..3] {
        let file = format!("points_{name}.bin");
        entries.push(floats(folder, &file, &depths, |z| device.stored_depth(*format, z))?);
    }
    Ok(entries)
}

fn clear_values(device: &Device, root: &json::Field<'_>) -> Result<Entry> {
    let clear = root.get("clearDepth")?;
    let values = clear.get("values")?.floats()?;
    let mut tally = Tally::new(SECTION, "depth.json clearDepth");
    for (name, format) in FORMATS {
        let Some(stored) = clear.get("stored")?.optional(name) else { continue };
        for (&z, want) in values.iter().zip(stored.floats()?) {
            tally.float(
                || format!("{name} cleared to {z:e}"),
                want,
                device.stored_depth(format, z),
            );
        }
    }
    Ok(tally.finish())
}

fn planes(folder: &Path, device: &Device, root: &json::Field<'_>) -> Result<Vec<Entry>> {
    let planes = root.get("planes")?;
    let size = planes.get("size")?.count(4096)?;
    let mut entries = Vec::new();
    for (i, plane) in planes.get("list")?.items()?.into_iter().enumerate() {
        let corners = plane.get("vertices")?.array::<16>()?;
        let clip: Vec<Vec4> = corners.chunks_exact(4).map(Vec4::from_slice).collect();
        let pass = Pass {
            size: [size; 2],
            cull: Cull::None,
            depth_buffer: DepthFormat::F32,
            offset: PolygonOffset::default(),
            clip: Default::default(),
        };
        let raster = draw(device, &pass, &clip, &[[0, 1, 2], [2, 1, 3]]);
        let drawn = |j: usize| raster.triangle[j] != NO_TRIANGLE;
        let depth: Vec<f32> = (0..raster.depth.len())
            .map(|j| if drawn(j) { raster.depth[j] } else { f32::NAN })
            .collect();
        entries.push(floats(folder, &format!("plane{i}_fragz.bin"), &depth, |z| z)?);
        for (name, format) in &FORMATS[..3] {
            let file = format!("plane{i}_{name}.bin");
            entries.push(floats(folder, &file, &depth, |z| device.stored_depth(*format, z))?);
        }
    }
    Ok(entries)
}

fn webgl1(folder: &Path, device: &Device, root: &json::Field<'_>) -> Result<Vec<Entry>> {
    let count = root.get("webgl1")?.get("points")?.count(1 << 26)? as usize;
    let file = "webgl1_in.bin";
    let Some(inputs) = dump::floats(&folder.join(file), count)? else {
        return Ok(vec![Tally::missing(SECTION, file)]);
    };
    let depth_of = |format: DepthFormat| {
        move |z: f32| device.stored_depth(format, window_depth(device, z, 1.0))
    };
    let kind = |(name, format): (&str, DepthFormat)| {
        floats(folder, &format!("webgl1_{name}.bin"), &inputs, depth_of(format))
    };
    WEBGL1.into_iter().map(kind).collect()
}
