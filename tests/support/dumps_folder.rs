//! A folder of WebGL dumps: the one that GNOMON_WEBGL names, or the committed compressed subset.

use flate2::read::GzDecoder;
use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};

/// The committed subset, unpacked into a folder of its own.
pub(crate) struct Subset(pub(crate) tempfile::TempDir);

impl Subset {
    pub(crate) fn unpack() -> Self {
        let target = tempfile::tempdir().expect("a temporary folder");
        let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures/dumps");
        unpack(&source, target.path());
        Self(target)
    }

    pub(crate) fn path(&self) -> &Path {
        self.0.path()
    }
}

fn unpack(from: &Path, to: &Path) {
    fs::create_dir_all(to).expect("a folder inside the temporary one");
    for entry in fs::read_dir(from).expect("the fixtures are committed") {
        let path = entry.expect("a readable folder").path();
        let target = to.join(path.file_stem().expect("a name"));
        if path.is_dir() {
            unpack(&path, &to.join(path.file_name().expect("a name")));
        } else {
            let mut bytes = Vec::new();
            GzDecoder::new(fs::File::open(&path).expect("a fixture"))
                .read_to_end(&mut bytes)
                .expect("a whole fixture");
            fs::write(target, bytes).expect("room for the fixture");
        }
    }
}

/// The whole folder of dumps, if GNOMON_WEBGL names one; says so where it does not.
#[allow(dead_code, reason = "not every test file uses the whole dumps")]
pub(crate) fn whole_dumps(test: &str) -> Option<PathBuf> {
    let folder = std::env::var_os("GNOMON_WEBGL").map(PathBuf::from);
    if folder.is_none() {
        println!("SKIPPED {test}: set GNOMON_WEBGL to a folder of dumps");
    }
    folder
}
