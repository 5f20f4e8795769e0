//! Clocks and medians that the benches share.
#![allow(dead_code, unreachable_pub, reason = "every bench uses a part of it")]

use std::hint::black_box;
use std::time::Instant;

/// Times of several ways to do one job, in the order in which they first came.
#[derive(Default)]
pub struct Ways(Vec<(String, Vec<f64>)>);

impl Ways {
    /// Adds one time in milliseconds.
    pub fn add(&mut self, name: &str, ms: f64) {
        match self.0.iter_mut().find(|(way, _)| way == name) {
            Some((_, times)) => times.push(ms),
            None => self.0.push((name.to_owned(), vec![ms])),
        }
    }

    /// Prints medians, best times and rates.
    pub fn report(&mut self, count: usize, what: &str) {
        for (name, times) in &mut self.0 {
            times.sort_by(f64::total_cmp);
            let (best, median) = (times[0], times[times.len() / 2]);
            let rate = count as f64 / median / 1e3;
            println!("    {name:32} {median:8.1} ms (best {best:.1}), {rate:.2} M {what} a second");
        }
    }
}

pub fn threads(n: usize) -> rayon::ThreadPool {
    rayon::ThreadPoolBuilder::new().num_threads(n).build().expect("threads")
}

pub fn wall_ms<R>(job: impl FnOnce() -> R) -> f64 {
    let start = Instant::now();
    black_box(job());
    start.elapsed().as_secs_f64() * 1e3
}

/// Milliseconds of processor time that this thread has had.
fn clock() -> f64 {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    text.split(' ').next().and_then(|ns| ns.parse::<f64>().ok()).unwrap_or(f64::NAN) / 1e6
}

/// Milliseconds of processor time of this thread.
pub fn cpu_ms<R>(job: impl FnOnce() -> R) -> f64 {
    let start = clock();
    black_box(job());
    clock() - start
}

/// The largest processor time of a pool's threads, in milliseconds: what the job takes on cores
/// that do nothing else, as long as its serial parts stay on one thread.
pub fn busiest_ms(pool: &rayon::ThreadPool, job: impl FnOnce() + Send) -> f64 {
    let before = pool.broadcast(|_| clock());
    pool.install(job);
    let after = pool.broadcast(|_| clock());
    before.iter().zip(&after).map(|(before, after)| after - before).fold(0.0, f64::max)
}

/// Wall milliseconds of a job, and the processor time of all threads of its pool.
pub fn both_ms(pool: &rayon::ThreadPool, job: impl FnOnce() + Send) -> [f64; 2] {
    let before = pool.broadcast(|_| clock());
    let wall = wall_ms(|| pool.install(job));
    let after = pool.broadcast(|_| clock());
    [wall, before.iter().zip(&after).map(|(before, after)| after - before).sum()]
}

/// Writes the rows of a curve where `GNOMON_CSV` says.
pub fn csv(rows: &[String]) {
    if let Ok(path) = std::env::var("GNOMON_CSV") {
        std::fs::write(path, rows.join("\n") + "\n").expect("the file is writable");
    }
}
