//! A sweep as work items: one case on one map size each, with results that survive a file bit by bit.

use super::tally::Kind;
use super::tally::Tally;
use super::{CaseSweep, Field, Plan, Point, Swept, plan, sweep_size};
use crate::analysis::effort::Effort;
use crate::{Error, Result};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::fmt::{self, Write};

/// Changes whenever the meaning of a stored result does.
const SCHEMA: &str = concat!("gnomon-sweep-items-1 ", env!("CARGO_PKG_VERSION"));

/// Every item in words, in order: the cases of the plan, under each its map sizes.
#[must_use]
pub fn items(plan: &Plan) -> Vec<String> {
    let of = |i: usize| format!("{} {}", plan.cases[i / plan.sizes.len()].name, size_of(plan, i));
    (0..plan.cases.len() * plan.sizes.len()).map(of).collect()
}

fn size_of(plan: &Plan, item: usize) -> u32 {
    plan.sizes[item % plan.sizes.len()]
}

/// SHA-256 (hex) of the whole plan: every axis, and of every case its geometry, light and pipeline.
///
/// `Debug` writes each float as its shortest text that reads back to the same bits, so plans with one
/// key are equal.
///
/// # Panics
/// Never: a digest takes any text.
#[must_use]
pub fn key(plan: &Plan) -> String {
    struct Text(Sha256);
    impl Write for Text {
        fn write_str(&mut self, text: &str) -> fmt::Result {
            self.0.update(text.as_bytes());
            Ok(())
        }
    }
    let mut text = Text(Sha256::new());
    write!(text, "{SCHEMA} {plan:?}").expect("a digest takes any text");
    text.0.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Computes items. Those of one case share its receivers while they come one after the other.
#[derive(Debug)]
pub struct Worker<'p> {
    plan: &'p Plan,
    effort: Effort,
    field: Option<(usize, Field<'p>)>,
}

impl<'p> Worker<'p> {
    /// Of a plan; no result depends on the effort.
    #[must_use]
    pub const fn new(plan: &'p Plan, effort: Effort) -> Self {
        Self { plan, effort, field: None }
    }

    /// The result of one item as bytes for [`assemble`]; the same bytes on every machine.
    ///
    /// # Panics
    /// If there is no such item.
    pub fn compute(&mut self, item: u32) -> Vec<u8> {
        let (plan, item) = (self.plan, item as usize);
        let index = item / plan.sizes.len();
        let case = &plan.cases[index];
        if self.field.as_ref().is_none_or(|f| f.0 != index) {
            self.field = None;
            self.field = Some((index, Field::with(case, plan.step, self.effort)));
        }
        let (_, field) = self.field.as_ref().expect("it has just been set");
        let facts = CaseSweep::of(field, plan);
        let one = |filter: &Option<_>| {
            let filter = filter.unwrap_or(case.lookup.filter);
            sweep_size(field, size_of(plan, item), filter, plan)
        };
        let swept: Vec<Vec<Swept>> = plan.filters.par_iter().map(one).collect();
        let stored = Stored {
            world_per_window: facts.world_per_window.to_bits(),
            texel_world: facts.texel_world.to_bits(),
            theory: facts.theory.iter().map(|(b, share)| (b.to_bits(), share.to_bits())).collect(),
            swept: swept.iter().flatten().map(StoredSwept::of).collect(),
        };
        serde_json::to_vec(&stored).expect("integers and names are JSON")
    }
}

/// The sweeps of a plan from the results of its items; what is missing is left out.
///
/// # Errors
/// [`Error::BadInput`] where a result is none of this version.
pub fn assemble(plan: &Plan, results: &BTreeMap<u32, &[u8]>) -> Result<Vec<CaseSweep>> {
    let mut sweeps: Vec<CaseSweep> = plan.cases.iter().map(CaseSweep::named).collect();
    for (&item, bytes) in results {
        let sweep = &mut sweeps[item as usize / plan.sizes.len()];
        let stored = serde_json::from_slice::<Stored>(bytes).ok();
        let swept = stored.as_ref().and_then(|s| s.swept.iter().map(StoredSwept::read).collect());
        let (Some(stored), Some(swept)) = (stored, swept) else {
            let place =
                format!("result of item {item} ({} {})", sweep.name, size_of(plan, item as usize));
            return Err(Error::bad_input(place, "cannot be read", "sweep again without --resume"));
        };
        let swept: Vec<Swept> = swept;
        sweep.world_per_window = f64::from_bits(stored.world_per_window);
        sweep.texel_world = f64::from_bits(stored.texel_world);
        let theory = stored.theory.iter();
        sweep.theory = theory.map(|&(b, s)| (f32::from_bits(b), f64::from_bits(s))).collect();
        sweep.swept.extend(swept);
    }
    Ok(sweeps)
}

/// An item's result: floats as their bits, so that nothing is lost, infinities included.
#[derive(Debug, Serialize, Deserialize)]
struct Stored {
    world_per_window: u64,
    texel_world: u64,
    theory: Vec<(u32, u64)>,
    swept: Vec<StoredSwept>,
}

/// Amount, receivers by kind, false shadow, false light, gap.
#[derive(Debug, Serialize, Deserialize)]
struct StoredPoint(u32, [i64; Kind::COUNT], i64, i64, u64);

#[derive(Debug, Serialize, Deserialize)]
struct StoredSwept {
    strategy: String,
    format: String,
    filter: String,
    size: u32,
    points: Vec<StoredPoint>,
    acne_free: Option<StoredPoint>,
    critical: Option<u32>,
    detachment: Option<u32>,
    populations: [u64; 2],
}

impl StoredPoint {
    const fn of(point: &Point) -> Self {
        let Tally { kinds, shadow, light } = point.tally;
        Self(point.amount.to_bits(), kinds, shadow, light, point.gap.to_bits())
    }

    const fn read(&self) -> Point {
        let tally = Tally { kinds: self.1, shadow: self.2, light: self.3 };
        Point { amount: f32::from_bits(self.0), tally, gap: f64::from_bits(self.4) }
    }
}

impl StoredSwept {
    fn of(swept: &Swept) -> Self {
        Self {
            strategy: swept.strategy.to_string(),
            format: swept.format.name().to_string(),
            filter: swept.filter.to_string(),
            size: swept.size,
            points: swept.points.iter().map(StoredPoint::of).collect(),
            acne_free: swept.acne_free.as_ref().map(StoredPoint::of),
            critical: swept.critical.map(f32::to_bits),
            detachment: swept.detachment.map(f32::to_bits),
            populations: swept.populations,
        }
    }

    /// `None` where a name is not known.
    fn read(&self) -> Option<Swept> {
        Some(Swept {
            strategy: self.strategy.parse().ok()?,
            format: plan::format_named(&self.format).ok()?,
            filter: self.filter.parse().ok()?,
            size: self.size,
            points: self.points.iter().map(StoredPoint::read).collect(),
            acne_free: self.acne_free.as_ref().map(StoredPoint::read),
            critical: self.critical.map(f32::from_bits),
            detachment: self.detachment.map(f32::from_bits),
            populations: self.populations,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_result_survives_storage_bit_by_bit() {
        let tally = Tally { kinds: [1, -2, 3, 4, 5, i64::MAX], shadow: i64::MIN, light: 7 };
        let point = Point { amount: f32::from_bits(1), tally, gap: f64::INFINITY };
        let swept = Swept {
            strategy: "constant".parse().unwrap(),
            format: plan::format_named("book").unwrap(),
            filter: crate::scene::Filter::ALL[1],
            size: 4096,
            points: vec![point, Point { amount: -0.0, ..point }],
            acne_free: Some(point),
            critical: None,
            detachment: Some(f32::INFINITY),
            populations: [u64::MAX, 3],
        };
        let text = serde_json::to_string(&StoredSwept::of(&swept)).unwrap();
        let read = serde_json::from_str::<StoredSwept>(&text).unwrap().read().unwrap();
        assert_eq!(format!("{read:?}"), format!("{swept:?}"));
        assert!(read.points[1].amount.is_sign_negative());
    }
}
