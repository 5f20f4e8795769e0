//! Reading files under limits, and only inside the scene's own folder.

use crate::{Error, Result, input};
use std::fs;
use std::path::{Component, Path, PathBuf};

/// What a scene may cost. Checked before anything is allocated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Bytes of all files together.
    pub bytes: u64,
    /// Vertices of all meshes together.
    pub vertices: u64,
    /// Indices of all meshes together.
    pub indices: u64,
    /// Depth of the node tree.
    pub depth: usize,
    /// Leave damaged triangles and nodes out, and note how many, where they would be refused.
    pub lenient: bool,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            bytes: 512 << 20,
            vertices: 100_000_000,
            indices: 200_000_000,
            depth: 1024,
            lenient: false,
        }
    }
}

/// Counts against the limits while a scene is read.
#[derive(Clone, Debug)]
pub(super) struct Budget {
    limits: Limits,
    bytes: u64,
    vertices: u64,
    indices: u64,
}

impl Budget {
    pub(super) fn new(limits: &Limits) -> Self {
        Self { limits: *limits, bytes: 0, vertices: 0, indices: 0 }
    }

    pub(super) fn depth(&self) -> usize {
        self.limits.depth
    }

    pub(super) fn is_lenient(&self) -> bool {
        self.limits.lenient
    }

    fn spend(place: &str, what: &str, spent: &mut u64, more: u64, limit: u64) -> Result<()> {
        let total = spent.checked_add(more).filter(|&t| t <= limit).ok_or_else(|| {
            Error::bad_input(
                place,
                format!("needs more than the {limit} {what} allowed"),
                "split or simplify the scene",
            )
        })?;
        *spent = total;
        Ok(())
    }

    pub(super) fn vertices(&mut self, place: &str, more: u64) -> Result<()> {
        Self::spend(place, "vertices", &mut self.vertices, more, self.limits.vertices)
    }

    pub(super) fn indices(&mut self, place: &str, more: u64) -> Result<()> {
        Self::spend(place, "indices", &mut self.indices, more, self.limits.indices)
    }

    fn bytes(&mut self, place: &str, more: u64) -> Result<()> {
        Self::spend(place, "bytes", &mut self.bytes, more, self.limits.bytes)
    }

    /// Bytes of a `data:` URI, after decoding.
    pub(super) fn data_uri(&mut self, place: &str, base64: &str) -> Result<Vec<u8>> {
        use base64::Engine as _;
        self.bytes(place, base64.len() as u64)?;
        base64::engine::general_purpose::STANDARD.decode(base64).map_err(|e| {
            Error::bad_input(place, format!("is no base64 ({e})"), "export the buffer again")
        })
    }

    /// A regular file's content, within what is left of the limit; pipes and devices are refused.
    pub(super) fn read(&mut self, path: &Path) -> Result<Vec<u8>> {
        let bytes = input::read(path, self.limits.bytes - self.bytes)?;
        self.bytes(&path.display().to_string(), bytes.len() as u64)?;
        Ok(bytes)
    }

    /// A file that a scene names by a relative URI: percent-decoded, then refused unless it lies
    /// inside the scene's folder, links resolved.
    pub(super) fn read_beside(&mut self, scene: &Path, place: &str, uri: &str) -> Result<Vec<u8>> {
        let outside = || {
            Error::bad_input(
                place,
                format!("'{uri}' leads outside the scene's folder"),
                "keep buffers beside the scene",
            )
        };
        if uri.contains(':') {
            return Err(outside());
        }
        let name = percent_decoded(uri).ok_or_else(|| {
            Error::bad_input(place, format!("'{uri}' is no UTF-8 path"), "rename the buffer")
        })?;
        let relative = PathBuf::from(name);
        if !relative.components().all(|c| matches!(c, Component::Normal(_) | Component::CurDir)) {
            return Err(outside());
        }
        let folder = match scene.parent() {
            Some(parent) if !parent.as_os_str().is_empty() => parent,
            _ => Path::new("."),
        };
        let path = folder.join(relative);
        let resolve = |p: &Path| fs::canonicalize(p).map_err(|e| Error::read(p, e));
        if !resolve(&path)?.starts_with(resolve(folder)?) {
            return Err(outside());
        }
        self.read(&path)
    }
}

/// `%41` → `A`; `None` where the result is not UTF-8 or an escape is broken.
fn percent_decoded(uri: &str) -> Option<String> {
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.bytes();
    while let Some(b) = rest.next() {
        if b == b'%' {
            let hex = [rest.next()?, rest.next()?];
            bytes.push(u8::from_str_radix(std::str::from_utf8(&hex).ok()?, 16).ok()?);
        } else {
            bytes.push(b);
        }
    }
    String::from_utf8(bytes).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn escapes_are_decoded_once() {
        assert_eq!(percent_decoded("a%20b.bin").as_deref(), Some("a b.bin"));
        assert_eq!(percent_decoded("%2e%2e/x").as_deref(), Some("../x"));
        assert_eq!(percent_decoded("%FF%FE.bin"), None);
        assert_eq!(percent_decoded("%4"), None);
    }

    #[test]
    fn nothing_outside_the_folder_is_read() {
        let outer = tempfile::tempdir().expect("a folder");
        let folder = outer.path().join("scene");
        fs::create_dir(&folder).expect("a folder");
        fs::write(outer.path().join("secret.bin"), "secret").expect("a file");
        fs::write(folder.join("good.bin"), "good").expect("a file");
        let scene = folder.join("scene.gltf");
        let read = |uri: &str| Budget::new(&Limits::default()).read_beside(&scene, "buffer 0", uri);
        assert_eq!(read("good.bin").expect("inside"), b"good");
        let absolute = outer.path().join("secret.bin").display().to_string();
        for uri in
            ["../secret.bin", "%2e%2e/secret.bin", "file:///dev/zero", "/dev/zero", &absolute]
        {
            let message = read(uri).expect_err(uri).to_string();
            assert!(message.contains("outside"), "{uri}: {message}");
        }
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink("../secret.bin", folder.join("link.bin")).expect("a link");
            assert!(read("link.bin").expect_err("a link").to_string().contains("outside"));
        }
    }

    #[test]
    fn limits_come_before_reading() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("big.bin");
        fs::write(&path, vec![0; 2048]).expect("a file");
        let limits = Limits { bytes: 1024, ..Limits::default() };
        let message = Budget::new(&limits).read(&path).expect_err("too big").to_string();
        assert!(message.contains("1024 bytes"), "{message}");
    }
}
