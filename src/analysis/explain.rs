//! One receiver's whole chain in words: decimal and hex, all rungs, and the cause.

use super::ladder::Rung;
use super::observe::{Observation, Observer};
use crate::raster::NO_TRIANGLE;
use crate::truth::Truth;
use std::fmt::Write;

fn float(x: f32) -> String {
    format!("{x:e} ({:#010x})", x.to_bits())
}

fn double(x: f64) -> String {
    format!("{x:e} ({:#018x})", x.to_bits())
}

/// The chain of the receiver at a pixel; `None` where the pixel is background.
#[must_use]
pub fn explain(observer: &Observer<'_>, x: u32, y: u32) -> Option<String> {
    let o = observer.observe_pixel(x, y)?;
    let mut text = String::new();
    // Writing to a String cannot fail.
    let _ = write_chain(&mut text, observer, &o);
    Some(text)
}

/// The command that prints the chain of an observation; failure messages end with it.
#[must_use]
pub fn command(observer: &Observer<'_>, o: &Observation) -> String {
    let [x, y] = o.pixel;
    format!("gnomon-report explain --case {} --pixel {x},{y}", observer.case().name)
}

fn write_chain(out: &mut String, observer: &Observer<'_>, o: &Observation) -> std::fmt::Result {
    let case = observer.case();
    let object = &case.objects[usize::from(o.object)].name;
    writeln!(out, "case        {} on {}", case.name, case.device)?;
    writeln!(out, "pixel       {}, {} (from the bottom left)", o.pixel[0], o.pixel[1])?;
    writeln!(out, "receiver    triangle {} of {object}", o.receiver.triangle)?;
    let p = o.receiver.position;
    for (axis, value) in [("x", p.x), ("y", p.y), ("z", p.z)] {
        writeln!(out, "  world {axis}   {}", double(value))?;
    }
    writeln!(out, "standing    {}", o.standing)?;
    write_truth(out, observer, o)?;
    for (i, axis) in ["u", "v", "z"].into_iter().enumerate() {
        let (exact, subject) = (o.exact.to_array()[i], o.coord[i]);
        writeln!(out, "coord {axis}     exact {}, subject {}", double(exact), float(subject))?;
    }
    write_taps(out, observer, o)?;
    writeln!(out, "rule        lit unless {}, bias {}", case.lookup.compare, float(case.bias))?;
    for (i, rung) in Rung::ALL.iter().enumerate() {
        let verdict = if o.wrong[i] { "WRONG" } else { "right" };
        writeln!(
            out,
            "rung        {:<13} stored {:<40} {verdict}",
            rung.name(),
            double(o.stored[i])
        )?;
    }
    writeln!(out, "visibility  {} of {} taps lit", o.lit_taps, o.taps.depths().len())?;
    match o.outcome.fault() {
        None => writeln!(out, "outcome     agrees with the truth, or does not count"),
        Some(fault) => {
            writeln!(out, "outcome     {} caused by {}", fault.kind.artifact(), fault.cause)
        }
    }
}

fn write_truth(out: &mut String, observer: &Observer<'_>, o: &Observation) -> std::fmt::Result {
    let name = |t: u32| {
        let object = usize::from(observer.geometry.object[t as usize]);
        format!("triangle {t} of {}", observer.case().objects[object].name)
    };
    match &o.answer.truth {
        Truth::Lit => writeln!(out, "truth       lit"),
        Truth::Ambiguous => writeln!(out, "truth       ambiguous"),
        Truth::Shadowed(s) => {
            writeln!(out, "truth       shadowed")?;
            writeln!(out, "  nearest   {} at {} world units", name(s.occluder), double(s.gap))?;
            writeln!(out, "  first     {} at {} world units", name(s.first), double(s.first_gap))
        }
    }
}

fn write_taps(out: &mut String, observer: &Observer<'_>, o: &Observation) -> std::fmt::Result {
    let map = &observer.subject.map;
    for (i, (&depth, &breakpoint)) in o.taps.depths().iter().zip(&o.breakpoints).enumerate() {
        writeln!(
            out,
            "tap {i}       stored {}, lit from bias {}",
            float(depth),
            float(breakpoint)
        )?;
        for &texel in o.taps.texels(i) {
            let [x, y] = map.layout().on_picture(texel);
            let triangle = observer.subject.map_raster.triangle[texel as usize];
            let drawn = if triangle == NO_TRIANGLE {
                "cleared".to_string()
            } else {
                let z = observer.subject.map_raster.depth[texel as usize];
                format!("triangle {triangle} drawn at {}", float(z))
            };
            let bytes =
                map.bytes(texel as usize).map_or(String::new(), |b| format!(", bytes {b:?}"));
            writeln!(out, "  texel     {x}, {y}: {drawn}{bytes}")?;
        }
    }
    writeln!(out, "deciding    texel {}, {:?}", o.texel, o.caster)
}
