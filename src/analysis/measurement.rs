//! The numbers of a measured case, as they stand in `results.json`.

use super::both_faces::BothFaces;
use super::classify::{Artifact, Kind, Side};
use super::curve::{Errors, Thresholds};
use super::ladder::Rung;
use super::observe::Observation;
use super::outside::{LeftOut, LostCaster, reasons};
use crate::scene::Fact;
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
    /// Receivers outside the map that the look-up says are shadowed nevertheless.
    pub outside_map_shadowed: u64,
    /// On a surface that receives no shadow; left out of files where there are none.
    #[serde(skip_serializing_if = "is_zero")]
    pub receives_none: u64,
    /// Triangles that met a counted receiver itself.
    pub touching: u64,
    /// Receivers outside the map or the cone by reason; results have them beside the samples.
    #[serde(skip)]
    pub left_out: Vec<LeftOut>,
}

#[allow(clippy::trivially_copy_pass_by_ref, reason = "serde passes a reference")]
const fn is_zero(n: &u64) -> bool {
    *n == 0
}

impl Samples {
    /// Why no receiver was measured and what to change, for the end of a sentence.
    #[must_use]
    pub fn unmeasured(&self) -> String {
        let standings = [
            (
                self.facing_away,
                "face away from the light",
                "turn the light or the camera so that it sees the side that the light reaches",
            ),
            (
                self.outside_cone,
                "lie outside the light's cone",
                "turn the light towards what the camera sees, or widen its cone (light.fovy)",
            ),
            (
                self.outside_map,
                "lie outside the map",
                "move or widen the light's box (light.width, near, far) around what the camera sees",
            ),
            (
                self.ambiguous,
                "cannot be decided",
                "move the light out of the planes of the surfaces",
            ),
        ];
        let standings = standings.into_iter().chain((self.receives_none > 0).then_some((
            self.receives_none,
            "lie on surfaces that receive no shadow",
            "let a surface that the camera sees receive shadows",
        )));
        let standings: Vec<_> = standings.collect();
        let largest = standings.iter().rev().max_by_key(|reason| reason.0);
        let seen = standings.iter().any(|reason| reason.0 > 0);
        let fix = largest.filter(|_| seen).map_or("turn the camera towards the scene", |r| r.2);
        let outside: u64 = self.left_out.iter().map(|left| left.receivers).sum();
        let fix = match largest.is_some_and(|r| r.0 > 0 && r.0 <= outside) {
            true => {
                format!("{outside} lie outside the light's volume{}", reasons(&self.left_out))
            }
            false => fix.to_string(),
        };
        let counts = standings.iter().map(|(n, what, _)| format!("{n} {what}"));
        let background = format!("{} are background", self.background);
        let list: Vec<String> = std::iter::once(background).chain(counts).collect();
        format!("no receiver was measured (of {} pixels {}); {fix}", self.pixels, list.join(", "))
    }
}

/// The share of `n` among `all`; `None` where there are none: it is not measured.
#[must_use]
pub fn share(n: u64, all: u64) -> Option<f64> {
    (all > 0).then(|| n as f64 / all as f64)
}

/// What is not measured where one of the truly lit and the truly shadowed is empty, for the end of a
/// sentence; `None` where neither is, or both are.
#[must_use]
pub fn half_measured(populations: [u64; 2]) -> Option<&'static str> {
    match populations.map(|n| n > 0) {
        [false, true] => Some("no receiver is truly lit, so acne is not measured"),
        [true, false] => Some("no receiver is truly shadowed, so lost shadow is not measured"),
        [true, true] | [false, false] => None,
    }
}

/// One kind of wrong verdict.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Wrongs {
    /// Receivers with a wrong verdict.
    pub count: u64,
    /// Their share of the truly lit (or shadowed) receivers; `None` where there are none: not measured.
    pub rate: Option<f64>,
    /// Σ|v − truth|.
    pub weight: f64,
    /// By the first rung from which the verdict stays wrong.
    pub by_cause: BTreeMap<Rung, u64>,
    /// By what it is called.
    pub by_artifact: BTreeMap<Artifact, u64>,
}

/// Counts of one object's receivers.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ObjectTally {
    /// Truly lit.
    pub lit: u64,
    /// Truly shadowed.
    pub shadowed: u64,
    /// Truly lit receivers with a wrong verdict.
    pub false_shadow: u64,
    /// Truly shadowed receivers with a wrong verdict.
    pub false_light: u64,
    /// Truly lit receivers with a wrong verdict where there is no bias.
    pub false_shadow_without_bias: u64,
}

impl ObjectTally {
    pub(super) fn add(&mut self, o: &Observation) {
        match o.truly_lit() {
            Some(true) => self.lit += 1,
            Some(false) => self.shadowed += 1,
            None => {}
        }
        match o.outcome.fault().map(|fault| fault.kind.side()) {
            Some(Side::FalseShadow) => self.false_shadow += 1,
            Some(Side::FalseLight) => self.false_light += 1,
            None => {}
        }
        let dark_without_bias = o.breakpoints.iter().any(|&b| b > 0.0);
        self.false_shadow_without_bias +=
            u64::from(o.truly_lit() == Some(true) && dark_without_bias);
    }
}

impl ObjectTally {
    /// Adds the counts of another object of the same name.
    pub(super) fn merge(&mut self, other: &Self) {
        self.lit += other.lit;
        self.shadowed += other.shadowed;
        self.false_shadow += other.false_shadow;
        self.false_light += other.false_light;
        self.false_shadow_without_bias += other.false_shadow_without_bias;
    }
}

/// Acne away from every edge.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct InteriorTotal {
    /// Truly lit interior receivers.
    pub lit: u64,
    /// Share of them dark at the case's bias; `None` where there are none.
    pub acne_rate: Option<f64>,
    /// Share of them dark without any bias; `None` where there are none.
    pub acne_rate_without_bias: Option<f64>,
}

impl InteriorTotal {
    pub(super) fn of(tallies: &BTreeMap<String, ObjectTally>) -> Self {
        let sum = |count: fn(&ObjectTally) -> u64| tallies.values().map(count).sum::<u64>();
        let lit = sum(|t| t.lit);
        let share = |n: u64| share(n, lit);
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
    /// Truly shadowed interior receivers that are lit, at least partly.
    pub leaks: u64,
    /// Their share; `None` where there are none.
    pub leak_rate: Option<f64>,
    /// Leaks by the receiver's object.
    pub leaks_by_object: BTreeMap<String, u64>,
    /// Receivers among them that face away from the light.
    #[serde(skip_serializing_if = "is_none")]
    pub facing_away: u64,
    /// Leaks among them that face away from the light.
    #[serde(skip_serializing_if = "is_none")]
    pub leaks_facing_away: u64,
}

/// Whether a count is 0.
#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes fields so")]
const fn is_none(count: &u64) -> bool {
    *count == 0
}

/// Faces turned away that leak in more than this share are told of.
const TOLD: f64 = 0.01;

impl ShadowInterior {
    /// What faces that are turned away from the light show, in one sentence; nothing where that is little.
    pub(super) fn turned_away(&self) -> Option<String> {
        let leaks = share(self.leaks_facing_away, self.facing_away)?;
        let told = "Faces turned away from the light count in no rate";
        (leaks > TOLD).then(|| {
            format!(
                "{told}: away from every edge the map lights {:.1} % of them ({} of {}), which a material shows that does not shade by N·L.",
                100.0 * leaks, self.leaks_facing_away, self.facing_away
            )
        })
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
#[non_exhaustive]
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
    /// Σ|v − t| over all counted receivers as a share of them; `None` where there are none.
    pub mean: Option<f64>,
    /// Σ max(N·L, 0)·|v − t| / Σ max(N·L, 0): what a white surface shows; `None` where nothing faces the
    /// light.
    pub seen: Option<f64>,
    /// What is seen of each kind; the kinds add up to `seen`.
    pub seen_by_kind: BTreeMap<Kind, f64>,
    /// Counts of wrong verdicts on each rung.
    pub wrong_on_rung: BTreeMap<Rung, u64>,
    /// Errors without any bias.
    pub without_bias: Errors,
    /// Largest breakpoint of acne, smallest of lost shadow.
    pub thresholds: Thresholds,
    /// detachment − critical.
    pub headroom: Option<f64>,
    /// Exact depth gaps of the truly shadowed.
    pub exact_gap: Option<Gap>,
    /// Receivers away from every edge, by object.
    pub interior: BTreeMap<String, ObjectTally>,
    /// The interior of all objects together.
    pub interior_total: InteriorTotal,
    /// Truly shadowed receivers away from every edge, those that face away from the light included.
    pub shadow_interior: ShadowInterior,
    /// All receivers, by object.
    pub by_object: BTreeMap<String, ObjectTally>,
    /// Objects whose whole shadow is gone although it covers counted receivers.
    pub lost_shadows: Vec<String>,
    /// Receivers outside the map or the cone by reason, with the values that would include them.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub left_out: Vec<LeftOut>,
    /// Objects that shadow receivers from before near or beyond far, where no map draws them.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub lost_casters: Vec<LostCaster>,
    /// What drawing both faces would change; where culling causes no false light, `None`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub both_faces: Option<BothFaces>,
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
    /// What was left out of the scene and can change a shadow, what lies outside the light's volume, which
    /// casters are cut off, what faces turned away show: sentences that come before all else.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub first_lines: Vec<String>,
    /// The first lines, then what the numbers say in one sentence.
    pub verdict: String,
}

impl Measurement {
    /// The verdict without its first lines.
    #[must_use]
    pub fn after_first_lines(&self) -> &str {
        let first = self.first_lines.join(" ");
        self.verdict.strip_prefix(&first).unwrap_or(&self.verdict).trim_start()
    }
}
