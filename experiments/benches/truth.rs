//! How fast is the truth?
#[path = "../../tests/support/meshes.rs"]
mod meshes;
use glam::DVec3;
use gnomon::truth::*;

/// Seconds of processor time that this thread has had.
fn cpu() -> f64 {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    text.split(' ').next().and_then(|ns| ns.parse::<f64>().ok()).unwrap_or(f64::NAN) / 1e9
}

fn main() {
    let scene = meshes::still_life(4);
    let tracer = Tracer::new(&scene);
    let mut random = meshes::Random(1);
    let receivers: Vec<_> = (0..1000 * 1000)
        .map(|k| {
            if k % 4 != 0 {
                let p = DVec3::new(
                    (k % 1000) as f64 * 0.016 - 8.0,
                    0.0,
                    (k / 1000) as f64 * 0.016 - 8.0,
                );
                Receiver { position: p, triangle: 0 }
            } else {
                let id = random.index(scene.triangles.len()) as u32;
                Receiver { position: meshes::on_triangle(&scene, id, &mut random), triangle: id }
            }
        })
        .collect();
    for light in [
        LightEnd::Point(DVec3::new(3.0, 9.0, 4.0)),
        LightEnd::Along(DVec3::new(0.5, 0.75, 0.25) * tracer.reach()),
    ] {
        let start = cpu();
        let (mut lit, mut ambiguous) = (0, 0);
        for r in &receivers {
            match tracer.truth(r, light.of(r.position)).truth {
                Truth::Lit => lit += 1,
                Truth::Ambiguous => {
                    ambiguous += 1;
                    println!("{r:?} {:?}", scene.corners(r.triangle));
                }
                _ => {}
            }
        }
        let s = (cpu() - start);
        println!(
            "{lit} lit {ambiguous} ambiguous of {}: {:.2} Mray/s",
            receivers.len(),
            receivers.len() as f64 / s / 1e6
        );
    }
}
