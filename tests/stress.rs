//! The verdict table: every row within 5 % of its forecast, and rows that can fail.

use gnomon::report::Profile;
use gnomon::stress::{Fate, Sampling, Stress, document, run};
use std::collections::BTreeSet;
use std::sync::OnceLock;

fn stresses() -> &'static [Stress] {
    static ALL: OnceLock<Vec<Stress>> = OnceLock::new();
    ALL.get_or_init(|| run(&Sampling { samples: 512, seed: 1 }, || ()))
}

#[test]
fn every_onset_is_within_five_per_cent_of_its_forecast() {
    let rows = || stresses().iter().flat_map(|s| &s.rows);
    for row in rows() {
        let f = &row.forecast;
        println!(
            "{:28} {:?} {:?} {:.3e} | {}",
            f.name,
            f.onset,
            row.measured,
            row.relative_error(),
            row.sentence()
        );
    }
    let outside: Vec<_> = rows().filter(|r| !r.agrees()).map(|r| &r.forecast.name).collect();
    assert!(outside.is_empty(), "outside 5 %: {outside:?}");
    assert!(rows().count() >= 45, "{} rows", rows().count());
    let onsets = rows().filter(|r| r.measured.is_some()).count();
    assert!(onsets >= 30, "only {onsets} rows have an onset");
}

#[test]
fn rows_are_named_once_and_their_curves_are_finite() {
    let mut names = BTreeSet::new();
    for row in stresses().iter().flat_map(|s| &s.rows) {
        let name = &row.forecast.name;
        assert!(names.insert(name), "{name} twice");
        assert!(row.curve.len() >= 5 && row.forecast.theory.len() >= 5, "{name} has no curve");
        let points = row.curve.iter().chain(&row.forecast.theory);
        assert!(points.flat_map(|p| [p.0, p.1]).all(f64::is_finite), "{name} is not finite");
        assert!((row.forecast.fate == Fate::Holds) == row.forecast.onset.is_none(), "{name}");
    }
}

/// The transform's error stays below γ₄Σ|m||p| and the sharp staircase below it.
#[test]
fn the_transform_keeps_its_bound() {
    let row = stresses().iter().flat_map(|s| &s.rows).find(|r| r.forecast.name == "f32-transform");
    let row = row.expect("the row");
    for (measured, theory) in row.curve.iter().zip(&row.forecast.theory) {
        // The theory leaves out what is relative to the scene's size, one ulp of the depth itself.
        assert!(measured.1 <= 1.01 * theory.1 + 2e-7, "{measured:?} above {theory:?}");
    }
    assert!(row.note.contains("never exceeds"), "{}", row.note);
}

/// The stored distance errs by the sum of its roundings, at every distance and in every format: never
/// more, and not much less.
#[test]
fn stored_distances_err_by_their_roundings() {
    let mut distances = 0;
    for row in &stresses()[0].rows {
        // Beyond that the format has no step left to speak of: its quantum is as large as the distance.
        let fine = |p: &(&(f64, f64), &(f64, f64))| p.1.1 < 0.02 * p.1.0;
        let pairs: Vec<_> = row.curve.iter().zip(&row.forecast.theory).filter(fine).collect();
        assert!(pairs.len() >= 3, "{}: {} distances", row.forecast.name, pairs.len());
        for (measured, theory) in &pairs {
            let name = &row.forecast.name;
            // Distance is not linear in depth: an error of 2 % is up to 2 % larger on the far side.
            assert!(measured.1 <= 1.025 * theory.1, "{name}: {measured:?} above {theory:?}");
            assert!(measured.1 >= 0.3 * theory.1, "{name}: {measured:?} far below {theory:?}");
        }
        distances += pairs.len();
    }
    assert!(distances > 60, "only {distances} distances were looked at");
}

/// The committed report: small, and the same numbers and bytes again, with one thread too.
#[test]
fn the_report_repeats_itself_and_stays_small() {
    let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let again = alone.install(|| run(&Sampling { samples: 512, seed: 1 }, || ()));
    assert!(again == stresses(), "another number of threads gives other numbers");
    let options = document::StressOptions { profile: Profile::Quick, seed: 1 };
    assert_eq!(options.samples(), 512);
    let files = document::render(&options, &again).files();
    let bytes: usize = files.iter().map(|f| f.bytes.len()).sum();
    assert!(bytes <= 600_000, "{bytes} bytes");
    assert!(files == document::render(&options, stresses()).files(), "bytes differ");
}
