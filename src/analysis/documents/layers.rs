//! A case's receivers as EXR layers, for viewers and for anyone who checks the truth independently.

use super::super::classify::Artifact;
use super::super::ladder::Rung;
use super::super::observe::{Observation, Observer, Standing};
use crate::report::ExrImage;
use crate::truth::Truth;
use serde_json::json;

/// A channel: its name and its value at a receiver.
type Channel<'a> = (&'a str, Box<dyn Fn(&Observation) -> f32 + 'a>);

/// Preview, depths, margin, signed error, class, cause, truth, position, id.
/// Background pixels are NaN (preview: 0).
pub(super) fn layers(
    id: &str,
    observer: &Observer<'_>,
    observations: &[Observation],
    step: u32,
    preview: &[u8],
) -> ExrImage {
    let [width, height] = observer.case().canvas.map(|side| side.div_ceil(step) as usize);
    let mut image = ExrImage {
        id: format!("{id}-receivers"),
        width,
        height,
        channels: Vec::new(),
        metadata: metadata(observer, step),
    };
    for (i, name) in ["R", "G", "B"].into_iter().enumerate() {
        let values = preview.iter().skip(i).step_by(3).map(|&b| f32::from(b) / 255.0).collect();
        image.channels.push((name.to_string(), values));
    }
    for (name, value) in channels() {
        let mut values = vec![f32::NAN; width * height];
        for o in observations {
            let row = height - 1 - (o.pixel[1] / step) as usize;
            values[row * width + (o.pixel[0] / step) as usize] = value(o);
        }
        image.channels.push((name.to_string(), values));
    }
    image
}

fn channels() -> Vec<Channel<'static>> {
    let stored = |o: &Observation| o.taps.depths()[o.taps.centre()];
    let exact_centre = |o: &Observation| o.stored[Rung::Sampling as usize];
    vec![
        ("depth.receiver.Z", Box::new(|o: &Observation| o.coord[2])),
        ("depth.stored.Z", Box::new(stored)),
        ("margin.Y", Box::new(move |o| (f64::from(o.coord[2]) - f64::from(stored(o))) as f32)),
        ("error.signed.Y", Box::new(move |o| (f64::from(stored(o)) - exact_centre(o)) as f32)),
        ("class.Y", Box::new(class_code)),
        ("cause.Y", Box::new(|o| o.outcome.fault().map_or(0.0, |f| f.cause as u8 as f32 + 1.0))),
        ("truth.Y", Box::new(truth_code)),
        ("position.X", Box::new(|o| o.receiver.position.x as f32)),
        ("position.Y", Box::new(|o| o.receiver.position.y as f32)),
        ("position.Z", Box::new(|o| o.receiver.position.z as f32)),
        ("triangle.Y", Box::new(|o| o.receiver.triangle as f32)),
    ]
}

/// 0 right, 1… the artifact, negative where the receiver does not count.
fn class_code(o: &Observation) -> f32 {
    match (o.standing, o.outcome.fault()) {
        (Standing::Counted, Some(fault)) => f32::from(fault.kind.artifact() as u8 + 1),
        (Standing::Counted, None) => 0.0,
        (standing, _) => -f32::from(standing as u8),
    }
}

fn truth_code(o: &Observation) -> f32 {
    match o.answer.truth {
        Truth::Lit => 1.0,
        Truth::Shadowed(_) => 0.0,
        Truth::Ambiguous => -1.0,
    }
}

fn metadata(observer: &Observer<'_>, step: u32) -> serde_json::Value {
    let case = observer.case();
    let codes = |names: Vec<&str>, first: i32, sign: i32| {
        let code = |(i, name): (usize, &str)| ((first + sign * i as i32).to_string(), json!(name));
        names.into_iter().enumerate().map(code).collect::<serde_json::Map<_, _>>()
    };
    let mut classes = codes(Artifact::ALL.iter().map(|a| a.name()).collect(), 1, 1);
    classes.insert("0".to_string(), json!("right"));
    classes.extend(codes(Standing::ALL.iter().skip(1).map(|s| s.name()).collect(), -1, -1));
    let mut causes = codes(Rung::ALL.iter().map(|r| r.name()).collect(), 1, 1);
    causes.insert("0".to_string(), json!("none"));
    json!({
        "case": case.name,
        "bias": case.bias,
        "device": case.device.name(),
        "every_nth_pixel": step,
        "light_position": case.light.eye().position.to_array(),
        "light_directional": case.light.is_directional(),
        "class.Y": classes,
        "cause.Y": causes,
        "truth.Y": { "1": "lit", "0": "shadowed", "-1": "ambiguous" },
        "margin.Y": "receiver depth minus stored depth, window depth",
        "error.signed.Y": "stored depth minus exact nearest depth at the texel centre",
        "position": "world position of the receiver; triangle.Y its triangle in drawing order",
    })
}
