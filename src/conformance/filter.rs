//! The filter section: texels that NEAREST picks, weights of LINEAR, wrapping, compare filtering.

use super::outcome::{Entry, Tally};
use super::{dump, json};
use crate::Result;
use crate::device::{Device, NearestCoord};
use crate::scene::Wrap;
use crate::shadow::sampler;
use std::path::Path;

const SECTION: &str = "filter";
/// Steps from one texel centre to the next in the one-dimensional dumps.
const STEPS: usize = 4097;

/// Compares the dumps of one- and two-dimensional filtering.
pub(super) fn compare(folder: &Path, device: &Device) -> Result<Vec<Entry>> {
    let layout = folder.join("filter.json");
    let value = json::read(&layout)?;
    let root = json::Field::root(&layout, &value);
    let mut entries = Vec::new();
    for (name, group) in root.get("nearest")?.members()? {
        if let Some(width) = name.strip_prefix('W').and_then(|w| w.parse().ok()) {
            let samples = group.get("samples")?.count(1 << 26)? as usize;
            entries.extend(nearest(folder, device, width, samples)?);
        }
    }
    for width in [2, 512, 1024, 2048] {
        entries.extend(linear(folder, device, width)?);
    }
    entries.push(linear_2d(folder, device)?);
    entries.push(wrap(device, &root)?);
    entries.push(compare_filter(&root)?);
    Ok(entries)
}

fn nearest(folder: &Path, device: &Device, width: u32, samples: usize) -> Result<Vec<Entry>> {
    let Some(u) = dump::floats(&folder.join(format!("nearest{width}_u.bin")), samples)? else {
        return Ok(Vec::new());
    };
    let fixed = device.nearest == NearestCoord::Fixed16;
    [("rgba8", fixed), ("r32f", false)]
        .into_iter()
        .map(|(kind, fixed)| {
            let file = format!("nearest{width}_{kind}_texel.bin");
            let Some(texels) = dump::floats(&folder.join(&file), samples)? else {
                return Ok(Tally::missing(SECTION, file));
            };
            let mut tally = Tally::new(SECTION, file);
            for (&u, want) in u.iter().zip(texels) {
                let found = sampler::nearest_texel(u, width, Wrap::Clamp, fixed);
                tally.integer(|| format!("u = {u:e}"), want.to_bits(), found);
            }
            Ok(tally.finish())
        })
        .collect()
}

fn linear(folder: &Path, device: &Device, width: u32) -> Result<Vec<Entry>> {
    let texel = [255.0, 128.0, 1.0, 200.0];
    let scale = device.load.value(1, 255);
    let kinds: [(&str, usize, f32); 2] = [("rgba8", 4, scale), ("r32f", 1, 1.0)];
    let mut entries = Vec::new();
    for (kind, channels, scale) in kinds {
        let file = format!("linear_{kind}_W{width}.bin");
        let Some(expected) = dump::floats(&folder.join(&file), STEPS * channels)? else { continue };
        let mut tally = Tally::new(SECTION, file);
        for (i, want) in expected.into_iter().enumerate() {
            let u =
                (f64::from(width) / 2.0 - 0.5 + (i / channels) as f64 / 4096.0) / f64::from(width);
            let lit = if channels == 4 { texel[i % 4] } else { 1.0 };
            let fetch = |x: u32, _: u32| if x == width / 2 { lit } else { 0.0 };
            let found = sampler::linear(fetch, [width, 1], Wrap::Clamp, [u as f32, 0.5]) * scale;
            tally.float(|| format!("step {}, channel {}", i / channels, i % channels), want, found);
        }
        entries.push(tally.finish());
    }
    Ok(entries)
}

/// The four texels around (1001, 1201) of a 2048² texture, walked in 32nds.
fn linear_2d(folder: &Path, device: &Device) -> Result<Entry> {
    const TEXELS: [[f32; 4]; 4] = [
        [10.0, 0.0, 255.0, 7.0],
        [250.0, 255.0, 0.0, 80.0],
        [100.0, 33.0, 128.0, 200.0],
        [30.0, 77.0, 129.0, 255.0],
    ];
    let file = "linear2d_2048.bin";
    let Some(expected) = dump::floats(&folder.join(file), 33 * 33 * 4)? else {
        return Ok(Tally::missing(SECTION, file));
    };
    let mut tally = Tally::new(SECTION, file);
    let coordinate = |texel: f64, i: usize| ((texel + 0.5 + i as f64 / 32.0) / 2048.0) as f32;
    for (n, want) in expected.into_iter().enumerate() {
        let (i, j, c) = (n / 4 % 33, n / 4 / 33, n % 4);
        let fetch = |x: u32, y: u32| {
            let (column, row) = (x.clamp(1000, 1001) - 1000, y.clamp(1200, 1201) - 1200);
            TEXELS[(row * 2 + column) as usize][c]
        };
        let uv = [coordinate(1000.0, i), coordinate(1200.0, j)];
        let found = sampler::linear(fetch, [2048; 2], Wrap::Clamp, uv) * device.load.value(1, 255);
        tally.float(|| format!("i {i} j {j} channel {c}"), want, found);
    }
    Ok(tally.finish())
}

/// REPEAT with NEAREST on four texels 50, 100, 150, 200.
fn wrap(device: &Device, root: &json::Field<'_>) -> Result<Entry> {
    let mut tally = Tally::new(SECTION, "filter.json wrap");
    let fixed = device.nearest == NearestCoord::Fixed16;
    for row in root.get("wrap")?.items()? {
        let [u, want] = row.array::<2>()?;
        let texel = sampler::nearest_texel(u, 4, Wrap::Repeat, fixed);
        tally.integer(|| format!("u = {u:e}"), want as u32, 50 * (texel + 1));
    }
    Ok(tally.finish())
}

/// A 512-texel depth ramp k/512 under LINEAR with compare LEQUAL, and without compare (reads 0).
fn compare_filter(root: &json::Field<'_>) -> Result<Entry> {
    let mut tally = Tally::new(SECTION, "filter.json shadowSamplerLinear");
    let reference = 100.5 / 512.0;
    let results = root.get("shadowSamplerLinear")?.get("result")?.floats()?;
    for (i, want) in results.into_iter().enumerate() {
        let u = ((100.5 + i as f64 / 32.0) / 512.0) as f32;
        let lit = |x: u32, _: u32| f32::from(u8::from(reference <= x as f32 / 512.0));
        let found = sampler::linear(lit, [512, 1], Wrap::Clamp, [u, 0.5]);
        tally.float(|| format!("i = {i}"), want, found);
    }
    Ok(tally.finish())
}
