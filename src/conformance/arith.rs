//! The arith section: shader expressions, bit by bit.
//!
//! `pow` and `exp` are left out: the measured implementation does not round them correctly and no
//! part of the pipeline uses them.

use super::outcome::{Entry, Tally};
use super::{dump, json};
use crate::Result;
use crate::device::Device;
use glam::{Mat4, Vec4};
use std::path::Path;

const SECTION: &str = "arith";

type Expression = fn(&Operands<'_>) -> [Option<f32>; 4];

struct Operands<'a> {
    device: &'a Device,
    m: Mat4,
    n: Mat4,
    a: Vec4,
    b: Vec4,
}

/// The expressions by the layout's names; `None` where a channel is not modelled.
const EXPRESSIONS: [(&str, Expression); 12] = [
    ("mat_vec", |o| all(o.device.mat_vec(&o.m, o.a))),
    ("mat_mat_vec", |o| all(o.device.mat_vec(&o.device.mat_mat(&o.m, &o.n), o.a))),
    ("mat_matvec", |o| all(o.device.mat_vec(&o.m, o.device.mat_vec(&o.n, o.a)))),
    ("div", |o| all(Vec4::new(o.a.x / o.b.x, o.a.y / o.b.w, o.a.z / o.b.w, 1.0 / o.b.w))),
    ("vec_div_scalar", |o| all(Vec4::new(o.a.x / o.b.w, o.a.y / o.b.w, o.a.z / o.b.w, 0.0))),
    ("mul_add", |o| {
        let (a, b) = (o.a, o.b);
        all(Vec4::new(a.x * b.x + a.y, a.x * b.x - a.z * b.z, a.x + b.x * a.w, (a.x + b.x) * a.y))
    }),
    ("book_coord", |o| {
        let coord = |x: f32| (x / o.b.w) / 2.0 + 0.5;
        all(Vec4::new(coord(o.a.x), coord(o.a.y), coord(o.a.z), 0.0))
    }),
    ("upc_coord", |o| {
        let coord = |x: f32| 0.5 * x / o.b.w + 0.5;
        all(Vec4::new(coord(o.a.x), coord(o.a.y), coord(o.a.z), 0.0))
    }),
    ("dot", |o| {
        let p = |i: usize| o.a[i] * o.b[i];
        all(Vec4::new(((p(0) + p(1)) + p(2)) + p(3), (p(0) + p(1)) + p(2), p(0) + p(1), 0.0))
    }),
    ("fract_floor", |o| {
        let fract = |x: f32| (x - x.floor()).min(1.0 - f32::EPSILON / 2.0);
        let a = o.a;
        let modulo = a.z - 0.75 * (a.z / 0.75).floor();
        all(Vec4::new(fract(a.x * 256.0), (a.x * 256.0).floor(), fract(a.y * 16_777_216.0), modulo))
    }),
    ("normalize", |o| {
        let a = o.a;
        let square = (a.x * a.x + a.y * a.y) + a.z * a.z;
        let scale = 1.0 / square.sqrt();
        all(Vec4::new(a.x * scale, a.y * scale, a.z * scale, square.sqrt()))
    }),
    ("roots", |o| [Some(o.b.x.sqrt()), Some(1.0 / o.b.x.sqrt()), None, None]),
];

fn all(v: Vec4) -> [Option<f32>; 4] {
    v.to_array().map(Some)
}

/// Compares every expression's dump.
pub(super) fn compare(folder: &Path, device: &Device) -> Result<Vec<Entry>> {
    let layout = folder.join("arith.json");
    let value = json::read(&layout)?;
    let root = json::Field::root(&layout, &value);
    let count = root.get("N")?.count(1 << 24)? as usize;
    let (m, n) = (root.get("M")?.matrix()?, root.get("Nmat")?.matrix()?);
    let read = |file: &str| dump::floats(&folder.join(file), count * 4);
    let (Some(a), Some(b)) = (read("a.bin")?, read("b.bin")?) else {
        return Ok(vec![Tally::missing(SECTION, "a.bin and b.bin")]);
    };
    let mut entries = Vec::new();
    for (name, expression) in EXPRESSIONS {
        let file = format!("{name}.bin");
        let Some(expected) = read(&file)? else {
            entries.push(Tally::missing(SECTION, file));
            continue;
        };
        let mut tally = Tally::new(SECTION, file);
        for i in 0..count {
            let at = |v: &[f32]| Vec4::from_slice(&v[i * 4..i * 4 + 4]);
            let found = expression(&Operands { device, m, n, a: at(&a), b: at(&b) });
            for (c, found) in found.into_iter().enumerate() {
                if let Some(found) = found {
                    tally.float(
                        || format!("[{i}] channel {c}"),
                        expected[i * 4 + c],
                        device.flush(found),
                    );
                }
            }
        }
        entries.push(tally.finish());
    }
    entries.push(mixes(&a, &b, read("mix_clamp.bin")?.as_deref()));
    entries.push(derivatives(read("deriv.bin")?.as_deref()));
    Ok(entries)
}

/// mix, clamp, smoothstep and step.
fn mixes(a: &[f32], b: &[f32], expected: Option<&[f32]>) -> Entry {
    let Some(expected) = expected else { return Tally::missing(SECTION, "mix_clamp.bin") };
    let mut tally = Tally::new(SECTION, "mix_clamp.bin");
    for (i, want) in expected.chunks_exact(4).enumerate() {
        let (a, b) = (&a[i * 4..i * 4 + 4], &b[i * 4..i * 4 + 4]);
        let t = ((b[0] - 0.1) / (0.9 - 0.1)).clamp(0.0, 1.0);
        let found = [
            a[0] + (a[1] - a[0]) * b[2],
            a[0].clamp(0.0, 1.0),
            t * t * (3.0 - 2.0 * t),
            f32::from(u8::from(a[1] >= a[0])),
        ];
        for (c, (&want, found)) in want.iter().zip(found).enumerate() {
            tally.float(|| format!("[{i}] channel {c}"), want, found);
        }
    }
    tally.finish()
}

/// Pixels per row of the target on which derivatives were dumped.
const ROW: usize = 64;

/// dFdx(0.1·x), dFdy(y²) and fwidth(x·y) of `gl_FragCoord`: differences within 2×2 quads, taken from
/// the quad's lower left pixel.
fn derivatives(expected: Option<&[f32]>) -> Entry {
    let Some(expected) = expected else { return Tally::missing(SECTION, "deriv.bin") };
    let mut tally = Tally::new(SECTION, "deriv.bin");
    for (i, want) in expected.chunks_exact(4).enumerate() {
        let centre = |pixel: usize| pixel as f32 + 0.5;
        let (x, y) = (i % ROW / 2 * 2, i / ROW / 2 * 2);
        let (x0, x1, y0, y1) = (centre(x), centre(x + 1), centre(y), centre(y + 1));
        let found = [
            x1 * 0.1 - x0 * 0.1,
            y1 * y1 - y0 * y0,
            (x1 * y0 - x0 * y0).abs() + (x0 * y1 - x0 * y0).abs(),
            0.0,
        ];
        for (c, (&want, found)) in want.iter().zip(found).enumerate() {
            tally.float(|| format!("[{i}] channel {c}"), want, found);
        }
    }
    tally.finish()
}
