//! The raster section: coverage, depth and varying planes, edge thresholds and snapping.

use super::outcome::{Entry, Tally};
use super::{dump, json};
use crate::Result;
use crate::device::Device;
use crate::raster::Setup;
use crate::scene::Cull;
use glam::Vec4;
use std::path::Path;

const SECTION: &str = "raster";
const BACKGROUND: f32 = -9.0;
/// Side of the canvas on which edges were measured.
const EDGE_CANVAS: u32 = 64;

/// Compares the random triangles, the edge thresholds and the fine snapping thresholds.
pub(super) fn compare(folder: &Path, device: &Device) -> Result<Vec<Entry>> {
    let layout = folder.join("raster.json");
    let value = json::read(&layout)?;
    let root = json::Field::root(&layout, &value);
    Ok(vec![
        triangles(
            folder,
            device,
            &root,
            &Dump { group: "affine", values: "affine_z.bin", channels: 1 },
        )?,
        triangles(
            folder,
            device,
            &root,
            &Dump { group: "persp", values: "persp_zwuv.bin", channels: 4 },
        )?,
        edges(device, &root)?,
        fine_snapping(device, &root)?,
    ])
}

struct Dump {
    group: &'static str,
    values: &'static str,
    channels: usize,
}

fn triangles(folder: &Path, device: &Device, root: &json::Field<'_>, dump: &Dump) -> Result<Entry> {
    let group = root.get(dump.group)?;
    let count = group.get("triangles")?.count(1 << 16)? as usize;
    let size = group.get("size")?.count(4096)?;
    let pixels = size as usize * size as usize;
    let vertices = dump::floats(&folder.join(format!("{}_verts.bin", dump.group)), count * 18)?;
    let values = dump::floats(&folder.join(dump.values), count * pixels * dump.channels)?;
    let (Some(vertices), Some(values)) = (vertices, values) else {
        return Ok(Tally::missing(SECTION, dump.values));
    };
    let mut tally = Tally::new(SECTION, dump.values);
    for (i, triangle) in vertices.chunks_exact(18).enumerate() {
        let found = draw(device, size, triangle);
        let expected = &values[i * pixels * dump.channels..][..pixels * dump.channels];
        for (j, &want) in expected.iter().enumerate() {
            let (pixel, channel) = (j / dump.channels, j % dump.channels);
            let place = || {
                format!(
                    "triangle {i}, x {}, y {}, channel {channel}",
                    pixel as u32 % size,
                    pixel as u32 / size
                )
            };
            tally.float(place, want, found[pixel][channel]);
        }
    }
    Ok(tally.finish())
}

/// Window depth, 1/w and two varyings of each pixel of one triangle (x, y, z, w, u, v per vertex).
fn draw(device: &Device, size: u32, triangle: &[f32]) -> Vec<[f32; 4]> {
    let corner = |i: usize| &triangle[i * 6..i * 6 + 6];
    let clip: [Vec4; 3] = std::array::from_fn(|i| Vec4::from_slice(corner(i)));
    let setup = Setup::new(device, [size; 2], clip);
    let varyings = setup.varyings(device);
    let mut picture = vec![[BACKGROUND; 4]; size as usize * size as usize];
    setup.cover(device, [size; 2], Cull::None, |y, first, end| {
        for x in first..end {
            let (px, py) = (x as f32, y as f32);
            let varying =
                |k: usize| varyings.scalar([corner(0)[k], corner(1)[k], corner(2)[k]], px, py);
            picture[(y * size + x) as usize] =
                [setup.depth().at(px, py), varyings.reciprocal_w(px, py), varying(4), varying(5)];
        }
    });
    picture
}

/// Pixels covered by an axis-aligned rectangle given in pixels, as low and high corner pixel.
fn covered(device: &Device, low: [f64; 2], high: [f64; 2]) -> Option<[[u32; 2]; 2]> {
    let ndc = |x: f64| (x / f64::from(EDGE_CANVAS) * 2.0 - 1.0) as f32;
    let at = |x: f64, y: f64| Vec4::new(ndc(x), ndc(y), 0.0, 1.0);
    let v = [at(low[0], low[1]), at(high[0], low[1]), at(low[0], high[1]), at(high[0], high[1])];
    let mut bounds: Option<[[u32; 2]; 2]> = None;
    for corners in [[v[0], v[1], v[2]], [v[2], v[1], v[3]]] {
        let setup = Setup::new(device, [EDGE_CANVAS; 2], corners);
        setup.cover(device, [EDGE_CANVAS; 2], Cull::None, |y, first, end| {
            let b = bounds.get_or_insert([[first, y], [end - 1, y]]);
            b[0] = [b[0][0].min(first), b[0][1].min(y)];
            b[1] = [b[1][0].max(end - 1), b[1][1].max(y)];
        });
    }
    bounds
}

/// The outermost covered pixel on `side` when that edge stands `offset` pixels beyond the centre of
/// pixel 10 (left, bottom) or 40 (right, top).
fn boundary(device: &Device, side: &str, offset: f64) -> Option<u32> {
    let (mut low, mut high) = ([10.5; 2], [40.5; 2]);
    match side {
        "left" => low[0] += offset,
        "bottom" => low[1] += offset,
        "right" => high[0] += offset,
        _ => high[1] += offset,
    }
    let [covered_low, covered_high] = covered(device, low, high)?;
    Some(match side {
        "left" => covered_low[0],
        "bottom" => covered_low[1],
        "right" => covered_high[0],
        _ => covered_high[1],
    })
}

fn edges(device: &Device, root: &json::Field<'_>) -> Result<Entry> {
    let mut tally = Tally::new(SECTION, "raster.json edges");
    for (target, sides) in root.get("edges")?.members()? {
        for (side, steps) in sides.members()? {
            let steps = steps.items()?;
            let step = |s: &json::Field<'_>| -> Result<(i32, u32)> {
                Ok((
                    s.get("from256ths")?.number()? as i32,
                    s.get("boundaryPixel")?.number()? as u32,
                ))
            };
            let steps = steps.iter().map(step).collect::<Result<Vec<_>>>()?;
            for k in -256..=256 {
                let Some(&(_, want)) = steps.iter().rev().find(|(from, _)| *from <= k) else {
                    continue;
                };
                let found = boundary(device, side, f64::from(k) / 256.0);
                let found = found.unwrap_or(u32::MAX);
                tally.integer(|| format!("{target} {side} edge at {k}/256"), want, found);
            }
        }
    }
    Ok(tally.finish())
}

fn fine_snapping(device: &Device, root: &json::Field<'_>) -> Result<Entry> {
    let mut tally = Tally::new(SECTION, "raster.json snapFine");
    let mut before: Option<u32> = None;
    for step in root.get("snapFine")?.items()? {
        let from = step.get("from4096ths")?.number()?;
        let want = step.get("leftmost")?.number()? as u32;
        let at = |k: f64| boundary(device, "left", k / 4096.0).unwrap_or(u32::MAX);
        tally.integer(|| format!("left edge at {from}/4096"), want, at(from));
        if let Some(before) = before {
            tally.integer(|| format!("left edge just below {from}/4096"), before, at(from - 1.0));
        }
        before = Some(want);
    }
    Ok(tally.finish())
}
