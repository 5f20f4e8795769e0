//! One combination of packing (or format), store, sampler and arithmetic, from names to certificate.

use super::bound::{bound, format_bound};
use super::certificate::{Certificate, Subject, certify};
use super::conditions::Conditions;
use super::proof::Bound;
use super::sample::sample;
use super::survey::{Method, survey, survey_format};
use super::tally::ErrorTally;
use crate::depth::arith::Raw;
use crate::depth::packing::{Pair, TextPair};
use crate::depth::roundtrip::{AnyRoundTrip, Closures, Path};
use crate::depth::{Arithmetic, FormatTrip, Packing, RoundTrip};
use crate::simd::Level;

/// What a certificate of a packing under some conditions is about.
fn subject(under: Conditions, name: &str, channels: usize, bound: Option<Bound>) -> Subject {
    Subject {
        name: name.to_string(),
        channels: Some(channels),
        store: under.store.to_string(),
        load: under.load.to_string(),
        arithmetic: under.arithmetic.to_string(),
        bound,
    }
}

/// How much to look at.
#[derive(Clone, Copy, Debug)]
pub struct Certifier {
    /// Sampled, brute or pruned.
    pub method: Method,
    /// The vector width.
    pub level: Level,
}

impl Certifier {
    fn tallies<F: Raw>(self, trip: &dyn RoundTrip<F>) -> Vec<ErrorTally<F>> {
        match self.method {
            Method::Sampled => sample(trip, self.level),
            Method::Brute => survey(trip, self.level, Method::Brute),
            Method::Pruned | Method::BreakPoints => survey(trip, self.level, Method::Pruned),
        }
    }

    /// The certificate of round trips that differ in their rounding alone.
    #[must_use]
    pub fn certify<F: Raw>(self, subject: Subject, trips: &[&dyn RoundTrip<F>]) -> Certificate {
        let tallies: Vec<_> = trips.iter().map(|&trip| self.tallies(trip)).collect();
        certify(subject, self.method, trips, &tallies)
    }

    /// The certificate of a catalogued packing.
    #[must_use]
    pub fn certify_packing(self, packing: Packing, conditions: Conditions) -> Certificate {
        let bound = bound(packing, conditions);
        let of = subject(conditions, packing.name(), packing.channels(), bound);
        let trips = conditions.paths().map(|path| path.of_packing(packing)).collect();
        self.certify_any(of, trips)
    }

    /// The certificate of a user's own pair.
    #[must_use]
    pub fn certify_text(self, name: &str, pair: TextPair, conditions: Conditions) -> Certificate {
        let of = subject(conditions, name, pair.channels(), None);
        self.certify_pair(of, pair, conditions)
    }

    /// The certificate of a pair written over [`Number`](crate::depth::arith::Number).
    #[must_use]
    pub fn certify_pair<P: Pair + 'static>(
        self,
        subject: Subject,
        pair: P,
        conditions: Conditions,
    ) -> Certificate {
        let trips = conditions.paths().map(|path| path.of(pair)).collect();
        self.certify_any(subject, trips)
    }

    /// The certificate of a pair of Rust closures in f32 (the conditions' arithmetic is theirs):
    /// `channels` of the four that `pack` returns are stored. Nothing can be proved about a closure,
    /// so `Pruned` evaluates every float.
    #[must_use]
    pub fn certify_closures<P, U>(
        self,
        name: &str,
        channels: usize,
        conditions: Conditions,
        pack: P,
        unpack: U,
    ) -> Certificate
    where
        P: Fn(f32) -> [f32; 4] + Send + Sync,
        U: Fn([f32; 4]) -> f32 + Send + Sync,
    {
        let conditions = Conditions { arithmetic: Arithmetic::F32, ..conditions };
        let trip = |path: Path| Closures::new(channels, path.rounding, path.load, &pack, &unpack);
        let trips: Vec<_> = conditions.paths().map(trip).collect();
        let trips: Vec<&dyn RoundTrip<f32>> = trips.iter().map(|t| t as _).collect();
        self.certify(subject(conditions, name, channels, None), &trips)
    }

    fn certify_any(self, subject: Subject, trips: Vec<AnyRoundTrip>) -> Certificate {
        let (mut single, mut double) = (Vec::new(), Vec::new());
        for trip in trips {
            match trip {
                AnyRoundTrip::F32(trip) => single.push(trip),
                AnyRoundTrip::F64(trip) => double.push(trip),
            }
        }
        if double.is_empty() {
            self.certify(subject, &single.iter().map(|t| &**t).collect::<Vec<_>>())
        } else {
            self.certify(subject, &double.iter().map(|t| &**t).collect::<Vec<_>>())
        }
    }

    /// The certificate of a depth format. Sampled, or exhaustive by break points (`Pruned` and
    /// `BreakPoints` alike) or by brute force; decoded in f64 where the sampler is exact.
    #[must_use]
    pub fn certify_format(self, trip: FormatTrip) -> Certificate {
        let subject = Subject {
            name: trip.format.to_string(),
            channels: None,
            store: trip.store.to_string(),
            load: trip.load.to_string(),
            arithmetic: Arithmetic::Real.to_string(),
            bound: format_bound(trip),
        };
        let tallies: Vec<ErrorTally<f64>> = match self.method {
            Method::Sampled | Method::Brute => self.tallies(&trip),
            Method::Pruned | Method::BreakPoints => survey_format(trip),
        };
        let method = if self.method == Method::Pruned { Method::BreakPoints } else { self.method };
        certify::<f64>(subject, method, &[&trip], &[tallies])
    }
}
