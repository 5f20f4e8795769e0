//! Which receivers a frame holds.

use super::super::Receiver;
use crate::simd::lanes::{BATCH, Lanes};

/// About so many make a sample.
const SAMPLE: usize = 1 << 14;

/// The receivers of a frame.
#[derive(Clone, Copy, Debug)]
pub(super) enum Members<'a> {
    /// All of so many.
    All(usize),
    /// The members with these indices.
    Some(&'a [u32]),
}

impl Members<'_> {
    pub(super) fn len(self) -> usize {
        match self {
            Self::All(len) => len,
            Self::Some(members) => members.len(),
        }
    }

    /// Every so many of them, if they are many. The step is odd: members often come in rows of an
    /// image.
    pub(super) fn sample(self) -> Vec<u32> {
        let step = (self.len() / SAMPLE) | 1;
        let some = if step == 1 { 0 } else { self.len() };
        (0..some).step_by(step).map(|k| self.index(k) as u32).collect()
    }

    #[inline(always)]
    pub(super) fn index(self, k: usize) -> usize {
        match self {
            Self::All(_) => k,
            Self::Some(members) => members[k] as usize,
        }
    }

    /// The positions of the next `count` members from `at` on, the last one again in the lanes that
    /// are left.
    #[inline(always)]
    pub(super) fn positions(self, receivers: &[Receiver], at: usize, count: usize) -> [Lanes; 3] {
        match self {
            Self::All(_) if count == BATCH => lanes(|k| &receivers[at..at + BATCH][k]),
            Self::Some(members) if count == BATCH => {
                let members = &members[at..at + BATCH];
                lanes(|k| &receivers[members[k] as usize])
            }
            Self::All(_) | Self::Some(_) => {
                lanes(|k| &receivers[self.index(at + k.min(count - 1))])
            }
        }
    }
}

#[inline(always)]
fn lanes<'a>(receiver: impl Fn(usize) -> &'a Receiver) -> [Lanes; 3] {
    let mut p = [Lanes::splat(0.0); 3];
    for k in 0..BATCH {
        let position = receiver(k).position;
        (p[0].0[k], p[1].0[k], p[2].0[k]) = (position.x, position.y, position.z);
    }
    p
}
