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
use serde::Serialize;
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
            let taps = map.taps(&device, &spec, &lookups, [i, i / 7]);
            black_box(visibility(&spec, &lookups, &taps, case.bias));
        }
        done += 1024;
    }
    started.elapsed().as_secs_f64() * 1e9 / f64::from(done)
}

/// Drawing and storing a map of one format, nanoseconds a texel.
#[derive(Clone, Copy, Debug, Serialize)]
#[non_exhaustive]
pub struct MapTime {
    /// The format's name.
    pub format: &'static str,
    /// Texels per side.
    pub size: u32,
    /// Drawing the casters.
    pub draw_ns_per_texel: f64,
    /// Encoding what was drawn.
    pub store_ns_per_texel: f64,
}

/// One look-up beside its counted cost.
#[derive(Clone, Copy, Debug, Serialize)]
#[non_exhaustive]
pub struct LookupTime {
    /// The format's name.
    pub format: &'static str,
    /// The filter.
    pub filter: Filter,
    /// Texels fetched, counted.
    pub fetches: u32,
    /// Arithmetic operations, counted.
    pub operations: u32,
    /// Nanoseconds.
    pub ns_per_lookup: f64,
}

/// One of the toolkit's own ways.
#[derive(Clone, Copy, Debug, Serialize)]
#[non_exhaustive]
pub struct WayTime {
    /// What is computed.
    pub job: &'static str,
    /// How.
    pub way: &'static str,
    /// Wall seconds.
    pub seconds: f64,
}

/// What was timed on one case, on this machine.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct Times {
    /// The case's name.
    pub case: String,
    /// A map of each format.
    pub maps: Vec<MapTime>,
    /// A look-up of each format and filter.
    pub lookups: Vec<LookupTime>,
    /// The toolkit's own ways.
    pub ways: Vec<WayTime>,
}

/// Times of maps and look-ups of a case, and of the toolkit's own ways, beside their counted costs.
#[must_use]
pub fn times(case: &Case, filters: &[Filter], ways: &[Way]) -> Times {
    let device = case.device.device();
    let vertices = Transformed::new(case, case.chain, &device);
    let (mut maps, mut lookups) = (Vec::new(), Vec::new());
    for texel in FORMATS {
        let (format, size) = (texel.name(), case.map.size);
        let (draw_ns_per_texel, store_ns_per_texel, drawn) = map_texel(case, &vertices, texel);
        maps.push(MapTime { format, size, draw_ns_per_texel, store_ns_per_texel });
        let spec = case.map.with(size, texel);
        let map = ShadowMap::store(&device, &spec, &drawn.layout, drawn.drawn());
        for &filter in filters {
            let Cost { fetches, operations, .. } =
                Cost::of(texel, size, filter, Strategy::Constant);
            let ns_per_lookup = lookup(case, &map, filter);
            lookups.push(LookupTime { format, filter, fetches, operations, ns_per_lookup });
        }
    }
    let way = |w: &Way| WayTime { job: w.job, way: w.way, seconds: w.seconds };
    Times { case: case.name.clone(), maps, lookups, ways: ways.iter().map(way).collect() }
}

/// The times as lines of text.
#[must_use]
pub fn text(times: &Times) -> String {
    let mut lines = vec![format!("times on this machine, case {}", times.case)];
    lines.extend(times.maps.iter().map(|m| {
        let MapTime { format, draw_ns_per_texel: draw, store_ns_per_texel: store, .. } = m;
        format!("  map {format:<12} draw {draw:8.2} ns/texel, store {store:8.2} ns/texel")
    }));
    lines.extend(times.lookups.iter().map(|l| {
        let LookupTime { format, filter, operations, ns_per_lookup: ns, .. } = l;
        let filter = filter.name();
        format!("  look-up {format:<12} {filter:<16} {ns:9.1} ns, {operations} operations counted")
    }));
    lines.extend(times.ways.iter().map(|w| format!("  {:9.4} s  {}: {}", w.seconds, w.job, w.way)));
    lines.join("\n") + "\n"
}
