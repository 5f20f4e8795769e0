//! A picture whose classes follow a slider, as data; the page redraws it, this file is its twin.
//!
//! A sample has one or more *taps*. Each tap answers "lit" from its *breakpoint* on: the smallest
//! slider value (f32) at which it does, `+∞` for never, `-∞` for always. Everything else follows
//! by comparing, so page and program agree at every f32.

use super::image::png;
use super::palette::Colour;

/// A picture whose classes follow a slider.
#[derive(Clone, Debug, Default)]
pub struct Explorer {
    /// Unique in the report.
    pub id: String,
    /// Heading.
    pub title: String,
    /// One sentence: what a reader should try.
    pub caption: String,
    /// Samples across.
    pub width: u32,
    /// Samples down.
    pub height: u32,
    /// Canvas pixels from sample to sample, for people who look a pixel up; 0 counts as 1.
    pub step: u32,
    /// Whether canvas rows count from the bottom, as WebGL's do.
    pub bottom_up: bool,
    /// What the reader drags.
    pub slider: Slider,
    /// The classes that codes mean, in legend order.
    pub classes: Vec<Class>,
    /// Configurations of the same picture; two at a time are shown side by side.
    pub views: Vec<View>,
}

/// A value the reader drags: zero, then logarithmic from `low` to `high`.
#[derive(Clone, Debug, Default)]
pub struct Slider {
    /// Quantity with its unit: `constant bias [window depth]`.
    pub label: String,
    /// Smallest value above zero.
    pub low: f32,
    /// Largest value.
    pub high: f32,
    /// Where it stands at first.
    pub value: f32,
    /// Values worth naming, as buttons and marks.
    pub marks: Vec<(f32, String)>,
}

/// What a class code means.
#[derive(Clone, Debug, Default)]
pub struct Class {
    /// Name in legend and counts.
    pub name: String,
    /// Its colour, the same everywhere.
    pub colour: Colour,
    /// What it is; shown on hover.
    pub about: String,
}

/// What a sample truly is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum Truth {
    /// Light reaches it.
    Lit = 0,
    /// Something stands between it and the light.
    Shadowed = 1,
    /// Counted apart: background, facing away, outside the map, ambiguous.
    #[default]
    Apart = 2,
}

/// The class codes of a tap (or of a whole sample).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Codes {
    /// While the tap says shadowed; also the code of a sample that is counted apart.
    pub shadowed: u8,
    /// While it says lit, below `late`.
    pub lit: u8,
    /// While it says lit, from `late` on.
    pub lit_late: u8,
    /// The slider value from which `lit_late` holds; `+∞` for never.
    pub late: f32,
}

/// One configuration.
#[derive(Clone, Debug, Default)]
pub struct View {
    /// Name in the menu.
    pub name: String,
    /// Taps per sample.
    pub taps: usize,
    /// Breakpoints: sample by sample, top row first, `taps` each. No NaN.
    pub breakpoints: Vec<f32>,
    /// Truth of each sample.
    pub truth: Vec<Truth>,
    /// Codes of each sample, or of each tap: then the first wrong tap decides, so the tap that
    /// should decide stands first. Where none is wrong the first tap's codes hold.
    pub codes: Vec<Codes>,
    /// What the inspector shows.
    pub detail: Detail,
    /// A command that explains one pixel; `{x}` and `{y}` stand for its place, may be empty.
    pub command: String,
}

/// Values of a coarser grid: every `every`-th sample across and down, from sample (0, 0) on.
#[derive(Clone, Debug, Default)]
pub struct Detail {
    /// Grid step in samples; 1 has all of them, 0 counts as 1.
    pub every: u32,
    /// The ladder below the final verdict, in order; a sample that is wrong from a rung on to the
    /// end has that rung as its cause. Empty where causes are not known.
    pub rungs: Vec<Rung>,
    /// The last rung's name and colour: its verdict is that of the taps themselves.
    pub last_rung: (String, Colour),
    /// Measured values.
    pub fields: Vec<Field>,
}

/// One rung of the ladder of causes.
#[derive(Clone, Debug, Default)]
pub struct Rung {
    /// Name of the cause.
    pub name: String,
    /// Its colour.
    pub colour: Colour,
    /// Breakpoint of each grid sample on this rung.
    pub breakpoints: Vec<f32>,
}

/// A measured quantity of each grid sample.
#[derive(Clone, Debug, Default)]
pub struct Field {
    /// Name in the inspector.
    pub name: String,
    /// Unit, may be empty.
    pub unit: String,
    /// The values.
    pub values: Values,
}

/// Values of a field.
#[derive(Clone, Debug)]
pub enum Values {
    /// Measured numbers, every bit; NaN is shown as missing.
    Numbers(Vec<f32>),
    /// Measured numbers that the page needs to a 65534th of their range only, half the size.
    Rounded(Vec<f32>),
    /// The first of two fields (by their places among the fields, both numbers) less the second.
    Difference(usize, usize),
    /// Integers.
    Integers(Vec<i32>),
    /// Codes into names; a code without a name is shown as missing.
    Names(Vec<u8>, Vec<String>),
}

impl Default for Values {
    fn default() -> Self {
        Self::Integers(Vec::new())
    }
}

/// What a view shows at one slider value.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// Samples of each class.
    pub classes: Vec<u64>,
    /// Truly lit samples with a tap that says shadowed, and how many such taps.
    pub false_shadow: (u64, u64),
    /// Truly shadowed samples with a tap that says lit, and how many such taps.
    pub false_light: (u64, u64),
    /// Grid samples of each cause, the last rung among them; empty without rungs.
    pub causes: Vec<u64>,
}

impl View {
    fn taps_of(&self, sample: usize) -> &[f32] {
        &self.breakpoints[sample * self.taps..][..self.taps]
    }

    /// The number of taps whose verdict at `value` is not the truth.
    #[must_use]
    pub fn wrong_taps(&self, sample: usize, value: f32) -> usize {
        let lit = self.taps_of(sample).iter().filter(|b| value >= **b).count();
        match self.truth[sample] {
            Truth::Lit => self.taps - lit,
            Truth::Shadowed => lit,
            Truth::Apart => 0,
        }
    }

    /// The class code of a sample at `value`.
    #[must_use]
    pub fn class(&self, sample: usize, value: f32) -> u8 {
        let wrong = self.wrong_taps(sample, value) > 0;
        let lit = match self.truth[sample] {
            Truth::Apart => return self.codes_of(sample, 0).shadowed,
            Truth::Lit => !wrong,
            Truth::Shadowed => wrong,
        };
        let codes = self.codes_of(sample, self.deciding_tap(sample, value));
        match (lit, value >= codes.late) {
            (false, _) => codes.shadowed,
            (true, false) => codes.lit,
            (true, true) => codes.lit_late,
        }
    }

    fn codes_of(&self, sample: usize, tap: usize) -> Codes {
        let per_tap = self.codes.len() > self.truth.len();
        self.codes[if per_tap { sample * self.taps + tap } else { sample }]
    }

    /// The first tap whose verdict at `value` is wrong, or the first of all.
    fn deciding_tap(&self, sample: usize, value: f32) -> usize {
        let truly_lit = self.truth[sample] == Truth::Lit;
        let wrong = |breakpoint: &f32| (value >= *breakpoint) != truly_lit;
        self.taps_of(sample).iter().position(wrong).unwrap_or(0)
    }

    /// The cause of a grid sample's wrong verdict at `value`: the first rung from which it is
    /// wrong to the end, the number of rungs for the last one. `None` where the verdict is right.
    #[must_use]
    pub fn cause(&self, grid: usize, sample: usize, value: f32) -> Option<usize> {
        if self.wrong_taps(sample, value) == 0 {
            return None;
        }
        let truly_lit = self.truth[sample] == Truth::Lit;
        let wrong = |rung: &&Rung| (value >= rung.breakpoints[grid]) != truly_lit;
        let run = self.detail.rungs.iter().rev().take_while(wrong).count();
        Some(self.detail.rungs.len() - run)
    }
}

impl View {
    /// Per rung and grid sample: the slider value at which that rung *and all above it* turn, which
    /// is all that a cause asks of a rung. Below the verdict's own the values repeat, so they pack
    /// better than the breakpoints; samples that are counted apart get `+∞`.
    pub(super) fn rung_limits(&self, grid: impl Iterator<Item = (usize, usize)>) -> Vec<Vec<f32>> {
        let mut limits = vec![Vec::new(); self.detail.rungs.len()];
        for (grid, sample) in grid {
            let taps = self.taps_of(sample).iter().copied();
            let (first, pick): (f32, fn(f32, f32) -> f32) = match self.truth[sample] {
                Truth::Lit => (taps.fold(f32::NEG_INFINITY, f32::max), f32::min),
                Truth::Shadowed => (taps.fold(f32::INFINITY, f32::min), f32::max),
                Truth::Apart => (f32::INFINITY, f32::max),
            };
            let mut limit = first;
            for (rung, limits) in self.detail.rungs.iter().zip(&mut limits).rev() {
                limit = pick(limit, rung.breakpoints[grid]) + 0.0;
                limits.push(limit);
            }
        }
        limits
    }
}

impl Explorer {
    /// Samples of one view.
    #[must_use]
    pub fn samples(&self) -> usize {
        self.width as usize * self.height as usize
    }

    /// (grid index, sample index) of a view's detail.
    pub fn grid(&self, view: &View) -> impl Iterator<Item = (usize, usize)> + use<> {
        let (width, height, every) = (self.width, self.height, view.detail.every.max(1));
        let rows = (0..height).step_by(every as usize);
        let samples = rows.flat_map(move |y| {
            (0..width)
                .step_by(every as usize)
                .map(move |x| y as usize * width as usize + x as usize)
        });
        samples.enumerate()
    }

    /// What `view` shows with the slider at `value`.
    #[must_use]
    pub fn tally(&self, view: &View, value: f32) -> Tally {
        let mut tally = Tally { classes: vec![0; self.classes.len()], ..Tally::default() };
        for sample in 0..self.samples() {
            tally.classes[usize::from(view.class(sample, value))] += 1;
            let wrong = view.wrong_taps(sample, value) as u64;
            let (samples, taps) = match view.truth[sample] {
                Truth::Shadowed => &mut tally.false_light,
                Truth::Lit | Truth::Apart => &mut tally.false_shadow,
            };
            *samples += u64::from(wrong > 0);
            *taps += wrong;
        }
        if !view.detail.rungs.is_empty() {
            tally.causes = vec![0; view.detail.rungs.len() + 1];
            for (grid, sample) in self.grid(view) {
                if let Some(cause) = view.cause(grid, sample, value) {
                    tally.causes[cause] += 1;
                }
            }
        }
        tally
    }

    /// sRGB bytes of `view` with the slider at `value`, top row first: the class colour, mixed
    /// with the colour of the right verdict where only some taps are wrong.
    #[must_use]
    pub fn picture(&self, view: &View, value: f32) -> Vec<u8> {
        let colour = |code: u8| self.classes[usize::from(code)].colour.rgb();
        let pixel = |sample| {
            let shown = colour(view.class(sample, value));
            let wrong = view.wrong_taps(sample, value);
            if wrong == 0 || wrong == view.taps {
                return shown;
            }
            let codes = view.codes_of(sample, view.deciding_tap(sample, value));
            let truly_lit = view.truth[sample] == Truth::Lit;
            let right = colour(if truly_lit { codes.lit } else { codes.shadowed });
            mixed(right, shown, wrong, view.taps)
        };
        (0..self.samples()).flat_map(pixel).collect()
    }

    /// The first view with the slider where it stands at first, as a PNG file.
    pub(super) fn to_png(&self) -> Vec<u8> {
        let rgb = self.views.first().map(|view| self.picture(view, self.slider.value));
        let rgb = rgb.expect("an explorer has a view");
        png(self.width, self.height, &rgb)
    }

    /// Panics with a sentence where arrays do not fit each other: a mistake of the program.
    pub(super) fn check(&self) {
        let named = |view: &View| format!("view {} of explorer {}", view.name, self.id);
        for view in &self.views {
            let samples = self.samples();
            assert_eq!(
                view.breakpoints.len(),
                samples * view.taps,
                "breakpoints of {}",
                named(view)
            );
            assert_eq!(view.truth.len(), samples, "truth of {}", named(view));
            let per = [samples, samples * view.taps];
            assert!(per.contains(&view.codes.len()), "codes of {}", named(view));
            assert!(!view.breakpoints.iter().any(|b| b.is_nan()), "NaN in {}", named(view));
            let grid = self.grid(view).count();
            let rungs = view.detail.rungs.iter().map(|rung| rung.breakpoints.len());
            let fields = view.detail.fields.iter().filter_map(|field| field.values.len());
            assert!(rungs.chain(fields).all(|len| len == grid), "detail of {}", named(view));
        }
    }
}

impl Values {
    /// How many are stored; `None` for what follows from other fields.
    fn len(&self) -> Option<usize> {
        match self {
            Self::Numbers(values) | Self::Rounded(values) => Some(values.len()),
            Self::Integers(values) => Some(values.len()),
            Self::Names(codes, _) => Some(codes.len()),
            Self::Difference(..) => None,
        }
    }
}

/// `wrong` of `taps` parts `to`, the rest `from`, rounded to the nearest byte.
fn mixed(from: [u8; 3], to: [u8; 3], wrong: usize, taps: usize) -> [u8; 3] {
    std::array::from_fn(|i| {
        let sum = usize::from(from[i]) * (taps - wrong) + usize::from(to[i]) * wrong;
        u8::try_from((sum + taps / 2) / taps).expect("a mean of bytes is a byte")
    })
}
