//! Every float of [0, 1]: known numbers, and the fast ways against the brute loop.
//!
//! The whole brute loop over every packing is `#[ignore]`d: `cargo test --release --test exhaustive
//! -- --ignored` (some minutes).

use gnomon::analysis::roundtrip::survey::{FLOATS, ONE, segments, survey_format, tally};
use gnomon::analysis::roundtrip::tally::ErrorTally;
use gnomon::analysis::roundtrip::{Certificate, Certifier, Conditions, Method, survey};
use gnomon::depth::arith::Raw;
use gnomon::depth::roundtrip::{AnyRoundTrip, Path};
use gnomon::depth::{
    Arithmetic, ByteStore, DepthFormat, FormatTrip, Packing, RoundTrip, UnormLoad, UnormStore,
};
use gnomon::num::exp2;
use gnomon::simd::Level;

fn pruned(packing: Packing, load: UnormLoad, arithmetic: Arithmetic) -> Certificate {
    let effort = Certifier { method: Method::Pruned, level: Level::best() };
    let store = ByteStore::HalfEven;
    let certificate = effort.certify_packing(packing, Conditions { store, load, arithmetic });
    assert_eq!(certificate.answered, FLOATS);
    certificate
}

fn inversions(certificate: &Certificate) -> u64 {
    certificate.order.expect("one rounding has an order").inversions
}

#[test]
fn book_loses_all_but_nine_bits_and_wraps() {
    for load in [UnormLoad::Divide, UnormLoad::Reciprocal] {
        let book = pruned(Packing::Book, load, Arithmetic::F32);
        assert!((book.max.error - 0.001_968_6).abs() < 5e-8, "{load}: {:?}", book.max);
        assert!((book.max.at - 0.501_960).abs() < 1e-5, "{load}: {:?}", book.max);
        assert_eq!(inversions(&book), 33_026, "{load}");
        assert_eq!(book.at_one, 0.0, "the far plane wraps to the near one");
    }
}

#[test]
fn aras_depends_on_how_bytes_are_decoded() {
    let divided = pruned(Packing::Aras2009, UnormLoad::Divide, Arithmetic::F32);
    assert_eq!(divided.max.error, exp2(-23));
    assert_eq!(divided.max.at, 0.502_624_7, "closed-form list: 0.502624691");
    assert_eq!(inversions(&divided), 575);
    let reciprocal = pruned(Packing::Aras2009, UnormLoad::Reciprocal, Arithmetic::F32);
    assert_eq!(reciprocal.max.error, 1.5 * exp2(-23));
    assert_eq!(inversions(&reciprocal), 583);
    assert_eq!(reciprocal.at_one, 0.0);
}

#[test]
fn three_js_loses_the_far_plane_until_r167() {
    let old = pruned(Packing::ThreeR86, UnormLoad::Divide, Arithmetic::F32);
    assert_eq!((old.at_one, old.specials[5].depth), (0.996_093_75, "1"));
    let new = pruned(Packing::ThreeRgba, UnormLoad::Divide, Arithmetic::F32);
    assert_eq!((new.at_one, inversions(&new)), (1.0, 0));
    assert!(new.max.error <= exp2(-32), "{:?}", new.max);
}

/// R1–R3 for integer digits in f64 reference arithmetic.
#[test]
fn integer_digits_meet_their_bounds() {
    for (packing, bits) in [(Packing::Digits16, 16), (Packing::Digits24, 24)] {
        let digits = pruned(packing, UnormLoad::Divide, Arithmetic::Real);
        let bound = 0.5 / (exp2(bits) - 1.0);
        assert!(digits.max.error <= bound * (1.0 + exp2(-40)), "{packing}: {:?}", digits.max);
        assert!(digits.max.error > bound * 0.99, "{packing}: the bound is met: {:?}", digits.max);
        assert_eq!(inversions(&digits), 0, "{packing}");
    }
    let digits = pruned(Packing::Digits32, UnormLoad::Divide, Arithmetic::F32);
    assert!(digits.max.error <= exp2(-33) * (1.0 + exp2(-32)), "{:?}", digits.max);
    assert_eq!(inversions(&digits), 0);
    assert_eq!(digits.exact_from, Some(exp2(-9) as f32), "every float from 2^-9 on is returned");
}

/// R2: decoded as a f32, the 32-bit code returns every float from 2⁻⁹ on, and the largest that it
/// does not return is the one before.
#[test]
fn thirty_two_bits_are_exact_from_two_to_the_minus_nine() {
    let path = real_path(Packing::Digits32);
    let AnyRoundTrip::F64(trip) = path else { panic!("real values decode to f64") };
    let exact = |bits: u32| {
        let z = f32::from_bits(bits);
        trip.decoded(f64::from(z)) as f32 == z
    };
    let edge = (exp2(-9) as f32).to_bits();
    assert!(!exact(edge - 1), "pred(2^-9) is the largest that fails");
    assert!((edge..=ONE).step_by(127).all(exact), "sampled; the whole range below is a soak run");
}

fn real_path(packing: Packing) -> AnyRoundTrip {
    let rounding = ByteStore::HalfEven.roundings()[0];
    let path = Path { rounding, load: UnormLoad::Divide, arithmetic: Arithmetic::Real };
    path.of_packing(packing)
}

/// R4 (D3D's rule for what is no depth).
#[test]
fn integer_digits_keep_the_ends_and_refuse_the_rest() {
    for packing in [Packing::Digits16, Packing::Digits24, Packing::Digits32] {
        let rounding = ByteStore::HalfEven.roundings()[0];
        let path = Path { rounding, load: UnormLoad::Divide, arithmetic: Arithmetic::F32 };
        let AnyRoundTrip::F32(trip) = path.of_packing(packing) else { panic!("f32") };
        let zeros = [0.0, -0.0, -1.0, f32::NEG_INFINITY, f32::NAN, f32::MIN_POSITIVE];
        assert!(zeros.iter().all(|&z| trip.decoded(z) == 0.0), "{packing}");
        let ones = [1.0, 1.0f32.next_up(), 2.0, f32::INFINITY];
        assert!(ones.iter().all(|&z| trip.decoded(z) == 1.0), "{packing}");
        assert!(trip.texel(1.0).iter().all(|&byte| byte == 255), "{packing}");
    }
}

/// R5: every code of 8, 16 and 24 bits survives unpack and pack (32 bits: a soak run).
#[test]
fn every_code_of_24_bits_is_invertible() {
    for (packing, bits) in [(Packing::Digits16, 16), (Packing::Digits24, 24)] {
        let AnyRoundTrip::F64(trip) = real_path(packing) else { panic!("real") };
        let lost = (0..1u32 << bits).filter(|code| {
            let z = f64::from(*code) / (exp2(bits) - 1.0);
            trip.texel(z) != code.to_be_bytes()[4 - bits as usize / 8..]
        });
        assert_eq!(lost.count(), 0, "{packing}");
    }
    for format in [DepthFormat::Unorm8, DepthFormat::Unorm16, DepthFormat::Unorm24] {
        let codes = 0..=format.unorm_max().expect("an integer format");
        let lost = codes.filter(|&code| format.encode(format.decode(code)) != code);
        assert_eq!(lost.count(), 0, "{format}");
    }
}

/// R1 and R5 for 32 bits in f64 reference arithmetic, R2 on every float.
#[test]
#[ignore = "soak: 2^32 codes"]
fn every_code_of_32_bits_is_invertible() {
    let AnyRoundTrip::F64(trip) = real_path(Packing::Digits32) else { panic!("real") };
    use rayon::prelude::*;
    let lost = (0..=u32::MAX).into_par_iter().filter(|code| {
        let z = f64::from(*code) / (exp2(32) - 1.0);
        trip.texel(z) != code.to_be_bytes()
    });
    assert_eq!(lost.count(), 0);
    let edge = (exp2(-9) as f32).to_bits();
    let inexact = (edge..=ONE).into_par_iter().filter(|&bits| {
        let z = f32::from_bits(bits);
        trip.decoded(f64::from(z)) as f32 != z
    });
    assert_eq!(inexact.count(), 0, "exact for every f32 from 2^-9 on");
    let digits = pruned(Packing::Digits32, UnormLoad::Divide, Arithmetic::Real);
    let bound = 0.5 / (exp2(32) - 1.0);
    assert!(digits.max.error <= bound * (1.0 + exp2(-20)), "{:?}", digits.max);
    assert!(digits.max.error > bound * 0.99, "the bound is met: {:?}", digits.max);
    assert_eq!(inversions(&digits), 0);
}

/// R1: 32 bits by truncation lose at most 2⁻³².
#[test]
#[ignore = "soak: 2^26 codes by break points"]
fn truncated_32_bits_lose_a_whole_step() {
    let trip = FormatTrip { store: UnormStore::Truncate, ..format_trip(DepthFormat::Unorm32) };
    let effort = Certifier { method: Method::BreakPoints, level: Level::best() };
    let truncated = effort.certify_format(trip);
    let step = exp2(-32);
    assert!(truncated.max.error <= step * (1.0 + exp2(-20)), "{:?}", truncated.max);
    assert!(truncated.max.error > 0.9 * step, "{:?}", truncated.max);
}

/// R4 on all 2³² bit patterns: what is no depth is 0 or 1 as D3D asks, and nothing panics.
#[test]
#[ignore = "soak: 2^32 bit patterns of every packing"]
fn every_bit_pattern_has_an_answer() {
    use rayon::prelude::*;
    const RUN: u32 = 1 << 12;
    for &packing in Packing::ALL.iter().filter(|p| p.original() == **p) {
        let rounding = ByteStore::HalfEven.roundings()[0];
        let path = Path { rounding, load: UnormLoad::Divide, arithmetic: Arithmetic::F32 };
        let AnyRoundTrip::F32(trip) = path.of_packing(packing) else { panic!("f32") };
        let digits = [Packing::Digits16, Packing::Digits24, Packing::Digits32].contains(&packing);
        let wrong = |run: u32| -> usize {
            let mut decoded = [0.0; RUN as usize];
            trip.run(Level::best(), run * RUN, &mut decoded);
            let answered = |(bits, &d): (u32, &f32)| {
                let z = f32::from_bits(bits);
                match z {
                    _ if !digits => d.is_finite(),
                    z if z.is_nan() || z <= 0.0 => d == 0.0,
                    z if z >= 1.0 => d == 1.0,
                    _ => (0.0..=1.0).contains(&d),
                }
            };
            (run * RUN..=u32::MAX).zip(&decoded).filter(|pair| !answered(*pair)).count()
        };
        let wrong: usize = (0..=u32::MAX / RUN).into_par_iter().map(wrong).sum();
        // The bit pattern's own packing gives infinity and NaN back.
        let faithful = packing == Packing::PlaycanvasBits;
        assert_eq!(wrong > 0, faithful, "{packing}: {wrong}");
    }
}

/// Half precision breaks every form with a factor 256³ or 255³ (and 2¹⁶ − 1): the products are
/// infinite from 65504 on. What survives has no such factor, and eleven bits.
#[test]
fn half_precision_breaks_every_form_with_a_large_factor() {
    use Packing::{PlaycanvasBits, PlaycanvasVsm8, R8, ThreeHalf, ThreeRg, UnityRg};
    let small = [R8, UnityRg, ThreeRg, ThreeHalf, PlaycanvasVsm8, PlaycanvasBits];
    for &packing in Packing::ALL {
        let certificate = pruned(packing, UnormLoad::Divide, Arithmetic::Fp16);
        let broken = certificate.sound.broken > 0;
        assert_eq!(broken, !small.contains(&packing), "{packing}: {:?}", certificate.sound);
        let coarse = certificate.max.error >= 0.9 * exp2(-12);
        assert!(coarse, "{packing}: eleven bits are all there are: {:?}", certificate.max);
    }
}

fn assert_same<F: Raw>(name: &str, fast: &ErrorTally<F>, brute: &ErrorTally<F>) {
    let place = format!("{name} from {:e}", f32::from_bits(brute.start));
    assert_eq!((fast.start, fast.count), (brute.start, brute.count), "{place}");
    assert_eq!(fast.above, brute.above, "{place}: greatest error above, and where");
    assert_eq!(fast.below, brute.below, "{place}: greatest error below, and where");
    assert_eq!(fast.inversions, brute.inversions, "{place}: inversions");
    assert_eq!(fast.drop, brute.drop, "{place}: largest drop, and where");
    assert_eq!((fast.first, fast.last), (brute.first, brute.last), "{place}: ends");
    let scale = (brute.squares * brute.count as f64).sqrt().max(f64::MIN_POSITIVE);
    let close = |a: f64, b: f64, size: f64| (a - b).abs() <= 1e-6 * size;
    assert!(close(fast.sum, brute.sum, scale), "{place}: {} {}", fast.sum, brute.sum);
    assert!(close(fast.squares, brute.squares, brute.squares), "{place}: squares");
}

fn windows() -> impl Iterator<Item = (u32, u32)> {
    segments().into_iter().flat_map(|segment| {
        let length = segment.end - segment.start;
        let width = length.min(1 << 11);
        (0..3u32).map(move |i| {
            let start = segment.start + (u64::from(length - width) * u64::from(i) / 2) as u32;
            (start, start + width)
        })
    })
}

fn compare_windows<F: Raw>(name: &str, trip: &dyn RoundTrip<F>) {
    let level = Level::best();
    for (start, end) in windows() {
        let fast = tally(trip, level, Method::Pruned, start, end);
        let brute = tally(trip, level, Method::Brute, start, end);
        assert_same(name, &fast, &brute);
    }
}

#[test]
fn pruning_equals_brute_force_in_windows_of_every_binade() {
    for &packing in Packing::ALL.iter().filter(|p| p.original() == **p) {
        for &arithmetic in &[Arithmetic::F32, Arithmetic::Fma, Arithmetic::Real] {
            for store in [ByteStore::HalfEven, ByteStore::Truncate] {
                let rounding = store.roundings()[0];
                let path = Path { rounding, load: UnormLoad::Divide, arithmetic };
                let name = format!("{packing} {store} {arithmetic}");
                match path.of_packing(packing) {
                    AnyRoundTrip::F32(trip) => compare_windows(&name, &*trip),
                    AnyRoundTrip::F64(trip) => compare_windows(&name, &*trip),
                }
            }
        }
    }
}

fn compare_whole(packing: Packing, store: ByteStore) {
    let rounding = store.roundings()[0];
    let path = Path { rounding, load: UnormLoad::Divide, arithmetic: Arithmetic::F32 };
    let AnyRoundTrip::F32(trip) = path.of_packing(packing) else { panic!("f32") };
    let fast = survey(&*trip, Level::best(), Method::Pruned);
    let brute = survey(&*trip, Level::best(), Method::Brute);
    for (fast, brute) in fast.iter().zip(&brute) {
        assert_same(packing.name(), fast, brute);
    }
}

#[test]
fn pruning_equals_brute_force_over_every_float_of_the_book() {
    compare_whole(Packing::Book, ByteStore::HalfEven);
}

#[test]
#[ignore = "soak: every float of every packing twice"]
fn pruning_equals_brute_force_over_every_float() {
    for &packing in Packing::ALL.iter().filter(|p| p.original() == **p) {
        for store in [ByteStore::HalfEven, ByteStore::Truncate] {
            compare_whole(packing, store);
        }
    }
}

/// The literal scalar path of each depth against a run in vectors.
fn assert_scalar_bits(packing: Packing, arithmetic: Arithmetic, first: u32, count: usize) {
    let rounding = ByteStore::HalfEven.roundings()[0];
    let path = Path { rounding, load: UnormLoad::Divide, arithmetic };
    let AnyRoundTrip::F32(trip) = path.of_packing(packing) else { panic!("f32") };
    let scalar: Vec<u32> =
        (first..).take(count).map(|z| trip.decoded(f32::from_bits(z)).to_bits()).collect();
    for &level in Level::ALL.iter().filter(|level| level.is_available()) {
        let mut out = vec![0.0; count];
        trip.run(level, first, &mut out);
        let same = out.iter().map(|d| d.to_bits()).eq(scalar.iter().copied());
        assert!(same, "{packing} {arithmetic} {level} from {first:#x}");
        trip.run_proved(level, first, &mut out);
        let same = out.iter().map(|d| d.to_bits()).eq(scalar.iter().copied());
        assert!(same, "{packing} {arithmetic} {level} from {first:#x}, proved channels");
    }
}

#[test]
fn every_vector_width_gives_the_bits_of_the_scalar_path() {
    // Around 2^-64 and 1, where the loop changes, and in every second binade.
    let edges = [1u32, (63 << 23) - 300, 0x3b80_0000, 0x3eff_ff00, 0x3f00_0000, ONE - 299, ONE + 1];
    let binades = (64..127u32).step_by(2).map(|e| (e << 23) + e * 0x1_2345);
    let firsts: Vec<u32> = edges.into_iter().chain(binades).collect();
    for &packing in Packing::ALL.iter().filter(|p| p.original() == **p) {
        for arithmetic in [Arithmetic::F32, Arithmetic::Fma] {
            firsts.iter().for_each(|&z| assert_scalar_bits(packing, arithmetic, z, 600));
        }
    }
}

#[test]
#[ignore = "soak: every float from 2^-20 on of every packing, one at a time"]
fn every_vector_width_gives_the_bits_of_the_scalar_path_for_every_float() {
    use rayon::prelude::*;
    const RUN: usize = 1 << 12;
    for &packing in Packing::ALL.iter().filter(|p| p.original() == **p) {
        let runs = (107u32 << 23..ONE + 1).into_par_iter().step_by(RUN);
        runs.for_each(|first| assert_scalar_bits(packing, Arithmetic::F32, first, RUN));
    }
}

fn format_trip(format: DepthFormat) -> FormatTrip {
    FormatTrip { format, store: UnormStore::Exact, load: UnormLoad::Divide }
}

#[test]
fn break_points_equal_brute_force() {
    for &format in DepthFormat::ALL {
        let trip = format_trip(format);
        for (start, end) in windows().filter(|w| format != DepthFormat::F32 || w.1 > 0x3f00_0000) {
            let fast: ErrorTally<f64> = tally(&trip, Level::best(), Method::Pruned, start, end);
            let brute = tally(&trip, Level::best(), Method::Brute, start, end);
            assert_same(format.name(), &fast, &brute);
        }
    }
    let fast = survey_format::<f64>(format_trip(DepthFormat::Unorm16));
    let brute = survey::<f64>(&format_trip(DepthFormat::Unorm16), Level::best(), Method::Brute);
    for (fast, brute) in fast.iter().zip(&brute) {
        assert_same("unorm16", fast, brute);
    }
    let evaluated: u64 = fast.iter().map(|t| t.evaluated).sum();
    assert!(evaluated < 140_000, "two ends of 65,536 cells, not a billion floats: {evaluated}");
}

/// R1: UNORM16 ≤ 1/(2(2¹⁶ − 1)), decoded in f64; met at 0.5, a tie.
#[test]
fn unorm16_meets_its_bound() {
    let effort = Certifier { method: Method::BreakPoints, level: Level::best() };
    let unorm16 = effort.certify_format(format_trip(DepthFormat::Unorm16));
    let bound = 0.5 / 65_535.0;
    assert!((unorm16.max.error / bound - 1.0).abs() < 1e-12, "{:?}", unorm16.max);
    assert_eq!(unorm16.max.at, 0.5, "a tie");
    assert_eq!(inversions(&unorm16), 0);
}
