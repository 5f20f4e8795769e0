//! Other files from a seed: maps, device profiles, packings, manifests and journals, sound but for a fault.

use super::mutate::Random;
use gnomon::output::journal::{Header, Outcome, encode};
use gnomon::output::{Manifest, OutFile};
use serde_json::{Value, json};
use std::collections::BTreeMap;

fn pick<'a, T>(random: &mut Random, list: &'a [T]) -> &'a T {
    &list[random.below(list.len())]
}

/// None, one or two single bytes of a file changed, or its end cut off.
fn spoil(mut bytes: Vec<u8>, random: &mut Random) -> Vec<u8> {
    if bytes.is_empty() {
        return bytes;
    }
    match random.below(4) {
        0 => {}
        1 => {
            let at = random.below(bytes.len());
            bytes[at] ^= 1 << random.below(8);
        }
        2 => {
            for _ in 0..2 {
                let at = random.below(bytes.len());
                bytes[at] = random.below(256) as u8;
            }
        }
        _ => bytes.truncate(bytes.len() - random.below(bytes.len().min(40))),
    }
    bytes
}

/// A chunk of a PNG with its sum, which is right unless the sum is the fault.
fn chunk(kind: &[u8; 4], data: &[u8]) -> Vec<u8> {
    let body = [kind, data].concat();
    let sum = crc32fast::hash(&body).to_be_bytes();
    [&(data.len() as u32).to_be_bytes()[..], &body, &sum].concat()
}

/// A PNG of a few texels; the fault is in its header, its samples or an extra chunk.
pub fn png(random: &mut Random) -> Vec<u8> {
    use std::io::Write;
    let side = 1 + random.below(9) as u32;
    let (colour, channels) = *pick(random, &[(0u8, 1), (2, 3), (4, 2), (6, 4), (3, 1)]);
    let depth = if colour == 3 { 8 } else { *pick(random, &[8u8, 8, 16]) };
    let row = 1 + side as usize * channels * usize::from(depth) / 8;
    let mut samples: Vec<u8> = (0..row * side as usize).map(|_| random.below(256) as u8).collect();
    samples.iter_mut().step_by(row).for_each(|filter| *filter %= 5);
    let (mut width, mut interlace) = (side, 0);
    let mut extra = Vec::new();
    match random.below(8) {
        0 => width = *pick(random, &[0, 2, 8193, 1 << 31, u32::MAX]),
        1 => interlace = random.below(3) as u8,
        2 => samples.truncate(random.below(samples.len())),
        3 => extra = chunk(b"zTXt", &spoil(b"Comment\0\0x\x9c\x03\0\0\0\0\x01".to_vec(), random)),
        4 => {
            extra =
                chunk(pick(random, &[*b"iCCP", *b"tRNS", *b"gAMA", *b"acTL", *b"fcTL"]), &[0; 9]);
        }
        5 => samples[0] = 9,
        _ => {}
    }
    let palette = if colour == 3 { chunk(b"PLTE", &[7; 768]) } else { Vec::new() };
    let head =
        [&width.to_be_bytes()[..], &side.to_be_bytes(), &[depth, colour, 0, 0, interlace]].concat();
    let mut packed = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::fast());
    packed.write_all(&samples).expect("memory");
    let data = chunk(b"IDAT", &packed.finish().expect("memory"));
    let bytes = [&b"\x89PNG\r\n\x1a\n"[..], &chunk(b"IHDR", &head), &extra, &palette, &data];
    let bytes = [&bytes.concat()[..], &chunk(b"IEND", &[])].concat();
    if random.below(8) == 0 { spoil(bytes, random) } else { bytes }
}

/// An EXR of a few texels, written by the library, then spoilt.
pub fn exr(random: &mut Random) -> Vec<u8> {
    let side = 1 + random.below(9);
    let channels = (0..1 + random.below(3))
        .map(|i| {
            (["Z", "R", "G"][i].to_string(), (0..side * side).map(|k| k as f32 * 0.01).collect())
        })
        .collect();
    let metadata = json!({});
    let image = gnomon::report::ExrImage {
        id: "map".into(),
        width: side,
        height: side,
        channels,
        metadata,
    };
    spoil(image.to_exr(), random)
}

/// Raw texels for a square of 4, often of the right length.
pub fn raw(random: &mut Random) -> Vec<u8> {
    let size = if random.below(3) > 0 { 64 } else { random.below(80) };
    (0..size).map(|_| random.below(256) as u8).collect()
}

/// What the panel of a page copies, with one field or number of another kind.
pub fn device(random: &mut Random) -> Vec<u8> {
    let mut value = json!({
        "schema": "gnomon-device-1", "renderer": "Phone 3000",
        "device": { "subpixel_bits": 8, "store": "truncate", "load": "divide", "depth24": "unorm24",
            "fma": false, "flush_denormals": false, "clamp_frag_z": true, "slope_norm": "unknown" },
        "polygon_offset": { "unorm16": { "r": 3.0517578125e-05 }, "f32": { "r": 5.96e-08 } },
    });
    let words = [
        json!("unknown"),
        json!(4),
        json!(0),
        json!(true),
        json!("euclid"),
        Value::Null,
        json!(1e300),
        json!("truncate"),
        json!([1]),
        json!("\u{1b}[31m"),
    ];
    if random.below(4) > 0 {
        let fields = gnomon::device::FIELDS;
        let name = fields[random.below(fields.len())].name;
        value["device"][name] = pick(random, &words).clone();
    }
    if random.below(4) == 0 {
        value["polygon_offset"]["unorm24"] = json!({ "r": pick(random, &words) });
    }
    value.to_string().into_bytes()
}

/// A packing in TOML, with one key of another kind.
pub fn packing(random: &mut Random) -> Vec<u8> {
    let channels = 1 + random.below(4);
    let base = pick(random, &["255.0", "256.0", "2.0", "1e30", "1.0000001"]);
    let mut text = format!("base = {base}\norder = \"high-first\"\nchannels = {channels}\n");
    let number = pick(random, &["1.0", "0.5", "1e-320", "1e308", "-1.0", "0.0", "nan", "inf"]);
    let list = vec![*number; channels + usize::from(random.below(6) == 0)].join(", ");
    for key in ["scales", "weights", "at_one", "at_zero"] {
        if random.below(3) == 0 {
            text += &format!("{key} = [{list}]\n");
        }
    }
    for key in ["upscale", "offset", "limit"] {
        if random.below(4) == 0 {
            text += &format!("{key} = {number}\n");
        }
    }
    text += *pick(
        random,
        &["", "unmasked = [0]\n", "decode = \"digits\"\n", "unmasked = [9]\n", "x = 1\n"],
    );
    text.into_bytes()
}

/// A manifest of a few files; names may lead anywhere.
pub fn manifest(random: &mut Random) -> Vec<u8> {
    let names = ["a.csv", "b/c.png", "../d", "/e", "", "f\n", "\u{202e}g", "manifest.json"];
    let digest = |random: &mut Random| "0123456789abcdef".repeat(4 + random.below(2));
    let outputs: BTreeMap<String, String> =
        (0..random.below(4)).map(|_| (pick(random, &names).to_string(), digest(random))).collect();
    let manifest = Manifest { schema: "gnomon-manifest-1".into(), outputs, ..Manifest::default() };
    let OutFile { bytes, .. } = manifest.to_file();
    spoil(bytes, random)
}

/// A journal of a few items, spoilt behind the sums or before them.
pub fn journal(random: &mut Random) -> Vec<u8> {
    let count = random.below(5) as u32;
    let header = Header { key: "k".repeat(64), about: "a sweep".into(), items: count + 1 };
    let outcome = |i: u32| -> Outcome {
        if i % 3 == 2 { Err("panicked".into()) } else { Ok(vec![i as u8; 3 * i as usize]) }
    };
    let items = (0..count).map(|i| (i + random.below(3) as u32 / 2, outcome(i))).collect();
    spoil(encode(&header, &items), random)
}
