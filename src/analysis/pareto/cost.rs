//! What a combination costs, counted: bytes, passes, fetches and operations.
//!
//! One operation is one addition, subtraction, multiplication, division, comparison, minimum, maximum,
//! floor, rounding or derivative of a scalar; a contracted multiply-add counts as two.
//!
//! A look-up, after the projection that every look-up shares, costs:
//! - per comparison: 2 for its coordinates (unless it is the only one), 1 for the bias, 1 to compare;
//! - per texel of a packing: its unpack, counted by running it;
//! - 1 addition per further comparison and 1 multiplication to average;
//! - per bilinear comparison: 4 for the two fractions (scale, floor each) and 9 for three linear
//!   interpolations of the four results;
//! - the strategy's own, [`strategy_operations`].

use crate::depth::Packing;
use crate::depth::arith::Number;
use crate::depth::packing::{Pair, PairVisitor};
use crate::scene::{Filter, TexelFormat};
use crate::shadow::bias::{Follow, Layers, NormalWeight, Strategy};
use serde::Serialize;
use std::cell::Cell;
use std::cmp::Ordering;
use std::ops::{Add, Div, Mul, Sub};

/// Machine-independent costs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Cost {
    /// Bytes of the map that look-ups read.
    pub map_bytes: u64,
    /// Passes over the casters.
    pub passes: u32,
    /// Texels that one look-up fetches.
    pub fetches: u32,
    /// Arithmetic operations of one look-up.
    pub operations: u32,
}

impl Cost {
    /// The cost of a combination.
    #[must_use]
    pub fn of(format: TexelFormat, size: u32, filter: Filter, strategy: Strategy) -> Self {
        let fetches = filter.fetches();
        let comparisons = if filter == Filter::Linear { 1 } else { fetches };
        let bilinear = filter.hardware_comparisons();
        let unpack = match format {
            TexelFormat::Packed(packing) => unpack_operations(packing),
            TexelFormat::Depth(_) => 0,
        };
        let places = if comparisons == 1 { 0 } else { 2 * comparisons };
        let average = if comparisons == 1 { 0 } else { comparisons };
        let [once, each] = strategy_operations(strategy);
        Self {
            map_bytes: u64::from(size) * u64::from(size) * u64::from(format.bytes()),
            passes: match strategy.with(1.0).layers {
                Layers::Nearest | Layers::BackFaces => 1,
                Layers::Second | Layers::Midpoint | Layers::Dual => 2,
            },
            fetches,
            operations: places
                + 2 * comparisons
                + unpack * comparisons
                + average
                + 13 * bilinear
                + once
                + each * comparisons,
        }
    }
}

/// Operations of a strategy at the receiver: once a look-up, and for each comparison more. Read off its
/// recipe; what the raster or the map pass does costs no look-up anything.
///
/// A move is three multiply-adds, one product more where it counts texels; its weight beside: 1 − N·L a dot
/// product, a difference and a product, sin θ a dot product, 1 − c², its root and a product; taking off the
/// part along L another dot product and three multiply-adds. A gradient is two derivatives: their sizes are
/// added, multiplied and clamped for a slope. The receiver's plane in the map is three pairs of derivatives,
/// three 2×2 determinants (3 operations each) and two divisions: 17; following it to a texel's centre costs
/// the centre (per axis scale, floor, add, rescale, subtract: 10) and two multiply-adds.
#[must_use]
pub fn strategy_operations(strategy: Strategy) -> [u32; 2] {
    let recipe = strategy.with(1.0);
    let normal = recipe.normal;
    let weight = match normal.weight {
        NormalWeight::One => 0,
        NormalWeight::OneMinusCos => 7,
        NormalWeight::Sin | NormalWeight::Blender => 9,
    };
    let counted = |does: bool, operations: u32| if does { operations } else { 0 };
    let moved = 6 + weight + counted(normal.in_texels, 1) + counted(normal.sideways, 11);
    let [plane, each] = match recipe.follow {
        Follow::Receiver => [0, 0],
        Follow::TexelCentre | Follow::NearerOfCentre => [17, 14],
        Follow::Sample => [17, 4],
    };
    let once = counted(normal.amount != 0.0, moved)
        + counted(recipe.light != 0.0, 6)
        + counted(recipe.slope != 0.0, 5)
        + recipe.rule.map_or(0, |r| r.rule.operations());
    [once + plane, each]
}

thread_local! {
    static OPERATIONS: Cell<u32> = const { Cell::new(0) };
}

/// Operations of a packing's unpack, counted by running it.
#[must_use]
pub fn unpack_operations(packing: Packing) -> u32 {
    struct Unpack;
    impl PairVisitor for Unpack {
        type Output = u32;
        fn visit<P: Pair + 'static>(self, pair: P) -> u32 {
            OPERATIONS.set(0);
            let channels = [0.5, 0.25, 0.125, 0.75].map(Counted);
            pair.unpack(channels);
            OPERATIONS.get()
        }
    }
    packing.with_pair(Unpack)
}

/// A real number that counts what is done with it.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Counted(f64);

impl Counted {
    fn by(value: f64, operations: u32) -> Self {
        OPERATIONS.set(OPERATIONS.get() + operations);
        Self(value)
    }
}

impl PartialOrd for Counted {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Self::by(0.0, 1);
        self.0.partial_cmp(&other.0)
    }
}

macro_rules! counted {
    ($($Operation:ident $method:ident $sign:tt),+) => {
        $(impl $Operation for Counted {
            type Output = Self;
            fn $method(self, other: Self) -> Self { Self::by(self.0 $sign other.0, 1) }
        })+
    };
}
counted!(Add add +, Sub sub -, Mul mul *, Div div /);

impl Number for Counted {
    fn ratio(n: f64, d: f64) -> Self {
        Self(n / d)
    }
    fn floor(self) -> Self {
        Self::by(self.0.floor(), 1)
    }
    fn nearest(self) -> Self {
        Self::by(self.0.round_ties_even(), 1)
    }
    fn fract(self) -> Self {
        Self::by(self.0 - self.0.floor(), 2)
    }
    fn pattern_byte(self, _: u32) -> Self {
        Self::by(self.0, 2)
    }
    // Four conversions, three shifts, three unions.
    fn from_pattern(bytes: [Self; 4]) -> Self {
        Self::by(bytes[0].0, 10)
    }
}
