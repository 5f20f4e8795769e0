//! The verdict by closed forms, and its two ways of finding who decides against each other.

use glam::{DVec2, DVec3};
use gnomon::analysis::classify::Kind;
use gnomon::analysis::classify::StoredCaster::{self, Occluder, Other, Own};
use gnomon::analysis::measure::measure;
use gnomon::analysis::sweep::Field;
use gnomon::analysis::sweep::chart::{Attachment, Chart};
use gnomon::analysis::verdict::counted::{Counted, Measure, is_misplaced, is_penumbra, on_plane};
use gnomon::analysis::verdict::{
    Held, LookUp, SHARE, SOUND, SURELY_SOUND, WHOLE, deciding, deciding_in_a_mix, is_sound, spans,
    verdict, visibility,
};
use gnomon::scene::cases;
use gnomon::shadow::bias::Strategy;
use std::collections::BTreeMap;

/// Parts as listed: share of the whole, visibility, surface; all sound, no occluder hidden.
struct Listed(Vec<(f64, f64, StoredCaster)>, usize);

impl Held for Listed {
    fn caster(&self, part: usize) -> StoredCaster {
        self.0[part].2
    }
    fn is_sound(&self, _: usize) -> bool {
        true
    }
    fn share(&self, part: usize) -> i64 {
        (self.0[part].0 * SHARE) as i64
    }
}

impl LookUp for Listed {
    fn parts(&self) -> usize {
        self.0.len()
    }
    fn centre(&self) -> usize {
        self.1
    }
    fn visibility(&self, part: usize) -> f64 {
        self.0[part].1
    }
    fn is_hidden(&self, _: usize) -> bool {
        false
    }
}

#[test]
fn the_centre_names_the_error_then_the_first_wrong_part() {
    let parts = |lit: [f64; 3]| {
        let casters = [Own, Other, Own];
        Listed(std::array::from_fn::<_, 3, _>(|i| (0.25, lit[i], casters[i])).to_vec(), 1)
    };
    let found = verdict(&parts([0.0, 0.0, 1.0]), true).unwrap();
    assert_eq!((found.kind, found.part, found.share), (Kind::EDGE_SHADOW, Some(1), WHOLE / 2));
    let found = verdict(&parts([1.0, 1.0, 0.0]), true).unwrap();
    assert_eq!((found.kind, found.part, found.share), (Kind::ACNE, Some(2), WHOLE / 4));
    assert_eq!(verdict(&parts([1.0; 3]), true), None);
}

#[test]
fn a_receiver_that_nothing_is_looked_up_for_is_lit() {
    let nothing = Listed(Vec::new(), 0);
    assert_eq!(visibility(&nothing), 1.0);
    assert_eq!(verdict(&nothing, true), None);
    let lost = verdict(&nothing, false).unwrap();
    assert_eq!((lost.kind, lost.part, lost.share), (Kind::LIGHT_LEAK, None, WHOLE));
}

/// One part whose visibility is a closed form, as of a moment map, is booked by its wrong share.
#[test]
fn visibility_need_not_come_from_taps() {
    let soft = Listed(vec![(1.0, 0.375, Own)], 0);
    assert_eq!(visibility(&soft), 0.375);
    assert_eq!(verdict(&soft, true).unwrap().share, (0.625 * SHARE) as i64);
    assert_eq!(verdict(&soft, false).unwrap().share, (0.375 * SHARE) as i64);
}

#[test]
fn sound_is_within_two_codes_of_eight_bits() {
    assert!(is_sound(Some(0.5), 0.5 + SURELY_SOUND) && is_sound(Some(1.25), 1.0));
    assert!(!is_sound(Some(0.5), 0.508) && !is_sound(None, 1.0) && !is_sound(Some(0.5), f32::NAN));
    assert!(f64::from(SURELY_SOUND) <= SOUND && SOUND < f64::from(SURELY_SOUND) + 1e-9);
}

/// Along all amounts the spans say what the first wrong tap in order says at each of them.
#[test]
fn spans_are_the_deciding_tap_at_every_amount() {
    let mut seed = 5u64;
    let mut next = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 40) as u32 % 9
    };
    for _ in 0..2000 {
        let taps = 1 + next() as usize;
        let lit_from: Vec<f32> = (0..taps).map(|_| next() as f32 - 1.0).collect();
        let centre = next() as usize % taps;
        for truly_lit in [true, false] {
            let mut found = Vec::new();
            let end = spans(truly_lit, centre, &lit_from, |tap, from, until| {
                found.push((tap, from, until));
            });
            for amount in (-2..9).map(|a| a as f32 + 0.5).chain((-2..9).map(|a| a as f32)) {
                let wrong = |tap: usize| (amount >= lit_from[tap]) != truly_lit;
                let of = |&&(_, from, until): &&(usize, f32, f32)| from <= amount && amount < until;
                let says: Vec<usize> = found.iter().filter(of).map(|s| s.0).collect();
                let expected: Vec<usize> = deciding(centre, taps, wrong).into_iter().collect();
                assert_eq!(says, expected, "{lit_from:?} centre {centre} at {amount}, {truly_lit}");
                assert_eq!(says.is_empty(), if truly_lit { amount >= end } else { amount < end });
            }
        }
    }
}

#[test]
fn a_mix_is_decided_by_the_nearest_texel_where_it_darkens() {
    let depths = [0.5, 0.25, 0.75, 0.25];
    assert_eq!(deciding_in_a_mix(true, 4, |i| depths[i]), 1, "the first of equals");
    assert_eq!(deciding_in_a_mix(false, 4, |i| depths[i]), 0);
}

/// Four receivers: lit and right at 60°, lit with a quarter dark seen head-on, shadowed and half lit at
/// 60°, facing away and wrong.
#[test]
fn wrong_mean_and_seen_by_hand() {
    let mut counted = Counted::default();
    assert_eq!(counted.of(Measure::Seen), None, "nothing is measured over nobody");
    let right = Listed(vec![(1.0, 1.0, Own)], 0);
    let quarter = Listed(vec![(0.75, 1.0, Other), (0.25, 0.0, Own)], 0);
    let half = Listed(vec![(0.5, 1.0, Other), (0.5, 0.0, Occluder)], 0);
    let away = Listed(vec![(1.0, 0.0, Own)], 0);
    counted.add(&right, true, 0.5);
    counted.add(&quarter, true, 1.0);
    let mut others = Counted::default();
    others.add(&half, false, 0.5);
    others.add(&away, true, -0.25);
    let counted = counted.joined(&others);
    assert_eq!(counted.of(Measure::Wrong), Some(0.75));
    assert_eq!(counted.of(Measure::Mean), Some((0.25 + 0.5 + 1.0) / 4.0));
    assert_eq!(counted.of(Measure::Seen), Some((0.25 + 0.5 * 0.5) / 2.0));
    assert_eq!(counted.seen_of(Kind::ACNE), Some(0.125), "away from the light nothing is seen");
    assert_eq!(counted.seen_of(Kind::LIGHT_LEAK), Some(0.125));
    let kinds = Kind::ALL.iter().filter_map(|&kind| counted.seen_of(kind));
    assert_eq!(kinds.sum::<f64>(), counted.of(Measure::Seen).unwrap());
}

/// 2²⁴ world units from the origin f32 steps are two units: a texel of one is missed, one of eight not.
#[test]
fn a_look_up_far_from_the_origin_is_misplaced() {
    let far = 16_777_216.0 + 1.0f64;
    let moved = f64::from(far as f32) - far;
    assert_eq!(moved.abs(), 1.0);
    let (extent, exact) = (1024.0, DVec2::splat(0.5));
    let looked = [0.5 + (moved / extent) as f32, 0.5];
    assert!(is_misplaced(exact, looked, 1024), "texels of 1 unit");
    assert!(!is_misplaced(exact, looked, 128), "texels of 8 units");
    assert!(is_misplaced(exact, [f32::NAN, 0.5], 128));
    assert!(!is_misplaced(exact, [0.5f32.next_up(), 0.5], 8192), "a rounding is none");
}

/// The light looks straight down on y = 0 beside a roof over x < 0. A receiver at x = ¼ is lit; its tap at
/// x = −½ is shadowed, and rightly so for the point below it.
#[test]
fn a_tap_that_is_right_for_its_own_point_is_penumbra() {
    let truth = |p: DVec3| p.x >= 0.0;
    let point = |x: f64| {
        let (near, far) = (DVec3::new(x, 10.0, 0.0), DVec3::new(x, -10.0, 0.0));
        on_plane(near, far, DVec3::new(0.25, 0.0, 0.0), DVec3::Y).unwrap()
    };
    assert_eq!(point(-0.5), DVec3::new(-0.5, 0.0, 0.0));
    let receiver = truth(point(0.25));
    assert!(is_penumbra(false, truth(point(-0.5)), receiver));
    assert!(!is_penumbra(false, truth(point(0.5)), receiver), "dark without reason: acne");
    assert!(!is_penumbra(true, truth(point(0.5)), receiver), "right");
    assert_eq!(on_plane(DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Y), None, "parallel");
}

/// The observer at a case's own bias and the sweep at that amount say the same of every receiver: NEAREST,
/// mixed texels, PCF; the map as drawn for the one, read by slots for the other.
#[test]
fn the_observer_and_the_sweep_give_one_verdict() {
    let (mut wrong, mut receivers) = (0, 0);
    for name in ["book-r8-y7", "upc", "exam-pcf", "fundamentals-spot", "runnable-rgba8"] {
        let case = cases::named(name).unwrap();
        let measured = measure(&case, 4);
        let field = Field::new(&case, 4);
        let (format, filter) = (case.map.texel, case.map.texel.usable(case.lookup.filter));
        let chart = Chart::new(&field, case.map.size, filter, Attachment::of(format));
        let recipe = Strategy::Constant.with(case.bias);
        let found = chart.wrong(&[format], &recipe, &chart.all()).remove(0);
        let kinds: BTreeMap<[u32; 2], Kind> =
            found.iter().map(|w| (field.samples[w.receiver as usize].pixel, w.kind)).collect();
        let counted = measured.observations.iter().filter(|o| o.truly_lit().is_some());
        for o in counted {
            let says = o.outcome.fault().map(|fault| fault.kind);
            assert_eq!(says, kinds.get(&o.pixel).copied(), "{name} at {:?}", o.pixel);
            wrong += usize::from(says.is_some());
            receivers += 1;
        }
    }
    assert!(wrong > 100 && receivers > 5000, "{wrong} wrong of {receivers}: too few to tell");
}
