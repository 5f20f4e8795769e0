//! The triangle and index streams of meshopt, versions 0 and 1.

use super::Bytes;

/// The last sixteen of something; places wrap around.
struct Fifo<T> {
    held: [T; 16],
    next: usize,
}

impl<T: Copy + Default> Fifo<T> {
    fn new(empty: T) -> Self {
        Self { held: [empty; 16], next: 0 }
    }

    /// The one that was pushed `back` pushes ago; 0 is the place that the next one goes to.
    fn back(&self, back: usize) -> T {
        self.held.get((self.next + 16 - back) % 16).copied().unwrap_or_default()
    }

    /// Writes a value; it stays if `keep`, else the next one overwrites it.
    fn push(&mut self, value: T, keep: bool) {
        self.held.get_mut(self.next).into_iter().for_each(|to| *to = value);
        self.next = (self.next + usize::from(keep)) % 16;
    }
}

struct Triangles<'a> {
    data: Bytes<'a>,
    edges: Fifo<(u32, u32)>,
    vertices: Fifo<u32>,
    /// The next vertex that was never named before.
    next: u32,
    /// The last vertex that was named by its distance.
    last: u32,
}

/// Corners of `count` / 3 triangles; `None` where the stream is damaged.
pub(super) fn triangles(stream: &[u8], count: usize) -> Option<Vec<u32>> {
    let mut bytes = Bytes(stream);
    let header = bytes.byte()?;
    let version = header & 0x0f;
    if header & 0xf0 != 0xe0 || version > 1 || !count.is_multiple_of(3) {
        return None;
    }
    let codes = bytes.take(count / 3)?;
    let table: &[u8; 16] = bytes.0.last_chunk()?;
    let data = Bytes(bytes.0.get(..bytes.0.len() - table.len())?);
    let (edges, vertices) = (Fifo::new((u32::MAX, u32::MAX)), Fifo::new(u32::MAX));
    let mut state = Triangles { data, edges, vertices, next: 0, last: 0 };
    let mut out = Vec::with_capacity(count);
    for &code in codes {
        out.extend(match code {
            0..0xf0 => state.on_edge(code, if version == 0 { 15 } else { 13 })?,
            0xf0..0xfe => state.new_triangle(0, *table.get(usize::from(code & 15))?)?,
            0xfe.. => {
                let aux = state.data.byte()?;
                state.next = if aux == 0 { 0 } else { state.next };
                state.new_triangle(if code == 0xfe { 0 } else { 15 }, aux)?
            }
        });
    }
    state.data.0.is_empty().then_some(out)
}

impl Triangles<'_> {
    fn fresh(&mut self) -> u32 {
        let vertex = self.next;
        self.next = vertex.wrapping_add(1);
        vertex
    }

    /// A triangle on one of the last edges; `most` corner codes name remembered vertices.
    fn on_edge(&mut self, code: u8, most: u8) -> Option<[u32; 3]> {
        let (a, b) = self.edges.back(usize::from(code >> 4) + 1);
        let corner = code & 15;
        let c = match corner {
            0 => self.fresh(),
            _ if corner < most => self.vertices.back(usize::from(corner) + 1),
            15 => self.by_distance()?,
            // 13 and 14 are one before and one after the last.
            _ => {
                self.last = match corner {
                    13 => self.last.wrapping_sub(1),
                    _ => self.last.wrapping_add(1),
                };
                self.last
            }
        };
        self.vertices.push(c, corner == 0 || corner >= most);
        self.edges.push((c, b), true);
        self.edges.push((a, c), true);
        Some([a, b, c])
    }

    /// A triangle on its own: 0 is a fresh vertex, 15 one by its distance, else one that is remembered.
    fn new_triangle(&mut self, first: u8, aux: u8) -> Option<[u32; 3]> {
        let codes = [first, aux >> 4, aux & 15];
        let mut corners = [0; 3];
        for (corner, code) in corners.iter_mut().zip(codes) {
            *corner = match code {
                0 => self.fresh(),
                15 => 0,
                _ => self.vertices.back(usize::from(code)),
            };
        }
        for (corner, _) in corners.iter_mut().zip(codes).filter(|(_, code)| *code == 15) {
            *corner = self.by_distance()?;
        }
        for (corner, code) in corners.into_iter().zip(codes) {
            self.vertices.push(corner, code == 0 || code == 15);
        }
        let [a, b, c] = corners;
        [(b, a), (c, b), (a, c)].into_iter().for_each(|edge| self.edges.push(edge, true));
        Some(corners)
    }

    fn by_distance(&mut self) -> Option<u32> {
        self.last = self.last.wrapping_add(unzigzag(variable(&mut self.data)?));
        Some(self.last)
    }
}

fn unzigzag(v: u32) -> u32 {
    (v >> 1) ^ (v & 1).wrapping_neg()
}

/// Seven bits a byte, the lowest first; the highest bit says that more follow.
fn variable(data: &mut Bytes<'_>) -> Option<u32> {
    let mut value = 0u32;
    for shift in [0, 7, 14, 21, 28] {
        let byte = data.byte()?;
        value |= u32::from(byte & 0x7f) << shift;
        if byte < 0x80 {
            break;
        }
    }
    Some(value)
}

/// `count` indices, each by its distance to one of the last two; `None` where the stream is damaged.
pub(super) fn sequence(stream: &[u8], count: usize) -> Option<Vec<u32>> {
    let mut bytes = Bytes(stream);
    let header = bytes.byte()?;
    if header & 0xf0 != 0xd0 || header & 0x0f > 1 || stream.len() < count.checked_add(5)? {
        return None;
    }
    let mut data = Bytes(bytes.0.get(..bytes.0.len().checked_sub(4)?)?);
    let mut last = [0u32; 2];
    let mut out = Vec::with_capacity(count);
    for _ in 0..count {
        let value = variable(&mut data)?;
        let base = last.get_mut((value & 1) as usize)?;
        *base = base.wrapping_add(unzigzag(value >> 1));
        out.push(*base);
    }
    data.0.is_empty().then_some(out)
}
