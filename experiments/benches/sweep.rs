//! What breakpoints save: 10,000 biases against one, and against the literal rule, side by side.
//!
//! Run with `cargo bench --bench sweep [-- canvas]`. Every pair is timed in turn on one thread, in processor
//! time, and the least of five counts. The counts of all ways are compared as well.

#[path = "timing.rs"]
mod timing;

use gnomon::analysis::sweep::chart::{Attachment, Chart};
use gnomon::analysis::sweep::evaluate::sweep_formats;
use gnomon::analysis::sweep::looks::{self, Looks};
use gnomon::analysis::sweep::taps::Taps;
use gnomon::analysis::sweep::{Field, Question, Range, sweep};
use gnomon::depth::{DepthFormat, Packing};
use gnomon::scene::{Case, TexelFormat, cases};
use gnomon::shadow::bias::Strategy;
use std::hint::black_box;
use std::time::Instant;
use timing::{Ways, threads, wall_ms};

/// Seconds of processor time that this thread has had: steady beside other jobs.
fn processor_seconds() -> f64 {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    text.split(' ').next().and_then(|ns| ns.parse::<f64>().ok()).unwrap_or(f64::NAN) / 1e9
}

/// The least of five timings of each of two jobs, run in turn. Seconds.
fn pair(mut first: impl FnMut(), mut second: impl FnMut()) -> [f64; 2] {
    let mut least = [f64::INFINITY; 2];
    for _ in 0..5 {
        for (i, job) in [&mut first as &mut dyn FnMut(), &mut second].into_iter().enumerate() {
            let (start, wall) = (processor_seconds(), Instant::now());
            job();
            let seconds = processor_seconds() - start;
            let seconds = if seconds.is_nan() { wall.elapsed().as_secs_f64() } else { seconds };
            least[i] = least[i].min(seconds);
        }
    }
    least
}

/// The whole sweep of the constant strategy: map, look-ups, counts, thresholds.
fn whole(field: &Field<'_>, amounts: &[f32]) {
    let case = field.case();
    let filter = case.map.texel.usable(case.lookup.filter);
    let chart = Chart::new(field, case.map.size, filter, Attachment::of(case.map.texel));
    let question = Question { amounts, max_acne: 0.0 };
    let swept = sweep(&chart, case.map.texel, Strategy::Constant, &question);
    assert_eq!(black_box(swept.points.len()), amounts.len());
}

/// False shadows at one bias over flat arrays: what a vectorising compiler makes of the literal rule.
fn flat(case: &Case, z: &[f32], stored: &[f32], bias: f32) -> usize {
    let rule = case.lookup.compare;
    z.iter().zip(stored).map(|(&z, &d)| usize::from(!rule.is_lit(z, d, bias))).sum()
}

/// The first tap of each truly lit receiver.
fn arrays(looks: &[Looks]) -> (Vec<f32>, Vec<f32>) {
    let lit = looks.iter().filter(|l| l.lit && !l.taps.is_empty());
    lit.map(|l| (l.taps[0].z, l.taps[0].stored)).unzip()
}

/// Every receiver of a 1080p canvas under 256 constant biases in eight formats, on one and on two threads.
fn canvas() {
    let mut case = cases::named("terrain-100000").expect("a case");
    (case.canvas, case.map.size) = ([1920, 1080], 2048);
    let field = Field::new(&case, 1);
    let amounts = "1e-6:1e-1:log:256".parse::<Range>().expect("a range").values();
    let question = Question { amounts: &amounts, max_acne: 0.0 };
    let depths = DepthFormat::ALL.iter().take(4).map(|&f| TexelFormat::Depth(f)).collect();
    let packed = Packing::ALL.iter().take(4).map(|&p| TexelFormat::Packed(p)).collect();
    let formats: [Vec<TexelFormat>; 2] = [depths, packed];
    let mut ways = Ways::default();
    for pool in (0..5).flat_map(|_| [1, 2].map(threads)) {
        let n = pool.current_num_threads();
        let mut charts = Vec::new();
        let draw = || {
            let of = |f: &Vec<_>| {
                Chart::new(&field, case.map.size, case.lookup.filter, Attachment::of(f[0]))
            };
            charts = formats.iter().map(of).collect();
        };
        ways.add(&format!("two charts, {n} threads"), wall_ms(|| pool.install(draw)));
        let sweep = || {
            for (chart, formats) in charts.iter().zip(&formats) {
                black_box(sweep_formats(chart, formats, Strategy::Constant, &question));
            }
        };
        ways.add(&format!("8 formats x 256 biases, {n} threads"), wall_ms(|| pool.install(sweep)));
    }
    println!("{}: {} receivers at 1080p", case.name, field.samples.len());
    ways.report(field.samples.len(), "receivers");
}

fn main() {
    canvas();
    if std::env::args().any(|arg| arg == "canvas") {
        return;
    }
    let amounts = "1e-7:1e-1:log:10000".parse::<Range>().expect("a range").values();
    for name in ["book-rgba8-y7", "fundamentals-spot", "fundamentals-directional", "exam-pcf"] {
        let case = cases::named(name).expect("a case");
        let field = Field::new(&case, 1);
        let [one, many] = pair(|| whole(&field, &amounts[5000..5001]), || whole(&field, &amounts));
        println!(
            "{name}: {} receivers; one bias {:.1} ms, 10,000 biases {:.1} ms: {:.2} times",
            field.samples.len(),
            1e3 * one,
            1e3 * many,
            many / one
        );
        let filter = case.map.texel.usable(case.lookup.filter);
        let chart = Chart::new(&field, case.map.size, filter, Attachment::of(case.map.texel));
        let looks = chart.looks(case.map.texel, &Strategy::Constant.with(0.0));
        let taps = Taps::on(&chart, case.map.texel, Strategy::Constant);
        let rule = case.lookup.compare;
        let few: Vec<f32> = amounts.iter().copied().step_by(500).collect();
        let [fast, slow] = pair(
            || drop(black_box(taps.curve(&looks, rule).at(&amounts))),
            || {
                few.iter().for_each(|&a| {
                    black_box(looks::literal(&looks, rule, |_| a));
                });
            },
        );
        let literal = slow / few.len() as f64 * amounts.len() as f64;
        let same = taps.curve(&looks, rule).at(&few);
        let equal = few.iter().zip(&same).all(|(&a, t)| looks::literal(&looks, rule, |_| a) == *t);
        println!(
            "  counts by artifact: breakpoints {:.1} ms, literally {literal:.2} s: {:.0} times, counts {}",
            1e3 * fast,
            literal / fast,
            if equal { "equal" } else { "DIFFER" }
        );
        let (z, stored) = arrays(&looks);
        let [_, vector] = pair(
            || (),
            || {
                amounts.iter().for_each(|&a| {
                    black_box(flat(&case, &z, &stored, black_box(a)));
                });
            },
        );
        println!(
            "  bare false shadows of {} taps in flat arrays, literally {vector:.3} s: {:.0} times",
            z.len(),
            vector / fast
        );
    }
}
