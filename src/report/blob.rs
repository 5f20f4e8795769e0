//! Arrays that travel inside the page: byte planes, deflated together, base64.
//!
//! Bytes of equal weight stand together (all lowest bytes, then the next…), since neighbouring
//! values share their upper bytes. The page inflates them with `DecompressionStream`.

use std::io::Write;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::DeflateEncoder;
use serde::Serialize;

/// Where an array lies in the blob.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub(super) struct Slice {
    /// `f32`, `i32` or `u8`.
    kind: &'static str,
    /// First byte.
    offset: usize,
    /// Elements.
    length: usize,
}

/// Arrays one after another.
#[derive(Debug, Default)]
pub(super) struct Blob {
    bytes: Vec<u8>,
}

impl Blob {
    fn push<const N: usize>(
        &mut self,
        kind: &'static str,
        values: impl Iterator<Item = [u8; N]> + Clone,
    ) -> Slice {
        let offset = self.bytes.len();
        let length = values.clone().count();
        for plane in 0..N {
            self.bytes.extend(values.clone().map(|bytes| bytes[plane]));
        }
        Slice { kind, offset, length }
    }

    pub(super) fn floats(&mut self, values: impl Iterator<Item = f32> + Clone) -> Slice {
        self.push("f32", values.map(f32::to_le_bytes))
    }

    pub(super) fn integers(&mut self, values: &[i32]) -> Slice {
        self.push("i32", values.iter().map(|v| v.to_le_bytes()))
    }

    pub(super) fn bytes(&mut self, values: impl Iterator<Item = u8> + Clone) -> Slice {
        self.push("u8", values.map(|v| [v]))
    }

    /// Raw deflate, then base64.
    pub(super) fn to_text(&self) -> String {
        let mut encoder = DeflateEncoder::new(Vec::new(), Compression::new(7));
        encoder.write_all(&self.bytes).expect("memory takes what is written");
        STANDARD.encode(encoder.finish().expect("memory takes what is written"))
    }
}
