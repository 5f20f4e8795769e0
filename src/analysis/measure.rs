//! Measuring a case: observe its receivers, then count, rate and name.

use super::both_faces::BothFaces;
use super::captured::Captured;
use super::classify::Kind;
use super::counts::Counts;
use super::curve::Curve;
use super::effort::{Count, Effort};
use super::interior;
use super::ladder::Rung;
use super::measurement::{Length, Measurement, Samples, Wrongs, half_measured};
use super::observe::{Observation, Observer};
use super::outside::OutsideCounts;
use super::verdict::counted::Measure;
use super::walk::Walk;
use crate::raster::NO_TRIANGLE;
use crate::scene::{Case, CullRule};
use rayon::prelude::*;
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
    let mut measured = of_observer(Observer::with(case, &case.device.device(), effort), step);
    let m = &mut measured.measurement;
    let culled = m.false_light.by_cause[&Rung::Culling];
    if culled > 0 {
        let both = both_faces(case, step, effort);
        m.both_faces = Some(both);
        m.verdict = format!("{} {}", m.verdict, both.sentence(culled));
    }
    measured
}

/// The case once more, with both faces of all casters drawn.
fn both_faces(case: &Case, step: u32, effort: Effort) -> BothFaces {
    let mut drawn = case.clone();
    drawn.map.cull = CullRule::None;
    let Measurement { false_shadow, false_light, seen, .. } =
        measure_by(&drawn, step, effort).measurement;
    BothFaces { false_shadow: false_shadow.rate, false_light: false_light.rate, seen }
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
    let object = |t: u32| observer.geometry.object[t as usize];
    let counts = Counts::of(case.objects.len(), observations, inside, object);
    let (peter_panning, stripe_period) = rayon::join(
        || peter_panning(observer, &counts.panning),
        || stripe_period(observer, &counts.striped),
    );
    let (interior, interior_total) = counts.interiors(case);
    let outside = OutsideCounts::of(observer, observations);
    let left_out = outside.left_out(observer);
    let samples = samples(case, counts.samples.clone(), observations.len(), step);
    let shadow_interior = counts.shadow_interior(case);
    let measured = lit + shadowed > 0;
    let mut first_lines = outside.first_lines(observer, measured);
    first_lines.extend(shadow_interior.turned_away().filter(|_| measured));
    let by_measure = observer.counted_by_measure(observations);
    let seen_of = |kind: Kind| Some((kind, by_measure.seen_of(kind)?));
    let mut measurement = Measurement {
        name: case.name.clone(),
        document: case.document.clone(),
        device: case.device.name(),
        map_size: case.map.size,
        format: case.map.texel.name(),
        filter: case.lookup.filter.name(),
        compare: case.lookup.compare.name(),
        bias: case.bias,
        samples: Samples { left_out: left_out.clone(), ..samples },
        lit,
        shadowed,
        false_shadow: counts.wrongs(true, lit),
        false_light: counts.wrongs(false, shadowed),
        mean: by_measure.of(Measure::Mean),
        seen: by_measure.of(Measure::Seen),
        seen_by_kind: Kind::ALL.into_iter().filter_map(seen_of).collect(),
        wrong_on_rung: counts.wrong_on_rung(),
        without_bias: curve.at(0.0),
        headroom: counts.thresholds.headroom(),
        thresholds: counts.thresholds,
        exact_gap: counts.exact_gap,
        interior_total,
        interior,
        shadow_interior,
        by_object: counts.by_object(case),
        lost_shadows: counts.lost_shadows(case),
        left_out,
        lost_casters: outside.lost_casters(observer),
        both_faces: None,
        peter_panning,
        stripe_period,
        misordered_texels: observer.misordered_texels(),
        assumptions: case.assumptions.clone(),
        facts: case.facts.clone(),
        first_lines,
        verdict: String::new(),
    };
    let said = verdict(&measurement);
    let lines = measurement.first_lines.iter().chain([&said]);
    measurement.verdict = lines.map(String::as_str).collect::<Vec<_>>().join(" ");
    measurement
}

fn samples(case: &Case, standings: Samples, receivers: usize, step: u32) -> Samples {
    let along = |size: u32| u64::from(size.div_ceil(step));
    let pixels = along(case.canvas[0]) * along(case.canvas[1]);
    Samples { pixels, background: pixels - receivers as u64, ..standings }
}

/// Why no receiver of a case was measured at every `step`-th pixel and what to change, in one sentence
/// without its full stop. Observes the case anew.
#[must_use]
pub fn unmeasured(case: &Case, step: u32) -> String {
    let observer = Observer::new(case, &case.device.device());
    let (observations, _) = observer.observe_all(step);
    let mut standings = Samples::default();
    observations.iter().for_each(|o| standings.add(o));
    let left_out = OutsideCounts::of(&observer, &observations).left_out(&observer);
    let samples = samples(case, standings, observations.len(), step);
    format!("{}: {}", case.name, Samples { left_out, ..samples }.unmeasured())
}

/// At most so many samples are walked; they are spread evenly over the list.
const WALKS: usize = 48;

fn spread<'o>(list: &[&'o Observation]) -> Vec<&'o Observation> {
    let stride = list.len().div_ceil(WALKS).max(1);
    list.iter().step_by(stride).copied().collect()
}

fn peter_panning(observer: &Observer<'_>, list: &[&Observation]) -> Option<Length> {
    let length = |o: &Observation| {
        let walk = Walk::along_light(observer, &o.receiver, observer.case().bias)?;
        let world = walk.false_light_length()?;
        Some(Length { world, texels: world / walk.texel_world() })
    };
    let lengths: Vec<Option<Length>> = spread(list).into_par_iter().map(length).collect();
    lengths.into_iter().flatten().max_by(|a, b| a.world.total_cmp(&b.world))
}

fn stripe_period(observer: &Observer<'_>, list: &[&Observation]) -> Option<Length> {
    let middle = list.get(list.len() / 2)?;
    let walk = Walk::along_light(observer, &middle.receiver, 0.0)?;
    let world = walk.stripe_period()?;
    Some(Length { world, texels: world / walk.texel_world() })
}

/// What the numbers say in one sentence.
fn verdict(m: &Measurement) -> String {
    if m.lit + m.shadowed == 0 {
        return capital(&format!("{}.", m.samples.unmeasured()));
    }
    let main = |w: &Wrongs| {
        // Of equals the last by name.
        let largest = w.by_cause.iter().max_by_key(|(cause, count)| (**count, cause.name()));
        largest
            .filter(|(_, c)| **c > 0)
            .map_or_else(String::new, |(cause, _)| format!(", mostly from {cause}"))
    };
    let said = |verb: &str, w: &Wrongs, whom: &str| {
        let rate = 100.0 * w.rate?;
        Some(format!("{verb} {rate:.2} % of the {whom}{}", main(w)))
    };
    let whom = if m.lit == 0 { "shadowed receivers" } else { "shadowed ones" };
    let errors =
        [said("shadows", &m.false_shadow, "lit receivers"), said("lights", &m.false_light, whom)];
    let errors: Vec<String> = errors.into_iter().flatten().collect();
    let half = half_measured([m.lit, m.shadowed]).map_or_else(String::new, |s| format!("; {s}"));
    let errors = format!("At its bias {} the map {}{half}", m.bias, errors.join(" and "));
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

/// A sentence that begins with a capital.
fn capital(text: &str) -> String {
    let mut rest = text.chars();
    rest.next().map_or_else(String::new, |c| c.to_uppercase().chain(rest).collect())
}

impl Observer<'_> {
    /// Texels in which the case's own depth attachment keeps another triangle than a float one.
    #[must_use]
    pub fn misordered_texels(&self) -> u64 {
        let ours = &self.subject.map_raster.triangle;
        let differs = |(a, b): (&u32, &u32)| a != b && *a != NO_TRIANGLE && *b != NO_TRIANGLE;
        let pairs = ours.par_iter().with_min_len(1 << 14).zip(self.float_triangles());
        pairs.filter(|&(a, b)| differs((a, b))).count() as u64
    }
}
