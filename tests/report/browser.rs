//! The page in a real browser: writes reports with what Rust expects of them, then lets
//! `tests/browser/run.mjs` compare. Needs `npm ci --prefix tests/browser` and Chromium.

use std::path::Path;
use std::process::Command;

use gnomon::report::explorer::Explorer;
use gnomon::report::{Report, Section};
use serde_json::{Value, json};

use crate::explored::{self, Random};
use crate::sample;

/// Slider values that are hard: breakpoints themselves, their neighbours, zero, and any f32.
fn biases(explorer: &Explorer, count: usize) -> Vec<f32> {
    let mut random = Random(7);
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

fn expected(explorer: &Explorer, count: usize) -> Value {
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
        "id": explorer.id,
        "at": biases(explorer, count).iter().map(at).collect::<Vec<_>>(),
        "picture": picture(explorer.slider.value),
    })
}

fn with(explorer: Explorer) -> Report {
    let mut section = Section::new("only", "Only", "");
    section.push(explorer);
    Report { sections: vec![section], name: "large".into(), ..sample::report() }
}

#[test]
#[ignore = "needs Chromium, Node and npm ci --prefix tests/browser"]
fn pages_work_in_a_browser() {
    let scratch = tempfile::tempdir().unwrap();
    let small = explored::explorer("small", (96, 80));
    let large = explored::explorer("large", (512, 512));
    let expected = json!([expected(&small, 1000), expected(&large, 20)]);
    sample::report().write(&scratch.path().join("sample")).unwrap();
    with(large).write(&scratch.path().join("large")).unwrap();
    std::fs::write(scratch.path().join("expected.json"), expected.to_string()).unwrap();
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/browser/run.mjs");
    let status = Command::new("node").arg(script).arg(scratch.path()).status().unwrap();
    assert!(status.success(), "the browser disagrees; see above");
}
