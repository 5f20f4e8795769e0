//! The certificate of one combination: what a round trip loses, where, and what it forces.

use super::proof::Bound;
use super::sample::sampled_depths;
use super::survey::{CUTS, FLOATS, Method};
use super::tally::{ErrorTally, Extreme, spacing};
use crate::depth::RoundTrip;
use crate::depth::arith::Raw;
use serde::Serialize;

/// A signed error and the depth that has it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Peak {
    /// Size of the error, window depth.
    pub error: f64,
    /// The first depth that has it.
    pub at: f32,
}

/// Error over one range of depths.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RangeError {
    /// First depth.
    pub from: f64,
    /// One past the last depth (1 alone: the range of z = 1).
    pub to: f64,
    /// Largest |decoded − z|.
    pub max: Peak,
    /// Mean of decoded − z, each float weighed with its spacing (uniform depth).
    pub mean: f64,
    /// Root of the mean square.
    pub rms: f64,
}

/// Whether the round trip keeps the order of depths.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Order {
    /// Neighbouring floats whose decoded values go down.
    pub inversions: u64,
    /// The largest such step.
    pub largest_drop: Peak,
}

/// What one unusual depth gives.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Special {
    /// The depth, in words.
    pub depth: &'static str,
    /// The stored bytes.
    pub texel: Vec<u8>,
    /// The decoded value (as text where it is not a number).
    pub decoded: String,
}

/// How many of the looked-at depths keep a promise.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Promise {
    /// Depths looked at.
    pub tested: u64,
    /// Depths that break it.
    pub broken: u64,
}

impl Promise {
    fn note(&mut self, kept: bool) {
        self.tested += 1;
        self.broken += u64::from(!kept);
    }
}

/// Everything about one combination of packing or format, store, sampler and arithmetic.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct Certificate {
    /// The packing or format.
    pub name: String,
    /// Channels (bytes a texel) of a packing.
    pub channels: Option<usize>,
    /// The store's name.
    pub store: String,
    /// The sampler's name.
    pub load: String,
    /// The arithmetic's name.
    pub arithmetic: String,
    /// How the floats were answered for.
    pub method: Method,
    /// Floats answered for.
    pub answered: u64,
    /// Floats evaluated to do so.
    pub evaluated: u64,
    /// Largest |decoded − z| for z < 1.
    pub max: Peak,
    /// Largest decoded − z for z < 1.
    pub above: Peak,
    /// Largest z − decoded for z < 1.
    pub below: Peak,
    /// Mean of decoded − z over uniform depths below 1.
    pub mean: f64,
    /// Root mean square of decoded − z over uniform depths below 1.
    pub rms: f64,
    /// −log₂ of the largest error: a format of so many bits is as good.
    pub equivalent_bits: f64,
    /// Decoded value of z = 1.
    pub at_one: f64,
    /// The least power of two (or table edge) from which no depth below 1 is changed.
    pub exact_from: Option<f32>,
    /// Error by depth range.
    pub ranges: Vec<RangeError>,
    /// Order of decoded depths, z = 1 included; `None` where the store is a set.
    pub order: Option<Order>,
    /// 0, 1, NaN, ±∞, −0, denormals, and values outside [0, 1].
    pub specials: Vec<Special>,
    /// unpack(pack(unpack(pack z))) = unpack(pack z).
    pub idempotent: Promise,
    /// The texel of a decoded depth is the texel it came from.
    pub invertible: Promise,
    /// No operation overflows or is undefined.
    pub sound: Promise,
    /// The smallest constant bias b for which no depth below 1 shadows itself by the literal f32 rule
    /// z > D + b, on a surface that faces the light.
    pub forced_bias: f32,
    /// What can be proved beside what was measured.
    pub bound: Option<Bound>,
}

/// What a certificate is about, beside the numbers.
#[derive(Clone, Debug)]
pub struct Subject {
    /// The packing or format.
    pub name: String,
    /// Channels of a packing.
    pub channels: Option<usize>,
    /// The store's name.
    pub store: String,
    /// The sampler's name.
    pub load: String,
    /// The arithmetic's name.
    pub arithmetic: String,
    /// The proved bound.
    pub bound: Option<Bound>,
}

/// The certificate from the tallies of every segment under each admissible rounding. The worst over
/// the roundings stands for the set; the order of a set of stores is not judged.
#[must_use]
pub fn certify<F: Raw>(
    subject: Subject,
    method: Method,
    trips: &[&dyn RoundTrip<F>],
    tallies: &[Vec<ErrorTally<F>>],
) -> Certificate {
    let wide: Vec<Vec<ErrorTally<f64>>> =
        tallies.iter().map(|t| t.iter().map(|t| t.widened()).collect()).collect();
    let segments = worst_of(&wide);
    let (one, below_one) = segments.split_last().expect("segments end with 1.0");
    let whole = range(0.0, 1.0, below_one);
    let (above, below) = (peak(below_one, |t| t.above), peak(below_one, |t| t.below));
    let promises = promises(trips);
    Certificate {
        name: subject.name,
        channels: subject.channels,
        store: subject.store,
        load: subject.load,
        arithmetic: subject.arithmetic,
        method,
        answered: if method == Method::Sampled { counted(&wide) } else { FLOATS },
        evaluated: wide.iter().flatten().map(|t| t.evaluated).sum(),
        max: whole.max,
        above,
        below,
        mean: whole.mean,
        rms: whole.rms,
        equivalent_bits: equivalent_bits(whole.max.error),
        at_one: one.last,
        exact_from: exact_from(below_one),
        ranges: ranges(&segments),
        order: (trips.len() == 1).then(|| order(&segments)),
        specials: specials(trips[0]),
        idempotent: promises.idempotent,
        invertible: promises.invertible,
        sound: promises.sound,
        forced_bias: forced_bias(trips, below),
        bound: subject.bound,
    }
}

/// Start of the longest run of segments before 1 without an error.
fn exact_from(below_one: &[ErrorTally<f64>]) -> Option<f32> {
    let exact = |t: &&ErrorTally<f64>| t.above.error == 0.0 && t.below.error == 0.0;
    below_one.iter().rev().take_while(exact).last().map(|t| f32::from_bits(t.start))
}

fn counted(tallies: &[Vec<ErrorTally<f64>>]) -> u64 {
    tallies[0].iter().map(|t| t.count).sum()
}

/// −log₂ e, and 149 (the depth of the smallest denormal) where nothing is lost.
fn equivalent_bits(error: f64) -> f64 {
    if error > 0.0 { -libm::log2(error) } else { 149.0 }
}

/// Segment by segment the worst of several roundings: greatest extremes, sums of the larger rms.
fn worst_of(tallies: &[Vec<ErrorTally<f64>>]) -> Vec<ErrorTally<f64>> {
    let worse = |a: ErrorTally<f64>, b: ErrorTally<f64>| {
        let sums = if b.squares > a.squares { b } else { a };
        ErrorTally {
            above: a.above.or(b.above),
            below: a.below.or(b.below),
            sum: sums.sum,
            squares: sums.squares,
            ..a
        }
    };
    let segment = |i: usize| tallies.iter().map(|t| t[i]).reduce(worse).expect("a rounding");
    (0..tallies[0].len()).map(segment).collect()
}

fn peak(segments: &[ErrorTally<f64>], pick: impl Fn(&ErrorTally<f64>) -> Extreme<f64>) -> Peak {
    let most = segments.iter().map(pick).reduce(Extreme::or).expect("a segment");
    Peak { error: most.error, at: f32::from_bits(most.at) }
}

/// Sums are in depths per float; a float weighs its spacing, so that depth is uniform.
fn range(from: f64, to: f64, segments: &[ErrorTally<f64>]) -> RangeError {
    let (above, below) = (peak(segments, |t| t.above), peak(segments, |t| t.below));
    let first = if below.error > above.error { below } else { above };
    let max = if below.error == above.error && below.at < above.at { below } else { first };
    let weighed = |pick: fn(&ErrorTally<f64>) -> f64| {
        let sum: f64 = segments.iter().map(|t| pick(t) * spacing(t.start)).sum();
        if to > from { sum / (to - from) } else { segments.iter().map(pick).sum() }
    };
    let mean = weighed(|t| t.sum);
    let rms = weighed(|t| t.squares).sqrt();
    RangeError { from, to, max, mean, rms }
}

fn ranges(segments: &[ErrorTally<f64>]) -> Vec<RangeError> {
    let starts = [0.0, 1.0 / 65_536.0, 1.0 / 256.0, 0.5].into_iter();
    let mut edges: Vec<f32> = starts.chain(CUTS).chain([1.0]).collect();
    edges.dedup();
    let inside = |from: f32, to: f32| -> Vec<ErrorTally<f64>> {
        let range = from.to_bits()..to.to_bits();
        segments.iter().filter(|t| range.contains(&t.start)).copied().collect()
    };
    let mut ranges: Vec<RangeError> =
        edges.windows(2).map(|w| range(w[0].into(), w[1].into(), &inside(w[0], w[1]))).collect();
    ranges.push(range(1.0, 1.0, &segments[segments.len() - 1..]));
    ranges
}

/// Segment ends are always evaluated, sampled or not, so the steps between segments count.
fn order(segments: &[ErrorTally<f64>]) -> Order {
    let joined = segments.iter().copied().reduce(ErrorTally::then).expect("a segment");
    let at = f32::from_bits(joined.drop.at);
    Order { inversions: joined.inversions, largest_drop: Peak { error: joined.drop.size, at } }
}

fn specials<F: Raw>(trip: &dyn RoundTrip<F>) -> Vec<Special> {
    let depths = [
        ("0", 0.0),
        ("-0", -0.0),
        ("smallest denormal", f32::from_bits(1)),
        ("largest denormal", f32::from_bits(0x007f_ffff)),
        ("1 - 2^-24", 1.0f32.next_down()),
        ("1", 1.0),
        ("1 + 2^-23", 1.0f32.next_up()),
        ("2", 2.0),
        ("-0.25", -0.25),
        ("+inf", f32::INFINITY),
        ("-inf", f32::NEG_INFINITY),
        ("NaN", f32::NAN),
    ];
    let special = |(name, z): (&'static str, f32)| {
        let decoded: f64 = trip.decoded(F::from_depth(z)).into();
        let texel = trip.texel(F::from_depth(z));
        Special { depth: name, texel, decoded: format!("{:?}", decoded as f32) }
    };
    depths.into_iter().map(special).collect()
}

struct Promises {
    idempotent: Promise,
    invertible: Promise,
    sound: Promise,
}

fn promises<F: Raw>(trips: &[&dyn RoundTrip<F>]) -> Promises {
    let none = Promise::default();
    let mut promises = Promises { idempotent: none, invertible: none, sound: none };
    let depths = sampled_depths();
    for &trip in trips {
        for z in depths.iter().map(|&z| F::from_depth(z)) {
            let once = trip.decoded(z);
            promises.idempotent.note(trip.decoded(once).key() == once.key());
            promises.invertible.note(trip.texel(once) == trip.texel(z));
            promises.sound.note(trip.is_sound(z));
        }
    }
    promises
}

/// The least f32 b with not z > fl(D + b), at the worst depth and at every sampled one: real
/// differences first, then single steps up while the literal rule still says shadow.
fn forced_bias<F: Raw>(trips: &[&dyn RoundTrip<F>], worst: Peak) -> f32 {
    let mut bias = (worst.error as f32).next_down().max(0.0);
    let depths = sampled_depths().iter().copied().filter(|&z| z < 1.0).chain([worst.at]);
    for z in depths {
        for trip in trips {
            let decoded: f64 = trip.decoded(F::from_depth(z)).into();
            let decoded = decoded as f32;
            while z > decoded + bias {
                bias = bias.next_up();
            }
        }
    }
    bias
}
