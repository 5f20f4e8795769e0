//! The attribute stream of meshopt, versions 0 and 1: blocks of vertices, byte after byte of them, as
//! differences from vertex to vertex in groups of sixteen.

use super::Bytes;

const BLOCK_BYTES: usize = 8192;
const BLOCK_VERTICES: usize = 256;
const GROUP: usize = 16;
/// Bits of a value in a group by its header's two bits; in version 1 the block says which row.
const BITS: [[u32; 4]; 3] = [[0, 2, 4, 8], [0, 1, 2, 4], [1, 2, 4, 8]];

/// `count` vertices of `size` bytes (a multiple of 4, at most 256); `None` where the stream is damaged.
pub(super) fn decode(stream: &[u8], count: usize, size: usize) -> Option<Vec<u8>> {
    if size == 0 || size > 256 || !size.is_multiple_of(4) {
        return None;
    }
    let mut bytes = Bytes(stream);
    let header = bytes.byte()?;
    let version = header & 0x0f;
    if header & 0xf0 != 0xa0 || version > 1 {
        return None;
    }
    let (channels, least) = if version == 0 { (0, 32) } else { (size / 4, 24) };
    let body = bytes.0.len().checked_sub((size + channels).max(least))?;
    let tail = bytes.0.get(bytes.0.len() - size - channels..)?;
    let (first, channels) = tail.split_at_checked(size)?;
    let mut decoder =
        Decoder { bytes: Bytes(bytes.0.get(..body)?), version, channels, last: first.to_vec() };
    let mut out = vec![0; count.checked_mul(size)?];
    let block = ((BLOCK_BYTES / size) & !(GROUP - 1)).min(BLOCK_VERTICES);
    for vertices in out.chunks_mut(block * size) {
        decoder.block(vertices, size)?;
    }
    decoder.bytes.0.is_empty().then_some(out)
}

struct Decoder<'a> {
    bytes: Bytes<'a>,
    version: u8,
    /// How the differences of each four bytes are coded (version 1).
    channels: &'a [u8],
    /// The vertex before the block.
    last: Vec<u8>,
}

impl Decoder<'_> {
    fn block(&mut self, vertices: &mut [u8], size: usize) -> Option<()> {
        let count = vertices.len() / size;
        let controls = self.bytes.take(if self.version == 0 { 0 } else { size / 4 })?;
        for word in 0..size / 4 {
            let control = controls.get(word).copied().unwrap_or(0);
            let mut columns = [[0u8; BLOCK_VERTICES]; 4];
            for (j, column) in columns.iter_mut().enumerate() {
                let column = column.get_mut(..count.next_multiple_of(GROUP))?;
                match (self.version, (control >> (2 * j)) & 3) {
                    (0, _) => self.groups(column, BITS.first()?)?,
                    (_, 3) => column.get_mut(..count)?.copy_from_slice(self.bytes.take(count)?),
                    (_, 2) => {}
                    (_, row) => self.groups(column, BITS.get(usize::from(row) + 1)?)?,
                }
            }
            let before = self.last.get(4 * word..4 * word + 4)?.first_chunk()?;
            let channel = self.channels.get(word).copied().unwrap_or(0);
            let mut last = *before;
            let rows = vertices
                .chunks_exact_mut(size)
                .filter_map(|v| v.get_mut(4 * word..)?.first_chunk_mut());
            for (i, to) in rows.enumerate() {
                let coded = columns.each_ref().map(|column| column.get(i).copied().unwrap_or(0));
                last = undo(channel, coded, last)?;
                *to = last;
            }
        }
        self.last.copy_from_slice(vertices.get(vertices.len() - size..)?);
        Some(())
    }

    /// Values of one byte of all vertices of a block, in groups of sixteen.
    fn groups(&mut self, column: &mut [u8], bits: &[u32; 4]) -> Option<()> {
        let headers = self.bytes.take((column.len() / GROUP).div_ceil(4))?;
        for (i, group) in column.as_chunks_mut::<GROUP>().0.iter_mut().enumerate() {
            let header = headers.get(i / 4)? >> (2 * (i % 4));
            let bits = *bits.get(usize::from(header & 3))?;
            match bits {
                0 => {}
                8 => group.copy_from_slice(self.bytes.take(GROUP)?),
                _ => self.group(group, bits)?,
            }
        }
        Some(())
    }

    /// Sixteen values of a few bits; the largest of them stands for a whole byte that follows.
    fn group(&mut self, group: &mut [u8; GROUP], bits: u32) -> Option<()> {
        let fixed = self.bytes.take(GROUP * bits as usize / 8)?;
        let (each, largest) = (8 / bits as usize, (1u8 << bits) - 1);
        for (i, value) in group.iter_mut().enumerate() {
            let (byte, place) = (fixed.get(i / each)?, (i % each) as u32 * bits);
            // Single bits begin at the lowest, wider values at the highest.
            let shift = if bits == 1 { place } else { 8 - bits - place };
            let small = (byte >> shift) & largest;
            *value = if small == largest { self.bytes.byte()? } else { small };
        }
        Some(())
    }
}

/// Four bytes of a vertex from their coded differences to those before: of bytes or halves (zigzag), or
/// of words (exclusive or, turned).
fn undo(channel: u8, coded: [u8; 4], before: [u8; 4]) -> Option<[u8; 4]> {
    let unzigzag8 = |v: u8| (v & 1).wrapping_neg() ^ (v >> 1);
    let unzigzag16 = |v: u16| (v & 1).wrapping_neg() ^ (v >> 1);
    match channel & 3 {
        0 => {
            let mut out = before;
            out.iter_mut().zip(coded).for_each(|(o, c)| *o = o.wrapping_add(unzigzag8(c)));
            Some(out)
        }
        1 => {
            let [a, b, c, d] = coded;
            let [e, f, g, h] = before;
            let half = |v: [u8; 2], p: [u8; 2]| {
                unzigzag16(u16::from_le_bytes(v)).wrapping_add(u16::from_le_bytes(p)).to_le_bytes()
            };
            let ([a, b], [c, d]) = (half([a, b], [e, f]), half([c, d], [g, h]));
            Some([a, b, c, d])
        }
        2 => {
            let turned = u32::from_le_bytes(coded).rotate_right(u32::from(channel >> 4));
            Some((turned ^ u32::from_le_bytes(before)).to_le_bytes())
        }
        _ => None,
    }
}
