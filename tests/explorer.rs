//! The page's explorers say what the analysis says, at the documents' biases and at any other.

use gnomon::analysis::documents::{Options, Which, report};
use gnomon::analysis::measure::measure;
use gnomon::depth::{DepthFormat, Packing};
use gnomon::report::explorer::Explorer;
use gnomon::report::{Block, Profile, Report};
use gnomon::scene::{Filter, TexelFormat, cases};

fn documents() -> Report {
    let options = Options { profile: Profile::Quick, ..Options::default() };
    report(&options, || {}).unwrap()
}

fn explorers(report: &Report) -> Vec<&Explorer> {
    let blocks = report.blocks();
    blocks.filter_map(|b| if let Block::Explorer(e) = b { Some(e) } else { None }).collect()
}

#[test]
fn counts_at_the_documents_bias_are_the_reports() {
    let report = documents();
    let cases = report.results["cases"].as_array().unwrap();
    let explorers = explorers(&report);
    assert_eq!(explorers.len(), cases.len());
    for (explorer, case) in explorers.iter().zip(cases) {
        let tally = explorer.tally(&explorer.views[0], explorer.slider.value);
        let count = |side: &str| case[side]["count"].as_u64().unwrap();
        assert_eq!(tally.false_shadow.0, count("false_shadow"), "{}", explorer.id);
        assert_eq!(tally.false_light.0, count("false_light"), "{}", explorer.id);
        for (class, shown) in explorer.classes.iter().zip(&tally.classes) {
            let name = class.name.replace(' ', "-");
            let of = |side: &str| case[side]["by_artifact"][&name].as_u64();
            if let (Some(shadow), Some(light)) = (of("false_shadow"), of("false_light")) {
                assert_eq!(*shown, shadow + light, "{} of {}", class.name, explorer.id);
            }
        }
        if explorer.views[0].detail.every == 1 {
            let cause = |name: &str| -> u64 {
                let sides = ["false_shadow", "false_light"];
                sides.iter().map(|s| case[*s]["by_cause"][name].as_u64().unwrap()).sum()
            };
            let names = ["culling", "bias", "sampling", "arithmetic", "quantization", "filter"];
            assert_eq!(tally.causes, names.map(cause), "causes of {}", explorer.id);
        }
    }
}

#[test]
fn counts_at_any_bias_are_the_curves() {
    let report = documents();
    for (explorer, case) in explorers(&report).iter().zip(cases::main_job()) {
        let (view, curve) = (&explorer.views[0], measure(&case, 4).curve);
        let breakpoints = view.breakpoints.iter().filter(|b| b.is_finite()).step_by(331);
        for bias in breakpoints.flat_map(|b| [b.next_down(), *b, b.next_up()]).chain([0.0, 1.0]) {
            let (tally, errors) = (explorer.tally(view, bias), curve.at(bias));
            assert_eq!(tally.false_shadow.0, errors.false_shadow, "{} at {bias:e}", explorer.id);
            assert_eq!(tally.false_light.0, errors.false_light, "{} at {bias:e}", explorer.id);
        }
    }
}

/// Filters may leave out taps that weigh nothing, so receivers have different numbers of them.
#[test]
fn every_filter_is_explored_and_no_tap_is_lost() {
    for &filter in Filter::ALL {
        for format in [TexelFormat::Depth(DepthFormat::Unorm16), TexelFormat::Packed(Packing::Book)]
        {
            let mut case = cases::named("fundamentals-spot").unwrap();
            (case.canvas, case.map.size, case.map.texel) = ([60, 40], 64, format);
            case.lookup.filter = filter;
            let options =
                Options { which: Which::Own(Box::new(case.clone())), ..Options::default() };
            let report = report(&options, || {}).unwrap();
            assert!(report.files().len() > 10, "{filter} is written");
            let explorer = explorers(&report)[0];
            let (view, measured) = (&explorer.views[0], measure(&case, 1));
            let most = measured.observations.iter().map(|o| o.breakpoints.len()).max();
            assert_eq!(Some(view.taps), most, "{filter}");
            let some = view.breakpoints.iter().filter(|b| b.is_finite()).step_by(97);
            for bias in some.flat_map(|b| [b.next_down(), *b]).chain([0.0, 1.0]) {
                let (tally, errors) = (explorer.tally(view, bias), measured.curve.at(bias));
                assert_eq!(tally.false_shadow.0, errors.false_shadow, "{filter} at {bias:e}");
                assert_eq!(tally.false_light.0, errors.false_light, "{filter} at {bias:e}");
            }
        }
    }
}
