//! Biases that are functions of a place on a surface: a guest's own, and the tutorials'.

use super::Site;
use std::fmt;

/// A bias rule as a shader writes it: a function of the receiver's place and of one or two amounts.
///
/// It need not be monotone in an amount: sweeps find out, say so, and go from amount to amount.
pub trait BiasRule: Sync {
    /// What every tap of a look-up adds to the stored depth before the comparison, window depth.
    fn bias(&self, site: &Site, amounts: [f32; 2]) -> f32;

    /// Scalar operations of one look-up: additions, products, divisions, roots, minima, comparisons.
    fn operations(&self) -> u32 {
        0
    }
}

/// A rule at its amounts.
#[derive(Clone, Copy)]
pub struct Rule {
    /// The rule.
    pub rule: &'static dyn BiasRule,
    /// Its amounts; rules of one amount leave the second alone.
    pub amounts: [f32; 2],
}

impl Rule {
    /// The bias of every tap at a place, window depth.
    #[must_use]
    pub fn bias(&self, site: &Site) -> f32 {
        self.rule.bias(site, self.amounts)
    }
}

/// This rule object at the same amounts.
impl PartialEq for Rule {
    fn eq(&self, other: &Self) -> bool {
        std::ptr::addr_eq(self.rule, other.rule) && self.amounts == other.amounts
    }
}

impl fmt::Debug for Rule {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Rule").field("amounts", &self.amounts).finish_non_exhaustive()
    }
}

/// N·L of a place, at least 0, rounded to f32; N the interpolated normal of the vertices, as the tutorials'
/// shaders have it.
fn cosine(site: &Site) -> f32 {
    let normal = site.normals.map_or(site.normal, |normals| normals.interpolated);
    normal.dot(site.to_light).clamp(0.0, 1.0) as f32
}

/// max(a·(1 − N·L), 0.005).
pub(super) struct FlooredCosine;

impl BiasRule for FlooredCosine {
    fn bias(&self, site: &Site, [a, _]: [f32; 2]) -> f32 {
        (a * (1.0 - cosine(site))).max(0.005)
    }

    // A dot product, a difference, a product, a maximum.
    fn operations(&self) -> u32 {
        8
    }
}

/// clamp(a·tan(acos(N·L)), 0, 0.01).
pub(super) struct ClampedTangent;

impl BiasRule for ClampedTangent {
    fn bias(&self, site: &Site, [a, _]: [f32; 2]) -> f32 {
        let cosine = cosine(site);
        let tangent = (1.0 - cosine * cosine).sqrt() / cosine;
        if a == 0.0 { 0.0 } else { (a * tangent).clamp(0.0, 0.01) }
    }

    // A dot product; 1 − c², its root, a quotient; a product, two bounds.
    fn operations(&self) -> u32 {
        12
    }
}

/// a/w.
pub(super) struct BeforeDivision;

impl BiasRule for BeforeDivision {
    fn bias(&self, site: &Site, [a, _]: [f32; 2]) -> f32 {
        a / site.w as f32
    }

    fn operations(&self) -> u32 {
        1
    }
}
