//! A bias that is in no catalogue, along its amount: a guest's rule, or any recipe of one amount.

use super::chart::Chart;
use super::evaluate::Question;
use super::swept::Point;
use super::values;
use crate::scene::TexelFormat;
use crate::shadow::bias::{BiasRule, Recipe, Rule};
use crate::{Error, Result};

/// What a bias leaves wrong along its amount.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Followed {
    /// The counts at each amount, literal.
    pub points: Vec<Point>,
    /// The first point from which acne stays within the limit to the last amount, bisected to 2⁻¹⁰ of the
    /// distance to the amount before where more of the bias never darkens, else one of `points`.
    pub acne_free: Option<Point>,
    /// The amount at which the first shadow detaches, found likewise.
    pub detachment: Option<f32>,
    /// How many receivers are truly lit and truly shadowed.
    pub populations: [u64; 2],
    /// The first receiver whose bias falls from one amount to the next, with both amounts: the bias is
    /// not monotone, and nothing is said of what lies between two amounts.
    pub falls: Option<(usize, [f32; 2])>,
}

/// Follows a guest's rule along its first amount; the second stays as it is.
///
/// ```
/// use gnomon::analysis::sweep::chart::{Attachment, Chart};
/// use gnomon::analysis::sweep::{Field, Question, guest};
/// use gnomon::scene::{Filter, cases};
/// use gnomon::shadow::bias::{BiasRule, Site};
///
/// /// max(a·(1 − N·L), b), as many tutorials write it.
/// struct Floored;
/// impl BiasRule for Floored {
///     fn bias(&self, site: &Site, [a, b]: [f32; 2]) -> f32 {
///         (a * (1.0 - site.normal.dot(site.to_light) as f32)).max(b)
///     }
/// }
///
/// let mut case = cases::named("fundamentals-spot").unwrap();
/// case.canvas = [64, 48];
/// let field = Field::new(&case, 1);
/// let format = case.map.texel;
/// let chart = Chart::new(&field, 256, Filter::Nearest, Attachment::of(format));
/// let question = Question { amounts: &[0.0, 0.01, 0.05, 0.2], max_acne: 0.001 };
/// let followed = guest::rule(&chart, format, &Floored, 1e-5, &question).unwrap();
/// assert_eq!(followed.points.len(), 4);
/// assert!(followed.falls.is_none(), "more of it never darkens");
/// ```
///
/// # Errors
/// [`Error::BadInput`] where an amount is out of order or the rule gives no number for a receiver.
pub fn rule(
    chart: &Chart<'_, '_>,
    format: TexelFormat,
    rule: &'static dyn BiasRule,
    second: f32,
    question: &Question<'_>,
) -> Result<Followed> {
    let recipe = |a: f32| {
        let rule = Some(Rule { rule, amounts: [a, second] });
        Recipe { rule, ..Recipe::NONE }
    };
    follow(chart, format, &recipe, question)
}

/// Follows any recipe of one amount.
///
/// # Errors
/// [`Error::BadInput`] where an amount is out of order or a receiver's bias is no number.
pub fn follow(
    chart: &Chart<'_, '_>,
    format: TexelFormat,
    recipe: &(dyn Fn(f32) -> Recipe + Sync),
    question: &Question<'_>,
) -> Result<Followed> {
    let amounts = question.amounts;
    if amounts.is_empty() || !amounts.is_sorted() || amounts.iter().any(|a| !a.is_finite()) {
        let reason = "are none, not ascending, or not finite";
        return Err(Error::bad_input("the amounts", reason, "give finite ascending amounts"));
    }
    let falls = falls(chart, format, recipe, amounts)?;
    let populations = chart.field.populations;
    let limit = (question.max_acne * populations[0] as f64) as i64;
    let found = values::along(chart, format, recipe, amounts, (limit, falls.is_none()));
    let (points, acne_free, detachment) = found;
    let acne_free = acne_free.filter(|_| populations[0] > 0);
    Ok(Followed { points, acne_free, detachment, populations, falls })
}

/// The first receiver whose bias falls between two amounts.
fn falls(
    chart: &Chart<'_, '_>,
    format: TexelFormat,
    recipe: &dyn Fn(f32) -> Recipe,
    amounts: &[f32],
) -> Result<Option<(usize, [f32; 2])>> {
    let mut before: Vec<f32> = Vec::new();
    let mut falls = None;
    for (k, &amount) in amounts.iter().enumerate() {
        let recipe = recipe(amount);
        let bias = |i: usize| chart.bias(&recipe, format, i);
        let now: Vec<f32> = (0..chart.field.samples.len()).map(bias).collect();
        if let Some(i) = now.iter().position(|b| b.is_nan()) {
            let place = format!("the bias of receiver {i} at amount {amount}");
            let at = chart.site(i).position;
            let reason = format!("is no number (at {at})");
            return Err(Error::bad_input(place, reason, "give the rule a value for every place"));
        }
        let fall = before.iter().zip(&now).position(|(before, now)| now < before);
        if let (Some(i), None) = (fall, falls) {
            falls = Some((i, [amounts[k - 1], amount]));
        }
        before = now;
    }
    Ok(falls)
}
