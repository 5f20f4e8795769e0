//! Everything that a measurement counts over its receivers, in one pass on all threads.

use super::classify::{Artifact, Kind};
use super::curve::Thresholds;
use super::ladder::Rung;
use super::measurement::{Gap, InteriorTotal, ObjectTally, Samples, ShadowInterior, Wrongs, share};
use super::observe::{Observation, Standing};
use crate::scene::Case;
use crate::truth::Truth;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Receivers that a thread counts at a time.
const CHUNK: usize = 1 << 14;

/// Counts of receivers, in their order.
#[derive(Debug)]
pub(super) struct Counts<'o> {
    pub(super) samples: Samples,
    pub(super) thresholds: Thresholds,
    pub(super) exact_gap: Option<Gap>,
    /// Falsely shadowed by peter-panning.
    pub(super) panning: Vec<&'o Observation>,
    /// Lit receivers that their own surface shadows without a bias.
    pub(super) striped: Vec<&'o Observation>,
    /// Wrong verdicts of the truly lit and of the truly shadowed.
    wrongs: [Wrong; 2],
    on_rung: [u64; Rung::ALL.len()],
    /// By object.
    all: Vec<ObjectTally>,
    interior: Vec<ObjectTally>,
    shadow_interior: u64,
    /// Interior receivers that face away and are truly shadowed, and those of them that are lit.
    turned_away: [u64; 2],
    /// By the receiver's object.
    leaks: Vec<u64>,
    /// Receivers that an object truly shadows, and those that the map keeps dark at least partly.
    cast: Vec<[u64; 2]>,
}

/// Wrong verdicts of one kind.
#[derive(Clone, Debug, Default)]
struct Wrong {
    /// |v − truth| of each.
    weights: Vec<f64>,
    by_cause: [u64; Rung::ALL.len()],
    by_artifact: [u64; Artifact::ALL.len()],
}

impl<'o> Counts<'o> {
    /// Counts all receivers; `inside` tells which are interior. `object` gives a triangle's object.
    pub(super) fn of(
        objects: usize,
        observations: &'o [Observation],
        inside: &[bool],
        object: impl Fn(u32) -> u16 + Sync,
    ) -> Self {
        let chunk = |(observations, inside): (&'o [Observation], &[bool])| {
            let mut counts = Self::none(objects);
            for (o, &inside) in observations.iter().zip(inside) {
                counts.add(o, inside, &object);
            }
            counts
        };
        let chunks = observations.par_chunks(CHUNK).zip(inside.par_chunks(CHUNK));
        let chunks: Vec<Self> = chunks.map(chunk).collect();
        chunks.into_iter().fold(Self::none(objects), Self::joined)
    }

    fn none(objects: usize) -> Self {
        Self {
            samples: Samples::default(),
            thresholds: Thresholds::default(),
            exact_gap: None,
            panning: Vec::new(),
            striped: Vec::new(),
            wrongs: Default::default(),
            on_rung: [0; Rung::ALL.len()],
            all: vec![ObjectTally::default(); objects],
            interior: vec![ObjectTally::default(); objects],
            shadow_interior: 0,
            turned_away: [0; 2],
            leaks: vec![0; objects],
            cast: vec![[0; 2]; objects],
        }
    }

    fn add(&mut self, o: &'o Observation, inside: bool, object: &impl Fn(u32) -> u16) {
        self.samples.add(o);
        self.thresholds.add(o);
        self.on_rung.iter_mut().zip(o.wrong).for_each(|(n, wrong)| *n += u64::from(wrong));
        self.all[usize::from(o.object)].add(o);
        if inside {
            self.interior(o);
        }
        match o.truly_lit() {
            Some(true) => self.lit(o),
            Some(false) => self.shadowed(o, object),
            None => {}
        }
    }

    fn interior(&mut self, o: &Observation) {
        self.interior[usize::from(o.object)].add(o);
        if matches!(o.answer.truth, Truth::Shadowed(_)) {
            let leaks = u64::from(o.visibility() > 0.0);
            self.shadow_interior += 1;
            self.leaks[usize::from(o.object)] += leaks;
            if o.standing == Standing::FacingAway {
                sum(&mut self.turned_away, &[1, leaks]);
            }
        }
    }

    fn lit(&mut self, o: &'o Observation) {
        self.wrongs[0].add(o, 1.0 - o.visibility());
        if o.own_surface && o.breakpoints.iter().any(|&b| b > 0.0) {
            self.striped.push(o);
        }
    }

    fn shadowed(&mut self, o: &'o Observation, object: &impl Fn(u32) -> u16) {
        self.wrongs[1].add(o, o.visibility());
        if o.outcome.fault().is_some_and(|f| f.kind == Kind::PETER_PANNING) {
            self.panning.push(o);
        }
        if o.stored[Rung::Bias as usize].is_finite() {
            let gap = o.exact.z - o.stored[Rung::Bias as usize];
            self.exact_gap = Gap::around(self.exact_gap, Some(Gap { min: gap, max: gap }));
        }
        if let Truth::Shadowed(occlusion) = &o.answer.truth {
            let [cast, kept] = &mut self.cast[usize::from(object(occlusion.first))];
            *cast += 1;
            *kept += u64::from(o.visibility() < 1.0);
        }
    }

    /// The counts of both together, the receivers of `self` before those of `other`.
    fn joined(mut self, other: Self) -> Self {
        self.samples.merge(&other.samples);
        self.thresholds = self.thresholds.joined(other.thresholds);
        self.exact_gap = Gap::around(self.exact_gap, other.exact_gap);
        self.panning.extend(other.panning);
        self.striped.extend(other.striped);
        self.wrongs.iter_mut().zip(other.wrongs).for_each(|(a, b)| a.join(b));
        sum(&mut self.on_rung, &other.on_rung);
        self.all.iter_mut().zip(&other.all).for_each(|(a, b)| a.merge(b));
        self.interior.iter_mut().zip(&other.interior).for_each(|(a, b)| a.merge(b));
        self.shadow_interior += other.shadow_interior;
        sum(&mut self.turned_away, &other.turned_away);
        sum(&mut self.leaks, &other.leaks);
        self.cast.iter_mut().zip(&other.cast).for_each(|(a, b)| sum(a, b));
        self
    }

    /// Wrong verdicts among the `population` truly lit or truly shadowed receivers.
    pub(super) fn wrongs(&self, truly_lit: bool, population: u64) -> Wrongs {
        let wrong = &self.wrongs[usize::from(!truly_lit)];
        let count = wrong.weights.len() as u64;
        Wrongs {
            count,
            rate: share(count, population),
            weight: wrong.weights.iter().fold(0.0, |sum, weight| sum + weight),
            by_cause: Rung::ALL.iter().copied().zip(wrong.by_cause).collect(),
            by_artifact: Artifact::ALL.iter().copied().zip(wrong.by_artifact).collect(),
        }
    }

    /// Counts of wrong verdicts on each rung.
    pub(super) fn wrong_on_rung(&self) -> BTreeMap<Rung, u64> {
        Rung::ALL.iter().copied().zip(self.on_rung).collect()
    }

    /// All receivers by the name of their object.
    pub(super) fn by_object(&self, case: &Case) -> BTreeMap<String, ObjectTally> {
        by_name(case, &self.all)
    }

    /// Receivers away from every edge, by object, and all of them.
    pub(super) fn interiors(&self, case: &Case) -> (BTreeMap<String, ObjectTally>, InteriorTotal) {
        let tallies = by_name(case, &self.interior);
        let total = InteriorTotal::of(&tallies);
        (tallies, total)
    }

    /// Light inside shadows.
    pub(super) fn shadow_interior(&self, case: &Case) -> ShadowInterior {
        let leaks = self.leaks.iter().sum();
        let mut found =
            ShadowInterior { receivers: self.shadow_interior, leaks, ..Default::default() };
        for (object, leaks) in case.objects.iter().zip(&self.leaks) {
            *found.leaks_by_object.entry(object.name.clone()).or_default() += leaks;
        }
        found.leak_rate = share(found.leaks, found.receivers);
        [found.facing_away, found.leaks_facing_away] = self.turned_away;
        found
    }

    /// Objects that truly shadow counted receivers, none of which the map leaves in the dark.
    pub(super) fn lost_shadows(&self, case: &Case) -> Vec<String> {
        let lost = self.cast.iter().map(|&[cast, kept]| cast > 0 && kept == 0);
        let objects = case.objects.iter().zip(lost).filter(|(_, lost)| *lost);
        objects.map(|(object, _)| object.name.clone()).collect()
    }
}

impl Wrong {
    fn add(&mut self, o: &Observation, weight: f64) {
        if let Some(fault) = o.outcome.fault() {
            self.weights.push(weight);
            self.by_cause[fault.cause as usize] += 1;
            self.by_artifact[fault.kind.artifact() as usize] += 1;
        }
    }

    fn join(&mut self, other: Self) {
        self.weights.extend(other.weights);
        sum(&mut self.by_cause, &other.by_cause);
        sum(&mut self.by_artifact, &other.by_artifact);
    }
}

impl Samples {
    pub(super) fn add(&mut self, o: &Observation) {
        match o.standing {
            Standing::Counted => {
                self.counted += 1;
                self.touching += u64::from(o.answer.touching);
            }
            Standing::Ambiguous => self.ambiguous += 1,
            Standing::FacingAway => self.facing_away += 1,
            Standing::OutsideCone => self.outside_cone += 1,
            Standing::ReceivesNone => self.receives_none += 1,
            Standing::OutsideMap => {
                self.outside_map += 1;
                self.outside_map_shadowed += u64::from(o.visibility() < 1.0);
            }
        }
    }

    fn merge(&mut self, other: &Self) {
        self.counted += other.counted;
        self.ambiguous += other.ambiguous;
        self.facing_away += other.facing_away;
        self.outside_cone += other.outside_cone;
        self.outside_map += other.outside_map;
        self.outside_map_shadowed += other.outside_map_shadowed;
        self.receives_none += other.receives_none;
        self.touching += other.touching;
    }
}

impl Gap {
    fn around(a: Option<Self>, b: Option<Self>) -> Option<Self> {
        let (Some(a), Some(b)) = (a, b) else { return a.or(b) };
        Some(Self { min: a.min.min(b.min), max: a.max.max(b.max) })
    }
}

fn sum(totals: &mut [u64], others: &[u64]) {
    totals.iter_mut().zip(others).for_each(|(total, n)| *total += n);
}

/// Objects of the same name together.
fn by_name(case: &Case, tallies: &[ObjectTally]) -> BTreeMap<String, ObjectTally> {
    let mut by_name: BTreeMap<String, ObjectTally> = BTreeMap::new();
    for (object, tally) in case.objects.iter().zip(tallies) {
        by_name.entry(object.name.clone()).or_default().merge(tally);
    }
    by_name
}
