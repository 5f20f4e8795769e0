//! Half precision: texture coordinates, packing digits and packing constants on `mediump` phones.

use super::search::{ladder, onset, phases};
use super::{Fate, Forecast, Sampling, Stress};
use crate::depth::Packing;
use crate::depth::arith::{Mediump, Number, Shader};
use crate::num::{exp2, to_half};
use crate::report::Scale;
use crate::scene::Wrap;
use crate::shadow::sampler::nearest_texel;
use std::collections::BTreeSet;

/// Share of coordinates in [½, 1) that pick another texel once rounded to half precision.
fn misplaced(size: u32, samples: u32) -> f64 {
    let texel = |u: f32| nearest_texel(u, size, Wrap::Clamp, false);
    let wrong = |phase: f64| {
        let u = (0.5 + phase / 2.0) as f32;
        texel(to_half(u)) != texel(u)
    };
    phases(samples).filter(|&p| wrong(p)).count() as f64 / f64::from(samples)
}

/// Map sizes that half-precision coordinates can address.
pub(super) fn coordinates(effort: &Sampling) -> Stress {
    let sizes: Vec<f64> = (4..=11).map(exp2).collect();
    let samples = 64 * effort.samples;
    let curve: Vec<_> = sizes.iter().map(|&n| (n, misplaced(n as u32, samples))).collect();
    let predicted = 0.1 * exp2(12);
    let event = "one look-up in ten reads a wrong texel";
    let formula =
        "N·2⁻¹²: u in [½, 1) is rounded up over a border from half a step of 2⁻¹¹ below it";
    let forecast = Forecast::at(Fate::Degrades, predicted, "mediump-coordinates", event, formula)
        .curve(&sizes, |n| n * exp2(-12));
    // Between the two powers of two around a tenth, in proportion.
    let measured = curve.windows(2).find(|w| w[1].1 > 0.1).map(|w| {
        let share = (0.1 - w[0].1) / (w[1].1 - w[0].1);
        w[0].0 + share * (w[1].0 - w[0].0)
    });
    Stress {
        id: "mediump-coordinates",
        title: "mediump texture coordinates",
        lead: "u is rounded to half precision before NEAREST picks a texel of a map of 16 to 2048."
            .to_string(),
        parameter: "texels per side",
        error: "share of look-ups in a wrong texel",
        scale: Scale::Log,
        rows: vec![forecast.met(measured, curve)],
    }
}

/// Distinct values of fract(z·scale) over all half-precision depths in [½, 1).
fn digits_left(scale: f64) -> usize {
    let digit = |j: u32| {
        let z = Mediump::ratio(f64::from(j), 2048.0);
        (z * Mediump::whole(scale)).fract().leave().to_bits()
    };
    (1024..2048).map(digit).collect::<BTreeSet<_>>().len()
}

/// What the fract of a packing finds below a half-precision depth.
pub(super) fn digits(_: &Sampling) -> Stress {
    let scales: Vec<f64> = (1..=14).map(exp2).collect();
    let curve: Vec<_> = scales.iter().map(|&s| (s, digits_left(s) as f64)).collect();
    let measured = curve.iter().find(|p| p.1 <= 1.0).map(|p| p.0);
    let event = "the next digit of a packing is always 0";
    let formula = "z in [½, 1) is a multiple of 2⁻¹¹, so z·2¹¹ has no fraction";
    let row = Forecast::at(Fate::Breaks, exp2(11), "mediump-digits", event, formula)
        .curve(&scales, |s| (exp2(11) / s).max(1.0))
        .met(measured, curve)
        .noting("A base-256 packing keeps 3 bits in its second channel and nothing in the third.");
    Stress {
        id: "mediump-digits",
        title: "mediump packing digits",
        lead: "A packing takes fract(z·scale) for its next channel. How many different values are left of \
               it when z and the product are half-precision numbers?"
            .to_string(),
        parameter: "scale of the digit",
        error: "different digits left",
        scale: Scale::Log,
        rows: vec![row],
    }
}

/// Packing constants up to the largest half-precision number.
pub(super) fn overflow(_: &Sampling) -> Stress {
    let scales = ladder(16.0, 1.7e7, 29);
    let sound = |s: f64| Mediump::whole(s).is_sound();
    let error = |s: f64| match sound(s) {
        true => (f64::from(Mediump::whole(s).leave()) - s).abs() / s,
        false => 1.0,
    };
    let packs = |p: &&Packing| p.pack_in(Mediump::ratio(7.0, 10.0)).iter().any(|c| !c.is_sound());
    let own = |p: &&Packing| p.original() == **p;
    let broken: Vec<_> = Packing::ALL.iter().filter(own).filter(packs).map(|p| p.name()).collect();
    let event = "a packing constant is infinite";
    let formula = "65504 is the largest half, 65520 the first number that rounds beyond it";
    let row = Forecast::at(Fate::Breaks, 65_520.0, "mediump-overflow", event, formula)
        .curve(&scales, |s| if s < 65_520.0 { exp2(-11) } else { 1.0 })
        .met(
            onset(16.0, 1.7e7, 400, |s| !sound(s)),
            scales.iter().map(|&s| (s, error(s))).collect(),
        )
        .noting(format!("Packings that meet an infinity on the way: {}.", broken.join(", ")));
    Stress {
        id: "mediump-overflow",
        title: "mediump packing constants",
        lead: "256³, 255³ and 65536 as half-precision constants. The curve is the relative error, 1 where \
               the constant is infinite, the theory the bound 2⁻¹¹."
            .to_string(),
        parameter: "constant",
        error: "relative error of the constant",
        scale: Scale::Log,
        rows: vec![row],
    }
}
