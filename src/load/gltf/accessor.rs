//! glTF accessors read with checked arithmetic: every offset is proved inside its buffer first.

use super::buffers::Buffers;
use gltf::accessor::sparse::IndexType;
use gltf::accessor::{DataType, Dimensions};
use gnomon_core::{Error, Result};

/// What to do with a file whose numbers do not fit together.
pub(super) const AGAIN: &str = "export the scene again";

/// The bytes of an accessor: start, stride and element size are known to fit.
struct Elements<'a> {
    bytes: &'a [u8],
    stride: usize,
    count: usize,
}

impl Elements<'_> {
    /// The elements of N bytes as `read` reads them: all, or those that `keep` numbers.
    fn read<T, const N: usize>(&self, keep: Keep<'_>, read: impl Fn([u8; N]) -> T) -> Vec<T> {
        let element = |i: usize| self.bytes.get(i * self.stride..)?.first_chunk().copied();
        let mut values = Vec::with_capacity(keep.map_or(self.count, <[u32]>::len));
        match keep {
            Some(keep) => {
                values.extend(keep.iter().map_while(|&i| element(i as usize)).map(read));
            }
            None => values.extend((0..self.count).map_while(element).map(read)),
        }
        values
    }
}

/// Numbers of the elements that are read, in rising order; all where it is `None`.
pub(super) type Keep<'k> = Option<&'k [u32]>;

/// Where accessors are read from, for messages and checks.
#[derive(Clone, Copy)]
pub(super) struct Source<'a> {
    pub(super) place: &'a str,
    pub(super) buffers: &'a Buffers<'a>,
    pub(super) keep: Keep<'a>,
}

impl<'a> Source<'a> {
    pub(super) fn all(place: &'a str, buffers: &'a Buffers<'a>) -> Self {
        Self { place, buffers, keep: None }
    }

    fn bad(&self, reason: impl Into<String>) -> Error {
        Error::bad_input(self.place, reason, AGAIN)
    }

    /// `count` elements of `size` bytes from `offset` in a view, proved to lie inside it and its buffer.
    fn elements(
        &self,
        view: &gltf::buffer::View<'_>,
        [offset, count, size]: [usize; 3],
    ) -> Result<Elements<'a>> {
        let [offset, count, size] = [offset, count, size].map(|n| n as u64);
        let stride = view.stride().map_or(size, |s| s as u64);
        if count == 0 || stride < size {
            return Err(self.bad(format!(
                "has count {count} and stride {stride} for elements of {size} bytes"
            )));
        }
        let length = (count - 1).checked_mul(stride).and_then(|n| n.checked_add(size));
        let start = (view.offset() as u64).checked_add(offset);
        let within_view = length
            .and_then(|n| n.checked_add(offset))
            .is_some_and(|end| end <= view.length() as u64);
        let buffer = self.buffers.of(view.buffer().index());
        let range = start.zip(length).and_then(|(s, n)| {
            let end = s.checked_add(n)?;
            buffer.get(usize::try_from(s).ok()?..usize::try_from(end).ok()?)
        });
        match range {
            Some(bytes) if within_view => {
                Ok(Elements { bytes, stride: stride as usize, count: count as usize })
            }
            _ => Err(self.bad(format!("reads beyond its buffer of {} bytes", buffer.len()))),
        }
    }

    /// The elements of an accessor: those of its view (`zero` where it has none), with those that a
    /// sparse accessor replaces.
    fn values<T: Copy, const N: usize>(
        &self,
        accessor: &gltf::Accessor<'_>,
        zero: T,
        read: impl Fn([u8; N]) -> T + Copy,
    ) -> Result<Vec<T>> {
        let count = accessor.count();
        let Some(sparse) = accessor.sparse() else {
            let view = accessor.view().ok_or_else(|| self.bad("has no buffer view"))?;
            let elements = self.elements(&view, [accessor.offset(), count, N])?;
            return Ok(elements.read(self.keep, read));
        };
        let mut values = match accessor.view() {
            Some(view) => self.elements(&view, [accessor.offset(), count, N])?.read(None, read),
            None if (count as u64).saturating_mul(N as u64) > self.buffers.most => {
                return Err(self.bad(format!("has {count} elements, but no data")));
            }
            None => vec![zero; count],
        };
        let (indices, replaced) = (sparse.indices(), sparse.values());
        let (view, offset) = (indices.view(), indices.offset());
        if sparse.count() == 0 {
            return Ok(self.kept(values));
        }
        let places = |size| self.elements(&view, [offset, sparse.count(), size]);
        let places = match indices.index_type() {
            IndexType::U8 => places(1)?.read(None, |[b]| u32::from(b)),
            IndexType::U16 => places(2)?.read(None, |b| u32::from(u16::from_le_bytes(b))),
            IndexType::U32 => places(4)?.read(None, u32::from_le_bytes),
        };
        let range = [replaced.offset(), sparse.count(), N];
        let replaced = self.elements(&replaced.view(), range)?.read(None, read);
        for (index, value) in places.into_iter().zip(replaced) {
            let at = values.get_mut(index as usize);
            *at.ok_or_else(|| {
                self.bad(format!("its sparse part replaces element {index} of {count}"))
            })? = value;
        }
        Ok(self.kept(values))
    }

    /// Gives all elements that are read.
    fn kept<T: Copy>(&self, values: Vec<T>) -> Vec<T> {
        match self.keep {
            Some(keep) => keep.iter().filter_map(|&i| values.get(i as usize).copied()).collect(),
            None => values,
        }
    }

    /// Vectors of N numbers: floats, or integers of 8 or 16 bits (`KHR_mesh_quantization`, weights,
    /// colours), which are fractions of the largest where they are normalized. `what` names them.
    pub(super) fn vectors<const N: usize>(
        &self,
        what: &str,
        accessor: &gltf::Accessor<'_>,
    ) -> Result<Vec<[f32; N]>> {
        let no_vectors =
            || self.bad(format!("{what} are not {N} floats or integers of at most 16 bits each"));
        if accessor.dimensions().multiplicity() != N {
            return Err(no_vectors());
        }
        let zero = [0.0; N];
        let scaled = |largest: f32| if accessor.normalized() { largest } else { 1.0 };
        // Only normalized integers have a lowest value, and it is −1 (glTF 2.0, 3.6.2.2).
        let lowest = if accessor.normalized() { -1.0 } else { f32::NEG_INFINITY };
        let number = |largest: f32| move |x: f32| (x / scaled(largest)).max(lowest);
        macro_rules! read {
            ($word:ty, $largest:expr) => {{
                let number = number($largest);
                self.components(accessor, zero, |b| number(f32::from(<$word>::from_le_bytes(b))))
            }};
        }
        match accessor.data_type() {
            DataType::F32 => self.components(accessor, zero, f32::from_le_bytes),
            DataType::I8 => read!(i8, 127.0),
            DataType::U8 => read!(u8, 255.0),
            DataType::I16 => read!(i16, 32767.0),
            DataType::U16 => read!(u16, 65535.0),
            DataType::U32 => Err(no_vectors()),
        }
    }

    /// N words of W bytes an element.
    fn components<T: Copy, const N: usize, const W: usize>(
        &self,
        accessor: &gltf::Accessor<'_>,
        zero: [T; N],
        read: impl Fn([u8; W]) -> T + Copy,
    ) -> Result<Vec<[T; N]>> {
        let element = |bytes: &[u8]| {
            let (words, _) = bytes.as_chunks::<W>();
            let mut element = zero;
            element.iter_mut().zip(words).for_each(|(to, word)| *to = read(*word));
            element
        };
        // The largest element is a matrix of floats; each size has its own loop.
        macro_rules! sizes {
            ($($size:literal)*) => {
                match N * W {
                    $($size => self.values(accessor, zero, |b: [u8; $size]| element(&b)),)*
                    _ => Err(self.bad("has elements of no known size")),
                }
            };
        }
        sizes!(1 2 3 4 6 8 12 16 64)
    }

    /// Indices or joints: N unsigned integers of 8, 16 or 32 bits each; `what` names them.
    pub(super) fn integers<const N: usize>(
        &self,
        what: &str,
        accessor: &gltf::Accessor<'_>,
    ) -> Result<Vec<[u32; N]>> {
        let kind = (accessor.data_type(), accessor.dimensions().multiplicity() == N);
        let zero = [0; N];
        match kind {
            (DataType::U8, true) => self.components(accessor, zero, |[b]| u32::from(b)),
            (DataType::U16, true) => {
                self.components(accessor, zero, |b| u32::from(u16::from_le_bytes(b)))
            }
            (DataType::U32, true) => self.components(accessor, zero, u32::from_le_bytes),
            _ => Err(self.bad(format!("{what} are no unsigned integers"))),
        }
    }

    /// Indices of a primitive.
    pub(super) fn indices(&self, accessor: &gltf::Accessor<'_>) -> Result<Vec<u32>> {
        if accessor.dimensions() != Dimensions::Scalar {
            return Err(self.bad("indices are no unsigned integers"));
        }
        Ok(self.integers::<1>("indices", accessor)?.into_iter().map(|[i]| i).collect())
    }
}
