//! The encodings section: packings before the store, their bytes, and what they decode to.

use super::outcome::{Entry, Tally};
use super::{dump, json};
use crate::Result;
use crate::depth::Packing;
use crate::device::Device;
use std::path::Path;

const SECTION: &str = "encodings";
/// How many of the depths have their packed floats dumped.
const PACKED: usize = 8192;
/// How many random texels are decoded.
const RANDOM: usize = 65_536;

/// Compares every encoding that `encodings.json` lists and the catalogue knows.
pub(super) fn compare(folder: &Path, device: &Device) -> Result<Vec<Entry>> {
    let layout = folder.join("encodings.json");
    let value = json::read(&layout)?;
    let root = json::Field::root(&layout, &value);
    let count = root.get("N")?.count(1 << 26)? as usize;
    let depths = dump::floats(&folder.join("depth_in.bin"), count)?;
    let Some(depths) = depths else { return Ok(vec![Tally::missing(SECTION, "depth_in.bin")]) };
    let random = dump::bytes(&folder.join("rand_bytes.bin"), RANDOM * 4)?;
    let mut entries = Vec::new();
    for (name, field) in root.get("encodings")?.members()? {
        let packing = packing(name)
            .ok_or_else(|| field.bad("is no known packing", "name one of the catalogue"));
        let Ok(packing) = packing else { continue };
        entries.extend(encoding(folder, device, name, packing, &depths, random.as_deref())?);
    }
    Ok(entries)
}

/// The packing behind the layout's name.
fn packing(name: &str) -> Option<Packing> {
    Some(match name {
        "three_now" => Packing::ThreeRgba,
        "three_150" => Packing::ThreeR86,
        "aras255" => Packing::Aras2009,
        "unity255" => Packing::UnityRgba,
        name => name.parse().ok()?,
    })
}

fn encoding(
    folder: &Path,
    device: &Device,
    name: &str,
    packing: Packing,
    depths: &[f32],
    random: Option<&[u8]>,
) -> Result<Vec<Entry>> {
    let n = depths.len();
    let file = |suffix: &str| format!("{name}_{suffix}.bin");
    let packed = |z: f32| packing.pack(device.flush(z)).map(|x| device.flush(x));
    let bytes = |z: f32| packed(z).map(|x| device.store.code(x, 255) as u8);
    let decode =
        |b: [u8; 4]| packing.unpack(b.map(|b| device.flush(device.load.value(u32::from(b), 255))));
    let mut entries = Vec::new();
    entries.push(match dump::bytes(&folder.join(file("bytes")), n * 4)? {
        None => Tally::missing(SECTION, file("bytes")),
        Some(expected) => {
            let mut tally = Tally::new(SECTION, file("bytes"));
            for (i, want) in expected.into_iter().enumerate() {
                let z = depths[i / 4];
                tally.integer(|| format!("z = {z:e}, byte {}", i % 4), want, bytes(z)[i % 4]);
            }
            tally.finish()
        }
    });
    entries.push(match dump::floats(&folder.join(file("decoded")), n)? {
        None => Tally::missing(SECTION, file("decoded")),
        Some(expected) => {
            let mut tally = Tally::new(SECTION, file("decoded"));
            for (&z, want) in depths.iter().zip(expected) {
                tally.float(|| format!("z = {z:e}"), want, decode(bytes(z)));
            }
            tally.finish()
        }
    });
    if let Some(expected) = dump::floats(&folder.join(file("packf32")), PACKED.min(n) * 4)? {
        let mut tally = Tally::new(SECTION, file("packf32"));
        for (i, want) in expected.into_iter().enumerate() {
            let z = depths[i / 4];
            tally.float(|| format!("z = {z:e}, channel {}", i % 4), want, packed(z)[i % 4]);
        }
        entries.push(tally.finish());
    }
    let expected = dump::floats(&folder.join(file("randdecoded")), RANDOM)?;
    if let (Some(random), Some(expected)) = (random, expected) {
        let mut tally = Tally::new(SECTION, file("randdecoded"));
        for (b, want) in random.chunks_exact(4).zip(expected) {
            let b = [b[0], b[1], b[2], b[3]];
            tally.float(|| format!("bytes {b:?}"), want, decode(b));
        }
        entries.push(tally.finish());
    }
    Ok(entries)
}
