//! Measuring a case: observe its receivers, then count, rate and name.

use super::captured::Captured;
use super::classify::Artifact;
use super::curve::{Curve, Thresholds};
use super::effort::{Count, Effort};
use super::interior;
use super::ladder::Rung;
use super::measurement::{
    Gap, InteriorTotal, Length, Measurement, Samples, ShadowInterior, Tally, Wrongs,
};
use super::observe::{Observation, Observer, Standing};
use super::walk::Walk;
use crate::raster::NO_TRIANGLE;
use crate::scene::Case;
use crate::truth::Truth;
use std::collections::BTreeMap;
use std::sync::Arc;

/// A measured case with the receivers behind the numbers.
#[derive(Debug)]
pub struct Measured<'a> {
    /// The drawn case and its truth.
    pub observer: Arc<Observer<'a>>,
    /// Every observed receiver.
    pub observations: Vec<Observation>,
    /// Its constant-bias curves.
    pub curve: Curve,
    /// The numbers.
    pub measurement: Measurement,
    /// What the skips saved.
    pub work: Vec<Count>,
}

/// Measures a case on its own device at every `step`-th pixel.
#[must_use]
pub fn measure(case: &Case, step: u32) -> Measured<'_> {
    measure_by(case, step, Effort::default())
}

/// As [`measure`], by a given effort; the result is the same.
#[must_use]
pub fn measure_by(case: &Case, step: u32, effort: Effort) -> Measured<'_> {
    of_observer(Observer::with(case, &case.device.device(), effort), step)
}

/// As [`measure_by`], every look-up reading a captured map.
#[must_use]
pub fn measure_captured<'a>(
    case: &'a Case,
    step: u32,
    effort: Effort,
    captured: &Captured,
) -> Measured<'a> {
    let mut observer = Observer::with(case, &case.device.device(), effort);
    observer.subject.map = captured.map.clone();
    of_observer(observer, step)
}

fn of_observer(observer: Observer<'_>, step: u32) -> Measured<'_> {
    let (observations, mut work) = observer.observe_all(step);
    let ((inside, count), curve) =
        rayon::join(|| interior::counted(&observer, &observations), || Curve::new(&observations));
    work.push(count);
    let measurement = summarize(&observer, &observations, &curve, &inside, step);
    Measured { observer: Arc::new(observer), observations, curve, measurement, work }
}

fn summarize(
    observer: &Observer<'_>,
    observations: &[Observation],
    curve: &Curve,
    inside: &[bool],
    step: u32,
) -> Measurement {
    let case = observer.case();
    let [lit, shadowed] = curve.populations();
    let (lengths, (interior, shadow_interior)) = rayon::join(
        || (peter_panning(observer, observations), stripe_period(observer, observations)),
        || {
            let inside = observations.iter().zip(inside).filter(|(_, inside)| **inside);
            let interior: Vec<&Observation> = inside.map(|(o, _)| o).collect();
            let shadow_interior = ShadowInterior::of(case, interior.iter().copied());
            (by_object(case, interior.into_iter()), shadow_interior)
        },
    );
    let (thresholds, by_object) =
        rayon::join(|| Thresholds::of(observations), || by_object(case, observations.iter()));
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
        by_object,
        lost_shadows: lost_shadows(observer, observations),
        peter_panning: lengths.0,
        stripe_period: lengths.1,
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
    let mut samples =
        Samples { pixels, background: pixels - observations.len() as u64, ..Samples::default() };
    for o in observations {
        match o.standing {
            Standing::Counted => {
                samples.counted += 1;
                samples.touching += u64::from(o.answer.touching);
            }
            Standing::Ambiguous => samples.ambiguous += 1,
            Standing::FacingAway => samples.facing_away += 1,
            Standing::OutsideCone => samples.outside_cone += 1,
            Standing::OutsideMap => {
                samples.outside_map += 1;
                samples.outside_map_shadowed += u64::from(o.visibility() < 1.0);
            }
        }
    }
    samples
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
    let mut counts = [0u64; 5];
    for o in observations {
        counts.iter_mut().zip(o.wrong).for_each(|(count, wrong)| *count += u64::from(wrong));
    }
    Rung::ALL.iter().map(|rung| rung.name()).zip(counts).collect()
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
    let mut tallies = vec![Tally::default(); case.objects.len()];
    observations.for_each(|o| tallies[usize::from(o.object)].add(o));
    let mut by_name: BTreeMap<String, Tally> = BTreeMap::new();
    for (object, tally) in case.objects.iter().zip(&tallies) {
        by_name.entry(object.name.clone()).or_default().merge(tally);
    }
    by_name
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
