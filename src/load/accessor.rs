//! glTF accessors read with checked arithmetic: every offset is proved inside its buffer first.

use glam::Vec3;
use gltf::accessor::sparse::IndexType;
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

/// `count` elements of `size` bytes from `offset` in a view, proved to lie inside it and its buffer.
fn elements<'a>(
    place: &str,
    view: &gltf::buffer::View<'_>,
    [offset, count, size]: [usize; 3],
    buffers: &'a [Vec<u8>],
) -> Result<Elements<'a>> {
    let bad = |reason: String| Error::bad_input(place, reason, "export the scene again");
    let [offset, count, size] = [offset, count, size].map(|n| n as u64);
    let stride = view.stride().map_or(size, |s| s as u64);
    if count == 0 || stride < size {
        return Err(bad(format!(
            "has count {count} and stride {stride} for elements of {size} bytes"
        )));
    }
    let length = (count - 1).checked_mul(stride).and_then(|n| n.checked_add(size));
    let start = (view.offset() as u64).checked_add(offset);
    let within_view =
        length.and_then(|n| n.checked_add(offset)).is_some_and(|end| end <= view.length() as u64);
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

/// The elements of an accessor: those of its view (`zero` where it has none), with those that a sparse
/// accessor replaces.
fn values<T: Copy, const N: usize>(
    place: &str,
    accessor: &gltf::Accessor<'_>,
    buffers: &[Vec<u8>],
    zero: T,
    read: impl Fn([u8; N]) -> T + Copy,
) -> Result<Vec<T>> {
    let bad = |reason: String| Error::bad_input(place, reason, "export the scene again");
    let count = accessor.count();
    let sparse = accessor.sparse();
    let mut values = match (accessor.view(), &sparse) {
        (Some(view), _) => {
            elements(place, &view, [accessor.offset(), count, N], buffers)?.read(read)
        }
        (None, Some(_)) => vec![zero; count],
        (None, None) => return Err(bad("has no buffer view".into())),
    };
    let Some(sparse) = sparse else { return Ok(values) };
    let (indices, replaced) = (sparse.indices(), sparse.values());
    let range = |size: usize| [indices.offset(), sparse.count(), size];
    let view = indices.view();
    let places = match indices.index_type() {
        IndexType::U8 => elements(place, &view, range(1), buffers)?.read(|[b]| u32::from(b)),
        IndexType::U16 => {
            elements(place, &view, range(2), buffers)?.read(|b| u32::from(u16::from_le_bytes(b)))
        }
        IndexType::U32 => elements(place, &view, range(4), buffers)?.read(u32::from_le_bytes),
    };
    let range = [replaced.offset(), sparse.count(), N];
    let replaced = elements(place, &replaced.view(), range, buffers)?.read(read);
    for (index, value) in places.into_iter().zip(replaced) {
        *values
            .get_mut(index as usize)
            .ok_or_else(|| bad(format!("its sparse part replaces element {index} of {count}")))? =
            value;
    }
    Ok(values)
}

/// Positions: three floats each, or (`KHR_mesh_quantization`) three integers of 8 or 16 bits, which
/// are fractions of the largest where they are normalized.
pub(super) fn positions(
    place: &str,
    accessor: &gltf::Accessor<'_>,
    buffers: &[Vec<u8>],
) -> Result<Vec<Vec3>> {
    let no_positions = || {
        let reason = "positions are not three floats or three integers of at most 16 bits each";
        Error::bad_input(place, reason, "export the scene again")
    };
    if accessor.dimensions() != Dimensions::Vec3 {
        return Err(no_positions());
    }
    let (zero, normalized) = (Vec3::ZERO, accessor.normalized());
    let fraction = move |largest: f32, v: [f32; 3]| match normalized {
        true => (Vec3::from_array(v) / largest).max(Vec3::NEG_ONE),
        false => Vec3::from_array(v),
    };
    match accessor.data_type() {
        DataType::F32 => values(place, accessor, buffers, zero, |b: [u8; 12]| {
            let [x, y, z] = words(b).map(f32::from_le_bytes);
            Vec3::new(x, y, z)
        }),
        DataType::I8 => values(place, accessor, buffers, zero, |b: [u8; 3]| {
            fraction(127.0, b.map(|b| f32::from(b.cast_signed())))
        }),
        DataType::U8 => {
            values(place, accessor, buffers, zero, |b: [u8; 3]| fraction(255.0, b.map(f32::from)))
        }
        DataType::I16 => values(place, accessor, buffers, zero, |b: [u8; 6]| {
            fraction(32767.0, words(b).map(|b| f32::from(i16::from_le_bytes(b))))
        }),
        DataType::U16 => values(place, accessor, buffers, zero, |b: [u8; 6]| {
            fraction(65535.0, words(b).map(|b| f32::from(u16::from_le_bytes(b))))
        }),
        DataType::U32 => Err(no_positions()),
    }
}

/// Three words of N bytes out of M = 3·N.
fn words<const N: usize, const M: usize>(bytes: [u8; M]) -> [[u8; N]; 3] {
    const { assert!(M == 3 * N) };
    let mut words = bytes.chunks_exact(N).filter_map(|word| word.try_into().ok());
    [(); 3].map(|()| words.next().unwrap_or([0; N]))
}

/// Indices: one unsigned integer of 8, 16 or 32 bits each.
pub(super) fn indices(
    place: &str,
    accessor: &gltf::Accessor<'_>,
    buffers: &[Vec<u8>],
) -> Result<Vec<u32>> {
    match (accessor.data_type(), accessor.dimensions()) {
        (DataType::U8, Dimensions::Scalar) => {
            values(place, accessor, buffers, 0, |[b]: [u8; 1]| u32::from(b))
        }
        (DataType::U16, Dimensions::Scalar) => {
            values(place, accessor, buffers, 0, |b| u32::from(u16::from_le_bytes(b)))
        }
        (DataType::U32, Dimensions::Scalar) => {
            values(place, accessor, buffers, 0, u32::from_le_bytes)
        }
        _ => {
            let reason = "indices are no unsigned integers";
            Err(Error::bad_input(place, reason, "export the scene again"))
        }
    }
}
