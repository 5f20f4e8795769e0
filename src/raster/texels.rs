//! A set of texels of a map as one bit each, and the rank of each member.

use rayon::prelude::*;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

/// Texels of a square map, its upper and right border included. Any number of threads may insert;
/// ranks are known after [`Self::count`]. 1.5 bits a texel.
#[derive(Debug)]
pub struct TexelSet {
    /// Words of a row.
    stride: usize,
    words: Vec<AtomicU64>,
    /// Members before each word.
    before: Vec<u32>,
}

impl TexelSet {
    /// The empty set of a map with `size` texels a side.
    #[must_use]
    pub fn new(size: u32) -> Self {
        let stride = (size as usize + 1).div_ceil(64);
        let words = stride * (size as usize + 1);
        Self { stride, words: (0..words).map(|_| AtomicU64::new(0)).collect(), before: Vec::new() }
    }

    /// The word and the bit of a texel.
    fn place(&self, [x, y]: [u32; 2]) -> (usize, u64) {
        (y as usize * self.stride + x as usize / 64, 1 << (x % 64))
    }

    /// Whether a texel is a member.
    #[must_use]
    pub fn contains(&self, texel: [u32; 2]) -> bool {
        let (word, bit) = self.place(texel);
        self.words[word].load(Relaxed) & bit != 0
    }

    /// Adds a texel.
    pub fn insert(&self, texel: [u32; 2]) {
        let (word, bit) = self.place(texel);
        if self.words[word].load(Relaxed) & bit == 0 {
            self.words[word].fetch_or(bit, Relaxed);
        }
    }

    /// Numbers the members.
    pub fn count(&mut self) {
        let mut sum = 0;
        let number = |word: &mut AtomicU64| {
            let before = sum;
            sum += word.get_mut().count_ones();
            before
        };
        self.before = self.words.iter_mut().map(number).collect();
    }

    /// How many members come before a texel, row by row.
    #[must_use]
    pub fn rank(&self, texel: [u32; 2]) -> usize {
        let (word, bit) = self.place(texel);
        let within = self.words[word].load(Relaxed) & (bit - 1);
        self.before[word] as usize + within.count_ones() as usize
    }

    /// All members, row by row.
    #[must_use]
    pub fn list(&self) -> Vec<[u32; 2]> {
        let members = |(k, word): (usize, &AtomicU64)| {
            let (row, first) = ((k / self.stride) as u32, (k % self.stride * 64) as u32);
            let mut bits = word.load(Relaxed);
            std::iter::from_fn(move || {
                let bit = (bits != 0).then(|| bits.trailing_zeros())?;
                bits &= bits - 1;
                Some([first + bit, row])
            })
        };
        let words = self.words.par_iter().with_min_len(1 << 12).enumerate();
        words.flat_map_iter(members).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranks_are_places_in_the_list() {
        let mut set = TexelSet::new(130);
        let texels = [[130, 130], [0, 0], [63, 7], [64, 7], [127, 7], [128, 7], [5, 7], [64, 7]];
        texels.iter().for_each(|&t| set.insert(t));
        set.count();
        let list = set.list();
        let mut sorted = texels.to_vec();
        sorted.sort_unstable_by_key(|[x, y]| (*y, *x));
        sorted.dedup();
        assert_eq!(list, sorted);
        for (rank, &texel) in list.iter().enumerate() {
            assert_eq!(set.rank(texel), rank, "{texel:?}");
        }
    }
}
