//! A case measured: counts, rates, causes, thresholds and lengths, as they stand in `results.json`.

use super::classify::{Artifact, Outcome};
use super::curve::{Curve, Errors, Thresholds};
use super::interior::interior;
use super::ladder::Rung;
use super::observe::{Observation, Observer, Standing};
use super::walk::Walk;
use crate::raster::NO_TRIANGLE;
use crate::scene::{Case, Fact};
use crate::truth::Truth;
use serde::Serialize;
use std::collections::BTreeMap;

/// Receivers by standing. All but `counted` stay out of the rates.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Samples {
    /// Pixels looked at: the sum of all below.
    pub pixels: u64,
    /// Nothing drawn.
    pub background: u64,
    /// In the rates.
    pub counted: u64,
    /// Truth undecided.
    pub ambiguous: u64,
    /// Surface faces away from the light.
    pub facing_away: u64,
    /// Outside the spot's cone.
    pub outside_cone: u64,
    /// Outside the map's volume.
    pub outside_map: u64,
    /// Of those outside the map: the look-up says shadowed nevertheless.
    pub outside_map_shadowed: u64,
    /// Triangles that met a counted receiver itself.
    pub touching: u64,
}

/// One kind of wrong verdict.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Wrongs {
    /// Receivers with a wrong verdict.
    pub count: u64,
    /// Their share of the truly lit (or shadowed) receivers.
    pub rate: f64,
    /// Σ|v − truth|.
    pub weight: f64,
    /// By the first rung from which the verdict stays wrong.
    pub by_cause: BTreeMap<&'static str, u64>,
    /// By what it is called.
    pub by_artifact: BTreeMap<&'static str, u64>,
}

/// Counts of one object's receivers.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Tally {
    /// Truly lit.
    pub lit: u64,
    /// Truly shadowed.
    pub shadowed: u64,
    /// Of the lit: wrong.
    pub false_shadow: u64,
    /// Of the shadowed: wrong.
    pub false_light: u64,
    /// Of the lit: wrong without any bias.
    pub false_shadow_without_bias: u64,
}

impl Tally {
    fn add(&mut self, o: &Observation) {
        match o.truly_lit() {
            Some(true) => self.lit += 1,
            Some(false) => self.shadowed += 1,
            None => {}
        }
        match o.outcome {
            Outcome::FalseShadow(_) => self.false_shadow += 1,
            Outcome::FalseLight(_) => self.false_light += 1,
            Outcome::Agree => {}
        }
        let dark_without_bias = o.breakpoints.iter().any(|&b| b > 0.0);
        self.false_shadow_without_bias +=
            u64::from(o.truly_lit() == Some(true) && dark_without_bias);
    }
}

/// Acne away from every edge.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct InteriorTotal {
    /// Truly lit interior receivers.
    pub lit: u64,
    /// Share of them dark at the case's bias.
    pub acne_rate: f64,
    /// Share of them dark without any bias.
    pub acne_rate_without_bias: f64,
}

impl InteriorTotal {
    fn of(tallies: &BTreeMap<String, Tally>) -> Self {
        let sum = |count: fn(&Tally) -> u64| tallies.values().map(count).sum::<u64>();
        let lit = sum(|t| t.lit);
        let share = |n: u64| if lit == 0 { 0.0 } else { n as f64 / lit as f64 };
        Self {
            lit,
            acne_rate: share(sum(|t| t.false_shadow)),
            acne_rate_without_bias: share(sum(|t| t.false_shadow_without_bias)),
        }
    }
}

/// Light inside shadows, away from every edge.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ShadowInterior {
    /// Truly shadowed interior receivers, facing the light or away from it.
    pub receivers: u64,
    /// Of them: lit, at least partly.
    pub leaks: u64,
    /// Their share.
    pub leak_rate: f64,
    /// Leaks by the receiver's object.
    pub leaks_by_object: BTreeMap<String, u64>,
}

impl ShadowInterior {
    fn of<'o>(case: &Case, interior: impl Iterator<Item = &'o Observation>) -> Self {
        let name = |o: &Observation| case.objects[usize::from(o.object)].name.clone();
        let mut found = Self {
            leaks_by_object: case.objects.iter().map(|o| (o.name.clone(), 0)).collect(),
            ..Self::default()
        };
        for o in interior.filter(|o| matches!(o.answer.truth, Truth::Shadowed(_))) {
            found.receivers += 1;
            if o.visibility() > 0.0 {
                found.leaks += 1;
                *found.leaks_by_object.entry(name(o)).or_default() += 1;
            }
        }
        if found.receivers > 0 {
            found.leak_rate = found.leaks as f64 / found.receivers as f64;
        }
        found
    }
}

/// Exact depth differences between truly shadowed receivers and their first occluder.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Gap {
    /// Smallest, window depth.
    pub min: f64,
    /// Largest, window depth.
    pub max: f64,
}

/// A length on the receiver.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Length {
    /// World units.
    pub world: f64,
    /// Texels of the map at the receiver.
    pub texels: f64,
}

/// Everything measured of one case at its own bias.
#[derive(Clone, Debug, Serialize)]
pub struct Measurement {
    /// The case's name.
    pub name: String,
    /// Its document.
    pub document: String,
    /// Device profile.
    pub device: &'static str,
    /// Map side in texels.
    pub map_size: u32,
    /// Format or packing of a texel.
    pub format: &'static str,
    /// Filter.
    pub filter: &'static str,
    /// Comparison rule.
    pub compare: &'static str,
    /// The document's bias; positive repairs acne.
    pub bias: f32,
    /// Receivers by standing.
    pub samples: Samples,
    /// Truly lit receivers.
    pub lit: u64,
    /// Truly shadowed receivers.
    pub shadowed: u64,
    /// Truth lit, map says shadowed.
    pub false_shadow: Wrongs,
    /// Truth shadowed, map says lit.
    pub false_light: Wrongs,
    /// Counts of wrong verdicts on each rung.
    pub wrong_on_rung: BTreeMap<&'static str, u64>,
    /// Errors without any bias.
    pub without_bias: Errors,
    /// Largest breakpoint of acne, smallest of lost shadow.
    pub thresholds: Thresholds,
    /// detachment − critical.
    pub headroom: Option<f64>,
    /// Exact depth gaps of the truly shadowed.
    pub exact_gap: Option<Gap>,
    /// Receivers away from every edge, by object.
    pub interior: BTreeMap<String, Tally>,
    /// The interior of all objects together.
    pub interior_total: InteriorTotal,
    /// Truly shadowed receivers away from every edge, those that face away from the light included.
    pub shadow_interior: ShadowInterior,
    /// All receivers, by object.
    pub by_object: BTreeMap<String, Tally>,
    /// Objects whose whole shadow is gone although it covers counted receivers.
    pub lost_shadows: Vec<String>,
    /// Longest falsely lit strip by peter-panning.
    pub peter_panning: Option<Length>,
    /// Mean distance of acne stripes without bias.
    pub stripe_period: Option<Length>,
    /// Map texels in which the pass' depth attachment keeps another triangle than a float one.
    pub misordered_texels: u64,
    /// What the document leaves open.
    pub assumptions: Vec<String>,
    /// Known facts.
    pub facts: Vec<Fact>,
    /// One sentence.
    pub verdict: String,
}

/// A measured case with the receivers behind the numbers.
#[derive(Debug)]
pub struct Measured<'a> {
    /// The drawn case and its truth.
    pub observer: Observer<'a>,
    /// Every observed receiver.
    pub observations: Vec<Observation>,
    /// Its constant-bias curves.
    pub curve: Curve,
    /// The numbers.
    pub measurement: Measurement,
}

/// Measures a case on its own device at every `step`-th pixel.
#[must_use]
pub fn measure(case: &Case, step: u32) -> Measured<'_> {
    let observer = Observer::new(case, &case.device.device());
    let observations = observer.observe_canvas(step);
    let curve = Curve::new(&observations);
    let measurement = summarize(&observer, &observations, &curve, step);
    Measured { observer, observations, curve, measurement }
}

fn summarize(
    observer: &Observer<'_>,
    observations: &[Observation],
    curve: &Curve,
    step: u32,
) -> Measurement {
    let case = observer.case();
    let [lit, shadowed] = curve.populations();
    let thresholds = Thresholds::of(observations);
    let inside = interior(observer, observations);
    let interior: Vec<&Observation> =
        observations.iter().zip(inside).filter(|(_, inside)| *inside).map(|(o, _)| o).collect();
    let shadow_interior = ShadowInterior::of(case, interior.iter().copied());
    let interior = by_object(case, interior.into_iter());
    let mut measurement = Measurement {
        name: case.name.clone(),
        document: case.document.clone(),
        device: case.device.name(),
        map_size: case.map.size,
        format: case.map.texel.name(),
        filter: case.lookup.filter.name(),
        compare: case.lookup.compare.name(),
        bias: case.bias,
        samples: samples(case, observations, step),
        lit,
        shadowed,
        false_shadow: wrongs(observations, true, lit),
        false_light: wrongs(observations, false, shadowed),
        wrong_on_rung: wrong_on_rung(observations),
        without_bias: curve.at(0.0),
        headroom: thresholds.headroom(),
        thresholds,
        exact_gap: exact_gap(observations),
        interior_total: InteriorTotal::of(&interior),
        interior,
        shadow_interior,
        by_object: by_object(case, observations.iter()),
        lost_shadows: lost_shadows(observer, observations),
        peter_panning: peter_panning(observer, observations),
        stripe_period: stripe_period(observer, observations),
        misordered_texels: observer.misordered_texels(),
        assumptions: case.assumptions.clone(),
        facts: case.facts.clone(),
        verdict: String::new(),
    };
    measurement.verdict = verdict(&measurement);
    measurement
}

fn samples(case: &Case, observations: &[Observation], step: u32) -> Samples {
    let along = |size: u32| u64::from(size.div_ceil(step));
    let pixels = along(case.canvas[0]) * along(case.canvas[1]);
    let of = |s: Standing| observations.iter().filter(|o| o.standing == s).count() as u64;
    let dark = |o: &&Observation| o.standing == Standing::OutsideMap && o.visibility() < 1.0;
    let counted = observations.iter().filter(|o| o.standing == Standing::Counted);
    Samples {
        pixels,
        background: pixels - observations.len() as u64,
        counted: of(Standing::Counted),
        ambiguous: of(Standing::Ambiguous),
        facing_away: of(Standing::FacingAway),
        outside_cone: of(Standing::OutsideCone),
        outside_map: of(Standing::OutsideMap),
        outside_map_shadowed: observations.iter().filter(dark).count() as u64,
        touching: counted.map(|o| u64::from(o.answer.touching)).sum(),
    }
}

fn wrongs(observations: &[Observation], truly_lit: bool, population: u64) -> Wrongs {
    let mut wrongs = Wrongs {
        by_cause: Rung::ALL.iter().map(|r| (r.name(), 0)).collect(),
        by_artifact: Artifact::ALL.iter().map(|a| (a.name(), 0)).collect(),
        ..Wrongs::default()
    };
    for o in observations.iter().filter(|o| o.truly_lit() == Some(truly_lit)) {
        let Some(fault) = o.outcome.fault() else { continue };
        wrongs.count += 1;
        wrongs.weight += if truly_lit { 1.0 - o.visibility() } else { o.visibility() };
        *wrongs.by_cause.entry(fault.cause.name()).or_default() += 1;
        *wrongs.by_artifact.entry(fault.artifact.name()).or_default() += 1;
    }
    wrongs.rate = if population == 0 { 0.0 } else { wrongs.count as f64 / population as f64 };
    wrongs
}

fn wrong_on_rung(observations: &[Observation]) -> BTreeMap<&'static str, u64> {
    let count = |i: usize| observations.iter().filter(|o| o.wrong[i]).count() as u64;
    Rung::ALL.iter().enumerate().map(|(i, rung)| (rung.name(), count(i))).collect()
}

fn exact_gap(observations: &[Observation]) -> Option<Gap> {
    let gaps = observations
        .iter()
        .filter(|o| o.truly_lit() == Some(false) && o.stored[0].is_finite())
        .map(|o| o.exact.z - o.stored[0]);
    gaps.fold(None, |gap: Option<Gap>, g| {
        Some(gap.map_or(Gap { min: g, max: g }, |Gap { min, max }| Gap {
            min: min.min(g),
            max: max.max(g),
        }))
    })
}

fn by_object<'o>(
    case: &Case,
    observations: impl Iterator<Item = &'o Observation>,
) -> BTreeMap<String, Tally> {
    let mut tallies: BTreeMap<String, Tally> =
        case.objects.iter().map(|o| (o.name.clone(), Tally::default())).collect();
    for o in observations {
        if let Some(tally) = tallies.get_mut(&case.objects[usize::from(o.object)].name) {
            tally.add(o);
        }
    }
    tallies
}

/// Objects that truly shadow counted receivers, none of which the map leaves in the dark.
fn lost_shadows(observer: &Observer<'_>, observations: &[Observation]) -> Vec<String> {
    let case = observer.case();
    let mut kept = vec![(0u64, 0u64); case.objects.len()];
    for o in observations {
        if let (Some(false), Truth::Shadowed(occlusion)) = (o.truly_lit(), &o.answer.truth) {
            let object = observer.geometry.object[occlusion.first as usize];
            let (cast, kept) = &mut kept[usize::from(object)];
            *cast += 1;
            *kept += u64::from(o.visibility() < 1.0);
        }
    }
    let lost = |&(_, &(cast, kept)): &(usize, &(u64, u64))| cast > 0 && kept == 0;
    kept.iter().enumerate().filter(lost).map(|(i, _)| case.objects[i].name.clone()).collect()
}

/// At most so many samples are walked; they are spread evenly over the list.
const WALKS: usize = 48;

fn spread<'o>(list: &[&'o Observation]) -> Vec<&'o Observation> {
    let stride = list.len().div_ceil(WALKS).max(1);
    list.iter().step_by(stride).copied().collect()
}

fn peter_panning(observer: &Observer<'_>, observations: &[Observation]) -> Option<Length> {
    let is_peter_panning =
        |o: &&Observation| o.outcome.fault().is_some_and(|f| f.artifact == Artifact::PeterPanning);
    let list: Vec<&Observation> = observations.iter().filter(is_peter_panning).collect();
    let length = |o: &Observation| {
        let walk = Walk::along_light(observer, &o.receiver, observer.case().bias)?;
        let world = walk.false_light_length()?;
        Some(Length { world, texels: world / walk.texel_world() })
    };
    let lengths = spread(&list).into_iter().filter_map(length);
    lengths.max_by(|a, b| a.world.total_cmp(&b.world))
}

fn stripe_period(observer: &Observer<'_>, observations: &[Observation]) -> Option<Length> {
    let is_acne = |o: &&Observation| {
        o.truly_lit() == Some(true) && o.own_surface && o.breakpoints.iter().any(|&b| b > 0.0)
    };
    let list: Vec<&Observation> = observations.iter().filter(is_acne).collect();
    let middle = list.get(list.len() / 2)?;
    let walk = Walk::along_light(observer, &middle.receiver, 0.0)?;
    let world = walk.stripe_period()?;
    Some(Length { world, texels: world / walk.texel_world() })
}

/// What the numbers say in one sentence.
fn verdict(m: &Measurement) -> String {
    let percent = |w: &Wrongs| format!("{:.2} %", 100.0 * w.rate);
    let main = |w: &Wrongs| {
        let largest = w.by_cause.iter().max_by_key(|(_, count)| **count);
        largest
            .filter(|(_, c)| **c > 0)
            .map_or_else(String::new, |(cause, _)| format!(", mostly from {cause}"))
    };
    let errors = format!(
        "At its bias {} the map shadows {} of the lit receivers{} and lights {} of the shadowed ones{}",
        m.bias,
        percent(&m.false_shadow),
        main(&m.false_shadow),
        percent(&m.false_light),
        main(&m.false_light),
    );
    let lost = match m.lost_shadows.as_slice() {
        [] => String::new(),
        objects => format!("; the whole shadow of {} is lost", objects.join(" and ")),
    };
    let thresholds = match (m.thresholds.critical, m.thresholds.detachment) {
        (Some(critical), Some(detachment)) if detachment > critical => format!(
            "; constant biases from {critical:.3e} to {detachment:.3e} leave edge aliasing only"
        ),
        (Some(critical), Some(detachment)) => format!(
            "; no constant bias is free of artifacts: acne needs {critical:.3e}, shadows detach at {detachment:.3e}"
        ),
        _ => String::new(),
    };
    format!("{errors}{lost}{thresholds}.")
}

impl Observer<'_> {
    /// Texels in which the case's own depth attachment keeps another triangle than a float one.
    #[must_use]
    pub fn misordered_texels(&self) -> u64 {
        let ours = &self.subject.map_raster.triangle;
        let differs = |(a, b): (&u32, &u32)| a != b && *a != NO_TRIANGLE && *b != NO_TRIANGLE;
        ours.iter().zip(self.float_triangles()).filter(|&(a, b)| differs((a, b))).count() as u64
    }
}
