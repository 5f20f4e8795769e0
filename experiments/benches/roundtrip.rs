//! How fast are depths certified? `cargo bench --bench roundtrip [-- whole]`
//!
//! Every figure is the least processor time of several rounds on one thread, beside its goal.
//! `whole` times every packing × 3 stores, exhaustive, on all threads instead.
//!
//! The arithmetic limit of the loop: a vector of the book's round trip takes 51 operations of the two
//! vector ports, counted in the compiled AVX-512 loop: 1 to make the depths, 4 floors of two, 3
//! products and 4 differences for the digits, 3 fma for the masks, 4 × (product, maximum, minimum,
//! rounding of two) for the bytes, 8 for the samples (k/255 as product and fma), 3 fma for the dot
//! product and 1 for the counter. The rate of such operations
//! is measured in the same run, by multiplications that depend on nothing but themselves, so a machine
//! that is busy or slow lowers the limit as it lowers the loop.

use gnomon::analysis::roundtrip::survey::{FLOATS, survey_format};
use gnomon::analysis::roundtrip::{Certifier, Conditions, Method, survey};
use gnomon::depth::roundtrip::{AnyRoundTrip, Path};
use gnomon::depth::{
    Arithmetic, ByteStore, DepthFormat, FormatTrip, Packing, RoundTrip, UnormLoad, UnormStore,
};
use gnomon::simd::{Kernel, Level};
use rayon::prelude::*;
use std::hint::black_box;
use std::time::Instant;

/// Seconds of processor time that this thread has had: steady beside other jobs.
fn processor_seconds() -> f64 {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    text.split(' ').next().and_then(|ns| ns.parse::<f64>().ok()).unwrap_or(f64::NAN) / 1e9
}

/// Seconds of processor time of all threads of this process, to a hundredth.
fn process_seconds() -> f64 {
    let text = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let after_name = text.rsplit(") ").next().unwrap_or_default();
    let ticks = |i: usize| after_name.split(' ').nth(i).and_then(|t| t.parse::<f64>().ok());
    (ticks(11).unwrap_or(f64::NAN) + ticks(12).unwrap_or(f64::NAN)) / 100.0
}

fn least_seconds(rounds: usize, mut work: impl FnMut()) -> f64 {
    let time = |_| {
        let (start, wall) = (processor_seconds(), Instant::now());
        work();
        let seconds = processor_seconds() - start;
        if seconds.is_nan() { wall.elapsed().as_secs_f64() } else { seconds }
    };
    (0..rounds).map(time).fold(f64::INFINITY, f64::min)
}

fn trip(packing: Packing, load: UnormLoad) -> Box<dyn RoundTrip<f32>> {
    let rounding = ByteStore::HalfEven.roundings()[0];
    match (Path { rounding, load, arithmetic: Arithmetic::F32 }).of_packing(packing) {
        AnyRoundTrip::F32(trip) => trip,
        AnyRoundTrip::F64(_) => unreachable!("f32 arithmetic decodes to f32"),
    }
}

/// Vector operations of the book's loop.
const LOOP_OPERATIONS: f64 = 51.0;
/// Multiplications a depth in [`Products`].
const PRODUCTS: usize = 64;

/// Four independent chains of products for each element: as many as the ports can take.
struct Products<'a>(&'a mut [f32]);

impl Kernel for Products<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self, _: bool) {
        for slot in self.0 {
            let mut chains = [*slot, *slot + 1.0, *slot + 2.0, *slot + 3.0];
            for _ in 0..PRODUCTS / 4 {
                for chain in &mut chains {
                    *chain *= 0.999_999;
                }
            }
            *slot = (chains[0] + chains[1]) + (chains[2] + chains[3]);
        }
    }
}

/// Elements a second that the vector ports could take through the book's loop, by the rate of
/// [`Products`] (with its six sums).
fn limit(level: Level) -> f64 {
    let mut values = vec![1.0f32; 2048];
    let seconds = least_seconds(9, || {
        for _ in 0..4096 {
            level.run(Products(black_box(&mut values)));
        }
    });
    4096.0 * 2048.0 * (PRODUCTS as f64 + 6.0) / LOOP_OPERATIONS / seconds
}

/// Depths per second through pack, store, load and unpack, 2²⁴ of [1/8, 1/2) eight times (2²⁰ of them at the
/// baseline).
fn rate(level: Level, packing: Packing, load: UnormLoad) -> f64 {
    let trip = trip(packing, load);
    let mut out = vec![0.0; 4096];
    let (first, runs) = (0x3e00_0000u32, 1 << 12);
    let all = if level == Level::Baseline { runs / 16 } else { 8 * runs };
    let seconds = least_seconds(9, || {
        for run in 0..all {
            trip.run(level, first + run % runs * 4096, &mut out);
            black_box(&mut out);
        }
    });
    f64::from(all) * 4096.0 / seconds
}

fn one_thread() {
    for &level in Level::ALL.iter().filter(|level| level.is_available()) {
        let goal = match level {
            Level::Baseline => 0.05,
            Level::Avx2 => 0.65,
            Level::Avx512 => 1.2,
        };
        let limit = limit(level) / 1e9;
        for load in [UnormLoad::Reciprocal, UnormLoad::Divide] {
            let rate = rate(level, Packing::Book, load) / 1e9;
            println!(
                "book, {load}, {level}: {rate:.2} Gvalues/s (goal {goal}), {:.0} % of the limit {limit:.2}",
                100.0 * rate / limit
            );
        }
    }
    let pruned = |packing| {
        let trip = trip(packing, UnormLoad::Divide);
        let work = || drop(black_box(survey(&*trip, Level::best(), Method::Pruned)));
        least_seconds(7, work)
    };
    println!("book, every float, pruned: {:.3} s (goal 0.2)", pruned(Packing::Book));
    println!("r8, every float, pruned: {:.4} s", pruned(Packing::R8));
    let book = trip(Packing::Book, UnormLoad::Divide);
    let work = || drop(black_box(survey(&*book, Level::best(), Method::Brute)));
    println!("book, every float, brute: {:.3} s", least_seconds(3, work));
    let unorm16 = FormatTrip {
        format: DepthFormat::Unorm16,
        store: UnormStore::Exact,
        load: UnormLoad::Divide,
    };
    let work = || (0..20).for_each(|_| drop(black_box(survey_format::<f64>(unorm16))));
    let seconds = least_seconds(5, work) / 20.0;
    println!("unorm16, every float, break points: {:.2} ms (goal 5)", seconds * 1e3);
}

fn whole() {
    let effort = Certifier { method: Method::Pruned, level: Level::best() };
    let stores = [ByteStore::HalfEven, ByteStore::Truncate, ByteStore::Admissible];
    let originals = Packing::ALL.iter().filter(|p| p.original() == **p);
    let jobs: Vec<_> = originals.flat_map(|&p| stores.map(|store| (p, store))).collect();
    let (start, cpu) = (Instant::now(), process_seconds());
    let evaluated: u64 = jobs
        .par_iter()
        .map(|&(p, store)| effort.certify_packing(p, Conditions::plain(store)).evaluated)
        .sum();
    let answered = FLOATS as f64 * Packing::ALL.len() as f64 * 3.0;
    println!(
        "{} packings x 3 stores, every float: {:.1} s on {} threads, {:.1} s of processor time, \
         {:.3} of {:.1} G evaluated",
        Packing::ALL.len(),
        start.elapsed().as_secs_f64(),
        rayon::current_num_threads(),
        process_seconds() - cpu,
        evaluated as f64 / 1e9,
        answered / 1e9,
    );
}

fn main() {
    if std::env::args().any(|argument| argument == "whole") {
        return whole();
    }
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build_global();
    pool.expect("the first pool");
    one_thread();
}
