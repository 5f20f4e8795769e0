//! Properties of mappings, packings and users' own pairs, from inputs biased to trouble.

use gnomon::analysis::roundtrip::{Certifier, Conditions, Method};
use gnomon::depth::packing::TextPair;
use gnomon::depth::roundtrip::{AnyRoundTrip, Path};
use gnomon::depth::{
    Arithmetic, ByteStore, DepthFormat, DepthMapping, MappingKind, Packing, RoundTrip, UnormLoad,
    UnormStore,
};
use gnomon::num::{exp2, from_ordinal, ordinal, ulp};
use gnomon::simd::Level;
use proptest::prelude::*;

/// Depths where packings break: byte boundaries and halves of them ± ulps, k/255, k/256, the ends,
/// 1 − 2⁻²⁴, finer digits; and any float of [0, 1].
fn depth() -> impl Strategy<Value = f32> {
    let near = |centre: f64, ulps: i32| {
        let z = from_ordinal(ordinal(centre as f32) + ulps);
        z.clamp(0.0, 1.0)
    };
    prop_oneof![
        (0u32..=510, -8i32..=8).prop_map(move |(k, u)| near(f64::from(k) / 510.0, u)),
        (0u32..=512, -8i32..=8).prop_map(move |(k, u)| near(f64::from(k) / 512.0, u)),
        (0u32..=131_070, -2i32..=2).prop_map(move |(k, u)| near(f64::from(k) / 131_070.0, u)),
        (0u32..=33_554_430, -1i32..=1).prop_map(move |(k, u)| near(f64::from(k) / 33_554_430.0, u)),
        prop_oneof![Just(0.0f32), Just(1.0), Just(1.0 - f32::EPSILON / 2.0), Just(0.5)],
        (0u32..=0x3f80_0000).prop_map(f32::from_bits),
    ]
}

fn packing() -> impl Strategy<Value = Packing> {
    proptest::sample::select(Packing::ALL)
}

fn planes() -> impl Strategy<Value = (f64, f64)> {
    (-6.0..3.0f64, 0.001..9.0f64).prop_map(|(near, ratio)| {
        let near = libm::exp10(near);
        (near, near * libm::exp10(ratio))
    })
}

fn mapping() -> impl Strategy<Value = DepthMapping> {
    (proptest::sample::select(MappingKind::ALL), planes())
        .prop_map(|(kind, (near, far))| DepthMapping::new(kind, near, far).expect("valid planes"))
}

fn f32_trip(packing: Packing, store: ByteStore) -> Box<dyn RoundTrip<f32>> {
    let rounding = store.roundings()[0];
    let path = Path { rounding, load: UnormLoad::Divide, arithmetic: Arithmetic::F32 };
    match path.of_packing(packing) {
        AnyRoundTrip::F32(trip) => trip,
        AnyRoundTrip::F64(_) => panic!("f32 arithmetic decodes to f32"),
    }
}

/// (z − n)·f as a sum of two f64 (Dekker), divided by (f − n)·z likewise: the rational value to 2⁻¹⁰⁰.
fn exact_perspective(n: f64, f: f64, z: f64) -> f64 {
    let two_sum = |a: f64, b: f64| {
        let s = a + b;
        let bb = s - a;
        (s, (a - (s - bb)) + (b - bb))
    };
    let times = |(hi, lo): (f64, f64), x: f64| {
        let p = hi * x;
        two_sum(p, hi.mul_add(x, -p) + lo * x)
    };
    let (top, bottom) = (times(two_sum(z, -n), f), times(two_sum(f, -n), z));
    let quotient = top.0 / bottom.0;
    let rest = quotient.mul_add(-bottom.0, top.0) + top.1 - quotient * bottom.1;
    quotient + rest / bottom.0
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4096))]

    /// R6: the window depth is within 5 ulp of the rational value, for f/n up to 10⁹.
    #[test]
    fn window_depth_is_within_five_ulps((n, f) in planes(), t in 0.0..1.0f64) {
        let z = n * libm::exp(t * libm::log(f / n));
        prop_assume!(z > n && z < f);
        let mapping = DepthMapping::new(MappingKind::Perspective, n, f).expect("valid planes");
        let (ours, exact) = (mapping.window_from_distance(z), exact_perspective(n, f, z));
        let spacing = exact.next_up() - exact;
        prop_assert!((ours - exact).abs() <= 5.0 * spacing, "{ours} {exact}");
    }

    /// R6, biased to trouble: back again within twice 4·2⁻⁵³·Z²(f − n)/(nf) + 2 ulp(Z): the window depth
    /// itself is up to 5 ulp off, times dZ/dd.
    #[test]
    fn distance_comes_back(mapping in mapping(), t in 0.0..1.0f64) {
        let (n, f) = (mapping.near(), mapping.far());
        let z = n * libm::exp(t * libm::log(f / n));
        prop_assume!(z > n && z < f);
        let back = mapping.distance_from_window(mapping.window_from_distance(z));
        let allowed = 8.0 * exp2(-53) * mapping.world_per_window(z) + 4.0 * (z.next_up() - z);
        prop_assert!((back - z).abs() <= allowed, "{mapping:?}: {z} -> {back}");
    }

    #[test]
    fn mappings_are_monotone_and_stay_in_the_unit_interval(mapping in mapping(), t in 0.0..0.9f64) {
        let (n, f) = (mapping.near(), mapping.far());
        let at = |t: f64| mapping.window_from_distance((n + (f - n) * t).clamp(n, f));
        let (near, farther) = (at(t), at(t + 0.1));
        prop_assert!((0.0..=1.0).contains(&near) && (0.0..=1.0).contains(&farther));
        let ordered = if mapping.is_reversed() { farther <= near } else { near <= farther };
        prop_assert!(ordered, "{mapping:?}: {near} {farther}");
    }

    /// The bytes that D3D admits enclose those of every other rounding but truncation.
    #[test]
    fn admissible_bytes_enclose_the_rounded_ones(packing in packing(), z in depth()) {
        for channel in packing.pack(z) {
            let scaled = (channel * 255.0).clamp(0.0, 255.0);
            let (least, most) = ((scaled + 0.4).floor(), (scaled + 0.6).floor());
            for store in [UnormStore::HalfEven, UnormStore::HalfUp] {
                let byte = store.code(channel, 255) as f32;
                prop_assert!((least..=most).contains(&byte), "{packing} {channel}: {byte}");
            }
        }
    }

    /// An interval that is proved constant is constant at every depth inside.
    #[test]
    fn proved_intervals_are_constant(packing in packing(), z in depth(), length in 0u32..4096) {
        for store in [ByteStore::HalfEven, ByteStore::Truncate] {
            let trip = f32_trip(packing, store);
            let start = z.to_bits();
            let end = (start + length).min(0x3f80_0000);
            if let Some(value) = trip.constant(start, end) {
                for bits in (start..=end).step_by(1 + length as usize / 64) {
                    let decoded = trip.decoded(f32::from_bits(bits));
                    prop_assert_eq!(decoded.to_bits(), value.to_bits(), "{} at {}", packing, bits);
                }
            }
        }
    }

    /// Integer digits: no store and no sampler changes the decoded depth.
    #[test]
    fn integer_digits_do_not_see_the_hardware(
        packing in proptest::sample::select(&[Packing::Digits16, Packing::Digits24, Packing::Digits32][..]),
        z in depth(),
    ) {
        let reference = f32_trip(packing, ByteStore::HalfEven).decoded(z);
        for &store in ByteStore::ALL {
            for &rounding in store.roundings() {
                for &load in UnormLoad::ALL {
                    let path = Path { rounding, load, arithmetic: Arithmetic::Fma };
                    let AnyRoundTrip::F32(trip) = path.of_packing(packing) else { panic!("f32") };
                    prop_assert_eq!(trip.decoded(z), reference, "{} {}", store, load);
                }
            }
        }
    }

    /// A text form of a catalogued packing gives its channels and its depth, bit for bit.
    #[test]
    fn text_forms_equal_the_catalogue(z in depth()) {
        for (packing, text) in TEXTS {
            let pair = TextPair::from_toml("test.toml", text).expect("a well-formed pair");
            let path = Path {
                rounding: ByteStore::HalfEven.roundings()[0],
                load: UnormLoad::Reciprocal,
                arithmetic: Arithmetic::F32,
            };
            let (AnyRoundTrip::F32(ours), AnyRoundTrip::F32(theirs)) =
                (path.of(pair), path.of_packing(packing)) else { panic!("f32") };
            let (mine, texel) = (ours.texel(z), theirs.texel(z));
            prop_assert!(mine.starts_with(&texel), "{packing} at {z:e}: {mine:?} {texel:?}");
            prop_assert_eq!(ours.decoded(z).to_bits(), theirs.decoded(z).to_bits(), "{}", packing);
        }
    }
}

const TEXTS: [(Packing, &str); 5] = [
    (Packing::R8, "base = 255.0\norder = \"high-first\"\nchannels = 1\nat_one = [1.0]"),
    (Packing::Book, "base = 256.0\norder = \"high-first\""),
    (Packing::Upc, "base = 256.0\norder = \"low-first\""),
    (Packing::Babylon, "base = 255.0\norder = \"low-first\""),
    (
        Packing::Aras160581375,
        "base = 255.0\norder = \"high-first\"\nscales = [1.0, 255.0, 65025.0, 160581375.0]",
    ),
];

/// R6 on 10⁶ distances, log-uniform in near, far/near and Z: within 5 ulp of the rational value, and
/// back again within a few ulps of the depth times dZ/dd.
#[test]
fn a_million_window_depths_are_within_five_ulps() {
    let step = |i: u64, odd: u64| (i.wrapping_mul(odd) >> 11) as f64 / (1u64 << 53) as f64;
    let mut worst = 0.0f64;
    for i in 1..=1_000_000u64 {
        let near = libm::exp10(9.0 * step(i, 0x9e37_79b9_7f4a_7c15) - 6.0);
        let far = near * libm::exp10(0.001 + 8.999 * step(i, 0xd1b5_4a32_d192_ed03));
        let z = near * libm::exp(libm::log(far / near) * step(i, 0xaef1_7502_108e_f2d9));
        if !(near < z && z < far) {
            continue;
        }
        let mapping = DepthMapping::new(MappingKind::Perspective, near, far).expect("valid");
        let (ours, exact) = (mapping.window_from_distance(z), exact_perspective(near, far, z));
        worst = worst.max((ours - exact).abs() / (exact.next_up() - exact));
        let back = mapping.distance_from_window(ours);
        let allowed = 8.0 * exp2(-53) * mapping.world_per_window(z) + 4.0 * (z.next_up() - z);
        assert!((back - z).abs() <= allowed, "{mapping:?}: {z} -> {back}");
    }
    assert!(worst <= 5.0 && worst > 1.0, "{worst} ulp");
}

/// R7: reversed-Z f32 with far at infinity: max |ΔZ|/Z ≤ 2⁻²⁴(1 + 2⁻²²) over Z ∈ [n, 10⁷].
#[test]
fn reversed_depth_in_f32_has_a_constant_relative_step() {
    let near = 0.1;
    let mapping = DepthMapping::new(MappingKind::ReversedInfinite, near, 1e7).expect("valid");
    let mut worst = 0.0f64;
    for i in 0..10_000_000 {
        let z = near * libm::exp(libm::log(1e7 / near) * f64::from(i) / 1e7);
        let stored = f64::from(mapping.window_from_distance(z) as f32);
        worst = worst.max((mapping.distance_from_window(stored) - z).abs() / z);
    }
    let bound = exp2(-24) * (1.0 + exp2(-22));
    assert!(worst <= bound && worst > 0.99 * bound, "{worst:e} of {bound:e}");
}

/// R7: standard Z in f32: |ΔZ| ≤ 1.001·2⁻²⁵·Z²(f − n)/(nf) for Z > 2n.
#[test]
fn standard_depth_in_f32_steps_with_the_square_of_the_distance() {
    let (near, far) = (0.1, 1000.0);
    let mapping = DepthMapping::new(MappingKind::Perspective, near, far).expect("valid");
    let mut worst = 0.0f64;
    for i in 1..1_000_000 {
        let z = 2.0 * near * libm::exp(libm::log(far / near / 2.0) * f64::from(i) / 1e6);
        let stored = f64::from(mapping.window_from_distance(z) as f32);
        let error = (mapping.distance_from_window(stored) - z).abs();
        worst = worst.max(error / (exp2(-25) * mapping.world_per_window(z)));
    }
    assert!(worst <= 1.001 && worst > 0.99, "{worst}");
}

#[test]
fn formats_resolve_what_the_tables_say() {
    let ortho = DepthMapping::new(MappingKind::Orthographic, 1e-3, 100.0).expect("valid");
    let step = DepthFormat::Unorm8.quantum(0.5) * ortho.world_per_window(50.0);
    assert!((step - 0.392).abs() < 1e-3, "orthographic range 100, R8: {step}");
    assert_eq!(ulp(0.75), DepthFormat::F32.quantum(0.75), "24 bits in [1/2, 1)");
}

/// A closure is certified like a catalogued packing, by evaluating floats.
#[test]
fn closures_are_certified() {
    let own = |z: f32| [z, 0.0, 0.0, 0.0];
    let effort = Certifier { method: Method::Sampled, level: Level::best() };
    let conditions = Conditions::plain(ByteStore::HalfEven);
    let mine = effort.certify_closures("mine", 1, conditions, own, |c| c[0]);
    let catalogued = effort.certify_packing(Packing::R8, conditions);
    assert_eq!((mine.max, mine.mean, mine.rms), (catalogued.max, catalogued.mean, catalogued.rms));
    assert_eq!(mine.forced_bias, catalogued.forced_bias);
}

#[test]
fn a_bad_pair_is_refused_with_one_sentence() {
    let bad = [
        ("base = 1.0\norder = \"high-first\"", "base"),
        ("base = 255.0\norder = \"high-first\"\nchannels = 5", "channels"),
        ("base = 255.0\norder = \"high-first\"\nat_one = [1.0]", "at_one"),
        ("base = 255.0\norder = \"high-first\"\nlimit = 2.0", "limit"),
        ("base = 255.0\norder = \"sideways\"", "mine.toml"),
        ("base = 255.0\nordre = \"high-first\"", "mine.toml"),
    ];
    for (text, place) in bad {
        let error = TextPair::from_toml("mine.toml", text).expect_err(text);
        assert_eq!(error.exit_code(), 2);
        let sentence = error.to_string();
        assert!(sentence.contains(place) && !sentence.contains('\n'), "{sentence}");
    }
}

/// The literal rule z > D + b: the forced bias frees every looked-at depth, a step less does not.
#[test]
fn the_forced_bias_is_the_least() {
    let effort = Certifier { method: Method::Pruned, level: Level::best() };
    for packing in [Packing::R8, Packing::ThreeRg, Packing::Digits16] {
        let certificate = effort.certify_packing(packing, Conditions::plain(ByteStore::HalfEven));
        let trip = f32_trip(packing, ByteStore::HalfEven);
        let (worst, bias) = (certificate.below.at, certificate.forced_bias);
        let shadowed = |z: f32, b: f32| z > trip.decoded(z) + b;
        assert!(!shadowed(worst, bias), "{packing}: {bias:e}");
        let less = from_ordinal(ordinal(bias) - 4);
        let near = (worst.to_bits() - 64..=worst.to_bits() + 64).map(f32::from_bits);
        let frees = near.filter(|&z| z < 1.0).any(|z| shadowed(z, less * (1.0 - 1e-3)));
        assert!(frees, "{packing}: a smaller bias than {bias:e} leaves a shadow at {worst}");
    }
}
