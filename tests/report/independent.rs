//! The written EXR through another reader's eyes: OpenEXR's own bindings for Python.

use std::process::Command;

use crate::sample;

/// `GNOMON_PYTHON` names a Python that has `openexr` and `numpy`.
#[test]
#[ignore = "needs the PyPI package openexr; .ci/run installs it"]
fn openexr_reads_the_same_bits() {
    let scratch = tempfile::tempdir().unwrap();
    let (image, planes) = (scratch.path().join("sample.exr"), scratch.path().join("planes"));
    let written = sample::exr();
    std::fs::write(&image, written.to_exr()).unwrap();
    std::fs::create_dir(&planes).unwrap();
    for (name, values) in &written.channels {
        let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        std::fs::write(planes.join(name), bytes).unwrap();
    }
    let python = std::env::var("GNOMON_PYTHON").unwrap_or_else(|_| "python3".to_string());
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/exr/read_back.py");
    let run = || Command::new(&python).arg(script).arg(&image).arg(&planes).status().unwrap();
    assert!(run().success());
    std::fs::write(planes.join("R"), [0; 4]).unwrap();
    assert!(!run().success(), "a changed plane is seen");
}
