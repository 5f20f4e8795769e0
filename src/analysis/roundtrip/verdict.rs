//! One sentence per packing: whether to use it, why not, and what to use instead.

use super::certificate::Certificate;
use crate::num::exp2;

crate::catalogue! {
    /// What to do with a packing.
    pub enum Advice {
        /// Keeps its bits under every store and keeps the far plane.
        Use = "use",
        /// Keeps its bits with care.
        Care = "with care",
        /// Loses bits or order on hardware that exists.
        Avoid = "avoid",
    }
}

/// A packing's certificates in f32: under each store, and in half precision.
#[derive(Clone, Copy, Debug)]
pub struct Evidence<'a> {
    /// Bytes rounded.
    pub rounded: &'a Certificate,
    /// Bytes truncated.
    pub truncated: &'a Certificate,
    /// Any byte that D3D admits.
    pub admissible: &'a Certificate,
    /// Half-precision arithmetic, bytes rounded.
    pub fp16: &'a Certificate,
    /// A sampler that returns half precision.
    pub half_sampler: &'a Certificate,
}

/// The advice and its sentence.
#[must_use]
pub fn verdict(evidence: Evidence<'_>) -> (Advice, String) {
    let certificate = evidence.rounded;
    let channels = certificate.channels.unwrap_or(4) as i32;
    let expected = exp2(-8 * channels);
    let inverted = certificate.order.is_some_and(|o| o.inversions > 0);
    let lossy = certificate.max.error > 16.0 * expected.max(exp2(-24));
    let fragile = evidence.truncated.max.error > 16.0 * certificate.max.error.max(exp2(-33));
    let wraps = (certificate.at_one - 1.0).abs() > 0.01;
    let clipped = !wraps && certificate.at_one < 1.0 - 16.0 * expected;
    let mut faults = Vec::new();
    if channels == 1 {
        faults.push(format!("holds {:.1} bits", certificate.equivalent_bits));
    }
    if lossy {
        let bits = certificate.equivalent_bits;
        let stored = 8 * channels;
        faults.push(format!("keeps {bits:.1} of the {stored} bits it stores"));
    }
    if wraps {
        faults.push("turns the far plane into the nearest depth".to_string());
    } else if clipped {
        faults.push(format!("reads the far plane as {}", certificate.at_one));
    }
    if inverted && !wraps {
        faults.push("puts some depths in the wrong order".to_string());
    }
    if fragile && !lossy {
        let bits = evidence.truncated.equivalent_bits;
        faults.push(format!("falls to {bits:.1} bits where the store truncates"));
    }
    let coarse_sampler = evidence.half_sampler.max.error > 16.0 * certificate.max.error;
    let advice = match (faults.is_empty(), coarse_sampler) {
        (false, _) => Advice::Avoid,
        (true, true) => Advice::Care,
        (true, false) => Advice::Use,
    };
    (advice, sentence(evidence, advice, &faults))
}

fn sentence(evidence: Evidence<'_>, advice: Advice, faults: &[String]) -> String {
    let certificate = evidence.rounded;
    let instead = match certificate.channels {
        Some(1) => "store more channels, as digits-16 or digits-24 do",
        Some(2) => "use digits-16",
        _ => "use digits-24",
    };
    if advice == Advice::Avoid {
        return format!("It {}: {instead}.", listed(faults));
    }
    let bits = certificate.equivalent_bits.min(32.0);
    let mut needs = Vec::new();
    if evidence.fp16.sound.broken > 0 {
        needs.push("highp in the shader".to_string());
    }
    if advice == Advice::Care {
        needs.push(format!("samplers of full precision ({instead} where they are not)"));
    }
    let needs =
        if needs.is_empty() { String::new() } else { format!("; it needs {}", listed(&needs)) };
    format!("It keeps {bits:.1} bits and the far plane under every store{needs}.")
}

fn listed(faults: &[String]) -> String {
    match faults {
        [one] => one.clone(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
        [] => String::new(),
    }
}
