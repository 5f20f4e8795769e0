//! glTF accessors read with checked arithmetic: every offset is proved inside its buffer first.

use glam::Vec3;
use gltf::accessor::{DataType, Dimensions};
use gnomon_core::{Error, Result};

/// The bytes of an accessor: start, stride and element size are known to fit.
struct Elements<'a> {
    bytes: &'a [u8],
    stride: usize,
    count: usize,
}

impl Elements<'_> {
    /// Each element of N bytes as `read` reads it.
    fn read<T, const N: usize>(&self, read: impl Fn([u8; N]) -> T) -> Vec<T> {
        let element = |i: usize| self.bytes.get(i * self.stride..)?.first_chunk().copied();
        (0..self.count).map_while(element).map(read).collect()
    }
}

fn elements<'a>(
    place: &str,
    accessor: &gltf::Accessor<'_>,
    buffers: &'a [Vec<u8>],
) -> Result<Elements<'a>> {
    let bad = |reason: String| Error::bad_input(place, reason, "export the scene again");
    if accessor.sparse().is_some() {
        return Err(bad("is a sparse accessor, which is not supported".into()));
    }
    let view = accessor.view().ok_or_else(|| bad("has no buffer view".into()))?;
    let size = accessor.size() as u64;
    let stride = view.stride().map_or(size, |s| s as u64);
    let count = accessor.count() as u64;
    if count == 0 || stride < size {
        return Err(bad(format!(
            "has count {count} and stride {stride} for elements of {size} bytes"
        )));
    }
    let length = (count - 1).checked_mul(stride).and_then(|n| n.checked_add(size));
    let start = (view.offset() as u64).checked_add(accessor.offset() as u64);
    let within_view = length
        .and_then(|n| n.checked_add(accessor.offset() as u64))
        .is_some_and(|end| end <= view.length() as u64);
    let buffer = buffers.get(view.buffer().index()).map_or(&[][..], Vec::as_slice);
    let range = start.zip(length).and_then(|(s, n)| {
        let end = s.checked_add(n)?;
        buffer.get(usize::try_from(s).ok()?..usize::try_from(end).ok()?)
    });
    match range {
        Some(bytes) if within_view => {
            Ok(Elements { bytes, stride: stride as usize, count: count as usize })
        }
        _ => Err(bad(format!("reads beyond its buffer of {} bytes", buffer.len()))),
    }
}

/// Number of elements, for limits, before anything is read.
pub(super) fn count(accessor: &gltf::Accessor<'_>) -> u64 {
    accessor.count() as u64
}

/// Positions: three floats each.
pub(super) fn positions(
    place: &str,
    accessor: &gltf::Accessor<'_>,
    buffers: &[Vec<u8>],
) -> Result<Vec<Vec3>> {
    if (accessor.data_type(), accessor.dimensions()) != (DataType::F32, Dimensions::Vec3) {
        return Err(Error::bad_input(
            place,
            "positions are not three floats each",
            "export without mesh quantization",
        ));
    }
    let elements = elements(place, accessor, buffers)?;
    Ok(elements.read(|[a, b, c, d, e, f, g, h, i, j, k, l]| {
        Vec3::from_array([[a, b, c, d], [e, f, g, h], [i, j, k, l]].map(f32::from_le_bytes))
    }))
}

/// Indices: one unsigned integer of 8, 16 or 32 bits each.
pub(super) fn indices(
    place: &str,
    accessor: &gltf::Accessor<'_>,
    buffers: &[Vec<u8>],
) -> Result<Vec<u32>> {
    let elements = || elements(place, accessor, buffers);
    match (accessor.data_type(), accessor.dimensions()) {
        (DataType::U8, Dimensions::Scalar) => Ok(elements()?.read(|[b]| u32::from(b))),
        (DataType::U16, Dimensions::Scalar) => {
            Ok(elements()?.read(|b| u32::from(u16::from_le_bytes(b))))
        }
        (DataType::U32, Dimensions::Scalar) => Ok(elements()?.read(u32::from_le_bytes)),
        _ => {
            let reason = "indices are no unsigned integers";
            Err(Error::bad_input(place, reason, "export the scene again"))
        }
    }
}
