//! How long does a whole case take: 100 000 triangles, 1080p receivers, a 2048² map, all curves?
//!
//! `cargo bench --bench case [-- NAME WIDTH HEIGHT MAP]`. Wall seconds on two threads, the processor
//! time of both beside them; the least and the median of several rounds.

#[path = "timing.rs"]
mod timing;

use gnomon::analysis::curve::Curve;
use gnomon::analysis::measure::measure;
use gnomon::analysis::observe::Observer;
use gnomon::analysis::sweep::Field;
use gnomon::analysis::sweep::pictures::Gallery;
use gnomon::scene::{Case, cases};
use gnomon::shadow::bias::Strategy;
use timing::{Ways, both_ms, cpu_ms, threads, wall_ms};

const ROUNDS: usize = 5;

fn main() {
    let args: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    let number = |k: usize, default: u32| {
        args.get(k).map_or(default, |text| text.parse().expect("a whole number"))
    };
    let mut case =
        cases::named(args.first().map_or("terrain-100000", String::as_str)).expect("a case's name");
    (case.canvas, case.map.size) = ([number(1, 1920), number(2, 1080)], number(3, 2048));
    let pool = threads(2);
    pool.install(|| describe(&case));
    let mut ways = Ways::default();
    for _ in 0..ROUNDS {
        let [wall, busy] = both_ms(&pool, || drop(measure(&case, 1)));
        ways.add("whole case, wall", wall);
        ways.add("whole case, processor", busy);
        pool.install(|| steps(&case, &mut ways));
    }
    ways.report(1, "cases");
    pool.install(|| pictures(&case));
}

/// One core: every receiver classified under one bias, and the map of the classes.
fn pictures(case: &Case) {
    let field = Field::new(case, 1);
    let gallery = Gallery::new(&field, case.map.texel, 1);
    let (one, mut ways) = (threads(1), Ways::default());
    for _ in 0..ROUNDS {
        let picture = || gallery.picture("", Strategy::Constant, case.bias, String::new());
        ways.add("classes and their map, one core", one.install(|| cpu_ms(picture)));
    }
    ways.report(field.samples.len(), "receivers");
}

fn describe(case: &Case) {
    let measured = measure(case, 1);
    println!(
        "{}: {} triangles, {} receivers, a map of {}²",
        case.name,
        measured.observer.geometry.triangles.len(),
        measured.observations.len(),
        case.map.size
    );
    for count in &measured.work {
        println!("  {}: {} of {} worked out", count.what, count.evaluated, count.answered);
    }
}

/// The parts that can be told apart from outside.
fn steps(case: &Case, ways: &mut Ways) {
    let mut observer = None;
    let device = case.device.device();
    ways.add(
        "  drawing, tree, adjacency",
        wall_ms(|| observer = Some(Observer::new(case, &device))),
    );
    let observer = observer.expect("just made");
    let mut observations = Vec::new();
    ways.add("  truth and classes", wall_ms(|| observations = observer.observe_canvas(1)));
    ways.add("  curves", wall_ms(|| Curve::new(&observations)));
}
