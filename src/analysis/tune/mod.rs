//! The bias that a scene needs, in an engine's own parameters.

mod cheapest;
mod report;
mod tables;
mod words;

use super::budget::Budget;
use super::sweep::chart::{Attachment, Chart};
use super::sweep::field::Sample;
use super::sweep::looks::Look;
use super::sweep::tally::{Kind, Tally};
use super::sweep::{Field, Question, Range, Scales, Swept, amounts, sweep};
use crate::engines::withdrawn::Withdrawal;
use crate::engines::{Engine, Knob, Place, Setting};
use crate::scene::TexelFormat;
use crate::shadow::bias::slope::receiver_slope;
use crate::shadow::bias::{MoveNormal, NormalMove, Recipe, Strategy};
pub use cheapest::Configuration;
use cheapest::cheapest;
pub use report::{Request, report};

/// What comes of one parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Found {
    /// The smallest value that meets the target, in the engine's unit.
    Set(f64),
    /// The target is met without any bias.
    NotNeeded,
    /// No amount meets the target.
    Infeasible,
    /// The target takes this value, which the engine does not keep, or more than the whole depth range.
    OutOfRange(f64),
    /// The line is known to be wrong here.
    Withdrawn(&'static Withdrawal),
}

/// One parameter and what comes of it.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Tuned {
    /// The parameter.
    pub knob: Knob,
    /// What comes of it.
    pub found: Found,
    /// The sweep behind it.
    pub swept: Swept,
}

/// A strategy along its amounts on a chart.
fn swept(chart: &Chart<'_, '_>, format: TexelFormat, strategy: Strategy, max_acne: f64) -> Swept {
    let field = chart.field;
    let range = Range { low: 1e-7, high: 1e-1, log: true, count: 100 };
    let amounts = amounts(strategy, &range, &Scales::on(field, chart.size, format, strategy));
    let mut swept = sweep(chart, format, strategy, &Question { amounts: &amounts, max_acne });
    // Where no bias meets the target none is needed, even if more of this one brings acne back.
    let limit = (max_acne * field.populations[0] as f64) as i64;
    let none = swept.points.first().filter(|p| p.amount == 0.0 && p.tally.of(Kind::ACNE) <= limit);
    swept.acne_free = none.copied().filter(|_| field.populations[0] > 0).or(swept.acne_free);
    swept
}

impl Tuned {
    fn new(chart: &Chart<'_, '_>, format: TexelFormat, knob: Knob, max_acne: f64) -> Self {
        let swept = swept(chart, format, knob.strategy, max_acne);
        let setting = Setting::of(chart.field.case(), chart.filter);
        let amount = swept.acne_free.map(|p| f64::from(p.amount));
        let found = match (amount, knob.withdrawn(&setting)) {
            (Some(0.0), _) => Found::NotNeeded,
            (_, Some(withdrawal)) => Found::Withdrawn(withdrawal),
            (None, None) => Found::Infeasible,
            (Some(amount), None) => {
                let value = knob.value(amount);
                let beyond = knob.strategy == Strategy::Constant && amount > 1.0;
                match knob.accepts(value) && !beyond {
                    true => Found::Set(value),
                    false => Found::OutOfRange(value),
                }
            }
        };
        Self { knob, found, swept }
    }

    /// The value to set; `None` where none is recommended.
    #[must_use]
    pub const fn value(&self) -> Option<f64> {
        match self.found {
            Found::Set(value) => Some(value),
            Found::NotNeeded => Some(0.0),
            Found::Infeasible | Found::OutOfRange(_) | Found::Withdrawn(_) => None,
        }
    }

    /// Order of preference: feasible, then the least false light, then false shadow.
    fn merit(&self) -> (bool, i64, i64) {
        let end = self.swept.acne_free.filter(|_| self.value().is_some());
        end.map_or((true, i64::MAX, i64::MAX), |p| (false, p.tally.light, p.tally.shadow))
    }
}

/// Where units are converted: the receiver in the middle of those counted.
#[must_use]
pub fn place(field: &Field<'_>, size: u32, format: TexelFormat) -> Option<Place> {
    Some(place_at(field, field.middle()?, size, format))
}

/// Where units are converted at one receiver. A polygon offset lifts its own triangle by the slope and the
/// unit that the sweeps draw it with, so that an amount times its lever is the window depth swept.
#[must_use]
pub fn place_at(field: &Field<'_>, sample: &Sample, size: u32, format: TexelFormat) -> Place {
    let layout = field.case().light.layout(size);
    let site = field.site(sample, &layout);
    let map = &field.observer.lenses[sample.map].map;
    let (near, far) = map.projection.near_far();
    let z = map.axial_distance(sample.receiver.position);
    let [caster_slope, unit] = field.offset_terms(sample, &layout, format).map(f64::from);
    Place {
        near,
        far,
        distance: (!map.is_orthographic()).then_some(z),
        texel_world: site.texel_world,
        cosine: site.normal.dot(site.to_light).clamp(1e-6, 1.0),
        slope: receiver_slope(site.gradient, site.map_size),
        caster_slope,
        unit,
        step: format.step(map.clip.compared(sample.coord[2])),
    }
}

/// Cosine of the largest angle between face and vertices' normals at which a move along one stands for a move
/// along the other: 1°.
const FLAT: f64 = 0.999_847_695;

/// Whether the normal of the vertices at the middle receiver is another than its face's.
fn is_curved(field: &Field<'_>) -> bool {
    field.middle().is_some_and(|sample| {
        let normals = field.observer.vertex_normals_at(&sample.receiver);
        normals.is_some_and(|normals| {
            let turned = [normals.interpolated, normals.shading];
            turned.into_iter().any(|normal| normal.dot(sample.normal) < FLAT)
        })
    })
}

/// Whether a strategy moves receivers or casters along normals of vertices.
fn moves_along_vertices(strategy: Strategy) -> bool {
    let recipe = strategy.with(1.0);
    let along = |normal: NormalMove| normal.amount != 0.0 && normal.along != MoveNormal::Face;
    along(recipe.normal) || along(recipe.caster_normal)
}

/// The measured setting of an engine's defaults: casters' and receivers' hooks together.
fn defaults(chart: &Chart<'_, '_>, format: TexelFormat, engine: Engine) -> Tally {
    let recipe = engine.defaults();
    let casters = Recipe { normal: NormalMove::default(), light: 0.0, ..recipe };
    let field = chart.field.looking_from(&recipe, &chart.layout);
    let there = Chart::new(&field, chart.size, chart.filter, Attachment::of(format));
    let rule = field.case().lookup.compare;
    let mut tally = Tally::default();
    for (i, mut looks) in there.looks(format, &casters).into_iter().enumerate() {
        let sample = &chart.field.samples[i];
        let bias = |look: &Look| chart.tap_bias(&recipe, format, i, look.map);
        let wrong = looks.verdict_by(rule, bias).0.is_some();
        if recipe.moves_receiver() && !sample.lit && wrong {
            let offset = recipe.receiver_offset(&chart.site(i));
            looks.moved_into_light = chart.field.is_lit_from(sample, offset);
        }
        looks.tally_by(rule, bias, &mut tally);
    }
    tally
}

/// What is known of an engine's bias on a scene: its parameters tuned, its defaults measured.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Tuning {
    /// The engine.
    pub engine: Engine,
    /// The target: acne allowed, as a share of the truly lit.
    pub max_acne: f64,
    /// Truly lit and truly shadowed receivers.
    pub populations: [u64; 2],
    /// Every parameter of the engine, in order of preference: those that meet the target first, of them
    /// the one that costs the least light. Empty where nothing is lit and acne is not measured.
    pub tuned: Vec<Tuned>,
    /// What the engine's defaults leave wrong; `None` where nothing is measured or it is not said.
    pub defaults: Option<Tally>,
    /// Why what the defaults leave is not said.
    pub no_default: Option<&'static Withdrawal>,
    /// The constant bias that ends acne, window depth; asked where a line is withdrawn.
    pub constant: Option<f32>,
    /// The best value in window depth at the middle receiver.
    pub window: Option<f64>,
    /// Where units are converted: the middle receiver; `None` where nothing is measured.
    pub place: Option<Place>,
    /// Whether the vertices' normals are not the face's there: moves along them have no other unit then.
    pub is_curved: bool,
    /// What a line's validity depends on.
    pub setting: Setting,
    /// The cheapest map with which the scene meets the target; `None` where no smaller one does.
    pub cheapest: Option<Configuration>,
    /// Where the needed bias comes from; `None` where nothing is lit.
    pub budget: Option<Budget>,
}

/// The bias for an engine on a field's scene: the smallest value of each of its parameters with acne on at
/// most `max_acne` of the truly lit.
///
/// ```
/// use gnomon::analysis::sweep::Field;
/// use gnomon::analysis::tune::{self, Found};
/// use gnomon::engines::Engine;
/// use gnomon::scene::cases;
///
/// let case = cases::named("book-r8-y7")?;
/// let field = Field::new(&case, 8); // every eighth pixel, both ways
/// let tuning = tune::tune(&field, Engine::Vulkan, 0.001);
/// let best = tuning.best().expect("some parameter ends acne");
/// let Found::Set(value) = best.found else { panic!("this scene needs a bias") };
/// println!("{}", best.knob.line(value));
/// assert!(tuning.window.is_some_and(|depth| depth > 0.0));
/// # Ok::<(), gnomon::Error>(())
/// ```
#[must_use]
pub fn tune(field: &Field<'_>, engine: Engine, max_acne: f64) -> Tuning {
    let (size, format) = (field.case().map.size, field.case().map.texel);
    let filter = format.usable(field.case().lookup.filter);
    let chart = Chart::new(field, size, filter, Attachment::of(format));
    let mut tuning = Tuning::on(&chart, format, engine, max_acne);
    if field.populations[0] > 0 {
        tuning.cheapest = cheapest(field, &tuning);
        tuning.budget = Some(Budget::of(field));
    }
    tuning
}

impl Tuning {
    /// Everything that the asked map says.
    fn on(chart: &Chart<'_, '_>, format: TexelFormat, engine: Engine, max_acne: f64) -> Self {
        let populations = chart.field.populations;
        let knobs = if populations[0] > 0 { engine.knobs() } else { Vec::new() };
        let tune = |knob| Tuned::new(chart, format, knob, max_acne);
        let mut tuned: Vec<Tuned> = knobs.into_iter().map(tune).collect();
        tuned.sort_by_key(Tuned::merit);
        let setting = Setting::of(chart.field.case(), chart.filter);
        let no_default = engine.default_withdrawn(&setting);
        let is_said = no_default.is_none() && populations != [0, 0];
        let defaults = is_said.then(|| defaults(chart, format, engine));
        let is_withdrawn = |t: &Tuned| matches!(t.found, Found::Withdrawn(_));
        let constant = tuned.iter().any(is_withdrawn).then(|| {
            let swept = swept(chart, format, Strategy::Constant, max_acne);
            swept.acne_free.map(|p| p.amount)
        });
        let place = place(chart.field, chart.size, format);
        let best = tuned.iter().find(|t| t.value().is_some());
        let is_curved = is_curved(chart.field);
        let converts = |t: &&Tuned| !(is_curved && moves_along_vertices(t.knob.strategy));
        let window = best.filter(converts).zip(place.as_ref()).and_then(|(t, place)| {
            let amount = f64::from(t.swept.acne_free?.amount);
            place.window(t.knob.strategy, amount).filter(|depth| depth.abs() <= 1.0)
        });
        let (constant, cheapest, budget) = (constant.flatten(), None, None);
        Self {
            engine,
            max_acne,
            populations,
            tuned,
            defaults,
            no_default,
            constant,
            window,
            place,
            is_curved,
            setting,
            cheapest,
            budget,
        }
    }

    /// The parameter to set; `None` where none is recommended.
    #[must_use]
    pub fn best(&self) -> Option<&Tuned> {
        self.tuned.iter().find(|t| t.value().is_some())
    }
}
