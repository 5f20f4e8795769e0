//! `EXT_meshopt_compression` and `KHR_meshopt_compression`: buffer views decoded before the document is read.
//!
//! The bitstreams are those of the extensions' specifications (attributes 0 and 1, triangles, indices,
//! and the filters octahedral, quaternion, exponential and colour).

mod filters;
mod indices;
mod vertices;

use super::super::files::Budget;
use super::buffers::{Buffers, add_view};
use gltf::json;
use gnomon_core::{Error, Result};
use serde_json::Value;

/// The names under which files have it.
pub(super) const NAMES: [&str; 2] = ["EXT_meshopt_compression", "KHR_meshopt_compression"];

/// How a buffer view is compressed; `None` where it is not.
pub(super) fn extension(view: &json::buffer::View) -> Option<&Value> {
    let others = &view.extensions.as_ref()?.others;
    NAMES.iter().find_map(|name| others.get(*name))
}

/// Decodes every compressed buffer view into a buffer of its own, which the view then shows.
pub(super) fn unpack(
    place: &str,
    root: &mut json::Root,
    buffers: &mut Buffers<'_>,
    budget: &Budget<'_>,
) -> Result<()> {
    for v in 0..root.buffer_views.len() {
        let Some(view) = root.buffer_views.get(v) else { continue };
        let Some(extension) = extension(view).cloned() else { continue };
        let at = format!("{place}: bufferViews[{v}]");
        let fix = "decode it with `gltf-transform copy`, or export it again";
        let bad = |reason: &str| Error::bad_input(&at, reason, fix);
        let stream =
            Stream::of(&extension).ok_or_else(|| bad("its compression is not complete"))?;
        budget.memory(&at, (stream.count as u64).saturating_mul(stream.stride as u64))?;
        let bytes = stream.decode(buffers).map_err(bad)?;
        let decoded = add_view(root, buffers, bytes).value();
        let decoded = root.buffer_views.get(decoded).cloned();
        if let Some((to, decoded)) = root.buffer_views.get_mut(v).zip(decoded) {
            to.byte_stride = to.byte_stride.map(|_| json::buffer::Stride(stream.stride));
            to.buffer = decoded.buffer;
            (to.byte_offset, to.byte_length) = (None, decoded.byte_length);
        }
    }
    Ok(())
}

/// A compressed stream and what it holds.
struct Stream<'j> {
    buffer: usize,
    offset: u64,
    length: u64,
    stride: usize,
    count: usize,
    mode: &'j str,
    filter: &'j str,
}

impl<'j> Stream<'j> {
    fn of(extension: &'j Value) -> Option<Self> {
        let number = |key: &str| extension.get(key)?.as_u64();
        let size = |key: &str| usize::try_from(number(key)?).ok();
        Some(Self {
            buffer: size("buffer")?,
            offset: number("byteOffset").unwrap_or(0),
            length: number("byteLength")?,
            stride: size("byteStride")?,
            count: size("count")?,
            mode: extension.get("mode")?.as_str()?,
            filter: extension.get("filter").and_then(Value::as_str).unwrap_or("NONE"),
        })
    }

    fn decode(&self, buffers: &Buffers<'_>) -> std::result::Result<Vec<u8>, &'static str> {
        let stream = buffers.range(self.buffer, self.offset, self.length);
        let stream = stream.ok_or("its compressed bytes lie beyond their buffer")?;
        const BROKEN: &str = "its compressed bytes are damaged";
        let words = |indices: Vec<u32>| match self.stride {
            2 => Ok(indices.into_iter().flat_map(|i| (i as u16).to_le_bytes()).collect()),
            4 => Ok(indices.into_iter().flat_map(u32::to_le_bytes).collect()),
            _ => Err("its indices have neither 2 nor 4 bytes"),
        };
        match self.mode {
            "ATTRIBUTES" => {
                let mut bytes = vertices::decode(stream, self.count, self.stride).ok_or(BROKEN)?;
                filters::apply(self.filter, &mut bytes, self.stride)?;
                Ok(bytes)
            }
            "TRIANGLES" => words(indices::triangles(stream, self.count).ok_or(BROKEN)?),
            "INDICES" => words(indices::sequence(stream, self.count).ok_or(BROKEN)?),
            _ => Err("its compression has a mode that is not known"),
        }
    }
}

/// Bytes of a stream from the first to the last, none twice.
struct Bytes<'a>(&'a [u8]);

impl<'a> Bytes<'a> {
    fn take(&mut self, count: usize) -> Option<&'a [u8]> {
        let (taken, rest) = self.0.split_at_checked(count)?;
        self.0 = rest;
        Some(taken)
    }

    fn byte(&mut self) -> Option<u8> {
        let (first, rest) = self.0.split_first()?;
        self.0 = rest;
        Some(*first)
    }
}
