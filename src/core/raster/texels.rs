//! A set of texels as one bit each, and the rank of each member.

use rayon::prelude::*;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

/// Texels by their number. Any number of threads may insert; ranks are known after [`Self::count`].
/// 1.5 bits a texel.
#[derive(Debug)]
pub struct TexelSet {
    words: Vec<AtomicU64>,
    /// Members before each word.
    before: Vec<u32>,
}

/// The word and the bit of a texel.
const fn place(texel: u32) -> (usize, u64) {
    (texel as usize / 64, 1 << (texel % 64))
}

impl TexelSet {
    /// The empty set of so many texels.
    #[must_use]
    pub fn new(texels: usize) -> Self {
        let words = texels.div_ceil(64);
        Self { words: (0..words).map(|_| AtomicU64::new(0)).collect(), before: Vec::new() }
    }

    /// Adds a texel.
    pub fn insert(&self, texel: u32) {
        let (word, bit) = place(texel);
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

    /// How many members come before a texel; `None` where it is not one.
    #[must_use]
    #[inline]
    pub fn rank(&self, texel: u32) -> Option<usize> {
        let (word, bit) = place(texel);
        let members = self.words[word].load(Relaxed);
        let within = (members & (bit - 1)).count_ones();
        (members & bit != 0).then(|| (self.before[word] + within) as usize)
    }

    /// All members, ascending.
    #[must_use]
    pub fn list(&self) -> Vec<u32> {
        let members = |(k, word): (usize, &AtomicU64)| {
            let mut bits = word.load(Relaxed);
            std::iter::from_fn(move || {
                let bit = (bits != 0).then(|| bits.trailing_zeros())?;
                bits &= bits - 1;
                Some(k as u32 * 64 + bit)
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
        let mut set = TexelSet::new(1000);
        let texels = [999, 0, 63, 64, 127, 128, 5, 64, 700];
        texels.iter().for_each(|&t| set.insert(t));
        set.count();
        let mut sorted = texels.to_vec();
        sorted.sort_unstable();
        sorted.dedup();
        assert_eq!(set.list(), sorted);
        for texel in 0..1000 {
            assert_eq!(set.rank(texel), sorted.iter().position(|&t| t == texel), "{texel}");
        }
    }
}
