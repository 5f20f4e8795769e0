//! How fast is the depth raster, beside Mesa's llvmpipe on the same triangles?
//!
//! `cargo bench --bench raster [-- terrain|sheets|fence|curve]`. Processor time on one thread; of
//! two threads that of the busier one, which is the wall time of a machine that does nothing else.
//! Medians over rounds in which all ways take turns. `GNOMON_DUMP=DIR` writes the
//! triangles and our maps there and runs `llvmpipe.py` on them, between the rounds;
//! `GNOMON_CSV=FILE` keeps the curve.

#[path = "../../tests/support/meshes.rs"]
mod meshes;
#[path = "scenes.rs"]
mod scenes;
#[path = "timing.rs"]
mod timing;

use std::path::{Path, PathBuf};
use std::process::Command;

use glam::Vec4;
use gnomon::depth::{DepthFormat, Packing};
use gnomon::device::DeviceProfile;
use gnomon::light::Layout;
use gnomon::raster::{Pass, PolygonOffset, Raster, draw_at, draw_each, draw_into, quickest};
use gnomon::scene::{Cull, CullRule, DepthBuffer, Geometry, MapSpec, TexelFormat};
use gnomon::shadow::ShadowMap;
use gnomon::simd::Level;
use timing::{Ways, busiest_ms, cpu_ms, threads};

const ROUNDS: usize = 5;

fn main() {
    let wanted: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    let is_wanted = |name: &str| wanted.is_empty() || wanted.iter().any(|w| w == name);
    for (name, scene) in [
        ("terrain", scenes::terrain(640)),
        ("sheets", scenes::sheets()),
        ("fence", scenes::fence()),
    ] {
        if !is_wanted(name) {
            continue;
        }
        println!("{name}: {} triangles, {} vertices", scene.triangles.len(), scene.positions.len());
        for (light, clip) in lights(&scene) {
            for size in [2048, 4096] {
                one_map(name, light, size, &clip, &scene.triangles);
            }
        }
    }
    if is_wanted("curve") {
        curve();
    }
}

fn lights(scene: &Geometry) -> [(&'static str, Vec<Vec4>); 2] {
    [
        ("point", scenes::clip_space(scene, scenes::SUN, true)),
        ("directional", scenes::clip_space(scene, scenes::SUN, false)),
    ]
}

fn pass(size: u32, depth_buffer: DepthFormat) -> Pass {
    let offset = PolygonOffset::default();
    Pass { size: [size; 2], cull: Cull::None, depth_buffer, offset, clip: Default::default() }
}

fn one_map(name: &str, light: &str, size: u32, clip: &[Vec4], triangles: &[[u32; 3]]) {
    let device = DeviceProfile::Ideal.device();
    let (one, two) = (threads(1), threads(2));
    let best = |format| draw_at(quickest(), &device, &pass(size, format), clip, triangles);
    // As in GL, a pass draws into memory that is there.
    let target = std::sync::Mutex::new(best(DepthFormat::F32));
    let draw = |level, format| {
        let mut target = target.lock().expect("one at a time");
        draw_into(&mut target, level, &device, &pass(size, format), clip, triangles);
    };
    let each = || draw_each(&device, &pass(size, DepthFormat::F32), clip, triangles);
    let (expected, found) = (each(), best(DepthFormat::F32));
    println!(
        "  {light}, {size} x {size}: {} texels covered, {} triangles over no centre; {} texels \
         differ from the arbiter",
        found.triangle.iter().filter(|&&t| t != u32::MAX).count(),
        found.empty_triangles,
        differing(&expected, &found),
    );
    let dump = Dump::new(name, light, size, clip, triangles, &found);
    let mut ways = Ways::default();
    for round in 0..ROUNDS {
        one.install(|| {
            ways.add("one thread", cpu_ms(|| draw(quickest(), DepthFormat::F32)));
            ways.add("one thread, avx512", cpu_ms(|| draw(Level::best(), DepthFormat::F32)));
            ways.add("one thread, baseline", cpu_ms(|| draw(Level::Baseline, DepthFormat::F32)));
            ways.add(
                "one thread, unorm16 tested",
                cpu_ms(|| draw(quickest(), DepthFormat::Unorm16)),
            );
            if round < 2 {
                ways.add("arbiter, one thread", cpu_ms(each));
            }
            ways.add("one thread, fresh memory", cpu_ms(|| best(DepthFormat::F32)));
        });
        let busiest = busiest_ms(&two, || drop(best(DepthFormat::F32)));
        ways.add("two threads, fresh, busiest", busiest);
        if let Some(dump) = &dump {
            dump.llvmpipe(&mut ways);
        }
    }
    ways.report(triangles.len(), "triangles");
    six_formats(size, clip, triangles);
}

/// What maps are kept as.
const SIX: [TexelFormat; 6] = [
    TexelFormat::Depth(DepthFormat::F32),
    TexelFormat::Depth(DepthFormat::Unorm16),
    TexelFormat::Depth(DepthFormat::Unorm24),
    TexelFormat::Depth(DepthFormat::F16),
    TexelFormat::Packed(Packing::Book),
    TexelFormat::Packed(Packing::ThreeRgba),
];

/// One raster and six maps of it beside one raster and one map, into memory that is there.
fn six_formats(size: u32, clip: &[Vec4], triangles: &[[u32; 3]]) {
    let device = DeviceProfile::Ideal.device();
    let pass = pass(size, DepthFormat::F32);
    let mut drawn = draw_at(quickest(), &device, &pass, clip, triangles);
    let clear = [1.0; 4];
    let (depth_buffer, cull) = (DepthBuffer::Texture, CullRule::None);
    let specs = SIX.map(|texel| MapSpec { size, texel, clear, depth_buffer, cull });
    let mut maps = SIX.map(ShadowMap::empty);
    let layout = Layout::whole([size; 2]);
    ShadowMap::store_each(&mut maps, &device, &specs, &layout, drawn.drawn());
    let mut job = |count: usize| {
        draw_into(&mut drawn, quickest(), &device, &pass, clip, triangles);
        ShadowMap::store_each(&mut maps[..count], &device, &specs[..count], &layout, drawn.drawn());
    };
    let one = threads(1);
    let mut ways = Ways::default();
    let mut ratios = Vec::new();
    for _ in 0..ROUNDS {
        let [a, b] = [1, SIX.len()].map(|count| one.install(|| cpu_ms(|| job(count))));
        ways.add("drawn, kept in one format", a);
        ways.add("drawn, kept in six", b);
        ratios.push(b / a);
    }
    ratios.sort_by(f64::total_cmp);
    ways.report(triangles.len(), "triangles");
    println!("    six formats: {:.3} times one", ratios[ROUNDS / 2]);
}

fn differing(a: &Raster, b: &Raster) -> usize {
    let depths = a.depth.iter().zip(&b.depth).map(|(a, b)| a.to_bits() != b.to_bits());
    let ids = a.triangle.iter().zip(&b.triangle).map(|(a, b)| a != b);
    depths.zip(ids).filter(|&(depth, id)| depth || id).count()
        + usize::from(a.empty_triangles != b.empty_triangles)
}

/// What `llvmpipe.py` reads: a scene in clip space and our map of it.
struct Dump {
    stem: PathBuf,
    size: u32,
}

impl Dump {
    fn new(
        name: &str,
        light: &str,
        size: u32,
        clip: &[Vec4],
        triangles: &[[u32; 3]],
        ours: &Raster,
    ) -> Option<Self> {
        let folder = std::env::var("GNOMON_DUMP").ok()?;
        let stem = Path::new(&folder).join(format!("{name}-{light}-{size}"));
        let write = |end: &str, bytes: Vec<u8>| {
            std::fs::write(stem.with_extension(end), bytes).expect("the dump folder is writable");
        };
        write("clip", clip.iter().flat_map(|v| v.to_array()).flat_map(f32::to_le_bytes).collect());
        write("triangles", triangles.iter().flatten().flat_map(|v| v.to_le_bytes()).collect());
        write("depth", ours.depth.iter().flat_map(|z| z.to_le_bytes()).collect());
        Some(Self { stem, size })
    }

    /// Lets llvmpipe draw; it prints one `name milliseconds` a line, and what differs.
    fn llvmpipe(&self, ways: &mut Ways) {
        let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("experiments/benches/llvmpipe.py");
        let mut command = Command::new("python3");
        command.arg(script).arg(&self.stem).arg(self.size.to_string());
        let out = command.output().expect("python3 runs");
        let text = String::from_utf8_lossy(&out.stdout);
        for line in text.lines() {
            match line.rsplit_once(' ').map(|(way, ms)| (way, ms.parse())) {
                Some((way, Ok(ms))) => ways.add(way, ms),
                _ => println!("    {line}"),
            }
        }
        if !out.status.success() {
            println!("    llvmpipe.py failed: {}", String::from_utf8_lossy(&out.stderr));
        }
    }
}

/// From 10⁴ to 10⁷ triangles, with four texels a triangle and with as many as fit 2048².
fn curve() {
    let device = DeviceProfile::Ideal.device();
    let one = threads(1);
    let mut rows = vec!["triangles,texels,ms,ns_per_triangle,ns_per_texel".to_owned()];
    println!("curve, one thread: triangles, map, ms, ns a triangle, ns a texel");
    for side in [71, 224, 707, 2236] {
        let scene = scenes::grid(side);
        let clip = scenes::clip_space(&scene, scenes::SUN, false);
        for size in [2 * side * 1414 / 1000, 2048] {
            let pass = pass(size, DepthFormat::F32);
            let draw = || draw_at(quickest(), &device, &pass, &clip, &scene.triangles);
            let mut times: Vec<f64> = (0..ROUNDS).map(|_| one.install(|| cpu_ms(draw))).collect();
            times.sort_by(f64::total_cmp);
            let (ms, n) = (times[ROUNDS / 2], scene.triangles.len());
            let texels = size as usize * size as usize;
            let (each, texel) = (ms * 1e6 / n as f64, ms * 1e6 / texels as f64);
            println!("  {n:9} {size:5}² {ms:8.2} {each:7.1} {texel:7.2}");
            rows.push(format!("{n},{texels},{ms:.3},{each:.2},{texel:.3}"));
        }
    }
    timing::csv(&rows);
}
