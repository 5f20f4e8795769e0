//! Near/far ratio and distance: where a depth format can no longer part two plates (T14).
//!
//! Two plates face the light t = 1 cm apart. A constant bias b works iff κq ≤ b < t′ − (1 − κ)q,
//! with t′ the gap in window depth and q the format's quantum there: no bias works once t′ < q.
//! Window depths are correctly rounded to f32 here, so that the format alone is stressed.

use super::search::{ladder, onset, phases};
use super::{Fate, Forecast, Row, Sampling, Stress};
use crate::depth::{DepthFormat, DepthMapping, MappingKind};
use crate::num::exp2;
use crate::report::Scale;
use crate::scene::CompareRule;
use crate::shadow::breakpoint;

/// Distance of the near plane, world units.
const NEAR: f64 = 0.1;
/// Distance between the plates, world units.
const GAP: f64 = 0.01;
/// The largest ratio of far to near.
const RATIO: f64 = 1e9;

const COMBINATIONS: [(MappingKind, DepthFormat); 8] = [
    (MappingKind::Perspective, DepthFormat::Unorm16),
    (MappingKind::Perspective, DepthFormat::Unorm24),
    (MappingKind::Perspective, DepthFormat::F16),
    (MappingKind::Perspective, DepthFormat::F32),
    (MappingKind::Reversed, DepthFormat::Unorm24),
    (MappingKind::Reversed, DepthFormat::F16),
    (MappingKind::Reversed, DepthFormat::F32),
    (MappingKind::ReversedInfinite, DepthFormat::F32),
];

/// A mapping with the format that keeps it.
#[derive(Clone, Copy)]
struct Store {
    mapping: DepthMapping,
    format: DepthFormat,
}

impl Store {
    fn new(kind: MappingKind, format: DepthFormat, ratio: f64) -> Self {
        let mapping = DepthMapping::new(kind, NEAR, NEAR * ratio).expect("near is below far");
        Self { mapping, format }
    }

    fn name(self) -> String {
        format!("{}-{}", self.mapping.kind(), self.format)
    }

    fn window(self, distance: f64) -> f32 {
        self.mapping.window_from_distance(distance) as f32
    }

    fn stored(self, distance: f64) -> f32 {
        self.format.decode(self.format.encode(self.window(distance)))
    }

    /// The smallest bias at which a receiver is lit beside a caster.
    fn breakpoint(self, receiver: f64, caster: f64) -> f32 {
        let sign = if self.mapping.is_reversed() { -1.0 } else { 1.0 };
        let (z, stored) = (self.window(receiver), self.stored(caster));
        breakpoint(CompareRule::ReceiverBeyond, sign * z, sign * stored)
    }

    /// Whether some constant bias keeps the far plate lit beside itself and dark behind the near one,
    /// whatever the phase of `distance` in the format's steps.
    fn usable(self, distance: f64, samples: u32) -> bool {
        let step = self.quantum_world(distance).min(0.01 * distance);
        let (mut critical, mut detachment) = (f32::NEG_INFINITY, f32::INFINITY);
        for phase in phases(samples) {
            let receiver = distance - step * phase;
            critical = critical.max(self.breakpoint(receiver, receiver));
            detachment = detachment.min(self.breakpoint(receiver, receiver - GAP));
        }
        critical < detachment
    }

    /// One step of the format in world units.
    fn quantum_world(self, distance: f64) -> f64 {
        self.format.quantum(self.window(distance)) * self.mapping.world_per_window(distance)
    }

    /// The largest error of a stored distance around `distance`, world units.
    fn error(self, distance: f64, samples: u32) -> f64 {
        let step = self.quantum_world(distance).min(0.5 * distance);
        let error = |phase: f64| {
            let z = distance - step * phase;
            let read = self.mapping.distance_from_window(f64::from(self.stored(z)));
            (read - z).abs().min(self.mapping.far())
        };
        phases(samples).map(error).fold(0.0, f64::max)
    }

    /// The largest error of a stored window depth around `window`: the depth is rounded to f32 before
    /// it is stored, rounded to a step of the format, and what is read is rounded to f32 again.
    ///
    /// ½ulp + ½q + ½ulp for UNORM codes; a float's code is read exactly, ½ulp + ½q, and f32 is its own
    /// format, ½ulp. Above ½ a 24-bit code loses nothing: f32 has 2²³ values there, one code each,
    /// k = j − 1 for j·2⁻²⁴, and k/(2²⁴ − 1) lies within 2⁻²⁵ of j·2⁻²⁴ and rounds back to it.
    fn depth_error(self, window: f32) -> f64 {
        let ulp = DepthFormat::F32.quantum(window);
        let step = self.format.quantum(window);
        let exact = self.format == DepthFormat::Unorm24 && window > 0.5;
        if exact || self.format == DepthFormat::F32 {
            ulp / 2.0
        } else if self.format.unorm_max().is_some() {
            step / 2.0 + ulp
        } else {
            step / 2.0 + ulp / 2.0
        }
    }

    /// [`Self::depth_error`] in world units, the larger at both ends of a step: it may cross a binade.
    fn error_bound(self, distance: f64) -> f64 {
        let step = self.quantum_world(distance).min(0.5 * distance);
        let ends = [distance, distance - step].map(|z| self.depth_error(self.window(z)));
        let error = ends[0].max(ends[1]) * self.mapping.world_per_window(distance);
        error.min(self.mapping.far())
    }

    /// nf/(f − n), or n for an infinite far plane: window depth is ∓this/Z plus a constant.
    fn scale(self) -> f64 {
        let (n, f) = (self.mapping.near(), self.mapping.far());
        if self.mapping.kind() == MappingKind::ReversedInfinite { n } else { n * f / (f - n) }
    }

    /// Distance beyond which the plates' window gap K·t/(Z(Z − t)) is below `quantum`.
    fn merged_beyond(self, quantum: f64) -> f64 {
        GAP / 2.0 + f64::sqrt(GAP * GAP / 4.0 + self.scale() * GAP / quantum)
    }

    /// The first distance at which the gap is below the format's quantum.
    fn first_merged(self) -> f64 {
        if let Some(max) = self.format.unorm_max() {
            return self.merged_beyond(1.0 / f64::from(max));
        }
        let digits = self.format.significant_bits() as i32;
        if !self.mapping.is_reversed() {
            return self.merged_beyond(exp2(-digits)); // depths in [½, 1) beyond 2n
        }
        let in_binade = |e: i32| {
            let first = self.mapping.distance_from_window(exp2(e + 1));
            let last = self.mapping.distance_from_window(exp2(e));
            let merged = self.merged_beyond(exp2(e + 1 - digits)).max(first);
            (merged <= last).then_some(merged)
        };
        (1..100).find_map(|e| in_binade(-e)).expect("relative precision ends")
    }
}

fn at_distance(effort: &Sampling, (kind, format): (MappingKind, DepthFormat)) -> Row {
    let store = Store::new(kind, format, RATIO);
    let distances = ladder(0.2, 0.999 * NEAR * RATIO, 20);
    let event = "no constant bias parts two plates 1 cm apart";
    let formula = "Z(Z − t) = K·t/q with K = nf/(f − n), q the format's step";
    let forecast = Forecast::at(Fate::Breaks, store.first_merged(), store.name(), event, formula)
        .curve(&distances, |z| store.error_bound(z));
    let measured = onset(0.2, 1e7, 700, |z| !store.usable(z, effort.samples));
    let curve = distances.iter().map(|&z| (z, store.error(z, effort.samples))).collect();
    let at_far = store.quantum_world(0.999 * store.mapping.far());
    let note = format!("One step near the far plane at 10⁸ is {} world units.", text(at_far));
    forecast.met(measured, curve).noting(note)
}

/// Distance from the light at far/near = 10⁹ and infinite.
pub(super) fn distances(effort: &Sampling) -> Stress {
    Stress {
        id: "distance",
        title: "Distance from the light, far/near = 10⁹ and infinite",
        lead: "Two plates facing the light, 1 cm apart, near plane at 0.1: from which distance on does \
               no constant bias part them? The curve is the largest error of a stored distance, the \
               theory the sum of its roundings: to f32, to a step of the format, to f32 when read."
            .to_string(),
        parameter: "distance from the light [world units]",
        error: "error of the stored distance [world units]",
        scale: Scale::Log,
        rows: COMBINATIONS.iter().map(|&c| at_distance(effort, c)).collect(),
    }
}

fn at_ratio(effort: &Sampling, kind: MappingKind, format: DepthFormat) -> Row {
    let name = format!("ladder-{}", Store::new(kind, format, 2.0).name());
    let ratios = ladder(10.0, RATIO, 17);
    let far = |ratio: f64| NEAR * ratio;
    let store = |ratio: f64| Store::new(kind, format, ratio);
    let event = "no constant bias parts two plates 1 cm apart at the far plane";
    let forecast = match kind {
        MappingKind::Reversed => {
            Forecast::never(name, event, "reversed floats keep their relative step down to depth 0")
        }
        MappingKind::Orthographic
        | MappingKind::Linear
        | MappingKind::Perspective
        | MappingKind::ReversedInfinite => {
            let quantum = format.quantum(0.75);
            let root = (NEAR - GAP) * (NEAR - GAP) + 4.0 * NEAR * GAP / quantum;
            let onset = ((NEAR + GAP) + f64::sqrt(root)) / 2.0 / NEAR;
            let formula = "(f − n)(f − t) = n·t/q";
            Forecast::at(Fate::Breaks, onset, name, event, formula)
        }
    };
    let forecast = forecast.curve(&ratios, |r| store(r).error_bound(0.999 * far(r)));
    let bad = |r: f64| !store(r).usable(far(r), effort.samples);
    let measured = onset(10.0, RATIO, 500, bad);
    let error = |&r: &f64| (r, store(r).error(0.999 * far(r), effort.samples));
    forecast.met(measured, ratios.iter().map(error).collect())
}

/// T14: far/near from 10 to 10⁹ with the receiver at the far plane.
pub(super) fn ratios(effort: &Sampling) -> Stress {
    use DepthFormat::{F32, Unorm16, Unorm24};
    use MappingKind::{Perspective, Reversed};
    let combinations =
        [(Perspective, Unorm16), (Perspective, Unorm24), (Perspective, F32), (Reversed, F32)];
    Stress {
        id: "near-far",
        title: "Ratio of far to near (T14)",
        lead: "The same two plates at the far plane, near plane at 0.1, far plane moved out: at which \
               ratio is the last usable bias gone?"
            .to_string(),
        parameter: "far / near",
        error: "error of the stored distance at the far plane [world units]",
        scale: Scale::Log,
        rows: combinations.map(|(kind, format)| at_ratio(effort, kind, format)).into(),
    }
}

fn text(value: f64) -> String {
    crate::report::number::pretty(value, 3)
}
