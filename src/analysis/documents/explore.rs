//! A case as an explorer: breakpoints, truth, artifacts and rungs of every receiver, for the page.

use crate::analysis::classify::{Artifact, Kind, StoredCaster};
use crate::analysis::ladder::Rung;
use crate::analysis::measure::Measured;
use crate::analysis::observe::{Observation, Observer, Standing};
use crate::analysis::verdict::order;
use crate::load::fit::YOURS;
use crate::num::{from_ordinal, ordinal};
use crate::report::explorer::{Class, Codes, Detail, Explorer, Field, Slider, Truth, Values, View};
use crate::report::{Colour, explorer};
use crate::scene::CompareRule;
use crate::shadow;

/// Rungs and fields travel for at most so many samples a side.
const DETAIL_SIDE: u32 = 200;
const LIT: u8 = 0;
const SHADOWED: u8 = 1;
const FIRST_ARTIFACT: u8 = 2;
const NOT_COUNTED: u8 = FIRST_ARTIFACT + Artifact::ALL.len() as u8;
const AMBIGUOUS: u8 = NOT_COUNTED + 1;
const BACKGROUND: u8 = NOT_COUNTED + 2;

/// The case at every constant bias, and its variants beside it.
pub(super) fn explorer(
    id: &str,
    measured: &Measured<'_>,
    compared: &[Measured<'_>],
    step: u32,
) -> Explorer {
    let case = measured.observer.case();
    let [width, height] = case.canvas.map(|side| side.div_ceil(step));
    let m = &measured.measurement;
    let thresholds = [(m.thresholds.critical, "critical"), (m.thresholds.detachment, "detachment")];
    let marks =
        thresholds.into_iter().filter_map(|(b, name)| Some((b.filter(|b| *b > 0.0)?, name)));
    let marks = [(0.0, "no bias"), (m.bias, "document's bias")].into_iter().chain(marks);
    let mut explorer = Explorer {
        id: format!("{id}-explorer"),
        title: format!("Drag the bias of {}", m.name),
        caption:
            "Exact at every f32 bias; click or use the arrow keys on the picture to inspect a \
                  receiver."
                .to_string(),
        width,
        height,
        step,
        bottom_up: true,
        slider: Slider {
            label: "constant bias [window depth]".to_string(),
            low: 1e-6,
            high: 1.0,
            value: m.bias,
            marks: marks.map(|(bias, name)| (bias, name.to_string())).collect(),
        },
        classes: classes(),
        views: vec![],
    };
    let shown = std::iter::once(measured).chain(compared);
    explorer.views = shown.map(|measured| view(measured, &explorer)).collect();
    // Variants and users' scenes have no name that `explain` knows.
    let known = usize::from(case.document != YOURS);
    explorer.views.iter_mut().skip(known).for_each(|view| view.command.clear());
    explorer
}

fn classes() -> Vec<Class> {
    let class = |name: &str, colour, about: &str| Class {
        name: name.replace('-', " "),
        colour,
        about: about.to_string(),
    };
    let right = [
        class("lit, right", Colour::White, "Map and truth say lit."),
        class("shadowed, right", Colour::Grey, "Map and truth say shadowed."),
    ];
    let artifacts = Artifact::ALL.iter().map(|a| class(a.name(), a.colour(), &a.about()));
    let apart = [
        class("not counted", Colour::Light, "Facing away, outside the cone or the map."),
        class("ambiguous", Colour::Green, "The truth cannot be decided in f64."),
        class("background", Colour::Ink, "Nothing is drawn there."),
    ];
    right.into_iter().chain(artifacts).chain(apart).collect()
}

fn view(measured: &Measured<'_>, explorer: &Explorer) -> View {
    let observer = &measured.observer;
    let case = observer.case();
    let (width, height, step) = (explorer.width, explorer.height, explorer.step);
    let mut seen: Vec<Option<&Observation>> = vec![None; explorer.samples()];
    for o in &measured.observations {
        let row = height - 1 - o.pixel[1] / step;
        seen[(row * width + o.pixel[0] / step) as usize] = Some(o);
    }
    let taps = measured.observations.iter().map(|o| o.breakpoints.len()).max().unwrap_or(1);
    let mut view = View {
        name: case.name.clone(),
        taps,
        command: format!("gnomon-report explain --case {} --pixel {{x}},{{y}}", case.name),
        ..View::default()
    };
    for o in &seen {
        let truth = truth(*o);
        view.truth.push(truth);
        let centre = o.map_or(0, |o| o.taps.centre());
        let own = o.map_or(0, |o| o.breakpoints.len());
        for tap in order(centre, own).take(own) {
            view.breakpoints.push(o.map_or(f32::INFINITY, |o| o.breakpoints[tap]));
            view.codes.push(codes(observer, *o, tap));
        }
        // A filter leaves out taps that weigh nothing: here they are right at every bias.
        let missing = taps - own;
        let right = if truth == Truth::Lit { f32::NEG_INFINITY } else { f32::INFINITY };
        view.breakpoints.extend(std::iter::repeat_n(right, missing));
        view.codes.extend(std::iter::repeat_n(codes(observer, *o, centre), missing));
    }
    view.detail.every = width.max(height).div_ceil(DETAIL_SIDE);
    let every = view.detail.every;
    let rows = (0..height).step_by(every as usize);
    let at = |y: u32| (0..width).step_by(every as usize).map(move |x| (y * width + x) as usize);
    let grid: Vec<_> = rows.flat_map(at).map(|sample| seen[sample]).collect();
    view.detail = Detail { every, ..detail(case.lookup.compare, &grid) };
    view
}

fn truth(o: Option<&Observation>) -> Truth {
    match o.and_then(Observation::truly_lit) {
        None => Truth::Apart,
        Some(true) => Truth::Lit,
        Some(false) => Truth::Shadowed,
    }
}

fn artifact(kind: Kind) -> u8 {
    FIRST_ARTIFACT + kind.artifact() as u8
}

fn codes(observer: &Observer<'_>, o: Option<&Observation>, tap: usize) -> Codes {
    let apart = |shadowed| Codes { shadowed, late: f32::INFINITY, ..Codes::default() };
    let Some(o) = o else { return apart(BACKGROUND) };
    let caster = |o| observer.tap_caster(o, tap);
    match (o.standing, o.truly_lit()) {
        (Standing::Ambiguous, _) => apart(AMBIGUOUS),
        (_, None) => apart(NOT_COUNTED),
        (_, Some(true)) => {
            let (stored, sound) = caster(o);
            let shadowed = artifact(Kind::false_shadow(stored, sound));
            Codes { shadowed, lit: LIT, lit_late: LIT, late: f32::INFINITY }
        }
        (_, Some(false)) => shadowed_codes(observer.case().lookup.compare, o, caster(o).0),
    }
}

/// False light is named anew from the bias on that hides the occluder by itself.
fn shadowed_codes(rule: CompareRule, o: &Observation, stored: StoredCaster) -> Codes {
    let late = exact_breakpoint(rule, o.exact.z, o.stored[Rung::Bias as usize]);
    let lit = |wrong_on_bias| artifact(Kind::false_light(stored, wrong_on_bias));
    Codes { shadowed: SHADOWED, lit: lit(false), lit_late: lit(true), late }
}

/// The smallest f32 bias at which the rule on exact depths says lit; −∞ where nothing is stored.
fn exact_breakpoint(rule: CompareRule, z: f64, stored: f64) -> f32 {
    if stored == f64::INFINITY {
        return f32::NEG_INFINITY;
    }
    let lit = |b: f32| rule.is_lit_exact(z, stored, f64::from(b));
    let mut b = (z - stored) as f32;
    while !lit(b) {
        b = from_ordinal(ordinal(b) + 1);
    }
    while lit(from_ordinal(ordinal(b) - 1)) {
        b = from_ordinal(ordinal(b) - 1);
    }
    b
}

fn detail(rule: CompareRule, grid: &[Option<&Observation>]) -> Detail {
    let colours =
        [Colour::Sky, Colour::Blue, Colour::Orange, Colour::Green, Colour::Purple, Colour::Yellow];
    let rungs = Rung::ALL.iter().zip(colours).take(5).map(|(rung, colour)| explorer::Rung {
        name: rung.name().to_string(),
        colour,
        breakpoints: grid.iter().map(|o| rung_breakpoint(rule, *rung, *o)).collect(),
    });
    Detail {
        every: 1,
        rungs: rungs.collect(),
        last_rung: (Rung::Filter.name().to_string(), colours[5]),
        fields: fields(grid),
    }
}

fn rung_breakpoint(rule: CompareRule, rung: Rung, o: Option<&Observation>) -> f32 {
    let Some(o) = o.filter(|o| o.standing == Standing::Counted) else { return f32::INFINITY };
    let stored = o.stored[rung as usize];
    match rung {
        // No bias changes what is drawn.
        Rung::Culling if o.wrong[rung as usize] == (o.truly_lit() == Some(true)) => f32::INFINITY,
        Rung::Culling => f32::NEG_INFINITY,
        Rung::Bias | Rung::Sampling => exact_breakpoint(rule, o.exact.z, stored),
        Rung::Arithmetic | Rung::Quantization | Rung::Filter => {
            shadow::breakpoint(rule, o.coord[2], stored as f32)
        }
    }
}

fn fields(grid: &[Option<&Observation>]) -> Vec<Field> {
    let measured = |value: &dyn Fn(&Observation) -> f64| -> Vec<f32> {
        grid.iter().map(|o| o.map_or(f32::NAN, |o| value(o) as f32)).collect()
    };
    let whole = |value: &dyn Fn(&Observation) -> u32| {
        let values = grid.iter().map(|o| o.map_or(-1, |o| value(o).cast_signed()));
        Values::Integers(values.collect())
    };
    let field = |name: &str, unit: &str, values| Field {
        name: name.to_string(),
        unit: unit.to_string(),
        values,
    };
    let depth = "window depth";
    let stored = |o: &Observation| o.stored[Rung::Filter as usize];
    let world = |value: &dyn Fn(&Observation) -> f64| Values::Rounded(measured(value));
    vec![
        field("receiver depth", depth, Values::Numbers(measured(&|o| f64::from(o.coord[2])))),
        field("stored depth", depth, Values::Numbers(measured(&stored))),
        field("margin", depth, Values::Difference(0, 1)),
        field("texel", "", whole(&|o| o.texel)),
        field("triangle", "", whole(&|o| o.receiver.triangle)),
        field("world x", "", world(&|o| o.receiver.position.x)),
        field("world y", "", world(&|o| o.receiver.position.y)),
        field("world z", "", world(&|o| o.receiver.position.z)),
    ]
}
