//! Reports become files: complete, self-contained, reproducible, readable.

mod sample;

use std::path::Path;

use gnomon::output::{self, OutFile};

fn file<'a>(files: &'a [OutFile], name: &str) -> &'a OutFile {
    files.iter().find(|file| file.name == name).unwrap_or_else(|| panic!("{name} is missing"))
}

fn text(files: &[OutFile], name: &str) -> String {
    String::from_utf8(file(files, name).bytes.clone()).unwrap()
}

#[test]
fn every_block_becomes_its_files() {
    let files = sample::report().files();
    let expected = [
        "exr/exr-sample.exr",
        "pictures/classes.png",
        "plots/trade-off.png",
        "plots/trade-off.svg",
        "report.json",
        "results.csv",
        "results.json",
        "tables/heat.csv",
        "tables/rates.csv",
        "index.html",
        "manifest.json",
    ];
    for name in expected {
        assert!(!file(&files, name).bytes.is_empty(), "{name} is empty");
    }
}

/// Set `GNOMON_LOOK=DIR` to keep the report for looking at.
#[test]
fn written_files_verify_and_indexes_list_them() {
    let scratch = tempfile::tempdir().unwrap();
    let kept = std::env::var_os("GNOMON_LOOK");
    let root = kept.as_deref().map_or(scratch.path(), Path::new);
    let written = sample::report().write(&root.join("sample")).unwrap();
    assert_eq!(output::verify(&written.folder).unwrap(), written.files.len() - 1);
    let index = gnomon::report::write_index(root).unwrap();
    let index = std::fs::read_to_string(index).unwrap();
    assert!(index.contains("sample/index.html") && index.contains("headroom −0.0016"));
}

#[test]
fn the_same_report_gives_the_same_bytes_with_any_number_of_threads() {
    let files = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| sample::report().files())
    };
    let (one, eight) = (files(1), files(8));
    assert_eq!(one.len(), eight.len());
    for (a, b) in one.iter().zip(&eight) {
        assert_eq!(a.name, b.name);
        assert!(a.bytes == b.bytes, "{} differs between 1 and 8 threads", a.name);
    }
}
