//! The truth about many receivers.

use super::{Answer, Truth};

/// The truth about many receivers, in their order: four bytes each, and an [`Answer`] for those that
/// are not simply lit.
#[derive(Clone, Debug, Default)]
pub struct Answers {
    /// One more than the index in `others`; 0 of a lit receiver.
    slots: Vec<u32>,
    others: Vec<Answer>,
}

impl Answer {
    /// Lit, and touched by nothing.
    pub const LIT: Self = Self { truth: Truth::Lit, touching: 0 };
}

impl Answers {
    /// So many lit receivers.
    #[must_use]
    pub fn lit(len: usize) -> Self {
        Self { slots: vec![0; len], others: Vec::new() }
    }

    /// How many receivers there are.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.slots.len()
    }

    /// Whether there are none.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.slots.is_empty()
    }

    /// The truth about receiver `k`.
    ///
    /// # Panics
    /// When there is no such receiver.
    #[must_use]
    pub fn get(&self, k: usize) -> Answer {
        match self.slots[k] {
            0 => Answer::LIT,
            slot => self.others[slot as usize - 1],
        }
    }

    /// All of them.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = Answer> {
        (0..self.len()).map(|k| self.get(k))
    }

    /// The truth about receiver `k`, to be changed.
    pub(super) fn at(&mut self, k: usize) -> &mut Answer {
        let slot = self.slot(k);
        &mut self.others[slot]
    }

    /// Where among the others the answer about receiver `k` is: the last one if it was none of them.
    pub(super) fn slot(&mut self, k: usize) -> usize {
        let slot = &mut self.slots[k];
        if *slot == 0 {
            self.others.push(Answer::LIT);
            *slot = self.others.len() as u32;
        }
        *slot as usize - 1
    }

    /// How many others there are.
    pub(super) const fn others(&self) -> usize {
        self.others.len()
    }

    /// The others from one on.
    pub(super) fn others_from(&mut self, first: usize) -> &mut [Answer] {
        &mut self.others[first..]
    }
}

impl FromIterator<Answer> for Answers {
    fn from_iter<I: IntoIterator<Item = Answer>>(answers: I) -> Self {
        let mut all = Self::default();
        for answer in answers {
            if answer != Answer::LIT {
                all.others.push(answer);
            }
            all.slots.push(if answer == Answer::LIT { 0 } else { all.others.len() as u32 });
        }
        all
    }
}

impl PartialEq for Answers {
    fn eq(&self, other: &Self) -> bool {
        self.iter().eq(other.iter())
    }
}
