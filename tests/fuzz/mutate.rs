//! Seeded mutations of corpus files: bytes, numbers and words of the formats, splices of two files.

/// Seeded random numbers.
pub struct Random(fastrand::Rng);

impl Random {
    /// Numbers of a seed.
    pub fn new(seed: u64) -> Self {
        Self(fastrand::Rng::with_seed(seed))
    }

    /// Below `limit`, which is not 0.
    pub fn below(&mut self, limit: usize) -> usize {
        self.0.usize(..limit)
    }
}

/// Largest mutant: 64 KiB.
const LARGEST: usize = 64 << 10;

/// Numbers at which readers of lengths, indices and floats go wrong.
const NUMBERS: [&[u8]; 24] = [
    b"0",
    b"1",
    b"-1",
    b"2",
    b"255",
    b"256",
    b"65535",
    b"65536",
    b"2147483647",
    b"2147483648",
    b"4294967295",
    b"4294967296",
    b"9223372036854775807",
    b"18446744073709551608",
    b"18446744073709551615",
    b"1152921504606846977",
    b"1e30",
    b"1e39",
    b"-1e308",
    b"1e999",
    b"1e-46",
    b"nan",
    b"inf",
    b"0.1",
];

const BYTES: &[u8] = b"\0\x01\x7f\x80\xff{}[]\",:\n\r\t #=/.\\-+eE%&<>'";

/// A mutant of one file of the corpus: one to eight changes.
pub fn mutant(corpus: &[Vec<u8>], random: &mut Random) -> Vec<u8> {
    let mut bytes = corpus[random.below(corpus.len())].clone();
    for _ in 0..1 << random.below(4) {
        let other = &corpus[random.below(corpus.len())];
        change(&mut bytes, other, random);
        bytes.truncate(LARGEST);
    }
    bytes
}

fn change(bytes: &mut Vec<u8>, other: &[u8], random: &mut Random) {
    if bytes.is_empty() {
        bytes.push(BYTES[random.below(BYTES.len())]);
    }
    let at = random.below(bytes.len());
    let size = 1 << random.below(9);
    let until = (at + 1 + random.below(size)).min(bytes.len());
    match random.below(10) {
        0 => bytes[at] ^= 1 << random.below(8),
        1 => bytes[at] = BYTES[random.below(BYTES.len())],
        2 => bytes.insert(at, BYTES[random.below(BYTES.len())]),
        3 => drop(bytes.drain(at..until)),
        4 => {
            let piece = bytes[at..until].to_vec();
            let to = random.below(bytes.len());
            bytes.splice(to..to, piece);
        }
        5 => bytes.truncate(at),
        6 if !other.is_empty() => {
            let from = random.below(other.len());
            let to = (from + 1 + random.below(256)).min(other.len());
            bytes.splice(at..until, other[from..to].iter().copied());
        }
        7 => {
            let word = random.0.u64(..).to_le_bytes();
            let patch = [&word[..], &[0; 8], &[0xff; 8]][random.below(3)];
            let end = (at + 1 + random.below(8)).min(bytes.len());
            let patch = patch.iter().copied().take(end - at);
            bytes.splice(at..end, patch);
        }
        _ => replace_number(bytes, at, random),
    }
}

/// Puts a troublesome number in the place of the next one.
fn replace_number(bytes: &mut Vec<u8>, at: usize, random: &mut Random) {
    let is_number = |b: &u8| b.is_ascii_digit() || b"+-.eE".contains(b);
    let Some(start) = bytes[at..].iter().position(u8::is_ascii_digit) else { return };
    let start = at + start;
    let length = bytes[start..].iter().position(|b| !is_number(b)).unwrap_or(bytes.len() - start);
    let number = NUMBERS[random.below(NUMBERS.len())];
    bytes.splice(start..start + length, number.iter().copied());
}
