//! The unorm section: what an RGBA8 target stores and what a byte samples as.

use super::outcome::{Entry, Tally};
use super::{dump, json};
use crate::Result;
use crate::device::Device;
use std::path::Path;

const SECTION: &str = "unorm";

/// Compares stores of `unorm_in.bin` and the 256 sampled bytes.
pub(super) fn compare(folder: &Path, device: &Device) -> Result<Vec<Entry>> {
    let layout = folder.join("unorm.json");
    let value = json::read(&layout)?;
    let count = json::Field::root(&layout, &value).get("N")?.count(1 << 26)? as usize;
    Ok(vec![stores(folder, device, count)?, samples(folder, device)?])
}

fn stores(folder: &Path, device: &Device, count: usize) -> Result<Entry> {
    let file = "unorm_out.bin";
    let input = dump::floats(&folder.join("unorm_in.bin"), count)?;
    let output = dump::bytes(&folder.join(file), count * 4)?;
    let (Some(input), Some(output)) = (input, output) else {
        return Ok(Tally::missing(SECTION, file));
    };
    let mut tally = Tally::new(SECTION, file);
    for (i, expected) in output.into_iter().enumerate() {
        let x = input[i / 4];
        let found = device.store.code(device.flush(x), 255);
        tally.integer(|| format!("store of {x:e}"), expected, found);
    }
    Ok(tally.finish())
}

fn samples(folder: &Path, device: &Device) -> Result<Entry> {
    let file = "byte_to_float_nearest.bin";
    let Some(expected) = dump::floats(&folder.join(file), 256)? else {
        return Ok(Tally::missing(SECTION, file));
    };
    let mut tally = Tally::new(SECTION, file);
    for (k, expected) in expected.into_iter().enumerate() {
        tally.float(|| format!("byte {k}"), expected, device.load.value(k as u32, 255));
    }
    Ok(tally.finish())
}
