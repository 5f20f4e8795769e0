//! `results.json`: every certificate, told once for packings with the same operations.

use super::{CertifyOptions, Dossier, Measured, SCHEMA, SETTINGS, Setting};
use crate::analysis::roundtrip::certificate::{Certificate, Promise, RangeError, Special};
use serde_json::{Value, json};

/// The body of `results.json`.
pub(super) fn results(options: &CertifyOptions, measured: &Measured) -> Value {
    let distinct: Vec<&Dossier> = measured.distinct().collect();
    let packing = |dossier: &Dossier| {
        let told = distinct.iter().find(|d| d.name != dossier.name && d.same_as(dossier));
        let mut value = json!({
            "name": dossier.name,
            "about": dossier.about,
            "advice": dossier.advice.name(),
            "sentence": dossier.sentence,
        });
        match told {
            Some(told) => value["same_operations_as"] = json!(told.name),
            None => value["certificates"] = certificates(dossier),
        }
        value
    };
    json!({
        "schema": SCHEMA,
        "profile": options.profile.name(),
        "seed": options.seed,
        "packings": measured.dossiers.iter().map(packing).collect::<Vec<_>>(),
        "formats": measured.formats.iter().map(whole).collect::<Vec<_>>(),
    })
}

/// By setting; ranges and unusual depths for the plain one alone.
fn certificates(dossier: &Dossier) -> Value {
    let told = |(i, setting): (usize, &Setting)| {
        let certificate = &dossier.certificates[i];
        let mut value = if i == 0 { whole(certificate) } else { brief(certificate) };
        value["hardware"] = json!(setting.name);
        value
    };
    SETTINGS.iter().enumerate().map(told).collect()
}

fn brief(c: &Certificate) -> Value {
    let mut value = json!({
        "store": c.store,
        "load": c.load,
        "arithmetic": c.arithmetic,
        "method": c.method,
        "answered": c.answered,
        "evaluated": c.evaluated,
        "max": c.max.error,
        "max_at": c.max.at,
        "mean": c.mean,
        "rms": c.rms,
        "equivalent_bits": c.equivalent_bits,
        "at_one": c.at_one,
        "forced_bias": c.forced_bias,
        "not_idempotent": share(c.idempotent),
        "not_invertible": share(c.invertible),
        "not_sound": share(c.sound),
    });
    if let Some(order) = c.order {
        value["inversions"] = json!(order.inversions);
        value["largest_drop"] = json!(order.largest_drop.error);
    }
    if let Some(bound) = &c.bound {
        value["bound"] = json!(bound.value);
    }
    value
}

fn whole(c: &Certificate) -> Value {
    let mut value = brief(c);
    value["exact_from"] = json!(c.exact_from);
    value["looked_at"] = json!(c.idempotent.tested);
    value["above"] = json!(c.above);
    value["below"] = json!(c.below);
    value["ranges"] = c.ranges.iter().map(range).collect();
    value["specials"] = c.specials.iter().map(|s| (s.depth.to_string(), special(s))).collect();
    if let Some(bound) = &c.bound {
        value["because"] = json!(bound.because);
    }
    value
}

fn share(promise: Promise) -> f64 {
    promise.broken as f64 / promise.tested.max(1) as f64
}

fn range(r: &RangeError) -> Value {
    json!({
        "from": r.from,
        "max": r.max.error,
        "max_at": r.max.at,
        "mean": r.mean,
        "rms": r.rms,
    })
}

/// Bytes in hexadecimal, then what they decode to.
fn special(s: &Special) -> Value {
    let bytes: Vec<String> = s.texel.iter().map(|byte| format!("{byte:02x}")).collect();
    json!(format!("{} -> {}", bytes.concat(), s.decoded))
}
