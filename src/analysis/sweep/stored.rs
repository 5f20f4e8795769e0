//! The result of a sweep's item in a journal or a shard: JSON in which no bit is lost.

use super::shard::Part;
use super::tally::{Kind, Tally};
use super::{Point, Swept, plan};
use crate::output::journal::Item;
use serde::{Deserialize, Serialize};

impl Item for Part {
    fn to_bytes(&self) -> Vec<u8> {
        let stored = Stored {
            world_per_window: self.world_per_window.to_bits(),
            texel_world: self.texel_world.to_bits(),
            theory: self.theory.iter().map(|(b, share)| (b.to_bits(), share.to_bits())).collect(),
            first_lines: self.first_lines.clone(),
            swept: self.swept.iter().map(StoredSwept::of).collect(),
        };
        serde_json::to_vec(&stored).expect("integers and names are JSON")
    }

    fn from_bytes(bytes: &[u8]) -> Option<Self> {
        let stored = serde_json::from_slice::<Stored>(bytes).ok()?;
        let theory = stored.theory.iter();
        Some(Self {
            world_per_window: f64::from_bits(stored.world_per_window),
            texel_world: f64::from_bits(stored.texel_world),
            theory: theory.map(|&(b, s)| (f32::from_bits(b), f64::from_bits(s))).collect(),
            first_lines: stored.first_lines,
            swept: stored.swept.iter().map(StoredSwept::read).collect::<Option<_>>()?,
        })
    }
}

/// An item's result: floats as their bits, so that nothing is lost, infinities included.
#[derive(Debug, Serialize, Deserialize)]
struct Stored {
    world_per_window: u64,
    texel_world: u64,
    theory: Vec<(u32, u64)>,
    first_lines: Vec<String>,
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
        let part = Part {
            world_per_window: f64::MIN_POSITIVE,
            texel_world: -0.0,
            theory: vec![(f32::NAN, 0.1 + 0.2)],
            first_lines: vec!["Left out: a \"skin\".".to_string()],
            swept: vec![swept],
        };
        let read = Part::from_bytes(&part.to_bytes()).unwrap();
        assert_eq!(format!("{read:?}"), format!("{part:?}"));
        assert!(read.swept[0].points[1].amount.is_sign_negative());
        assert_eq!(read.to_bytes(), part.to_bytes());
    }

    #[test]
    fn what_is_no_result_of_this_version_is_refused() {
        for bytes in [&b"{}"[..], b"", b"\xff"] {
            assert!(Part::from_bytes(bytes).is_none());
        }
    }
}
