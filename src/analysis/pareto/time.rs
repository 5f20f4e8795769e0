//! Measured times on this machine: nanoseconds a look-up and a map texel. Printed and written where
//! asked, never part of a report.

use super::algorithms::Way;
use super::cost::Cost;
use crate::depth::{DepthFormat, Packing};
use crate::light::Lookup;
use crate::raster::passes::{MapRaster, Transformed, draw_map, map_depth_buffer};
use crate::scene::{Case, Filter, TexelFormat};
use crate::shadow::bias::Strategy;
use crate::shadow::{ShadowMap, visibility};
use serde_json::{Value, json};
use std::hint::black_box;
use std::time::Instant;

/// Look-ups are repeated until so many seconds have gone by.
const SECONDS: f64 = 0.05;

/// Formats that are timed.
const FORMATS: [TexelFormat; 3] = [
    TexelFormat::Depth(DepthFormat::F32),
    TexelFormat::Packed(Packing::Book),
    TexelFormat::Packed(Packing::ThreeRgba),
];

/// Seconds of one call, the least of three.
fn seconds<T>(mut run: impl FnMut() -> T) -> f64 {
    let one = |_| {
        let started = Instant::now();
        black_box(run());
        started.elapsed().as_secs_f64()
    };
    (0..3).map(one).fold(f64::INFINITY, f64::min)
}

/// Drawing and storing a map, per texel; one thread.
fn map_texel(case: &Case, vertices: &Transformed, format: TexelFormat) -> (f64, f64, MapRaster) {
    let device = case.device.device();
    let mut own = case.clone();
    own.map = case.map.with(case.map.size, format);
    let draw = || draw_map(&own, &device, vertices, map_depth_buffer(&own));
    let drawn = draw();
    let store = || ShadowMap::store(&device, &own.map, &drawn.layout, drawn.drawn());
    let texels = drawn.layout.texels() as f64;
    let (draw_ns, store_ns) = (seconds(draw) * 1e9 / texels, seconds(store) * 1e9 / texels);
    (draw_ns, store_ns, drawn)
}

/// One look-up at random places of the map; one thread.
fn lookup(case: &Case, map: &ShadowMap, filter: Filter) -> f64 {
    let device = case.device.device();
    let mut spec = case.lookup;
    spec.filter = filter;
    let maps = map.layout().rects().len();
    // A multiplicative sequence: places without any order, the same in every run.
    let place = |i: u32| f32::from(i.wrapping_mul(40_503) as u16) / 65_536.0;
    let coord = |i: u32| [place(i), place(i.wrapping_add(7919)), 0.5];
    let (mut done, started) = (0u32, Instant::now());
    while started.elapsed().as_secs_f64() < SECONDS {
        for i in done..done + 1024 {
            let lookups = [Lookup { map: i as usize % maps, coord: coord(i), weight: 1.0 }];
            let taps = map.taps(&device, &spec, &lookups);
            black_box(visibility(&spec, &lookups, &taps, case.bias));
        }
        done += 1024;
    }
    started.elapsed().as_secs_f64() * 1e9 / f64::from(done)
}

/// Times of maps and look-ups of a case, and of the toolkit's own ways, beside their counted costs.
#[must_use]
pub fn times(case: &Case, filters: &[Filter], ways: &[Way]) -> Value {
    let device = case.device.device();
    let vertices = Transformed::new(case, case.chain, &device);
    let (mut maps, mut lookups) = (Vec::new(), Vec::new());
    for format in FORMATS {
        let (draw_ns, store_ns, drawn) = map_texel(case, &vertices, format);
        maps.push(json!({ "format": format.name(), "size": case.map.size,
            "draw_ns_per_texel": draw_ns, "store_ns_per_texel": store_ns }));
        let spec = case.map.with(case.map.size, format);
        let map = ShadowMap::store(&device, &spec, &drawn.layout, drawn.drawn());
        for &filter in filters {
            let cost = Cost::of(format, case.map.size, filter, Strategy::Constant);
            lookups.push(json!({ "format": format.name(), "filter": filter.name(),
                "fetches": cost.fetches, "operations": cost.operations,
                "ns_per_lookup": lookup(case, &map, filter) }));
        }
    }
    let way = |w: &Way| json!({ "job": w.job, "way": w.way, "seconds": w.seconds });
    json!({ "case": case.name, "maps": maps, "lookups": lookups,
        "ways": ways.iter().map(way).collect::<Vec<_>>() })
}

/// The times as lines of text.
#[must_use]
pub fn text(times: &Value) -> String {
    let list = |name: &str| times[name].as_array().cloned().unwrap_or_default();
    let word = |v: &Value, name: &str| v[name].as_str().unwrap_or("").to_string();
    let number = |v: &Value, name: &str| v[name].as_f64().unwrap_or(f64::NAN);
    let mut lines = vec![format!("times on this machine, case {}", word(times, "case"))];
    lines.extend(list("maps").iter().map(|m| {
        let (draw, store) = (number(m, "draw_ns_per_texel"), number(m, "store_ns_per_texel"));
        format!(
            "  map {:<12} draw {draw:8.2} ns/texel, store {store:8.2} ns/texel",
            word(m, "format")
        )
    }));
    lines.extend(list("lookups").iter().map(|l| {
        let (ns, operations) = (number(l, "ns_per_lookup"), number(l, "operations"));
        let (format, filter) = (word(l, "format"), word(l, "filter"));
        format!("  look-up {format:<12} {filter:<16} {ns:9.1} ns, {operations} operations counted")
    }));
    lines.extend(list("ways").iter().map(|w| {
        format!("  {:9.4} s  {}: {}", number(w, "seconds"), word(w, "job"), word(w, "way"))
    }));
    lines.join("\n") + "\n"
}
