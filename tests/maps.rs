//! A light with several maps against its single-map cases, and maps in every clip space.

use glam::DVec3;
use gnomon::analysis::curve::Curve;
use gnomon::analysis::documents::{self, Options, Which};
use gnomon::analysis::observe::{Observation, Observer, Standing};
use gnomon::analysis::sweep::chart::{Attachment, Chart};
use gnomon::analysis::sweep::looks::Look;
use gnomon::analysis::sweep::tally::Tally;
use gnomon::analysis::sweep::{Field, Question, sweep};
use gnomon::light::{Choice, Map, Viewport};
use gnomon::raster::passes::Subject;
use gnomon::report::Profile;
use gnomon::scene::{Case, Filter, cases, cases::analytic};
use gnomon::shadow::bias::Strategy;
use gnomon::view::{ClipRange, ClipSpace, Projection, View};

/// Share of the light's box that each half covers, in eighths.
const COVERED: u32 = 5;
const SIDE: u32 = 512;

/// The left and the right part of a directional light's square box; they share its middle quarter.
fn halves(case: &Case) -> [Map; 2] {
    let whole = case.light.only_map().expect("one map");
    let Projection::Orthographic { width, height, near, far } = whole.projection else {
        panic!("a directional light")
    };
    let part = width * f64::from(COVERED) / 8.0;
    let right = whole.view.view_from_world().row(0).truncate();
    [-1.0, 1.0].map(|side| {
        let aside = right * (side * (width - part) / 2.0);
        let View { position, target, up } = whole.view;
        let view = View { position: position + aside, target: target + aside, up };
        Map::new(view, Projection::Orthographic { width: part, height, near, far })
    })
}

/// A map that fills `COVERED` eighths of the width of a texture of its own.
fn on_layer(map: Map, layer: u16) -> Map {
    let viewport = Viewport { layer, low: [0, 0], high: [COVERED, 8], parts: 8 };
    map.on(viewport)
}

fn base(filter: Filter) -> Case {
    let mut case = cases::named("fundamentals-directional").expect("a case");
    case.lookup.filter = filter;
    case.map.size = SIDE;
    case
}

/// The case of two maps with a blend, and the cases of each map alone.
fn split(case: &Case) -> (Case, [Case; 2]) {
    let halves = halves(case);
    let with = |maps: Vec<Map>, choice: Choice| {
        let light = case.light.clone().with_maps(maps, choice).expect("a sound light");
        Case { light, ..case.clone() }
    };
    let blend = Choice::FirstThatHolds { border: 0.0, blend: 0.125 };
    let both = with(vec![on_layer(halves[0], 0), on_layer(halves[1], 1)], blend);
    (both, halves.map(|map| with(vec![on_layer(map, 0)], Choice::Only)))
}

#[test]
fn two_maps_are_drawn_as_each_is_alone_and_an_atlas_holds_the_same() {
    let (both, singles) = split(&base(Filter::Nearest));
    let device = both.device.device();
    let subject = Subject::draw(&both, &device);
    let alone = singles.each_ref().map(|case| Subject::draw(case, &device).map_raster);
    assert_eq!(subject.map_raster.layout.rect(1).size, [SIDE * COVERED / 8, SIDE]);
    let joined: Vec<u32> = alone.iter().flat_map(|map| &map.triangle).copied().collect();
    assert_eq!(subject.map_raster.triangle, joined);
    let bits = |depths: &[f32]| depths.iter().map(|z| z.to_bits()).collect::<Vec<_>>();
    let joined: Vec<f32> = alone.iter().flat_map(|map| &map.depth).copied().collect();
    assert_eq!(bits(&subject.map_raster.depth), bits(&joined));

    // Side by side in one texture of twice the width, each half as large again.
    let beside = |map: Map, low: u32| {
        let viewport = Viewport { layer: 0, low: [low, 0], high: [low + COVERED, 8], parts: 16 };
        map.on(viewport)
    };
    let [left, right] = halves(&base(Filter::Nearest));
    let choice = Choice::FirstThatHolds { border: 0.0, blend: 0.125 };
    let maps = vec![beside(left, 0), beside(right, COVERED)];
    let light = both.light.clone().with_maps(maps, choice).expect("a sound light");
    let mut atlas = Case { light, ..both.clone() };
    atlas.map.size = 2 * SIDE;
    let atlas = Subject::draw(&atlas, &device).map_raster;
    for (map, single) in alone.iter().enumerate() {
        let rect = atlas.layout.rect(map);
        for (texel, depth) in single.depth.iter().enumerate() {
            let (x, y) = (texel as u32 % rect.size[0], texel as u32 / rect.size[0]);
            let found = atlas.depth[rect.texel(x, y) as usize];
            assert_eq!(found.to_bits(), depth.to_bits(), "map {map} at {x}, {y}");
        }
    }
}

/// What an observation says, but for the numbers of its texels.
fn said(o: &Observation) -> String {
    let depths: Vec<u32> = o.taps.depths().iter().map(|d| d.to_bits()).collect();
    let coord = o.coord.map(f32::to_bits);
    let (stored, wrong) = (o.stored.map(f64::to_bits), o.wrong);
    let rest = (o.lit_taps, o.lit_share, &*o.breakpoints, o.outcome, o.caster, o.own_surface);
    format!("{coord:?} {:?} {depths:?} {stored:?} {wrong:?} {rest:?} {:?}", o.exact, o.standing)
}

#[test]
fn outside_the_blend_a_receiver_has_the_bits_of_its_single_map() {
    for filter in [Filter::Nearest, Filter::Pcf3, Filter::Bilinear] {
        let (both, singles) = split(&base(filter));
        let device = both.device.device();
        let observer = Observer::new(&both, &device);
        let two = observer.observe_canvas(3);
        let alone = singles.each_ref().map(|c| Observer::new(c, &device).observe_canvas(3));
        let [mut kept, mut mixed] = [0, 0];
        for (k, o) in two.iter().enumerate() {
            match &*o.lookups {
                [only] => {
                    kept += 1;
                    let single = &alone[only.map][k];
                    assert_eq!(said(o), said(single), "{filter} at {:?}", o.pixel);
                    let first = observer.subject.map_raster.layout.rect(only.map).first;
                    assert_eq!(o.texel, single.texel + first);
                }
                [a, b] => {
                    mixed += 1;
                    let [x, y] = [&alone[a.map][k], &alone[b.map][k]];
                    let union: Vec<f32> =
                        x.breakpoints.iter().chain(&y.breakpoints).copied().collect();
                    assert_eq!(&*o.breakpoints, union, "{filter} at {:?}", o.pixel);
                    let share = a.weight * x.lit_share + b.weight * y.lit_share;
                    assert!((o.lit_share - share).abs() < 1e-12, "{} {share}", o.lit_share);
                    assert!((a.weight + b.weight - 1.0).abs() < 1e-15);
                }
                _ => panic!("one map or two"),
            }
        }
        assert!(kept > 2000 && mixed > 200, "{filter}: {kept} in one map, {mixed} in two");
        curve_is_literal(&both, &two);
    }
}

/// The curve over breakpoints counts as the taps do at each bias.
fn curve_is_literal(case: &Case, observations: &[Observation]) {
    let curve = Curve::new(observations);
    let rule = case.lookup.compare;
    for bias in [0.0, 1e-5, 1e-4, 1e-3, 4e-3, 0.02, 0.1] {
        let (mut counts, mut shares) = ([0, 0], [0.0, 0.0]);
        for o in observations {
            let Some(truly_lit) = o.truly_lit() else { continue };
            let visible = o.taps.visibility(|i| o.taps.is_lit(rule, i, bias));
            let wrong = |i: usize| o.taps.is_lit(rule, i, bias) != truly_lit;
            counts[usize::from(!truly_lit)] += u64::from((0..o.taps.depths().len()).any(wrong));
            shares[usize::from(!truly_lit)] += if truly_lit { 1.0 - visible } else { visible };
        }
        let found = curve.at(bias);
        assert_eq!([found.false_shadow, found.false_light], counts, "at {bias}");
        for (a, b) in [found.false_shadow_weight, found.false_light_weight].iter().zip(shares) {
            assert!((a - b).abs() < 1e-6 * (1.0 + b), "at {bias}: {a} {b}");
        }
    }
}

/// The amounts of a strategy at which swept counts are compared with the literal rule.
fn assert_literal(chart: &Chart<'_, '_>, strategy: Strategy, amounts: &[f32]) -> i64 {
    let case = chart.field.case();
    let (format, rule) = (case.map.texel, case.lookup.compare);
    let swept = sweep(chart, format, strategy, &Question { amounts, max_acne: 0.001 });
    let mut wrong = 0;
    for point in &swept.points {
        let recipe = strategy.with(point.amount);
        let looks = chart.looks(format, &recipe);
        let mut found = Tally::default();
        for (i, looks) in looks.iter().enumerate() {
            let bias = |look: &Look| chart.tap_bias(&recipe, format, i, look.map);
            looks.tally_by(rule, bias, &mut found);
        }
        assert_eq!(point.tally, found, "{} {strategy} at {}", case.name, point.amount);
        wrong += point.tally.false_shadow() + point.tally.false_light();
    }
    wrong
}

const STRATEGIES: [(Strategy, [f32; 4]); 8] = [
    (Strategy::Constant, [0.0, 1e-4, 2e-3, 0.05]),
    (Strategy::World, [0.0, 1e-3, 0.02, 0.5]),
    (Strategy::ReceiverSlope, [0.0, 0.25, 1.0, 4.0]),
    (Strategy::SlopeRaster, [0.0, 0.5, 1.0, 3.0]),
    (Strategy::NormalHdrp, [0.0, 0.5, 1.0, 3.0]),
    (Strategy::CasterUrp, [0.0, 0.5, 1.0, 3.0]),
    (Strategy::ReceiverPlane, [0.0, 1e-4, 2e-3, 0.05]),
    (Strategy::Oriented, [0.0, 1e-3, 0.02, 0.5]),
];

#[test]
fn sweeps_of_two_maps_count_as_the_literal_rule_and_as_the_observer() {
    for filter in [Filter::Nearest, Filter::Pcf3] {
        let (both, _) = split(&base(filter));
        let field = Field::new(&both, 4);
        let chart = Chart::new(&field, SIDE, filter, Attachment::of(both.map.texel));
        let wrong: i64 = STRATEGIES.iter().map(|(s, a)| assert_literal(&chart, *s, a)).sum();
        assert!(wrong > 0, "something is wrong somewhere");

        let observed = Observer::new(&both, &both.device.device()).observe_canvas(4);
        let errors = Curve::new(&observed).at(both.bias);
        let question = Question { amounts: &[both.bias], max_acne: 0.001 };
        let swept = sweep(&chart, both.map.texel, Strategy::Constant, &question);
        let tally = swept.points[0].tally;
        let found = [tally.false_shadow() as u64, tally.false_light() as u64];
        assert_eq!(found, [errors.false_shadow, errors.false_light], "{filter}");
    }
}

#[test]
fn a_page_shows_a_case_of_two_maps() {
    let (both, _) = split(&base(Filter::Pcf3));
    let options = Options {
        profile: Profile::Quick,
        which: Which::Own(Box::new(Case { name: "two-maps".to_string(), ..both })),
        ..Options::default()
    };
    let report = documents::report(&options, || ()).expect("a report");
    let cases = report.results["cases"].as_array().expect("a list").len();
    assert_eq!(cases, 1);
    assert!(!report.sections.is_empty());
}

/// Every clip space, and each with and without a far plane where the projection may lack one.
fn in_every_space(case: &Case) -> Vec<Case> {
    let space = |k: u32| ClipSpace {
        range: if k & 1 == 0 { ClipRange::MinusOneToOne } else { ClipRange::ZeroToOne },
        reversed: k & 2 != 0,
        y_down: k & 4 != 0,
    };
    let endless = |projection: Projection| match projection {
        Projection::Perspective { fovy_degrees, aspect, near, .. } => {
            Projection::Perspective { fovy_degrees, aspect, near, far: f64::INFINITY }
        }
        Projection::Orthographic { .. } => projection,
    };
    let light = |k: u32| match k & 8 {
        0 => case.light.clone(),
        _ => case.light.remade(|view| view, endless),
    };
    let directional = case.light.is_directional();
    let spaces = 0..if directional { 8 } else { 16 };
    spaces.map(|k| Case { light: light(k).in_clip_space(space(k)), ..case.clone() }).collect()
}

/// Window depth of a point by the closed form of its map.
fn closed_form(map: &Map, p: DVec3) -> f64 {
    let z = map.axial_distance(p);
    let (near, far) = map.projection.near_far();
    let depth = match (map.is_orthographic(), far.is_infinite()) {
        (true, _) => (z - near) / (far - near),
        (false, true) => 1.0 - near / z,
        (false, false) => far * (z - near) / (z * (far - near)),
    };
    if map.clip.reversed { 1.0 - depth } else { depth }
}

#[test]
fn planes_have_the_depths_of_the_closed_forms_in_every_clip_space() {
    for base in [analytic::spot_plane(0.25, 0.125), analytic::tilted_plane(0.5, 0.25)] {
        for case in in_every_space(&base) {
            let map = *case.light.only_map().expect("one map");
            let device = case.device.device();
            let observer = Observer::new(&case, &device);
            let raster = &observer.subject.map_raster;
            let lens = &observer.lenses[0];
            let (mut checked, size) = (0, raster.layout.side());
            for (texel, &triangle) in raster.triangle.iter().enumerate() {
                let place = [texel as u32 % size, texel as u32 / size].map(f64::from);
                let uv = (glam::DVec2::from(place) + 0.5) / f64::from(size);
                let Some((first, point)) = observer.first_drawn(lens, uv) else { continue };
                if first == triangle {
                    let expected = closed_form(&map, point);
                    let found = f64::from(raster.depth[texel]);
                    assert!((found - expected).abs() < 4e-6, "{map:?}: {found} for {expected}");
                    checked += 1;
                }
            }
            assert!(checked > 1000, "{:?}: {checked} texels", map.clip);
        }
    }
}

#[test]
fn verdicts_do_not_depend_on_how_a_map_writes_depth() {
    for base in [analytic::spot_plane(0.25, 0.125), analytic::plates(), analytic::wall()] {
        let mut all = in_every_space(&base);
        // A bias in window depth means another length where the far plane is gone.
        all.truncate(8);
        let kinds = all.iter().map(|case| {
            let seen = Observer::new(case, &case.device.device()).observe_canvas(5);
            let sure = |o: &&Observation| {
                let margin = f64::from(o.coord[2]) - f64::from(o.taps.depths()[0]);
                o.standing == Standing::Counted && (margin - f64::from(case.bias)).abs() > 1e-5
            };
            let kind = |o: &Observation| (o.pixel, format!("{:?} {:?}", o.outcome, o.caster));
            seen.iter().filter(sure).map(kind).collect::<std::collections::BTreeMap<_, _>>()
        });
        let kinds: Vec<_> = kinds.collect();
        for (other, case) in kinds.iter().zip(&all) {
            let both = kinds[0].iter().filter_map(|(pixel, kind)| Some((kind, other.get(pixel)?)));
            let (mut compared, mut differ) = (0, 0);
            for (a, b) in both {
                compared += 1;
                differ += usize::from(a != b);
            }
            // A texel's edge may fall to either side under another rounding of its vertices.
            let clip = case.light.only_map().expect("one map").clip;
            assert!(
                compared > 1000 && differ * 200 <= compared,
                "{clip:?}: {differ} of {compared}"
            );
        }
    }
}

#[test]
fn sweeps_count_as_the_literal_rule_in_every_clip_space() {
    for base in [analytic::spot_plane(0.25, 0.125), analytic::plates()] {
        let mut wrong = 0;
        for case in in_every_space(&base) {
            let field = Field::new(&case, 9);
            let filter = case.map.texel.usable(case.lookup.filter);
            let chart = Chart::new(&field, 64, filter, Attachment::of(case.map.texel));
            wrong += STRATEGIES.iter().map(|(s, a)| assert_literal(&chart, *s, a)).sum::<i64>();
        }
        assert!(wrong > 0, "{}: something is wrong somewhere", base.name);
    }
}

#[test]
fn what_does_not_fit_is_refused_in_one_sentence() {
    let case = base(Filter::Nearest);
    let [left, right] = halves(&case);
    let message = |maps: Vec<Map>, choice: Choice| {
        case.light.clone().with_maps(maps, choice).unwrap_err().to_string()
    };
    assert!(message(Vec::new(), Choice::Only).contains("light.maps"));
    assert!(
        message(vec![on_layer(left, 0), on_layer(right, 1)], Choice::Only).contains("light.choice")
    );
    let mut turned = right;
    turned.clip.reversed = true;
    let choice = Choice::FirstThatHolds { border: 0.0, blend: 0.0 };
    assert!(message(vec![left, turned], choice.clone()).contains("reverse"));
    let mut outside = right;
    outside.viewport = Viewport { layer: 1, low: [3, 0], high: [2, 1], parts: 4 };
    assert!(message(vec![left, outside], choice.clone()).contains("maps[1].viewport"));
    assert!(message(vec![left, right], choice).contains("overlap"), "one place for both");
}

#[test]
fn a_matrix_from_outside_holds_until_its_map_moves() {
    let view = View { position: DVec3::Y * 8.0, target: DVec3::ZERO, up: DVec3::NEG_Z };
    let projection = Projection::Orthographic { width: 8.0, height: 8.0, near: 0.0, far: 16.0 };
    let odd = glam::Mat4::from_scale(glam::Vec3::splat(0.125));
    let mut map = Map::new(view, projection).with_uploaded(odd);
    assert_eq!(map.matrices()[0], odd);
    map.view.position += DVec3::X;
    assert_eq!(map.uploaded(), None, "it does not stand for the moved map");
    assert_eq!(map.matrices()[0], projection.clip_from_view().as_mat4());
    map.view.position -= DVec3::X;
    assert_eq!(map.uploaded(), Some(odd), "and stands for it again");
}
