//! The page in a real browser: writes reports with what Rust expects of them, then lets
//! `tests/browser/run.mjs` compare. Needs `npm ci --prefix tests/browser` and Chromium.
#![allow(clippy::wildcard_enum_match_arm, reason = "singles one member out")]

use std::path::Path;
use std::process::Command;

use gnomon::analysis::documents::{Options, report};
use gnomon::conformance::device_json;
use gnomon::device::DeviceProfile;
use gnomon::report::explorer::{Explorer, Values};
use gnomon::report::{Block, Profile, Report, Section};
use rayon::prelude::*;
use serde_json::{Value, json};

use crate::explored::{self, Random};
use crate::sample;

/// Slider values that are hard: breakpoints themselves, their neighbours, zero, and any f32.
fn biases(explorer: &Explorer, count: usize) -> Vec<f32> {
    let mut random = Random::new(7);
    let finite: Vec<f32> =
        explorer.views.iter().flat_map(|view| &view.breakpoints).copied().collect();
    let pick = |index: usize| {
        let breakpoint = finite[random.next() as usize % finite.len()].clamp(0.0, 1.0);
        match index % 4 {
            0 => breakpoint,
            1 => breakpoint.next_up(),
            2 => breakpoint.next_down().max(0.0),
            _ => f32::from_bits(random.next() as u32 % 1.0_f32.to_bits()),
        }
    };
    std::iter::once(0.0).chain((1..count).map(pick)).collect()
}

/// The inspector's numbers of a field and how far the page may be from them; missing is null.
fn field(explorer: &Explorer, values: &Values) -> Value {
    let fields = &explorer.views[0].detail.fields;
    let numbers = |index: usize| match &fields[index].values {
        Values::Numbers(values) => values.iter().map(|v| f64::from(*v)).collect::<Vec<_>>(),
        _ => panic!("a difference is of numbers"),
    };
    match values {
        Values::Numbers(values) => json!({ "values": values, "within": 0.0 }),
        Values::Integers(values) => json!({ "values": values, "within": 0.0 }),
        Values::Names(codes, _) => json!({ "values": codes, "within": 0.0 }),
        Values::Rounded(values) => {
            let finite = || values.iter().copied().filter(|v| v.is_finite());
            let range =
                finite().fold(f32::NEG_INFINITY, f32::max) - finite().fold(f32::INFINITY, f32::min);
            json!({ "values": values, "within": f64::from(range) / 131_000.0 })
        }
        Values::Difference(a, b) => {
            let values: Vec<f64> =
                numbers(*a).iter().zip(numbers(*b)).map(|(a, b)| a - b).collect();
            json!({ "values": values, "within": 0.0 })
        }
    }
}

/// What `explorer` of the report in `folder` counts at `count` biases.
fn expected(folder: &str, explorer: &Explorer, count: usize) -> Value {
    let at = |bias: &f32| -> Value {
        let tallies = explorer.views.iter().map(|view| explorer.tally(view, *bias));
        let tally = |t: gnomon::report::explorer::Tally| {
            let (shadow, light) = (t.false_shadow, t.false_light);
            json!({
                "classes": t.classes, "causes": t.causes,
                "false_shadow": [shadow.0, shadow.1], "false_light": [light.0, light.1],
            })
        };
        json!({ "bits": bias.to_bits(), "views": tallies.map(tally).collect::<Vec<_>>() })
    };
    let picture = |bias: f32| explorer.picture(&explorer.views[0], bias);
    json!({
        "folder": folder,
        "id": explorer.id,
        "at": biases(explorer, count).par_iter().map(at).collect::<Vec<_>>(),
        "fields": explorer.views[0].detail.fields.iter().map(|f| field(explorer, &f.values)).collect::<Vec<_>>(),
        "picture": picture(explorer.slider.value),
    })
}

fn with(explorer: Explorer) -> Report {
    let mut section = Section::new("only", "Only", "");
    section.push(explorer);
    Report { sections: vec![section], name: "large".into(), ..sample::report() }
}

/// The quick report of the documents, as it is committed.
fn documents() -> Report {
    let options = Options { profile: Profile::Quick, ..Options::default() };
    report(&options, || {}).unwrap()
}

#[test]
#[ignore = "needs Chromium, Node and npm ci --prefix tests/browser"]
fn pages_work_in_a_browser() {
    let scratch = tempfile::tempdir().unwrap();
    let at = |name: &str| scratch.path().join(name);
    let small = explored::explorer("small", (96, 80));
    let large = explored::explorer("large", (512, 512));
    let documents = documents();
    let mut all = vec![expected("sample", &small, 1000), expected("large", &large, 20)];
    all.extend(documents.blocks().filter_map(|block| match block {
        Block::Explorer(explorer) => Some(expected("documents", explorer, 1000)),
        _ => None,
    }));
    assert!(all.len() >= 2 + 13, "only {} explorers", all.len());
    sample::report().write(&at("sample")).unwrap();
    with(large).write(&at("large")).unwrap();
    documents.write(&at("documents")).unwrap();
    std::fs::write(at("expected.json"), json!(all).to_string()).unwrap();
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/browser/run.mjs");
    let status = Command::new("node").arg(script).arg(scratch.path()).status().unwrap();
    assert!(status.success(), "the browser disagrees; see above");
    the_copied_json_is_the_emulated_profile(&at("device.json"));
}

/// What the panel copied under SwiftShader is the profile that conformance found in its dumps.
fn the_copied_json_is_the_emulated_profile(path: &Path) {
    let measured = device_json::read(path).unwrap();
    let emulated = DeviceProfile::WebglSwiftshader;
    assert_eq!(measured.missing, ["setup"], "the panel cannot see how planes are set up");
    assert_eq!(measured.differing(emulated), [""; 0]);
    assert_eq!(measured.nearest()[0], emulated);
}
