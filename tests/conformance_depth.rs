//! The emulation against what a real WebGL wrote: stores, samplers, packings, depth formats.
//!
//! Whole dumps: `GNOMON_WEBGL=DIR cargo test --release --test conformance_depth`; else the committed
//! copies of every n-th sample. Every comparison is of bits, and none may differ.

#[path = "support/dumps.rs"]
mod dumps;

use dumps::{dump, floats, say_which_dumps};
use gnomon::depth::roundtrip::AnyRoundTrip;
use gnomon::depth::{Arithmetic, DepthFormat, Packing, UnormLoad, UnormStore};
use gnomon::depth::{ByteStore, roundtrip::Path};

/// The measured device flushes denormals before arithmetic.
fn flushed(x: f32) -> f32 {
    if x.is_subnormal() { 0.0_f32.copysign(x) } else { x }
}

fn differing<T: PartialEq>(
    ours: impl Iterator<Item = T>,
    theirs: impl Iterator<Item = T>,
) -> usize {
    let (mut count, mut differing) = (0, 0);
    let mut theirs = theirs;
    for value in ours {
        count += 1;
        differing += usize::from(theirs.next() != Some(value));
    }
    assert!(count > 1000 && theirs.next().is_none(), "same, sufficient length: {count}");
    differing
}

const ENCODINGS: [(&str, Packing); 6] = [
    ("r8", Packing::R8),
    ("book", Packing::Book),
    ("upc", Packing::Upc),
    ("three_now", Packing::ThreeRgba),
    ("three_150", Packing::ThreeR86),
    ("aras255", Packing::Aras2009),
];

#[test]
fn bytes_of_every_encoding() {
    say_which_dumps("bytes_of_every_encoding");
    let depths = floats("encodings/depth_in.bin");
    for (name, packing) in ENCODINGS {
        let theirs = dump(&format!("encodings/{name}_bytes.bin"));
        let ours = depths.iter().flat_map(|&z| {
            packing.pack(flushed(z)).map(|c| UnormStore::HalfEven.code(c, 255) as u8)
        });
        assert_eq!(differing(ours, theirs.into_iter()), 0, "{name}");
    }
}

#[test]
fn decoded_depths_of_every_encoding() {
    let bytes_to_channels =
        |b: &[u8]| [b[0], b[1], b[2], b[3]].map(|k| UnormLoad::Reciprocal.value(k.into(), 255));
    for (name, packing) in ENCODINGS {
        let bytes = dump(&format!("encodings/{name}_bytes.bin"));
        let ours = bytes.chunks_exact(4).map(|b| packing.unpack(bytes_to_channels(b)).to_bits());
        let theirs = floats(&format!("encodings/{name}_decoded.bin"));
        assert_eq!(differing(ours, theirs.into_iter().map(f32::to_bits)), 0, "{name}");
    }
}

#[test]
fn channels_before_the_store() {
    let depths = floats("encodings/depth_in.bin");
    for (name, packing) in &ENCODINGS[1..] {
        let theirs = floats(&format!("encodings/{name}_packf32.bin"));
        let depths = &depths[..theirs.len() / 4];
        let ours = depths.iter().flat_map(|&z| packing.pack(flushed(z)));
        // Zeros of either sign and flushed denormals are one value to the texture unit.
        let bits = |x: f32| (flushed(x) + 0.0).to_bits();
        assert_eq!(differing(ours.map(bits), theirs.into_iter().map(bits)), 0, "{name}");
    }
}

#[test]
fn the_vectorised_round_trip_is_the_measured_one() {
    let depths = floats("encodings/depth_in.bin");
    let path = Path {
        rounding: ByteStore::HalfEven.roundings()[0],
        load: UnormLoad::Reciprocal,
        arithmetic: Arithmetic::F32,
    };
    for (name, packing) in ENCODINGS {
        let AnyRoundTrip::F32(trip) = path.of_packing(packing) else {
            panic!("f32 decodes to f32")
        };
        let theirs = floats(&format!("encodings/{name}_decoded.bin"));
        let run = |&z: &f32| {
            let mut out = [0.0; 1];
            trip.run(gnomon::simd::Level::best(), flushed(z).to_bits(), &mut out);
            assert_eq!(out[0].to_bits(), trip.decoded(flushed(z)).to_bits(), "scalar at {z:e}");
            out[0].to_bits()
        };
        let differing = differing(depths.iter().map(run), theirs.into_iter().map(f32::to_bits));
        assert_eq!(differing, 0, "{name}");
    }
}

#[test]
fn unorm8_stores_and_samples() {
    say_which_dumps("unorm8_stores_and_samples");
    let inputs = floats("unorm/unorm_in.bin");
    let theirs = dump("unorm/unorm_out.bin");
    let ours = inputs.iter().map(|&x| UnormStore::HalfEven.code(flushed(x), 255) as u8);
    assert_eq!(differing(ours, theirs.chunks_exact(4).map(|b| b[0])), 0, "stored bytes");
    let half_up = inputs.iter().zip(theirs.chunks_exact(4));
    let told_apart =
        half_up.filter(|(x, b)| UnormStore::HalfUp.code(**x, 255) as u8 != b[0]).count();
    assert!(told_apart > 100, "the samples tell the rounding rules apart: {told_apart}");
    let sampled = floats("unorm/byte_to_float_nearest.bin");
    for (k, theirs) in (0u32..).zip(sampled) {
        assert_eq!(UnormLoad::Reciprocal.value(k, 255).to_bits(), theirs.to_bits(), "byte {k}");
    }
}

/// What the measured device keeps of a depth: 16 bits as such, all else as f32.
fn stored(format: DepthFormat, depth: f32) -> u32 {
    let code = format.encode_with(UnormStore::HalfEven, flushed(depth));
    format.decode_with(UnormLoad::Reciprocal, code).to_bits()
}

const DEPTH_DUMPS: [(&str, DepthFormat); 5] = [
    ("d16", DepthFormat::Unorm16),
    ("d24", DepthFormat::F32),
    ("d32f", DepthFormat::F32),
    ("d24s8", DepthFormat::F32),
    ("d32fs8", DepthFormat::F32),
];

#[test]
fn depth_formats_store_what_a_shader_writes() {
    say_which_dumps("depth_formats_store_what_a_shader_writes");
    let inputs = floats("depth/fragdepth_in.bin");
    for (name, format) in DEPTH_DUMPS {
        let theirs = floats(&format!("depth/fragdepth_{name}.bin"));
        let ours = inputs.iter().map(|&z| stored(format, z));
        assert_eq!(differing(ours, theirs.into_iter().map(f32::to_bits)), 0, "{name}");
    }
}

#[test]
fn window_depth_of_clip_positions() {
    let inputs = floats("depth/points_in.bin");
    let zw = floats("depth/points_fragcoord_zw.bin");
    let window = |z: f32, w: f32| z * (1.0 / w) * 0.5 + 0.5;
    let ours = inputs.chunks_exact(4).map(|p| window(p[2], p[3]).to_bits());
    assert_eq!(differing(ours, zw.chunks_exact(2).map(|c| c[0].to_bits())), 0, "gl_FragCoord.z");
    for (name, format) in &DEPTH_DUMPS[..3] {
        let theirs = floats(&format!("depth/points_{name}.bin"));
        let ours = inputs.chunks_exact(4).map(|p| stored(*format, window(p[2], p[3])));
        assert_eq!(differing(ours, theirs.into_iter().map(f32::to_bits)), 0, "{name}");
    }
}

#[test]
fn webgl1_depth_textures() {
    let inputs = floats("depth/webgl1_in.bin");
    let formats = [
        ("unsigned_short", DepthFormat::Unorm16),
        ("unsigned_int", DepthFormat::F32),
        ("unsigned_int_24_8", DepthFormat::F32),
    ];
    for (name, format) in formats {
        let theirs = floats(&format!("depth/webgl1_{name}.bin"));
        let ours = inputs.iter().map(|&z| stored(format, z * 0.5 + 0.5));
        assert_eq!(differing(ours, theirs.into_iter().map(f32::to_bits)), 0, "{name}");
    }
}

#[test]
fn slanted_planes_are_quantised_alike() {
    for plane in 0..4 {
        let depths = floats(&format!("depth/plane{plane}_fragz.bin"));
        for (name, format) in &DEPTH_DUMPS[..3] {
            let theirs = floats(&format!("depth/plane{plane}_{name}.bin"));
            let ours = depths.iter().map(|&z| stored(*format, z));
            let differing = differing(ours, theirs.into_iter().map(f32::to_bits));
            assert_eq!(differing, 0, "plane {plane} {name}");
        }
    }
}
