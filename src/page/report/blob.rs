//! Arrays that travel inside the page: differences in byte planes, deflated together, base64.
//!
//! Each value stands as its difference from the one before it (of bit patterns, modulo 2ⁿ), and bytes
//! of equal weight stand together: neighbouring samples share most of their upper bytes. The page
//! inflates with `DecompressionStream` and adds up again, so nothing is lost.

use std::io::Write;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::DeflateEncoder;
use serde::Serialize;

/// Deflate's effort: 7 and above cost half as much again and gain 1 % on reports.
const EFFORT: u32 = 6;

/// Where an array lies in the blob.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub(super) struct Slice {
    /// `f32`, `i32`, `u16` or `u8`.
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
    /// `N` planes of the differences between neighbours, modulo 2^8N.
    fn push<const N: usize>(
        &mut self,
        kind: &'static str,
        patterns: impl Iterator<Item = u32>,
    ) -> Slice {
        let offset = self.bytes.len();
        let mut last = 0u32;
        let differences: Vec<[u8; 4]> = patterns
            .map(|pattern| {
                pattern.wrapping_sub(std::mem::replace(&mut last, pattern)).to_le_bytes()
            })
            .collect();
        for plane in 0..N {
            self.bytes.extend(differences.iter().map(|bytes| bytes[plane]));
        }
        Slice { kind, offset, length: differences.len() }
    }

    pub(super) fn floats(&mut self, values: impl Iterator<Item = f32>) -> Slice {
        self.push::<4>("f32", values.map(f32::to_bits))
    }

    pub(super) fn integers(&mut self, values: &[i32]) -> Slice {
        self.push::<4>("i32", values.iter().map(|v| v.cast_unsigned()))
    }

    pub(super) fn ranks(&mut self, values: impl Iterator<Item = u16>) -> Slice {
        self.push::<2>("u16", values.map(u32::from))
    }

    pub(super) fn bytes(&mut self, values: impl Iterator<Item = u8>) -> Slice {
        let offset = self.bytes.len();
        self.bytes.extend(values);
        Slice { kind: "u8", offset, length: self.bytes.len() - offset }
    }

    /// Raw deflate, then base64.
    pub(super) fn to_text(&self) -> String {
        let mut encoder = DeflateEncoder::new(Vec::new(), Compression::new(EFFORT));
        encoder.write_all(&self.bytes).expect("memory takes what is written");
        STANDARD.encode(encoder.finish().expect("memory takes what is written"))
    }
}
