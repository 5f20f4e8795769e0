//! Step functions along the amounts of a bias: counts, and shares of visibility.

/// A count along the amounts ≥ 0: it grows by one at each breakpoint of `up`, falls by one at each of
/// `down`. Four bytes a breakpoint, since millions are sorted.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Steps {
    base: i64,
    pub(super) up: Vec<f32>,
    pub(super) down: Vec<f32>,
}

/// Sorts positive floats: millions, by their digits.
pub(super) fn sort(list: &mut [f32]) {
    radsort::sort(list);
}

/// How many of an ascending list are at most `amount`, given that `from` of them are.
fn reached(list: &[f32], mut from: usize, amount: f32) -> usize {
    let mut stride = 1;
    while list.get(from + stride - 1).is_some_and(|&at| at <= amount) {
        from += stride;
        stride *= 2;
    }
    let end = list.len().min(from + stride);
    from + list[from..end].partition_point(|&at| at <= amount)
}

impl Steps {
    /// Adds one on [from, until).
    pub(super) fn count(&mut self, from: f32, until: f32) {
        self.base += i64::from(from <= 0.0);
        if from > 0.0 && from < f32::INFINITY {
            self.up.push(from);
        }
        if until < f32::INFINITY {
            self.down.push(until);
        }
    }

    pub(super) fn sort(&mut self) {
        sort(&mut self.up);
        sort(&mut self.down);
    }

    pub(super) fn join(&mut self, other: &Self) {
        self.base += other.base;
        self.up.extend(&other.up);
        self.down.extend(&other.down);
    }

    /// The counts at ascending amounts.
    pub(super) fn at<'s>(&'s self, amounts: &'s [f32]) -> impl Iterator<Item = i64> + 's {
        let (mut up, mut down) = (0, 0);
        amounts.iter().map(move |&amount| {
            (up, down) = (reached(&self.up, up, amount), reached(&self.down, down, amount));
            self.base + up as i64 - down as i64
        })
    }

    /// The smallest amount from which the count stays within `limit`.
    pub(super) fn quiet_from(&self, limit: i64) -> Option<f32> {
        let (mut up, mut down) = (self.up.as_slice(), self.down.as_slice());
        let mut count = self.base + up.len() as i64 - down.len() as i64;
        if count > limit {
            return None;
        }
        loop {
            let [last_up, last_down] = [up, down].map(|list| list.last().copied().unwrap_or(0.0));
            let at = if last_up > last_down { last_up } else { last_down };
            if at <= 0.0 {
                return Some(0.0);
            }
            count -= retreat(&mut up, at) - retreat(&mut down, at);
            if count > limit {
                return Some(at);
            }
        }
    }

    /// The smallest amount at which the count is positive.
    pub(super) fn first(&self) -> Option<f32> {
        let (mut count, mut down) = (self.base, 0);
        if count > 0 {
            return Some(0.0);
        }
        for (i, &at) in self.up.iter().enumerate() {
            count += 1;
            if self.up.get(i + 1) == Some(&at) {
                continue;
            }
            let fallen = reached(&self.down, down, at);
            (count, down) = (count - (fallen - down) as i64, fallen);
            if count > 0 {
                return Some(at);
            }
        }
        None
    }
}

/// Drops the breakpoints at `at` from the end of a list; how many they were.
fn retreat(list: &mut &[f32], at: f32) -> i64 {
    let before = list.len();
    while let [rest @ .., last] = list
        && *last == at
    {
        *list = rest;
    }
    (before - list.len()) as i64
}

/// Shares of visibility, in 2⁻⁴⁰, by the amount from which their taps are lit.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Shares {
    /// Share of the taps that are lit from the start.
    base: i64,
    /// Share of all taps together.
    pub(super) all: i64,
    /// Where the others are lit.
    pub(super) at: Vec<f32>,
    /// Their common share.
    each: i64,
    /// The share of each where they differ; else empty.
    own: Vec<i64>,
}

impl Shares {
    pub(super) fn add(&mut self, from: f32, share: i64) {
        self.all += share;
        if from <= 0.0 {
            self.base += share;
        } else if from < f32::INFINITY {
            if self.at.is_empty() {
                self.each = share;
            } else if self.own.is_empty() && share != self.each {
                self.own = self.listed().collect();
            }
            self.at.push(from);
            if !self.own.is_empty() {
                self.own.push(share);
            }
        }
    }

    pub(super) fn join(&mut self, other: &Self) {
        (self.base, self.all) = (self.base + other.base, self.all + other.all);
        if other.at.is_empty() {
            return;
        }
        if self.at.is_empty() {
            (self.each, self.own) = (other.each, other.own.clone());
        } else if [self, other].iter().any(|s| !s.own.is_empty()) || self.each != other.each {
            if self.own.is_empty() {
                self.own = self.listed().collect();
            }
            self.own.extend(other.listed());
        }
        self.at.extend(&other.at);
    }

    /// The share of each, whether they are alike or not.
    fn listed(&self) -> impl Iterator<Item = i64> {
        let alike = self.at.len() - self.own.len();
        self.own.iter().copied().chain(std::iter::repeat_n(self.each, alike))
    }

    pub(super) fn sort(&mut self) {
        if self.own.is_empty() {
            return sort(&mut self.at);
        }
        let mut pairs: Vec<(u32, i64)> =
            self.at.iter().map(|at| at.to_bits()).zip(self.own.drain(..)).collect();
        pairs.sort_unstable();
        (self.at, self.own) =
            pairs.into_iter().map(|(at, share)| (f32::from_bits(at), share)).unzip();
    }

    /// What is lit at ascending amounts.
    pub(super) fn at<'s>(&'s self, amounts: &'s [f32]) -> impl Iterator<Item = i64> + 's {
        let (mut lit, mut next) = (self.base, 0);
        amounts.iter().map(move |&amount| {
            let now = reached(&self.at, next, amount);
            lit += match self.own.get(next..now) {
                Some(own) => own.iter().sum(),
                None => self.each * (now - next) as i64,
            };
            next = now;
            lit
        })
    }
}
