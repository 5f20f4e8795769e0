//! Filters of meshopt's attributes: what is left to do to a decoded vertex. Arithmetic is f32, as the
//! specification has it.

/// Undoes a filter in place.
pub(super) fn apply(
    filter: &str,
    bytes: &mut [u8],
    stride: usize,
) -> std::result::Result<(), &'static str> {
    match (filter, stride) {
        ("NONE", _) => {}
        ("OCTAHEDRAL", 4) => {
            each(bytes, |v| octahedral(v.map(f32::from), 127.0).map(|x| x as i8));
        }
        ("OCTAHEDRAL", 8) => {
            each16(bytes, |v| octahedral(v.map(f32::from), 32767.0).map(|x| x as i16));
        }
        ("QUATERNION", 8) => each16(bytes, quaternion),
        ("EXPONENTIAL", _) => {
            bytes.as_chunks_mut::<4>().0.iter_mut().for_each(|word| *word = exponential(*word));
        }
        ("COLOR", 4) => {
            each(bytes, |v: [i8; 4]| {
                let alpha = u32::from(v[3].cast_unsigned());
                colour(v.map(i32::from), alpha, 8).map(|x| (x as u8).cast_signed())
            });
        }
        ("COLOR", 8) => each16(bytes, |v| {
            let alpha = u32::from(v[3].cast_unsigned());
            colour(v.map(i32::from), alpha, 16).map(|x| (x as u16).cast_signed())
        }),
        _ => return Err("its compression has a filter that is not known"),
    }
    Ok(())
}

fn each(bytes: &mut [u8], change: impl Fn([i8; 4]) -> [i8; 4]) {
    for vertex in bytes.as_chunks_mut::<4>().0 {
        *vertex = change(vertex.map(u8::cast_signed)).map(i8::cast_unsigned);
    }
}

fn each16(bytes: &mut [u8], change: impl Fn([i16; 4]) -> [i16; 4]) {
    for vertex in bytes.as_chunks_mut::<8>().0 {
        let [a, b, c, d, e, f, g, h] = *vertex;
        let halves = [[a, b], [c, d], [e, f], [g, h]].map(i16::from_le_bytes);
        let [[a, b], [c, d], [e, f], [g, h]] = change(halves).map(i16::to_le_bytes);
        *vertex = [a, b, c, d, e, f, g, h];
    }
}

/// The nearest integer, halves away from zero.
fn nearest(x: f32) -> f32 {
    (x + if x >= 0.0 { 0.5 } else { -0.5 }).trunc()
}

/// A direction from its place on an octahedron; the third number is 1 in the same units, the fourth stays.
fn octahedral([x, y, one, w]: [f32; 4], largest: f32) -> [f32; 4] {
    let z = one - x.abs() - y.abs();
    let fold = if z >= 0.0 { 0.0 } else { z };
    let folded = |c: f32| c + if c >= 0.0 { fold } else { -fold };
    let (x, y) = (folded(x), folded(y));
    let scale = largest / (x * x + y * y + z * z).sqrt();
    [nearest(x * scale), nearest(y * scale), nearest(z * scale), w]
}

/// A rotation from its three smaller parts, their scale and which part is the largest.
fn quaternion([x, y, z, rest]: [i16; 4]) -> [i16; 4] {
    let scale = 1.0 / 2.0f32.sqrt() / f32::from(rest | 3);
    let [x, y, z] = [x, y, z].map(|c| f32::from(c) * scale);
    let w = (1.0 - x * x - y * y - z * z).max(0.0).sqrt();
    let [x, y, z, w] = [x, y, z, w].map(|c| nearest(c * 32767.0) as i16);
    match rest & 3 {
        0 => [w, x, y, z],
        1 => [z, w, x, y],
        2 => [y, z, w, x],
        _ => [x, y, z, w],
    }
}

/// A float from 24 bits of mantissa and 8 of exponent.
fn exponential(word: [u8; 4]) -> [u8; 4] {
    let v = i32::from_le_bytes(word);
    let (mantissa, exponent) = ((v << 8) >> 8, v >> 24);
    let power = f32::from_bits((exponent.wrapping_add(127) as u32) << 23);
    (power * mantissa as f32).to_le_bytes()
}

/// A colour from luma, two differences and an alpha whose highest bit gives the scale.
fn colour([y, co, cg, _]: [i32; 4], alpha: u32, bits: u32) -> [f32; 4] {
    let luma = y & ((1 << bits) - 1);
    let scale = [1, 2, 4, 8].iter().fold(alpha, |scale, shift| scale | scale >> shift);
    let expanded = ((alpha << 1) & scale) | (alpha & 1);
    let factor = ((1u32 << bits) - 1) as f32 / scale as f32;
    let channel = |c: i32| (c as f32 * factor + 0.5).trunc();
    [
        channel(luma + co - cg),
        channel(luma + cg),
        channel(luma - co - cg),
        (expanded as f32 * factor + 0.5).trunc(),
    ]
}
