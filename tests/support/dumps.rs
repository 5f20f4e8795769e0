//! What several test files share: fixtures, whole or the small copies that are committed.
#![allow(dead_code, reason = "each test file uses its part")]

use std::io::Read;
use std::path::{Path, PathBuf};

/// The folder with the whole dumps, where `GNOMON_WEBGL` names it.
pub(crate) fn whole_dumps() -> Option<PathBuf> {
    std::env::var_os("GNOMON_WEBGL").map(PathBuf::from)
}

/// The bytes of a dump: the whole one where `GNOMON_WEBGL` is set, else the committed copy of every
/// n-th sample.
pub(crate) fn dump(name: &str) -> Vec<u8> {
    if let Some(folder) = whole_dumps() {
        let path = folder.join(name);
        return std::fs::read(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    }
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures/webgl");
    let path = path.join(format!("{name}.gz"));
    let packed = std::fs::read(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let mut bytes = Vec::new();
    flate2::read::GzDecoder::new(&packed[..]).read_to_end(&mut bytes).expect("a gzip file");
    bytes
}

/// A dump of little-endian f32.
pub(crate) fn floats(name: &str) -> Vec<f32> {
    let bytes = dump(name);
    bytes.chunks_exact(4).map(|b| f32::from_le_bytes(b.try_into().expect("four bytes"))).collect()
}

/// Says once that the committed copies stand in for the whole dumps.
pub(crate) fn say_which_dumps(test: &str) {
    if whole_dumps().is_none() {
        println!("{test}: GNOMON_WEBGL is unset, the committed every-n-th copies are compared");
    }
}
