//! The buffers of a glTF: those of its file and those that were unpacked.

use gltf::json;
use gltf::json::validation::USize64;
use std::borrow::Cow;

/// The buffers of a document; those of a GLB are borrowed from the file.
pub(super) struct Buffers<'a> {
    pub(super) all: Vec<Cow<'a, [u8]>>,
    /// Bytes that values which are in no buffer may take.
    pub(super) most: u64,
}

impl<'a> Buffers<'a> {
    /// The bytes of a buffer; none where there is no such one.
    pub(super) fn of(&self, index: usize) -> &[u8] {
        self.all.get(index).map_or(&[], |bytes| bytes)
    }

    fn push(&mut self, bytes: Vec<u8>) {
        self.all.push(Cow::Owned(bytes));
    }

    /// The part of a buffer that a view shows, or that an extension of it names.
    pub(super) fn range(&self, buffer: usize, offset: u64, length: u64) -> Option<&[u8]> {
        let (start, end) = (usize::try_from(offset).ok()?, offset.checked_add(length)?);
        self.of(buffer).get(start..usize::try_from(end).ok()?)
    }
}

/// Adds bytes as a buffer of their own under a view of all of them.
pub(super) fn add_view(
    root: &mut json::Root,
    buffers: &mut Buffers<'_>,
    bytes: Vec<u8>,
) -> json::Index<json::buffer::View> {
    let byte_length = USize64(bytes.len() as u64);
    // The file's own buffers and these are numbered alike.
    let extras = json::Extras::default;
    buffers.push(bytes);
    let buffer =
        json::Buffer { byte_length, name: None, uri: None, extensions: None, extras: extras() };
    let view = json::buffer::View {
        buffer: json::Index::push(&mut root.buffers, buffer),
        byte_length,
        byte_offset: None,
        byte_stride: None,
        name: None,
        target: None,
        extensions: None,
        extras: extras(),
    };
    json::Index::push(&mut root.buffer_views, view)
}
