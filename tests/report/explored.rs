//! An explorer of a made-up scene: two configurations, one with nine taps, all kinds of codes.

use gnomon::report::Colour;
use gnomon::report::explorer::{
    Class, Codes, Detail, Explorer, Field, Rung, Slider, Truth, Values, View,
};

/// Seeded random numbers.
pub(crate) struct Random(fastrand::Rng);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self(fastrand::Rng::with_seed(seed))
    }

    pub(crate) fn next(&mut self) -> u64 {
        self.0.u64(..)
    }

    fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Breakpoints of one sample: mostly alike, as neighbouring texels are, sometimes all over.
    fn taps(&mut self, taps: usize) -> Vec<f32> {
        let base = self.breakpoint();
        let wild = self.next().is_multiple_of(10);
        let tap =
            |_| if wild { self.breakpoint() } else { base * (0.9 + 0.2 * self.unit()) as f32 };
        (0..taps).map(tap).collect()
    }

    /// A breakpoint between 1e-6 and 1e-2, sometimes 0, -0, never, always or a denormal.
    fn breakpoint(&mut self) -> f32 {
        match self.next() % 40 {
            0 => 0.0,
            1 => -0.0,
            2 => f32::INFINITY,
            3 => f32::NEG_INFINITY,
            4 => 1e-45,
            _ => (1e-6 * libm::pow(1e4, self.unit())) as f32,
        }
    }
}

const CLASSES: [(&str, Colour); 9] = [
    ("lit", Colour::White),
    ("shadowed", Colour::Grey),
    ("acne", Colour::Vermilion),
    ("edge aliasing", Colour::Yellow),
    ("encoding fault", Colour::Purple),
    ("peter-panning", Colour::Blue),
    ("light leak", Colour::Sky),
    ("background", Colour::Light),
    ("ambiguous", Colour::Ink),
];

fn truth(x: u32, y: u32, width: u32, height: u32) -> Truth {
    let (dx, dy) = (f64::from(x) / f64::from(width) - 0.5, f64::from(y) / f64::from(height) - 0.5);
    match dx * dx + dy * dy {
        d if d > 0.22 => Truth::Apart,
        d if d < 0.06 => Truth::Shadowed,
        _ => Truth::Lit,
    }
}

fn codes(truth: Truth, random: &mut Random) -> Codes {
    match truth {
        Truth::Apart => Codes { shadowed: 7 + (random.next() % 2) as u8, ..Codes::default() },
        Truth::Lit => {
            let shadowed = 2 + (random.next() % 3) as u8;
            Codes { shadowed, lit: 0, lit_late: 0, late: f32::INFINITY }
        }
        Truth::Shadowed => {
            let lit = [3, 6][(random.next() % 2) as usize];
            Codes { shadowed: 1, lit, lit_late: 5, late: random.breakpoint() }
        }
    }
}

fn view(size: (u32, u32), taps: usize, every: u32, random: &mut Random) -> View {
    let places = (0..size.1).flat_map(|y| (0..size.0).map(move |x| (x, y)));
    let truth: Vec<_> = places.map(|(x, y)| truth(x, y, size.0, size.1)).collect();
    let per_tap = truth.iter().flat_map(|t| std::iter::repeat_n(*t, taps));
    let codes: Vec<_> = per_tap.map(|t| codes(t, random)).collect();
    let grid = (size.0.div_ceil(every) * size.1.div_ceil(every)) as usize;
    let rung = |(name, colour): (&str, Colour), random: &mut Random| Rung {
        name: name.into(),
        colour,
        breakpoints: (0..grid).map(|_| random.breakpoint()).collect(),
    };
    let rungs =
        [("bias", Colour::Blue), ("sampling", Colour::Orange), ("arithmetic", Colour::Green)];
    let rungs = rungs.map(|named| rung(named, random)).to_vec();
    let field =
        |name: &str, unit: &str, values| Field { name: name.into(), unit: unit.into(), values };
    let fields = vec![
        field(
            "receiver depth",
            "window depth",
            Values::Numbers((0..grid).map(|i| i as f32).collect()),
        ),
        field("texel x", "", Values::Integers((0..grid).map(|i| i as i32 - 5).collect())),
        field(
            "stored depth",
            "window depth",
            Values::Numbers((0..grid).map(|i| (i * i) as f32 / 7.0).collect()),
        ),
        field("margin", "window depth", Values::Difference(0, 2)),
        field(
            "world x",
            "",
            Values::Rounded(
                (0..grid)
                    .map(|i| if i % 9 == 4 { f32::NAN } else { (i % 50) as f32 - 7.3 })
                    .collect(),
            ),
        ),
        field("object", "", Values::Names(vec![1; grid], vec!["plane".into(), "triangle".into()])),
    ];
    View {
        name: format!("{taps} taps"),
        taps,
        breakpoints: (0..truth.len()).flat_map(|_| random.taps(taps)).collect(),
        truth,
        codes,
        detail: Detail { every, rungs, last_rung: ("filter".into(), Colour::Purple), fields },
        command: "gnomon-report explain --case sample --pixel {x},{y}".into(),
    }
}

/// Seeded by `id`'s length only: the same explorer in every run.
pub(crate) fn explorer(id: &str, size: (u32, u32)) -> Explorer {
    let mut random = Random::new(0x9e37_79b9_7f4a_7c15 ^ id.len() as u64);
    Explorer {
        id: id.into(),
        title: "Drag the bias".into(),
        caption: "Masks, counts and curve follow the slider.".into(),
        width: size.0,
        height: size.1,
        step: 1,
        bottom_up: false,
        slider: Slider {
            label: "constant bias [window depth]".into(),
            low: 1e-7,
            high: 0.1,
            value: 0.0015,
            marks: vec![(0.0015, "document's bias".into()), (0.0, "no bias".into())],
        },
        classes: CLASSES
            .map(|(name, colour)| Class { name: name.into(), colour, about: String::new() })
            .to_vec(),
        views: vec![
            view(size, 1, size.0.div_ceil(200), &mut random),
            view(size, 9, 4, &mut random),
        ],
    }
}

/// Counts by the words of the definition, tap by tap, at breakpoints and between them.
#[test]
fn tallies_equal_a_literal_count() {
    let explorer = explorer("literal", (31, 17));
    for view in &explorer.views {
        for bias in view.breakpoints.iter().step_by(97).flat_map(|b| [*b, b.next_down(), 0.0]) {
            let tally = explorer.tally(view, bias);
            assert_eq!(tally.classes.iter().sum::<u64>(), 31 * 17);
            let wrong = |truth, lit: bool| -> (u64, u64) {
                let taps = (0..explorer.samples()).filter(|s| view.truth[*s] == truth).map(|s| {
                    let taps = &view.breakpoints[s * view.taps..(s + 1) * view.taps];
                    taps.iter().filter(|b| (bias >= **b) == lit).count() as u64
                });
                taps.fold((0, 0), |(samples, all), n| (samples + u64::from(n > 0), all + n))
            };
            assert_eq!(tally.false_shadow, wrong(Truth::Lit, false), "bias {bias:e}");
            assert_eq!(tally.false_light, wrong(Truth::Shadowed, true), "bias {bias:e}");
            let (shadow, light): (u64, u64) =
                (tally.classes[2..5].iter().sum(), tally.classes[5] + tally.classes[6]);
            assert!(shadow >= tally.false_shadow.0 && shadow + light >= tally.false_light.0);
        }
    }
}

/// The blamed rung is wrong, everything above it is wrong, the rung below it is right.
#[test]
fn a_cause_is_the_first_rung_that_stays_wrong() {
    let explorer = explorer("cause", (31, 17));
    let mut seen = [false; 4];
    for view in &explorer.views {
        for (grid, sample) in explorer.grid(view) {
            let wrong = |rung: usize| {
                let lit = 0.0015 >= view.detail.rungs[rung].breakpoints[grid];
                lit != (view.truth[sample] == Truth::Lit)
            };
            let Some(cause) = view.cause(grid, sample, 0.0015) else {
                assert_eq!(view.wrong_taps(sample, 0.0015), 0);
                continue;
            };
            assert!((cause..3).all(wrong), "rungs above {cause} are not all wrong");
            assert!(cause == 0 || !wrong(cause - 1), "rung below {cause} is wrong too");
            seen[cause] = true;
        }
    }
    assert_eq!(seen, [true; 4], "some cause never occurs");
}

#[test]
#[should_panic(expected = "NaN in view")]
fn a_nan_breakpoint_is_a_bug() {
    let mut explorer = explorer("nan", (4, 4));
    explorer.views[0].breakpoints[3] = f32::NAN;
    let mut report = crate::sample::report();
    report.sections[0].blocks = vec![explorer.into()];
    let _ = report.files();
}
