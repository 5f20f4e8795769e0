//! What a scene may cost, and the files that it names beside itself: relative, decoded, given by the caller.

use gnomon_core::size::Size;
use gnomon_core::{Error, Result};
use std::path::{Component, Path, PathBuf};

/// Gives the content of a file that a scene names: a relative path below the scene's folder, and how many
/// bytes it may have at most.
pub type Beside<'b> = dyn Fn(&Path, u64) -> Result<Vec<u8>> + 'b;

gnomon_core::catalogue! {
    /// How a surface with blended alpha throws its shadow, which file formats leave to the engine.
    pub enum Blend {
        /// As if it were opaque (three.js' shadow pass).
        Opaque = "opaque",
        /// Cut out where its alpha is below 0.5.
        Cutout = "cutout",
        /// Not at all.
        None = "none",
    }
}

/// What of a scene file is read where it has more than one answer.
#[derive(Clone, Debug, PartialEq)]
pub struct Wanted {
    /// Name or number of the scene; the file's own choice without it.
    pub scene: Option<String>,
    /// Seconds into the animation at which everything is posed; at rest without it.
    pub time: Option<f64>,
    /// Name or number of the animation; the first without it.
    pub animation: Option<String>,
    /// How surfaces with blended alpha throw shadows.
    pub blend: Blend,
}

/// The file's own scene at rest, blended surfaces as opaque ones.
impl Default for Wanted {
    fn default() -> Self {
        Self { scene: None, time: None, animation: None, blend: Blend::Opaque }
    }
}

/// What a scene may cost, and which of its answers are wanted. Checked before anything is allocated.
#[derive(Clone, Debug, PartialEq)]
pub struct Limits {
    /// Bytes of all files together.
    pub bytes: u64,
    /// Bytes of memory that what is read may take.
    pub memory: u64,
    /// Vertices of all meshes together.
    pub vertices: u64,
    /// Indices of all meshes together.
    pub indices: u64,
    /// Depth of the node tree.
    pub depth: usize,
    /// Leave damaged triangles and nodes out, and note how many, where they would be refused.
    pub lenient: bool,
    /// Scene, time and choices of the reader.
    pub wanted: Wanted,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            bytes: 512 << 20,
            memory: 8 << 30,
            vertices: 100_000_000,
            indices: 200_000_000,
            depth: 1024,
            lenient: false,
            wanted: Wanted::default(),
        }
    }
}

/// Counts against the limits while a scene is read.
#[derive(Clone)]
pub(super) struct Budget<'b> {
    limits: Limits,
    beside: &'b Beside<'b>,
    bytes: u64,
    vertices: u64,
    indices: u64,
}

impl<'b> Budget<'b> {
    /// A budget for a scene whose own file has `bytes`; files that it names come from `beside`.
    ///
    /// # Errors
    /// [`Error::BadInput`] where the file alone is beyond the limit.
    pub(super) fn new(
        place: &str,
        bytes: u64,
        limits: &Limits,
        beside: &'b Beside<'b>,
    ) -> Result<Self> {
        let mut budget = Self { limits: limits.clone(), beside, bytes: 0, vertices: 0, indices: 0 };
        budget.bytes(place, bytes)?;
        Ok(budget)
    }

    /// Refuses what needs more memory than is left to the scene.
    pub(super) fn memory(&self, place: &str, need: u64) -> Result<()> {
        Size(self.limits.memory).afford(place, Size(need), "split or simplify the scene")
    }

    /// Bytes of memory that one thing may take at most.
    pub(super) fn most_memory(&self) -> u64 {
        self.limits.memory
    }

    pub(super) fn wanted(&self) -> &Wanted {
        &self.limits.wanted
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

    /// What a URI stands for: its own data, or a file beside the scene.
    pub(super) fn resource(&mut self, place: &str, uri: &str) -> Result<Vec<u8>> {
        match uri.strip_prefix("data:") {
            Some(data) => {
                let base64 = data.split_once(";base64,").map(|(_, text)| text);
                let reason = "is a data URI without base64";
                let base64 =
                    base64.ok_or_else(|| Error::bad_input(place, reason, "export it again"))?;
                self.data_uri(place, base64)
            }
            None => self.read_beside(place, uri),
        }
    }

    /// Bytes of a `data:` URI, after decoding.
    fn data_uri(&mut self, place: &str, base64: &str) -> Result<Vec<u8>> {
        use base64::Engine as _;
        self.bytes(place, base64.len() as u64)?;
        base64::engine::general_purpose::STANDARD.decode(base64).map_err(|e| {
            Error::bad_input(place, format!("is no base64 ({e})"), "export the buffer again")
        })
    }

    /// A file that a scene names by a relative URI: percent-decoded, then refused unless it leads
    /// downwards from the scene's folder.
    fn read_beside(&mut self, place: &str, uri: &str) -> Result<Vec<u8>> {
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
        let bytes = (self.beside)(&relative, self.limits.bytes - self.bytes)?;
        self.bytes(place, bytes.len() as u64)?;
        Ok(bytes)
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
    fn names_that_lead_elsewhere_are_never_asked_for() {
        let beside = |path: &Path, _: u64| Ok(path.display().to_string().into_bytes());
        let read = |uri: &str| {
            let budget = Budget::new("a.gltf", 0, &Limits::default(), &beside);
            budget.expect("an empty file").read_beside("buffer 0", uri)
        };
        assert_eq!(read("b/./good%20one.bin").expect("inside"), b"b/./good one.bin");
        for uri in
            ["../secret.bin", "%2e%2e/secret.bin", "file:///dev/zero", "/dev/zero", "b/../../c"]
        {
            let message = read(uri).expect_err(uri).to_string();
            assert!(message.contains("outside"), "{uri}: {message}");
        }
    }

    #[test]
    fn limits_count_the_file_and_what_it_names() {
        let beside = |_: &Path, most: u64| Ok(vec![0; most as usize]);
        let limits = Limits { bytes: 1024, ..Limits::default() };
        let budget = |bytes| Budget::new("a.gltf", bytes, &limits, &beside);
        let message = budget(2048).map(|_| ()).expect_err("too big").to_string();
        assert!(message.contains("1024 bytes"), "{message}");
        let left = budget(1000).expect("small").read_beside("buffer 0", "b.bin").expect("the rest");
        assert_eq!(left.len(), 24);
    }
}
