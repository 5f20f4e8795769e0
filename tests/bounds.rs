//! Every measured round-trip error against its proved bound, side by side.

use gnomon::analysis::roundtrip::curve::error_curve;
use gnomon::analysis::roundtrip::{Certifier, Conditions, Method};
use gnomon::depth::{Arithmetic, ByteStore, Packing, UnormLoad};
use gnomon::simd::Level;

/// Bounds are sound on every kind of hardware, and mostly tight: under a store that rounds, the
/// largest error is at least half of the bound, but where f32 roundings never meet (see `LOOSE`).
fn check_bounds(method: Method, stores: &[ByteStore], loads: &[UnormLoad]) -> usize {
    /// three.js r86 sums from the last term: roundings that do not fall on one depth, as those of r68
    /// and of the typo; with the sampler's reciprocal those of RGBA neither.
    const LOOSE: [Packing; 4] =
        [Packing::ThreeR86, Packing::ThreeR68, Packing::Aras160581375, Packing::ThreeRgba];
    let effort = Certifier { method, level: Level::best() };
    let mut checked = 0;
    for &packing in Packing::ALL.iter().filter(|p| p.original() == **p) {
        for (&store, &load) in stores.iter().flat_map(|s| loads.iter().map(move |l| (s, l))) {
            for arithmetic in [Arithmetic::F32, Arithmetic::Fma, Arithmetic::Real] {
                let conditions = Conditions { store, load, arithmetic };
                if method == Method::Pruned && arithmetic == Arithmetic::Real {
                    continue;
                }
                let certificate = effort.certify_packing(packing, conditions);
                let Some(bound) = certificate.bound else { continue };
                let place = format!("{packing} {store} {load} {arithmetic}");
                let max = certificate.max.error;
                assert!(max <= bound.value, "{place}: {max:e} above {bound:?}");
                let claimed = store == ByteStore::HalfEven
                    && load != UnormLoad::Half
                    && arithmetic == Arithmetic::F32
                    && !LOOSE.contains(&packing);
                let tight = bound.value <= 2.0 * max;
                assert!(tight || !claimed, "{place}: {max:e} far below {bound:?}");
                if store == ByteStore::HalfEven && arithmetic == Arithmetic::F32 {
                    println!("{place:40} bound {:.4e}, measured {max:.4e}", bound.value);
                }
                checked += 1;
            }
        }
    }
    checked
}

const STORES: [ByteStore; 3] = [ByteStore::HalfEven, ByteStore::Truncate, ByteStore::Admissible];

#[test]
fn no_measured_error_exceeds_its_proved_bound() {
    let checked = check_bounds(Method::Sampled, &STORES, &[UnormLoad::Divide]);
    assert!(checked > 140, "{checked} combinations have a bound");
}

#[test]
#[ignore = "soak: every float of every packing under every store and sampler"]
fn no_float_exceeds_the_proved_bound() {
    let loads = [UnormLoad::Divide, UnormLoad::Reciprocal];
    let checked = check_bounds(Method::Pruned, ByteStore::ALL, &loads);
    assert!(checked > 200, "{checked} combinations have a bound");
}

/// The drawn curve shows errors that last a few ulps beside a code boundary: that of June 2007 doubles
/// there, above half the depth alone, and stays within its bound in every slice.
#[test]
fn drawn_curves_show_peaks_at_code_boundaries() {
    let slices = error_curve(Packing::Aras2007, Conditions::plain(ByteStore::HalfEven), 64);
    let largest = |slices: &[gnomon::analysis::roundtrip::curve::Slice]| {
        slices.iter().map(|s| s.measured).fold(0.0, f64::max)
    };
    let (below, above) = slices.split_at(32);
    assert!(largest(below) < 0.004, "{:e}", largest(below));
    assert_eq!(largest(above), 0.007858633995056152);
    assert!(slices.iter().all(|s| s.theory.is_some_and(|bound| s.measured <= bound)));
}
