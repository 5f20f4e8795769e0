//! Truth: what a receiver sees towards the light, decided in f64 by exact sign tests.
//!
//! Truth shares inputs with the subject, never code, and knows no lights: it answers about
//! segments from a receiver to a *light end* (the position of a point light, or a point far
//! enough towards a directional one).
//!
//! # What is certain
//! A triangle *meets* a segment by its closed set. Signs of 3x3 determinants on the given f64
//! coordinates are exact (`orient`), so meeting is known, not estimated. Where the segment passes
//! through the inside of a triangle, every neighbouring segment is blocked as well. Where it passes
//! through an edge or a vertex, the triangles that meet there are looked at together
//! (`cover`): if they close the full turn around the segment (two triangles on both sides of an
//! edge, a whole fan around a vertex), every neighbouring segment is blocked and the verdict is
//! *shadowed*; if not, the segment grazes a silhouette and the verdict is *ambiguous*. So a closed
//! mesh never leaks, and nothing is ever guessed. A triangle without area casts no shadow.
//!
//! # Touching
//! Receivers are barycentric combinations rounded to f64, so they lie off their own surface by up
//! to `16 * 2^-53 * M` per axis, where `M` is the largest |coordinate| of scene and receiver
//! (three products, their sum, and barycentrics that add up to 1 within 3 ulp: `8 * 2^-53 * M`,
//! doubled). A triangle whose distance along the segment is 0 within that uncertainty and the
//! rounding of the distance itself is *touching*: it is no occluder, and it is counted.
//!
//! # Range
//! Signs are exact where the non-zero coordinates of segment and triangle span at most 342
//! binades (about 100 decimal orders). Beyond that the triangle counts as grazing: ambiguous
//! unless another occluder is certain.

mod answers;
mod bvh;
mod cover;
mod holes;
mod intersect;
pub mod izb;
mod orient;
mod plane;

pub use answers::Answers;
pub use bvh::Tracer;

use crate::scene::{Cull, Culls};
use glam::DVec3;

/// What a receiver sees towards the light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Truth {
    /// Nothing meets the segment to the light.
    Lit,
    /// The segment and all segments next to it are blocked.
    Shadowed(Occlusion),
    /// The segment grazes a silhouette, lies in the plane of a triangle or ends on one.
    Ambiguous,
}

/// The occluders at both ends of a blocked segment. Where several share a distance, the lowest
/// triangle id stands for them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Occlusion {
    /// The occluder nearest to the receiver.
    pub occluder: u32,
    /// World distance from the receiver to `occluder`, rounded to f64; its error bound is that of
    /// [`FirstHit::Hit`] times the length of the segment.
    pub gap: f64,
    /// The occluder nearest to the light: what an ideal map stores.
    pub first: u32,
    /// World distance from the receiver to `first`.
    pub first_gap: f64,
}

/// A point on the subject's surface, promoted to f64.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Receiver {
    /// World position.
    pub position: DVec3,
    /// The triangle it lies on, which never occludes it; an id that the scene does not have
    /// (`u32::MAX`) excludes nothing.
    pub triangle: u32,
}

/// The truth about one receiver.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Answer {
    /// Lit, shadowed or ambiguous.
    pub truth: Truth,
    /// Triangles that meet the line to the light at the receiver itself, its own one excluded.
    pub touching: u32,
}

/// The first triangle along a segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FirstHit {
    /// Nothing meets the segment.
    None,
    /// A triangle blocks this segment and all segments next to it.
    Hit {
        /// The triangle; the lowest id where several share the distance.
        triangle: u32,
        /// Position on the segment, `from + t * (to - from)`, strictly between 0 and 1.
        t: f64,
        /// The true `t` lies within `t_error` of `t`, also if `from` is off by the position
        /// uncertainty that the module describes.
        t_error: f64,
    },
    /// The nearest contact only grazes a silhouette.
    Ambiguous,
}

crate::catalogue! {
    /// Which sides of a triangle count, as seen from the start of the segment.
    pub enum Faces {
        /// Triangles seen from either side.
        Both = "both",
        /// Only triangles seen counter-clockwise.
        Front = "front",
        /// Only triangles seen clockwise.
        Back = "back",
    }
}

/// Which sides of which triangles count, as seen from the start of the segment.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SeenFaces {
    /// Every triangle alike.
    Alike(Faces),
    /// By triangle id; `None` of one that never counts.
    Each(Vec<Option<Faces>>),
}

impl SeenFaces {
    /// The sides that a map draws which leaves out these faces.
    #[must_use]
    pub fn left_by(culls: &Culls) -> Self {
        let left = |cull: Cull| match cull {
            Cull::None => Faces::Both,
            Cull::Back => Faces::Front,
            Cull::Front => Faces::Back,
        };
        match culls {
            Culls::Alike(cull) => Self::Alike(left(*cull)),
            Culls::Each(each) => Self::Each(each.iter().map(|cull| cull.map(left)).collect()),
        }
    }

    /// The sides of a triangle that count.
    #[must_use]
    #[inline]
    pub fn of(&self, id: u32) -> Option<Faces> {
        match self {
            Self::Alike(faces) => Some(*faces),
            Self::Each(each) => each[id as usize],
        }
    }

    /// Whether both sides of every triangle count that counts at all.
    #[must_use]
    pub fn is_everything(&self) -> bool {
        match self {
            Self::Alike(faces) => *faces == Faces::Both,
            Self::Each(each) => each.iter().all(|f| f.is_none_or(|faces| faces == Faces::Both)),
        }
    }
}

/// Where the segments of all receivers end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightEnd {
    /// A point light or spot at this world position.
    Point(DVec3),
    /// A directional light: the end is the receiver plus this vector, which must reach beyond
    /// every caster ([`Tracer::reach`]).
    Along(DVec3),
}

impl LightEnd {
    /// The end of the segment of a receiver at `position`, each coordinate rounded once.
    #[must_use]
    pub fn of(self, position: DVec3) -> DVec3 {
        match self {
            Self::Point(light) => light,
            Self::Along(vector) => position + vector,
        }
    }
}
