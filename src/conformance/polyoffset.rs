//! The polyoffset section: measured effect of polygon offset on fragment and stored depth.

use super::json::{self, Field};
use super::outcome::{Entry, Tally};
use crate::Result;
use crate::depth::DepthFormat;
use crate::device::Device;
use crate::raster::{Plane, PolygonOffset, Setup};
use crate::scene::Cull;
use glam::Vec4;
use std::path::Path;

const SECTION: &str = "polyoffset";
const FILE: &str = "polyoffset.json";

/// Compares every row of `polyoffset.json`: minimum, maximum and mean over the covered pixels of the
/// difference with and without offset.
pub(super) fn compare(folder: &Path, device: &Device) -> Result<Vec<Entry>> {
    let path = folder.join(FILE);
    if !path.is_file() {
        return Ok(vec![Tally::missing(SECTION, FILE)]);
    }
    let value = json::read(&path)?;
    let root = Field::root(&path, &value);
    let size = root.get("size")?.count(4096)?;
    let mut rows = Tally::new(SECTION, "polyoffset.json rows");
    for row in root.get("rows")?.items()? {
        let slope = |name: &str| row.get(name)?.number();
        let (z0, sx, sy) = (slope("z0")?, slope("sx")?, slope("sy")?);
        let far = 2.0 * f64::from(size);
        let depth = |px: f64, py: f64| z0 + sx * px + sy * py;
        let corners = [depth(0.0, 0.0), depth(far, 0.0), depth(0.0, far)];
        compare_row(device, size, &row, covering_triangle(corners, 0), &mut rows)?;
    }
    let mut order = Tally::new(SECTION, "polyoffset.json vertexOrder");
    for row in root.get("vertexOrder")?.items()? {
        let depths = [row.get("za")?.number()?, row.get("zb")?.number()?, row.get("zc")?.number()?];
        let rotation = row.get("rot")?.number()? as usize;
        compare_row(device, size, &row, covering_triangle(depths, rotation), &mut order)?;
    }
    let mut clamped = Tally::new(SECTION, "polyoffset.json clamp");
    for (name, pair) in root.get("clamp")?.members()? {
        compare_clamp(device, size, name, &root.get("clamp")?, &pair, &mut clamped)?;
    }
    Ok(vec![rows.finish(), order.finish(), clamped.finish()])
}

fn vertex(x: f32, y: f32, window_depth: f64) -> Vec4 {
    Vec4::new(x, y, (window_depth * 2.0 - 1.0) as f32, 1.0)
}

/// One triangle over the whole canvas, its vertex list rotated.
fn covering_triangle(z: [f64; 3], rotation: usize) -> [Vec4; 3] {
    let v = [vertex(-1.0, -1.0, z[0]), vertex(3.0, -1.0, z[1]), vertex(-1.0, 3.0, z[2])];
    std::array::from_fn(|i| v[(i + rotation) % 3])
}

/// A pair [fragment depth, stored depth] of a flat surface pushed far out: `<format>_base` without
/// offset, `<format>_units<n>` and `<format>_unitsMinus<n>` with n units.
fn compare_clamp(
    device: &Device,
    size: u32,
    name: &str,
    all: &Field<'_>,
    pair: &Field<'_>,
    tally: &mut Tally,
) -> Result<()> {
    let fix = "name it <format>_base or <format>_units<n>";
    let (prefix, kind) = name.split_once('_').ok_or_else(|| pair.bad("has no format", fix))?;
    let format = match prefix {
        "d16" => DepthFormat::Unorm16,
        "d32f" => DepthFormat::F32,
        _ => return Err(pair.bad("names no known format", fix)),
    };
    let units = match kind.strip_prefix("units") {
        None => Ok(0.0),
        Some(n) => n.replace("Minus", "-").parse::<f32>(),
    };
    let units = units.map_err(|_| pair.bad("names no number of units", fix))?;
    let [base, _] = all.get(&format!("{prefix}_base"))?.array::<2>()?;
    let setup = Setup::new(device, [size; 2], covering_triangle([f64::from(base); 3], 0));
    let offset = setup.offset(device, format, PolygonOffset { factor: 0.0, units, clamp: 0.0 });
    let z = setup.depth().moved(offset).at((size / 2) as f32, (size / 2) as f32);
    let [fragment, stored] = pair.array::<2>()?;
    tally.float(|| format!("{name} fragment"), fragment, z);
    tally.float(|| format!("{name} stored"), stored, device.stored_depth(format, z));
    Ok(())
}

fn compare_row(
    device: &Device,
    size: u32,
    row: &Field<'_>,
    corners: [Vec4; 3],
    tally: &mut Tally,
) -> Result<()> {
    let words = [
        ("d16", Some(DepthFormat::Unorm16)),
        ("d24", Some(DepthFormat::Unorm24)),
        ("d24s8", Some(DepthFormat::Unorm24)),
        ("d32f", Some(DepthFormat::F32)),
        ("none", None),
    ];
    let format = row.get("fmt")?.word(&words)?;
    let factor = row.optional("factor").map_or(Ok(0.0), |f| f.float())?;
    let offset = PolygonOffset { factor, units: row.get("units")?.float()?, clamp: 0.0 };
    let measured = measure(device, size, corners, format, offset);
    for (name, found) in ["fragz", "stored"].into_iter().zip(measured) {
        let Some(expected) = row.optional(name) else { continue };
        let place = expected.place();
        tally.integer(|| format!("{place}.n"), expected.get("n")?.number()? as u64, found.count);
        for (key, value) in
            [("min", found.min), ("max", found.max), ("mean", found.sum / found.count as f64)]
        {
            tally.double(|| format!("{place}.{key}"), expected.get(key)?.number()?, value);
        }
    }
    Ok(())
}

/// Statistics of a difference over pixels.
struct Spread {
    count: u64,
    min: f64,
    max: f64,
    sum: f64,
}

impl Spread {
    const EMPTY: Self = Self { count: 0, min: f64::INFINITY, max: f64::NEG_INFINITY, sum: 0.0 };

    fn add(&mut self, x: f64) {
        self.count += 1;
        self.min = self.min.min(x);
        self.max = self.max.max(x);
        self.sum += x;
    }
}

/// Differences of fragment depth and of stored depth; without a depth attachment the offset is 0.
fn measure(
    device: &Device,
    size: u32,
    corners: [Vec4; 3],
    format: Option<DepthFormat>,
    offset: PolygonOffset,
) -> [Spread; 2] {
    let mut spreads = [Spread::EMPTY; 2];
    let setup = Setup::new(device, [size; 2], corners);
    let moved = setup.depth().moved(format.map_or(0.0, |f| setup.offset(device, f, offset)));
    setup.cover(device, [size; 2], Cull::None, |y, first, end| {
        for x in first..end {
            let at = |p: &Plane| p.at(x as f32, y as f32);
            let (a, b) = (at(setup.depth()), at(&moved));
            spreads[0].add(f64::from(b) - f64::from(a));
            if let Some(format) = format {
                let stored = |z: f32| f64::from(device.stored_depth(format, z));
                spreads[1].add(stored(b) - stored(a));
            }
        }
    });
    spreads
}
